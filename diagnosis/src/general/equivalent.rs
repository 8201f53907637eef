//! The unlisted input as one more signal at a declared input, so that the amended scenario replays the log.
//!
//! No master can add to an equation inside a unit, but to an input it can. d(k) is added to the input over each interval, a
//! Gauss-Markov process like the unlisted input itself, and one more state: x(k+1) = F(x, u + d), d(k+1) = e^(-Δt/τ) d(k) + w.
//! Its column is the one of a bias of that input. Of all inputs the likeliest is taken, if it does nearly as much as the unlisted
//! input at its equation does; about its smoothed course the run is linearised anew.

use super::policy::GENERAL;
use super::study::Studied;
use crate::dynamics::Engine;
use crate::dynamics::grid::{Course, Grid};
use crate::dynamics::linearise::Chord;
use crate::dynamics::machine::{Parameter, Role};
use crate::dynamics::schedule::input_effects;
use crate::error::Error;
use crate::infer::fit::Path;
use crate::infer::likelihood::maximise;
use crate::infer::{Linearised, Noise, Sizes, first_process_noise, smooth};
use crate::observe::{Hold, InputEffect, Scale};
use crate::ports::input::Effects;
use crate::search::trials::interval;
use crate::statistics::levels::FINE;
use orchestrator::Kind;

/// The unlisted input at a declared one.
#[derive(Debug, Clone)]
pub struct Equivalent {
    /// Place among the machine's inputs.
    pub input: usize,
    /// The first run with the course added to that input.
    pub grid: Grid,
    /// Its first state.
    pub start: Vec<f64>,
}

/// What was found, and what a reader should know of it.
///
/// # Errors
/// A unit failed.
pub fn equivalent(
    studied: &Studied,
    driven: &dyn Fn(&str) -> bool,
) -> Result<(Option<Equivalent>, Option<String>), Error> {
    let Some(noise) = &studied.residual.unlisted else { return Ok((None, None)) };
    if studied.built.engine.machine.whole {
        let text =
            "the model can't be started within a run: the amended scenario leaves the unlisted input out";
        return Ok((None, Some(text.into())));
    }
    if !crate::dynamics::plain(&studied.built.engine.machine, &studied.fit.at.theta) {
        return Ok((
            None,
            Some("an input or a sensor lags: the amended scenario leaves the unlisted input out".into()),
        ));
    }
    let own = &studied.built.engine;
    let inputs = free_inputs(studied, driven);
    if inputs.is_empty() {
        let text = "no declared input is free to carry the unlisted one: the amended scenario leaves it out";
        return Ok((None, Some(text.into())));
    }
    let (engine, theta, chords) = biased(own, &studied.fit.at.theta, &inputs);
    let runs = engine.chords(&theta, &studied.fit.at.paths, &chords)?;
    let Some((deviance, place, memory, noise)) = likeliest(studied, &runs, &inputs, noise) else {
        return Ok((None, None));
    };
    let name = &own.machine.inputs[inputs[place]].name;
    let share = (studied.residual.none - deviance) / studied.residual.evidence;
    if !stands_for(share) {
        let text = format!(
            "no declared input does what the unlisted one did (the best, {name}, gains {:.0} % of its deviance): the amended \
             scenario leaves it out",
            100.0 * share.max(0.0)
        );
        return Ok((None, Some(text)));
    }
    let found = follow_course(&engine, studied, &theta, (inputs[place], chords[place], memory), &noise)?;
    let text = format!(
        "the amended scenario adds the unlisted input to {name}, which gains {:.0} % of its deviance; its course is part of \
         {}",
        100.0 * share,
        super::table::INPUTS
    );
    let (grid, start) = found;
    Ok((Some(Equivalent { input: inputs[place], grid, start }), Some(text)))
}

