//! What a class is drawn by, on both sides of each of its numbers.

use super::{OwnFit, Replaced, linear_loss, resembled};
use crate::rigs::acrobot::candidates::{Candidate, Side};
use crate::rigs::acrobot::residual::Nuisances;
use crate::rigs::acrobot::selection::Step;
use crate::rigs::acrobot::selection::evaluation::Evaluation;
use crate::rigs::acrobot::selection::examples::{candidate, evaluation, hit, toy};
use nalgebra::DMatrix;

/// The first of two in the place that others are tried in.
fn own_fit_of<'a>(candidates: &'a [Candidate], last: &'a Evaluation) -> OwnFit<'a> {
    OwnFit {
        candidates,
        last,
        others: Vec::new(),
        effect: 0,
        temper: 1.0,
        offsets: DMatrix::zeros(0, 0),
        deviance: 0.0,
        nuisances: Nuisances::default(),
        unseen: 0,
    }
}

/// Whether the second is fitted in the place of the first, which explains `strength` and shares `shared` of its square with it.
fn is_near(strength: f64, shared: f64, nonlinear: bool, linear: Option<f64>) -> bool {
    let candidates = [candidate(Side::Camera, false), candidate(Side::Camera, nonlinear)];
    let across = (strength * shared).sqrt();
    let last = evaluation(&[1.0, 0.0], &[0.0; 2], &[strength, across, across, 1.0]);
    let own = own_fit_of(&candidates, &last);
    let replaced = linear.map(|loss| Replaced { loss, x: 0.0, own: 0, other: 1 });
    own.near(1, replaced.as_ref()).is_some()
}

#[test]
fn value_no_other_is_looked_at_that_loses_too_much() {
    // half of what it doesn't share: 11 and 13, and the line is 12; columns say 23 and 25, and the line is 24
    assert_eq!([0.78, 0.74].map(|shared| is_near(100.0, shared, false, None)), [true, false]);
    assert_eq!([23.0, 25.0].map(|loss| is_near(100.0, 0.5, false, Some(loss))), [true, false]);
}

#[test]
fn value_columns_are_alike_that_have_little_apart() {
    // 0.018 and 0.022 of a large effect, and the line is 0.02; of a blur 0.09 and 0.11, and it is 0.1
    assert_eq!([0.964, 0.956].map(|shared| is_near(1e5, shared, false, None)), [true, false]);
    assert_eq!([0.82, 0.78].map(|shared| is_near(1e5, shared, true, None)), [true, false]);
}

#[test]
fn value_no_column_is_believed_beyond_a_hundred_of_its_steps() {
    let candidates = [candidate(Side::Camera, false), candidate(Side::Camera, false)];
    let takes = |across: f64| {
        let last = evaluation(&[1.0, 0.0], &[0.0; 2], &[1.0, across, across, 0.5]);
        linear_loss(&last, &[], 0, 1, &candidates).map(|replaced| replaced.x)
    };
    // steps of 0.01
    assert!(takes(0.45).is_some_and(|x| (x - 0.9).abs() < 1e-12));
    assert_eq!(takes(0.55), None);
}

#[test]
fn value_another_resembles_a_whole_number_that_foretold_half_of_it() {
    let resembles = |gain: f64| {
        let step = Step {
            best: vec![hit(1, gain)],
            p_value: 0.0,
            accepted: Some(0),
            together: Vec::new(),
            dropped: Vec::new(),
            deviance: (1000.0, 0.0),
            mean_square: (1.0, 1.0),
            held_out: (1.0, 1.0),
        };
        resembled(&[step], 0, 1)
    };
    // 500 less 24
    assert_eq!([470.0, 480.0].map(resembles), [false, true]);
}

/// What a loss of a column is worth that another explains so much by.
fn along(loss: f64, strength: f64, nonlinear: bool) -> (f64, f64) {
    let candidates = [candidate(Side::Plant, false), candidate(Side::Plant, nonlinear)];
    let last = evaluation(&[1.0, 0.0], &[0.0; 2], &[1.0, 0.0, 0.0, 1.0]);
    let own = OwnFit { offsets: DMatrix::zeros(2, 0), unseen: 1, ..own_fit_of(&candidates, &last) };
    let mut cut = toy(|_| vec![0.0]);
    cut.unseen = 3;
    let replaced = Replaced { loss, x: 0.0, own: 0, other: 1 };
    (own.loss_by_columns(&mut cut, 1, &replaced, strength), own.lost(&cut))
}

#[test]
fn value_a_loss_counts_less_by_what_is_not_known_of_columns() {
    // 0.0025 of 400 standard deviations is one, and variances add
    assert!((along(10.0, 1.6e5, false).0 - 5.0).abs() < 1e-12);
    // 0.2 of what tells a blur from another
    assert!((along(5.0, 0.0, true).0 - 5.0 / 1.2).abs() < 1e-12);
    // two more frames lost: 3² each
    assert_eq!(along(10.0, 0.0, false), (10.0, 18.0));
}

#[test]
fn law_what_those_beside_an_effect_would_take_speaks_for_no_other() {
    let candidates = [(); 3].map(|()| candidate(Side::Camera, false));
    // an effect, another in its place, and one beside it that both resemble; half a standard deviation is left along the latter
    let columns = [[100.0, 1.0, 0.0], [100.0, 0.5, 0.5], [100.0, 0.0, 0.0]];
    let product = |a: usize, b: usize| (0..3).map(|row| columns[a][row] * columns[b][row]).sum::<f64>();
    let gram: Vec<f64> = (0..9).map(|place| product(place / 3, place % 3)).collect();
    let last = evaluation(&[1.0, 0.0, 1.0], &[50.0; 3], &gram);
    let replaced = linear_loss(&last, &[2], 0, 1, &candidates).expect("columns differ");
    // half of one square of what tells the effect from the one beside it: the half is no reason to prefer the other by 2500
    assert!((replaced.loss - 0.5).abs() < 1e-6 && (replaced.x - 1.0).abs() < 1e-6, "{}", replaced.loss);
}
