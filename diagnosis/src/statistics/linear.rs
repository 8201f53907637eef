//! Least squares in blocks, with the nuisances of each block projected out.
//!
//! A block has residuals r, columns S of the candidates and columns N of nuisances that belong to it alone (the
//! start state of a window, the pose of a frame). A nuisance is *hard* (anything goes) or *soft* (Gaussian prior
//! around 0). After whitening, soft ones get a row [0 … 1/σ … 0] each, so that one orthogonal projection deals
//! with both; what is left of a block is a sum of squares, a score and a Gram matrix. Everything after that
//! (screening, leaving runs out, the bootstrap) is sums of these over blocks.
//! Björck, *Numerical Methods for Least Squares Problems*, SIAM 1996, section 2.4 and 4.2.

use super::basis::{Basis, kept, whiten};
use crate::statistics::levels::FINE;
pub use crate::statistics::normal::{inverse, solve, submatrix, subvector};
use crate::statistics::products::add_products;
use nalgebra::{DMatrix, DVector};

/// Below this share of its own length, what is left of a column after projection is rounding.
pub const RANK_TOLERANCE: f64 = 1e-9;
/// Prior size that leaves a discrepancy as good as free, for a cell of `inertia_scale` 1.
const FREE: f64 = 1.0 / FINE;

/// One set of rows that share nuisances.
#[derive(Debug, Clone)]
pub struct Cell {
    /// Measured minus simulated.
    pub residual: Vec<f64>,
    /// Standard deviation of each row.
    pub sigma: Vec<f64>,
    /// Index of each row's signal.
    pub signal: Vec<usize>,
    /// Time of each row in s.
    pub time: Vec<f64>,
    /// Columns of free nuisances.
    pub hard: DMatrix<f64>,
    /// Columns of nuisances with a prior of standard deviation 1.
    pub soft: DMatrix<f64>,
    /// Soft columns from here on stand for what the model lacks; their prior is multiplied by a common size.
    pub discrepancy: usize,
    /// How large a discrepancy is against that of a machine of usual size: its sizes are counted in it.
    pub inertia_scale: f64,
    /// Change of the simulated rows per unit of each candidate.
    pub columns: DMatrix<f64>,
    /// What noise alone gives each row, where that is less than `sigma`; else empty.
    pub floor: Vec<f64>,
    /// q1, q2, dq1, dq2 where all rows are of one moment; else empty.
    pub state: Vec<f64>,
    /// Where on the pixel lattice each row was rendered: rows of a signal at one place share a renderer's error there. Empty
    /// where nothing is rendered.
    pub lattice: Vec<usize>,
    /// Where each row was rendered, as the model has it. Empty where nothing is rendered.
    pub drawn: Vec<Drawn>,
}

/// Where the model renders what a row measures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drawn {
    /// Its circle, from the image centre: right and up, px.
    pub place: [f64; 2],
    /// Change of the row with time, of its unit a second.
    pub rate: f64,
}

impl Cell {
    /// The same rows with other columns.
    pub fn with_columns(&self, columns: DMatrix<f64>) -> Self {
        Self {
            residual: self.residual.clone(),
            sigma: self.sigma.clone(),
            signal: self.signal.clone(),
            time: self.time.clone(),
            hard: self.hard.clone(),
            soft: self.soft.clone(),
            floor: self.floor.clone(),
            state: self.state.clone(),
            lattice: self.lattice.clone(),
            drawn: self.drawn.clone(),
            columns,
            ..*self
        }
    }

    /// Prior size that leaves the discrepancy as good as free, in its own unit.
    pub fn free(&self) -> f64 {
        FREE * self.inertia_scale
    }
}

/// Residual after `shift` more of some columns.
pub fn moved(cell: &Cell, places: &[usize], shift: Option<&DVector<f64>>) -> Vec<f64> {
    let mut residual = cell.residual.clone();
    for (place, by) in places.iter().zip(shift.iter().flat_map(|shift| shift.iter())) {
        let column = cell.columns.column(*place);
        residual.iter_mut().zip(column.iter()).for_each(|(rest, column)| *rest -= by * column);
    }
    residual
}

