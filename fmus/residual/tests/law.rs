//! The residual unit: what passes, what each term is, what is refused.

use fmi2_export::{Experiment, Log, Model, ModelError, Slot, SlotMut, Step, Table};
use residual::{Residual, Variables};

struct Silence;
impl Log for Silence {
    fn log(&mut self, _: &'static str, _: &dyn Fn() -> String) {}
}

const EXPERIMENT: Experiment = Experiment { start: 0.0, stop: None, tolerance: None };

fn set(variables: &mut Variables, name: &str, value: f64) {
    let index = Variables::variables().iter().position(|variable| variable.name == name).expect("declared");
    match variables.get_mut(index) {
        Some(SlotMut::Real(slot)) => *slot = value,
        _ => panic!("{name} is no Real"),
    }
}

fn get(variables: &Variables, name: &str) -> f64 {
    let index = Variables::variables().iter().position(|variable| variable.name == name).expect("declared");
    match variables.get(index) {
        Some(Slot::Real(value)) => *value,
        _ => panic!("{name} is no Real"),
    }
}

fn answered(values: &[(&str, f64)]) -> Result<Variables, ModelError> {
    let mut variables = Variables::default();
    values.iter().for_each(|(name, value)| set(&mut variables, name, *value));
    let mut unit = Residual::default();
    unit.initialize(&mut variables, &EXPERIMENT, &mut Silence)?;
    unit.step(&mut variables, &Step { from: 0.0, to: 0.01, input_rates: &[] }, &mut Silence)?;
    Ok(variables)
}

const STATE: [(&str, f64); 4] = [("q1", 0.3), ("q2", -0.5), ("dq1", 0.7), ("dq2", -0.4)];

#[test]
fn law_torques_pass_to_the_bit_without_coefficients() {
    for given in [0.0, -0.0, 0.1, -7.3e-300] {
        let mut values = STATE.to_vec();
        values.extend([("tau_1_in", given), ("tau_2_in", -given)]);
        let variables = answered(&values).expect("legal");
        assert_eq!(get(&variables, "tau_1").to_bits(), given.to_bits());
        assert_eq!(get(&variables, "tau_2").to_bits(), (-given).to_bits());
    }
}

#[test]
fn value_each_term_is_what_it_says() {
    let (x, v) = (0.3, 0.7);
    let (y, w) = (-0.5 - 0.3, -0.4 - 0.7);
    let sign = |rate: f64| (rate / 0.02).tanh();
    let fall = |rate: f64, slow: f64| (-(rate / slow) * (rate / slow)).exp();
    let cases: [(&str, f64, f64); 8] = [
        ("bias", 1.0, 1.0),
        ("spring", x, y),
        ("even", x * x, y * y),
        ("stiff", x * x * x, y * y * y),
        ("damp", v, w),
        ("drag", v * v, -w * w),
        ("stick", sign(v), sign(w)),
        ("stribeck", sign(v) * fall(v, 0.6), sign(w) * fall(w, 0.6)),
    ];
    for (name, roll, joint) in cases {
        let of = |axis: &str| {
            let (coefficient, slow) = (format!("{name}_{axis}"), format!("slow_{axis}"));
            let mut values = STATE.to_vec();
            values.extend([(coefficient.as_str(), 2.0), (slow.as_str(), 0.6)]);
            let variables = answered(&values).expect("legal");
            [get(&variables, "tau_1"), get(&variables, "tau_2")]
        };
        let close = |a: [f64; 2], b: [f64; 2]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-15); // rounding
        assert!(close(of("roll"), [2.0 * roll, 0.0]), "{name}: {:?}", of("roll"));
        assert!(close(of("joint"), [-2.0 * joint, 2.0 * joint]), "{name}: {:?}", of("joint"));
    }
}

#[test]
fn law_terms_stay_at_the_edge_of_what_the_data_covered() {
    let torque = |q1: f64, dq1: f64| {
        let values = [
            ("q1", q1),
            ("dq1", dq1),
            ("stiff_roll", 1.0),
            ("drag_roll", 1.0),
            ("centre_roll", 3.0),
            ("reach_roll", 0.5),
            ("speed_roll", 2.0),
        ];
        get(&answered(&values).expect("legal"), "tau_1")
    };
    assert_eq!(torque(3.5, 2.0), 0.125 + 4.0);
    assert_eq!(torque(9.0, 50.0), torque(3.5, 2.0));
    assert_eq!(torque(-9.0, -50.0), -torque(3.5, 2.0));
    assert!((torque(3.25, 1.0) - (0.25_f64.powi(3) + 1.0)).abs() < 1e-15); // measured from the centre; rounding
}

