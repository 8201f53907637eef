//! The controller as a unit: when it answers, what it keeps, what it refuses.

use controller::{Controller, Variables};
use fmi2_export::{Experiment, Log, Model, ModelError, Step, Table};
use mechanics::Theta;

struct Silence;
impl Log for Silence {
    fn log(&mut self, _: &'static str, _: &dyn Fn() -> String) {}
}

const EXPERIMENT: Experiment = Experiment { start: 0.0, stop: None, tolerance: None };

fn start(change: impl FnOnce(&mut Variables)) -> Result<(Controller, Variables), ModelError> {
    let (mut controller, mut variables) = (Controller::default(), Variables::default());
    change(&mut variables);
    controller.initialize(&mut variables, &EXPERIMENT, &mut Silence)?;
    Ok((controller, variables))
}

fn step(controller: &mut Controller, variables: &mut Variables) -> f64 {
    let step = Step { from: 0.0, to: 0.01, input_rates: &[] };
    controller.step(variables, &step, &mut Silence).unwrap();
    variables.outputs.torque
}

#[test]
fn every_communication_point_is_new_without_frames() {
    let (mut controller, mut variables) = start(|v| v.inputs.link2_angle = 0.1).unwrap();
    let first = variables.outputs.torque;
    assert_ne!(first, 0.0);
    variables.inputs.link2_angle = 0.2;
    let second = step(&mut controller, &mut variables);
    assert_ne!(second, first);
    variables.inputs.desired_place = 0.3;
    assert_ne!(step(&mut controller, &mut variables), second);
}

#[test]
fn every_torque_is_held_until_the_next_frame() {
    let (mut controller, mut variables) = start(|v| {
        v.inputs.frame = 0;
        v.inputs.link2_angle = 0.1;
    })
    .unwrap();
    assert_eq!((variables.outputs.torque, variables.outputs.estimated_place), (0.0, 0.0));
    assert_eq!(step(&mut controller, &mut variables), 0.0);
    variables.inputs.frame = 1;
    let first = step(&mut controller, &mut variables);
    assert_ne!(first, 0.0);
    variables.inputs.link2_angle = 0.2;
    variables.inputs.desired_place = 0.1;
    assert_eq!(step(&mut controller, &mut variables), first);
    variables.inputs.frame = 3; // one lost on the way
    assert_ne!(step(&mut controller, &mut variables), first);

    let (_, variables) = start(|v| {
        v.inputs.frame = 1;
        v.inputs.link2_angle = 0.1;
    })
    .unwrap();
    assert_eq!(variables.outputs.torque, first); // a frame delivered at the start counts
}

#[test]
fn every_rate_of_an_input_moves_the_estimate_to_the_steps_end() {
    let (mut controller, mut variables) = start(|_| {}).unwrap();
    variables.inputs.link2_angle = 0.1;
    let moving = Step { from: 0.0, to: 0.5, input_rates: &[("q2", 0.2)] };
    controller.step(&mut variables, &moving, &mut Silence).unwrap();
    let torque = variables.outputs.torque;
    variables.inputs.link2_angle = 0.1 + 0.2 * 0.5;
    assert_eq!(step(&mut controller, &mut variables), torque);
}

#[test]
fn every_saved_state_goes_on_to_the_bit() {
    let (mut controller, mut variables) = start(|v| v.inputs.frame = 0).unwrap();
    variables.inputs.frame = 7;
    variables.inputs.link1_angle = -0.02;
    step(&mut controller, &mut variables);
    let saved = postcard::to_stdvec(&(&controller, &variables)).unwrap();
    let (mut restored, mut copy): (Controller, Variables) = postcard::from_bytes(&saved).unwrap();
    for frame in [7, 8, 8, 9] {
        for values in [&mut variables, &mut copy] {
            values.inputs.frame = frame;
            values.inputs.link1_rate = f64::from(frame) * 0.01;
        }
        assert_eq!(step(&mut restored, &mut copy).to_bits(), step(&mut controller, &mut variables).to_bits());
    }
}

#[test]
fn every_change_of_theta_rebuilds_the_tables() {
    let at = |v: &mut Variables| (v.inputs.link1_angle, v.inputs.link2_angle) = (-0.3, 0.9);
    let (mut controller, mut variables) = start(at).unwrap();
    variables.parameters.theta_10 = 1.7;
    let changed = step(&mut controller, &mut variables);
    let (_, fresh) = start(|v| {
        at(v);
        v.parameters.theta_10 = 1.7;
    })
    .unwrap();
    assert_eq!(changed, fresh.outputs.torque);
    assert_ne!(changed, start(at).unwrap().1.outputs.torque);
}

#[test]
fn every_bad_value_is_refused_by_name() {
    type Change = fn(&mut Variables);
    let cases: [(&str, Change); 7] = [
        ("q1", |v| v.inputs.link1_angle = f64::NAN),
        ("dq2", |v| v.inputs.link2_rate = f64::INFINITY),
        ("z_desired", |v| v.inputs.desired_place = f64::NAN),
        ("omega_1", |v| v.parameters.omega_1 = 0.0),
        ("zeta_2", |v| v.parameters.zeta_2 = f64::NAN),
        ("theta_8", |v| v.parameters.theta_8 = f64::NAN),
        ("frame", |v| v.inputs.frame = -2),
    ];
    for (expected, change) in cases {
        match start(change) {
            Err(ModelError::Value { name, .. }) => assert_eq!(name, expected),
            other => panic!("{expected}: {other:?}"),
        }
    }
    let huge = start(|v| v.inputs.link1_rate = f64::MAX).unwrap_err().to_string();
    assert!(huge.contains("the law overflows for Inputs { link1_angle: 0.0"), "{huge}");
    let (mut controller, mut variables) = start(|_| {}).unwrap();
    let moving = Step { from: 0.0, to: 0.5, input_rates: &[("q2", f64::NAN)] };
    let error = controller.step(&mut variables, &moving, &mut Silence).unwrap_err().to_string();
    assert!(error.starts_with("variable q2 = NaN: "), "{error}");
    let steep = start(|v| v.parameters.theta_10 = 5.0).unwrap_err().to_string();
    assert!(steep.contains("theta_10 / theta_9 = 1.04"), "{steep}");
}

#[test]
fn every_start_value_is_that_of_table_2() {
    let variables = Variables::default();
    assert_eq!(variables.parameters.theta(), Theta::TABLE_2);
    let mut names: Vec<_> = Variables::variables().iter().map(|variable| variable.name).collect();
    names.sort_unstable();
    assert!(names.windows(2).all(|pair| pair[0] != pair[1]), "{names:?}");
}

#[test]
fn golden_torque_at_14() {
    let (_, variables) = start(|v| (v.inputs.link1_angle, v.inputs.link2_angle) = (-0.05, 0.1)).unwrap();
    // Every digit of 2026-11: arithmetic and `libm` don't depend on the machine.
    let answer = (variables.outputs.torque, variables.outputs.estimated_place);
    assert_eq!(answer, (-0.36542441648445056, 0.00844531008979754));
}

#[test]
fn every_word_of_the_description_is_committed() {
    let committed = include_str!("../../../modelDescriptions/acrobot_controller.xml");
    assert!(
        fmi2_export::description::Unit::of::<controller::Controller>().xml() == committed,
        "stale: cargo xtask pack"
    );
}

#[test]
fn law_derivatives_are_the_differences_of_the_outputs() {
    let inputs = |v: &mut Variables, moved: usize, by: f64| {
        let inputs = &mut v.inputs;
        let places = [
            &mut inputs.link1_angle,
            &mut inputs.link2_angle,
            &mut inputs.link1_rate,
            &mut inputs.link2_rate,
            &mut inputs.desired_place,
        ];
        // Far from the upright, where the torque that holds an equilibrium bends.
        for (at, (place, value)) in places.into_iter().zip([-0.5, 1.1, 0.2, -0.3, 0.25]).enumerate() {
            *place = value + if at == moved { by } else { 0.0 };
        }
    };
    for side in [1.0, -1.0] {
        let (mut controller, variables) = start(|v| {
            inputs(v, 5, 0.0);
            v.inputs.link2_angle *= side;
        })
        .unwrap();
        let from_bytes = Controller::default();
        for (known, name) in ["q1", "q2", "dq1", "dq2", "z_desired"].iter().enumerate() {
            let h = 1e-5;
            let [tau, z_hat] = [-h, h]
                .map(|by| {
                    let mut moved = variables.clone();
                    inputs(&mut moved, known, if *name == "q2" { side * by } else { by });
                    moved.inputs.link2_angle *= side;
                    step(&mut controller, &mut moved);
                    [moved.outputs.torque, moved.outputs.estimated_place]
                })
                .into_iter()
                .reduce(|low, high| [0, 1].map(|output| (high[output] - low[output]) / (2.0 * h)))
                .unwrap();
            for (unknown, difference) in [("tau", tau), ("z_hat", z_hat)] {
                let derivative = controller.derivative(&variables, unknown, name).unwrap();
                // The differences are good to h² and to 1e-16/h of torques of some 10 N·m.
                let allowed = 1e-6 * (1.0 + difference.abs());
                assert!(
                    (derivative - difference).abs() < allowed,
                    "{unknown} by {name}: {derivative} {difference}"
                );
                // A state that came as bytes has no table yet.
                assert_eq!(from_bytes.derivative(&variables, unknown, name), Some(derivative));
            }
        }
    }
}

#[test]
fn every_derivative_before_the_first_estimate_is_zero_and_of_others_there_is_none() {
    let (controller, variables) = start(|v| v.inputs.frame = 0).unwrap();
    assert_eq!(controller.derivative(&variables, "tau", "q2"), Some(0.0));
    assert_eq!(controller.derivative(&variables, "tau", "frame"), None);
    assert_eq!(controller.derivative(&variables, "theta_1", "q2"), None);
    // A table of other parameters is not asked.
    let (controller, mut variables) = start(|v| v.inputs.link2_angle = 0.5).unwrap();
    let before = controller.derivative(&variables, "tau", "q2");
    variables.parameters.theta_10 *= 1.1;
    assert_ne!(controller.derivative(&variables, "tau", "q2"), before);
}