/// Inputs that can carry a course: real, fed by a log or by nobody knows what, with no effect and no other unit before them.
fn free_inputs(studied: &Studied, driven: &dyn Fn(&str) -> bool) -> Vec<usize> {
    let machine = &studied.built.engine.machine;
    let effects = input_effects(machine, &studied.fit.at.theta);
    let fits = |input: &usize| {
        let one = &machine.inputs[*input];
        let fed = one.channel.is_some() || one.open;
        fed && one.variable.kind == Kind::Real && effects[*input] == Effects::OFF && !driven(&one.name)
    };
    (0..machine.inputs.len()).filter(fits).collect()
}

/// The likeliest course at one of these inputs, of runs with a column for a bias of each: deviance, place among the inputs, memory in s, and
/// noises.
fn likeliest(
    studied: &Studied,
    runs: &[Linearised],
    inputs: &[usize],
    noise: &Noise,
) -> Option<(f64, usize, f64, Noise)> {
    let engine = &studied.built.engine;
    let row = interval(engine);
    let tries = (0..inputs.len()).flat_map(|place| GENERAL.memories.map(|memory| (place, memory * row)));
    let tried = tries.map(|(place, memory)| {
        let size = engine.input_scales[inputs[place]];
        let wide: Vec<Linearised> =
            runs.iter().map(|run| augmented(run, place, memory, size, None)).collect();
        let (sizes, first) = first_noises(studied, noise, size, row);
        let (noise, deviance) = maximise(&wide, &[], &first, &sizes);
        (deviance, place, memory, noise)
    });
    tried.min_by(|a, b| a.0.total_cmp(&b.0))
}

/// Whether an input that gains this share of the unlisted one's deviance does what that did.
fn stands_for(share: f64) -> bool {
    share >= GENERAL.stands_for
}

/// The engine with a bias of each of these inputs as a further parameter.
fn biased(own: &Engine, theta: &[f64], inputs: &[usize]) -> (Engine, Vec<f64>, Vec<Chord>) {
    let mut machine = own.machine.clone();
    let (mut theta, mut chords) = (theta.to_vec(), Vec::new());
    for input in inputs {
        let step = FINE * own.input_scales[*input];
        chords.push(Chord { parameter: machine.parameters.len(), to: step, per: step });
        machine.parameters.push(Parameter {
            name: String::new(),
            phrase: String::new(),
            neutral: 0.0,
            range: (f64::NEG_INFINITY, f64::INFINITY),
            scale: Scale::Absolute,
            role: Role::Input(*input, InputEffect::Bias),
        });
        theta.push(0.0);
    }
    (own.with_runs(machine, own.grids.clone()), theta, chords)
}

/// Noises beside a course at an input: no equation has process noise but the course.
fn first_noises(studied: &Studied, noise: &Noise, size: f64, row: f64) -> (Sizes, Noise) {
    let mut sizes = studied.residual.sizes.clone();
    let span = studied.built.engine.grids.iter().map(Grid::span).fold(row, f64::max);
    sizes.pinned = vec![true; sizes.process.len()];
    let mut begun = sizes.quieted(Noise { disturbance: None, ..noise.clone() });
    sizes.process.push((1e-6 * size / span.sqrt(), 1e2 * size / row.sqrt()));
    sizes.pinned.push(false);
    begun.process.push(first_process_noise(size, row));
    (sizes, begun)
}