#[test]
fn law_rates_of_inputs_move_the_state_to_the_steps_end() {
    let mut variables = Variables::default();
    set(&mut variables, "spring_roll", 1.0);
    let mut unit = Residual::default();
    set(&mut variables, "q1", -2.0);
    unit.initialize(&mut variables, &EXPERIMENT, &mut Silence).expect("legal");
    assert_eq!(get(&variables, "tau_1"), -2.0, "outputs are there before the first step");
    set(&mut variables, "q1", 0.0);
    let step = Step { from: 0.0, to: 0.5, input_rates: &[("q1", 0.25), ("tau_1_in", 2.0)] };
    unit.step(&mut variables, &step, &mut Silence).expect("legal");
    assert_eq!(get(&variables, "tau_1"), 0.125 + 1.0);
}

#[test]
fn every_bad_value_is_refused_by_name() {
    for (name, value) in [
        ("q1", f64::INFINITY),
        ("stick_roll", f64::NAN),
        ("smooth", 0.0),
        ("slow_joint", -1.0),
        ("reach_roll", -0.1),
    ] {
        match answered(&[(name, value)]) {
            Err(ModelError::Value { name: said, .. }) => assert_eq!(said, name),
            other => panic!("{name}: {:?}", other.map(|variables| variables.outputs)),
        }
    }
    let error = answered(&[("q1", 1e200), ("stiff_roll", 1.0)]).expect_err("1e600").to_string();
    assert!(error.contains("overflow"), "{error}");
}

#[test]
fn every_word_of_the_description_is_committed() {
    let committed = include_str!("../../../modelDescriptions/acrobot_residual.xml");
    assert!(fmi2_export::description::Unit::of::<Residual>().xml() == committed, "stale: cargo xtask pack");
}

#[test]
fn law_derivatives_are_the_differences() {
    // All terms at once, inside and beyond what the data covered.
    let mut values = STATE.to_vec();
    values.extend([("tau_1_in", 0.4), ("tau_2_in", -0.2)]);
    let terms = ["bias", "spring", "even", "stiff", "damp", "drag", "stick", "stribeck"];
    for axis in ["roll", "joint"] {
        for (place, term) in terms.iter().enumerate() {
            let name = format!("{term}_{axis}");
            let declared = Variables::variables().iter().any(|variable| variable.name == name);
            assert!(declared, "{name}");
            values.push((Box::leak(name.into_boxed_str()), 0.1 + 0.05 * place as f64));
        }
    }
    values.push(("smooth", 0.5));
    for limits in [&[][..], &[("reach_roll", 0.2), ("speed_joint", 0.9)]] {
        let at = |changed: &str, by: f64| {
            let all = values
                .iter()
                .chain(limits)
                .map(|(name, value)| (*name, value + if *name == changed { by } else { 0.0 }));
            answered(&all.collect::<Vec<_>>()).expect("legal")
        };
        let middle = at("", 0.0);
        for known in ["q1", "q2", "dq1", "dq2", "tau_1_in", "tau_2_in"] {
            // Second order: h² = 1e-10 times third derivatives of order 10, and rounding 1e-16/h.
            let h = 1e-5;
            let (before, after) = (at(known, -h), at(known, h));
            for unknown in ["tau_1", "tau_2", "roll", "joint"] {
                let expected = (get(&after, unknown) - get(&before, unknown)) / (2.0 * h);
                let found = Residual::default().derivative(&middle, unknown, known).expect("provided");
                assert!((found - expected).abs() < 1e-8, "{unknown} by {known}: {found}, not {expected}");
            }
        }
    }
    assert_eq!(Residual::default().derivative(&at_rest(), "tau_1", "smooth"), None);
    assert_eq!(Residual::default().derivative(&at_rest(), "q1", "q1"), None);
}

fn at_rest() -> Variables {
    answered(&STATE).expect("legal")
}
