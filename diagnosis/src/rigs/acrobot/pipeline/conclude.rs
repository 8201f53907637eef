//! One diagnosis of all parts: effects, what has no name, gap, verdict, next experiment, amended scenario.

use super::Rig;
use super::compare::{Compared, Part};
use super::detectable::add_detectable;
use super::effects::{Alternates, PartEffects};
use super::fit_correction::fit_correction;
use super::log_clocks::{doubts_by_clock, late_log_instead};
use super::noise_and_losses::{add_lost_frames, add_sensor_noise};
use super::policy::PIPELINE;
use super::torque_scale::tell_torque_scale;
use crate::diagnosis::{Correction, Diagnosis, Effect, Gap, NextExperiment, Trace, Unknown, Verdict};
use crate::error::{Error, Notice};
use crate::overlay::Overlaid;
use crate::provenance::Provenance;
use crate::rigs::acrobot::candidates::{Candidate, Side};
use crate::rigs::acrobot::check::{Found, Judged, drifting, heavy_tail, is_of_angles, judged, torque_shape};
use crate::rigs::acrobot::dataset::DataSet;
use crate::rigs::acrobot::gap::Measure;
use crate::rigs::acrobot::linked::{Left, left_of, poses_as_log};
use crate::rigs::acrobot::overlay;
use crate::rigs::acrobot::residual_places::{Place, places, shares};
use crate::rigs::acrobot::selection::Study;
use crate::rigs::acrobot::{amend, experiment, gap, residual_places, story};
use crate::watch::Watch;
use std::collections::BTreeMap;

/// The diagnosis of all parts, with `notices` of what came before them; and in what each part's gap is measured.
///
/// # Errors
/// No cut was compared, or the amended scenario can't be written.
pub(super) fn conclude(
    rig: &Rig<'_>,
    compared: &Compared,
    notices: Vec<Notice>,
    watch: &mut Watch<'_>,
) -> Result<(Diagnosis, Vec<Measure>), Error> {
    let parts = compared.parts.as_slice();
    let runs: Vec<String> = rig.data.runs.iter().map(|run| run.name.clone()).collect();
    let logs = Logs {
        rig,
        doubts: doubts_by_clock(rig.model, &rig.list, parts),
        drift: parts.iter().find_map(|part| drifting(&part.study, &rig.list, &runs)),
        runs,
    };
    let mut all = Conclusion { notices, ..Conclusion::default() };
    for part in parts {
        all.add_part(&logs, part, watch);
    }
    let point = all.amended_point(&logs, compared);
    let gap = all.gaps.iter().cloned().max_by(|a, b| gap::above_floor(a).total_cmp(&gap::above_floor(b)));
    let gap = gap.ok_or_else(|| Error::Model("no cut of the loop was compared".into()))?;
    let next = all.next_experiment(&logs, parts, &point, watch);
    let verdict = all.verdict();
    let amended = all.amended_scenario(&logs, point)?;
    let channels = parts.iter().flat_map(|part| courses(part, &rig.data)).collect();
    let measures = std::mem::take(&mut all.measures);
    Ok((all.into_diagnosis(rig, gap, verdict, next, (amended, channels)), measures))
}

/// What conclusions are drawn from, beside the parts.
struct Logs<'a> {
    rig: &'a Rig<'a>,
    /// Candidates that the log's clock leaves in doubt, and the standard deviation of their coordinate by it.
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
    /// Members of classes that are named in the place of the effects that were found.
    alternates: Vec<Alternates>,
    /// Smallest size of each candidate that would have been found.
    smallest: BTreeMap<String, f64>,
    places: Vec<Place>,
    gaps: Vec<Gap>,
    unknown: Option<Unknown>,
    correction: Option<Correction>,
    /// Candidates that were found and are not there.
    withdrawn: Vec<usize>,
    story: Vec<String>,
    traces: Vec<Trace>,
    /// In what each gap is measured.
    measures: Vec<Measure>,
    notices: Vec<Notice>,
}

