//! The gap that is told: of a model that never saw the runs on which it is judged.
//!
//! Naming has the power of all runs. For the gap the search is repeated without a part of them: clocks as they were put right, but
//! effects chosen and fitted anew: it begins with what the first one found, drops what is superfluous without these runs, and looks
//! for more among those that the first one had on its screens. What it then names is judged on the runs that were left out, each
//! half in turn. With one run, halves of it are left out.

use super::correct::correct;
use super::plant::{logged_poses, pose_of};
use super::*;
use crate::diagnosis::Gap;
use crate::overlay::Channel;
use crate::rigs::acrobot::correction::{self, Correction};
use crate::rigs::acrobot::dataset::Span;
use crate::rigs::acrobot::gap::{Compared as Of, Shifted, Sums, above};
use crate::rigs::acrobot::overlay;
use crate::rigs::acrobot::pipeline::policy::PIPELINE;
use crate::rigs::acrobot::residual::chain::Chain;
use crate::rigs::acrobot::residual::forced::Forced;
use crate::rigs::acrobot::residual::image::{ImageCut, Pose};
use crate::rigs::acrobot::residual::plant::PlantCut;
use crate::rigs::acrobot::residual::torque::{Torque, shrunk, torques};
use crate::rigs::acrobot::residual::weak::Weak;
use crate::rigs::acrobot::selection::Evaluation;
use crate::watch::Known;

/// What ends early where time is up.
const REPEATED: &str = "the repeated searches without the runs that are left out";

/// What repeated searches say.
pub(super) struct LeftOut {
    /// The gap of each part of the diagnosis.
    pub(super) gaps: Vec<Gap>,
    /// For each repeated search what was left out, and what it named.
    pub(super) found: Vec<(String, Vec<String>)>,
    /// Measured, nominal and amended of the last run, by the model that never saw it.
    channels: Vec<Channel>,
}

/// What a diagnosis found, and how its parts were compared.
pub(super) struct First<'a> {
    pub(super) parts: &'a [Part],
    /// What each part's gap is one of.
    pub(super) compared: &'a [Of],
    pub(super) correction: Option<&'a Correction>,
    /// By cross-validation.
    pub(super) gaps: &'a [Gap],
    /// Coordinates of all candidates.
    pub(super) point: &'a [f64],
}

impl First<'_> {
    /// Whether a part has anything that the nominal model hasn't.
    fn finds(&self, place: usize) -> bool {
        let part = &self.parts[place];
        !part.study.active.is_empty() || (part.torque && self.correction.is_some())
    }
}

/// What is left out, and what is left.
struct Fold {
    names: Vec<String>,
    kept: DataSet,
    held: DataSet,
}

