//! What a lab could do to tell the members of an open class apart, found by simulating it with each of them.
//!
//! - [`catalogue`]: the experiments, as data.
//! - [`scenario`] and [`motion`]: one of them as a scenario, for this machine and these logs.
//! - [`mod@simulate`]: what a lab would log.
//! - [`cuts`] and [`separation`]: what a diagnosis of that would lose by taking one member for another.
//! - [`choose`]: which is best, in words.
//! - [`loop_of_logs`]: whether the lab's loop is the one that was simulated.

mod catalogue;
mod choose;
mod cuts;
mod loop_of_logs;
mod motion;
mod policy;
mod scenario;
mod separation;
mod simulate;
#[cfg(test)]
mod tests;

use crate::design::EXPERIMENTS;
use crate::diagnosis::{NextExperiment, Separation};
use crate::error::Error;
use crate::planned::{self, Planned, Predicted};
use crate::rigs::acrobot::candidates::{Candidate, Side};
use crate::rigs::acrobot::dataset::{DataSet, Run, Table};
use crate::rigs::acrobot::experiment::policy::DESIGN;
use crate::rigs::acrobot::model::Model;
use crate::rigs::acrobot::residual::Signal;
use crate::rigs::acrobot::selection::{Alternative, CLASS, Study};
use catalogue::{AGAIN, CATALOGUE, Change, Experiment};
use choose::Tried;
use orchestrator::{Simulation, UnitPath};
use scenario::{Logs, Prepared, prepare, refused};
use separation::{Bench, Losses};
use simulate::Simulated;
use std::collections::BTreeMap;

/// File that the scenario is written to.
const FILE: &str = "next_experiment.toml";

/// What one cut of the loop found: the study, its signals, and the classes of its effects.
pub type Found<'a> = (&'a Study, &'a [Signal], &'a [(usize, Vec<Alternative>)]);

/// A survivor.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Member {
    candidate: usize,
    /// Its coordinate in the others' place.
    x: f64,
    /// How probable it is beside the others.
    weight: f64,
}

/// Standard deviations of the signals.
struct Noise {
    stated: BTreeMap<String, f64>,
    seen: BTreeMap<String, f64>,
    /// The runs that were made had encoders.
    encoders: bool,
}

impl Noise {
    /// Standard deviation of a signal in an experiment with or without encoders: without, an angle is one read off the image.
    fn of(&self, name: &str, encoders: bool) -> f64 {
        let read = !encoders && name.starts_with("plant.");
        let stated = self.stated.get(name).filter(|_| !read);
        let seen = self.seen.get(name).filter(|_| encoders == self.encoders || !name.starts_with("plant."));
        let guess = match name.rsplit('.').next().unwrap_or_default() {
            "q1" | "q2" if encoders => DESIGN.encoder,
            "q1" | "q2" => 1e-3,
            "tau_applied" => DESIGN.torque,
            area if area.starts_with("area") => 1.0,
            _ => 0.08,
        };
        match (seen, stated) {
            (Some(seen), Some(stated)) => seen.max(*stated),
            (Some(one), None) | (None, Some(one)) => *one,
            (None, None) => guess,
        }
    }
}

/// The members of a class that are to be told apart, and the machine.
pub struct Question<'a> {
    data: &'a DataSet,
    model: &'a Model,
    list: &'a [Candidate],
    point: &'a [f64],
    members: Vec<Member>,
    noise: Noise,
    discrepancy_sd: f64,
    units: &'a UnitPath,
}

impl Question<'_> {
    fn name(&self, place: usize) -> String {
        self.members.get(place).map_or_else(String::new, |m| self.list[m.candidate].name.to_owned())
    }

    fn weights(&self) -> Vec<f64> {
        self.members.iter().map(|member| member.weight).collect()
    }
}

