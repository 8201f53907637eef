//! What must hold of the signal unit whatever its parameters: nothing when off, no trace of how time is cut, no loss
//! when saved.

mod common;
use common::{Rig, Silence, busy, scattered};
use fmi2_export::{Experiment, Model, Step};
use signal_effects::{SignalEffects, Variables};

type Change = fn(&mut Variables);

#[test]
fn law_all_off_passes_every_bit() {
    let odd = [0.0, -0.0, f64::MIN_POSITIVE / 8.0, 1.0 / 3.0, -7.3e-300, f64::MAX, -1e17, 0.1 + 0.2];
    for linear in [false, true] {
        let mut rig = Rig::new(0.0, -0.0, |variables| variables.hold.linear = linear);
        assert_eq!(rig.y().to_bits(), (-0.0_f64).to_bits());
        for k in 0..4000 {
            let u = if k < 8 { odd[k as usize] } else { scattered(k) * 10f64.powi(k as i32 % 31 - 15) };
            let size = 0.001 * (1.5 + scattered(k + 7));
            assert_eq!(rig.step(rig.time + size, u).to_bits(), u.to_bits());
        }
    }
}

#[test]
fn law_each_effect_alone_leaves_the_value_as_it_is_where_it_does_nothing() {
    let changes: [Change; 3] = [
        |variables| variables.effects.saturation = 1.0,   // not reached
        |variables| variables.effects.rate_limit = 1e5,   // not reached on the way along a line
        |variables| variables.effects.delay = 1.0 / 64.0, // two steps, exact in binary
    ];
    for (place, change) in changes.into_iter().enumerate() {
        let mut rig = Rig::new(0.0, scattered(0), |variables| {
            change(variables);
            variables.hold.linear = true;
        });
        for k in 1..500_u32 {
            let expected = if place == 2 { scattered(k.saturating_sub(2)) } else { scattered(k) };
            let y = rig.step(f64::from(k) / 128.0, scattered(k));
            assert_eq!(y.to_bits(), expected.to_bits(), "effect {place}, step {k}");
        }
    }
}

#[test]
fn law_how_time_is_cut_leaves_no_trace() {
    let cases: [Change; 2] =
        [|variables| busy(&mut variables.effects), |variables| variables.effects.delay = 0.0123];
    for (linear, case) in [(false, 0), (true, 0), (false, 1), (true, 1)] {
        let make = || {
            Rig::new(0.0, 0.2, |variables| {
                cases[case](variables);
                variables.hold.linear = linear;
            })
        };
        let (mut coarse, mut fine) = (make(), make());
        let mut before = 0.2;
        for k in 0..300_u32 {
            let u = scattered(k / 3);
            let (from, to) = (0.01 * f64::from(k), 0.01 * f64::from(k + 1));
            let y = coarse.step(to, u);
            for part in 1..=7 {
                let share = f64::from(part) / 7.0;
                let value = if linear { before + (u - before) * share } else { u };
                fine.step(from + (to - from) * share, if part == 7 { u } else { value });
            }
            before = u;
            // Rounding: seven times as many corners, values below 1.
            assert!((y - fine.y()).abs() < 1e-13, "linear = {linear}, at {to} s: {y}, {}", fine.y());
        }
    }
}

#[test]
fn every_saved_state_goes_on_to_the_bit() {
    let drive = |rig: &mut Rig, from: u32, to: u32| -> Vec<u64> {
        (from..to).map(|k| rig.step(f64::from(k + 1) / 120.0, scattered(k / 2)).to_bits()).collect()
    };
    for cut in [0, 1, 7, 50] {
        let mut rig = Rig::new(0.0, 0.3, |variables| {
            busy(&mut variables.effects);
            variables.effects.drift = 0.1;
            variables.hold.linear = cut % 2 == 1;
        });
        drive(&mut rig, 0, cut);
        let saved = postcard::to_stdvec(&(&rig.unit, &rig.variables)).expect("serialisable");
        let expected = drive(&mut rig, cut, 100);
        let (unit, variables): (SignalEffects, Variables) = postcard::from_bytes(&saved).expect("readable");
        let mut restored = Rig { unit, variables, time: f64::from(cut) / 120.0 };
        assert_eq!(drive(&mut restored, cut, 100), expected);
        assert!(expected.windows(2).any(|pair| pair[0] != pair[1]), "something moves");
    }
}

