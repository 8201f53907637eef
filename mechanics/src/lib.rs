//! The acrobot's equations as pure functions of theta.
//!
//! Stands below everything else of ours: the plant integrates [`Theta::equation`], the controller is built from
//! [`Theta::linearisation`] and [`Place`], studies and the diagnosis read z from [`Place`]. Nothing here keeps
//! time, state or files.
//!
//! Angles are absolute, in rad, from the upright vertical and positive towards +u (right); torques in N·m.
//! Transcendental functions come from the `libm` crate, so that bits don't depend on the machine's C library.
//!
//! Sources: eqs. (12), (13), Tables 1 and 2 of Bishop, Hutchinson, Spong, "Camera Modelling for Visual Servo
//! Control Applications"; the velocity terms from the Lagrangian that belongs to the M(q) printed there.

#![forbid(unsafe_code)]

pub mod manifold;
pub mod motion;
pub mod place;
pub mod sampled;
pub mod theta;

pub use manifold::Linearisation;
pub use motion::{Equation, Incline};
pub use place::Place;
pub use sampled::{Rates, Sampling};
pub use theta::{Links, Theta};

/// Why an equation has no answer for these parameters.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MechanicsError {
    /// Eq. (13) asks for the arcsine of something beyond 1.
    #[error(
        "theta_10 / theta_9 = {ratio}: must lie strictly between -1 and 1, or the equilibrium manifold (13) ends \
         before abs(q2) = pi/2"
    )]
    NoManifold {
        /// theta_10 / theta_9
        ratio: f64,
    },
    /// M(q) can't be inverted.
    #[error(
        "the inertia matrix is not positive definite at q1 = {q1} rad, q2 = {q2} rad: its determinant is \
         {determinant} kg2.m4, must be > 0"
    )]
    SingularInertia {
        /// Angle of link 1, rad.
        q1: f64,
        /// Angle of link 2, rad.
        q2: f64,
        /// Determinant of M(q).
        determinant: f64,
    },
    /// The torque at the joint can't move the linearised plant everywhere.
    #[error(
        "the linearised plant is not controllable from the joint torque at q2 = {q2} rad on the manifold"
    )]
    Uncontrollable {
        /// Angle of link 2, rad.
        q2: f64,
    },
}
