//! Whether process noise stays above its floor, at which equation, and what its smoothed course follows.

use super::events::{Course, events};
use super::noisy_inputs;
use super::policy::GENERAL;
use super::study::Studied;
use crate::diagnosis::{RunTrace, Unknown};
use crate::dynamics::Engine;
use crate::infer::likelihood::maximise;
use crate::infer::{Disturbance, Fit, Noise, Sizes, smooth};
use crate::observe::Problem;
use crate::search::Policy;
use crate::search::SEARCHING;
use crate::search::trials::interval;
use crate::statistics::levels::{HALF, PART};
use crate::statistics::linear::solve;
use crate::text::brief;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// What process noise says.
#[derive(Debug, Clone)]
pub struct Residual {
    /// Deviance that process noise or an unlisted input gains over none.
    pub evidence: f64,
    /// Deviance without either.
    pub none: f64,
    /// Noises with the unlisted input, where that is called for.
    pub unlisted: Option<Noise>,
    /// Which noises are free beside it.
    pub sizes: Sizes,
}

/// Process noise at its floor against free, and against an unlisted input at each equation.
///
/// Beside an unlisted input no equation has process noise of its own, unless that is needed, too: white noise of a state
/// that forgets within a row and the noise of its sensor are nearly the same, and free together one takes the other's part.
pub fn judge_residual(engine: &Engine, fit: &Fit, sizes: &Sizes, policy: &Policy) -> Residual {
    let columns: Vec<usize> = (0..fit.free.len()).collect();
    let order = engine.machine.order();
    let exact = sizes.with_pinned(vec![true; order]);
    let none = exact.quieted(Noise { disturbance: None, ..fit.at.noise.clone() });
    let without = maximise(&fit.runs, &columns, &none, &exact).1;
    let row = interval(engine);
    let tried: Vec<(usize, f64)> = (0..order)
        .flat_map(|equation| GENERAL.memories[..2].iter().map(move |memory| (equation, memory * row)))
        .collect();
    let best = tried
        .par_iter()
        .map(|(equation, memory)| {
            let size = fit.at.noise.process[*equation].max(GENERAL.above_least * sizes.process[*equation].0)
                / memory.sqrt();
            let disturbance = Some(Disturbance { equation: *equation, size, memory: *memory });
            maximise(&fit.runs, &columns, &Noise { disturbance, ..none.clone() }, &exact)
        })
        .collect::<Vec<_>>()
        .into_iter()
        .chain(fit.at.noise.disturbance.map(|_| maximise(&fit.runs, &columns, &fit.at.noise, sizes)))
        .min_by(|a, b| a.1.total_cmp(&b.1));
    let white = fit.deviance;
    let Some((noise, with)) = best else {
        return Residual { evidence: without - white, none: without, unlisted: None, sizes: exact };
    };
    let (noise, with, own) = freed(engine, fit, exact, (noise, with), policy);
    let evidence = without - with.min(white);
    let mut of_something_else = evidence;
    if evidence > policy.unknown
        && let Some(explained) = noisy_inputs::deviance(engine, fit, &none, sizes)
    {
        of_something_else = evidence.min(explained - with.min(white));
    }
    Residual {
        evidence,
        none: without,
        unlisted: Some(noise).filter(|_| of_something_else > policy.unknown),
        sizes: own,
    }
}

/// Frees the process noise of one equation after the other, as long as that gains as much as a name must.
fn freed(
    engine: &Engine,
    fit: &Fit,
    mut sizes: Sizes,
    (mut noise, mut deviance): (Noise, f64),
    policy: &Policy,
) -> (Noise, f64, Sizes) {
    let columns: Vec<usize> = (0..fit.free.len()).collect();
    loop {
        let pinned: Vec<usize> = (0..engine.machine.order()).filter(|one| sizes.is_pinned(*one)).collect();
        let tried: Vec<(Noise, f64, Sizes)> = pinned
            .par_iter()
            .map(|equation| {
                let mut left = sizes.pinned.clone();
                left[*equation] = false;
                let own = sizes.with_pinned(left);
                let mut begun = noise.clone();
                let least = GENERAL.above_least * sizes.process[*equation].0;
                begun.process[*equation] = fit.at.noise.process[*equation].max(least);
                let (noise, deviance) = maximise(&fit.runs, &columns, &begun, &own);
                (noise, deviance, own)
            })
            .collect();
        match tried.into_iter().min_by(|a, b| a.1.total_cmp(&b.1)) {
            Some(best) if deviance - best.1 > policy.sure => (noise, deviance, sizes) = best,
            _ => return (noise, deviance, sizes),
        }
    }
}

