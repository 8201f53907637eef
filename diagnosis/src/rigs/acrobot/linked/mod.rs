//! The plant with its states linked from row to row: the engine of any unit (`dynamics`, `infer`) on our rig's logs.
//!
//! - `problem.rs`: the plant's logs as a problem of any unit
//! - `classes.rs`: which names such a fit tells apart
//! - `unlisted_law.rs`: which law that no candidate gives is left
//! - `lone_readings.rs`: single readings that lie far off
//! - `periods.rs`: laws that go to and fro along an angle
//! - `poses.rs`: what images show in the place of a log
//! - `policy.rs`: the numbers both decide by

mod classes;
mod lone_readings;
mod periods;
pub(super) mod policy;
mod poses;
mod problem;
mod unlisted_law;

pub use classes::weigh_linked_classes;
#[cfg(test)]
pub use lone_readings::LoneReadings;
pub use poses::poses_as_log;
pub use unlisted_law::{Left, UnlistedLaw, left_of};

use crate::dynamics::build::{Built, Span, build};
use crate::dynamics::first_path::Trails;
use crate::dynamics::machine::Role;
use crate::error::Error;
use crate::infer::fit::{At, Fit, Options, fit, fit_from};
use crate::infer::likelihood::maximise;
use crate::infer::{Linearised, Noise, Sizes};
use crate::observe::{OutputEffect, Run};
use crate::rigs::acrobot::candidates::{Candidate, actuator};
use crate::rigs::acrobot::dataset::DataSet;
use crate::rigs::acrobot::model::Model;
use crate::rigs::acrobot::residual::Signal;
use crate::rigs::acrobot::selection::Study;
use policy::LINKED;
use problem::{Stretches, stretches};
use std::sync::Arc;

/// The first states are angles; process noise acts on their rates.
const ANGLES: usize = 2;

/// The plant's logs, ready to be linked.
struct Linked {
    built: Built,
    list: Arc<Vec<Candidate>>,
    /// The parameter that is each candidate.
    places: Vec<Option<usize>>,
    /// Parameters that no candidate is, as the nominal model has them.
    nominal: Vec<f64>,
}

impl Linked {
    /// Links the runs that hold a torque and both angles; `None` where there are none.
    fn of(
        data: &DataSet,
        model: &Model,
        list: &Arc<Vec<Candidate>>,
        point: &[f64],
        sigma: &dyn Fn(&str) -> Option<f64>,
    ) -> Result<Option<Self>, Error> {
        let Some(Stretches { problem, spans }) = stretches(data, model, list, point, sigma)? else {
            return Ok(None);
        };
        let runs: Vec<(&Run, Span)> = spans.iter().map(|(run, span)| (&problem.runs[*run], *span)).collect();
        let mut built = build(&problem, &runs)?;
        // an angle is the integral of its rate: what a plant lacks is a torque
        for place in 0..ANGLES {
            let least = built.sizes.process[place].0;
            built.sizes.process[place].1 = least;
            built.noise.process[place] = least;
        }
        let parameters = &built.engine.machine.parameters;
        let torque = built.engine.machine.inputs.iter().position(|input| input.name == "plant.tau");
        let mut nominal = built.engine.machine.neutral();
        for (name, effect) in actuator() {
            let own = |role: Role| matches!(role, Role::Input(place, kind) if Some(place) == torque && kind == effect);
            if let (Some(place), Some(value)) =
                (parameters.iter().position(|one| own(one.role)), model.number(name))
            {
                nominal[place] = value;
            }
        }
        let place = |candidate: &Candidate| {
            parameters.iter().position(|one| match (one.role, candidate.at_port(), candidate.zero()) {
                (Role::Input(place, kind), Some(effect), _) => Some(place) == torque && kind == effect,
                (Role::Output(place, OutputEffect::Offset), _, Some(angle)) => place == angle,
                (Role::Unit(_), None, None) => one.name == candidate.name,
                _ => false,
            })
        };
        let places = list.iter().map(place).collect();
        Ok(Some(Self { built, list: list.clone(), places, nominal }))
    }

