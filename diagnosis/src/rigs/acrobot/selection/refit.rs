//! Fitting the values of the active candidates through the units: Gauss-Newton with bounds and a careful step.

use super::Questioned;
use super::evaluation::Evaluation;
use crate::error::Error;
use crate::rigs::acrobot::candidates::{Candidate, continuous};
use crate::rigs::acrobot::channels::Measures;
use crate::rigs::acrobot::residual::{Perturbation, Signal, Tracked};
use crate::rigs::acrobot::selection::policy::SELECTION;
use crate::statistics::linear::{Reduced, solve, submatrix, subvector};

/// Fits `active` from a point; discrete ones stay where they are.
///
/// # Errors
/// A unit failed even at the point to begin with.
pub fn refit(
    cut: &mut Tracked,
    candidates: &[Candidate],
    start: &[f64],
    active: &[usize],
) -> Result<Evaluation, Error> {
    fitted(cut, candidates, start, active, f64::INFINITY, |_, best| some_ran_away(best))
}

/// The same for what may be kept: where the arm sticks, a window in which more is left than noise leaves is settled anew at each linearisation.
/// A fit that is only compared may be a little off. Ended as soon as the deviance is not going to decrease to `enough`.
///
/// # Errors
/// A unit failed even at the point to begin with.
pub fn refit_closely(
    cut: &mut Tracked,
    candidates: &[Candidate],
    start: &[f64],
    active: &[usize],
    enough: f64,
) -> Result<Evaluation, Error> {
    fitted(cut, candidates, start, active, enough, some_doubted)
}

/// The same, ended as soon as the deviance is not going to decrease to `enough`.
///
/// # Errors
/// A unit failed even at the point to begin with.
pub(super) fn refit_towards(
    cut: &mut Tracked,
    candidates: &[Candidate],
    start: &[f64],
    active: &[usize],
    enough: f64,
) -> Result<Evaluation, Error> {
    fitted(cut, candidates, start, active, enough, |_, best| some_ran_away(best))
}

/// By how much the next step of a fit is damped, and by how much it goes beyond what columns predict.
struct StepSize {
    damping: f64,
    stride: f64,
    /// Damping of the first step after a refused one.
    shorter: f64,
}

impl StepSize {
    /// A step was taken that brought more than its columns predict, if `straight`.
    fn taken(&mut self, straight: bool) {
        self.stride = if straight && self.damping == 0.0 { SELECTION.stretch * self.stride } else { 1.0 };
        self.damping *= 0.1;
    }

    /// A step was refused: the next one is shorter. Whether there is a next one.
    fn refused(&mut self) -> bool {
        if self.stride > 1.0 {
            self.stride = 1.0;
            return true;
        }
        self.damping = (10.0 * self.damping).max(self.shorter);
        self.damping <= 1e4
    }
}

/// Fits `active` from `start`, by chord steps; where the arm sticks and the first evaluation is `doubted`, by a linearisation at each.
fn fitted(
    cut: &mut Tracked,
    candidates: &[Candidate],
    start: &[f64],
    active: &[usize],
    enough: f64,
    doubted: fn(&Tracked, &Evaluation) -> bool,
) -> Result<Evaluation, Error> {
    let free = continuous(candidates, active);
    let (mut best, chords) = first_evaluation(cut, candidates, start, &free, doubted)?;
    let judge = if chords { chord } else { linearised };
    // where each step settles them anew, a refused one must leave no trace
    let mut settled = cut.nuisances.clone();
    let shorter = if cut.policy().lattice { SELECTION.shorter_seen } else { SELECTION.shorter };
    let mut step = StepSize { damping: 0.0, stride: 1.0, shorter };
    for _ in 0..SELECTION.rounds {
        let Some((next, predicted)) = propose(&best, candidates, &free, &step) else { break };
        let least = if step.damping < shorter { SELECTION.settled } else { SELECTION.refused };
        if predicted < least || best.deviance() - SELECTION.reach * predicted > enough {
            break;
        }
        // columns are wanted only of a step that is taken
        let lower = |bare: Evaluation| bare.deviance() < best.deviance();
        let taken = !cut.policy().steady || judge(cut, candidates, &next, &[]).is_ok_and(lower);
        let trial = if taken { judge(cut, candidates, &next, &free).ok() } else { None };
        if let Some(trial) = trial.filter(|trial| trial.deviance() < best.deviance()) {
            let decrease = best.deviance() - trial.deviance();
            step.taken(decrease > SELECTION.refit_straight * step.stride * predicted);
            best = trial;
            settled = cut.nuisances.clone();
            continue;
        }
        if predicted < SELECTION.refused && step.stride == 1.0 {
            break;
        }
        // what the refused step did to nuisances is no beginning for the next one
        if chords {
            cut.restore_linearised();
        } else {
            cut.restore(&settled);
        }
        if !step.refused() {
            break;
        }
    }
    if !chords {
        cut.restore(&settled);
    }
    Ok(best)
}

