//! Links that know nothing of each other, nor of gravity: motions, turns and contacts in closed form.

use crate::common;
use crate::common::{Kept, NO_CONTACT, Rig};
use fmi2_export::{Model, Step};
use plant::Variables;

/// 1 kg·m² each, so that torques are accelerations: q̈₂ = τ, q̈₁ = −τ.
fn free(start: [f64; 4], change: impl FnOnce(&mut Variables)) -> Rig {
    Rig::at(start, |variables| {
        let parameters = &mut variables.parameters;
        (parameters.theta_1, parameters.theta_5) = (1.0, 1.0);
        (parameters.theta_2, parameters.theta_7, parameters.theta_8) = (0.0, 0.0, 0.0);
        (parameters.theta_9, parameters.theta_10) = (0.0, 0.0);
        change(variables);
    })
}

/// How far link 2 has come, and how fast it is, after `t`.
type Path<'a> = &'a dyn Fn(f64) -> [f64; 2];

/// When this path turns between two instants: by halving, far below rounding of what is compared.
fn turn(path: Path, mut low: f64, mut high: f64) -> f64 {
    assert!(path(low)[1] > 0.0 && path(high)[1] < 0.0, "out and back");
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if path(middle)[1] > 0.0 { low = middle } else { high = middle }
    }
    low
}

/// Under a torque that goes from `from` to `to` behind a lag T.
fn lagged(rate: f64, from: f64, to: f64, lag: f64) -> impl Fn(f64) -> [f64; 2] {
    move |t| {
        let (b, gone) = (from - to, 1.0 - (-t / lag).exp());
        [rate * t + to * t * t / 2.0 + b * lag * (t - lag * gone), rate + to * t + b * lag * gone]
    }
}

/// Under a torque along a line.
fn along(rate: f64, torque: f64, growth: f64) -> impl Fn(f64) -> [f64; 2] {
    move |t| {
        let angle = rate * t + torque * t * t / 2.0 + growth * t * t * t / 6.0;
        [angle, rate + torque * t + growth * t * t / 2.0]
    }
}

/// What drives link 2 outwards.
#[derive(Clone, Copy)]
struct Drive {
    rate: f64,
    /// N·m before the start, behind the lag
    before: f64,
    torque: f64,
    growth: f64,
    lag: f64,
}

/// Link 2 starts at 1 rad on this side and goes on for `span` s in equal steps, to links that touch at 1 rad and `reach`.
fn driven(side: f64, drive: Drive, reach: f64, span: f64, steps: u32) -> Rig {
    let mut rig = free([0.0, side, 0.0, side * drive.rate], |variables| {
        variables.parameters.contact_angle = 1.0 + reach;
        variables.parameters.start_torque = side * drive.before;
        variables.inputs.torque = side * drive.torque;
        variables.effects.lag.time = drive.lag;
    });
    for k in 1..=steps {
        let (from, to) = (span * f64::from(k - 1) / f64::from(steps), span * f64::from(k) / f64::from(steps));
        rig.variables.inputs.torque = side * (drive.torque + drive.growth * from);
        rig.step_with(to, &[("tau", side * drive.growth)]);
    }
    rig
}

/// Rounding, and halvings of 0.05 s to 1e-15 s at up to 100 rad/s.
const CLOSE: f64 = 1e-12;

#[test]
fn value_contact_while_a_lag_settles() {
    let lag = 0.02;
    let drive = Drive { rate: 0.3, before: 9.0, torque: -1.0, growth: 0.0, lag };
    let path = lagged(0.3, 9.0, -1.0, lag);
    for side in [1.0, -1.0] {
        for (span, steps, instant) in [
            (0.04, 1, 0.004),
            (0.04, 1, 0.03),
            (0.12, 1, 0.015),
            (0.12, 1, 0.1),
            (0.3, 7, 0.2),
            (0.06, 60, 0.0305),
        ] {
            let [angle, _] = path(instant);
            let rig = driven(side, drive, angle, span, steps);
            let [q1, q2, dq1, dq2] = rig.state();
            let about = format!("{side}: {span} s in {steps} steps, at {instant} s: {q1}, {q2}");
            assert!(rig.variables.outputs.contact, "{about}");
            assert_eq!([dq1, dq2], [0.0; 2], "{about}");
            assert!((side * q2 - 1.0 - angle).abs() < CLOSE, "{about}");
            // Link 1 goes the other way from 0, without the rate; it tells the instant.
            let expected = -(angle - 0.3 * instant);
            assert!((side * q1 - expected).abs() < CLOSE, "{about}, not {expected}");
        }
    }
}