    /// All parameters at a point.
    fn theta(&self, point: &[f64]) -> Vec<f64> {
        let mut theta = self.nominal.clone();
        for ((candidate, place), x) in self.list.iter().zip(&self.places).zip(point) {
            if let Some(place) = place {
                theta[*place] = candidate.value(*x);
            }
        }
        theta
    }

    /// Path and noises at a point before anything is fitted, and the runs about that path with columns of the parameters that are `free`.
    fn first_path(&mut self, point: &[f64], free: &[usize]) -> Result<(At, Vec<Linearised>), Error> {
        let theta = self.theta(point);
        self.built.begin_fit(&theta, &Trails::default(), free)
    }

    /// The effects that are on fitted at a point, with the path and the noises.
    fn fitted_anew(&mut self, point: &[f64], active: &[usize]) -> Result<Fit, Error> {
        let free = self.free(active);
        let (start, runs) = self.first_path(point, &free)?;
        fit_from(&self.built.engine, &start, runs, &free, Some(&self.built.sizes), &OPTIONS)
    }

    /// The candidates `free` fitted, with the path, from `start` on; and with the sizes of the noises, unless they are held.
    fn fitted(&self, start: &At, free: &[usize], sizes: Option<&Sizes>) -> Result<Fit, Error> {
        fit(&self.built.engine, start, &self.free(free), sizes, &OPTIONS)
    }

    /// The parameters that are candidates with a continuous value.
    fn free(&self, candidates: &[usize]) -> Vec<usize> {
        let real = candidates.iter().filter(|index| !self.list[**index].is_discrete());
        real.filter_map(|index| self.places[*index]).collect()
    }
}

/// The plant's logs with linked states where a study ended: what one question found, another needn't fit again.
pub struct LinkedFit {
    linked: Linked,
    /// The study's effects, fitted.
    fit: Fit,
    /// Where the study ended, and the noises that it found.
    point: Vec<f64>,
    active: Vec<usize>,
    sigmas: Vec<f64>,
}

impl LinkedFit {
    /// Links the logs and fits the study's effects; `None` where there is nothing to link.
    fn of(
        data: &DataSet,
        model: &Model,
        list: &Arc<Vec<Candidate>>,
        (study, signals): (&Study, &[Signal]),
    ) -> Result<Option<Self>, Error> {
        let sigma = |name: &str| {
            let place = signals.iter().position(|signal| signal.name.strip_prefix("plant.") == Some(name))?;
            study.last.sigmas.get(place).copied()
        };
        let (point, active, sigmas) =
            (study.last.point.clone(), study.active.clone(), study.last.sigmas.clone());
        let Some(mut linked) = Linked::of(data, model, list, &point, &sigma)? else { return Ok(None) };
        let fit = linked.fitted_anew(&point, &active)?;
        Ok(Some(Self { linked, fit, point, active, sigmas }))
    }

    /// Whether the study still stands where it was linked.
    fn is_of(&self, study: &Study) -> bool {
        self.point == study.last.point && self.active == study.active && self.sigmas == study.last.sigmas
    }
}

/// Whether process noise gains less than what ends a search: otherwise the model lacks something, or the log's noise is not white.
fn is_quiet(fit: &Fit, sizes: &Sizes) -> bool {
    gain_of_process_noise(fit, sizes) < LINKED.quiet
}

/// Deviance that process noise gains over none.
fn gain_of_process_noise(fit: &Fit, sizes: &Sizes) -> f64 {
    let columns: Vec<usize> = (0..fit.free.len()).collect();
    let exact =
        Sizes { process: sizes.process.iter().map(|(least, _)| (*least, *least)).collect(), ..sizes.clone() };
    let none =
        Noise { process: sizes.process.iter().map(|(least, _)| *least).collect(), ..fit.at.noise.clone() };
    maximise(&fit.runs, &columns, &none, &exact).1 - fit.deviance
}

/// As usual, with time to come to an end: a fit that stops on its way must not speak against its effect.
const OPTIONS: Options = Options { rounds: 2 * Options::USUAL.rounds, ..Options::USUAL };
