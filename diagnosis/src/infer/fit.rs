//! Parameters, path and noises together: Gauss-Newton with Levenberg's damping about a path that moves with it.
//!
//! Each round linearises the model about the path, takes the noises by maximum likelihood, solves the reduced normal
//! equations for δθ within the ranges, and moves the path to the smoothed one. A round that raises the deviance is
//! taken back and damped (Bell, SIAM J. Optim. 4 (1994) 626: the iterated Kalman smoother is a Gauss-Newton method).

use super::likelihood::{Sizes, informed, maximise_within, reduced};
use super::linearised::Linearised;
use super::noise::Noise;
use super::paths::{smooth_paths, smooth_paths_damped};
use crate::error::Error;
use crate::statistics::levels::{FEW, FINE, HALF, ROUNDING, SLIGHT};
use crate::statistics::linear::{Reduced, inverse, solve};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// States of a run, n a row.
pub type Path = Vec<f64>;

/// What can be linearised about paths.
pub trait Linearise: Sync {
    /// Every run about its path, at parameters θ, with columns for those asked for, in their order.
    ///
    /// # Errors
    /// The model failed.
    fn linearise(&self, theta: &[f64], paths: &[Path], columns: &[usize]) -> Result<Vec<Linearised>, Error>;

    /// Smallest and largest value of a parameter.
    fn range(&self, parameter: usize) -> (f64, f64);

    /// Whether a parameter is known by how many times it is larger than what it was: it works by its inverse as well as by itself, and
    /// in one round it goes no farther than to half or twice of where it is.
    fn is_relative(&self, _parameter: usize) -> bool {
        false
    }

    /// A size of each state that matters: a path that moves less has settled.
    fn scales(&self) -> &[f64];
}

/// Knobs of a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Most rounds.
    pub rounds: usize,
    /// A round that is expected to gain less deviance than this ends the fit.
    pub enough: f64,
    /// The path has settled when no state moves by more than this share of its scale.
    pub settled: f64,
    /// How often a round that raises the deviance is damped before the fit ends where it is.
    pub damped: usize,
    /// By this much a value a round may raise the deviance: it is that of the model linearised about the path, which moves with it.
    pub rise: f64,
    /// Rounds of the noises' own search in each round: they move on with the path, and must have settled in the end.
    pub noises: usize,
}

impl Options {
    /// Rounds are quadratic near the end. 0.02 of deviance is a hundredth of a standard deviation squared of one parameter; verdicts ask
    /// for hundreds of times it.
    pub const USUAL: Self =
        Self { rounds: 8, enough: SLIGHT, settled: FINE, damped: FEW, rise: FINE, noises: 10 };
}

impl Default for Options {
    fn default() -> Self {
        Self::USUAL
    }
}

/// Where a fit is.
#[derive(Debug, Clone, PartialEq)]
pub struct At {
    /// All parameters.
    pub theta: Vec<f64>,
    /// A path for each run.
    pub paths: Vec<Path>,
    /// Sizes of the noises.
    pub noise: Noise,
}

/// A fit that has ended.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Parameters, paths and noises at its end.
    pub at: At,
    /// The parameters that were free.
    pub free: Vec<usize>,
    /// -2 log likelihood with the free parameters where it is least.
    pub deviance: f64,
    /// Covariance of the free parameters, in their order and units; infinite where the data tell nothing.
    pub covariance: DMatrix<f64>,
    /// The runs, linearised about the end, with columns for the free parameters.
    pub runs: Vec<Linearised>,
    /// Rounds it took.
    pub rounds: usize,
}

impl Fit {
    /// Standard deviation of a free parameter by how far stretches of the log disagree, if that is more.
    pub fn robust_deviation(&self, parameter: usize) -> f64 {
        let own = self.deviation(parameter);
        let columns: Vec<usize> = (0..self.free.len()).collect();
        let Some(place) = self.free.iter().position(|known| *known == parameter) else { return own };
        let robust = super::robust::sandwich(&self.runs, &self.at.noise, &columns);
        robust.map_or(own, |covariance| covariance[(place, place)].max(0.0).sqrt().max(own))
    }

    /// Standard deviation of a free parameter.
    pub fn deviation(&self, parameter: usize) -> f64 {
        let place = self.free.iter().position(|known| *known == parameter);
        place.map_or(f64::INFINITY, |place| self.covariance[(place, place)].sqrt())
    }
}