/// What is left of a block.
#[derive(Debug, Clone)]
pub struct Reduced {
    /// Sum of squares.
    pub square: f64,
    /// Sᵀ r.
    pub score: DVector<f64>,
    /// Sᵀ S.
    pub gram: DMatrix<f64>,
    /// Rows less hard nuisances.
    pub freedom: f64,
    /// log det of the rows' covariance (for comparing sizes of soft nuisances).
    pub log_det: f64,
}

impl Reduced {
    /// Nothing yet, for p candidates.
    pub fn zero(p: usize) -> Self {
        Self { square: 0.0, score: DVector::zeros(p), gram: DMatrix::zeros(p, p), freedom: 0.0, log_det: 0.0 }
    }

    /// Adds a cell, its nuisances projected out. `discrepancy_sd` multiplies the discrepancy's prior standard deviation.
    pub fn add_cell(&mut self, cell: &Cell, discrepancy_sd: f64) {
        let Projected { residual, columns, freedom, log_det, .. } = projected(cell, discrepancy_sd);
        self.square += residual.norm_squared();
        self.freedom += freedom;
        self.log_det += log_det + log_noise(cell);
        add_products(&columns, residual.as_slice(), &mut self.score, &mut self.gram);
    }

    /// Adds another.
    pub fn add(&mut self, other: &Reduced) {
        self.square += other.square;
        self.score += &other.score;
        self.gram += &other.gram;
        self.freedom += other.freedom;
        self.log_det += other.log_det;
    }

    /// Takes another away.
    pub fn subtract(&mut self, other: &Reduced) {
        self.square -= other.square;
        self.score -= &other.score;
        self.gram -= &other.gram;
        self.freedom -= other.freedom;
        self.log_det -= other.log_det;
    }

    /// What others leave of a column: the square of its length, and its score. Nothing where they don't tell each other apart.
    pub fn beside(&self, others: &[usize], column: usize) -> Option<(f64, f64)> {
        let (gram, score) = (&self.gram, &self.score);
        let across = DVector::from_fn(others.len(), |i, _| gram[(others[i], column)]);
        let none = others.is_empty();
        let weights = if none { DVector::zeros(0) } else { solve(&submatrix(gram, others), &across)? };
        Some((
            gram[(column, column)] - weights.dot(&across),
            score[column] - weights.dot(&subvector(score, others)),
        ))
    }

    /// The same with every variance multiplied by `dispersion`.
    pub fn dispersed(&self, dispersion: f64) -> Self {
        Self {
            square: self.square / dispersion,
            score: &self.score / dispersion,
            gram: &self.gram / dispersion,
            freedom: self.freedom,
            log_det: self.log_det,
        }
    }
}

/// Whitened rows of a cell after projection, with the soft nuisances' own rows below.
pub struct Projected {
    /// What is left of the residual.
    pub residual: DVector<f64>,
    /// What is left of the columns.
    pub columns: DMatrix<f64>,
    /// Rows less hard nuisances.
    pub freedom: f64,
    /// log det of the whitened rows' covariance.
    pub log_det: f64,
    /// Expected square of each of the cell's own rows, where noise is all there is: 1 less its leverage.
    pub expected: Vec<f64>,
}

/// Projects. `discrepancy` multiplies the prior standard deviation of the discrepancy.
pub fn projected(cell: &Cell, discrepancy_sd: f64) -> Projected {
    beside(cell, &cell.residual, &cell.columns, discrepancy_sd)
}

/// Projects this residual alone.
pub fn bare(cell: &Cell, residual: &[f64], discrepancy_sd: f64) -> Projected {
    beside(cell, residual, &DMatrix::zeros(residual.len(), 0), discrepancy_sd)
}

