//! Derivatives of the deviance by the sizes of the noises, all at once: one sweep forth and its adjoint back.
//!
//! With r and N after a value (the adjoint state and its covariance), u = e/s - Kᵀ r and D = 1/s + Kᵀ N K, the deviance
//! changes by D - u² for each unit of that value's variance, and by gᵀ N g - (gᵀ r)² for each unit of process noise along g
//! before a row. With the parameters where the deviance is least, the innovations there stand for e: at a minimum its
//! place doesn't count. Koopman, Shephard, Biometrika 79 (1992) 823; Durbin, Koopman, *Time Series Analysis by State Space
//! Methods*, Oxford 2012, 7.3.

#![allow(
    clippy::needless_range_loop,
    reason = "i and j are the indices of matrices, in the formulas and here"
)]

use super::linearised::Linearised;
use super::noise::Noise;
use super::sweep::{Interval, Kept, direction, sized};

/// A derivative by a logarithm, and the curvature that is expected there.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Slope {
    /// First derivative.
    pub first: f64,
    /// Second derivative in the mean, as if values were independent.
    pub second: f64,
}

impl Slope {
    /// One variance's part: D - u² and D.
    fn add(&mut self, variance: f64, excess: f64, spread: f64) {
        self.first += 2.0 * variance * excess;
        let share = variance * spread;
        self.second += 4.0 * share * share;
    }

    fn sum(&mut self, other: Self) {
        self.first += other.first;
        self.second += other.second;
    }
}

/// By the logarithm of each size; an unlisted input's memory is not among them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Gradient {
    /// Channels.
    pub channels: Vec<Slope>,
    /// Process noise of each equation.
    pub process: Vec<Slope>,
    /// Timestamps.
    pub jitter: Slope,
    /// The unlisted input's size.
    pub disturbance: Slope,
}

impl Gradient {
    fn zero(noise: &Noise) -> Self {
        Self {
            channels: vec![Slope::default(); noise.channels.len()],
            process: vec![Slope::default(); noise.process.len()],
            ..Self::default()
        }
    }

    /// Adds another run's.
    pub fn add(&mut self, other: &Self) {
        self.channels.iter_mut().zip(&other.channels).for_each(|(own, other)| own.sum(*other));
        self.process.iter_mut().zip(&other.process).for_each(|(own, other)| own.sum(*other));
        self.jitter.sum(other.jitter);
        self.disturbance.sum(other.disturbance);
    }
}

/// Of all runs, after the parameters in `columns` moved by `shift`; `swept` is what [`super::sweep::sweep_columns`] kept of each.
pub fn gradient(
    runs: &[Linearised],
    noise: &Noise,
    columns: &[usize],
    shift: &[f64],
    swept: &[&Kept],
) -> Gradient {
    use rayon::prelude::*;
    let of = |(run, kept): (&Linearised, &&Kept)| of_run(run, noise, columns, shift, kept);
    let parts: Vec<Gradient> = runs.par_iter().zip(swept).map(of).collect();
    let mut sum = Gradient::zero(noise);
    parts.iter().for_each(|part| sum.add(part));
    sum
}

fn of_run(run: &Linearised, noise: &Noise, columns: &[usize], shift: &[f64], kept: &Kept) -> Gradient {
    sized!(run, noise; backward(run, noise, columns, shift, kept))
}

/// The gradient of one run for N states, an unlisted input among them, from the last row to the first.
fn backward<const N: usize>(
    run: &Linearised,
    noise: &Noise,
    columns: &[usize],
    shift: &[f64],
    kept: &Kept,
) -> Gradient {
    let p = columns.len();
    let mut sum = Gradient::zero(noise);
    let mut adjoint = Adjoint::<N> { mean: [0.0; N], spread: [[0.0; N]; N] };
    for row in (0..run.rows()).rev() {
        for value in run.values(row).rev() {
            let s = kept.variance[value];
            if s.is_infinite() {
                continue;
            }
            let own = &kept.columns[value * p..(value + 1) * p];
            let e = kept.innovation[value] - own.iter().zip(shift).map(|(j, by)| j * by).sum::<f64>();
            let gain = &kept.gain[value * N..(value + 1) * N];
            adjoint.take_value(run, noise, value, (e, s, gain), &mut sum);
        }
        match row.checked_sub(1) {
            Some(before) => adjoint.go_back(run, noise, before, &mut sum),
            None => {
                let first = noise.disturbance.map(|unlisted| unlisted.size * unlisted.size);
                adjoint.add_disturbance(run.states, first, &mut sum);
            }
        }
    }
    sum
}