/// Where a fit begins, and whether it goes on by chord steps: columns and start states of another friction hold for no window in which the
/// arm sticks.
fn first_evaluation(
    cut: &mut Tracked,
    candidates: &[Candidate],
    start: &[f64],
    free: &[usize],
    doubted: fn(&Tracked, &Evaluation) -> bool,
) -> Result<(Evaluation, bool), Error> {
    cut.restore_linearised();
    let first = chord(cut, candidates, start, free)?;
    let sticks = free.iter().any(|index| candidates[*index].sticks());
    let chords = cut.policy().lattice || !sticks || !doubted(cut, &first);
    Ok((if chords { first } else { linearised(cut, candidates, start, free)? }, chords))
}

/// The coordinate of the effect and the deviance of its own fit: where the last linearisation predicts little more decrease, it is that
/// one, less what they predict.
pub(super) fn own_fit(cut: &mut Tracked, asked: &Questioned<'_>) -> Result<(f64, f64), Error> {
    let Questioned { candidates, last, active, effect, .. } = *asked;
    let free = continuous(candidates, active);
    let predicted = last
        .predicted_decrease(&free)
        .filter(|predicted| !cut.policy().lattice && *predicted < SELECTION.refused);
    if let Some(predicted) = predicted {
        cut.restore_linearised();
        return Ok((last.point[effect], last.deviance() - predicted));
    }
    let fit = refit_closely(cut, candidates, &last.point, active, f64::INFINITY)?;
    let fit = settled(cut, fit)?;
    Ok((fit.point[effect], fit.deviance()))
}

/// A fit with nuisances settled, but for images: made anew, they would differ by the lattice.
pub(super) fn settled(cut: &mut Tracked, fit: Evaluation) -> Result<Evaluation, Error> {
    if cut.policy().lattice { Ok(fit) } else { Evaluation::at(cut, &fit.point, &[]) }
}

/// A chord step to a point, with the sensitivities of the free values.
fn chord(
    cut: &mut Tracked,
    candidates: &[Candidate],
    point: &[f64],
    free: &[usize],
) -> Result<Evaluation, Error> {
    Evaluation::chord(cut, point, &derivatives(candidates, point, free))
}

/// A linearisation at a point, with the sensitivities of the free values.
fn linearised(
    cut: &mut Tracked,
    candidates: &[Candidate],
    point: &[f64],
    free: &[usize],
) -> Result<Evaluation, Error> {
    Evaluation::at(cut, point, &derivatives(candidates, point, free))
}

/// A small step of each free candidate, for its derivative.
fn derivatives(candidates: &[Candidate], point: &[f64], free: &[usize]) -> Vec<Perturbation> {
    let derivative = |index: &usize| Perturbation {
        candidate: *index,
        by: candidates[*index].derivative_step(point[*index]),
    };
    free.iter().map(derivative).collect()
}

