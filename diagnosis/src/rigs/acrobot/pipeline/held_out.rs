//! The gap that is told: of a model that never saw the runs on which it is judged.
//!
//! Naming has the power of all runs. For the gap the search is repeated without a part of them: clocks as they were put right, but
//! effects chosen and fitted anew: it begins with what the first one found, drops what is superfluous without these runs, and looks
//! for more among those that the first one had on its screens. What it then names is judged on the runs that were left out, each
//! half in turn. With one run, halves of it are left out.

use super::Rig;
use super::compare::{Compared, Part, compare};
use super::compare_images::Images;
use super::compare_plant::{Motions, followed_motions, logged_motions};
use super::fit_correction::fit_correction;
use super::policy::PIPELINE;
use crate::diagnosis::{Correction, Gap};
use crate::error::Error;
use crate::overlay::Overlaid;
use crate::rigs::acrobot::candidates::{Candidate, Side};
use crate::rigs::acrobot::correction;
use crate::rigs::acrobot::dataset::{DataSet, Span};
use crate::rigs::acrobot::gap::{Measure, Shifted, Sums};
use crate::rigs::acrobot::overlay;
use crate::rigs::acrobot::residual::Tracked;
use crate::rigs::acrobot::residual::forced_torques::Forced;
use crate::rigs::acrobot::residual::image::Laws;
use crate::rigs::acrobot::residual::torque::{Torque, shrunk, torques};
use crate::rigs::acrobot::selection::Evaluation;
use crate::watch::{Known, Watch};
use std::sync::Arc;

/// What ends early where time is up.
const REPEATED: &str = "the repeated searches without the runs that are left out";

/// What repeated searches say.
pub(super) struct HeldOut {
    /// The gap of each part of the diagnosis.
    pub(super) gaps: Vec<Gap>,
    /// For each repeated search the runs that were left out, and the names that it found.
    pub(super) found: Vec<(String, Vec<String>)>,
    /// Names of what these searches could find: what the first one did.
    pub(super) searched: Vec<String>,
    /// Measured, nominal and amended of the last run, by the model that never saw it.
    pub(super) channels: Vec<Overlaid>,
}

/// What a diagnosis found, and how its parts were compared.
pub(super) struct FirstSearch<'a> {
    pub(super) compared: &'a Compared,
    /// In what each part's gap is measured.
    pub(super) measures: &'a [Measure],
    pub(super) correction: Option<&'a Correction>,
    /// The gap of each part by cross-validation.
    pub(super) gaps: &'a [Gap],
}

impl FirstSearch<'_> {
    /// What was found on each cut.
    fn parts(&self) -> &[Part] {
        &self.compared.parts
    }

    /// Whether a part has anything that the nominal model hasn't.
    fn finds(&self, place: usize) -> bool {
        let part = &self.parts()[place];
        !part.study.active.is_empty() || (part.torque && self.correction.is_some())
    }

    /// What a repeated search begins from, with the candidates `kept` of the first one's.
    fn known(&self, kept: &[usize]) -> Known {
        let on = |index: &usize| self.parts().iter().any(|part| part.study.active.contains(index));
        let by_torques = |part: &Part| part.torque && part.study.discrepancy_dominated;
        Known {
            point: kept.iter().map(|index| self.compared.point[*index]).collect(),
            active: (0..kept.len()).filter(|place| on(&kept[*place])).collect(),
            by_torques: self.parts().iter().any(by_torques),
        }
    }
}

/// A part of the runs that is left out of a search, and the others.
struct Fold {
    names: Vec<String>,
    kept: DataSet,
    held: DataSet,
}

