//! Where the three inscribed circles are in the world, from the pose of the robot (Figure 10, Section 4).
//!
//! World: x to the right, y up, the origin in the middle of the field of view. The drum of radius R rolls on the
//! ground line; circle 1 sits at its centre, 2 at the joint, 3 at the tip. Angles are absolute from the upright,
//! positive towards +x. *Deviations*: the paper does not say where circle 1 sits or how high the ground is; its
//! Table 3 comes out for this choice only (`ground` = −8).

use crate::variables::Scene;

/// Angles of the links in rad.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Pose {
    /// q₁
    pub link1_angle: f64,
    /// q₂
    pub link2_angle: f64,
}

impl Scene {
    /// Centres of circles 1, 2, 3 in world units.
    pub fn centres_world(&self, pose: Pose) -> [(f64, f64); 3] {
        let (q1, q2) = (pose.link1_angle, pose.link2_angle);
        let drum = (self.drum_radius * q1, self.ground_height + self.drum_radius);
        let joint = (drum.0 + self.link1_length * libm::sin(q1), drum.1 + self.link1_length * libm::cos(q1));
        let tip = (joint.0 + self.link2_length * libm::sin(q2), joint.1 + self.link2_length * libm::cos(q2));
        [drum, joint, tip]
    }
}
