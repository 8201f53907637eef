//! The plant's variables, each declared once.

use crate::effects::Effects;
use crate::integrator::{LOOSEST, TIGHTEST, TOLERANCE};
use fmi2_export::{ModelError, Unit, table, unit, variables};
use mechanics::{Theta, place::ARM_END};

/// Energy.
const JOULE: Unit = Unit { name: "J", exponents: [1, 2, -2, 0, 0, 0, 0, 0], factor: 1.0, display: &[] };

variables! {
    /// What acts on the plant.
    pub struct Inputs {
        input torque: f64 = 0.0, "tau", "τ", unit::NEWTON_METRE,
            "Commanded torque between the links, u = [-1, 1]' tau in eq. (12).";
        input link1_torque: f64 = 0.0, "tau_1", "τ₁", unit::NEWTON_METRE,
            "External torque on link 1; not in the paper, moves a rig that is pinned.";
        input link2_torque: f64 = 0.0, "tau_2", "τ₂", unit::NEWTON_METRE,
            "External torque on link 2; not in the paper. With the opposite on link 1 it acts at the joint, past the actuator.";
    }
}

variables! {
    /// What can be seen of the plant. The start values are those of the start state (14).
    pub struct Outputs {
        output link1_angle: f64 = -0.05, "q1", "q₁", unit::RADIAN,
            "Angle of link 1 from the upright vertical, positive towards +u, eq. (12).";
        output link2_angle: f64 = 0.1, "q2", "q₂", unit::RADIAN,
            "Absolute angle of link 2 from the upright vertical, positive towards +u, eq. (12).";
        output link1_rate: f64 = 0.0, "dq1", "q̇₁", unit::RADIAN_PER_SECOND,
            "Rate of q1.", derivative_of = "q1";
        output link2_rate: f64 = 0.0, "dq2", "q̇₂", unit::RADIAN_PER_SECOND,
            "Rate of q2.", derivative_of = "q2";
        output applied_torque: f64 = 0.0, "tau_applied", "τ_a", unit::NEWTON_METRE,
            "Torque between the links after the actuator, at the end of the step.";
        output place: f64 = 0.0, "z", "z", unit::ONE,
            "Place on the manifold (13) that belongs to q2, 0.5 at 75 % of its arm; 0 where theta has no manifold.";
        output contact: bool = false, "contact", "", unit::ONE,
            "abs(q2) reached q2_max: the links touch, and the state is held from then on.";
    }
}

variables! {
    /// The dynamic parameters, the start state and what else shapes the equations.
    pub struct Parameters {
        parameter theta_1: f64 = Theta::TABLE_2.theta_1, "theta_1", "θ₁", unit::KILOGRAM_METRE_SQUARED,
            "Inertia m1*R^2 + m2*l1^2 + m2*R^2 + J1, Tables 1 and 2.";
        parameter theta_2: f64 = Theta::TABLE_2.theta_2, "theta_2", "θ₂", unit::KILOGRAM_METRE_SQUARED,
            "Inertia 2*m1*R*lc1 + 2*m2*R*l1, Tables 1 and 2; 0 for a pinned pendulum.";
        parameter theta_5: f64 = Theta::TABLE_2.theta_5, "theta_5", "θ₅", unit::KILOGRAM_METRE_SQUARED,
            "Inertia J2, Tables 1 and 2.";
        parameter theta_7: f64 = Theta::TABLE_2.theta_7, "theta_7", "θ₇", unit::KILOGRAM_METRE_SQUARED,
            "Inertia m2*R*lc2, Tables 1 and 2; 0 for a pinned pendulum.";
        parameter theta_8: f64 = Theta::TABLE_2.theta_8, "theta_8", "θ₈", unit::KILOGRAM_METRE_SQUARED,
            "Inertia m2*l1*lc2, Tables 1 and 2.";
        parameter theta_9: f64 = Theta::TABLE_2.theta_9, "theta_9", "θ₉", unit::NEWTON_METRE,
            "Gravity m1*g*lc1 + m2*g*l1, Tables 1 and 2.";
        parameter theta_10: f64 = Theta::TABLE_2.theta_10, "theta_10", "θ₁₀", unit::NEWTON_METRE,
            "Gravity m2*g*lc2, Tables 1 and 2.";
        fixed link1_start: f64 = -0.05, "q1_0", "q₁(0)", unit::RADIAN,
            "Start value of q1, eq. (14).";
        fixed link2_start: f64 = 0.1, "q2_0", "q₂(0)", unit::RADIAN,
            "Start value of q2, eq. (14).";
        fixed link1_start_rate: f64 = 0.0, "dq1_0", "q̇₁(0)", unit::RADIAN_PER_SECOND,
            "Start value of dq1, eq. (14).";
        fixed link2_start_rate: f64 = 0.0, "dq2_0", "q̇₂(0)", unit::RADIAN_PER_SECOND,
            "Start value of dq2, eq. (14).";
        fixed start_torque: f64 = 0.0, "tau_0", "τ(0)", unit::NEWTON_METRE,
            "Command before the start: what the actuator's delay, rate limit and lag hold then.";
        parameter contact_angle: f64 = ARM_END, "q2_max", "q₂max", unit::RADIAN,
            "abs(q2) at which the links touch, Section 3.1.", min = 0.0;
        parameter velocity_terms: bool = true, "velocity_terms", "", unit::ONE,
            "true: full Lagrangian; false: c of eq. (12) as printed, gravity only.";
    }
}

variables! {
    /// What happens inside.
    pub struct Locals {
        local link1_acceleration: f64 = 0.0, "ddq1", "q̈₁", unit::RADIAN_PER_SECOND_SQUARED,
            "Angular acceleration of link 1, eq. (12).", derivative_of = "dq1";
        local link2_acceleration: f64 = 0.0, "ddq2", "q̈₂", unit::RADIAN_PER_SECOND_SQUARED,
            "Angular acceleration of link 2, eq. (12).", derivative_of = "dq2";
        local energy: f64 = 0.0, "energy", "E", JOULE,
            "Kinetic and potential energy, theta_9 + theta_10 at rest at the upright.";
    }
}

variables! {
    /// How exactly the equations are solved.
    pub struct Solver {
        fixed tolerance: f64 = TOLERANCE, "tolerance", "", unit::ONE,
            "Largest estimated error of the integrator per second, in rad and rad/s, relative to values above 1.",
            min = TIGHTEST, max = LOOSEST;
    }
}

impl Parameters {
    /// theta, for the equations.
    pub fn theta(&self) -> Theta {
        let Parameters { theta_1, theta_2, theta_5, theta_7, theta_8, theta_9, theta_10, .. } = *self;
        Theta { theta_1, theta_2, theta_5, theta_7, theta_8, theta_9, theta_10 }
    }
}

impl Solver {
    /// Refuses what no integration keeps to.
    pub fn check(&self) -> Result<(), ModelError> {
        if (TIGHTEST..=LOOSEST).contains(&self.tolerance) {
            return Ok(());
        }
        let expected = format!("must be between {TIGHTEST:e} and {LOOSEST:e}");
        Err(ModelError::Value { name: "tolerance", value: self.tolerance.to_string(), expected })
    }
}

table! {
    /// All variables of the plant.
    pub struct Variables {
        /// Inputs.
        pub inputs: Inputs,
        /// Outputs.
        pub outputs: Outputs,
        /// Parameters.
        pub parameters: Parameters,
        /// Parameters of the effects.
        pub effects: Effects,
        /// Local variables.
        pub locals: Locals,
        /// How exactly.
        pub solver: Solver,
    }
}
