//! Each effect taken alone: what it changes, and that it changes nothing else; nothing at all at its neutral value.

use crate::common::{Rig, WILD};
use fmi2_export::{Kind, Slot, SlotMut, Table};
use mechanics::Theta;
use plant::Variables;

/// Two seconds of swinging under a torque that changes 30 times a second, as bits.
fn swing(change: impl FnOnce(&mut Variables)) -> Vec<u64> {
    let mut rig = Rig::at(WILD, change);
    let mut bits = rig.bits();
    for k in 0..60_u32 {
        rig.variables.inputs.torque = 0.8 * (f64::from(k) * 0.9).sin();
        rig.run(f64::from(k + 1) / 30.0, 4);
        bits.extend(rig.bits());
    }
    bits
}

fn set(variables: &mut Variables, index: usize, value: f64) {
    match variables.get_mut(index) {
        Some(SlotMut::Real(slot)) => *slot = value,
        other => panic!("variable {index} is {other:?}"),
    }
}

/// The effects that the contract names, with a value at which each shows.
const EFFECTS: [(&str, f64); 13] = [
    ("b_roll", 0.01),
    ("b_joint", 0.01),
    ("fc_roll", 0.01),
    ("fc_joint", 0.01),
    ("I_rotor", 0.001),
    ("slope", 0.01),
    ("incline", 0.01),
    ("tau_delay", 0.01),
    ("tau_max", 0.5),
    ("dtau_max", 10.0),
    ("T_act", 0.01),
    ("k_tau", 1.1),
    ("tau_bias", 0.05),
];

#[test]
fn alone_every_effect_is_declared_once_and_starts_off() {
    let all = Variables::variables();
    let declared: Vec<_> =
        all.iter().filter(|variable| variable.is_effect).map(|variable| variable.name).collect();
    assert_eq!(declared.len(), EFFECTS.len());
    for (name, _) in EFFECTS {
        let variable = all.iter().find(|variable| variable.name == name).unwrap();
        let off = if name == "k_tau" { 1.0 } else { 0.0 };
        assert_eq!(variable.kind, Kind::Real(off), "{name}");
        assert!(variable.is_effect, "{name}");
    }
}

#[test]
fn alone_effects_at_their_off_values_leave_eq_12_to_the_bit() {
    // With every effect off, the unit's accelerations are those of the bare equation.
    let mut rig = Rig::at(WILD, |_| {});
    for k in 0..60_u32 {
        let torque = 0.8 * (f64::from(k) * 0.9).sin();
        rig.variables.inputs.torque = torque;
        rig.run(f64::from(k + 1) / 30.0, 4);
        let [q1, q2, dq1, dq2] = rig.state();
        let mut equation = Theta::TABLE_2.equation([q1, q2], [dq1, dq2], None, true);
        equation.add_joint_torque(torque);
        let locals = &rig.variables.locals;
        assert_eq!(equation.accelerations(), [locals.link1_acceleration, locals.link2_acceleration]);
        assert_eq!(rig.variables.outputs.applied_torque.to_bits(), torque.to_bits());
    }
}

#[test]
fn alone_each_effect_matters_and_negative_zero_is_off() {
    let without = swing(|_| {});
    let all = Variables::variables();
    for (name, value) in EFFECTS {
        let index = all.iter().position(|variable| variable.name == name).unwrap();
        assert_ne!(swing(|variables| set(variables, index, value)), without, "{name} = {value}");
        if name != "k_tau" {
            assert_eq!(swing(|variables| set(variables, index, -0.0)), without, "{name} = -0");
        }
    }
}

#[test]
fn alone_limits_out_of_reach_leave_no_trace() {
    let without = swing(|_| {});
    assert_eq!(swing(|variables| variables.effects.saturation.limit = 0.9), without); // torques stay below 0.8
    assert_eq!(swing(|variables| variables.effects.slope.weight = 7.0), without); // level ground
    assert_eq!(swing(|variables| variables.outputs.applied_torque = 7.0), without); // outputs are only written
}