/// A run with the course as one more state; `around` is where it is.
fn augmented(run: &Linearised, column: usize, memory: f64, size: f64, around: Option<&[f64]>) -> Linearised {
    let (n, p, rows) = (run.states, run.parameters, run.rows());
    let mut out = Linearised {
        states: n + 1,
        parameters: 0,
        transition: Vec::with_capacity((rows - 1) * (n + 1) * (n + 1)),
        defect: Vec::with_capacity((rows - 1) * (n + 1)),
        observe: Vec::with_capacity(run.measured.len() * (n + 1)),
        drive: Vec::new(),
        direct: Vec::new(),
        ..run.clone()
    };
    for row in 0..rows - 1 {
        let keeps = libm::exp(-run.interval(row) / memory);
        let along = run.column(row, column);
        for (i, by) in along.iter().enumerate() {
            out.transition.extend_from_slice(&run.transition[(row * n + i) * n..(row * n + i + 1) * n]);
            out.transition.push(*by);
        }
        out.transition.extend((0..n).map(|_| 0.0));
        out.transition.push(keeps);
        out.defect.extend_from_slice(&run.defect[row * n..(row + 1) * n]);
        out.defect.push(around.map_or(0.0, |around| keeps * around[row] - around[row + 1]));
    }
    for value in 0..run.measured.len() {
        out.observe.extend_from_slice(&run.observe[value * n..(value + 1) * n]);
        out.observe.push(run.direct[value * p + column]);
    }
    out.start.0.push(around.map_or(0.0, |around| -around[0]));
    out.start.1.push(size);
    out
}

/// The first run about the course, until it has settled: its grid with the course, and its first state.
fn follow_course(
    engine: &Engine,
    studied: &Studied,
    theta: &[f64],
    (input, chord, memory): (usize, Chord, f64),
    noise: &Noise,
) -> Result<(Grid, Vec<f64>), Error> {
    let n = engine.machine.order();
    let first = &engine.grids[0];
    let size = engine.input_scales[input];
    let mut path: Path = studied.fit.at.paths[0].clone();
    let mut course = vec![0.0; first.time.len()];
    let mut held = course.clone();
    for _ in 0..GENERAL.linearisations {
        let about = engine.with_runs(engine.machine.clone(), vec![with_course(first, input, &course)]);
        let run = about.run(0, theta, &path, &[chord])?;
        let smoothed = smooth(&augmented(&run, 0, memory, size, Some(&course)), noise);
        for (row, moved) in smoothed.state.chunks(n + 1).enumerate() {
            path[row * n..(row + 1) * n].iter_mut().zip(moved).for_each(|(state, by)| *state += by);
            course[row] += moved[n];
        }
        held.clone_from(&course);
        // what the course gains within an interval acts for half of it
        for (row, pushed) in smoothed.process.chunks(n + 1).enumerate() {
            held[row] += 0.5 * (first.time[row + 1] - first.time[row]) * pushed[n];
        }
    }
    Ok((with_course(first, input, &held), path[..n].to_vec()))
}

/// A run with values at its rows, each held to the next, added to an input.
fn with_course(grid: &Grid, input: usize, added: &[f64]) -> Grid {
    let own = &grid.inputs[input];
    let mut time: Vec<f64> = own.time.iter().chain(&grid.time).copied().collect();
    time.sort_by(f64::total_cmp);
    time.dedup();
    let more = Course { time: grid.time.clone(), values: added.to_vec(), hold: Hold::Zero };
    let from = grid.time[0];
    let value = |t: f64| own.value(t) + if t < from { 0.0 } else { more.value(t) };
    let values = time.iter().map(|t| value(*t)).collect();
    let mut grid = grid.clone();
    grid.inputs[input] = Course { time, values, hold: own.hold };
    grid
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_a_course_is_added_from_row_to_row() {
        let logged = Course { time: vec![0.0, 1.5], values: vec![1.0, 3.0], hold: Hold::Zero };
        let grid = Grid {
            name: "a".into(),
            time: vec![0.0, 1.0, 2.0],
            samples: Vec::new(),
            inputs: vec![logged],
            origin: 0.0,
            begin: Vec::new(),
            lost: Vec::new(),
        };
        let sum = with_course(&grid, 0, &[10.0, 20.0, 0.0]);
        assert_eq!(sum.inputs[0].time, [0.0, 1.0, 1.5, 2.0]);
        assert_eq!(sum.inputs[0].values, [11.0, 21.0, 23.0, 3.0]);
    }

    #[test]
    fn value_an_input_stands_for_another_that_does_most_of_it() {
        // less than half: another input, or another equation, does as much
        assert!(!stands_for(0.45) && stands_for(0.55));
    }
}
