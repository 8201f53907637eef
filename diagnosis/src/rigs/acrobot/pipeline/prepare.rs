//! Before anything is compared: the candidates that the logs can tell of, logs that count as the model does, and their clocks' ticks.

use super::Rig;
use super::clock_ticks::at_clock_ticks;
use super::policy::PIPELINE;
use super::saturations::saturations;
use crate::error::Error;
use crate::options::Options;
use crate::rigs::acrobot::candidates::{Attribute, Candidate, Side, candidates};
use crate::rigs::acrobot::dataset::row_times::unevenness;
use crate::rigs::acrobot::dataset::{DataSet, Run};
use crate::rigs::acrobot::model::Model;
use crate::rigs::acrobot::parameters;
use crate::rigs::acrobot::plausibility;
use crate::watch::Watch;
use orchestrator::UnitPath;
use std::path::Path;
use std::sync::Arc;

/// The logs with the candidates that they can tell of. Images that the model has no camera for are put aside.
///
/// # Errors
/// No log is left.
pub(super) fn prepare<'a>(
    mut data: DataSet,
    model: &'a Model,
    units: &'a UnitPath,
    options: &'a Options,
) -> Result<Rig<'a>, Error> {
    if model.camera.is_none() {
        let scenario = data.manifest.scenario.clone();
        data.without_images(&format!("the scenario `{scenario}` has no unit `camera`"))?;
    }
    let contact = data.contact(model.number(parameters::LIMIT).unwrap_or(f64::INFINITY));
    let mut list = candidates(model, &options.without, &|cuts| saturations(&data, cuts, contact));
    let seen = data.runs.iter().any(|run| run.camera.is_some());
    if !data.runs.iter().any(Run::logs_the_torque) {
        // what nobody drives has no motor that could be off; one that is told 0 may be
        list.retain(|candidate| !candidate.is(Attribute::Bias));
    }
    if data.frames_apart {
        let delay = list.iter_mut().filter(|candidate| candidate.is(Attribute::ImageDelay));
        delay.for_each(|delay| delay.side = Side::Timestamps);
    }
    let logs = data.runs.iter().filter_map(|run| run.plant.as_ref());
    data.late_by_hand = PIPELINE.late_by_hand * logs.map(|log| unevenness(&log.time)).fold(0.0, f64::max);
    if !seen || data.frames_apart {
        // nobody but the camera could tell a log that is stamped late from an actuator's delay: that is named
        believe_clocks(&mut list, data.late_by_hand);
    }
    if data.clocks_apart {
        trust_no_clock(&mut list);
    }
    Ok(Rig { data, model, list: Arc::new(list), units, options })
}

/// Logs that count as the model does, with rows at the ticks of their clocks where the motion fits these better.
///
/// # Errors
/// The logs count otherwise than the model, or a unit failed.
pub(super) fn plausible<'a>(mut rig: Rig<'a>, path: &Path, watch: &mut Watch<'_>) -> Result<Rig<'a>, Error> {
    watch.stage("do the logs count as the model does?");
    if let Some(finding) = plausibility::motion::other_way_of_counting(&rig.data, rig.model, &rig.list)? {
        let finding = Box::new(finding.beside(&rig.data.manifest.stated.given));
        return Err(Error::Implausible { path: path.to_owned(), finding });
    }
    if let Some(data) = at_clock_ticks(&rig) {
        watch.stage("plant: timestamps set to the ticks of their clocks");
        rig.data = data;
    }
    Ok(rig)
}

/// Lets logs be late by no more than what their timestamps scatter by, s.
pub(super) fn believe_clocks(list: &mut [Candidate], late_by_hand: f64) {
    let clocks = list.iter_mut().filter(|candidate| candidate.side == Side::Clock);
    clocks.for_each(|clock| clock.range.1 = clock.range.1.min(late_by_hand));
}

/// Lets logs be late by as much as any other, where their clocks are known to be off.
pub(super) fn trust_no_clock(list: &mut [Candidate]) {
    let clocks = list.iter_mut().filter(|candidate| candidate.side == Side::Clock);
    clocks.for_each(|clock| clock.range = (-PIPELINE.any, PIPELINE.any));
}
