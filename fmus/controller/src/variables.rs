//! The controller's variables, each declared once.

use crate::law::Polynomial;
use fmi2_export::{Unit, table, unit, variables};
use mechanics::Theta;

/// Angular frequency of a pair of poles.
const OMEGA: Unit = unit::RADIAN_PER_SECOND;

variables! {
    /// What the controller is told.
    pub struct Inputs {
        input link1_angle: f64 = 0.0, "q1", "q₁", unit::RADIAN,
            "Angle of link 1 from the upright vertical, estimated or true, Section 3.2.";
        input link2_angle: f64 = 0.0, "q2", "q₂", unit::RADIAN,
            "Absolute angle of link 2 from the upright vertical, estimated or true, Section 3.2.";
        input link1_rate: f64 = 0.0, "dq1", "q̇₁", unit::RADIAN_PER_SECOND,
            "Rate of q1; the camera's are first-order differences, Section 3.1.";
        input link2_rate: f64 = 0.0, "dq2", "q̇₂", unit::RADIAN_PER_SECOND,
            "Rate of q2; the camera's are first-order differences, Section 3.1.";
        input desired_place: f64 = 0.0, "z_desired", "z_d", unit::ONE,
            "Place on the manifold that is asked for, Section 4.2.";
        input frame: i32 = -1, "frame", "k", unit::ONE,
            "Number of the estimate: a change brings a new one; 0: none yet, torque 0; -1: a new one at every \
             communication point.", min = -1;
    }
}

variables! {
    /// What the controller says.
    pub struct Outputs {
        output torque: f64 = 0.0, "tau", "τ", unit::NEWTON_METRE,
            "Torque asked for between the links, held until a new estimate arrives.";
        output estimated_place: f64 = 0.0, "z_hat", "ẑ", unit::ONE,
            "Place on the manifold as the law sees it: y1, the pseudolinearizing coordinate.";
    }
}

variables! {
    /// The nominal plant and the poles of the closed loop.
    pub struct Parameters {
        parameter theta_1: f64 = Theta::TABLE_2.theta_1, "theta_1", "θ₁", unit::KILOGRAM_METRE_SQUARED,
            "Nominal inertia, Tables 1 and 2.";
        parameter theta_2: f64 = Theta::TABLE_2.theta_2, "theta_2", "θ₂", unit::KILOGRAM_METRE_SQUARED,
            "Nominal inertia, Tables 1 and 2; 0 for a pinned pendulum.";
        parameter theta_5: f64 = Theta::TABLE_2.theta_5, "theta_5", "θ₅", unit::KILOGRAM_METRE_SQUARED,
            "Nominal inertia, Tables 1 and 2.";
        parameter theta_7: f64 = Theta::TABLE_2.theta_7, "theta_7", "θ₇", unit::KILOGRAM_METRE_SQUARED,
            "Nominal inertia, Tables 1 and 2; 0 for a pinned pendulum.";
        parameter theta_8: f64 = Theta::TABLE_2.theta_8, "theta_8", "θ₈", unit::KILOGRAM_METRE_SQUARED,
            "Nominal inertia, Tables 1 and 2.";
        parameter theta_9: f64 = Theta::TABLE_2.theta_9, "theta_9", "θ₉", unit::NEWTON_METRE,
            "Nominal gravity, Tables 1 and 2.";
        parameter theta_10: f64 = Theta::TABLE_2.theta_10, "theta_10", "θ₁₀", unit::NEWTON_METRE,
            "Nominal gravity, Tables 1 and 2.";
        parameter omega_1: f64 = 6.11, "omega_1", "ω₁", OMEGA,
            "First pair of closed-loop poles, s^2 + 2*zeta*omega*s + omega^2; chosen here, the paper's are unknown.",
            min = 0.0;
        parameter zeta_1: f64 = 0.84, "zeta_1", "ζ₁", unit::ONE,
            "Damping ratio of the first pair of closed-loop poles; chosen here, the paper's are unknown.";
        parameter omega_2: f64 = 3.52, "omega_2", "ω₂", OMEGA,
            "Second pair of closed-loop poles, s^2 + 2*zeta*omega*s + omega^2; chosen here, the paper's are unknown.",
            min = 0.0;
        parameter zeta_2: f64 = 0.54, "zeta_2", "ζ₂", unit::ONE,
            "Damping ratio of the second pair of closed-loop poles; chosen here, the paper's are unknown.";
    }
}

impl Parameters {
    /// theta, for the tables.
    pub fn theta(&self) -> Theta {
        let Parameters { theta_1, theta_2, theta_5, theta_7, theta_8, theta_9, theta_10, .. } = *self;
        Theta { theta_1, theta_2, theta_5, theta_7, theta_8, theta_9, theta_10 }
    }

    /// The closed loop's polynomial.
    pub fn polynomial(&self) -> Polynomial {
        Polynomial::from_pole_pairs([self.omega_1, self.zeta_1], [self.omega_2, self.zeta_2])
    }
}

table! {
    /// All variables of the controller.
    pub struct Variables {
        /// Inputs.
        pub inputs: Inputs,
        /// Outputs.
        pub outputs: Outputs,
        /// Parameters.
        pub parameters: Parameters,
    }
}