impl Conclusion {
    /// What one cut shows, with all doubts of it.
    fn add_part(&mut self, logs: &Logs<'_>, part: &Part, watch: &mut Watch<'_>) {
        let list = &logs.rig.list;
        let free = part.study.continuous(list);
        let (mut gap, measure) = gap::widest(&part.study, &free, &logs.runs, part.torque, &part.signals);
        self.measures.push(measure);
        let torque = measure == Measure::Torques;
        let left = left(logs.rig, part, watch);
        self.notices.extend(heavy_tail(&left));
        let judged = judged(&Found {
            left: &left,
            study: &part.study,
            signals: &part.signals,
            list,
            torque: part.torque,
            free: &free,
            runs: &logs.runs,
            drift: logs.drift.as_ref(),
            together: part.noise.filter(|noise| noise.clear).and_then(|noise| noise.together),
            gap: &gap,
        });
        if part.study.active.is_empty() {
            gap = gap::without_effects(gap);
        }
        // beside a residual without a name nobody knows what would have been found
        if judged.model_stands {
            add_detectable(part, list, &free, &logs.doubts, &mut self.smallest);
        }
        let left = judged.unknown.as_ref();
        self.tell_search(part, list, &gap, left);
        let own = places(&part.study, &part.signals, left.map(|left| left.signal.as_str()));
        let mut trace = residual_places::trace(&part.study, torque, &blamed(left, &own, torque, &part.study));
        self.places.extend(own);
        if judged.withdrawn {
            self.story.push(story::of_widened(&gap));
            gap = Gap { after: gap.before, closed: Some(0.0), ..gap };
            trace.after.clone_from(&trace.before);
            self.withdrawn.extend(&part.study.active);
        } else {
            self.add_effects(logs, part, &free, &judged, watch);
        }
        if part.has_circle_beside(list) {
            gap = Gap { after: gap.before, closed: gap.closed.map(|_| 0.0), ..gap };
            trace.after.clone_from(&trace.before);
        }
        self.correct(logs, part, &judged, &gap, watch);
        if let Some(correction) = self.correction.as_ref().filter(|_| part.torque) {
            (gap, trace) = (correction.closes(&gap), correction.drawn(trace));
        }
        self.gaps.push(gap);
        self.traces.push(trace);
        self.note_unknown(judged.unknown);
    }

    /// What a cut lacks without a name beside what those before it did: torques that seem to lack are those of angles, which the log itself
    /// tells best.
    fn note_unknown(&mut self, left: Option<Unknown>) {
        let of_angles = left.as_ref().is_some_and(is_of_angles);
        let first = self.unknown.take().filter(|first| is_of_angles(first) || !of_angles);
        self.unknown = first.or(left);
    }

    /// Tells how a cut was searched.
    fn tell_search(&mut self, part: &Part, list: &[Candidate], gap: &Gap, left: Option<&Unknown>) {
        if !part.coarse.is_empty() {
            self.story.push(story::of_coarse(&part.coarse, list));
        }
        self.story.extend(story::of_study(&part.study, list, gap, left));
        self.story.extend(story::of_gone(&part.coarse, &part.study, list));
    }

    /// Names what was found on a cut; beside something without a name, or where time was up, each is less sure.
    fn add_effects(
        &mut self,
        logs: &Logs<'_>,
        part: &Part,
        free: &[usize],
        judged: &Judged,
        watch: &Watch<'_>,
    ) {
        let confounded = judged.unknown.is_some().then_some(judged.confounded);
        let early = !watch.ended().is_empty();
        let told = PartEffects::new(logs.rig, part, free, &logs.doubts, confounded, early);
        for (effect, alternates) in told.effects() {
            self.story.extend(effect.unbounded.then(|| story::of_open(&effect)));
            self.effects.push(effect);
            self.alternates.extend(alternates);
        }
    }

    /// Fits a correction of what has no name: beside the effects, since without them it would be another one.
    fn correct(&mut self, logs: &Logs<'_>, part: &Part, judged: &Judged, gap: &Gap, watch: &mut Watch<'_>) {
        let lacks = judged.unknown.is_some() && logs.drift.is_none() && !judged.withdrawn;
        if !part.torque || !lacks || watch.is_over("the correction of what has no name") {
            return;
        }
        watch.stage("a correction of what has no name");
        let found = fit_correction(logs.rig, part, &mut self.notices);
        // measured as the effects' gap is: with it no more may be left than with effects alone
        self.correction = found.filter(|correction| correction.usual <= gap.after);
        self.story.push(story::of_correction(self.correction.as_ref()));
    }

