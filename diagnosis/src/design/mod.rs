//! The next experiment: inputs within their declared range that would tell the members of an open class apart.
//!
//! - `waves.rs`: holds, steps, sines, chirps
//! - `policy.rs`: the numbers that decide, with their reasons
//! - here: each is screened by the Fisher information of the model: of one member's effect, what no other member, no effect
//!   found and no start state does as well. The best are then simulated with each member as the truth and fitted with the others.

mod policy;
mod waves;

use crate::diagnosis::{NextExperiment, Separation};
use crate::dynamics::Engine;
use crate::dynamics::grid::{Course, Grid, Sample};
use crate::dynamics::linearise::Chord;
use crate::dynamics::schedule::{Schedule, output_effects};
use crate::dynamics::worker::Job;
use crate::error::Error;
use crate::infer::Noise;
use crate::infer::fit::{At, Options, fit};
use crate::infer::likelihood::reduced;
use crate::observe::{Hold, Problem, Scale};
use crate::planned::{self, Planned, Predicted};
use crate::search::class::Alternative;
use crate::statistics::levels::SLIGHT;
use crate::statistics::linear::{inverse, submatrix};
use orchestrator::scenario::{Shape, SignalEntry, SourceEntry};
use orchestrator::{Place, Simulation, UnitPath};
pub(crate) use policy::EXPERIMENTS;
use rayon::prelude::*;
use waves::{Wave, brief, waves};

/// What was found: the engine that found it, all parameters, noises, and the open class.
pub struct Question<'a> {
    /// Engine.
    pub engine: &'a Engine,
    /// Parameters as fitted.
    pub theta: &'a [f64],
    /// Noises as fitted.
    pub noise: &'a Noise,
    /// The effect whose class is open.
    pub own: usize,
    /// All effects.
    pub effects: &'a [usize],
    /// The class with values, the best guess first.
    pub class: Vec<Alternative>,
}

/// The best experiment, and the scenario that runs it with the nominal model, where that is one unit alone.
pub type Proposal = (NextExperiment, Option<String>);
/// File that the scenario is written to.
const FILE: &str = "next_experiment.toml";

impl Question<'_> {
    fn name(&self, member: &Alternative) -> String {
        self.engine.machine.parameters[member.parameter].name.clone()
    }

    /// All parameters with one member in the effect's place.
    fn with_member(&self, member: Option<&Alternative>) -> Vec<f64> {
        let mut theta = self.theta.to_vec();
        for place in self.class.iter().map(|one| one.parameter).chain([self.own]) {
            if place == self.own || !self.effects.contains(&place) {
                theta[place] = self.engine.machine.parameters[place].neutral;
            }
        }
        if let Some(member) = member {
            theta[member.parameter] = member.value;
        }
        theta
    }

    /// The noises without the unlisted input, which no experiment has.
    fn noise(&self) -> Noise {
        Noise { disturbance: None, ..self.noise.clone() }
    }
}

/// Looks for an experiment that tells a class apart; nothing where no input can be driven.
pub fn next(problem: &Problem, question: &Question<'_>, units: &UnitPath) -> Option<Proposal> {
    let mut question = Question { class: question.class.clone(), ..*question };
    question.class.truncate(EXPERIMENTS.members);
    let engine = question.engine;
    let longest = engine.grids.iter().map(|grid| &grid.time).max_by_key(|time| time.len())?;
    let waves: Vec<Wave> = times(longest).iter().flat_map(|time| waves(problem, engine, time)).collect();
    let tried: Vec<(usize, Losses)> = finalists(&question, &waves)
        .par_iter()
        .filter_map(|place| Some((*place, losses(&question, &waves[*place]).ok()?)))
        .collect();
    let tried = ranked(tried);
    let (best, losses) = tried.first()?;
    let names: Vec<String> = question.class.iter().map(|member| question.name(member)).collect();
    let named = |places: &[usize]| places.iter().map(|place| names[*place].clone()).collect::<Vec<_>>();
    let separation = tried.iter().map(|(place, losses)| {
        let (a, b, loss) = hardest_pair(losses);
        Separation {
            experiment: waves[*place].what.clone(),
            loss: Some(loss),
            pair: named(&[a, b]),
            certainty: None,
            problem: None,
        }
    });
    let (one, other, loss) = hardest_pair(losses);
    let separates = told_apart(losses);
    // what tells nobody from anybody is worth no day in a lab
    let worth = !separates.is_empty() || loss >= SLIGHT * EXPERIMENTS.told;
    let scenario = scenario(problem, engine, &waves[*best], units).filter(|_| worth);
    let next = NextExperiment {
        what: words(&waves[*best].what, loss, [&names[one], &names[other]], worth),
        separates: named(&separates),
        scenario: scenario.as_ref().map(|_| FILE.to_owned()),
        leaves_open: pairs_left_open(losses).into_iter().map(|(a, b)| named(&[a, b])).collect(),
        separation: separation.collect(),
        told: EXPERIMENTS.told,
        planned: planned(&question, &waves[*best]).ok().filter(|_| worth),
    };
    Some((next, scenario))
}