/// What is left without a name, if there is something.
pub fn unknown(problem: &Problem, studied: &Studied) -> Option<Unknown> {
    let noise = studied.residual.unlisted.as_ref()?;
    let unlisted = noise.disturbance?;
    if !problem.ports.unknown_inputs {
        return Some(unasked(studied.residual.evidence));
    }
    let engine = &studied.built.engine;
    let courses: Vec<Vec<f64>> =
        studied.fit.runs.par_iter().map(|run| smooth(run, noise).disturbance).collect();
    let course: Vec<f64> = courses.iter().flatten().copied().collect();
    let state = &engine.machine.states[unlisted.equation];
    let unit = unit_of(problem, &state.name);
    let (depends_on, shape) = follows(engine, studied, &course);
    let along = || engine.grids.iter().zip(&courses);
    let by_run: Vec<Course<'_>> =
        along().map(|(grid, value)| Course { run: &grid.name, time: &grid.time, value }).collect();
    let shape = match events(&by_run) {
        Some(text) if depends_on.is_empty() => text,
        _ => shape,
    };
    let traces: Vec<RunTrace> = along()
        .map(|(grid, course)| RunTrace {
            run: grid.name.clone(),
            trace: grid.time.iter().zip(course).map(|(time, value)| [*time, *value]).collect(),
        })
        .collect();
    Some(Unknown {
        signal: if engine.machine.whole {
            format!("what {} shows beyond the model", state.name)
        } else {
            format!("the equation of {}", state.name)
        },
        depends_on,
        shape,
        nearest: format!(
            "an unlisted input there gains {:.0} of deviance over none, which no candidate takes away",
            studied.residual.evidence
        ),
        trace: traces.first().map_or_else(Vec::new, |first| first.trace.clone()),
        traces,
        unit: format!("{unit}/s"),
    })
}

/// What has no name, and where time was up before all that is listed was tried, that it may have one.
pub(super) fn as_far_as_searched(unknown: Unknown, is_cut_short: bool) -> Unknown {
    match is_cut_short {
        true => Unknown {
            shape: format!("as far as the search came before time was up: {}", unknown.shape),
            ..unknown
        },
        false => unknown,
    }
}

/// What has no name where nobody asked for an unlisted input, though process noise gains so much deviance.
fn unasked(evidence: f64) -> Unknown {
    Unknown {
        signal: "the whole model".into(),
        shape: "nobody asked where: [ports] unknown_inputs = false".into(),
        nearest: format!("process noise gains {evidence:.0} of deviance, which no candidate takes away"),
        ..Unknown::default()
    }
}

/// What the variable of a channel, or one that shows a state, is measured in.
fn unit_of(problem: &Problem, name: &str) -> String {
    let channel = problem.channels.iter().find(|channel| channel.name == name);
    let of = |id| problem.model.variable(id).unit.clone();
    let found = channel.map(|channel| channel.variable).or_else(|| {
        problem.states.iter().filter_map(|state| state.shows).find(|shown| problem.model.name(*shown) == name)
    });
    // a state that no variable shows has the name of its start
    let start =
        || problem.states.iter().map(|state| state.start).find(|start| problem.model.name(*start) == name);
    found.or_else(start).and_then(of).unwrap_or_else(|| "1".into())
}

/// A term that a course may follow: name of the variable, words, columns.
type Term = (String, String, Vec<Vec<f64>>);

/// Whether a variable of this unit may be an angle in rad.
fn is_angle(unit: &str) -> bool {
    matches!(unit, "rad" | "")
}

