//! The sizes of the noises by maximum likelihood, parameters eliminated: a quasi-Newton search in their logarithms.
//!
//! -2 log L(φ) = Σ e²/s + log s - gᵀ Γ⁻¹ g with the score g and the Gram matrix Γ of the innovations' sensitivity columns
//! (profile likelihood of θ). Gradients by the adjoint of the sweep (`gradient.rs`), but for the memory of an unlisted input.
//! Nocedal, Wright, *Numerical Optimization*, Springer 2006, 6.1 (BFGS) and 3.1 (backtracking).

use super::gradient::{Slope, gradient};
use super::linearised::Linearised;
use super::noise::Noise;
use super::policy::INFER;
use super::sweep::{Kept, sweep, sweep_columns};
use crate::statistics::levels::STEP;
use crate::statistics::linear::{Reduced, solve};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Which sizes are free, and between what.
#[derive(Debug, Clone, PartialEq)]
pub struct Sizes {
    /// Least standard deviation of each channel whose noise is not stated; `None`: stated.
    pub channels: Vec<Option<f64>>,
    /// Least and largest process noise of each equation.
    pub process: Vec<(f64, f64)>,
    /// Equations without process noise of their own: it stays at its least. Empty: none of them.
    pub pinned: Vec<bool>,
    /// Largest standard deviation of the timestamps, s; 0: they are exact.
    pub jitter: f64,
}

/// A size's place, least and largest logarithm.
#[derive(Debug, Clone, Copy)]
struct Slot {
    which: Which,
    range: (f64, f64),
}

#[derive(Debug, Clone, Copy)]
enum Which {
    Channel(usize),
    Process(usize),
    Jitter,
    Disturbance,
    Memory,
}

impl Sizes {
    /// Whether an equation's process noise stays at its least.
    pub fn is_pinned(&self, equation: usize) -> bool {
        self.pinned.get(equation).copied().unwrap_or(false)
    }

    /// These sizes with process noise at its least in the equations that are marked.
    pub fn with_pinned(&self, pinned: Vec<bool>) -> Self {
        Self { pinned, ..self.clone() }
    }

    /// A noise without what is pinned.
    pub fn quieted(&self, mut noise: Noise) -> Noise {
        for (equation, (least, _)) in self.process.iter().enumerate() {
            if self.is_pinned(equation) {
                noise.process[equation] = *least;
            }
        }
        noise
    }

    fn slots(&self, runs: &[Linearised], noise: &Noise) -> Vec<Slot> {
        let mut slots = Vec::new();
        let mut slot = |which, least: f64, most: f64| {
            if least < most {
                slots.push(Slot { which, range: (libm::log(least), libm::log(most)) });
            }
        };
        for (channel, least) in self.channels.iter().enumerate() {
            if let Some(least) = least {
                slot(Which::Channel(channel), *least, least * INFER.widest);
            }
        }
        for (equation, (least, most)) in self.process.iter().enumerate() {
            if !self.is_pinned(equation) {
                slot(Which::Process(equation), *least, *most);
            }
        }
        slot(Which::Jitter, 1e-4 * self.jitter, self.jitter);
        if let Some(unlisted) = noise.disturbance {
            let (least, most) = self.process[unlisted.equation];
            let (shortest, longest) = spans(runs);
            slot(Which::Disturbance, least / longest.sqrt(), most / shortest.sqrt());
            slot(Which::Memory, 2.0 * shortest, longest);
        }
        slots
    }
}

/// Mean interval and longest run, s.
fn spans(runs: &[Linearised]) -> (f64, f64) {
    let length = |run: &Linearised| run.time.last().copied().unwrap_or(0.0) - run.time[0];
    let longest = runs.iter().map(length).fold(0.0, f64::max);
    let (all, rows) =
        runs.iter().fold((0.0, 0.0), |(all, rows), run| (all + length(run), rows + run.rows() as f64));
    (all / f64::max(rows, 1.0), longest)
}

fn read(noise: &Noise, which: Which) -> f64 {
    match which {
        Which::Channel(channel) => noise.channels[channel],
        Which::Process(equation) => noise.process[equation],
        Which::Jitter => noise.jitter,
        Which::Disturbance => noise.disturbance.map_or(0.0, |unlisted| unlisted.size),
        Which::Memory => noise.disturbance.map_or(0.0, |unlisted| unlisted.memory),
    }
}

fn written(noise: &Noise, slots: &[Slot], at: &DVector<f64>) -> Noise {
    let mut noise = noise.clone();
    for (slot, value) in slots.iter().zip(at) {
        let value = libm::exp(*value);
        match slot.which {
            Which::Channel(channel) => noise.channels[channel] = value,
            Which::Process(equation) => noise.process[equation] = value,
            Which::Jitter => noise.jitter = value,
            Which::Disturbance => {
                if let Some(unlisted) = &mut noise.disturbance {
                    unlisted.size = value;
                }
            }
            Which::Memory => {
                if let Some(unlisted) = &mut noise.disturbance {
                    unlisted.memory = value;
                }
            }
        }
    }
    noise
}