/// Repeats the search without each part of the runs and judges it there; `None` where nothing was found, or time is up.
///
/// # Errors
/// A unit failed.
pub(super) fn left_out(
    data: &DataSet,
    model: &Model,
    list: &[Candidate],
    options: &Options,
    first: &First<'_>,
    units: &UnitPath,
    watch: &mut Watch<'_>,
) -> Result<Option<LeftOut>, Error> {
    let kept = again(list, first);
    let shorter: Arc<Vec<Candidate>> = Arc::new(kept.iter().map(|index| list[*index].clone()).collect());
    let mut sums = vec![Sums::default(); first.parts.len()];
    let (mut runs, mut found, mut channels) = (Vec::new(), Vec::new(), Vec::new());
    let point: Vec<f64> = kept.iter().map(|index| first.point[*index]).collect();
    let on = |index: &usize| first.parts.iter().any(|part| part.study.active.contains(index));
    let active: Vec<usize> = (0..kept.len()).filter(|place| on(&kept[*place])).collect();
    let by_torques = first.parts.iter().any(|part| part.torque && part.study.discrepancy_dominated);
    let mut laws = Laws::default();
    laws.extend(first.parts.iter().map(|part| &part.laws));
    let all = folds(data);
    for (place, fold) in all.iter().enumerate() {
        watch.stage("the search is repeated for the gap");
        watch.trying(&format!("without {}", fold.names.join(", ")), place + 1, all.len());
        if watch.is_over(REPEATED) {
            return Ok(None);
        }
        watch.begin_from(Some(Known { point: point.clone(), active: active.clone(), by_torques }));
        let compared = compare(&fold.kept, model, &shorter, options, &laws, watch);
        watch.begin_from(None);
        let Compared { parts, point, .. } = compared?;
        let named =
            parts.iter().flat_map(|part| &part.study.active).map(|index| shorter[*index].name.to_owned());
        found.push((fold.names.join(", "), named.collect()));
        let corrected = first.correction.and_then(|_| {
            let part = parts.iter().find(|part| part.torque)?;
            correct(&fold.kept, model, &shorter, part, units, &mut Vec::new())
        });
        let judge = Judge { data: &fold.held, model, list: &shorter, frames: options.frames, units };
        let mut kept = Vec::new();
        for (place, own) in judge.sums(&point, corrected.as_ref(), first, &mut kept)?.into_iter().enumerate()
        {
            sums[place] = sums[place].and(own);
        }
        let last = |data: &DataSet| data.runs.last().map(|run| run.name.clone());
        if last(&fold.held) == last(data) {
            channels = kept;
        }
        runs.extend(fold.names.iter().cloned());
    }
    let gaps =
        sums.into_iter().zip(first.compared).zip(first.gaps).enumerate().map(|(place, ((sums, of), gap))| {
            // where nothing was found nothing was fitted
            match first.finds(place) {
                true => Gap { held_out_runs: runs.clone(), ..sums.gap(*of) },
                false => gap.clone(),
            }
        });
    Ok(Some(LeftOut { gaps: gaps.collect(), found, channels }))
}

/// Candidates of a repeated search: what was found, what the screens had among their best, and what is of the logs.
fn again(list: &[Candidate], first: &First<'_>) -> Vec<usize> {
    let studies = || first.parts.iter().map(|part| &part.study).filter(|study| !study.active.is_empty());
    let screened = |index: usize| {
        let steps = studies().flat_map(|study| &study.steps);
        steps.flat_map(|step| step.best.iter().take(PIPELINE.screened)).any(|hit| hit.candidate == index)
    };
    let taken = |index: usize| studies().any(|study| study.active.contains(&index));
    let beside =
        |index: usize| first.point[index] != list[index].off || list[index].side == Side::SensorNoise;
    (0..list.len()).filter(|index| taken(*index) || screened(*index) || beside(*index)).collect()
}