/// The experiment in words, and what it is worth for the two that are hardest to tell apart.
fn words(wave: &str, loss: f64, [one, other]: [&String; 2], worth: bool) -> String {
    if !worth {
        return format!(
            "nothing that can be driven here tells {one} and {other} apart. Measure another variable, or strike out one of them. \
             The best that was simulated was to {wave}: there, too, one name does as well as the other"
        );
    }
    let told = if loss < SLIGHT * EXPERIMENTS.told { "0".to_owned() } else { brief(loss) };
    let then = match loss {
        _ if loss >= EXPERIMENTS.told => String::new(),
        _ if loss < SLIGHT * EXPERIMENTS.told => format!(
            ": nothing that can be driven here tells {one} and {other} apart. Measure another variable, or strike out one of them"
        ),
        _ => format!(
            ", too little to tell {one} and {other} apart: record so many runs of it that this comes to {}",
            brief(EXPERIMENTS.told)
        ),
    };
    format!("{wave}; start it at rest. One name for another would lose {told} of deviance there{then}")
}

/// The waves of each length that the model's Fisher information says tell most, the best first.
fn finalists(question: &Question<'_>, waves: &[Wave]) -> Vec<usize> {
    let screened: Vec<Option<f64>> = waves.par_iter().map(|wave| screen(question, wave).ok()).collect();
    let mut order: Vec<usize> = (0..waves.len()).filter(|wave| screened[*wave].is_some()).collect();
    // stable: of equal ones the simplest comes first
    order.sort_by(|a, b| screened[*b].unwrap_or(0.0).total_cmp(&screened[*a].unwrap_or(0.0)));
    // far from where it was linearised a long one may tell nothing: some of each length
    let of_its_length = |(at, place): &(usize, &usize)| {
        let before = order[..*at].iter().filter(|other| waves[**other].time == waves[**place].time);
        before.count() < EXPERIMENTS.finalists
    };
    order.iter().enumerate().filter(of_its_length).map(|(_, place)| *place).collect()
}

/// When rows would be: as in the longest log while they last, and spread over all of it. What is slow needs the one, a delay below the
/// distance of the others the other.
fn times(longest: &[f64]) -> Vec<Vec<f64>> {
    let each = longest.len().div_ceil(EXPERIMENTS.rows).max(1);
    let begin = longest[..longest.len().min(EXPERIMENTS.rows)].to_vec();
    let spread = longest.iter().copied().step_by(each).collect();
    if each > 1 { vec![spread, begin] } else { vec![begin] }
}

/// What is driven, and what each member would give.
fn planned(question: &Question<'_>, wave: &Wave) -> Result<Planned, Error> {
    let (machine, time) = (&question.engine.machine, &wave.time);
    let since = |rows: &[f64], values: &[f64]| -> Vec<(f64, f64)> {
        rows.iter().zip(values).map(|(t, value)| (t - time[0], *value)).collect()
    };
    let inputs = machine.inputs.iter().zip(&wave.values).map(|(input, values)| planned::Course {
        name: input.name.clone(),
        unit: input.unit.clone(),
        points: since(time, values),
    });
    let mut outputs: Vec<Predicted> = (machine.channels.iter().zip(&question.noise.channels))
        .map(|(output, noise)| Predicted {
            name: output.name.clone(),
            unit: output.unit.clone(),
            noise: Some(*noise),
            members: Vec::new(),
        })
        .collect();
    for member in &question.class {
        let engine = simulated(question, wave, &question.with_member(Some(member)))?;
        for (channel, output) in outputs.iter_mut().enumerate() {
            let own = engine.grids[0].samples.iter().filter(|sample| sample.channel == channel);
            let (rows, values): (Vec<f64>, Vec<f64>) = own.map(|sample| (sample.time, sample.value)).unzip();
            output.members.push((question.name(member), since(&rows, &values)));
        }
    }
    Ok(Planned { inputs: inputs.collect(), outputs })
}

