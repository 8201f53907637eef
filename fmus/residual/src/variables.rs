//! The residual unit's variables, each declared once. What the terms are stands in `terms.rs`.

use crate::terms::Axis;
use fmi2_export::{Unit, table, unit, variables};

const PER_RADIAN: Unit = per("N.m/rad", 0, 1);
const PER_RADIAN_SQUARED: Unit = per("N.m/rad2", 0, 2);
const PER_RADIAN_CUBED: Unit = per("N.m/rad3", 0, 3);
const PER_RATE: Unit = unit::NEWTON_METRE_SECOND_PER_RADIAN;
const PER_RATE_SQUARED: Unit = per("N.m.s2/rad2", 2, 2);

/// Torque times time to a power, per angle to a power.
const fn per(name: &'static str, seconds: i8, radians: i8) -> Unit {
    Unit { name, exponents: [1, 2, seconds - 2, 0, 0, 0, 0, -radians], factor: 1.0, display: &[] }
}

variables! {
    /// The plant's state, and torques that pass.
    pub struct Inputs {
        input link1_angle: f64 = 0.0, "q1", "q₁", unit::RADIAN,
            "Angle of link 1 from the upright vertical, eq. (12).";
        input link2_angle: f64 = 0.0, "q2", "q₂", unit::RADIAN,
            "Absolute angle of link 2 from the upright vertical, eq. (12).";
        input link1_rate: f64 = 0.0, "dq1", "q̇₁", unit::RADIAN_PER_SECOND,
            "Rate of q1.";
        input link2_rate: f64 = 0.0, "dq2", "q̇₂", unit::RADIAN_PER_SECOND,
            "Rate of q2.";
        input link1_given: f64 = 0.0, "tau_1_in", "τ₁,ᵢₙ", unit::NEWTON_METRE,
            "External torque on link 1 from elsewhere; the correction is added to it.";
        input link2_given: f64 = 0.0, "tau_2_in", "τ₂,ᵢₙ", unit::NEWTON_METRE,
            "External torque on link 2 from elsewhere; the correction is added to it.";
    }
}

variables! {
    /// What goes to the plant.
    pub struct Outputs {
        output link1_torque: f64 = 0.0, "tau_1", "τ₁", unit::NEWTON_METRE,
            "External torque on link 1: tau_1_in + roll - joint.";
        output link2_torque: f64 = 0.0, "tau_2", "τ₂", unit::NEWTON_METRE,
            "External torque on link 2: tau_2_in + joint.";
        output roll_torque: f64 = 0.0, "roll", "τ_r", unit::NEWTON_METRE,
            "The correction between the ground and link 1.";
        output joint_torque: f64 = 0.0, "joint", "τ_j", unit::NEWTON_METRE,
            "The correction between the links, positive as the plant's tau.";
    }
}

variables! {
    /// Coefficients of the torque between the ground and link 1: angle q1, rate dq1.
    pub struct Roll {
        effect bias: f64 = 0.0, "bias_roll", "c₀", unit::NEWTON_METRE,
            "Coefficient of 1 in the torque on link 1; off at 0.";
        effect spring: f64 = 0.0, "spring_roll", "c₁", PER_RADIAN,
            "Coefficient of x = q1 - centre_roll in the torque on link 1, negative for a spring; off at 0.";
        effect even: f64 = 0.0, "even_roll", "c₂", PER_RADIAN_SQUARED,
            "Coefficient of x^2 in the torque on link 1; off at 0.";
        effect stiff: f64 = 0.0, "stiff_roll", "c₃", PER_RADIAN_CUBED,
            "Coefficient of x^3 in the torque on link 1; off at 0.";
        effect damp: f64 = 0.0, "damp_roll", "c₄", PER_RATE,
            "Coefficient of v = dq1 in the torque on link 1, negative for friction; off at 0.";
        effect drag: f64 = 0.0, "drag_roll", "c₅", PER_RATE_SQUARED,
            "Coefficient of v*abs(v) in the torque on link 1, negative for drag; off at 0.";
        effect stick: f64 = 0.0, "stick_roll", "c₆", unit::NEWTON_METRE,
            "Coefficient of tanh(v/smooth) in the torque on link 1, negative for friction; off at 0.";
        effect stribeck: f64 = 0.0, "stribeck_roll", "c₇", unit::NEWTON_METRE,
            "Coefficient of tanh(v/smooth)*exp(-(v/slow_roll)^2) in the torque on link 1; off at 0.";
        parameter centre: f64 = 0.0, "centre_roll", "x₀", unit::RADIAN,
            "Angle q1 from which x is measured.";
        parameter reach: f64 = 0.0, "reach_roll", "X", unit::RADIAN,
            "Largest abs(x) that the data covered: terms stay at what they are there; 0: no limit.", min = 0.0;
        parameter speed: f64 = 0.0, "speed_roll", "V", unit::RADIAN_PER_SECOND,
            "Largest abs(v) that the data covered: terms stay at what they are there; 0: no limit.", min = 0.0;
        parameter slow: f64 = 0.15, "slow_roll", "v_s", unit::RADIAN_PER_SECOND,
            "Rate over which the Stribeck term falls.", min = 0.0;
    }
}