#[test]
fn alone_forces_are_what_they_claim() {
    // M·(q̈ with − q̈ without) is the generalised force of the effect.
    let [q1, q2, dq1, dq2] = WILD;
    let joint = dq2 - dq1;
    let sign = |rate: f64| (rate / 1e-3).tanh();
    type Change = fn(&mut Variables);
    let cases: [(&str, Change, [f64; 2]); 7] = [
        ("b_roll", |v| v.effects.viscous.roll = 0.3, [-0.3 * dq1, 0.0]),
        ("b_joint", |v| v.effects.viscous.joint = 0.3, [0.3 * joint, -0.3 * joint]),
        ("fc_roll", |v| v.effects.coulomb.roll = 0.2, [-0.2 * sign(dq1), 0.0]),
        ("fc_joint", |v| v.effects.coulomb.joint = 0.2, [0.2 * sign(joint), -0.2 * sign(joint)]),
        ("tau_bias", |v| v.effects.bias.torque = 0.4, [-0.4, 0.4]),
        ("tau_1", |v| v.inputs.link1_torque = 0.4, [0.4, 0.0]),
        ("tau_2", |v| v.inputs.link2_torque = 0.4, [0.0, 0.4]),
    ];
    let accelerations = |change: Change| {
        let locals = Rig::at(WILD, change).variables.locals;
        [locals.link1_acceleration, locals.link2_acceleration]
    };
    let without = accelerations(|_| {});
    let inertia = Theta::TABLE_2.equation([q1, q2], [dq1, dq2], None, true);
    for (name, change, expected) in cases {
        let with = accelerations(change);
        let [d1, d2] = [with[0] - without[0], with[1] - without[1]];
        let force = [inertia.m11 * d1 + inertia.m12 * d2, inertia.m12 * d1 + inertia.m22 * d2];
        for i in 0..2 {
            assert!((force[i] - expected[i]).abs() < 1e-13, "{name}: {force:?} instead of {expected:?}"); // rounding
        }
    }
    // The rotor adds to M instead: (M + I·[1 −1; −1 1])·q̈ stays f.
    let [d1, d2] = accelerations(|v| v.effects.rotor.inertia = 0.02);
    let twist = 0.02 * (d1 - d2);
    let force = [inertia.m11 * d1 + inertia.m12 * d2 + twist, inertia.m12 * d1 + inertia.m22 * d2 - twist];
    assert!((force[0] - inertia.f1).abs() < 1e-13 && (force[1] - inertia.f2).abs() < 1e-13);
}

/// The torque after each of `steps` communication steps of 10 ms, the command being 0.5 N·m from 0 on.
fn torques(steps: u32, change: impl FnOnce(&mut Variables)) -> Vec<f64> {
    let mut rig = Rig::at([0.0; 4], change);
    rig.variables.inputs.torque = 0.5;
    (1..=steps)
        .map(|k| {
            rig.step(f64::from(k) / 100.0);
            rig.variables.outputs.applied_torque
        })
        .collect()
}

#[test]
fn alone_stages_of_the_actuator_answer_a_step() {
    let close = |a: &[f64], b: &[f64]| {
        assert_eq!(a.len(), b.len());
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-14), "{a:?} instead of {b:?}"); // rounding
    };
    close(&torques(3, |v| v.effects.delay.time = 0.015), &[0.0, 0.5, 0.5]);
    close(&torques(3, |v| v.effects.delay.time = 0.02), &[0.0, 0.0, 0.5]); // at 20 ms: still the limit from the left
    close(&torques(3, |v| v.effects.saturation.limit = 0.2), &[0.2; 3]);
    close(&torques(4, |v| v.effects.rate_limit.limit = 16.0), &[0.16, 0.32, 0.48, 0.5]);
    let lag: Vec<f64> = (1..=4).map(|k| 0.5 * (1.0 - (-f64::from(k) * 0.01 / 0.03).exp())).collect();
    close(&torques(4, |v| v.effects.lag.time = 0.03), &lag);
    close(&torques(2, |v| v.effects.gain.factor = -2.0), &[-1.0; 2]);
    close(&torques(2, |v| v.effects.bias.torque = 0.1), &[0.6; 2]);
    // In order: saturation before gain before bias.
    let all = |v: &mut Variables| {
        v.effects.saturation.limit = 0.2;
        v.effects.gain.factor = 3.0;
        v.effects.bias.torque = 0.1;
    };
    close(&torques(2, all), &[0.2 * 3.0 + 0.1; 2]);
}

#[test]
fn alone_actuator_starts_from_zero_torque() {
    type Change = fn(&mut Variables);
    let cases: [(Change, f64); 5] = [
        (|_| {}, 0.5),
        (|v| v.effects.delay.time = 0.1, 0.0),
        (|v| v.effects.rate_limit.limit = 1.0, 0.0),
        (|v| v.effects.lag.time = 0.1, 0.0),
        (|v| (v.effects.lag.time, v.effects.bias.torque) = (0.1, 0.3), 0.3),
    ];
    for (change, expected) in cases {
        let rig = Rig::at([0.0; 4], |variables| {
            change(variables);
            variables.inputs.torque = 0.5;
        });
        let torque = rig.variables.outputs.applied_torque;
        assert!((torque - expected).abs() < 1e-15, "{torque} instead of {expected}"); // rounding of the lag's sum
    }
}

#[test]
fn alone_a_reference_finds_every_variable() {
    let mut variables = Variables::default();
    for (index, variable) in Variables::variables().iter().enumerate() {
        let kind = match variables.get(index).unwrap() {
            Slot::Real(value) => Kind::Real(*value),
            Slot::Integer(value) => Kind::Integer(*value),
            Slot::Boolean(value) => Kind::Boolean(*value),
            Slot::String(value) => Kind::String(value.into()),
        };
        assert_eq!(kind, variable.kind, "{}", variable.name);
        assert!(variables.get_mut(index).is_some());
    }
    assert_eq!(variables.get(Variables::COUNT), None);
}
