//! What all parts say together.

use super::correct::correct;
use super::counted::{counted, noisy_sensor};
use super::detectable::detectable;
use super::effects::{Swap, part_effects};
use super::policy::PIPELINE;
use super::*;
use crate::diagnosis::{Effect, Gap, NextExperiment, Trace, Unknown, Verdict, Where};
use crate::overlay::Channel;
use crate::provenance::Provenance;
use crate::rigs::acrobot::check::{Found, Judged, drifting, judged, of_angles, torque_shape};
use crate::rigs::acrobot::correction::Correction;
use crate::rigs::acrobot::overlay;
use crate::rigs::acrobot::{amend, experiment, gap, places, story};
use std::collections::BTreeMap;

#[allow(clippy::too_many_arguments)] // one stage of one workflow: a struct would only rename its locals
pub(super) fn conclude(
    data: &DataSet,
    model: &Model,
    list: &Arc<Vec<Candidate>>,
    parts: &[Part],
    point: &[f64],
    notices: Vec<Notice>,
    units: &UnitPath,
    watch: &mut Watch<'_>,
) -> Result<(Diagnosis, Vec<gap::Compared>), Error> {
    let logs = Logs {
        data,
        model,
        list,
        units,
        doubts: doubts(model, list, parts),
        drift: parts.iter().find_map(|part| drifting(&part.study, list)),
        runs: data.runs.iter().map(|run| run.name.clone()).collect(),
    };
    let mut all = Conclusion { notices, ..Conclusion::default() };
    for part in parts {
        all.cut(&logs, part, watch);
    }
    let point = all.values(&logs, parts, point);
    let gap = all.gaps.iter().cloned().max_by(|a, b| gap::above(a).total_cmp(&gap::above(b)));
    let gap = gap.ok_or_else(|| Error::Model("no cut of the loop was compared".into()))?;
    let (next, experiment) = all.next(&logs, parts, &point, watch);
    let verdict = all.verdict();
    let amended = all.amended(&logs, point)?;
    // the nominal model misses noise by a little everywhere; that is no place
    if verdict == Verdict::None {
        all.places.clear();
    }
    let diagnosis = Diagnosis {
        provenance: Provenance::of(data),
        units: model.units().clone(),
        verdict,
        effects: all.effects,
        place: places::shares(all.places),
        gap,
        unknown: all.unknown,
        correction: all.correction,
        next_experiment: next,
        minimum_detectable: all.smallest,
        cross_validation: all.gaps.clone(),
        gaps: all.gaps,
        ended_early: Vec::new(),
        notices: all.notices,
        story: all.story,
        amended,
        attachments: Vec::new(),
        experiment,
        traces: all.traces,
        channels: parts.iter().flat_map(|part| courses(part, data)).collect(),
    };
    Ok((diagnosis, all.compared))
}

/// What conclusions are drawn from, beside the parts.
struct Logs<'a> {
    data: &'a DataSet,
    model: &'a Model,
    list: &'a Arc<Vec<Candidate>>,
    units: &'a UnitPath,
    /// What the log's clock leaves in doubt of candidates.
    doubts: Vec<(usize, f64)>,
    /// The clock of some cut that drifts.
    drift: Option<Unknown>,
    /// Names of the runs.
    runs: Vec<String>,
}

/// What is concluded so far.
#[derive(Default)]
struct Conclusion {
    effects: Vec<Effect>,
    swaps: Vec<Swap>,
    smallest: BTreeMap<String, f64>,
    places: Vec<(f64, Where)>,
    gaps: Vec<Gap>,
    unknown: Option<Unknown>,
    correction: Option<Correction>,
    /// Candidates that were found and are not there.
    withdrawn: Vec<usize>,
    story: Vec<String>,
    traces: Vec<Trace>,
    compared: Vec<gap::Compared>,
    notices: Vec<Notice>,
}