/// Waves in a turn that a course of an angle may follow, which turned through so much, rad: half a wave at least.
fn waves(turned: f64) -> impl Iterator<Item = usize> {
    (1..=GENERAL.waves).filter(move |waves| *waves as f64 * turned > std::f64::consts::PI && turned < 1e3)
}

/// Where laws of a variable between these values begin, and what to say of that: where it hardly moves beside how large it is, as the pressure of the
/// air, in the middle. There its powers about 0 are all the same.
fn origin(low: f64, high: f64) -> (f64, String) {
    let middle = HALF * (low + high);
    if high - low < PART * middle.abs() {
        (middle, format!(" about {}", brief(middle)))
    } else {
        (0.0, String::new())
    }
}

fn terms(engine: &Engine, studied: &Studied) -> Vec<Term> {
    let n = engine.machine.order();
    // name, values, and whether it may be an angle, which alone goes round
    let mut plain: Vec<(String, Vec<f64>, bool)> = Vec::new();
    let states = if engine.machine.whole { &[][..] } else { &engine.machine.states[..] };
    for (place, state) in states.iter().enumerate() {
        let values = studied.fit.at.paths.iter().flat_map(|path| path.chunks(n).map(move |row| row[place]));
        let unit = state.channel.map(|channel| engine.machine.channels[channel].unit.as_str());
        plain.push((state.name.clone(), values.collect(), unit.is_some_and(is_angle)));
    }
    let schedules: Vec<crate::dynamics::schedule::Schedule> = (engine.grids.iter())
        .map(|grid| crate::dynamics::schedule::Schedule::new(&engine.machine, grid, &studied.fit.at.theta))
        .collect();
    let logged = engine.machine.inputs.iter().enumerate().filter(|(_, input)| input.channel.is_some());
    for (place, input) in logged {
        let values = schedules.iter().flat_map(|s| s.at_row.chunks(s.width).map(move |row| row[place]));
        plain.push((input.name.clone(), values.collect(), is_angle(&input.unit)));
    }
    let time: Vec<f64> =
        engine.grids.iter().flat_map(|grid| grid.time.iter().map(|t| t - grid.origin)).collect();
    let mut list = Vec::new();
    for (name, values, is_angle) in &plain {
        let (low, high) =
            values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (v.min(l), v.max(h)));
        let (from, about) = origin(low, high);
        let size = (high - from).abs().max((low - from).abs()).max(1e-300);
        let mut term = |words: &str, of: &dyn Fn(f64) -> f64| {
            list.push((
                name.clone(),
                format!("{words} {name}{about}"),
                vec![values.iter().map(|v| of((v - from) / size)).collect::<Vec<f64>>()],
            ));
        };
        term("linear in", &|v| v);
        term("like the sign of", &|v| libm::tanh(20.0 * v));
        term("quadratic in", &|v| v * v);
        term("cubic in", &|v| v * v * v);
        term("like the signed square of", &|v| v * v.abs());
        // an angle that turns through more than half a wave
        let turned = if *is_angle { high - low } else { 0.0 };
        for waves in waves(turned) {
            let wave =
                |of: fn(f64) -> f64| -> Vec<f64> { values.iter().map(|v| of(waves as f64 * v)).collect() };
            let words = format!("a wave of {waves} periods in 2π of {name}");
            list.push((name.clone(), words, vec![wave(libm::sin), wave(libm::cos)]));
        }
    }
    list.push(("time".into(), "growing with time".into(), vec![time]));
    list
}

/// Names in the order in which they come first.
fn each_once<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut once: Vec<String> = Vec::new();
    for name in names {
        if !once.iter().any(|known| known == name) {
            once.push(name.to_owned());
        }
    }
    once
}

