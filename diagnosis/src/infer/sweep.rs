//! The Kalman sweep over a run: innovations and their sensitivities, states eliminated.
//!
//! With δx = m + M δθ + ξ, ξ ~ N(0, P), a value r = H δx + D δθ + ε has the innovation e - J δθ with e = r - H m,
//! J = H M + D and variance s = H P Hᵀ + R. Values of a row are taken one after the other, which needs no matrix inverse
//! (their noises are independent). An unlisted input with a memory is one more state.

#![allow(
    clippy::needless_range_loop,
    reason = "i and j are the indices of matrices, in the formulas and here"
)]

use super::linearised::{Follows, Linearised};
use super::noise::Noise;
use crate::statistics::linear::Reduced;
use nalgebra::{DMatrix, DVector};

/// Most states, the unlisted input among them.
pub const MOST_STATES: usize = 24;

/// What the backward pass needs: one entry a value or row.
#[derive(Debug, Default)]
pub struct Kept {
    /// Innovation of each value, in its channel's unit.
    pub innovation: Vec<f64>,
    /// Its variance.
    pub variance: Vec<f64>,
    /// P Hᵀ of each value, before it was taken in.
    pub gain: Vec<f64>,
    /// m of each row after its values.
    pub mean: Vec<f64>,
    /// P of each row after its values.
    pub covariance: Vec<f64>,
    /// Sum of the scores up to each row, a number a column.
    pub score: Vec<f64>,
    /// Sensitivity of each innovation, a number a column.
    pub columns: Vec<f64>,
    /// Means, covariances and scores of the rows aren't wanted.
    values_only: bool,
}

/// Runs the filter over a run, with the columns of the chosen parameters.
pub fn sweep(run: &Linearised, noise: &Noise, columns: &[usize]) -> Reduced {
    dispatch(run, noise, columns, None)
}

/// Runs the filter without columns, and keeps what smoothing needs: N numbers a state of a row, where N is the size of [`sized`].
pub fn sweep_kept(run: &Linearised, noise: &Noise) -> (Reduced, Kept) {
    let mut kept = Kept::default();
    let reduced = dispatch(run, noise, &[], Some(&mut kept));
    (reduced, kept)
}

/// Runs the filter with these columns, and gives the sum of their scores up to each row, too.
pub fn sweep_scores(run: &Linearised, noise: &Noise, columns: &[usize]) -> (Reduced, Vec<f64>) {
    let mut kept = Kept::default();
    let reduced = dispatch(run, noise, columns, Some(&mut kept));
    (reduced, kept.score)
}

/// Runs the filter with these columns, and keeps innovations with their columns and gains: what a gradient needs.
pub fn sweep_columns(run: &Linearised, noise: &Noise, columns: &[usize]) -> (Reduced, Kept) {
    let mut kept = Kept { values_only: true, ..Kept::default() };
    let reduced = dispatch(run, noise, columns, Some(&mut kept));
    (reduced, kept)
}

/// States with the unlisted input.
pub fn dimension(run: &Linearised, noise: &Noise) -> usize {
    run.states + usize::from(noise.disturbance.is_some())
}

/// Calls a function for as many states as there are, or the next larger size that it is compiled for: states that nothing moves change no bit,
/// and each size takes seconds to compile.
macro_rules! sized {
    ($run:expr, $noise:expr; $of:ident($($argument:expr),*)) => {
        $crate::infer::sweep::sized!(@ $crate::infer::sweep::dimension($run, $noise), $of, ($($argument),*); 0 1 2 3 4 5 6 8 10 12 16 24)
    };
    (@ $n:expr, $of:ident, $arguments:tt; $($size:literal)*) => {
        match $n {
            $(..=$size => $crate::infer::sweep::sized!(@call $of, $size, $arguments),)*
            more => unreachable!("{more} states; the pipeline refuses more than {}", $crate::infer::sweep::MOST_STATES),
        }
    };
    (@call $of:ident, $size:literal, ($($argument:expr),*)) => { $of::<$size>($($argument),*) };
}
pub(super) use sized;