fn folds(data: &DataSet) -> Vec<Fold> {
    let count = data.runs.len();
    if count == 1 {
        let (from, to) = data.runs[0].span();
        let at = |part: usize| from + (to - from) * part as f64 / PIPELINE.parts as f64;
        return (0..PIPELINE.parts)
            .map(|part| {
                let (begin, end) = (at(part), at(part + 1));
                let kept = [Span(f64::NEG_INFINITY, begin), Span(end, f64::INFINITY)];
                let held =
                    if part + 1 == PIPELINE.parts { Span(begin, f64::INFINITY) } else { Span(begin, end) };
                Fold {
                    names: vec![format!("{} from {begin:.1} to {end:.1} s", data.runs[0].name)],
                    kept: data.within(&kept),
                    held: data.within(&[held]),
                }
            })
            .collect();
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

/// Judges a model on runs that it never saw: nothing is fitted but start states and poses, which belong to the logs.
struct Judge<'a> {
    data: &'a DataSet,
    model: &'a Model,
    list: &'a Arc<Vec<Candidate>>,
    frames: usize,
    units: &'a UnitPath,
}

impl Judge<'_> {
    fn sums(
        &self,
        point: &[f64],
        correction: Option<&Correction>,
        first: &First<'_>,
        kept: &mut Vec<Channel>,
    ) -> Result<Vec<Sums>, Error> {
        // as the search compared them: where no torque was logged beside the angles, images stand at the poses of the logs alone
        let led_by_logs = first.parts.iter().all(|part| !part.torque);
        let mut motions = if led_by_logs { logged_poses(self.data) } else { None };
        let mut all = Vec::new();
        for (place, (part, of)) in first.parts.iter().zip(first.compared).enumerate() {
            if !part.torque && !first.finds(place) {
                all.push(Sums::default());
                continue;
            }
            let sums = if part.torque {
                let (sums, followed) = self.plant(point, correction, part, kept)?;
                motions = followed;
                sums
            } else {
                self.picture(point, motions.take(), *of, part, kept)?
            };
            all.push(sums);
        }
        Ok(all)
    }

    fn off(&self) -> Vec<f64> {
        self.list.iter().map(|candidate| candidate.off).collect()
    }

    /// Torques that the plant lacks, and the motion for the images.
    #[allow(clippy::type_complexity)] // a motion for each run, and how well it is known
    fn plant(
        &self,
        point: &[f64],
        correction: Option<&Correction>,
        part: &Part,
        kept: &mut Vec<Channel>,
    ) -> Result<(Sums, Option<(Vec<Logged>, f64)>), Error> {
        let noise = &part.study.noise;
        let Some(mut rows) = PlantCut::new(self.data, self.model, self.list.clone())?.map(Tracked::new)
        else {
            return Ok((Sums::default(), None));
        };
        if part.study.discrepancy_dominated {
            let Some(mut weak) = Weak::new(self.data, self.model, self.list.clone())?.map(Tracked::new)
            else {
                return Ok((Sums::default(), None));
            };
            return Ok((self.torques(&mut weak, point, correction, part, &mut Vec::new())?, None));
        }
        rows.begin(&self.off())?;
        let sums = self.at_the_log(self.torques(&mut rows, point, correction, part, kept)?)?;
        rows.begin(point)?;
        rows.linearise(point, &[])?;
        let sigma = noise[..2].iter().fold(0.0, |a: f64, b| a.max(*b));
        Ok((sums, pose_of(self.data, &mut rows, point, sigma)?))
    }

    /// The same sums, with what the nominal model lacks at the logged states where it has run away from the log.
    fn at_the_log(&self, sums: Sums) -> Result<Sums, Error> {
        let mean = |(square, count): (f64, f64)| square / f64::max(count, 1.0);
        if mean(sums.before) < PIPELINE.far_above * PIPELINE.far_above * mean(sums.floor) {
            return Ok(sums);
        }
        let Some(mut weak) = Weak::new(self.data, self.model, self.list.clone())?.map(Tracked::new) else {
            return Ok(sums);
        };
        let seen = Evaluation::at(&mut weak, &self.off(), &[])?;
        let seen = torques(&seen.blocks, &[], &[], &vec![0; seen.blocks.len()]);
        let square: f64 = seen.iter().flat_map(|torque| torque.torque).map(|x| x * x).sum();
        let shown = square / (2.0 * seen.len() as f64).max(1.0);
        let ran_away = shown > 0.0 && mean(sums.before) > PIPELINE.ran_away * PIPELINE.ran_away * shown;
        Ok(if ran_away { Sums { before: (shown * sums.before.1, sums.before.1), ..sums } } else { sums })
    }

    fn torques<C: Forced + 'static>(
        &self,
        cut: &mut Tracked<C>,
        point: &[f64],
        correction: Option<&Correction>,
        part: &Part,
        kept: &mut Vec<Channel>,
    ) -> Result<Sums, Error> {
        let nominal = Evaluation::at(cut, &self.off(), &[])?;
        let mut there = point.to_vec();
        for name in correction.iter().flat_map(|correction| &correction.supersedes) {
            let own = self.list.iter().position(|candidate| candidate.name == name);
            own.into_iter().for_each(|index| there[index] = self.list[index].off);
        }
        cut.reset();
        let last = Evaluation::at(cut, &there, &[])?;
        kept.extend(overlay::channels((&nominal.blocks, &last.blocks), &part.signals, self.data, true));
        let folds = vec![0; last.blocks.len()];
        let shifted = Shifted { places: &[], shifts: &[], folds: &folds };
        let sums = Of::Torques.sums(&nominal, &last, &shifted, &part.study.noise);
        let Some(correction) = correction else { return Ok(sums) };
        let left: Vec<Torque> = correction::left(cut, &there, &last, correction, self.units)?;
        let before = torques(&nominal.under(&last).blocks, &[], &[], &folds);
        let [_, after, _, count] = shrunk(&before, &left, &left);
        Ok(Sums { after: (after, count), ..sums })
    }

    fn picture(
        &self,
        point: &[f64],
        motions: Option<(Vec<Logged>, f64)>,
        of: Of,
        part: &Part,
        kept: &mut Vec<Channel>,
    ) -> Result<Sums, Error> {
        let chained = motions.is_none();
        let pose = motions.map_or(Pose::Free, |(motions, sigma)| Pose::Logged(motions, sigma));
        let chain = if chained { Chain::new(self.data, self.model, self.list.clone())? } else { None };
        let image = match chain {
            Some(_) => None,
            None => ImageCut::new(self.data, self.model, self.list.clone(), pose, self.frames)?,
        };
        let mut cut: Box<Tracked> = match (chain, image) {
            (Some(chain), _) => Box::new(Tracked::new(chain)),
            (_, Some(image)) => Box::new(Tracked::new(image)),
            _ => return Ok(Sums::default()),
        };
        let judged = |cut: &mut Tracked, point: &[f64]| {
            let first = Evaluation::at(cut, point, &[])?;
            // the linearisation itself has put frames elsewhere
            if cut.policy().free_pose { Evaluation::at(cut, point, &[]) } else { Ok(first) }
        };
        let nominal = judged(cut.as_mut(), &self.off())?;
        cut.reset();
        let last = judged(cut.as_mut(), point)?;
        kept.extend(overlay::channels((&nominal.blocks, &last.blocks), &part.signals, self.data, true));
        let folds = vec![0; last.blocks.len().max(nominal.blocks.len())];
        let shifted = Shifted { places: &[], shifts: &[], folds: &folds };
        Ok(of.sums(&nominal, &last, &shifted, &part.study.noise))
    }
}