impl Conclusion {
    /// What one cut shows, with all doubts of it.
    fn cut(&mut self, logs: &Logs<'_>, part: &Part, watch: &mut Watch<'_>) {
        let list = logs.list;
        let free: Vec<usize> =
            part.study.active.iter().copied().filter(|index| !list[*index].is_discrete()).collect();
        let (mut gap, of) = gap::widest(&part.study, &free, &logs.runs, part.torque, &part.signals);
        let (own, torque) = (places::places(&part.study, &part.signals), of == gap::Compared::Torques);
        self.compared.push(of);
        let judged = judged(&Found {
            study: &part.study,
            signals: &part.signals,
            list,
            torque: part.torque,
            free: &free,
            runs: &logs.runs,
            drift: logs.drift.as_ref(),
            gap: &gap,
        });
        if part.study.active.is_empty() {
            gap = gap::unchanged(gap);
        }
        // beside a residual without a name nobody knows what would have been found
        if judged.model_stands {
            detectable(part, list, &free, &logs.doubts, &mut self.smallest);
        }
        if !part.coarse.is_empty() {
            self.story.push(story::of_coarse(&part.coarse, list));
        }
        let left = judged.unknown.as_ref();
        self.story.extend(story::of(&part.study, list, &gap, left));
        let mut trace = places::trace(&part.study, torque, &blamed(left, &own, torque, &part.study));
        self.places.extend(own);
        if judged.withdrawn {
            self.story.push(story::of_widened(&gap));
            gap = Gap { after: gap.before, closed: Some(0.0), ..gap };
            trace.after.clone_from(&trace.before);
            self.withdrawn.extend(&part.study.active);
        } else {
            let confounded = left.is_some().then_some(judged.confounded);
            let early = !watch.ended().is_empty();
            for (effect, swap) in part_effects(logs.data, part, list, &free, &logs.doubts, confounded, early)
            {
                self.story.extend(effect.unbounded.then(|| story::of_open(&effect)));
                self.effects.push(effect);
                self.swaps.extend(swap);
            }
        }
        self.correct(logs, part, &judged, &gap, watch);
        if let Some(correction) = self.correction.as_ref().filter(|_| part.torque) {
            (gap, trace) = (correction.closes(&gap), correction.drawn(trace));
        }
        self.gaps.push(gap);
        self.traces.push(trace);
        // torques that seem to lack are those angles'
        let first = self.unknown.take().filter(|_| !judged.unknown.as_ref().is_some_and(of_angles));
        self.unknown = first.or(judged.unknown);
    }

    /// Fits a correction of what has no name: beside the effects, since without them it would be another one.
    fn correct(&mut self, logs: &Logs<'_>, part: &Part, judged: &Judged, gap: &Gap, watch: &mut Watch<'_>) {
        let lacks = judged.unknown.is_some() && logs.drift.is_none() && !judged.withdrawn;
        if !part.torque || !lacks || watch.is_over("the correction of what has no name") {
            return;
        }
        watch.stage("a correction of what has no name");
        let found = correct(logs.data, logs.model, logs.list, part, logs.units, &mut self.notices);
        // measured as the effects' gap is: with it no more may be left than with effects alone
        self.correction = found.filter(|correction| correction.usual <= gap.after);
        self.story.push(story::of_correction(self.correction.as_ref()));
    }

    /// Coordinates of all candidates without those that were withdrawn, and what shows in no mean.
    fn values(&mut self, logs: &Logs<'_>, parts: &[Part], point: &[f64]) -> Vec<f64> {
        let Logs { data, model, list, .. } = logs;
        let mut point = point.to_vec();
        self.withdrawn.iter().for_each(|index| point[*index] = list[*index].off);
        // a residual that no effect gives scatters, too
        if self.unknown.is_none() {
            noisy_sensor(parts, list, &mut self.effects, &mut self.smallest, &mut self.notices);
        } else {
            let noises = (0..list.len()).filter(|index| list[*index].side == Side::SensorNoise);
            noises.for_each(|index| point[index] = list[index].off);
        }
        counted(data, model, list, &mut self.effects, &mut self.smallest);
        if self.unknown.as_ref().is_some_and(of_angles) {
            self.doubt_plant(list);
        }
        self.notices.extend(super::clock::or_late(list, parts, &self.effects));
        let gone = self.superseded();
        self.effects.retain(|effect| !gone.contains(&effect.name));
        if let Some(message) = super::scale::unscaled(data, list, &mut self.effects) {
            self.story.push(message.clone());
            self.notices.push(Notice { file: "controller.csv".into(), line: 0, message });
        }
        let superseded = |index: &usize| gone.iter().any(|name| name == list[*index].name);
        (0..list.len()).filter(superseded).for_each(|index| point[index] = list[index].off);
        if let Some(correction) =
            self.correction.as_ref().filter(|_| !self.unknown.as_ref().is_some_and(of_angles))
        {
            self.unknown = self.unknown.take().map(|left| correction.told(left));
        }
        point
    }