fn dispatch(run: &Linearised, noise: &Noise, columns: &[usize], kept: Option<&mut Kept>) -> Reduced {
    sized!(run, noise; filter(run, noise, columns, kept))
}

/// Transition of one interval with the unlisted input as the last state, and the covariance of the process noise.
pub struct Interval<const N: usize> {
    /// ∂x(k+1)/∂x(k).
    pub transition: [[f64; N]; N],
    /// Covariance of what the process noise adds.
    pub covariance: [[f64; N]; N],
}

impl<const N: usize> Interval<N> {
    /// Of the interval after a row.
    #[inline]
    pub fn new(run: &Linearised, noise: &Noise, row: usize) -> Self {
        let n = run.states;
        let dt = run.interval(row);
        let a = &run.transition[row * n * n..(row + 1) * n * n];
        let mut transition = [[0.0; N]; N];
        for i in 0..n {
            transition[i][..n].copy_from_slice(&a[i * n..(i + 1) * n]);
        }
        let mut covariance = [[0.0; N]; N];
        for (equation, q) in noise.process.iter().copied().enumerate().take(n) {
            if q > 0.0 {
                let variance = q * q / dt;
                let mut along = [0.0; N];
                for (i, along) in along.iter_mut().enumerate().take(n) {
                    *along = direction(run, row, equation, i);
                }
                for i in 0..n {
                    let weighted = along[i] * variance;
                    for j in 0..=i {
                        covariance[i][j] += weighted * along[j];
                    }
                }
            }
        }
        for (i, late) in run.late(row).iter().enumerate() {
            let weighted = late * noise.jitter * noise.jitter;
            run.late(row)[..=i].iter().zip(&mut covariance[i]).for_each(|(other, c)| *c += weighted * other);
        }
        if let Some(unlisted) = noise.disturbance {
            let keeps = libm::exp(-dt / unlisted.memory);
            for (i, to) in transition.iter_mut().enumerate().take(n) {
                to[n] = direction(run, row, unlisted.equation, i);
            }
            transition[n][n] = keeps;
            covariance[n][n] = unlisted.size * unlisted.size * (1.0 - keeps * keeps);
        }
        if run.is_torn(row) {
            // nothing of what was before: with that beside it a run begun anew would be likelier or not by where it begins
            for (i, sd) in run.start.1.iter().enumerate().take(n) {
                (transition[i], covariance[i]) = ([0.0; N], [0.0; N]);
                covariance[i][i] = sd * sd;
            }
        }
        for i in 0..N {
            for j in 0..i {
                covariance[j][i] = covariance[i][j];
            }
        }
        Self { transition, covariance }
    }
}

/// Gᵢ of the interval after a row: where a rate of one equation held over it leads; nowhere where the state behind it is begun anew.
#[inline]
pub fn direction(run: &Linearised, row: usize, equation: usize, i: usize) -> f64 {
    if run.is_torn(row) {
        return 0.0;
    }
    let a = run.transition[(row * run.states + i) * run.states + equation];
    0.5 * run.interval(row) * (a + if i == equation { 1.0 } else { 0.0 })
}

/// The filter for N states, an unlisted input among them.
fn filter<const N: usize>(
    run: &Linearised,
    noise: &Noise,
    columns: &[usize],
    mut kept: Option<&mut Kept>,
) -> Reduced {
    let mut filter = Filter::<N>::new(run, noise, columns);
    for row in 0..run.rows() {
        for value in run.values(row) {
            filter.take_in(value, kept.as_deref_mut());
        }
        if let Some(kept) = kept.as_deref_mut().filter(|kept| !kept.values_only) {
            kept.mean.extend_from_slice(&filter.mean);
            filter.covariance.iter().for_each(|row| kept.covariance.extend_from_slice(row));
            kept.score.extend_from_slice(&filter.score);
        }
        if row + 1 < run.rows() {
            filter.predict(row);
        }
    }
    filter.reduced()
}

