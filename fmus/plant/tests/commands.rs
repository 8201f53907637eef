//! Commands along lines, and of either sign, through each stage of the actuator, against closed forms.

use crate::common::Rig;
use plant::Variables;

/// The torque at the joint after one step of a second along the command `value + rate·t`.
fn after(value: f64, rate: f64, change: impl Fn(&mut Variables)) -> f64 {
    let mut rig = Rig::at([0.0; 4], |variables| {
        variables.inputs.torque = value;
        change(variables);
    });
    rig.step_with(1.0, &[("tau", rate)]);
    rig.variables.outputs.applied_torque
}

/// Where a lag T ends after t that stood at 0 and follows r·t.
fn ramped(rate: f64, t: f64, time: f64) -> f64 {
    rate * (t - time + time * (-t / time).exp())
}

/// Where a lag T ends after t that stood at `from` and follows a constant.
fn settled(from: f64, to: f64, t: f64, time: f64) -> f64 {
    to + (from - to) * (-t / time).exp()
}

/// Rounding, and corners that are told apart down to 1e-12 s.
const CLOSE: f64 = 1e-11;

#[test]
fn value_saturation_cuts_commands_of_either_sign() {
    for sign in [1.0, -1.0] {
        let limited = |value: f64, rate: f64, limit: f64, lag: f64| {
            sign * after(sign * value, sign * rate, |variables| {
                variables.effects.saturation.limit = limit;
                variables.effects.lag.time = lag;
            })
        };
        assert_eq!(limited(2.0, 0.0, 0.7, 0.0), 0.7);
        assert_eq!(limited(0.5, 0.0, 0.7, 0.0), 0.5);
        // Reached inside the step, after a quarter of it; the lag tells what came before.
        let expected = settled(ramped(4.0, 0.25, 0.5), 1.0, 0.75, 0.5);
        assert!((limited(0.0, 4.0, 1.0, 0.5) - expected).abs() < CLOSE);
        // Left inside the step: 3 − 4t is cut until t = 1/2.
        let cut = settled(0.0, 1.0, 0.5, 0.5);
        let expected = settled(cut, 1.0, 0.5, 0.5) + ramped(-4.0, 0.5, 0.5);
        assert!((limited(3.0, -4.0, 1.0, 0.5) - expected).abs() < CLOSE);
        // From one limit to the other: 2 − 5t is cut until 1/5 and from 3/5 on.
        let cut = settled(0.0, 1.0, 0.2, 0.5);
        let through = settled(cut, 1.0, 0.4, 0.5) + ramped(-5.0, 0.4, 0.5);
        let expected = settled(through, -1.0, 0.4, 0.5);
        assert!((limited(2.0, -5.0, 1.0, 0.5) - expected).abs() < CLOSE);
    }
}

#[test]
fn value_a_rate_limit_follows_ramps_of_either_sign() {
    for sign in [1.0, -1.0] {
        let limited = |value: f64, rate: f64, limit: f64| {
            sign * after(sign * value, sign * rate, |variables| variables.effects.rate_limit.limit = limit)
        };
        assert!((limited(0.0, 4.0, 3.0) - 3.0).abs() < CLOSE, "too fast a ramp");
        assert!((limited(0.0, 2.0, 3.0) - 2.0).abs() < CLOSE, "one that it follows");
        assert!((limited(1.0, 1.0, 3.0) - 2.0).abs() < CLOSE, "caught up with at t = 1/2");
        assert!((limited(3.0, -4.0, 6.0) - -1.0).abs() < CLOSE, "met at t = 0.3, and followed down");
        assert!(
            (limited(3.0, -7.0, 3.0) - (0.9 - 0.7 * 3.0)).abs() < CLOSE,
            "met at t = 0.3, and then too fast"
        );
    }
}