/// The experiment for the first class that is open, and the text of its scenario.
pub fn next<'a>(
    data: &DataSet,
    model: &Model,
    list: &[Candidate],
    point: &[f64],
    found: impl Iterator<Item = Found<'a>> + Clone,
    units: &UnitPath,
) -> (Option<NextExperiment>, Option<String>) {
    let classes = found.clone().flat_map(|(_, _, classes)| classes);
    let open = classes.map(|(effect, others)| members(*effect, others)).find(|members| members.len() > 1);
    let Some(members) = open else { return (None, None) };
    let signals = found.clone().flat_map(|(study, signals, _)| signals.iter().zip(&study.last.sigmas));
    let noise = Noise {
        stated: data.manifest.noise.iter().filter(|(_, s)| **s > 0.0).map(|(n, s)| (n.clone(), *s)).collect(),
        seen: signals.map(|(signal, sigma)| (signal.name.clone(), *sigma)).collect(),
        encoders: Logs::of(data).encoders,
    };
    let discrepancy_sd = found.map(|(study, _, _)| study.last.discrepancy_sd).fold(0.0, f64::max);
    let question = Question { data, model, list, point, members, noise, discrepancy_sd, units };
    choice(&question)
}

/// The class of an effect, the effect itself first.
fn members(effect: usize, others: &[Alternative]) -> Vec<Member> {
    let own = others.iter().filter(|other| other.candidate == effect);
    let rest = others.iter().filter(|other| other.candidate != effect && other.loss < CLASS);
    let member = |other: &Alternative| Member {
        candidate: other.candidate,
        x: other.x,
        weight: libm::exp(-0.5 * other.loss),
    };
    own.chain(rest).map(member).collect()
}

/// Simulates the whole catalogue with the likeliest member as the truth, and the best few with each; the best of these.
fn choice(question: &Question<'_>) -> (Option<NextExperiment>, Option<String>) {
    let weights = question.weights();
    let likely = (0..weights.len()).max_by(|a, b| weights[*a].total_cmp(&weights[*b])).unwrap_or(0);
    let (mut tried, mut failed) = (Vec::new(), Vec::new());
    let simulated = &mut Simulated::default();
    let foreign = run_in_loop(question, &AGAIN, likely, simulated)
        .and_then(|made| loop_of_logs::beyond_the_logs(&made, question.data));
    for entry in CATALOGUE {
        if let Some(why) = foreign.as_ref().filter(|_| closes_loop(question, entry)) {
            failed.push((entry, why.clone()));
            continue;
        }
        match simulate_with_one(question, entry, likely, simulated) {
            Ok(one) => tried.extend(one),
            Err(problem) => failed.push((entry, problem.to_string())),
        }
    }
    // what can't be simulated can't be checked either
    let same = simulate_with_one(question, &AGAIN, likely, simulated).ok().flatten();
    let same = same.filter(|_| foreign.is_none());
    // the tolerance of renderers does not become less with more images
    let longer = question.members.iter().all(|member| question.list[member.candidate].side == Side::Plant);
    let plain: BTreeMap<&str, Losses> =
        tried.iter().map(|one| (one.entry.name, one.losses.clone())).collect();
    let weigh = |one: &mut Tried| {
        same.iter().for_each(|same| one.discount(&same.losses, CLASS));
        if longer {
            one.lengthen();
        }
    };
    tried.iter_mut().for_each(weigh);
    choose::sort(&mut tried, &weights);
    for one in tried.iter_mut().take(DESIGN.finalists) {
        let losses = plain[one.entry.name].clone();
        match simulate_with_each(question, one.entry, likely, losses, simulated) {
            Ok(losses) => *one = Tried { entry: one.entry, losses, times: 1.0 },
            Err(problem) => {
                failed.push((one.entry, problem.to_string()));
                continue;
            }
        }
        weigh(one);
    }
    tried.retain(|one| failed.iter().all(|(entry, _)| entry.name != one.entry.name));
    choose::sort(&mut tried, &weights);
    let Some(best) = tried.first() else { return (None, None) };
    let mut separation: Vec<Separation> =
        tried.iter().chain(&same).map(|one| choose::line(one, question)).collect();
    separation.extend(failed.into_iter().map(not_simulated));
    let text = text(question, best).ok();
    let planned = planned(question, best.entry, simulated).ok();
    let told = told_next(question, best, separation, text.is_some());
    let what = std::iter::once(told.what.clone()).chain(promised_of(question, best.entry, likely, simulated));
    (Some(NextExperiment { planned, what: what.collect::<Vec<_>>().join(" "), ..told }), text)
}