/// Repeats the search without each part of the runs and judges it there; `None` where nothing was found, or time is up.
///
/// # Errors
/// A unit failed.
pub(super) fn hold_out(
    rig: &Rig<'_>,
    first: &FirstSearch<'_>,
    watch: &mut Watch<'_>,
) -> Result<Option<HeldOut>, Error> {
    let kept = candidates_again(&rig.list, first);
    let list: Arc<Vec<Candidate>> = Arc::new(kept.iter().map(|index| rig.list[*index].clone()).collect());
    let known = first.known(&kept);
    let mut laws = Laws::default();
    laws.extend(first.parts().iter().map(|part| &part.laws));
    let mut sums = vec![Sums::default(); first.parts().len()];
    let (mut runs, mut found, mut channels) = (Vec::new(), Vec::new(), Vec::new());
    let last = |data: &DataSet| data.runs.last().map(|run| run.name.clone());
    let folds = folds(&rig.data);
    let count = folds.len();
    for (place, fold) in folds.into_iter().enumerate() {
        watch.stage("the search is repeated for the gap");
        watch.trying(&format!("without {}", fold.names.join(", ")), place + 1, count);
        if watch.is_over(REPEATED) {
            return Ok(None);
        }
        let holds_last = last(&fold.held) == last(&rig.data);
        let judged = search_without(rig, (&list, &known, &laws), fold.kept, fold.held, first, watch)?;
        sums.iter_mut().zip(judged.sums).for_each(|(sum, own)| *sum = sum.and(own));
        if holds_last {
            channels = judged.channels;
        }
        found.push((fold.names.join(", "), judged.named));
        runs.extend(fold.names);
    }
    let gaps = (sums.into_iter().zip(first.measures).zip(first.gaps).enumerate()).map(
        |(place, ((sums, measure), gap))| match first.finds(place) {
            true => Gap { held_out_runs: runs.clone(), ..sums.gap(*measure) },
            // where nothing was found nothing was fitted
            false => gap.clone(),
        },
    );
    let active = first.parts().iter().flat_map(|part| &part.study.active);
    let searched = active.map(|index| rig.list[*index].name.to_owned()).collect();
    Ok(Some(HeldOut { gaps: gaps.collect(), found, searched, channels }))
}

/// What one repeated search found, and how it does on the runs that it never saw.
struct JudgedFold {
    /// Names of the effects.
    named: Vec<String>,
    /// Sums of squares of each part.
    sums: Vec<Sums>,
    channels: Vec<Overlaid>,
}

/// Searches the runs that are `kept`, beginning with what is known, and judges what was found on those that are `held` back.
fn search_without(
    rig: &Rig<'_>,
    (list, known, laws): (&Arc<Vec<Candidate>>, &Known, &Laws),
    kept: DataSet,
    held: DataSet,
    first: &FirstSearch<'_>,
    watch: &mut Watch<'_>,
) -> Result<JudgedFold, Error> {
    let on = |data: DataSet| Rig { data, list: list.clone(), ..*rig };
    let seen = on(kept);
    watch.begin_from(Some(known.clone()));
    let compared = compare(&seen, laws, watch);
    watch.begin_from(None);
    let Compared { parts, point, .. } = compared?;
    let active = parts.iter().flat_map(|part| &part.study.active);
    let named = active.map(|index| list[*index].name.to_owned()).collect();
    let correction = first.correction.and_then(|_| {
        let part = parts.iter().find(|part| part.torque)?;
        fit_correction(&seen, part, &mut Vec::new())
    });
    let mut judge =
        Judge { rig: &on(held), first, point: &point, correction: correction.as_ref(), channels: Vec::new() };
    let sums = judge.sums()?;
    Ok(JudgedFold { named, sums, channels: judge.channels })
}

/// Candidates of a repeated search: what was found, what the screens had among their best, and what is of the logs.
fn candidates_again(list: &[Candidate], first: &FirstSearch<'_>) -> Vec<usize> {
    let studies = || first.parts().iter().map(|part| &part.study).filter(|study| !study.active.is_empty());
    let screened = |index: usize| {
        let steps = studies().flat_map(|study| &study.steps);
        steps.flat_map(|step| step.best.iter().take(PIPELINE.screened)).any(|hit| hit.candidate == index)
    };
    let taken = |index: usize| studies().any(|study| study.active.contains(&index));
    let beside = |index: usize| {
        first.compared.point[index] != list[index].off || list[index].side == Side::SensorNoise
    };
    (0..list.len()).filter(|index| taken(*index) || screened(*index) || beside(*index)).collect()
}