#[test]
fn value_a_rate_limit_beside_a_command_as_fast_as_itself_keeps_its_distance() {
    for sign in [1.0, -1.0] {
        let mut rig = Rig::at([0.0; 4], |variables| {
            variables.effects.rate_limit.limit = 3.0;
            variables.inputs.torque = sign;
        });
        rig.step_with(1.0, &[("tau", 3.0 * sign)]);
        assert!((sign * rig.variables.outputs.applied_torque - 3.0).abs() < CLOSE, "1 N.m behind");
        // The command stands at what it has become, and is caught up with after a third of a second.
        rig.variables.inputs.torque = 4.0 * sign;
        rig.step(1.25);
        assert!((sign * rig.variables.outputs.applied_torque - 3.75).abs() < CLOSE);
        rig.step(2.0);
        assert!((sign * rig.variables.outputs.applied_torque - 4.0).abs() < CLOSE);
    }
}

#[test]
fn law_a_rate_limit_has_no_scale() {
    // Limit, commands and their rates times a power of two give torques times that power, to the bit: it holds for micronewtons
    // and for cranes. The links touch, so that none of these torques is integrated.
    let torques = |scale: f64| {
        let mut rig = Rig::at([0.0, 2.0, 0.0, 0.0], |variables| {
            variables.parameters.contact_angle = 1.0;
            variables.effects.rate_limit.limit = 3.0 * scale;
        });
        let mut torques = Vec::new();
        for k in 0..200_u32 {
            let rate = scale * f64::from(k % 5) - 2.0 * scale;
            rig.variables.inputs.torque = scale * (0.7 * f64::from(k / 3)).sin();
            rig.step_with(f64::from(k + 1) * 0.03, &[("tau", rate)]);
            torques.push(rig.variables.outputs.applied_torque / scale);
        }
        torques
    };
    let expected = torques(1.0);
    assert!(expected.iter().any(|torque| torque.abs() > 0.5));
    for power in [-300, -40, -10, 10, 40, 300] {
        assert_eq!(torques(2.0_f64.powi(power)), expected, "2^{power}");
    }
}

#[test]
fn value_ramps_through_delay_saturation_and_lag() {
    for sign in [1.0, -1.0] {
        let delayed = |limit: f64, lag: f64| {
            sign * after(0.0, 4.0 * sign, |variables| {
                variables.effects.delay.time = 0.25;
                variables.effects.saturation.limit = limit;
                variables.effects.lag.time = lag;
            })
        };
        assert!((delayed(0.0, 0.0) - 3.0).abs() < CLOSE);
        assert!((delayed(1.0, 0.0) - 1.0).abs() < CLOSE);
        assert!((delayed(0.0, 0.5) - ramped(4.0, 0.75, 0.5)).abs() < CLOSE);
        let expected = settled(ramped(4.0, 0.25, 0.5), 1.0, 0.5, 0.5);
        assert!((delayed(1.0, 0.5) - expected).abs() < CLOSE);
    }
    // Ramps of several steps: 0.03 s late whatever the steps, cut at 0.4.
    let mut rig = Rig::at([0.0; 4], |variables| {
        variables.effects.delay.time = 0.03;
        variables.effects.saturation.limit = 0.4;
    });
    let saw = |t: f64| if t < 0.0 { 0.0 } else { (8.0 * (t % 0.1)).min(0.4) };
    for k in 0..60_u32 {
        let (from, to) = (f64::from(k) * 0.01, f64::from(k + 1) * 0.01);
        rig.variables.inputs.torque = 8.0 * f64::from(k % 10) * 0.01;
        rig.step_with(to, &[("tau", 8.0)]);
        // Where the saw falls, a step ends with the value before the fall.
        let before = saw(from - 0.03 + 0.005) + 8.0 * 0.005;
        let expected = if to <= 0.03 + 1e-9 { 0.0 } else { before.min(0.4) };
        let found = rig.variables.outputs.applied_torque;
        assert!((found - expected).abs() < CLOSE, "at {to} s: {found}, {expected}");
    }
}
