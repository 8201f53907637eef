//! Intervals of values, and what a name is worth beside a residual that has none.

use super::policy::PIPELINE;
use crate::rigs::acrobot::candidates::{Candidate, Cuts, Motion};
use crate::rigs::acrobot::dataset::DataSet;
use crate::rigs::acrobot::selection::{Study, discrepancy};
use crate::statistics::levels::{HALF, WITHIN};
use crate::statistics::linear::{inverse, submatrix};
use nalgebra::DMatrix;

/// The 95 % interval of a candidate at `at`, where its coordinate has this standard error; `None` where that is not known.
pub(super) fn ci95(candidate: &Candidate, at: f64, error: Option<f64>) -> [f64; 2] {
    match candidate.motion {
        Motion::Switch => return [candidate.value(at); 2],
        // the nearest whole number of all in between
        Motion::Count { .. } => return [at - HALF, at + HALF],
        _ => {}
    }
    let known = error.filter(|error| error.is_finite());
    let (low, high) = match (known, candidate.motion) {
        (Some(error), _) => (at - WITHIN * error, at + WITHIN * error),
        // nothing is known but that it is there
        (None, Motion::Saturation { .. }) => (0.0, at * PIPELINE.never_reached),
        (None, _) => candidate.range,
    };
    let ends = match candidate.motion {
        Motion::Saturation { .. } => [low.max(loosest(candidate).min(at)), high.max(at)],
        _ => [low, high],
    };
    let ends = ends.map(|end| candidate.value(end));
    [ends[0].min(ends[1]), ends[0].max(ends[1])]
}

/// The coordinate of the loosest saturation that these logs tell from none: the loosest that was tried.
fn loosest(candidate: &Candidate) -> f64 {
    candidate.steps.iter().map(|step| candidate.off + step).fold(f64::INFINITY, f64::min)
}

/// Whether an interval ends where the logs tell a saturation from none no more.
pub(super) fn is_open(candidate: &Candidate, ci95: [f64; 2]) -> bool {
    let saturation = matches!(candidate.motion, Motion::Saturation { .. });
    saturation && ci95[1] >= candidate.value(loosest(candidate))
}

/// Standard errors of the continuous active values, each; `None` where nothing tells.
pub(super) fn standard_errors(study: &Study, free: &[usize]) -> Vec<Option<f64>> {
    let of = |covariance: Option<DMatrix<f64>>, place: usize| {
        let variance = covariance?.get((place, place)).copied()?;
        (variance.is_finite() && variance > 0.0).then(|| variance.sqrt())
    };
    let all = study.last.covariance(free);
    // one that shows nothing any more hides the errors of all the others
    let one = |(place, index): (usize, &usize)| {
        of(all.clone(), place).or_else(|| of(study.last.covariance(&[*index]), 0))
    };
    free.iter().enumerate().map(one).collect()
}

/// What a residual without a name leaves of a name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Worth {
    /// Share of its probability that it keeps.
    pub(super) share: f64,
    /// By how much its coordinate moves where another name goes.
    pub(super) moves: f64,
    /// Times its standard error, for what is left beside noise.
    pub(super) wider: f64,
}

impl Worth {
    /// What an effect keeps of which a tangent tells nothing.
    pub(super) const LEAST: Self = Self { share: PIPELINE.confounded, moves: 0.0, wider: 1.0 };
}