/// The parts of the runs that are left out, each once: of several runs whole ones, of a single one stretches of the same duration.
fn folds(data: &DataSet) -> Vec<Fold> {
    let count = data.runs.len();
    if count == 1 {
        return stretches(data);
    }
    let parts = count.min(PIPELINE.parts);
    let part = |part: usize| {
        let out = |run: usize| run % parts == part;
        Fold {
            names: (0..count).filter(|run| out(*run)).map(|run| data.runs[run].name.clone()).collect(),
            kept: data.only(&|run| !out(run)),
            held: data.only(&out),
        }
    };
    (0..parts).map(part).collect()
}

/// The only run, without each of its stretches.
fn stretches(data: &DataSet) -> Vec<Fold> {
    let (from, to) = data.runs[0].span();
    let at = |part: usize| from + (to - from) * part as f64 / PIPELINE.parts as f64;
    let without = |part: usize| {
        let (begin, end) = (at(part), at(part + 1));
        let kept = [Span(f64::NEG_INFINITY, begin), Span(end, f64::INFINITY)];
        let held = if part + 1 == PIPELINE.parts { Span(begin, f64::INFINITY) } else { Span(begin, end) };
        Fold {
            names: vec![format!("{} from {begin:.1} to {end:.1} s", data.runs[0].name)],
            kept: data.within(&kept),
            held: data.within(&[held]),
        }
    };
    (0..PIPELINE.parts).map(without).collect()
}

/// Judges a model on runs that it never saw: nothing is fitted but start states and poses, which belong to the logs.
struct Judge<'a> {
    /// The runs that were left out, with the candidates of the repeated search.
    rig: &'a Rig<'a>,
    first: &'a FirstSearch<'a>,
    /// Coordinates of all candidates as the repeated search found them.
    point: &'a [f64],
    correction: Option<&'a Correction>,
    /// Measured, nominal and amended of all that was judged so far.
    channels: Vec<Overlaid>,
}