/// Contact just within the top of the way is met, just beyond it isn't; both ways and however many steps are taken.
fn meets_its_top(what: &str, drive: Drive, path: Path, instants: [f64; 2], span: f64) {
    let top = path(turn(path, instants[0], instants[1]))[0];
    assert!(top > 1e-3 && top > path(span)[0] + 1e-8, "{what}: goes out to {top} and comes back");
    for side in [1.0, -1.0] {
        for steps in [1, 2, 9, 100] {
            let about = format!("{what}, {side}, {steps} steps");
            let rig = driven(side, drive, top - 1e-9, span, steps);
            assert!(rig.variables.outputs.contact, "{about}: went past");
            assert!((side * rig.state()[1] - 1.0 - (top - 1e-9)).abs() < CLOSE, "{about}");
            let rig = driven(side, drive, top + 1e-9, span, steps);
            assert!(!rig.variables.outputs.contact, "{about}: touched nothing");
            let [angle, rate] = path(span);
            let [_, q2, _, dq2] = rig.state().map(|number| side * number);
            assert!(
                (q2 - 1.0 - angle).abs() < CLOSE && (dq2 - rate).abs() < CLOSE * rate.abs().max(1.0),
                "{about}"
            );
        }
    }
}

#[test]
fn value_contact_at_the_top_of_a_throw() {
    // As slow as in the rig, and far faster: 0.05 s at up to 100 rad/s.
    for torque in [40.0, 400.0, 4000.0] {
        let rate = torque * 0.025;
        let drive = Drive { rate, before: 0.0, torque: -torque, growth: 0.0, lag: 0.0 };
        meets_its_top("thrown", drive, &along(rate, -torque, 0.0), [0.0, 0.05], 0.05);
    }
    // Nearly at rest at both ends: all of the way is due to the torque in between.
    let drive = Drive { rate: 1e-6, before: 0.0, torque: 10.0, growth: -401.0, lag: 0.0 };
    meets_its_top("pushed", drive, &along(1e-6, 10.0, -401.0), [0.0, 0.05], 0.05);
}

#[test]
fn value_contact_at_the_top_while_a_lag_settles() {
    for rate in [0.01, 1.0] {
        let drive = Drive { rate, before: 30.0, torque: -20.0 - 60.0 * rate, growth: 0.0, lag: 0.02 };
        let path = lagged(rate, drive.before, drive.torque, drive.lag);
        meets_its_top("settling", drive, &path, [0.0, 0.05], 0.05);
        meets_its_top("settling, and on", drive, &path, [0.0, 0.05], 0.12);
    }
}

#[test]
fn value_contact_at_a_top_from_rest() {
    let drive = Drive { rate: 0.0, before: 30.0, torque: -20.0, growth: 0.0, lag: 0.02 };
    let path = lagged(0.0, drive.before, drive.torque, drive.lag);
    meets_its_top("from rest behind a lag", drive, &path, [1e-6, 0.05], 0.05);
    let drive = Drive { rate: 0.0, before: 0.0, torque: 10.0, growth: -420.0, lag: 0.0 };
    meets_its_top("from rest", drive, &along(0.0, 10.0, -420.0), [1e-6, 0.05], 0.05);
}

#[test]
fn value_contact_at_a_top_before_the_link_comes_again() {
    // Out, back, and outwards again at the end of one step: the rates at its ends are alike.
    let drive = Drive { rate: 6.0, before: 0.0, torque: -1000.0, growth: 40_000.0, lag: 0.0 };
    let path = along(6.0, -1000.0, 40_000.0);
    assert!(path(0.05)[1] > 0.0 && path(0.025)[1] < 0.0);
    meets_its_top("and again", drive, &path, [0.0, 0.025], 0.05);
}