/// A step within the bounds and the decrease it predicts; an active value that a bound stops is left there and the
/// others are solved for again.
fn propose(
    best: &Evaluation,
    candidates: &[Candidate],
    free: &[usize],
    step: &StepSize,
) -> Option<(Vec<f64>, f64)> {
    let total = followed(best, candidates, free);
    let mut moving: Vec<usize> = (0..free.len()).collect();
    let mut next = best.point.clone();
    for _ in 0..=free.len() {
        if moving.is_empty() {
            return None;
        }
        let mut gram = submatrix(&total.gram, &moving);
        for i in 0..moving.len() {
            gram[(i, i)] *= 1.0 + step.damping;
        }
        let score = subvector(&total.score, &moving);
        let shift = solve(&gram, &score)?;
        let mut stopped = Vec::new();
        next.clone_from(&best.point);
        for (i, place) in moving.iter().enumerate() {
            let candidate = &candidates[free[*place]];
            let x = best.point[free[*place]];
            let target = limited(candidate, x, x + step.stride * shift[i]);
            let within = target.clamp(candidate.range.0, candidate.range.1);
            if within != target && within == x {
                stopped.push(*place);
            }
            next[free[*place]] = within;
        }
        if stopped.is_empty() {
            return Some((next, shift.dot(&score)));
        }
        moving.retain(|place| !stopped.contains(place));
    }
    None
}

/// The machine ran away in this window, and no tangent says anything of it.
pub(super) fn ran_away(block: &Reduced) -> bool {
    block.square > SELECTION.runaway * block.freedom.max(1.0)
}

/// Some windows ran away.
fn some_ran_away(best: &Evaluation) -> bool {
    best.reduced.iter().any(ran_away)
}

/// Encoders are fine enough to see how the arm sticks, and more is left in some windows than noise leaves.
fn some_doubted(cut: &Tracked, best: &Evaluation) -> bool {
    let angle = |signal: &Signal| matches!(signal.measures, Measures::Angle | Measures::VisionAngle);
    let mut sigmas = cut.signals().iter().zip(&best.sigmas);
    let fine = sigmas.any(|(signal, sigma)| angle(signal) && signal.known.unwrap_or(*sigma) < SELECTION.fine);
    if !fine || cut.nuisances.in_vain {
        return false;
    }
    let doubted =
        |block: &Reduced| block.square > block.freedom + SELECTION.doubt * (2.0 * block.freedom).sqrt();
    best.reduced.iter().any(doubted)
}

/// Sums over the blocks; where the arm sticks, without those that ran away: a start state may be lost there that is found again with
/// another friction, and no tangent says so.
fn followed(best: &Evaluation, candidates: &[Candidate], free: &[usize]) -> Reduced {
    if !some_ran_away(best) || !free.iter().any(|index| candidates[*index].sticks()) {
        return best.total.clone();
    }
    let mut sum = Reduced::zero(best.perturbations.len());
    best.reduced.iter().filter(|block| !ran_away(block)).for_each(|block| sum.add(block));
    sum
}

