//! Ground that is not level: it falls towards +u.
//!
//! The equations are those of [`mechanics::Incline`]: the drum's path is turned by the angle, and the weight of
//! both links pulls it downhill with θ_slope·sin(slope). Source: the Lagrangian of the rolling double pendulum.

use super::{Mechanical, finite};
use fmi2_export::{ModelError, unit, variables};
use mechanics::{Incline, Theta};

variables! {
    /// Ground that is not level.
    pub struct Slope {
        effect angle: f64 = 0.0, "slope", "α", unit::RADIAN,
            "Inclination of the ground, which falls towards +u; off at 0.", min = -1.5, max = 1.5;
        parameter weight: f64 = Theta::THETA_SLOPE, "theta_slope", "θ_s", unit::NEWTON_METRE,
            "(m1 + m2)*g*R, assumed since Table 2 can't tell it; acts only if slope is not 0.";
    }
}

impl Mechanical for Slope {
    fn check(&self) -> Result<(), ModelError> {
        finite("slope", self.angle)?;
        finite("theta_slope", self.weight)
    }

    fn incline(&self) -> Option<Incline> {
        Incline::new(self.angle, self.weight)
    }
}
