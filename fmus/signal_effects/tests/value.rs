//! Numbers of the signal unit: closed forms, stamps that are never lost by rounding, and the plant's actuator.

mod common;
use common::{Rig, busy, scattered};
use fmi2_export::{Experiment, Log, Model, Step};
use plant::Plant;

#[test]
fn value_a_lag_follows_a_held_value_and_a_line_in_closed_form() {
    let time = 0.3;
    let mut held = Rig::new(0.0, 0.0, |variables| variables.effects.lag = time);
    let mut ramp = Rig::new(0.0, 0.0, |variables| {
        variables.effects.lag = time;
        variables.hold.linear = true;
    });
    for k in 1..=100 {
        let t = 0.02 * f64::from(k);
        // Rounding of a hundred steps.
        assert!((held.step(t, 1.0) - (1.0 - (-t / time).exp())).abs() < 1e-14);
        assert!((ramp.step(t, t) - (t - time + time * (-t / time).exp())).abs() < 1e-14);
    }
}

#[test]
fn value_a_lag_that_is_next_to_nothing_is_next_to_none() {
    for linear in [false, true] {
        for time in [f64::MIN_POSITIVE / 16.0, 1e-300, 1e-9] {
            let mut rig = Rig::new(0.0, 0.0, |variables| {
                variables.effects.lag = time;
                variables.hold.linear = linear;
            });
            // A line is followed one time constant late: 1e-9 s at 100 per second.
            assert!((rig.step(0.01, 1.0) - 1.0).abs() <= 1.01e-7, "lag {time}: {}", rig.y());
        }
    }
}

#[test]
fn value_a_delay_of_whole_steps_is_exact_whoever_sums_the_time() {
    for start in [0.0, 1e5] {
        for linear in [false, true] {
            let size = 0.1;
            let mut rig = Rig::new(start, scattered(0), |variables| {
                variables.effects.delay = 0.7;
                variables.hold.linear = linear;
            });
            let mut time = start;
            for k in 1..3000_u32 {
                time += size; // a master that sums: 0.1 is no binary number
                let y = rig.step(time, scattered(k));
                assert_eq!(y, scattered(k.saturating_sub(7)), "start {start}, linear {linear}, step {k}");
            }
        }
    }
}

#[test]
fn value_a_delay_of_any_length_with_steps_of_any_length() {
    for delay in [1e-4, 0.013, 0.0777, 0.5] {
        let mut held = Rig::new(0.0, 0.0, |variables| variables.effects.delay = delay);
        let mut line = Rig::new(0.0, 0.0, |variables| {
            variables.effects.delay = delay;
            variables.hold.linear = true;
        });
        let mut stamps = vec![(0.0, 0.0)];
        let mut time = 0.0;
        for k in 0..2000 {
            time += 0.01 * (1.2 + scattered(k));
            let u = scattered(k + 1);
            stamps.push((time, u));
            let asked = time - delay;
            let after = stamps.partition_point(|(stamp, _)| *stamp < asked);
            let (expected_held, expected_line) = if after == 0 {
                (0.0, 0.0)
            } else {
                let ((t0, u0), (t1, u1)) = (stamps[after - 1], stamps[after]);
                (u1, u0 + (u1 - u0) * (asked - t0) / (t1 - t0))
            };
            assert_eq!(held.step(time, u), expected_held);
            assert!((line.step(time, u) - expected_line).abs() < 1e-11); // rounding at slopes of up to 1e3
        }
    }
}

#[test]
fn value_saturation_and_rate_limit_within_a_step() {
    let rig = |limit: f64, rate: f64| {
        Rig::new(0.0, 0.0, |variables| {
            variables.effects.saturation = limit;
            variables.effects.rate_limit = rate;
            variables.effects.lag = 1.0;
            variables.hold.linear = true;
        })
    };
    // u = 4t over a second, cut at 1 from t = 1/4 on, through a lag of 1 s: both parts in closed form.
    for sign in [1.0, -1.0] {
        let at_corner = 4.0 * (0.25 - 1.0 + (-0.25_f64).exp());
        let expected = 1.0 + (at_corner - 1.0) * (-0.75_f64).exp();
        assert!((rig(1.0, 0.0).step(1.0, 4.0 * sign) - sign * expected).abs() < 1e-15);
        // The same line followed at 2 per second, without and with the cut: 2t, and 2t until 1/2.
        let followed = 2.0 * (-1.0_f64).exp();
        assert!((rig(0.0, 2.0).step(1.0, 4.0 * sign) - sign * followed).abs() < 1e-15);
        let at_corner = 2.0 * (0.5 - 1.0 + (-0.5_f64).exp());
        let expected = 1.0 + (at_corner - 1.0) * (-0.5_f64).exp();
        assert!((rig(1.0, 2.0).step(1.0, 4.0 * sign) - sign * expected).abs() < 1e-15);
        // From one limit through to the other: a rise of 8 at 8 per second, cut at both ends for a quarter and more.
        let mut through = rig(1.0, 0.0);
        through.step(50.0, -3.0 * sign); // settled to e⁻⁵⁰ at the lower limit
        through.step(51.0, 5.0 * sign);
        let rise = -1.0 + 8.0 * (0.25 - 1.0 + (-0.25_f64).exp());
        let expected = 1.0 + (rise - 1.0) * (-0.5_f64).exp();
        assert!((through.y() - sign * expected).abs() < 1e-14, "{} {expected}", through.y());
    }
}