/// The adjoint state r and its covariance N.
struct Adjoint<const N: usize> {
    mean: [f64; N],
    spread: [[f64; N]; N],
}

impl<const N: usize> Adjoint<N> {
    /// Before a value with the innovation e, its variance s and the gain P Hᵀ.
    #[inline]
    fn take_value(
        &mut self,
        run: &Linearised,
        noise: &Noise,
        value: usize,
        (e, s, gain): (f64, f64, &[f64]),
        sum: &mut Gradient,
    ) {
        let (n, measured) = (run.states, &run.measured[value]);
        let observe = &run.observe[value * n..(value + 1) * n];
        let mut through = [0.0; N];
        let (mut along, mut twice) = (0.0, 0.0);
        for i in 0..N {
            let k = gain[i] / s;
            along += k * self.mean[i];
            for j in 0..N {
                through[i] += self.spread[i][j] * gain[j] / s;
            }
            twice += k * through[i];
        }
        let (u, d) = (e / s - along, 1.0 / s + twice);
        let sigma = noise.channels[measured.channel];
        let late = noise.jitter * measured.slope;
        sum.channels[measured.channel].add(sigma * sigma, d - u * u, d);
        sum.jitter.add(late * late, d - u * u, d);
        for (i, h) in observe.iter().enumerate().filter(|(_, h)| **h != 0.0) {
            self.mean[i] += h * u;
            for (j, other) in observe.iter().enumerate() {
                self.spread[i][j] += h * other * d;
            }
            for j in 0..N {
                self.spread[i][j] -= h * through[j];
                self.spread[j][i] -= h * through[j];
            }
        }
    }

    /// Before the interval after a row.
    #[inline]
    fn go_back(&mut self, run: &Linearised, noise: &Noise, row: usize, sum: &mut Gradient) {
        let n = run.states;
        let step = Interval::<N>::new(run, noise, row);
        let dt = run.interval(row);
        for (equation, q) in noise.process.iter().enumerate().take(n).filter(|(_, q)| **q > 0.0) {
            let (mut along, mut twice) = (0.0, 0.0);
            for i in 0..n {
                let g = direction(run, row, equation, i);
                along += g * self.mean[i];
                for j in 0..n {
                    twice += g * self.spread[i][j] * direction(run, row, equation, j);
                }
            }
            sum.process[equation].add(q * q / dt, twice - along * along, twice);
        }
        let late = run.late(row);
        let along: f64 = late.iter().zip(&self.mean).map(|(late, r)| late * r).sum();
        let through = |(late, spread): (&f64, &[f64; N])| -> f64 {
            late * spread.iter().zip(run.late(row)).map(|(spread, late)| spread * late).sum::<f64>()
        };
        let twice: f64 = late.iter().zip(&self.spread).map(through).sum();
        sum.jitter.add(noise.jitter * noise.jitter, twice - along * along, twice);
        let variance = noise.disturbance.map(|_| step.covariance[n][n]);
        self.add_disturbance(n, variance, sum);
        self.mean =
            std::array::from_fn(|j| (0..N).map(|i| step.transition[i][j] * self.mean[i]).sum::<f64>());
        self.spread = back_through(&step.transition, &self.spread);
    }

    /// The unlisted input's part, where there is one with this variance.
    fn add_disturbance(&self, n: usize, variance: Option<f64>, sum: &mut Gradient) {
        if let Some(variance) = variance {
            let excess = self.spread[n][n] - self.mean[n] * self.mean[n];
            sum.disturbance.add(variance, excess, self.spread[n][n]);
        }
    }
}

/// Tᵀ N T, symmetric to the last bit.
fn back_through<const N: usize>(t: &[[f64; N]; N], n: &[[f64; N]; N]) -> [[f64; N]; N] {
    let mut half = [[0.0; N]; N];
    for i in 0..N {
        for k in 0..N {
            let factor = n[i][k];
            for j in 0..N {
                half[i][j] += factor * t[k][j];
            }
        }
    }
    let mut whole = [[0.0; N]; N];
    for i in 0..N {
        for k in 0..N {
            let factor = t[k][i];
            for j in 0..=i {
                whole[i][j] += factor * half[k][j];
            }
        }
    }
    for i in 0..N {
        for j in 0..i {
            whole[j][i] = whole[i][j];
        }
    }
    whole
}
