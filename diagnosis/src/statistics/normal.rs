//! Normal equations: symmetric matrices solved and inverted, and the parts of them that belong to chosen columns.

use nalgebra::{DMatrix, DVector};

/// Solves A x = b for a symmetric A ≥ 0 after scaling to a unit diagonal; `None` when A is singular to rounding.
pub fn solve(a: &DMatrix<f64>, b: &DVector<f64>) -> Option<DVector<f64>> {
    let scale = scaling(a)?;
    let scaled = DMatrix::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)] * scale[i] * scale[j]);
    let right = DVector::from_fn(b.len(), |i, _| b[i] * scale[i]);
    let solution = scaled.cholesky()?.solve(&right);
    let solution = DVector::from_fn(b.len(), |i, _| solution[i] * scale[i]);
    solution.iter().all(|value| value.is_finite()).then_some(solution)
}

/// Inverse of a symmetric A ≥ 0, scaled the same way.
pub fn inverse(a: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let scale = scaling(a)?;
    let scaled = DMatrix::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)] * scale[i] * scale[j]);
    let inverse = scaled.cholesky()?.inverse();
    Some(DMatrix::from_fn(a.nrows(), a.ncols(), |i, j| inverse[(i, j)] * scale[i] * scale[j]))
}

fn scaling(a: &DMatrix<f64>) -> Option<Vec<f64>> {
    (0..a.nrows()).map(|i| (a[(i, i)] > 0.0).then(|| 1.0 / a[(i, i)].sqrt())).collect()
}

/// The part of a matrix that belongs to chosen candidates.
pub fn submatrix(a: &DMatrix<f64>, chosen: &[usize]) -> DMatrix<f64> {
    DMatrix::from_fn(chosen.len(), chosen.len(), |i, j| a[(chosen[i], chosen[j])])
}

/// The part of a vector that belongs to chosen candidates.
pub fn subvector(a: &DVector<f64>, chosen: &[usize]) -> DVector<f64> {
    DVector::from_fn(chosen.len(), |i, _| a[chosen[i]])
}