/// The nominal model under the experiment.
fn scenario(problem: &Problem, engine: &Engine, wave: &Wave, units: &UnitPath) -> Option<String> {
    let time = &wave.time;
    let mut scenario = problem.model.scenario.clone();
    if !(scenario.connections.is_empty() && scenario.sources.is_empty() && scenario.units.len() == 1) {
        return None;
    }
    scenario.set_stop(&format!("{:.6}", time[time.len() - 1] - time[0])).ok()?;
    // a source is read at the end of a step and held over it
    let late = 0.5 * scenario.units[0].interval.to_f64();
    for (input, values) in engine.machine.inputs.iter().zip(&wave.values) {
        let points = time.iter().map(|t| t - time[0] + late).zip(values.iter().copied()).collect();
        let shape = if input.hold == Hold::Linear { Shape::Linear } else { Shape::Hold };
        scenario.sources.push(SourceEntry {
            to: input.name.clone(),
            signal: SignalEntry::Table { shape, points },
            place: Place::Override(input.name.clone()),
        });
    }
    Some(Simulation::new(&scenario, units).ok()?.resolved())
}

/// Deviance lost by taking one member (the second place) where another (the first) is true.
type Losses = Vec<Vec<f64>>;

/// Members that this leaves open, each beside another.
fn pairs_left_open(losses: &Losses) -> Vec<(usize, usize)> {
    let pairs = (0..losses.len()).flat_map(|a| (a + 1..losses.len()).map(move |b| (a, b)));
    pairs.filter(|(a, b)| losses[*a][*b].min(losses[*b][*a]) < EXPERIMENTS.told).collect()
}

/// Members that this tells from at least one other.
fn told_apart(losses: &Losses) -> Vec<usize> {
    let open = pairs_left_open(losses);
    let told = |a: usize, b: usize| a != b && !open.contains(&(a.min(b), a.max(b)));
    (0..losses.len()).filter(|a| (0..losses.len()).any(|b| told(*a, b))).collect()
}

/// The pair that is hardest to tell apart: places of both, and the smaller of the deviances that one for the other loses.
fn hardest_pair(losses: &Losses) -> (usize, usize, f64) {
    let pairs = (0..losses.len()).flat_map(|a| (a + 1..losses.len()).map(move |b| (a, b)));
    pairs
        .map(|(a, b)| (a, b, losses[a][b].min(losses[b][a])))
        .min_by(|a, b| a.2.total_cmp(&b.2))
        .unwrap_or((0, 0, 0.0))
}

/// The best first: what it loses for the pair that is hardest. Of equal ones the simplest.
fn ranked(mut tried: Vec<(usize, Losses)>) -> Vec<(usize, Losses)> {
    tried.sort_by(|a, b| hardest_pair(&b.1).2.total_cmp(&hardest_pair(&a.1).2).then(a.0.cmp(&b.0)));
    tried
}