fn beside(cell: &Cell, residual: &[f64], raw: &DMatrix<f64>, discrepancy_sd: f64) -> Projected {
    let n = cell.residual.len();
    let basis = Basis::new(cell, discrepancy_sd);
    let mut left = DVector::zeros(basis.rows);
    whiten(cell, residual, 1.0, left.as_mut_slice());
    basis.project(left.as_mut_slice());
    let mut columns = DMatrix::zeros(basis.rows, raw.ncols());
    for (column, into) in raw.column_iter().zip(columns.as_mut_slice().chunks_exact_mut(basis.rows.max(1))) {
        if column.amax() > 0.0 {
            whiten(cell, column.as_slice(), 1.0, into);
            basis.project(into);
        }
    }
    let freedom = n as f64 - basis.hard_rank as f64;
    Projected { residual: left, columns, freedom, log_det: basis.log_det, expected: basis.expected(n) }
}

/// log det of the rows' noise.
fn log_noise(cell: &Cell) -> f64 {
    cell.sigma.iter().map(|sigma| 2.0 * libm::log(*sigma)).sum()
}

/// Projects the nuisances out of a cell. `discrepancy` multiplies the discrepancy's prior standard deviation.
pub fn reduce(cell: &Cell, discrepancy_sd: f64) -> Reduced {
    let mut sum = Reduced::zero(cell.columns.ncols());
    sum.add_cell(cell, discrepancy_sd);
    sum
}

/// The deviance of a cell's own rows (square and log det) as a function of the discrepancy's size, with one projection for all
/// sizes: r'(I + s² D D')⁻¹r and log det(I + s² D'D) in the eigenvectors of D'D (Woodbury).
pub struct Sized {
    none: f64,
    /// For each eigenvector of D'D its value, and the square of D'r along it.
    along: Vec<(f64, f64)>,
}

impl Sized {
    /// Projects all other nuisances out.
    pub fn of(cell: &Cell) -> Self {
        let free = cell.discrepancy.min(cell.soft.ncols());
        let columns = cell.soft.columns(free, cell.soft.ncols() - free).into_owned();
        let Projected { residual, columns, log_det, .. } = beside(cell, &cell.residual, &columns, 0.0);
        let none = residual.norm_squared() + (log_det + log_noise(cell));
        if columns.ncols() == 0 {
            return Self { none, along: Vec::new() };
        }
        let eigen = columns.tr_mul(&columns).symmetric_eigen();
        let scores = eigen.eigenvectors.tr_mul(&columns.tr_mul(&residual));
        let along =
            eigen.eigenvalues.iter().zip(&scores).map(|(value, score)| (value.max(0.0), score * score));
        Self { none, along: along.collect() }
    }

    /// -2 log likelihood, up to a constant.
    pub fn deviance(&self, size: f64) -> f64 {
        let square = size * size;
        let part = |(value, score): &(f64, f64)| {
            libm::log1p(square * value) - square * score / (1.0 + square * value)
        };
        self.none + self.along.iter().map(part).sum::<f64>()
    }
}

/// Most likely nuisances (hard, then soft) of a cell that leaves this residual.
pub fn nuisances(cell: &Cell, residual: &[f64], discrepancy_sd: f64) -> DVector<f64> {
    let soft = soft_columns(cell, discrepancy_sd);
    let (hard, all) = (cell.hard.ncols(), cell.hard.ncols() + soft.ncols());
    let white = DMatrix::from_fn(cell.residual.len(), all, |row, column| {
        let value = if column < hard { cell.hard[(row, column)] } else { soft[(row, column - hard)] };
        value / cell.sigma[row]
    });
    let residual = DVector::from_fn(residual.len(), |row, _| residual[row] / cell.sigma[row]);
    let mut normal = white.tr_mul(&white);
    for place in hard..all {
        normal[(place, place)] += 1.0;
    }
    let mut solution = solve(&normal, &white.tr_mul(&residual)).unwrap_or_else(|| DVector::zeros(all));
    for place in hard + cell.discrepancy.min(soft.ncols())..all {
        solution[place] *= discrepancy_sd;
    }
    solution
}

fn soft_columns(cell: &Cell, discrepancy_sd: f64) -> DMatrix<f64> {
    DMatrix::from_fn(cell.soft.nrows(), kept(cell, discrepancy_sd), |row, column| {
        cell.soft[(row, column)] * if column < cell.discrepancy { 1.0 } else { discrepancy_sd }
    })
}