/// Puts the gaps of models that never saw the runs in the place of those by cross-validation, and tells what they named.
pub(super) fn told(diagnosis: &mut Diagnosis, left_out: LeftOut) {
    for (runs, names) in &left_out.found {
        let named = if names.is_empty() { "nothing".to_owned() } else { names.join(", ") };
        diagnosis.story.push(format!("Searched again without {runs}: {named}."));
    }
    let widest = left_out.gaps.iter().max_by(|a, b| above(a).total_cmp(&above(b)));
    if let Some(gap) = widest.cloned() {
        if let Some(closed) = gap.closed {
            diagnosis.story.push(format!(
                "On these runs, which the repeated searches never saw, the gap goes from {} to {} {} (noise alone: {}): {:.0} % \
                 of it is closed.",
                crate::rigs::acrobot::story::brief(gap.before),
                crate::rigs::acrobot::story::brief(gap.after),
                gap.unit,
                crate::rigs::acrobot::story::brief(gap.floor),
                100.0 * closed
            ));
        }
        diagnosis.gap = gap;
    }
    diagnosis.gaps = left_out.gaps;
    for channel in left_out.channels {
        if let Some(known) = diagnosis.channels.iter_mut().find(|known| known.signal == channel.signal) {
            *known = channel;
        }
    }
}