variables! {
    /// Coefficients of the torque between the links: angle q2 - q1, rate dq2 - dq1.
    pub struct Joint {
        effect bias: f64 = 0.0, "bias_joint", "d₀", unit::NEWTON_METRE,
            "Coefficient of 1 in the torque at the joint; off at 0.";
        effect spring: f64 = 0.0, "spring_joint", "d₁", PER_RADIAN,
            "Coefficient of x = q2 - q1 - centre_joint in the torque at the joint, negative for a spring; off at 0.";
        effect even: f64 = 0.0, "even_joint", "d₂", PER_RADIAN_SQUARED,
            "Coefficient of x^2 in the torque at the joint; off at 0.";
        effect stiff: f64 = 0.0, "stiff_joint", "d₃", PER_RADIAN_CUBED,
            "Coefficient of x^3 in the torque at the joint; off at 0.";
        effect damp: f64 = 0.0, "damp_joint", "d₄", PER_RATE,
            "Coefficient of v = dq2 - dq1 in the torque at the joint, negative for friction; off at 0.";
        effect drag: f64 = 0.0, "drag_joint", "d₅", PER_RATE_SQUARED,
            "Coefficient of v*abs(v) in the torque at the joint, negative for drag; off at 0.";
        effect stick: f64 = 0.0, "stick_joint", "d₆", unit::NEWTON_METRE,
            "Coefficient of tanh(v/smooth) in the torque at the joint, negative for friction; off at 0.";
        effect stribeck: f64 = 0.0, "stribeck_joint", "d₇", unit::NEWTON_METRE,
            "Coefficient of tanh(v/smooth)*exp(-(v/slow_joint)^2) in the torque at the joint; off at 0.";
        parameter centre: f64 = 0.0, "centre_joint", "y₀", unit::RADIAN,
            "Angle q2 - q1 from which x is measured.";
        parameter reach: f64 = 0.0, "reach_joint", "Y", unit::RADIAN,
            "Largest abs(x) that the data covered: terms stay at what they are there; 0: no limit.", min = 0.0;
        parameter speed: f64 = 0.0, "speed_joint", "W", unit::RADIAN_PER_SECOND,
            "Largest abs(v) that the data covered: terms stay at what they are there; 0: no limit.", min = 0.0;
        parameter slow: f64 = 0.15, "slow_joint", "w_s", unit::RADIAN_PER_SECOND,
            "Rate over which the Stribeck term falls.", min = 0.0;
    }
}

variables! {
    /// What both have in common.
    pub struct Common {
        parameter smooth: f64 = 0.02, "smooth", "v₀", unit::RADIAN_PER_SECOND,
            "Rate over which the sign of a rate is smoothed: torques are held over a communication step, and a sharper \
             sign would chatter.", min = 0.0;
    }
}

macro_rules! axis {
    ($Coefficients:ident) => {
        impl $Coefficients {
            /// The terms with these coefficients.
            pub fn axis(&self) -> Axis {
                let Self { bias, spring, even, stiff, damp, drag, stick, stribeck, .. } = *self;
                Axis {
                    coefficients: [bias, spring, even, stiff, damp, drag, stick, stribeck],
                    centre: self.centre,
                    reach: self.reach,
                    speed: self.speed,
                    slow: self.slow,
                }
            }
        }
    };
}
axis!(Roll);
axis!(Joint);

table! {
    /// All variables of the residual unit.
    pub struct Variables {
        /// Inputs.
        pub inputs: Inputs,
        /// Outputs.
        pub outputs: Outputs,
        /// Between the ground and link 1.
        pub roll: Roll,
        /// Between the links.
        pub joint: Joint,
        /// Common.
        pub common: Common,
    }
}
