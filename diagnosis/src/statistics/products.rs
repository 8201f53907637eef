//! Sums of products, most of a diagnosis that is not the units'. Compiled for AVX2, too, and chosen at run time: the same sums in the same
//! order, so the same bits.

use multiversion::multiversion;
use nalgebra::{DMatrix, DVector};

/// Takes what lies along each direction (one behind the other) out of a vector.
#[multiversion(targets("x86_64+avx2"))]
pub fn take_out(directions: &[f64], rows: usize, vector: &mut [f64]) {
    for direction in directions.chunks_exact(rows.max(1)) {
        let along = dot(direction, vector);
        vector.iter_mut().zip(direction).for_each(|(value, direction)| *value -= along * direction);
    }
}

/// Adds the products of columns with a residual and with each other; most columns of a cell are often 0.
#[multiversion(targets("x86_64+avx2"))]
pub fn add_products(
    columns: &DMatrix<f64>,
    residual: &[f64],
    score: &mut DVector<f64>,
    gram: &mut DMatrix<f64>,
) {
    let rows = residual.len();
    let column = |place: usize| &columns.as_slice()[place * rows..(place + 1) * rows];
    let told = |place: &usize| column(*place).iter().any(|value| *value != 0.0);
    let told: Vec<usize> = (0..columns.ncols()).filter(told).collect();
    for (count, place) in told.iter().enumerate() {
        let own = column(*place);
        score[*place] += dot(own, residual);
        for other in &told[..count] {
            let product = dot(column(*other), own);
            gram[(*other, *place)] += product;
            gram[(*place, *other)] += product;
        }
        gram[(*place, *place)] += dot(own, own);
    }
}

/// Eight sums side by side, so that compilers use vectors.
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (a_parts, b_parts) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = a_parts.remainder().iter().zip(b_parts.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a_parts.zip(b_parts) {
        for lane in 0..8 {
            sums[lane] += a[lane] * b[lane];
        }
    }
    rest + sums.iter().sum::<f64>()
}

/// Length of a vector.
pub fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::random::Random;

    #[test]
    fn value_products_are_those_of_matrices_with_columns_of_zeros_left_out_or_not() {
        let mut random = Random::new(1);
        // rows that fill the eight sums once, with a rest
        let (rows, columns) = (13, 5);
        let mut matrix = DMatrix::from_fn(rows, columns, |_, _| random.uniform() - 0.5);
        matrix.column_mut(2).fill(0.0);
        let residual = DVector::from_fn(rows, |_, _| random.uniform() - 0.5);
        let (mut score, mut gram) = (DVector::zeros(columns), DMatrix::zeros(columns, columns));
        // twice: what was there stays
        for _ in 0..2 {
            add_products(&matrix, residual.as_slice(), &mut score, &mut gram);
        }
        // sums of thirteen products below 1, in another order
        let rounding = 1e-14;
        assert!((score - 2.0 * matrix.tr_mul(&residual)).amax() < rounding);
        assert!((gram - 2.0 * matrix.tr_mul(&matrix)).amax() < rounding);
    }
}
