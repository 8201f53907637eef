//! The equation of motion (12), with the velocity terms that its printed form leaves out, and the energy.
//!
//! ```text
//! M(q)·q̈ + c(q, q̇) = u                                                                  (12)
//!
//! M(q) = [ θ₁ + θ₂cos q₁               θ₇cos q₂ + θ₈cos(q₁−q₂) ]
//!        [ θ₇cos q₂ + θ₈cos(q₁−q₂)     θ₅                      ]
//!
//! c₁ = −½θ₂ sin q₁·q̇₁² − θ₇ sin q₂·q̇₂² + θ₈ sin(q₁−q₂)·q̇₂² − θ₉ sin q₁
//! c₂ = −θ₈ sin(q₁−q₂)·q̇₁² − θ₁₀ sin q₂
//! ```
//!
//! *Deviations*: the paper writes c(q, q̇) but prints only its gravity. The rest of c₁ and c₂ follows from
//! T = ½q̇ᵀM(q)q̇ and can be switched off to get eq. (12) as printed.
//!
//! On ground that falls towards +u by α the drum's centre moves along the incline, so that the angle between its
//! path and the horizontal enters wherever the drum's motion meets a link's: cos q₁ → cos(q₁−α) beside θ₂ and
//! cos q₂ → cos(q₂−α) beside θ₇ (likewise the sines of the velocity terms), and its weight adds θ_slope·sin α to
//! the first row.
//!
//! Where the whole rig stands inclined by ι (its ground, its camera, whatever its angles are counted from), q is counted from the
//! normal of what it stands on: with q + ι and α + ι in the place of q and α the same equations hold, so that ι enters the weight
//! alone: sin(q₁+ι) beside θ₉, sin(q₂+ι) beside θ₁₀, θ_slope·sin(α+ι).

use crate::theta::Theta;

/// Ground that is not level, or a rig that does not stand level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Incline {
    /// (sin, cos) of α.
    path: (f64, f64),
    /// (sin, cos) of ι.
    rig: (f64, f64),
    /// θ_slope·sin(α+ι), N·m.
    torque: f64,
}

impl Incline {
    /// Ground that falls towards +u by `alpha` rad, in a rig that as a whole does so by `iota` rad; `theta_slope` = (m₁+m₂)·g·R in
    /// N·m. `None` where all is level, so that nothing is computed there and the bits are those of eq. (12).
    pub fn new(alpha: f64, iota: f64, theta_slope: f64) -> Option<Incline> {
        (alpha != 0.0 || iota != 0.0).then(|| Incline {
            path: libm::sincos(alpha),
            rig: libm::sincos(iota),
            torque: theta_slope * libm::sin(alpha + iota),
        })
    }

    /// Torque on link 1 by the weight of both links rolling down: θ_slope·sin(α+ι).
    pub fn torque(&self) -> f64 {
        self.torque
    }

    /// (sin, cos) of an angle less α.
    fn against_path(&self, (sin, cos): (f64, f64)) -> (f64, f64) {
        (sin * self.path.1 - cos * self.path.0, cos * self.path.1 + sin * self.path.0)
    }

    /// (sin, cos) of an angle and ι.
    fn against_weight(&self, (sin, cos): (f64, f64)) -> (f64, f64) {
        (sin * self.rig.1 + cos * self.rig.0, cos * self.rig.1 - sin * self.rig.0)
    }
}

/// M(q)·q̈ = f, ready to be solved. Effects add to its entries.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Equation {
    /// M₁₁ in kg·m²
    pub m11: f64,
    /// M₁₂ = M₂₁ in kg·m²
    pub m12: f64,
    /// M₂₂ in kg·m²
    pub m22: f64,
    /// All that acts on q₁, in N·m.
    pub f1: f64,
    /// All that acts on q₂, in N·m.
    pub f2: f64,
}

impl Equation {
    /// det M in kg²·m⁴.
    pub fn determinant(&self) -> f64 {
        self.m11 * self.m22 - self.m12 * self.m12
    }

    /// M is positive definite, as that of a body must be.
    pub fn is_regular(&self) -> bool {
        self.m11 > 0.0 && self.determinant() > 0.0
    }