/// The filter on its way through a run.
struct Filter<'a, const N: usize> {
    run: &'a Linearised,
    noise: &'a Noise,
    columns: &'a [usize],
    /// m.
    mean: [f64; N],
    /// P.
    covariance: [[f64; N]; N],
    /// M, a column for each parameter.
    sensitivity: Vec<[f64; N]>,
    /// J of the last value.
    innovation_columns: Vec<f64>,
    /// Sum of J e / s.
    score: Vec<f64>,
    /// Sum of J J' / s, its lower half.
    gram: Vec<f64>,
    /// Sum of e² / s.
    square: f64,
    /// Sum of log s, with what is left out.
    log_det: f64,
    /// Number of values that were taken in.
    count: f64,
}

impl<'a, const N: usize> Filter<'a, N> {
    /// Before the first row.
    fn new(run: &'a Linearised, noise: &'a Noise, columns: &'a [usize]) -> Self {
        let (n, p) = (run.states, columns.len());
        let mut filter = Self {
            run,
            noise,
            columns,
            mean: [0.0; N],
            covariance: [[0.0; N]; N],
            sensitivity: vec![[0.0; N]; p],
            innovation_columns: vec![0.0; p],
            score: vec![0.0; p],
            gram: vec![0.0; p * p],
            square: 0.0,
            log_det: run.left_out,
            count: 0.0,
        };
        for i in 0..n {
            filter.mean[i] = run.start.0[i];
            filter.covariance[i][i] = run.start.1[i] * run.start.1[i];
        }
        run.follows.iter().for_each(|known| filter.lead(known));
        if let Some(unlisted) = noise.disturbance {
            filter.covariance[n][n] = unlisted.size * unlisted.size;
        }
        filter
    }

    /// A state of the first row that begins where those before it lead.
    fn lead(&mut self, known: &Follows) {
        let (own, before) = (known.state, self.covariance);
        for (j, by) in known.by.iter().enumerate() {
            self.mean[own] += by * self.mean[j];
            for i in 0..own {
                self.covariance[own][i] += by * before[j][i];
                self.covariance[own][own] += by * before[j][i] * known.by.get(i).copied().unwrap_or(0.0);
            }
        }
        for i in 0..own {
            self.covariance[i][own] = self.covariance[own][i];
        }
        let columns = self.sensitivity.iter_mut().zip(self.columns);
        columns.for_each(|(m, column)| m[own] = known.direct[*column]);
    }

    /// Takes a value in: e, s and J, the sums, then m, P and M.
    #[inline]
    fn take_in(&mut self, value: usize, mut kept: Option<&mut Kept>) {
        let (run, n) = (self.run, self.run.states);
        let measured = &run.measured[value];
        let observe = &run.observe[value * n..(value + 1) * n];
        let mut gain = [0.0; N];
        let mut predicted = 0.0;
        for (j, h) in observe.iter().enumerate().filter(|(_, h)| **h != 0.0) {
            predicted += h * self.mean[j];
            for (gain, row) in gain.iter_mut().zip(&self.covariance) {
                *gain += h * row[j];
            }
        }
        let spread: f64 = observe.iter().zip(&gain).map(|(h, gain)| h * gain).sum();
        let own = self.noise.variance(measured.channel, measured.slope);
        let innovation = measured.residual - predicted;
        let variance = spread.max(0.0) + own;
        if let Some(kept) = kept.as_deref_mut() {
            kept.innovation.push(innovation);
            kept.variance.push(if measured.weight > 0.0 { variance } else { f64::INFINITY });
            kept.gain.extend_from_slice(&gain);
        }
        if measured.weight == 0.0 {
            if let Some(kept) = kept {
                kept.columns.resize(kept.columns.len() + self.columns.len(), 0.0);
            }
            return;
        }
        let direct = &run.direct[value * run.parameters..(value + 1) * run.parameters];
        for (slot, (column, m)) in self.columns.iter().zip(&self.sensitivity).enumerate() {
            let through: f64 = observe.iter().zip(m).map(|(h, m)| h * m).sum();
            self.innovation_columns[slot] = through + direct[*column];
        }
        if let Some(kept) = kept {
            kept.columns.extend_from_slice(&self.innovation_columns);
        }
        self.add(innovation, variance);
        self.correct(&gain, innovation, variance);
    }