/// What a promise is of: how many runs, and in which loop.
fn promised_of(
    question: &Question<'_>,
    entry: &'static Experiment,
    truth: usize,
    simulated: &mut Simulated,
) -> Vec<String> {
    let Ok(Some(prepared)) = prepare(question.data, question.model, entry) else { return Vec::new() };
    let moves = entry.changes.iter().any(|change| matches!(change, Change::Desired(_) | Change::Hang));
    let runs = Some(prepared.repeats.round()).filter(|runs| moves && *runs > 1.0);
    let runs = runs.map(|runs| format!("Make {runs} such runs: as long in all as those that were made."));
    let made = run_in_loop(question, entry, truth, simulated);
    let other = made.and_then(|made| loop_of_logs::quicker_than(&made, question.data));
    runs.into_iter().chain(other).collect()
}

/// Whether the scenario's controller drives an experiment.
fn closes_loop(question: &Question<'_>, entry: &Experiment) -> bool {
    let prepared = prepare(question.data, question.model, entry).ok().flatten();
    prepared.is_some_and(|prepared| prepared.scenario.units.iter().any(|unit| unit.name == "controller"))
}

/// The torques of an experiment that the scenario's controller drives.
fn run_in_loop(
    question: &Question<'_>,
    entry: &'static Experiment,
    truth: usize,
    simulated: &mut Simulated,
) -> Option<Table> {
    let prepared = prepare(question.data, question.model, entry).ok()??;
    let run = Bench::new(question, &prepared).ok()?.logged(truth, simulated).ok()?;
    run.controller.filter(|_| closes_loop(question, entry))
}

/// An experiment that could not be simulated, and why.
fn not_simulated((entry, problem): (&Experiment, String)) -> Separation {
    Separation {
        experiment: entry.name.to_owned(),
        loss: None,
        pair: Vec::new(),
        certainty: None,
        problem: Some(problem),
    }
}

/// The chosen experiment as the diagnosis tells it, with what all would separate, and its scenario's file if it has one; without graphs.
fn told_next(
    question: &Question<'_>,
    best: &Tried,
    separation: Vec<Separation>,
    scenario: bool,
) -> NextExperiment {
    let groups = best.groups();
    let names = |group: &[usize]| group.iter().map(|place| question.name(*place)).collect::<Vec<_>>();
    let apart = if groups.len() > 1 { (0..question.members.len()).collect() } else { Vec::new() };
    NextExperiment {
        what: choose::words(best),
        separates: names(&apart),
        scenario: scenario.then(|| FILE.to_owned()),
        leaves_open: groups.iter().filter(|group| group.len() > 1).map(|group| names(group)).collect(),
        separation,
        told: DESIGN.told,
        planned: None,
    }
}

/// What would be logged.
const DRIVEN: [(&str, &str); 2] = [("tau", "N·m"), ("tau_1", "N·m")];
const LOGGED: [(&str, &str, &str); 7] = [
    ("plant", "q1", "rad"),
    ("plant", "q2", "rad"),
    ("plant", "tau_applied", "N·m"),
    ("camera", "u2", "px"),
    ("camera", "v2", "px"),
    ("camera", "u3", "px"),
    ("camera", "v3", "px"),
];

