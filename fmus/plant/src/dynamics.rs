//! The right-hand side that the integrator sees: eq. (12), the effects on the bodies, the torques.

use crate::effects::{Effects, Motion};
use crate::variables::Variables;
use mechanics::{Equation, Incline, Theta};

/// The plant's equations with everything that stays the same within a step.
#[derive(Debug)]
pub struct Dynamics<'a> {
    theta: Theta,
    velocity_terms: bool,
    effects: &'a Effects,
    ground: Option<Incline>,
    /// External torques on the links at the beginning of the step, N·m, and their rates, N·m/s.
    external: [(f64, f64); 2],
}

impl<'a> Dynamics<'a> {
    /// The equations for these parameters; the external torques on the links have the given rates.
    pub fn new(variables: &'a Variables, external_rates: [f64; 2]) -> Dynamics<'a> {
        let parameters = &variables.parameters;
        Dynamics {
            theta: parameters.theta(),
            velocity_terms: parameters.velocity_terms,
            effects: &variables.effects,
            ground: variables.effects.incline(),
            external: [
                (variables.inputs.link1_torque, external_rates[0]),
                (variables.inputs.link2_torque, external_rates[1]),
            ],
        }
    }

    /// M·q̈ = f at a state and a torque between the links, `offset` s after the beginning of the step.
    #[inline]
    pub fn equation(&self, motion: &Motion, torque: f64, offset: f64) -> Equation {
        let mut equation =
            self.theta.equation(motion.q, motion.dq, self.ground.as_ref(), self.velocity_terms);
        self.effects.act(motion, &mut equation);
        equation.add_joint_torque(torque);
        for ((torque, rate), force) in self.external.iter().zip([&mut equation.f1, &mut equation.f2]) {
            if *torque != 0.0 || *rate != 0.0 {
                *force += torque + rate * offset;
            }
        }
        equation
    }

    /// Kinetic and potential energy, J.
    pub fn energy(&self, motion: &Motion) -> f64 {
        self.theta.energy(motion.q, motion.dq, self.ground.as_ref()) + self.effects.kinetic_energy(motion)
    }
}