impl Judge<'_> {
    /// The sums of squares of each part.
    fn sums(&mut self) -> Result<Vec<Sums>, Error> {
        let first = self.first;
        // as the search compared them: where no torque was logged beside the angles, images stand at the poses of the logs alone
        let at_logs = first.parts().iter().all(|part| !part.torque);
        let mut motions = if at_logs { logged_motions(&self.rig.data) } else { None };
        let mut all = Vec::new();
        for (place, (part, measure)) in first.parts().iter().zip(first.measures).enumerate() {
            if !part.torque && !first.finds(place) {
                all.push(Sums::default());
                continue;
            }
            let sums = if part.torque {
                let judged = |(place, part): (usize, &Part)| !part.torque && first.finds(place);
                let images = first.parts().iter().enumerate().any(judged);
                let (sums, followed) = self.plant(part, images)?;
                motions = followed;
                sums
            } else {
                self.images(motions.take(), *measure, part)?
            };
            all.push(sums);
        }
        Ok(all)
    }

    /// Torques that the plant lacks, and the motions for the images, where any are judged.
    fn plant(&mut self, part: &Part, images: bool) -> Result<(Sums, Option<Motions>), Error> {
        let Some(mut rows) = self.rig.plant_cut()? else {
            return Ok((Sums::default(), None));
        };
        if part.study.discrepancy_dominated {
            let Some(mut torques) = self.rig.torque_cut()? else {
                return Ok((Sums::default(), None));
            };
            let (sums, _) = self.torques(&mut torques, part)?;
            return Ok((sums, None));
        }
        rows.begin(&self.rig.nominal_point())?;
        let (sums, channels) = self.torques(&mut rows, part)?;
        self.channels.extend(channels);
        let sums = self.at_the_log(sums)?;
        if !images {
            return Ok((sums, None));
        }
        rows.begin(self.point)?;
        rows.linearise(self.point, &[])?;
        let sigma = part.study.noise[..2].iter().fold(0.0, |a: f64, b| a.max(*b));
        Ok((sums, followed_motions(self.rig, &mut rows, self.point, sigma)?))
    }

    /// Sums of the plant's torques, with what the nominal model lacks at the logged states where it has run away from the log.
    fn at_the_log(&self, sums: Sums) -> Result<Sums, Error> {
        let mean = |(square, count): (f64, f64)| square / f64::max(count, 1.0);
        if mean(sums.before) < PIPELINE.far_above * PIPELINE.far_above * mean(sums.floor) {
            return Ok(sums);
        }
        let Some(mut weak) = self.rig.torque_cut()? else { return Ok(sums) };
        let seen = Evaluation::at(&mut weak, &self.rig.nominal_point(), &[])?;
        let seen = torques(&seen.blocks, &[], &[], &vec![0; seen.blocks.len()]);
        let square: f64 = seen.iter().flat_map(|torque| torque.torque).map(|x| x * x).sum();
        let shown = square / (2.0 * seen.len() as f64).max(1.0);
        let ran_away = shown > 0.0 && mean(sums.before) > PIPELINE.ran_away * PIPELINE.ran_away * shown;
        Ok(if ran_away { Sums { before: (shown * sums.before.1, sums.before.1), ..sums } } else { sums })
    }

    /// Sums of the torques that a cut lacks, with the correction where there is one, and the courses of its signals.
    fn torques<C: Forced + 'static>(
        &self,
        cut: &mut Tracked<C>,
        part: &Part,
    ) -> Result<(Sums, Vec<Overlaid>), Error> {
        let Rig { data, list, units, .. } = self.rig;
        let nominal = Evaluation::at(cut, &self.rig.nominal_point(), &[])?;
        let mut there = self.point.to_vec();
        for name in self.correction.iter().flat_map(|correction| &correction.supersedes) {
            let own = list.iter().position(|candidate| candidate.name == name);
            own.into_iter().for_each(|index| there[index] = list[index].off);
        }
        cut.reset();
        let last = Evaluation::at(cut, &there, &[])?;
        let channels = overlay::channels((&nominal.blocks, &last.blocks), &part.signals, data, true);
        let folds = vec![0; last.blocks.len()];
        let shifted = Shifted { places: &[], shifts: &[], folds: &folds };
        let sums = Measure::Torques.sums(&nominal, &last, &shifted, &part.study.noise);
        let Some(correction) = self.correction else { return Ok((sums, channels)) };
        let left: Vec<Torque> = correction::left(cut, &there, &last, correction, units)?;
        let before = torques(&nominal.under(&last).blocks, &[], &[], &folds);
        let [_, after, _, count] = shrunk(&before, &left, &left);
        Ok((Sums { after: (after, count), ..sums }, channels))
    }

    /// Sums of what images leave, and their courses.
    fn images(&mut self, motions: Option<Motions>, measure: Measure, part: &Part) -> Result<Sums, Error> {
        let Some(mut images) = Images::new(self.rig, motions)? else { return Ok(Sums::default()) };
        let cut = images.tracked();
        let judged = |cut: &mut Tracked, point: &[f64]| {
            let first = Evaluation::at(cut, point, &[])?;
            // the linearisation itself has put frames elsewhere
            if cut.policy().free_pose { Evaluation::at(cut, point, &[]) } else { Ok(first) }
        };
        let nominal = judged(cut, &self.rig.nominal_point())?;
        cut.reset();
        let last = judged(cut, self.point)?;
        let blocks = (nominal.blocks.as_slice(), last.blocks.as_slice());
        self.channels.extend(overlay::channels(blocks, &part.signals, &self.rig.data, true));
        let folds = vec![0; last.blocks.len().max(nominal.blocks.len())];
        let shifted = Shifted { places: &[], shifts: &[], folds: &folds };
        Ok(measure.sums(&nominal, &last, &shifted, &part.study.noise))
    }
}