/// Forward selection over the terms: what the course depends on, and how.
pub(super) fn follows(engine: &Engine, studied: &Studied, course: &[f64]) -> (Vec<String>, String) {
    let terms = terms(engine, studied);
    let mean = course.iter().sum::<f64>() / course.len().max(1) as f64;
    let whole: f64 = course.iter().map(|v| (v - mean) * (v - mean)).sum();
    let constant = vec![1.0; course.len()];
    let left = |chosen: &[usize]| {
        let columns: Vec<&Vec<f64>> =
            std::iter::once(&constant).chain(chosen.iter().flat_map(|t| &terms[*t].2)).collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let gram = DMatrix::from_fn(columns.len(), columns.len(), |i, j| dot(columns[i], columns[j]));
        let score = DVector::from_fn(columns.len(), |i, _| dot(columns[i], course));
        solve(&gram, &score).map_or(f64::INFINITY, |shift| dot(course, course) - shift.dot(&score))
    };
    let (mut chosen, mut square) = (Vec::new(), whole);
    while chosen.len() < SEARCHING.terms {
        let best = (0..terms.len())
            .filter(|term| !chosen.contains(term))
            .map(|term| {
                let mut with: Vec<usize> = chosen.clone();
                with.push(term);
                (left(&with), term)
            })
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((after, term)) = best else { break };
        let needed = if chosen.is_empty() { SEARCHING.follows } else { SEARCHING.further };
        if square - after < needed * whole {
            break;
        }
        chosen.push(term);
        square = after;
    }
    if chosen.is_empty() {
        return (Vec::new(), "it follows no state, no input and no time".into());
    }
    let names = each_once(chosen.iter().map(|term| terms[*term].0.as_str()));
    let words: Vec<String> = chosen.iter().map(|term| terms[*term].1.clone()).collect();
    let share = 100.0 * (1.0 - square / whole);
    (names, format!("{}; that explains {share:.0} % of its variance", words.join(", then ")))
}

#[cfg(test)]
mod tests {
    use super::{GENERAL, Unknown, as_far_as_searched, each_once, origin, waves};

    #[test]
    fn law_what_a_search_that_was_cut_short_leaves_is_told_as_that() {
        let told = |is_cut_short| {
            let left = Unknown { shape: "linear in x".into(), signal: "x".into(), ..Unknown::default() };
            as_far_as_searched(left, is_cut_short)
        };
        assert_eq!(told(false).shape, "linear in x");
        let cut = told(true);
        assert_eq!(cut.shape, "as far as the search came before time was up: linear in x");
        assert_eq!(cut.signal, "x");
    }

    #[test]
    fn value_laws_of_what_hardly_moves_begin_in_its_middle() {
        assert_eq!(origin(101_324.0, 101_326.0), (101_325.0, " about 101325".into()));
        assert_eq!([origin(10.0, 14.0), origin(-1.0, 1.0)], [(0.0, String::new()), (0.0, String::new())]);
        assert_eq!(origin(-12.0, -10.0).0, -11.0);
    }

    #[test]
    fn every_variable_of_several_terms_is_told_once() {
        // linear in x, linear in u, cubic in x
        assert_eq!(each_once(["x", "u", "x"].into_iter()), ["x", "u"]);
    }

    #[test]
    fn value_any_memory_from_a_row_to_a_long_log_is_near_one_to_begin_with() {
        // the likelihood leads to a correlation time from within half a decade or so; from farther it ends where noise is white, or constant
        for decade in 0..=36 {
            let memory = 10f64.powf(0.1 * f64::from(decade));
            let away = |begun: &f64| f64::max(memory / begun, begun / memory);
            let nearest = GENERAL.memories.iter().map(away).fold(f64::INFINITY, f64::min);
            assert!(nearest <= 5.0 * (1.0 + 1e-9), "{memory:.1} rows: the nearest is {nearest:.1} times off");
        }
    }

    #[test]
    fn value_waves_of_an_angle_that_are_tried() {
        // cogging of a motor with eight poles in 24 slots has 24 waves in a turn; of more an encoder or a belt is as likely
        let list: Vec<usize> = waves(3.0 * std::f64::consts::TAU).collect();
        assert!(list.contains(&1) && list.contains(&24) && list.iter().all(|waves| *waves <= 26));
        // a quarter turn shows half a wave of two in a turn, and more of more
        assert_eq!(waves(0.51 * std::f64::consts::PI).next(), Some(2));
        assert_eq!(waves(1e4).count(), 0, "what turns so far is no angle");
    }
}