/// What each of the continuous active effects is worth beside a residual: what it alone explains against what nothing does. One that leans on
/// others moves when they go.
pub(super) fn worths(study: &Study, list: &[Candidate], free: &[usize], confounded: bool) -> Vec<Worth> {
    let hard = study.last.hard();
    let places = hard.places(free);
    let gram = submatrix(&hard.total.gram, &places);
    let left = discrepancy(&study.last).max(unexplained(study));
    let dispersion = (hard.total.square / hard.total.freedom.max(1.0)).max(1.0);
    let sizes: Vec<f64> = free.iter().map(|index| study.last.point[*index] - list[*index].off).collect();
    let Some(bread) = inverse(&gram).filter(|_| places.len() == free.len()) else {
        return vec![Worth { share: PIPELINE.confounded, moves: 0.0, wider: dispersion.sqrt() }; free.len()];
    };
    (0..free.len())
        .map(|k| {
            // alone: what is lost if it goes and the others are fitted again
            let alone = sizes[k] * sizes[k] / bread[(k, k)].max(f64::MIN_POSITIVE);
            let share = share_beside(alone, left);
            // without another one, this one takes its part over
            let moves = |j: usize| (bread[(k, j)] / bread[(j, j)] * sizes[j]).abs();
            let moves = (0..free.len()).filter(|j| *j != k).map(moves).fold(0.0, f64::max);
            let share = if confounded { share.min(PIPELINE.confounded) } else { share };
            Worth { share, moves, wider: dispersion.sqrt() }
        })
        .collect()
}

/// What a name keeps that alone explains so many squares, beside so many that nothing does.
fn share_beside(alone: f64, left: f64) -> f64 {
    PIPELINE.beside * alone / (alone + left).max(f64::MIN_POSITIVE)
}

/// Share of its certainty that a name keeps of which a single run tells, so that no run left out could contradict it: as after n
/// agreeing cases in all (rule of succession, (n + 1)/(n + 2)), n the blocks in which it shows, or the commands that a saturation has cut. A
/// push from outside may look like two of these.
pub(super) fn confirmed(study: &Study, data: &DataSet, list: &[Candidate], index: usize) -> f64 {
    let (last, folds) = (&study.last, &study.folds);
    let Some(place) = last.places(&[index]).first().copied().filter(|_| folds.runs.len() > 1) else {
        return 1.0;
    };
    let told = || last.reduced.iter().map(|block| block.gram[(place, place)]);
    let all: f64 = told().sum();
    let mut runs = vec![0.0; folds.count];
    told().zip(&folds.of).for_each(|(own, fold)| runs[*fold] += own);
    if all <= 0.0 || runs.iter().all(|own| *own < PIPELINE.interval_alone * all) {
        return 1.0;
    }
    let blocks = all * all / told().map(|own| own * own).sum::<f64>();
    let cases = match list[index].motion {
        Motion::Saturation { cuts: Cuts::Torque } => {
            blocks.max(count_commands_beyond(data, list[index].value(last.point[index])))
        }
        _ => blocks,
    };
    (cases + 1.0) / (cases + 2.0)
}

/// Commands beyond a level.
fn count_commands_beyond(data: &DataSet, level: f64) -> f64 {
    let logs = data.runs.iter().filter_map(|run| run.controller.as_ref()?.column("tau"));
    logs.flatten().filter(|tau| tau.abs() > level).count() as f64
}