/// The engine with one run of this experiment, as it would be logged without noise.
fn simulated(question: &Question<'_>, wave: &Wave, theta: &[f64]) -> Result<Engine, Error> {
    let (engine, time) = (question.engine, &wave.time);
    let machine = &engine.machine;
    let inputs = machine.inputs.iter().zip(&wave.values).map(|(input, values)| Course {
        time: time.to_vec(),
        values: values.clone(),
        hold: input.hold,
    });
    // from rest, where the model itself begins
    let own = if machine.whole { &machine.begins } else { &machine.states };
    let begun: Vec<f64> = own.iter().map(|state| state.nominal).collect();
    let mut grid = Grid {
        begin: begun.iter().zip(&engine.grids[0].begin).map(|(value, (_, sd))| (*value, *sd)).collect(),
        name: "next".into(),
        origin: time[0],
        lost: Vec::new(),
        time: time.to_vec(),
        samples: Vec::new(),
        inputs: inputs.collect(),
    };
    let states: Vec<f64> = machine.states.iter().map(|state| state.nominal).collect();
    let schedule = Schedule::new(machine, &grid, theta);
    let set = engine.set(theta);
    let channels = machine.channels.len();
    let mut out = Vec::new();
    engine.with_worker(|worker| {
        let whole = schedule.job(time[0], 0, time.len() - 1, &begun);
        worker.interval(machine, &Job { parameters: &set, each_row: true, reads: &[], ..whole }, &mut out)
    })?;
    let first = machine.order();
    let effects = output_effects(machine, theta);
    for (channel, effect) in effects.iter().enumerate() {
        let values: Vec<f64> = (0..time.len()).map(|row| out[first + row * channels + channel]).collect();
        let sensed = crate::dynamics::sensed(time, &values, effect.delay, effect.lag);
        let samples = time.iter().zip(sensed).map(|(t, value)| Sample {
            channel,
            time: *t,
            value: effect.shown(value, t - time[0]),
        });
        grid.samples.extend(samples);
    }
    grid.samples.sort_by(|a, b| a.time.total_cmp(&b.time).then(a.channel.cmp(&b.channel)));
    let starts = vec![(states, engine.starts[0].1.clone())];
    let outliers = vec![vec![false; grid.samples.len()]];
    Ok(Engine { starts, outliers, ..engine.with_runs(machine.clone(), vec![grid]) })
}

/// By the Fisher information: the least that any member leaves of another.
fn screen(question: &Question<'_>, wave: &Wave) -> Result<f64, Error> {
    let theta = question.with_member(None);
    let engine = simulated(question, wave, &theta)?;
    let noise = question.noise();
    let paths = engine.first_paths(&theta, &noise)?;
    let member = |member: &Alternative| Chord { parameter: member.parameter, to: member.value, per: 1.0 };
    let others: Vec<usize> =
        question.effects.iter().copied().filter(|effect| *effect != question.own).collect();
    let mut chords: Vec<Chord> = question.class.iter().map(member).collect();
    chords.extend(others.iter().map(|effect| engine.local(&theta, *effect)));
    let runs = engine.chords(&theta, &paths, &chords)?;
    let all: Vec<usize> = (0..chords.len()).collect();
    let gram = reduced(&runs, &noise, &all).gram;
    let members = question.class.len();
    let mut least = f64::INFINITY;
    for a in 0..members {
        for b in (0..members).filter(|b| *b != a) {
            let beside: Vec<usize> =
                std::iter::once(b).chain(members..chords.len()).filter(|i| gram[(*i, *i)] > 0.0).collect();
            let explained = inverse(&submatrix(&gram, &beside)).map_or(0.0, |inverse| {
                let row: Vec<f64> = beside.iter().map(|i| gram[(a, *i)]).collect();
                (0..row.len())
                    .flat_map(|i| (0..row.len()).map(move |j| (i, j)))
                    .map(|(i, j)| row[i] * inverse[(i, j)] * row[j])
                    .sum()
            });
            least = least.min(gram[(a, a)] - explained);
        }
    }
    Ok(least)
}

/// Each member as the truth, each other one fitted to it.
fn losses(question: &Question<'_>, wave: &Wave) -> Result<Losses, Error> {
    let noise = question.noise();
    let row = |truth: &Alternative| {
        let theta = question.with_member(Some(truth));
        let engine = simulated(question, wave, &theta)?;
        let paths = engine.first_paths(&theta, &noise)?;
        let fitted = |member: &Alternative| {
            let theta = question.with_member(Some(member));
            let beside = question.effects.iter().copied().filter(|effect| *effect != question.own);
            let free: Vec<usize> = std::iter::once(member.parameter)
                .chain(beside)
                .filter(|place| {
                    !matches!(engine.machine.parameters[*place].scale, Scale::Switch | Scale::Count)
                })
                .collect();
            let at = At { theta, paths: paths.clone(), noise: noise.clone() };
            Ok::<f64, Error>(fit(&engine, &at, &free, None, &Options::default())?.deviance)
        };
        let all = question.class.iter().map(fitted).collect::<Result<Vec<f64>, Error>>()?;
        let own = question.class.iter().position(|member| member == truth).map_or(0.0, |place| all[place]);
        Ok(all.iter().map(|deviance| (deviance - own).max(0.0)).collect())
    };
    question.class.iter().map(row).collect()
}

#[cfg(test)]
mod tests;