    /// The torque between the links: u = [−1, 1]ᵀτ.
    pub fn add_joint_torque(&mut self, tau: f64) {
        self.f1 -= tau;
        self.f2 += tau;
    }

    /// q̈ = M⁻¹f in rad/s²; NaN where M is not positive definite.
    pub fn accelerations(&self) -> [f64; 2] {
        let Equation { m11, m12, m22, f1, f2 } = *self;
        let inverse = if self.is_regular() { 1.0 / self.determinant() } else { f64::NAN };
        [(m22 * f1 - m12 * f2) * inverse, (m11 * f2 - m12 * f1) * inverse]
    }
}

impl Theta {
    /// Eq. (12) without any torque: f = −c(q, q̇).
    #[inline]
    pub fn equation(
        &self,
        q: [f64; 2],
        [dq1, dq2]: [f64; 2],
        ground: Option<&Incline>,
        velocity_terms: bool,
    ) -> Equation {
        let Theta { theta_2, theta_7, theta_8, theta_9, theta_10, .. } = *self;
        let pose = Pose::new(q, ground);
        let s12 = pose.between.0;
        let (s1_path, s2_path) = (pose.link1_path.0, pose.link2_path.0);

        let mut f1 = theta_9 * pose.link1_weight.0; // (12)
        let mut f2 = theta_10 * pose.link2_weight.0; // (12)
        if velocity_terms {
            let (dq1_dq1, dq2_dq2) = (dq1 * dq1, dq2 * dq2);
            f1 += 0.5 * theta_2 * s1_path * dq1_dq1 + (theta_7 * s2_path - theta_8 * s12) * dq2_dq2;
            f2 += theta_8 * s12 * dq1_dq1;
        }
        if let Some(incline) = ground {
            f1 += incline.torque();
        }
        let [[m11, m12], [_, m22]] = pose.inertia(self);
        Equation { m11, m12, m22, f1, f2 }
    }

    /// Kinetic and potential energy in J; the potential is θ₉ + θ₁₀ at the upright on level ground.
    pub fn energy(&self, q: [f64; 2], dq: [f64; 2], ground: Option<&Incline>) -> f64 {
        let pose = Pose::new(q, ground);
        let [[m11, m12], [_, m22]] = pose.inertia(self);
        let kinetic = 0.5 * m11 * dq[0] * dq[0] + m12 * dq[0] * dq[1] + 0.5 * m22 * dq[1] * dq[1];
        let potential = self.theta_9 * pose.link1_weight.1 + self.theta_10 * pose.link2_weight.1;
        kinetic + potential - ground.map_or(0.0, |incline| incline.torque() * q[0])
    }
}

/// The sines and cosines of a configuration, each as (sin, cos).
struct Pose {
    /// Of q₁ − q₂.
    between: (f64, f64),
    /// Of the links against the vertical: q₁ + ι, q₂ + ι.
    link1_weight: (f64, f64),
    link2_weight: (f64, f64),
    /// Of the links against the drum's path: q₁ − α, q₂ − α.
    link1_path: (f64, f64),
    link2_path: (f64, f64),
}

impl Pose {
    #[inline]
    fn new([q1, q2]: [f64; 2], ground: Option<&Incline>) -> Pose {
        let (link1, link2) = (libm::sincos(q1), libm::sincos(q2));
        let ((s1, c1), (s2, c2)) = (link1, link2);
        let between = (s1 * c2 - c1 * s2, c1 * c2 + s1 * s2);
        let [link1_weight, link2_weight] =
            [link1, link2].map(|link| ground.map_or(link, |incline| incline.against_weight(link)));
        let [link1_path, link2_path] =
            [link1, link2].map(|link| ground.map_or(link, |incline| incline.against_path(link)));
        Pose { between, link1_weight, link2_weight, link1_path, link2_path }
    }

    /// M(q).
    #[inline]
    fn inertia(&self, theta: &Theta) -> [[f64; 2]; 2] {
        let m12 = theta.theta_7 * self.link2_path.1 + theta.theta_8 * self.between.1; // (12)
        [[theta.theta_1 + theta.theta_2 * self.link1_path.1, m12], [m12, theta.theta_5]] // (12)
    }
}