/// The experiment as graphs: what drives the arm with the best guess, and what each member would give.
fn planned(
    question: &Question<'_>,
    entry: &'static Experiment,
    simulated: &mut Simulated,
) -> Result<Planned, Error> {
    let prepared = prepare(question.data, question.model, entry)?;
    let prepared = prepared.ok_or_else(|| Error::Model("there is nothing to do".into()))?;
    let bench = Bench::new(question, &prepared)?;
    let members = 0..question.members.len().min(EXPERIMENTS.members);
    let runs: Vec<(usize, Run)> =
        members.map(|truth| Ok((truth, bench.logged(truth, simulated)?))).collect::<Result<_, Error>>()?;
    let course = |table: Option<&Table>, name: &str| -> Option<Vec<(f64, f64)>> {
        let table = table?;
        let rows = table.time.iter().copied().zip(table.column(name)?.iter().copied());
        let rows: Vec<(f64, f64)> = rows.filter(|(_, value)| value.is_finite()).collect();
        rows.iter().any(|(_, value)| *value != rows[0].1).then_some(rows)
    };
    let driven = |(name, unit): &(&str, &str)| {
        let points = course(runs.first()?.1.controller.as_ref(), name)?;
        Some(planned::Course { name: format!("torque {name}"), unit: (*unit).to_owned(), points })
    };
    let logged = |(instance, variable, unit): &(&str, &str, &str)| {
        let name = format!("{instance}.{variable}");
        let of = |(truth, run): &(usize, Run)| {
            let table = if *instance == "plant" { run.plant.as_ref() } else { run.camera.as_ref() };
            Some((question.name(*truth), course(table, variable)?))
        };
        let members: Vec<(String, Vec<(f64, f64)>)> = runs.iter().filter_map(of).collect();
        let noise = question.noise.of(&name, prepared.logs.encoders);
        // Frames that one member loses are rows that nobody can compare.
        let alike = members.windows(2).all(|pair| pair[0].1.len() == pair[1].1.len());
        (alike && members.len() > 1).then(|| Predicted {
            name,
            unit: (*unit).to_owned(),
            noise: Some(noise),
            members,
        })
    };
    Ok(Planned {
        inputs: DRIVEN.iter().filter_map(driven).collect(),
        outputs: LOGGED.iter().filter_map(logged).collect(),
    })
}

/// An experiment simulated with one member as the truth.
fn simulate_with_one(
    question: &Question<'_>,
    entry: &'static Experiment,
    truth: usize,
    simulated: &mut Simulated,
) -> Result<Option<Tried>, Error> {
    let Some(prepared) = prepare(question.data, question.model, entry)? else { return Ok(None) };
    let losses = Bench::new(question, &prepared)?.losses(truth, simulated)?;
    Ok(Some(Tried { entry, losses, times: 1.0 }))
}

/// An experiment simulated with each member as the truth in turn, for that member's row; `losses` are those with the likeliest one alone.
fn simulate_with_each(
    question: &Question<'_>,
    entry: &'static Experiment,
    likely: usize,
    mut losses: Losses,
    simulated: &mut Simulated,
) -> Result<Losses, Error> {
    let prepared = prepare(question.data, question.model, entry)?;
    let prepared = prepared.ok_or_else(|| Error::Model("there is nothing to do".into()))?;
    let bench = Bench::new(question, &prepared)?;
    let mut rivals: Vec<usize> = (0..losses.len()).filter(|truth| *truth != likely).collect();
    // in a large class, the improbable ones keep the row that the columns of the most probable one give
    rivals.sort_by(|a, b| question.members[*b].weight.total_cmp(&question.members[*a].weight));
    for truth in rivals.into_iter().take(DESIGN.truths) {
        losses[truth] = bench.losses(truth, simulated)?.swap_remove(truth);
    }
    Ok(losses)
}

/// The scenario of the chosen experiment: the nominal model, for what will be measured to be compared with.
fn text(question: &Question<'_>, chosen: &Tried) -> Result<String, Error> {
    let prepared = prepare(question.data, question.model, chosen.entry)?;
    let Prepared { scenario, logs, .. } =
        prepared.ok_or_else(|| Error::Model("the experiment has no scenario".into()))?;
    let resolved = Simulation::new(&scenario, question.units).map_err(refused)?.resolved();
    let mut log = vec!["controller.tau or plant.tau"];
    log.extend(logs.images.then_some("the camera's centroids and areas"));
    log.extend(logs.encoders.then_some("plant.q1, plant.q2"));
    log.extend(logs.torque.then_some("plant.tau_applied"));
    let often = logs.rate.map_or_else(String::new, |rate| format!(" ({rate} times a second)"));
    Ok(format!("# Next experiment: {}\n# Log: {}{often}.\n{resolved}", chosen.order(), log.join("; ")))
}
