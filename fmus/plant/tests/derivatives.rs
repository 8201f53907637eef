//! Directional derivatives of the plant beside the linearisation and beside neighbouring states, where friction sticks, too.

use crate::common::{Rig, WILD, busy};
use fmi2_export::Model;
use mechanics::Theta;

#[test]
fn law_derivatives_at_equilibria_are_the_linearisation() {
    for q2 in [0.0, 0.6, 1.7559, -2.1] {
        let theta = Theta::TABLE_2;
        let rig = Rig::at([theta.manifold_q1(q2).unwrap(), q2, 0.0, 0.0], |variables| {
            variables.inputs.torque = theta.manifold_torque(q2);
        });
        let get = |unknown, known| rig.plant.derivative(&rig.variables, unknown, known).unwrap();
        let (a, b) = (theta.linearisation(q2).unwrap().a(), theta.linearisation(q2).unwrap().b());
        let unknowns = ["dq1", "dq2", "ddq1", "ddq2"];
        for (i, unknown) in unknowns.into_iter().enumerate() {
            for (j, known) in ["q1", "q2", "dq1", "dq2"].into_iter().enumerate() {
                assert!((get(unknown, known) - a[i][j]).abs() < 1e-9, "{unknown} by {known}"); // derivative.rs
            }
            assert!((get(unknown, "tau") - b[i]).abs() < 1e-12, "{unknown} by tau"); // rounding
        }
        assert_eq!(get("tau_applied", "tau"), 1.0);
        let place = mechanics::Place::new(&theta).unwrap();
        assert_eq!(get("z", "q2"), place.slope(q2));
        assert_eq!(rig.plant.derivative(&rig.variables, "ddq1", "theta_1"), None);
        assert_eq!(rig.plant.derivative(&rig.variables, "contact", "q2"), None);
    }
}

#[test]
fn law_derivatives_foretell_neighbouring_states() {
    let accelerations = |start: [f64; 4], torque: f64| {
        let locals = Rig::at(start, |variables| {
            busy(variables);
            variables.effects.delay.time = 0.0;
            variables.effects.rate_limit.limit = 0.0;
            variables.effects.lag.time = 0.0;
            variables.inputs.torque = torque;
        });
        (locals.variables.locals.clone(), locals)
    };
    let (here, rig) = accelerations(WILD, 0.5);
    let h = 1e-6; // error: h times a second derivative of order 10
    for (i, known) in ["q1", "q2", "dq1", "dq2", "tau"].into_iter().enumerate() {
        let mut start = WILD;
        let mut torque = 0.5;
        if i < 4 {
            start[i] += h
        } else {
            torque += h
        }
        let there = accelerations(start, torque).0;
        for (unknown, difference) in [
            ("ddq1", there.link1_acceleration - here.link1_acceleration),
            ("ddq2", there.link2_acceleration - here.link2_acceleration),
        ] {
            let expected = rig.plant.derivative(&rig.variables, unknown, known).unwrap();
            assert!(
                (difference / h - expected).abs() < 2e-4,
                "{unknown} by {known}: {} {expected}",
                difference / h
            );
        }
    }
    let saturated = accelerations(WILD, 0.9).1;
    assert_eq!(saturated.plant.derivative(&saturated.variables, "ddq1", "tau"), Some(0.0));
}

#[test]
fn law_derivatives_hold_where_friction_sticks() {
    // v_s of the joint is 0.1 mrad/s, that of rolling 0.03
    let near = [0.3, -0.2, 1e-5, 6e-5];
    let at = |start: [f64; 4]| {
        let rig = Rig::at(start, |variables| {
            (variables.effects.coulomb.roll, variables.effects.coulomb.joint) = (0.003, 0.01);
        });
        let locals = &rig.variables.locals;
        ([locals.link1_acceleration, locals.link2_acceleration], rig)
    };
    let (_, rig) = at(near);
    let h = 1e-8;
    for (place, known) in [(2, "dq1"), (3, "dq2")] {
        let beside = |by: f64| {
            let mut start = near;
            start[place] += by;
            at(start).0
        };
        let (before, after) = (beside(-h), beside(h));
        for (row, unknown) in ["ddq1", "ddq2"].into_iter().enumerate() {
            let expected = (after[row] - before[row]) / (2.0 * h);
            let told = rig.plant.derivative(&rig.variables, unknown, known).unwrap();
            // rounding of 1e-15 over h, and (h/v_s)² of some thousands
            assert!(
                (told - expected).abs() < 1e-4 * expected.abs(),
                "{unknown} by {known}: {told} {expected}"
            );
        }
    }
}

#[test]
fn every_friction_however_small_leaves_numbers() {
    for friction in [f64::from_bits(1), 1e-300, 1e-9] {
        let mut rig = Rig::at([0.0; 4], |variables| {
            (variables.effects.coulomb.roll, variables.effects.coulomb.joint) = (friction, friction);
        });
        rig.step(0.1);
        let slope = rig.plant.derivative(&rig.variables, "ddq2", "dq2").unwrap();
        assert!(rig.state().iter().all(|x| x.is_finite()) && slope.is_finite(), "{friction:e}: {slope}");
    }
}