/// Squares that noise alone doesn't leave.
fn unexplained(study: &Study) -> f64 {
    let last = &study.last;
    let noise = |signal: usize| (study.noise[signal] / last.sigmas[signal]).min(1.0).powi(2);
    let cells = last.blocks.iter().flat_map(|block| &block.cells);
    cells.flat_map(|cell| &cell.signal).map(|signal| 1.0 - noise(*signal)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::candidates::Side;
    use crate::rigs::acrobot::pipeline::torque_scale::tests::unlogged;
    use crate::rigs::acrobot::residual::Perturbation;
    use crate::rigs::acrobot::selection::examples::{candidate, found, toy};
    use crate::rigs::acrobot::selection::{Evaluation, Folds};
    use crate::statistics::linear::Reduced;

    fn saturation() -> Candidate {
        let motion = Motion::Saturation { cuts: Cuts::Torque };
        let (name, side, phrase) = ("plant.tau_max", Side::Plant, "");
        let (off, steps, range) = (0.0, vec![1.0], (0.0, f64::INFINITY));
        Candidate { name, side, phrase, motion, off, steps, range, nonlinear: true, attributes: &[] }
    }

    #[test]
    fn value_no_name_beside_something_unnamed_is_sure() {
        // explains all but nothing, as much as is left, next to nothing
        let shares = [share_beside(1e6, 1.0), share_beside(100.0, 100.0), share_beside(1.0, 1e6)];
        assert!(
            (shares[0] - 0.3).abs() < 1e-6 && (shares[1] - 0.15).abs() < 1e-12 && shares[2] < 1e-6,
            "{shares:?}"
        );
        assert_eq!(share_beside(0.0, 0.0), 0.0);
    }

    #[test]
    fn value_no_interval_of_a_saturation_is_nothing() {
        // 1 / 0.5 N·m, known to a fifth
        let within = 0.4 * 1.959_963_984_540_054; // scipy.stats.norm.ppf(0.975)
        let [low, high] = ci95(&saturation(), 2.0, Some(0.4));
        assert!((low - 1.0 / (2.0 + within)).abs() < 1e-12 && (high - 1.0 / (2.0 - within)).abs() < 1e-12);
        assert!(!is_open(&saturation(), [low, high]));
        // not told from none, and not known at all: neither end is 0, which would say that there is no saturation, and the upper one is
        // the loosest that was tried, 1 N·m
        for error in [Some(2.0), Some(f64::NAN), None] {
            let [low, high] = ci95(&saturation(), 2.0, error);
            assert!(0.0 < low && low < 0.5 && (high - 1.0).abs() < 1e-9, "{error:?}: {low} {high}");
            assert!(is_open(&saturation(), [low, high]));
        }
        // one that is looser still is no tighter than itself
        assert_eq!(ci95(&saturation(), 0.5, None)[1], 2.0);
    }

    #[test]
    fn value_a_whole_number_is_the_nearest_one_and_a_switch_is_itself() {
        let passes = Candidate { motion: Motion::Count { tried: 4, most: 16 }, ..saturation() };
        assert_eq!(ci95(&passes, 3.0, None), [2.5, 3.5]);
        let switch = Candidate { motion: Motion::Switch, ..saturation() };
        assert_eq!(ci95(&switch, 0.0, None), [0.0, 0.0]);
    }

    /// One effect of 100 of deviance, of which this share shows in the first of two runs.
    fn shown(share: f64) -> Study {
        let perturbations = [Perturbation { candidate: 0, by: 0.1 }];
        let mut last =
            Evaluation::at(&mut toy(|x| vec![10.0 - 10.0 * x[0]]), &[1.0], &perturbations).expect("runs");
        let part = |share: f64| Reduced { gram: share * &last.total.gram, ..last.total.clone() };
        last.reduced = vec![part(share), part(1.0 - share)];
        Study {
            name: "a toy",
            active: vec![0],
            nominal: last.clone(),
            last,
            class: None,
            screen: found(Vec::new()),
            steps: Vec::new(),
            folds: Folds { of: vec![0, 1], count: 2, runs: vec![0, 1] },
            seen: vec![0],
            explained: 0.0,
            tick_drift: 0.0,
            discrepancy_dominated: false,
            noise: vec![1.0],
        }
    }

    #[test]
    fn value_one_run_says_it_all_of_which_others_say_less_than_a_fiftieth() {
        let list = [candidate(Side::Plant, false)];
        let worth = |share: f64| confirmed(&shown(share), &unlogged(), &list, 0);
        assert_eq!(worth(0.978), 1.0);
        // as after one case: 2/3 or a little more
        assert!((worth(0.982) - 2.0 / 3.0).abs() < 0.01, "{}", worth(0.982));
    }

    #[test]
    fn value_a_confounded_name_keeps_a_twentieth() {
        let list = [candidate(Side::Plant, false)];
        let shares = [false, true].map(|confounded| worths(&shown(0.5), &list, &[0], confounded)[0].share);
        assert!((shares[0] - 0.3).abs() < 1e-9, "{shares:?}");
        assert_eq!(shares[1], 0.05);
        assert_eq!(Worth::LEAST.share, shares[1]);
    }
}