#[test]
fn value_a_rate_limit_lets_go_where_it_has_caught_up() {
    let mut rig = Rig::new(0.0, 0.0, |variables| variables.effects.rate_limit = 10.0);
    assert_eq!(rig.step(0.1, 2.0), 1.0);
    assert_eq!(rig.step(0.3, 2.0), 2.0);
    assert!((rig.step(0.4, -5.0) - 1.0).abs() < 1e-15);
    assert_eq!(rig.step(5.0, -5.0), -5.0);
    // Catching a line that comes towards it: 3 − 20t meets 0 + 10t at t = 0.1, and is then too fast to follow.
    let mut rig = Rig::new(0.0, 0.0, |variables| variables.effects.rate_limit = 10.0);
    let y = rig.step_with(0.2, 3.0, &[("u", -20.0)]);
    assert!((y - (1.0 - 10.0 * 0.1)).abs() < 1e-15, "{y}");
}

#[test]
fn value_gain_bias_drift_and_disturbance_come_last() {
    let mut rig = Rig::new(2.0, 0.25, |variables| {
        let effects = &mut variables.effects;
        (effects.gain, effects.bias, effects.drift, effects.saturation) = (-3.0, 0.5, 0.125, 1.0);
        variables.inputs.disturbance = 8.0;
    });
    assert_eq!(rig.y(), -0.75 + 0.5 + 8.0); // no drift at the start
    assert_eq!(rig.step(4.0, 7.0), -3.0 + 0.5 + 0.25 + 8.0); // cut before the gain
    assert_eq!(rig.step_with(6.0, 0.5, &[("d", 0.5)]), -1.5 + 0.5 + 0.5 + 9.0);
    assert_eq!(rig.step_with(6.5, 0.5, &[("u", 0.5)]), -3.0 * 0.75 + 0.5 + 0.5625 + 8.0);
}

struct Silence;
impl Log for Silence {
    fn log(&mut self, _: &'static str, _: &dyn Fn() -> String) {}
}

/// The reference for the order of effects and for what holds when: an actuator that was written before.
#[test]
fn value_the_same_as_the_plants_actuator() {
    let steps = |k: u32| if k.is_multiple_of(3) { 0.004 } else { 0.011 };
    for ramped in [false, true] {
        let mut plant = Plant::default();
        let mut variables = plant::Variables::default();
        let mut rig = Rig::new(0.0, 0.3, |variables| busy(&mut variables.effects));
        let effects = &mut variables.effects;
        let ours = &rig.variables.effects;
        effects.delay.time = ours.delay;
        effects.saturation.limit = ours.saturation;
        effects.rate_limit.limit = ours.rate_limit;
        effects.lag.time = ours.lag;
        effects.gain.factor = ours.gain;
        effects.bias.torque = ours.bias;
        variables.parameters.start_torque = 0.3;
        variables.inputs.torque = 0.3;
        let experiment = Experiment { start: 0.0, stop: None, tolerance: None };
        plant.initialize(&mut variables, &experiment, &mut Silence).expect("legal");
        assert_eq!(variables.outputs.applied_torque, rig.y());
        let mut moved = 0;
        for k in 0..1000 {
            let (from, to) = (rig.time, rig.time + steps(k));
            let (u, slope) = (scattered(k), if ramped { 50.0 * scattered(k + 5) } else { 0.0 });
            let before = rig.y();
            let y = if ramped { rig.step_with(to, u, &[("u", slope)]) } else { rig.step(to, u) };
            variables.inputs.torque = u;
            let rates = [("tau", slope)];
            let input_rates = if ramped { &rates[..] } else { &[] };
            plant.step(&mut variables, &Step { from, to, input_rates }, &mut Silence).expect("legal");
            let theirs = variables.outputs.applied_torque;
            // Its corners are told apart down to 1e-12 s, at rates of up to 50 per second.
            assert!((theirs - y).abs() < 1e-10, "ramped {ramped}, at {to} s: {theirs}, {y}");
            moved += u32::from((y - before).abs() > 1e-3);
        }
        assert!(moved > 500, "{moved} of 1000 steps move the output");
    }
}