#[test]
fn law_links_touch_from_the_very_angle_on() {
    // Drifts that end at the limit or a rounding beside it: touching is to have reached it.
    let mut met = 0;
    for steps in 1..=60_u32 {
        for limit in [1.25, 1.5, 1.75, 2.0] {
            let mut rig = free([0.0, 1.0, 0.0, 1.0], |variables| variables.parameters.contact_angle = limit);
            for k in 1..=steps {
                rig.step((limit - 1.0) * f64::from(k) / f64::from(steps));
                let reached = rig.state()[1] >= limit;
                assert_eq!(
                    rig.variables.outputs.contact,
                    reached,
                    "{limit} in {steps}, {k}: {:?}",
                    rig.state()
                );
            }
            met += u32::from(rig.state()[1] == limit);
        }
    }
    assert!(met > 20, "{met}"); // else nothing was asked
    // So at the start.
    for (limit, expected) in [(1.0, true), (1.0 + f64::EPSILON, false)] {
        let rig = free([0.0, -1.0, 0.0, 0.5], |variables| variables.parameters.contact_angle = limit);
        assert_eq!(rig.variables.outputs.contact, expected, "{limit}");
        assert_eq!(rig.state()[3], if expected { 0.0 } else { 0.5 });
    }
}

#[test]
fn value_contact_tells_its_time() {
    // 0.3 s away; the delay puts corners into the step before that.
    let mut rig = free([0.0, 1.0, 0.0, 1.0], |variables| {
        variables.parameters.contact_angle = 1.3;
        variables.effects.delay.time = 0.25;
    });
    let mut log = Kept::default();
    for (from, to) in [(0.0, 0.2), (0.2, 0.5)] {
        let step = Step { from, to, input_rates: &[] };
        rig.plant.step(&mut rig.variables, &step, &mut log).unwrap();
        rig.variables.inputs.torque = 0.01; // from 0.2 s on, so that it acts from 0.45 s on
    }
    assert_eq!(log.0.len(), 1, "{:?}", log.0);
    let told = log.0[0].1.split("contact at t = ").nth(1).unwrap().split(' ').next().unwrap();
    assert!((told.parse::<f64>().unwrap() - 0.3).abs() < 1e-12, "{:?}", log.0);
}

#[test]
fn value_accelerations_while_a_lag_settles() {
    for (lag, span) in [(0.02, 0.03), (0.02, 0.021), (0.02, 0.019), (0.05, 0.12)] {
        let mut rig = free([0.0, 1.0, 0.0, 0.0], |variables| {
            variables.parameters.start_torque = 5.0;
            variables.inputs.torque = -2.0;
            variables.effects.lag.time = lag;
        });
        rig.step(span);
        let expected = -2.0 + 7.0 * (-span / lag).exp();
        let locals = &rig.variables.locals;
        assert!(
            (locals.link2_acceleration - expected).abs() < CLOSE,
            "{} not {expected}",
            locals.link2_acceleration
        );
        assert!((locals.link1_acceleration + expected).abs() < CLOSE);
        let [angle, rate] = lagged(0.0, 5.0, -2.0, lag)(span);
        let [q1, q2, dq1, dq2] = rig.state();
        assert!((q2 - 1.0 - angle).abs() < CLOSE && (dq2 - rate).abs() < CLOSE, "{lag} {span}");
        assert!((q1 + angle).abs() < CLOSE && (dq1 + rate).abs() < CLOSE, "{lag} {span}");
    }
}

#[test]
fn law_a_lag_too_short_to_see_is_none() {
    // However short: no step of an integrator resolves 1e-300 s.
    let end = |lag: f64, command: f64| {
        let mut rig = Rig::at([0.3, -0.4, 0.5, 0.0], |variables| {
            variables.inputs.torque = command;
            variables.effects.lag.time = lag;
        });
        rig.run(0.2, 3);
        rig.state()
    };
    for lag in [1e-14, 1e-20, 1e-100, 1e-300] {
        let (found, expected) = (end(lag, 0.8), end(0.0, 0.8));
        // Three times what the integrator promises for a second.
        assert!(common::distance(found, expected) < 3e-10, "{lag:e}: {found:?}, not {expected:?}");
    }
}

#[test]
fn every_step_however_short_is_taken() {
    for step in [1e-13, 1e-14, 1e-20, 1e-200] {
        let mut rig = free([0.0, 0.0, 0.0, 3.0], |variables| variables.parameters.contact_angle = NO_CONTACT);
        rig.step(step);
        let [.., q2, _, dq2] = rig.state();
        assert!((q2 / (3.0 * step) - 1.0).abs() < 1e-15 && dq2 == 3.0, "{step:e}: {q2:e}"); // rounding
    }
}