/// All runs together.
pub fn reduced(runs: &[Linearised], noise: &Noise, columns: &[usize]) -> Reduced {
    let parts: Vec<Reduced> = runs.par_iter().map(|run| sweep(run, noise, columns)).collect();
    let mut sum = Reduced::zero(columns.len());
    parts.iter().for_each(|part| sum.add(part));
    sum
}

/// -2 log likelihood with the parameters where it is least.
pub fn profile(reduced: &Reduced) -> f64 {
    reduced.square - best_shift(reduced).1 + reduced.log_det
}

/// Where the parameters are best, and what is gained by going there.
fn best_shift(reduced: &Reduced) -> (Vec<f64>, f64) {
    let told = informed(reduced);
    let gram = crate::statistics::linear::submatrix(&reduced.gram, &told);
    let score = crate::statistics::linear::subvector(&reduced.score, &told);
    let mut shift = vec![0.0; reduced.score.len()];
    let Some(solution) = solve(&gram, &score) else { return (shift, 0.0) };
    told.iter().zip(solution.iter()).for_each(|(place, by)| shift[*place] = *by);
    (shift, solution.dot(&score))
}

/// Parameters of which the data say anything.
pub fn informed(reduced: &Reduced) -> Vec<usize> {
    (0..reduced.score.len()).filter(|i| reduced.gram[(*i, *i)] > 0.0).collect()
}

/// The most likely sizes from these on, and the deviance there. Columns are those of the parameters that are free.
pub fn maximise(runs: &[Linearised], columns: &[usize], start: &Noise, sizes: &Sizes) -> (Noise, f64) {
    let (noise, deviance, _) = maximise_within(runs, columns, start, sizes, INFER.rounds);
    (noise, deviance)
}

/// As [`maximise`], in at most so many rounds; and whether it came to its end.
pub fn maximise_within(
    runs: &[Linearised],
    columns: &[usize],
    start: &Noise,
    sizes: &Sizes,
    rounds: usize,
) -> (Noise, f64, bool) {
    let slots = sizes.slots(runs, start);
    let clamped =
        |at: DVector<f64>| DVector::from_fn(at.len(), |i, _| at[i].clamp(slots[i].range.0, slots[i].range.1));
    let first = slots.iter().map(|slot| libm::log(read(start, slot.which).max(1e-300)));
    let at = clamped(DVector::from_iterator(slots.len(), first));
    let deviance = |at: &DVector<f64>| profile(&reduced(runs, &written(start, &slots, at), columns));
    let swept = |at: DVector<f64>| Swept::new(runs, columns, written(start, &slots, &at), at);
    let valleys = with_less_process_noise(&at, &slots).into_iter().map(&clamped);
    let mut here = lowest(swept(at), valleys, &deviance, &swept);
    let slopes = |here: &Swept| derivatives(runs, columns, here, &slots, &deviance);
    let (mut gradient, curvature) = slopes(&here);
    let mut inverse = DMatrix::from_diagonal(&curvature.map(|second| 1.0 / second.max(INFER.flat)));
    let mut ended = false;
    for round in 0..rounds {
        let direction = held_within(-&inverse * &gradient, &here.at, &gradient, &slots);
        let longest = direction.amax();
        if longest < 1e-6 {
            ended = true;
            break;
        }
        let length = (INFER.longest_move / longest).min(1.0);
        let decrease = -gradient.dot(&direction);
        let try_at = |length: f64| swept(clamped(&here.at + &direction * length));
        let Some(there) = backtracked(here.value, decrease, length, &try_at) else {
            ended = true;
            break;
        };
        ended = here.value - there.value < INFER.ends;
        if ended || round + 1 == rounds {
            here = there;
            break;
        }
        let next = slopes(&there).0;
        update_inverse(&mut inverse, &(&there.at - &here.at), &(&next - &gradient));
        (here, gradient) = (there, next);
    }
    (here.noise, here.value, ended)
}

/// Where the search begins: what an effect explains may have been the process noise's, and beyond a ridge there is a valley with less of it.
fn lowest(
    here: Swept,
    valleys: impl Iterator<Item = DVector<f64>>,
    deviance: &dyn Fn(&DVector<f64>) -> f64,
    swept: &dyn Fn(DVector<f64>) -> Swept,
) -> Swept {
    let all = valleys.map(|less| (deviance(&less), less));
    let lowest = all.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(there, _)| *there < here.value);
    lowest.map_or(here, |(_, at)| swept(at))
}

/// The first of ever shorter steps that lowers the deviance by a share of what it is predicted to (Armijo's rule: Nocedal and Wright, Numerical
/// Optimization, section 3.1, whose share this is); nothing where none of a few does.
fn backtracked(
    value: f64,
    predicted_decrease: f64,
    mut length: f64,
    try_at: &dyn Fn(f64) -> Swept,
) -> Option<Swept> {
    (0..8).find_map(|_| {
        let there = try_at(length);
        let good =
            there.value.is_finite() && there.value <= value - 1e-4 * length * predicted_decrease.max(0.0);
        length *= if good { 1.0 } else { 0.35 };
        good.then_some(there)
    })
}

