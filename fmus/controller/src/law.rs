//! Pseudolinearizing feedback: the closed loop's linearisation is the same at every point of the manifold.
//!
//! With s the point of the manifold at the present q₂ and x = (q₁, q₂, q̇₁, q̇₂)
//!
//! ```text
//! y₁   = z(s) + c·n(s)·(x − x_e(s))
//! yᵢ₊₁ = c·n(s)·A(s)ⁱ·(x − x_e(s)),  i = 1, 2, 3
//! v    = −a₀(y₁ − z_desired) − a₁y₂ − a₂y₃ − a₃y₄
//! τ    = τ_e(s) + v/c − n(s)·A(s)⁴·(x − x_e(s))
//! ```
//!
//! Near any equilibrium ẏ₁ = y₂, ẏ₂ = y₃, ẏ₃ = y₄, ẏ₄ = v to first order, because dz/ds = c·n·x_e′ and
//! A·x_e′ + b·τ_e′ = 0. So the poles are the roots of s⁴ + a₃s³ + a₂s² + a₁s + a₀ wherever the acrobot stands.
//!
//! *Deviations*: the paper's own law is that of its reference \[27\], which is not available. This one has the
//! property that Section 3.1 names, uses B-splines as it does, and takes z as its coordinate.

use crate::schedule::{Schedule, Scheduled};

/// Coefficients of the closed loop's polynomial s⁴ + a₃s³ + a₂s² + a₁s + a₀.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polynomial {
    /// a₀ in 1/s⁴, a₁ in 1/s³, a₂ in 1/s², a₃ in 1/s
    pub a: [f64; 4],
}

impl Polynomial {
    /// (s² + 2ζ₁ω₁s + ω₁²)(s² + 2ζ₂ω₂s + ω₂²).
    pub fn from_pole_pairs([omega_1, zeta_1]: [f64; 2], [omega_2, zeta_2]: [f64; 2]) -> Polynomial {
        let (damping_1, damping_2) = (2.0 * zeta_1 * omega_1, 2.0 * zeta_2 * omega_2);
        let (square_1, square_2) = (omega_1 * omega_1, omega_2 * omega_2);
        Polynomial {
            a: [
                square_1 * square_2,
                damping_1 * square_2 + damping_2 * square_1,
                square_1 + square_2 + damping_1 * damping_2,
                damping_1 + damping_2,
            ],
        }
    }
}

/// The torque and where the law sees the acrobot on the manifold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// τ in N·m.
    pub torque: f64,
    /// y₁.
    pub place: f64,
}

/// What the law's answer depends on, in the order of [`slopes`].
pub const INPUTS: [&str; 5] = ["q1", "q2", "dq1", "dq2", "z_desired"];

/// The derivatives of torque and place by [`INPUTS`], exactly those of what [`torque`] computes; at the ends of the table,
/// where the schedule stays, that of the side beyond.
pub fn slopes(
    schedule: &Schedule,
    polynomial: &Polynomial,
    [q1, q2]: [f64; 2],
    dq: [f64; 2],
) -> [[f64; 5]; 2] {
    let (at, slope) = (schedule.at(q2), schedule.slope(q2));
    let off = [q1 - at.q1, q2 - at.q2];
    let along = |row: [f64; 2], vector: [f64; 2]| row[0] * vector[0] + row[1] * vector[1];
    let [a0, a1, a2, a3] = polynomial.a;
    let scale = schedule.scale();
    // How the deviation changes with q₂.
    let moves = [-slope.q1, 1.0 - slope.q2];
    let place = slope.z + along(slope.cp, off) + along(at.cp, moves);
    let v = -a0 * place
        - a1 * along(slope.cp, dq)
        - a2 * (along(slope.cpk, off) + along(at.cpk, moves))
        - a3 * along(slope.cpk, dq);
    let by_q1 = (-a0 * at.cp[0] - a2 * at.cpk[0]) / scale - at.pkk[0];
    let by_q2 = slope.torque + v / scale - along(slope.pkk, off) - along(at.pkk, moves);
    let by_rate = |link: usize| (-a1 * at.cp[link] - a3 * at.cpk[link]) / scale;
    [[by_q1, by_q2, by_rate(0), by_rate(1), a0 / scale], [at.cp[0], place, 0.0, 0.0, 0.0]]
}

/// The law, for angles in rad and rates in rad/s.
pub fn torque(
    schedule: &Schedule,
    polynomial: &Polynomial,
    [q1, q2]: [f64; 2],
    dq: [f64; 2],
    z_desired: f64,
) -> Answer {
    let at: Scheduled = schedule.at(q2);
    let off = [q1 - at.q1, q2 - at.q2];
    let along = |row: [f64; 2], vector: [f64; 2]| row[0] * vector[0] + row[1] * vector[1];
    let y1 = at.z + along(at.cp, off);
    let y2 = along(at.cp, dq);
    let y3 = along(at.cpk, off);
    let y4 = along(at.cpk, dq);
    let [a0, a1, a2, a3] = polynomial.a;
    let v = -a0 * (y1 - z_desired) - a1 * y2 - a2 * y3 - a3 * y4;
    Answer { torque: at.torque + v / schedule.scale() - along(at.pkk, off), place: y1 }
}