#[test]
fn every_initialisation_starts_from_nothing() {
    let drive = |rig: &mut Rig| -> Vec<f64> {
        (0..100).map(|k| rig.step(5.0 + f64::from(k + 1) / 120.0, scattered(k))).collect()
    };
    let mut rig = Rig::new(5.0, 0.3, |variables| busy(&mut variables.effects));
    let first = drive(&mut rig);
    rig.variables.inputs.value = 0.3;
    let experiment = Experiment { start: 5.0, stop: None, tolerance: None };
    rig.unit.initialize(&mut rig.variables, &experiment, &mut Silence).expect("legal");
    rig.time = 5.0;
    assert_eq!(drive(&mut rig), first);
}

#[test]
fn every_delay_line_is_bounded() {
    let bytes = |change: fn(u32) -> f64| {
        let mut rig = Rig::new(0.0, 0.0, |variables| variables.effects.delay = 0.1);
        let step = |k: u32| {
            rig.step(f64::from(k + 1) / 1000.0, change(k));
            postcard::to_stdvec(&rig.unit).expect("serialisable").len()
        };
        (0..2000).map(step).max()
    };
    let moving = bytes(|k| f64::from(k % 2)).expect("steps");
    assert!(moving < 103 * 24 + 100, "{moving} bytes"); // 100 pieces of three numbers wait, two are at the ends
    let still = bytes(|_| 1.0).expect("steps");
    assert!(still < 150, "{still} bytes"); // a value that stays takes one place
}

#[test]
fn law_directional_derivatives_are_differences() {
    let cases: [(Change, f64); 5] = [
        (|_| {}, 0.4),
        (|variables| variables.effects.gain = -2.5, 0.4),
        (|variables| variables.effects.saturation = 0.3, 0.4),
        (|variables| variables.effects.saturation = 0.5, 0.4),
        (|variables| variables.effects.delay = 0.05, 0.4),
    ];
    for (place, (change, u)) in cases.into_iter().enumerate() {
        let answer = |u: f64, d: f64| {
            let mut rig = Rig::new(0.0, 0.0, change);
            rig.variables.inputs.disturbance = d;
            rig.step(0.01, u);
            rig
        };
        let rig = answer(u, 0.1);
        let by = |known| rig.unit.derivative(&rig.variables, "y", known).expect("provided");
        // Piecewise linear in both: a difference of 1e-3 is the derivative but for rounding.
        let (by_u, by_d) = (answer(u + 1e-3, 0.1).y() - rig.y(), answer(u, 0.101).y() - rig.y());
        assert!((by("u") - by_u / 1e-3).abs() < 1e-12, "case {place}: {} and {}", by("u"), by_u / 1e-3);
        assert!((by("d") - by_d / 1e-3).abs() < 1e-12, "case {place}");
        assert_eq!(rig.unit.derivative(&rig.variables, "y", "gain"), None);
    }
}

#[test]
fn law_the_start_is_saturated_and_gives_nothing_on_at_the_limit() {
    let started =
        |u: f64, saturation: f64| Rig::new(0.0, u, |variables| variables.effects.saturation = saturation);
    for (u, saturation, y) in [(2.0, 0.5, 0.5), (-2.0, 0.5, -0.5), (0.4, 0.5, 0.4), (2.0, 0.0, 2.0)] {
        assert_eq!(started(u, saturation).y(), y, "{u} with a saturation of {saturation}");
    }
    let by_u = |rig: Rig| rig.unit.derivative(&rig.variables, "y", "u");
    assert_eq!(by_u(started(0.5, 0.5)), Some(0.0), "what reaches the limit has no way up");
    assert_eq!(by_u(started(0.499, 0.5)), Some(1.0));
}

#[test]
fn law_a_step_of_a_whole_experiment_is_legal() {
    let mut rig = Rig::new(-3.0, 0.0, |variables| busy(&mut variables.effects));
    let step = Step { from: -3.0, to: 1e9, input_rates: &[("u", 1e-9)] };
    rig.unit.step(&mut rig.variables, &step, &mut Silence).expect("legal");
    assert!((rig.y() - (0.9 * 0.7 + 0.01)).abs() < 1e-12, "settled at the saturation: {}", rig.y());
}

#[test]
fn every_word_of_the_description_is_committed() {
    let committed = include_str!("../../../modelDescriptions/signal_effects.xml");
    assert!(
        fmi2_export::description::Unit::of::<SignalEffects>().xml() == committed,
        "stale: cargo xtask pack"
    );
}
