//! The statistics keep what they promise.

use diagnosis::testing::{Cell, Null, Random, Scores, Sized, nuisances, reduce};
use nalgebra::{DMatrix, DVector};

fn cell(random: &mut Random, rows: usize) -> Cell {
    let mut matrix = |columns| DMatrix::from_fn(rows, columns, |_, _| random.normal());
    let (hard, soft, columns) = (matrix(3), matrix(2), matrix(4));
    Cell {
        residual: (0..rows).map(|_| random.normal()).collect(),
        sigma: vec![0.5; rows],
        signal: vec![0; rows],
        time: vec![0.0; rows],
        hard,
        soft,
        discrepancy: 0,
        inertia_scale: 1.0,
        columns,
        floor: Vec::new(),
        state: Vec::new(),
        lattice: Vec::new(),
        drawn: Vec::new(),
    }
}

#[test]
fn law_a_free_nuisance_leaves_no_trace() {
    let mut random = Random::new(1);
    let mut one = cell(&mut random, 20);
    let before = reduce(&one, 0.3);
    let along = &one.hard * DVector::from_vec(vec![3.0, -40.0, 500.0]);
    one.residual.iter_mut().zip(along.iter()).for_each(|(rest, more)| *rest += more);
    let after = reduce(&one, 0.3);
    // rounding of sums near 1e3
    assert!((before.square - after.square).abs() < 1e-8);
    assert!((before.score - after.score).amax() < 1e-8);
    assert_eq!(after.freedom, 17.0);
}

#[test]
fn law_nuisances_that_are_nearly_one_are_projected_out_as_well() {
    let mut random = Random::new(6);
    let mut one = cell(&mut random, 20);
    let (first, apart) = (one.hard.column(0).into_owned(), one.hard.column(1) * 1e-6);
    one.hard.set_column(1, &(&first + apart));
    let along = &one.hard * DVector::from_vec(vec![3.0, -40.0, 500.0]);
    let before = reduce(&one, 0.3);
    one.residual.iter_mut().zip(along.iter()).for_each(|(rest, more)| *rest += more);
    let after = reduce(&one, 0.3);
    // the direction in which they differ is known to 1e-16/1e-6, times sums near 1e3
    assert!((before.square - after.square).abs() < 1e-6, "{} {}", before.square, after.square);
    assert!((before.score - after.score).amax() < 1e-6);
    assert_eq!(after.freedom, 17.0);
}

#[test]
fn law_a_soft_nuisance_is_its_prior_covariance() {
    let mut random = Random::new(2);
    let mut one = cell(&mut random, 12);
    one.hard = DMatrix::zeros(12, 0);
    let size = 0.7;
    let covariance = DMatrix::identity(12, 12) * 0.25 + &one.soft * one.soft.transpose() * (size * size);
    let rest = DVector::from_column_slice(&one.residual);
    let inverse = covariance.clone().try_inverse().expect("a covariance");
    let reduced = reduce(&one, size);
    // rounding
    assert!((reduced.square - (rest.transpose() * &inverse * &rest)[0]).abs() < 1e-9);
    assert!((reduced.log_det - covariance.determinant().ln()).abs() < 1e-9);
    assert!((reduced.gram - one.columns.transpose() * inverse * &one.columns).amax() < 1e-9);
}

#[test]
fn law_one_projection_gives_the_deviance_of_every_size() {
    let mut random = Random::new(5);
    for fixed in [0, 1, 2] {
        let one = Cell { discrepancy: fixed, ..cell(&mut random, 12) };
        let sized = Sized::of(&one);
        for size in [0.0, 1e-3, 0.7, 40.0] {
            let reduced = reduce(&one, size);
            // rounding
            assert!((sized.deviance(size) - reduced.square - reduced.log_det).abs() < 1e-9, "{fixed} {size}");
        }
    }
}

#[test]
fn law_nuisances_that_made_the_rest_are_found() {
    let mut random = Random::new(3);
    let mut one = cell(&mut random, 30);
    let made = DVector::from_vec(vec![1.0, 2.0, 3.0]);
    one.residual = (&one.hard * &made).iter().copied().collect();
    // rounding
    assert!((nuisances(&one, &one.residual, 0.0) - made).amax() < 1e-10);
}

#[test]
fn value_the_largest_of_many_looks_large_by_chance() {
    let mut random = Random::new(4);
    let columns = 30;
    let alarms = (0..60)
        .filter(|_| {
            let blocks = DMatrix::from_fn(80, columns, |_, _| random.normal());
            let total = blocks.row_sum().transpose();
            let deviation = DVector::from_fn(columns, |c, _| blocks.column(c).norm());
            let scores = Scores { blocks, total, deviation, sided: vec![0; columns] };
            let best = (0..columns).map(|c| scores.statistic(c)).fold(0.0, f64::max);
            Null::of(&scores).p_value(best) < 0.1
        })
        .count();
    // 6 of 60 are expected; 15 or more would come with probability 6e-4 (binomial)
    assert!(alarms < 15, "{alarms} of 60");
}