/// δθ that leaves no range, by solving with what would leave it held at its end.
pub fn step(
    reduced: &Reduced,
    theta: &[f64],
    free: &[usize],
    ranges: &[(f64, f64)],
    damping: f64,
) -> Vec<f64> {
    let mut shift = vec![0.0; free.len()];
    let mut open = informed(reduced);
    loop {
        let mut gram = crate::statistics::linear::submatrix(&reduced.gram, &open);
        for i in 0..open.len() {
            gram[(i, i)] *= 1.0 + damping;
        }
        let held = DVector::from_fn(open.len(), |i, _| {
            let pulls = (0..free.len()).filter(|j| !open.contains(j));
            reduced.score[open[i]] - pulls.map(|j| reduced.gram[(open[i], j)] * shift[j]).sum::<f64>()
        });
        let Some(solution) = solve(&gram, &held) else { return shift };
        let mut left = None;
        for (place, value) in open.iter().zip(&solution) {
            let (least, most) = ranges[*place];
            let to = theta[free[*place]] + value;
            shift[*place] = to.clamp(least, most) - theta[free[*place]];
            if to < least || to > most {
                left = left.or(Some(*place));
            }
        }
        match left {
            Some(place) => open.retain(|known| *known != place),
            None => return shift,
        }
    }
}

/// Where a parameter may go in one round.
fn within_reach(model: &dyn Linearise, parameter: usize, at: f64) -> (f64, f64) {
    let (least, most) = model.range(parameter);
    if !model.is_relative(parameter) || at == 0.0 {
        return (least, most);
    }
    let (one, other) = (HALF * at, at / HALF);
    (least.max(one.min(other)), most.min(one.max(other)))
}

/// Whether a round's reach holds a parameter back, and not its range.
fn is_cut(model: &dyn Linearise, free: &[usize], theta: &[f64], reach: &[(f64, f64)]) -> bool {
    free.iter().zip(reach).any(|(parameter, (least, most))| {
        let (at, range) = (theta[*parameter], model.range(*parameter));
        let same = |end: f64| (at - end).abs() <= ROUNDING * end.abs();
        same(*least) && *least > range.0 || same(*most) && *most < range.1
    })
}

/// The noises of a place by itself, the parameters held there, and the deviance with them. In a round the parameters are free, so that a fit
/// goes far at first; two places, neither of which is the end, are compared by these.
fn noise_held(runs: &[Linearised], from: &Noise, sizes: &Sizes, options: &Options) -> (Noise, f64) {
    let (noise, deviance, _) = maximise_within(runs, &[], from, sizes, options.noises);
    (noise, deviance)
}

/// By how much a step lowers the deviance, by the linear model.
fn predicted_decrease(reduced: &Reduced, shift: &[f64]) -> f64 {
    let shift = DVector::from_column_slice(shift);
    2.0 * shift.dot(&reduced.score) - shift.dot(&(&reduced.gram * &shift))
}

/// Fits the free parameters from a place on. Without `sizes` the noises stay as they are.
///
/// # Errors
/// The model failed at the start, or wherever the fit went.
pub fn fit(
    model: &dyn Linearise,
    start: &At,
    free: &[usize],
    sizes: Option<&Sizes>,
    options: &Options,
) -> Result<Fit, Error> {
    let runs = model.linearise(&start.theta, &start.paths, free)?;
    fit_from(model, start, runs, free, sizes, options)
}

/// Fits from runs that are linearised at the start already, with a column for each free parameter.
///
/// # Errors
/// As [`fit`].
pub fn fit_from(
    model: &dyn Linearise,
    start: &At,
    mut runs: Vec<Linearised>,
    free: &[usize],
    sizes: Option<&Sizes>,
    options: &Options,
) -> Result<Fit, Error> {
    let task = Task { model, free, sizes, options, rise: allowed_rise(&runs, options) };
    let all: Vec<usize> = (0..free.len()).collect();
    let mut at = start.clone();
    let mut best: Option<(At, Vec<Linearised>, f64)> = None;
    let (mut damping, mut rounds) = (Damping { factor: 0.0, failures: 0 }, 0);
    loop {
        rounds += 1;
        let quiet = task.settle_noises(&runs, &mut at.noise);
        let here = reduced(&runs, &at.noise, &all);
        let value = here.square + here.log_det;
        let worse = best.as_ref().is_some_and(|best| task.is_worse(&runs, &at.noise, value, best));
        if worse && damping.failures < options.damped {
            damping.fail();
        } else if !worse {
            best = Some((at.clone(), runs.clone(), value));
        }
        let Some((from, about, _)) = &best else {
            return Err(Error::Model("the model leaves no finite likelihood at its nominal values".into()));
        };
        let last = rounds >= options.rounds || damping.failures >= options.damped;
        if worse && last {
            return Ok(end_fit(from.clone(), about.clone(), free, rounds));
        }
        let here = if worse { reduced(about, &from.noise, &all) } else { here };
        let Round { to, gain, moved } = task.round(from, about, &here, &damping);
        if last || quiet && gain < options.enough && moved < options.settled {
            return Ok(end_fit(from.clone(), about.clone(), free, rounds));
        }
        match model.linearise(&to.theta, &to.paths, free) {
            Ok(there) => (at, runs) = (to, there),
            Err(Error::TooSlow) => return Err(Error::TooSlow),
            Err(_) => {
                // the model can't be followed where the data lead: from the best place with more damping, or not at all
                damping.fail();
                if damping.failures >= options.damped {
                    return Ok(end_fit(from.clone(), about.clone(), free, rounds));
                }
                (at, runs) = (from.clone(), about.clone());
            }
        }
    }
}