    /// What was found by angles that are off themselves is doubted.
    fn doubt_plant(&mut self, list: &[Candidate]) {
        let plant =
            |effect: &&mut Effect| list.iter().any(|own| own.name == effect.name && own.side == Side::Plant);
        for effect in self.effects.iter_mut().filter(plant) {
            effect.probability *= PIPELINE.beside;
            effect.members.iter_mut().for_each(|member| member.probability *= PIPELINE.beside);
        }
    }

    /// Effects that a correction takes the place of.
    fn superseded(&self) -> Vec<String> {
        self.correction.as_ref().map_or_else(Vec::new, |correction| correction.supersedes.clone())
    }

    fn verdict(&self) -> Verdict {
        match &self.unknown {
            Some(_) => Verdict::Unknown,
            None if self.effects.is_empty() => Verdict::None,
            None if self.effects.iter().any(|effect| effect.class.len() > 1) => Verdict::Ambiguous,
            None => Verdict::Named,
        }
    }

    /// The next experiment. Where a model lacks much, noise says nothing of what one would tell, nor are effects asked for that a
    /// correction took the place of.
    fn next(
        &self,
        logs: &Logs<'_>,
        parts: &[Part],
        point: &[f64],
        watch: &mut Watch<'_>,
    ) -> (Option<NextExperiment>, Option<String>) {
        watch.stage("the next experiment");
        if watch.is_over("the next experiment") {
            return (None, None);
        }
        let gone = self.superseded();
        let stands = |part: &&Part| part.study.active.iter().all(|index| !self.withdrawn.contains(index));
        let certain = parts.iter().filter(|part| !part.study.discrepancy_dominated).filter(stands);
        let cuts = certain.filter(|part| !part.torque || gone.is_empty());
        let cuts = cuts.map(|part| (&part.study, part.signals.as_slice(), part.classes.as_slice()));
        experiment::next(logs.data, logs.model, logs.list, point, cuts, logs.units)
    }

    /// The amended scenario, with better guesses in their places.
    fn amended(&mut self, logs: &Logs<'_>, mut point: Vec<f64>) -> Result<String, Error> {
        let Logs { data, model, list, units, .. } = logs;
        for (own, best, x) in self.swaps.drain(..) {
            // not what a correction has withdrawn
            if point[own] != list[own].off {
                (point[own], point[best]) = (list[own].off, x);
            }
        }
        self.story.extend(self.effects.iter().filter(|effect| effect.at_end).map(story::of_end));
        for effect in &mut self.effects {
            effect.unit = model.units().get(&effect.name).cloned().unwrap_or_default();
        }
        amend::amended(data, model, list, &point, &self.effects, self.correction.as_ref(), units)
    }
}

/// Measured, nominal and amended of what a part compares, with the model that saw all runs.
fn courses(part: &Part, data: &DataSet) -> Vec<Channel> {
    let blocks = (part.study.nominal.blocks.as_slice(), part.study.last.blocks.as_slice());
    overlay::channels(blocks, &part.signals, data, false)
}

/// The signal that is blamed: of what has no name, or where the nominal model is furthest off.
fn blamed(left: Option<&Unknown>, own: &[(f64, Where)], torque: bool, study: &Study) -> String {
    let left = left.map(|left| left.signal.clone());
    match torque {
        true => left.unwrap_or_else(|| torque_shape(study, &study.nominal).0),
        false => {
            let worst = own.iter().filter(|(_, place)| place.signal.starts_with("camera."));
            let worst = worst.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, place)| place.signal.clone());
            left.or(worst).unwrap_or_default()
        }
    }
}