    /// Coordinates of all candidates without those that were withdrawn, and with what shows in no mean.
    fn amended_point(&mut self, logs: &Logs<'_>, compared: &Compared) -> Vec<f64> {
        let (rig, list) = (logs.rig, &logs.rig.list);
        let mut point = compared.point.clone();
        self.withdrawn.iter().for_each(|index| point[*index] = list[*index].off);
        let found = self.effects.len();
        // a residual that no effect gives scatters, too
        if self.unknown.is_none() {
            let (smallest, notices) = (&mut self.smallest, &mut self.notices);
            add_sensor_noise(&compared.parts, list, &mut self.effects, smallest, notices);
        } else {
            let noises = (0..list.len()).filter(|index| list[*index].side == Side::SensorNoise);
            noises.for_each(|index| point[index] = list[index].off);
        }
        add_lost_frames(rig, &mut self.effects, &mut self.smallest, &mut self.notices);
        let counted =
            |effect: &Effect| list.iter().any(|own| own.name == effect.name && own.side == Side::Count);
        let scattered = self.effects[found..].iter().map(|effect| story::of_scatter(effect, counted(effect)));
        self.story.extend(scattered.collect::<Vec<_>>());
        if self.unknown.as_ref().is_some_and(is_of_angles) {
            self.doubt_plant(list);
        }
        self.notices.extend(late_log_instead(list, &compared.parts, &self.effects));
        let gone = self.superseded();
        self.effects.retain(|effect| !gone.contains(&effect.name));
        if let Some(message) = tell_torque_scale(&rig.data, list, &mut self.effects) {
            self.story.push(message.clone());
            self.notices.push(Notice { file: "controller.csv".into(), line: 0, message });
        }
        let superseded = |index: &usize| gone.iter().any(|name| name == list[*index].name);
        (0..list.len()).filter(superseded).for_each(|index| point[index] = list[index].off);
        if !self.unknown.as_ref().is_some_and(is_of_angles)
            && let Some(correction) = &self.correction
        {
            self.unknown = self.unknown.take().map(|left| correction.name_in(left));
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

    /// The verdict of what is concluded so far.
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
    fn next_experiment(
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
        let Rig { data, model, list, units, .. } = logs.rig;
        experiment::next(data, model, list, point, cuts, units)
    }

    /// The amended scenario, with better guesses in their places.
    fn amended_scenario(&mut self, logs: &Logs<'_>, mut point: Vec<f64>) -> Result<String, Error> {
        let Rig { data, model, list, units, .. } = logs.rig;
        for Alternates { found, named, x } in self.alternates.drain(..) {
            // not what a correction has withdrawn
            if point[found] != list[found].off {
                (point[found], point[named]) = (list[found].off, x);
            }
        }
        self.story.extend(self.effects.iter().filter(|effect| effect.at_end).map(story::of_end));
        for effect in &mut self.effects {
            effect.unit = model.units().get(&effect.name).cloned().unwrap_or_default();
        }
        amend::amended(data, model, list, &point, &self.effects, self.correction.as_ref(), units)
    }

    /// All of it in the form of `diagnosis.json`, with the widest gap, the next experiment, the amended scenario and the courses of signals.
    fn into_diagnosis(
        self,
        rig: &Rig<'_>,
        gap: Gap,
        verdict: Verdict,
        (next_experiment, experiment): (Option<NextExperiment>, Option<String>),
        (amended, channels): (String, Vec<Overlaid>),
    ) -> Diagnosis {
        Diagnosis {
            provenance: Provenance::of(&rig.data),
            units: rig.model.units().clone(),
            // the nominal model misses noise by a little everywhere; that is no place
            place: shares(
                if verdict == Verdict::None { Vec::new() } else { self.places },
                self.unknown.as_ref().map(|left| left.signal.as_str()),
            ),
            verdict,
            effects: self.effects,
            gap,
            unknown: self.unknown,
            correction: self.correction,
            next_experiment,
            minimum_detectable: self.smallest,
            cross_validation: self.gaps.clone(),
            gaps: self.gaps,
            ended_early: Vec::new(),
            notices: self.notices,
            story: self.story,
            amended,
            attachments: Vec::new(),
            experiment,
            traces: self.traces,
            channels,
        }
    }
}

/// Measured, nominal and amended of what a part compares, with the model that saw all runs.
fn courses(part: &Part, data: &DataSet) -> Vec<Overlaid> {
    let blocks = (part.study.nominal.blocks.as_slice(), part.study.last.blocks.as_slice());
    overlay::channels(blocks, &part.signals, data, false)
}

/// The signal that is blamed: of what has no name, or where the nominal model is furthest off.
fn blamed(left: Option<&Unknown>, own: &[Place], torque: bool, study: &Study) -> String {
    let left = left.map(|left| left.signal.clone());
    match torque {
        true => left.unwrap_or_else(|| torque_shape(study, &study.nominal).0),
        false => {
            let worst = own.iter().filter(|place| place.disagrees() && place.signal().starts_with("camera."));
            let worst = worst.max_by(|a, b| a.excess().total_cmp(&b.excess()));
            let worst = worst.map(|place| place.signal().to_owned());
            left.or(worst).unwrap_or_default()
        }
    }
}

/// What a part's motion leaves beside all that is listed: a log's, or what images show where there is none. A log that can't be
/// linked tells none, and must not end a diagnosis that stands without it.
fn left(rig: &Rig<'_>, part: &Part, watch: &mut Watch<'_>) -> Left {
    let seen = match (part.torque, gap::chained(&part.signals)) {
        (true, _) => None,
        (false, true) => Some(poses_as_log(&rig.data, rig.model, &rig.list, &part.study)),
        // images at measured motions tell of no torque
        (false, false) => return Left::default(),
    };
    if watch.is_over("the search for laws that nobody lists") {
        return Left::default();
    }
    watch.stage("plant: laws that nobody lists, with linked states");
    let (data, found) = (seen.as_ref().unwrap_or(&rig.data), (&part.study, part.signals.as_slice()));
    left_of(data, rig.model, &rig.list, found, part.linked.as_ref(), part.torque).unwrap_or_default()
}
