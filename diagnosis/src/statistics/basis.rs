//! An orthonormal basis of the nuisances of a cell, by which they are projected out.

use super::linear::{Cell, RANK_TOLERANCE};
use super::products::{norm, take_out};

/// An orthonormal basis of a cell's nuisances, after whitening.
pub(super) struct Basis {
    /// Length of its vectors: rows of the cell, and one for each soft nuisance.
    pub(super) rows: usize,
    /// Vectors that share no row, as those of timestamps that scatter don't.
    apart: Apart,
    /// The others, one behind the other.
    vectors: Vec<f64>,
    /// log det of the whitened rows' covariance.
    pub(super) log_det: f64,
    /// Hard nuisances that say something of their own.
    pub(super) hard_rank: usize,
}

/// Vectors that share no row: rows in which each is not 0, and its values there, one behind the other.
#[derive(Default)]
struct Apart {
    values: Vec<(usize, f64)>,
    /// Where each ends.
    ends: Vec<usize>,
}

impl Apart {
    fn each(&self) -> impl Iterator<Item = &[(usize, f64)]> {
        let begins = [0].into_iter().chain(self.ends.iter().copied());
        begins.zip(&self.ends).map(|(begin, end)| &self.values[begin..*end])
    }

    fn take_out(&self, vector: &mut [f64]) {
        for own in self.each() {
            let along: f64 = own.iter().map(|(row, value)| value * vector[*row]).sum();
            own.iter().for_each(|(row, value)| vector[*row] -= along * value);
        }
    }
}

/// A column that keeps this share of its length is orthogonal to rounding after one pass (Kahan's criterion; Parlett, *The
/// Symmetric Eigenvalue Problem*, SIAM 1998, section 6.9).
const KEPT: f64 = std::f64::consts::FRAC_1_SQRT_2;

impl Basis {
    /// Gram-Schmidt, each column twice where it needs that, which is as good as Householder here and leaves dependent columns
    /// out. Soft columns that share no row are orthogonal as they are, and come first.
    pub(super) fn new(cell: &Cell, discrepancy_sd: f64) -> Self {
        let (n, soft) = (cell.residual.len(), kept(cell, discrepancy_sd));
        let (rows, apart) = (n + soft, apart(cell, soft));
        let vectors = Vec::with_capacity(rows * (cell.hard.ncols() + soft - apart.len()));
        let mut basis = Self { rows, apart: Apart::default(), vectors, log_det: 0.0, hard_rank: 0 };
        let mut vector = vec![0.0; rows];
        let factor = |place: usize| if place < cell.discrepancy { 1.0 } else { discrepancy_sd };
        for place in &apart {
            basis.set_apart(cell, *place, factor(*place));
        }
        for column in cell.hard.column_iter() {
            whiten(cell, column.as_slice(), 1.0, &mut vector);
            basis.hard_rank += usize::from(basis.push(&mut vector));
        }
        for place in (0..soft).filter(|place| !apart.contains(place)) {
            whiten(cell, cell.soft.column(place).as_slice(), factor(place), &mut vector);
            vector[n + place] = 1.0;
            basis.push(&mut vector);
        }
        basis
    }

    /// Adds a soft column that shares no row with those before it.
    fn set_apart(&mut self, cell: &Cell, place: usize, factor: f64) {
        let Apart { values, ends } = &mut self.apart;
        let begin = values.len();
        let column = cell.soft.column(place);
        let told = column.iter().zip(&cell.sigma).enumerate().filter(|(_, (value, _))| **value != 0.0);
        values.extend(told.map(|(row, (value, sigma))| (row, factor * value / sigma)));
        values.push((cell.residual.len() + place, 1.0));
        let length = values[begin..].iter().map(|(_, value)| value * value).sum::<f64>().sqrt();
        if length.is_nan() {
            return values.truncate(begin);
        }
        values[begin..].iter_mut().for_each(|(_, value)| *value /= length);
        ends.push(values.len());
        self.log_det += 2.0 * libm::log(length);
    }

    fn push(&mut self, vector: &mut [f64]) -> bool {
        let before = norm(vector);
        self.project(vector);
        let mut after = norm(vector);
        if after <= KEPT * before {
            self.project(vector);
            after = norm(vector);
        }
        if after.is_nan() || after <= RANK_TOLERANCE * before {
            return false;
        }
        self.log_det += 2.0 * libm::log(after);
        self.vectors.extend(vector.iter().map(|value| value / after));
        true
    }

    /// Takes out of a vector what lies along the basis.
    pub(super) fn project(&self, vector: &mut [f64]) {
        self.apart.take_out(vector);
        take_out(&self.vectors, self.rows, vector);
    }

