//! What the law needs along the manifold, as B-splines over q₂, built from theta.
//!
//! n(s) = (p, 0), so the rows of the pseudolinearizing coordinates are n = (p, 0), nA = (0, p), nA² = (pK, 0),
//! nA³ = (0, pK), nA⁴ = (pK², 0), with K from the linearised plant.
//!
//! With 248 knots over 0..2.6 rad every function is within 1e-11 of what it interpolates, relative to its largest
//! value, and its slope within 1e-8 (tested for Table 2, for R = 0 and for other theta).

use crate::spline::Spline;
use mechanics::{MechanicsError, Place, Theta, place::ARM_END};

/// Intervals from the upright to the end of the table; half of those of [`Place`], so that its nodes are met.
const INTERVALS: usize = 248;
/// Intervals on the other side of the upright, so that no spline ends where the acrobot balances.
const MARGIN: usize = 8;

/// Everything at one point of the manifold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scheduled {
    /// q₂ of the equilibrium, rad: that of the state, or the table's end if it lies beyond.
    pub q2: f64,
    /// q₁ of the equilibrium, rad.
    pub q1: f64,
    /// Torque of the equilibrium, N·m.
    pub torque: f64,
    /// Place on the manifold.
    pub z: f64,
    /// c·p
    pub cp: [f64; 2],
    /// c·pK
    pub cpk: [f64; 2],
    /// pK²
    pub pkk: [f64; 2],
}

/// The table.
#[derive(Debug, Clone, PartialEq)]
pub struct Schedule {
    theta: Theta,
    scale: f64,
    end: f64,
    splines: Spline<8>,
}

impl Schedule {
    /// Builds the table. Fails, naming the place, where theta has no manifold or no controllable one.
    pub fn new(theta: &Theta) -> Result<Schedule, MechanicsError> {
        let place = Place::new(theta)?;
        let spacing = place.end() / INTERVALS as f64;
        let upright = theta.linearisation(0.0)?.controllability_determinant();
        let mut values = Vec::with_capacity(MARGIN + INTERVALS + 1);
        for knot in (1..=MARGIN).rev() {
            values.push(row(theta, &place, upright, -(knot as f64) * spacing)?);
        }
        for knot in 0..=INTERVALS {
            let q2 = knot as f64 * spacing;
            match row(theta, &place, upright, q2) {
                Ok(row) => values.push(row),
                Err(error) if q2 <= ARM_END => return Err(error),
                Err(_) => break, // past the arm a shorter table will do
            }
        }
        let end = (values.len() - 1 - MARGIN) as f64 * spacing;
        let splines = Spline::through(-(MARGIN as f64) * spacing, spacing, &values)
            .expect("MARGIN alone is as many intervals as a spline needs"); // so it can't fail
        Ok(Schedule { theta: *theta, scale: place.scale(), end, splines })
    }

    /// The parameters that it was built from.
    pub fn theta(&self) -> &Theta {
        &self.theta
    }

    /// c.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// The largest abs(q₂) of the table, rad.
    pub fn end(&self) -> f64 {
        self.end
    }

    /// Looks up q₂, or the nearer end of the table if it lies beyond. Mirror images give mirror images, to the bit.
    pub fn at(&self, q2: f64) -> Scheduled {
        let magnitude = q2.abs().min(self.end);
        let [q1, z, cp1, cp2, cpk1, cpk2, pkk1, pkk2] = self.splines.at(magnitude);
        let side = if q2 < 0.0 { -1.0 } else { 1.0 };
        let q2 = side * magnitude;
        Scheduled {
            q2,
            q1: side * q1,
            torque: self.theta.manifold_torque(q2),
            z: side * z,
            cp: [cp1, cp2],
            cpk: [cpk1, cpk2],
            pkk: [pkk1, pkk2],
        }
    }
}

impl Schedule {
    /// The derivatives by q₂ of what [`Schedule::at`] looks up.
    pub fn slope(&self, q2: f64) -> Scheduled {
        if q2.abs() >= self.end {
            let nothing = [0.0; 2];
            return Scheduled {
                q2: 0.0,
                q1: 0.0,
                torque: 0.0,
                z: 0.0,
                cp: nothing,
                cpk: nothing,
                pkk: nothing,
            };
        }
        let [q1, z, cp1, cp2, cpk1, cpk2, pkk1, pkk2] = self.splines.slope(q2.abs());
        // Even functions have odd derivatives.
        let side = if q2 < 0.0 { -1.0 } else { 1.0 };
        Scheduled {
            q2: 1.0,
            q1,
            // Of −θ₁₀ sin q₂, the torque that holds the equilibrium.
            torque: -self.theta.theta_10 * libm::cos(q2),
            z,
            cp: [side * cp1, side * cp2],
            cpk: [side * cpk1, side * cpk2],
            pkk: [side * pkk1, side * pkk2],
        }
    }
}

/// The functions at one knot; `upright` is the controllability determinant there.
fn row(theta: &Theta, place: &Place, upright: f64, q2: f64) -> Result<[f64; 8], MechanicsError> {
    let linearisation = theta.linearisation(q2)?;
    if linearisation.controllability_determinant() * upright <= 0.0 {
        return Err(MechanicsError::Uncontrollable { q2 });
    }
    let p = linearisation.p()?;
    let pk = linearisation.times_stiffness(p);
    let pkk = linearisation.times_stiffness(pk);
    let c = place.scale();
    let q1 = theta.manifold_q1(q2)?;
    Ok([q1, place.z(q2), c * p[0], c * p[1], c * pk[0], c * pk[1], pkk[0], pkk[1]])
}