    /// Adds a value to the sums.
    #[inline]
    fn add(&mut self, innovation: f64, variance: f64) {
        let p = self.columns.len();
        self.square += innovation * innovation / variance;
        self.log_det += libm::log(variance);
        self.count += 1.0;
        for i in 0..p {
            let weighted = self.innovation_columns[i] / variance;
            self.score[i] += weighted * innovation;
            for j in 0..=i {
                self.gram[i * p + j] += weighted * self.innovation_columns[j];
            }
        }
    }

    /// m, P and M after a value with the gain P Hᵀ.
    #[inline]
    fn correct(&mut self, gain: &[f64; N], innovation: f64, variance: f64) {
        for i in 0..N {
            let k = gain[i] / variance;
            self.mean[i] += k * innovation;
            for (m, column) in self.sensitivity.iter_mut().zip(&self.innovation_columns) {
                m[i] -= k * column;
            }
            for j in 0..N {
                self.covariance[i][j] -= k * gain[j];
            }
        }
    }

    /// m, P and M at the end of the interval after a row.
    #[inline]
    fn predict(&mut self, row: usize) {
        let (run, n) = (self.run, self.run.states);
        let step = Interval::<N>::new(run, self.noise, row);
        let defect = &run.defect[row * n..(row + 1) * n];
        self.mean = times(&step.transition, &self.mean);
        self.mean.iter_mut().zip(defect).for_each(|(mean, defect)| *mean += defect);
        for (m, column) in self.sensitivity.iter_mut().zip(self.columns) {
            *m = times(&step.transition, m);
            m.iter_mut().zip(run.column(row, *column)).for_each(|(m, column)| *m += column);
        }
        self.covariance = spread(&step.transition, &self.covariance);
        for i in 0..N {
            for j in 0..N {
                self.covariance[i][j] += step.covariance[i][j];
            }
        }
    }

    /// The sums over the run.
    fn reduced(self) -> Reduced {
        let p = self.columns.len();
        Reduced {
            square: self.square,
            score: DVector::from_vec(self.score),
            gram: DMatrix::from_fn(p, p, |i, j| self.gram[i.max(j) * p + i.min(j)]),
            freedom: self.count,
            log_det: self.log_det,
        }
    }
}

/// A v.
#[inline]
pub fn times<const N: usize>(a: &[[f64; N]; N], v: &[f64; N]) -> [f64; N] {
    std::array::from_fn(|i| a[i].iter().zip(v).map(|(a, v)| a * v).sum())
}

/// A P Aᵀ, symmetric to the last bit.
#[inline]
fn spread<const N: usize>(a: &[[f64; N]; N], p: &[[f64; N]; N]) -> [[f64; N]; N] {
    let mut half = [[0.0; N]; N];
    for i in 0..N {
        for k in 0..N {
            let factor = a[i][k];
            if factor != 0.0 {
                for j in 0..N {
                    half[i][j] += factor * p[k][j];
                }
            }
        }
    }
    let mut whole = [[0.0; N]; N];
    for i in 0..N {
        for j in 0..=i {
            let sum: f64 = half[i].iter().zip(&a[j]).map(|(half, a)| half * a).sum();
            whole[i][j] = sum;
            whole[j][i] = sum;
        }
    }
    whole
}
