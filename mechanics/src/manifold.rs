//! The manifold of equilibria (13) and the plant linearised along it.
//!
//! q₁ = −arcsin(θ₁₀/θ₉ · sin q₂), τ_e = −θ₁₀ sin q₂.
//!
//! At an equilibrium the velocity terms are of second order and drop out, and M⁻¹ multiplies a force that is zero,
//! so that with x = (q₁, q₂, q̇₁, q̇₂)
//!
//! ```text
//! A = [ 0  I ]     b = [ 0 ]     K = M⁻¹·diag(θ₉cos q₁, θ₁₀cos q₂),   B = M⁻¹·[−1, 1]ᵀ
//!     [ K  0 ]         [ B ]
//! ```
//!
//! for both forms of (12). n, the last row of the inverse of [b, Ab, A²b, A³b], is (p, 0) with p·B = 0, p·KB = 1.

use crate::{MechanicsError, theta::Theta};

impl Theta {
    /// θ₁₀/θ₉, the only number on which the manifold depends.
    fn manifold_ratio(&self) -> Result<f64, MechanicsError> {
        let ratio = self.theta_10 / self.theta_9;
        if ratio.abs() < 1.0 { Ok(ratio) } else { Err(MechanicsError::NoManifold { ratio }) }
    }

    /// q₁ of the equilibrium at q₂, rad. Fails if θ₁₀/θ₉ is not within (−1, 1).
    pub fn manifold_q1(&self, q2: f64) -> Result<f64, MechanicsError> {
        Ok(-libm::asin(self.manifold_ratio()? * libm::sin(q2))) // (13)
    }

    /// dq₁/dq₂ along the manifold.
    pub fn manifold_slope(&self, q2: f64) -> Result<f64, MechanicsError> {
        let ratio = self.manifold_ratio()?;
        let sine = ratio * libm::sin(q2);
        Ok(-ratio * libm::cos(q2) / (1.0 - sine * sine).sqrt())
    }

    /// The torque that holds the equilibrium at q₂, N·m.
    pub fn manifold_torque(&self, q2: f64) -> f64 {
        -self.theta_10 * libm::sin(q2)
    }

    /// The plant linearised at the equilibrium at q₂.
    pub fn linearisation(&self, q2: f64) -> Result<Linearisation, MechanicsError> {
        let q1 = self.manifold_q1(q2)?;
        let equation = self.equation([q1, q2], [0.0; 2], None, false);
        let determinant = equation.determinant();
        if !equation.is_regular() {
            return Err(MechanicsError::SingularInertia { q1, q2, determinant });
        }
        let (m11, m12, m22) = (equation.m11, equation.m12, equation.m22);
        let inverse = [[m22 / determinant, -m12 / determinant], [-m12 / determinant, m11 / determinant]];
        let gravity = [self.theta_9 * libm::cos(q1), self.theta_10 * libm::cos(q2)];
        Ok(Linearisation {
            q2,
            stiffness: inverse.map(|row| [row[0] * gravity[0], row[1] * gravity[1]]),
            input: inverse.map(|row| row[1] - row[0]),
        })
    }
}

/// The plant linearised at a point of the manifold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Linearisation {
    /// Where, rad.
    pub q2: f64,
    /// K = ∂q̈/∂q, 1/s².
    pub stiffness: [[f64; 2]; 2],
    /// B = ∂q̈/∂τ, 1/(kg·m²).
    pub input: [f64; 2],
}

/// A value this many times smaller than its factors suggest is rounding: the point counts as not controllable.
const CONTROLLABLE: f64 = 1e-10;

impl Linearisation {
    /// A(s), for x = (q₁, q₂, q̇₁, q̇₂).
    pub fn a(&self) -> [[f64; 4]; 4] {
        let [[k11, k12], [k21, k22]] = self.stiffness;
        [[0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0], [k11, k12, 0.0, 0.0], [k21, k22, 0.0, 0.0]]
    }

    /// b(s).
    pub fn b(&self) -> [f64; 4] {
        [0.0, 0.0, self.input[0], self.input[1]]
    }

    /// [b, Ab, A²b, A³b], by rows.
    pub fn controllability(&self) -> [[f64; 4]; 4] {
        let [b1, b2] = self.input;
        let [kb1, kb2] = self.stiffness_times_input();
        [[0.0, b1, 0.0, kb1], [0.0, b2, 0.0, kb2], [b1, 0.0, kb1, 0.0], [b2, 0.0, kb2, 0.0]]
    }

    /// B₂·(KB)₁ − B₁·(KB)₂, whose square is the controllability matrix' determinant. Between two points at which its
    /// signs differ lies one that is not controllable.
    pub fn controllability_determinant(&self) -> f64 {
        let [b1, b2] = self.input;
        let [kb1, kb2] = self.stiffness_times_input();
        b2 * kb1 - b1 * kb2
    }

    /// p, the first half of n(s); the second half is zero. Fails where the plant is not controllable.
    pub fn p(&self) -> Result<[f64; 2], MechanicsError> {
        let [b1, b2] = self.input;
        let [kb1, kb2] = self.stiffness_times_input();
        let determinant = self.controllability_determinant();
        let scale = (b2 * kb1).abs() + (b1 * kb2).abs();
        if determinant.abs() > CONTROLLABLE * scale {
            Ok([b2 / determinant, -b1 / determinant])
        } else {
            Err(MechanicsError::Uncontrollable { q2: self.q2 })
        }
    }

    /// n(s), the last row of the inverse of the controllability matrix.
    pub fn n(&self) -> Result<[f64; 4], MechanicsError> {
        self.p().map(|[p1, p2]| [p1, p2, 0.0, 0.0])
    }

    /// A row vector times K.
    pub fn times_stiffness(&self, row: [f64; 2]) -> [f64; 2] {
        let k = &self.stiffness;
        [row[0] * k[0][0] + row[1] * k[1][0], row[0] * k[0][1] + row[1] * k[1][1]]
    }

    fn stiffness_times_input(&self) -> [f64; 2] {
        self.stiffness.map(|row| row[0] * self.input[0] + row[1] * self.input[1])
    }
}
