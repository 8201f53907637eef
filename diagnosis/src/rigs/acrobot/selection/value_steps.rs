//! Whether a candidate's value steps once within runs, where it doesn't drift along them.

use super::evaluation::Evaluation;
use super::steadiness::{BlockScore, block_scores};
use crate::statistics::levels::{CERTAIN, HALF};
use std::collections::BTreeMap;

/// A step within a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ValueStep {
    /// The run's index.
    pub run: usize,
    /// When, s.
    pub time: f64,
    /// By how much x changes there.
    pub by: f64,
}

/// The steps of a candidate where the active ones are fitted, if they explain what its blocks want clearly better than a drift of each run does, and
/// leave less than half of what that leaves.
pub fn value_steps(evaluation: &Evaluation, candidate: usize, active: &[usize]) -> Option<Vec<ValueStep>> {
    steps_of(&block_scores(evaluation, candidate, active)?)
}

/// Sums over blocks: information, what they want times it, and the square of that.
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    length: f64,
    score: f64,
    square: f64,
}

impl Sum {
    fn of<'a>(blocks: impl Iterator<Item = &'a &'a BlockScore>) -> Self {
        blocks.fold(Self::default(), |sum, block| Self {
            length: sum.length + block.length,
            score: sum.score + block.score,
            square: sum.square + block.score * block.score / block.length,
        })
    }

    /// The value that they want together.
    fn mean(&self) -> f64 {
        self.score / self.length
    }

    /// Squares that one value leaves.
    fn left(&self) -> f64 {
        self.square - self.score * self.score / self.length
    }
}

/// See `value_steps`.
fn steps_of(blocks: &[BlockScore]) -> Option<Vec<ValueStep>> {
    let mut runs: BTreeMap<usize, Vec<&BlockScore>> = BTreeMap::new();
    for block in blocks.iter().filter(|block| block.length > 0.0) {
        runs.entry(block.run).or_default().push(block);
    }
    let (mut by_drifts, mut by_steps, mut count) = (0.0, 0.0, 0.0);
    let mut steps = Vec::new();
    for own in runs.values_mut() {
        own.sort_by(|one, other| one.time.total_cmp(&other.time));
        let all = Sum::of(own.iter());
        by_drifts += all.left() - gain_of_drift(own, &all);
        let step = step_of(own);
        by_steps += step.map_or(all.left(), |(left, _)| left);
        steps.extend(step.map(|(left, step)| (all.left() - left, step)));
        // two values, and a time
        count += own.len() as f64 - 2.0 - 1.0;
    }
    let scatter = (by_steps / count.max(1.0)).max(1.0);
    let sure = CERTAIN * CERTAIN * scatter;
    steps.retain(|(gain, _)| *gain > sure);
    let clear = by_drifts - by_steps > sure && by_steps < HALF * by_drifts;
    (clear && !steps.is_empty()).then(|| steps.into_iter().map(|(_, step)| step).collect())
}

/// Squares that a drift takes of what one value leaves of a run.
fn gain_of_drift(own: &[&BlockScore], all: &Sum) -> f64 {
    let middle = own.iter().map(|block| block.length * block.time).sum::<f64>() / all.length;
    let (along, spread) = own.iter().fold((0.0, 0.0), |(along, spread), block| {
        let since = block.time - middle;
        (along + since * (block.score - block.length * all.mean()), spread + block.length * since * since)
    });
    if spread > 0.0 { along * along / spread } else { 0.0 }
}

/// The step that leaves least of a run, and what it leaves; `None` of a single block.
fn step_of(own: &[&BlockScore]) -> Option<(f64, ValueStep)> {
    let at = |place: usize| {
        let (before, after) = own.split_at(place);
        let (first, second) = (Sum::of(before.iter()), Sum::of(after.iter()));
        let time = HALF * (own[place - 1].time + own[place].time);
        let step = ValueStep { run: own[place].run, time, by: second.mean() - first.mean() };
        (first.left() + second.left(), step)
    };
    (1..own.len()).map(at).min_by(|one, other| one.0.total_cmp(&other.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::random::Random;

    /// Two runs of 15 blocks, each of which tells a value to 1 ms and wants so much by its run and time, s.
    fn told(wanted: impl Fn(usize, f64) -> f64) -> Option<Vec<ValueStep>> {
        let (mut random, mut blocks) = (Random::new(5), Vec::new());
        for run in 0..2 {
            for block in 0..15 {
                let (time, length) = (f64::from(block) + 0.5, 1e6);
                let score = length * (wanted(run, time) + 1e-3 * random.normal());
                blocks.push(BlockScore { run, time, score, length });
            }
        }
        steps_of(&blocks)
    }

    #[test]
    fn recovers_a_step_with_its_time_and_its_size() {
        let after = |time: f64, by: f64| if time > 9.0 { by } else { 0.0 };
        let steps = told(|run, time| after(time, [0.03, -0.02][run])).expect("30 ms are told");
        assert!(steps.len() == 2 && steps.iter().all(|step| (step.time - 9.0).abs() < 0.1), "{steps:?}");
        assert!((steps[0].by - 0.03).abs() < 2e-3 && (steps[1].by + 0.02).abs() < 2e-3, "{steps:?}");
        // a run without one has none
        let steps = told(|run, time| if run == 1 { after(time, 0.03) } else { 0.0 }).expect("30 ms are told");
        assert!(steps.len() == 1 && steps[0].run == 1, "{steps:?}");
    }

    #[test]
    fn law_a_drift_is_no_step_and_noise_is_none() {
        assert_eq!(told(|_, time| 3e-3 * time), None);
        assert_eq!(told(|run, time| [2e-3, -1e-3][run] * time), None);
        assert_eq!(told(|_, _| 0.0), None);
    }
}