/// A place of the search with what one sweep of every run gave there: the deviance, and what its gradient needs.
struct Swept {
    at: DVector<f64>,
    noise: Noise,
    value: f64,
    /// Where the parameters are best.
    shift: Vec<f64>,
    kept: Vec<Kept>,
}

impl Swept {
    fn new(runs: &[Linearised], columns: &[usize], noise: Noise, at: DVector<f64>) -> Self {
        let parts: Vec<(Reduced, Kept)> =
            runs.par_iter().map(|run| sweep_columns(run, &noise, columns)).collect();
        let mut sum = Reduced::zero(columns.len());
        parts.iter().for_each(|(part, _)| sum.add(part));
        let kept = parts.into_iter().map(|(_, kept)| kept).collect();
        Self { value: profile(&sum), shift: best_shift(&sum).0, at, noise, kept }
    }
}

/// Places with less process noise than this one, of all equations or of one.
fn with_less_process_noise(at: &DVector<f64>, slots: &[Slot]) -> Vec<DVector<f64>> {
    let equations: Vec<usize> =
        (0..slots.len()).filter(|slot| matches!(slots[*slot].which, Which::Process(_))).collect();
    let by = |which: &[usize], share: f64| {
        let mut to = at.clone();
        which.iter().for_each(|slot| to[*slot] += libm::log(share));
        to
    };
    let all = INFER.less_process.iter().map(|share| by(&equations, *share));
    let each = equations.iter().map(|slot| by(&[*slot], INFER.less_process[1]));
    if equations.is_empty() { Vec::new() } else { all.chain(each).collect() }
}

/// First derivatives, and the second in the mean.
fn derivatives(
    runs: &[Linearised],
    columns: &[usize],
    here: &Swept,
    slots: &[Slot],
    deviance: &impl Fn(&DVector<f64>) -> f64,
) -> (DVector<f64>, DVector<f64>) {
    let kept: Vec<&Kept> = here.kept.iter().collect();
    let all = gradient(runs, &here.noise, columns, &here.shift, &kept);
    let mut first = DVector::zeros(slots.len());
    let mut second = DVector::zeros(slots.len());
    for (i, slot) in slots.iter().enumerate() {
        let slope = match slot.which {
            Which::Channel(channel) => all.channels[channel],
            Which::Process(equation) => all.process[equation],
            Which::Jitter => all.jitter,
            Which::Disturbance => all.disturbance,
            Which::Memory => {
                // the deviance is smooth and exact to 1e-9: far from rounding, and short against 1, over which it bends
                let step = if here.at[i] + STEP > slot.range.1 { -STEP } else { STEP };
                let mut to = here.at.clone();
                to[i] += step;
                // a time constant is known about as well as the size that goes with it
                Slope { first: (deviance(&to) - here.value) / step, second: all.disturbance.second }
            }
        };
        (first[i], second[i]) = (slope.first, slope.second);
    }
    (first, second)
}

/// A direction that leaves no range: what stands at an end and would go beyond stays.
fn held_within(
    direction: DVector<f64>,
    at: &DVector<f64>,
    gradient: &DVector<f64>,
    slots: &[Slot],
) -> DVector<f64> {
    let stuck = |i: usize| {
        let (least, most) = slots[i].range;
        at[i] <= least && gradient[i] > 0.0 || at[i] >= most && gradient[i] < 0.0
    };
    let free = DVector::from_fn(at.len(), |i, _| if stuck(i) { 0.0 } else { direction[i] });
    // what is left may lead upwards: then straight down, slowly
    if free.dot(gradient) < 0.0 {
        return free;
    }
    let size = gradient.amax().max(1.0);
    DVector::from_fn(at.len(), |i, _| if stuck(i) { 0.0 } else { -gradient[i] / size })
}

/// The BFGS update of the inverse Hessian, left out where curvature is not positive.
fn update_inverse(inverse: &mut DMatrix<f64>, moved: &DVector<f64>, change: &DVector<f64>) {
    let along = moved.dot(change);
    if along <= 1e-12 {
        return;
    }
    let through = &*inverse * change;
    let factor = (1.0 + change.dot(&through) / along) / along;
    *inverse += moved * moved.transpose() * factor;
    let cross = moved * through.transpose();
    *inverse -= (&cross + cross.transpose()) / along;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_how_loud_a_sensor_may_be_beside_its_least() {
        let sizes =
            Sizes { channels: vec![Some(1e-7)], process: Vec::new(), pinned: Vec::new(), jitter: 0.0 };
        let none = Noise { channels: vec![1.0], process: Vec::new(), jitter: 0.0, disturbance: None };
        let slots = sizes.slots(&[], &none);
        let within = |sd: f64| (slots[0].range.0..=slots[0].range.1).contains(&libm::log(sd));
        // the least is 1e-7 of what the channel shows, which it may be off by altogether and a few times that; a billion times the least
        // is as far as doubles tell one column of a fit from another
        assert!(within(1e-7 * 1.0001) && within(90.0) && !within(110.0));
    }
}