/// No more than a factor of three at once for what is already on and works by its size.
fn limited(candidate: &Candidate, x: f64, wanted: f64) -> f64 {
    match candidate.motion {
        crate::rigs::acrobot::candidates::Motion::Saturation { .. } if x > 0.0 => {
            wanted.clamp(x / 3.0, 3.0 * x)
        }
        _ => wanted,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::candidates::{Cuts, Motion, Side};
    use crate::rigs::acrobot::selection::examples::{candidate, toy};

    #[test]
    fn value_a_window_ran_away_that_leaves_thirty_times_what_noise_does() {
        let runs = |square: f64, freedom: f64| ran_away(&Reduced { square, freedom, ..Reduced::zero(0) });
        assert_eq!([290.0, 310.0].map(|square| runs(square, 10.0)), [false, true]);
        // a window with hardly any freedom has as many as one
        assert_eq!([29.0, 31.0].map(|square| runs(square, 0.1)), [false, true]);
    }

    #[test]
    fn value_a_saturation_moves_by_three_times_at_most() {
        let any = candidate(Side::Plant, true);
        let saturation = Candidate { motion: Motion::Saturation { cuts: Cuts::Torque }, ..any.clone() };
        let moved = [0.1, 1.5, 10.0].map(|wanted| limited(&saturation, 2.0, wanted));
        assert_eq!(moved, [2.0 / 3.0, 1.5, 6.0]);
        // from none to anything, and what isn't one as it likes
        assert_eq!((limited(&saturation, 0.0, 10.0), limited(&any, 2.0, 10.0)), (10.0, 10.0));
    }

    #[test]
    fn value_a_fit_ends_that_foretells_next_to_nothing() {
        let at = |decrease: f64| {
            let candidates = [candidate(Side::Plant, false)];
            let fit = refit(&mut toy(move |x| vec![decrease.sqrt() - x[0]]), &candidates, &[0.0], &[0]);
            fit.expect("runs").point[0]
        };
        // 0.02 of deviance
        assert_eq!(at(0.018), 0.0);
        assert!((at(0.022) - 0.022_f64.sqrt()).abs() < 1e-9);
    }

    #[test]
    fn value_a_fit_ends_that_would_not_come_near_enough_by_three_times_what_it_foretells() {
        let at = |enough: f64| {
            let candidates = [candidate(Side::Plant, false)];
            // 110 of deviance, of which 10 go
            let mut cut = toy(|x| vec![10.0_f64.sqrt() - x[0], 10.0]);
            refit_towards(&mut cut, &candidates, &[0.0], &[0], enough).expect("runs").point[0]
        };
        assert_eq!(at(78.0), 0.0);
        assert!((at(82.0) - 10.0_f64.sqrt()).abs() < 1e-9);
    }

    #[test]
    fn value_a_fit_of_its_own_is_foretold_where_that_is_less_than_a_standard_error() {
        let at = |decrease: f64| {
            let candidates = [candidate(Side::Plant, false)];
            let mut cut = toy(move |x| vec![decrease.sqrt() - x[0]]);
            let last = linearised(&mut cut, &candidates, &[0.0], &[0]).expect("runs");
            let asked =
                Questioned { candidates: &candidates, last: &last, active: &[0], effect: 0, steps: &[] };
            let (x, deviance) = own_fit(&mut cut, &asked).expect("runs");
            assert!(deviance.abs() < 1e-9, "{deviance}");
            x
        };
        assert_eq!(at(0.9), 0.0);
        assert!((at(1.1) - 1.1_f64.sqrt()).abs() < 1e-9);
    }

    #[test]
    fn value_a_start_is_doubted_beyond_what_noise_does_and_where_encoders_are_fine() {
        let doubts = |square: f64, sigma: f64| {
            let cut = toy(|_| vec![0.0]);
            let mut best = crate::rigs::acrobot::selection::examples::evaluation(&[], &[], &[]);
            (best.reduced, best.sigmas) =
                (vec![Reduced { square, freedom: 8.0, ..Reduced::zero(0) }], vec![sigma]);
            some_doubted(&cut, &best)
        };
        // 8 and 4.5 times 4
        assert_eq!([24.0, 28.0].map(|square| doubts(square, 1e-6)), [false, true]);
        // encoders of 0.2 mrad
        assert_eq!([1.8e-4, 2.2e-4].map(|sigma| doubts(28.0, sigma)), [true, false]);
    }

    #[test]
    fn value_a_fit_takes_eight_steps_at_most() {
        // each step is one further, and leaves 1/e of the residual
        let mut cut = toy(|x| vec![1e8 * libm::exp(-x[0])]);
        let fit = refit(&mut cut, &[candidate(Side::Plant, false)], &[0.0], &[0]).expect("runs");
        assert_eq!(fit.point[0].round(), 8.0);
    }
}