/// By how much a round may raise the deviance of so many values.
fn allowed_rise(runs: &[Linearised], options: &Options) -> f64 {
    let values: usize = runs.iter().map(|run| run.measured.len()).sum();
    f64::max(1.0, options.rise * values as f64)
}

/// Levenberg's damping: none at first, then 1, then eight times as much after each further round that failed. Numerical only: it says how soon a
/// fit gives up, and not where it ends.
struct Damping {
    factor: f64,
    failures: usize,
}

impl Damping {
    /// Damps more: a round raised the deviance, or led where the model can't be run.
    fn fail(&mut self) {
        self.failures += 1;
        self.factor = if self.factor == 0.0 { 1.0 } else { 8.0 * self.factor };
    }
}

/// What is fitted.
struct Task<'a> {
    model: &'a dyn Linearise,
    free: &'a [usize],
    sizes: Option<&'a Sizes>,
    options: &'a Options,
    /// A round may raise the deviance by so much.
    rise: f64,
}

/// Where a round leads.
struct Round {
    to: At,
    /// Decrease of the deviance by the linear model.
    gain: f64,
    /// Largest move of a path, in units of the states' scales.
    moved: f64,
}

impl Task<'_> {
    /// Moves the noises on, the parameters free; whether they have settled.
    fn settle_noises(&self, runs: &[Linearised], noise: &mut Noise) -> bool {
        let Some(sizes) = self.sizes else { return true };
        let all: Vec<usize> = (0..self.free.len()).collect();
        let (settled, _, quiet) = maximise_within(runs, &all, noise, sizes, self.options.noises);
        *noise = settled;
        quiet
    }

    /// Whether a place with this deviance is worse than the best one.
    fn is_worse(
        &self,
        runs: &[Linearised],
        noise: &Noise,
        value: f64,
        (best, about, known): &(At, Vec<Linearised>, f64),
    ) -> bool {
        let seems = !value.is_finite() || value > known + self.rise;
        let is = |sizes: &Sizes| {
            let (usual, least) = noise_held(about, &best.noise, sizes, self.options);
            let is_above = |begin: &Noise| {
                let here = noise_held(runs, begin, sizes, self.options).1;
                !here.is_finite() || here > least + self.rise
            };
            // where the parameters are free the noises are often at their floor, and that is too far from what these places need
            is_above(noise) && is_above(&usual)
        };
        seems && self.sizes.is_none_or(is)
    }

    /// A Gauss-Newton step of the parameters within their reach, and the paths that follow it.
    fn round(&self, from: &At, about: &[Linearised], here: &Reduced, damping: &Damping) -> Round {
        let (model, free, scales) = (self.model, self.free, self.model.scales());
        let ranges: Vec<_> = free.iter().map(|one| within_reach(model, *one, from.theta[*one])).collect();
        let shift = step(here, &from.theta, free, &ranges, damping.factor);
        let mut to = from.clone();
        for (parameter, by) in free.iter().zip(&shift) {
            to.theta[*parameter] += by;
        }
        if let (Some(sizes), true) = (self.sizes, is_cut(model, free, &to.theta, &ranges)) {
            // the noises are those of the whole step, too small for what a part of it leaves
            let by: Vec<(usize, f64)> = shift.iter().copied().enumerate().collect();
            let moved: Vec<Linearised> = about.par_iter().map(|run| run.shifted(&by)).collect();
            to.noise = noise_held(&moved, &to.noise, sizes, self.options).0;
        }
        let moved = if damping.factor > 0.0 && damping.failures > 1 {
            // states follow a damped step, too: a share of the way
            let share = 1.0 / (1.0 + damping.factor);
            smooth_paths_damped(&mut to.paths, about, &to.noise, &shift, scales, share)
        } else {
            smooth_paths(&mut to.paths, about, &to.noise, &shift, scales)
        };
        Round { to, gain: predicted_decrease(here, &shift), moved }
    }
}

/// The fit that ends at a place about which the runs are linearised.
fn end_fit(at: At, runs: Vec<Linearised>, free: &[usize], rounds: usize) -> Fit {
    let all: Vec<usize> = (0..free.len()).collect();
    let here = reduced(&runs, &at.noise, &all);
    let told = informed(&here);
    let mut covariance = DMatrix::from_diagonal_element(free.len(), free.len(), f64::INFINITY);
    if let Some(inverse) = inverse(&crate::statistics::linear::submatrix(&here.gram, &told)) {
        for (i, a) in told.iter().enumerate() {
            for (j, b) in told.iter().enumerate() {
                covariance[(*a, *b)] = inverse[(i, j)];
            }
        }
    }
    Fit { deviance: here.square + here.log_det, at, free: free.to_vec(), covariance, runs, rounds }
}