    /// Expected square of each of the first `n` rows after projection, where noise is all there is: 1 less its leverage.
    pub(super) fn expected(&self, n: usize) -> Vec<f64> {
        let mut expected = vec![1.0; n];
        for (row, value) in self.apart.values.iter().filter(|(row, _)| *row < n) {
            expected[*row] -= value * value;
        }
        for vector in self.vectors.chunks_exact(self.rows.max(1)) {
            expected.iter_mut().zip(vector).for_each(|(expected, value)| *expected -= value * value);
        }
        expected.iter_mut().for_each(|expected| *expected = expected.max(0.0));
        expected
    }
}

/// Soft columns, of the first so many, no two of which share a row: those of the fewest rows first.
fn apart(cell: &Cell, soft: usize) -> Vec<usize> {
    let told = |place: usize| {
        let values = cell.soft.as_slice()[place * cell.soft.nrows()..].iter().take(cell.soft.nrows());
        values.enumerate().filter(|(_, value)| **value != 0.0).map(|(row, _)| row)
    };
    let mut all: Vec<(usize, usize)> = (0..soft).map(|place| (told(place).count(), place)).collect();
    all.sort_unstable();
    let mut taken = vec![false; cell.residual.len()];
    all.retain(|(_, place)| {
        let free = told(*place).all(|row| !taken[row]);
        told(*place).filter(|_| free).for_each(|row| taken[row] = true);
        free
    });
    all.into_iter().map(|(_, place)| place).collect()
}

/// Divides a column by the rows' standard deviations; the rows of soft nuisances below are 0.
pub(super) fn whiten(cell: &Cell, column: &[f64], factor: f64, into: &mut [f64]) {
    let (own, below) = into.split_at_mut(column.len());
    for ((into, value), sigma) in own.iter_mut().zip(column).zip(&cell.sigma) {
        *into = factor * value / sigma;
    }
    below.fill(0.0);
}

/// Soft columns that take part: where there is no discrepancy, its columns stay out.
pub(super) fn kept(cell: &Cell, discrepancy_sd: f64) -> usize {
    if discrepancy_sd > 0.0 { cell.soft.ncols() } else { cell.discrepancy.min(cell.soft.ncols()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::random::Random;
    use nalgebra::DMatrix;

    /// Two angles at eight times: a shared nuisance, one for each time, one for two times that share rows with others, and two hard ones.
    fn cell() -> Cell {
        let mut random = Random::new(3);
        let mut soft = DMatrix::zeros(16, 10);
        soft.column_mut(0).fill(0.3);
        for time in 0..8 {
            soft[(time, 1 + time)] = random.normal();
            soft[(8 + time, 1 + time)] = random.normal();
        }
        (3..5).for_each(|time| soft[(time, 9)] = 1.0);
        Cell {
            residual: (0..16).map(|_| random.normal()).collect(),
            sigma: (0..16).map(|_| 0.5 + random.uniform()).collect(),
            signal: vec![0; 16],
            time: vec![0.0; 16],
            hard: DMatrix::from_fn(16, 2, |_, _| random.normal()),
            soft,
            discrepancy: 9,
            inertia_scale: 1.0,
            columns: DMatrix::zeros(16, 0),
            floor: Vec::new(),
            state: Vec::new(),
            lattice: Vec::new(),
            drawn: Vec::new(),
        }
    }

    #[test]
    fn law_columns_that_share_no_row_are_projected_out_as_all_others() {
        let cell = cell();
        assert_eq!(apart(&cell, 10), [1, 2, 3, 4, 5, 6, 7, 8]);
        let basis = Basis::new(&cell, 2.0);
        // all nuisances, whitened, as a matrix; its Q by Householder
        let white = DMatrix::from_fn(26, 12, |row, column| match (row < 16, column < 2) {
            (true, true) => cell.hard[(row, column)] / cell.sigma[row],
            (true, false) => {
                let size = if column == 11 { 2.0 } else { 1.0 };
                size * cell.soft[(row, column - 2)] / cell.sigma[row]
            }
            (false, _) => f64::from(u8::from(row - 16 + 2 == column)),
        });
        let q = white.clone().qr().q();
        let mut residual = vec![0.0; 26];
        whiten(&cell, &cell.residual, 1.0, &mut residual);
        let whole = nalgebra::DVector::from_column_slice(&residual);
        basis.project(&mut residual);
        let left = &whole - &q * q.tr_mul(&whole);
        // rounding of values near 1
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
        assert!(residual.iter().zip(&left).all(|(a, b)| near(*a, *b)), "{residual:?} {left}");
        let expected = basis.expected(16);
        assert!((0..16).all(|row| near(expected[row], 1.0 - q.row(row).norm_squared())), "{expected:?}");
        let det = white.tr_mul(&white).determinant();
        assert!(near(basis.log_det, libm::log(det)), "{} {det}", basis.log_det);
        assert_eq!(basis.hard_rank, 2);
    }
}
