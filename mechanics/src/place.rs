//! z, the place on the manifold.
//!
//! dz/ds = c·n(s)·x_e′(s), z = 0 at the upright, positive with q₂, and c such that z = 0.5 at 75 % of the arc
//! length in (q₁, q₂) from q₂ = 0 to q₂ = 2.35. Along the manifold s may be q₂ itself.
//!
//! n·x_e′ has a closed form. K·q_e′ = −B·τ_e′ along the manifold, p·B = 0 and p·KB = 1, so that by Cayley and
//! Hamilton p·q_e′ = τ_e′/det K = −det M/(θ₉cos q₁). It never changes sign: z grows with q₂ wherever M is regular,
//! even past a point at which the plant is not controllable.
//!
//! *Deviations*: the paper takes z from its reference \[27\], which is not available, and says only that z = 0.5
//! lies at about 75 % of an arm. The normalisation is that of a pseudolinearizing coordinate.

use crate::{MechanicsError, theta::Theta};

/// Angle of link 2 at which the links touch, rad: the end of an arm of the manifold (Section 3.1).
pub const ARM_END: f64 = 2.35;
/// Share of an arm's length at which z = [`Z_OF_SHARE`].
pub const ARC_SHARE: f64 = 0.75;
/// z at [`ARC_SHARE`] of the arm.
pub const Z_OF_SHARE: f64 = 0.5;

/// Intervals from the upright to the end of the arm.
const ARM_INTERVALS: usize = 448;
/// Intervals beyond it, so that places a little past contact still have a z: up to q₂ = 2.60 rad.
const SPARE_INTERVALS: usize = 48;
const INTERVAL: f64 = ARM_END / ARM_INTERVALS as f64;

/// z as a function of q₂, odd, with its inverse.
///
/// Kept as a table of values and exact slopes with cubic Hermite interpolation between; within 1e-11 of the
/// integral. Beyond the table's ends (±2.60 rad, or less where z ends earlier) z stays at its last value: no
/// equilibrium lies there that the acrobot can reach, and a finite, monotone answer is the useful one.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    scale: f64,
    /// z and dz/dq₂ at multiples of `INTERVAL`.
    nodes: Vec<[f64; 2]>,
}

/// Integrals from the upright to a node: of n·x_e′ and of the arc length, with n·x_e′ there.
#[derive(Clone, Copy)]
struct Sum {
    place: f64,
    arc: f64,
    rate: f64,
}

impl Place {
    /// Integrates z along the manifold of `theta`. Fails if there is none, or M is singular somewhere on it.
    pub fn new(theta: &Theta) -> Result<Place, MechanicsError> {
        let mut sums = Vec::with_capacity(ARM_INTERVALS + SPARE_INTERVALS + 1);
        sums.push(Sum { place: 0.0, arc: 0.0, rate: rate(theta, 0.0)? });
        for interval in 0..ARM_INTERVALS + SPARE_INTERVALS {
            let from = interval as f64 * INTERVAL;
            let to = (interval + 1) as f64 * INTERVAL;
            let next = integrals(theta, from, to).and_then(|(place, arc)| Ok((place, arc, rate(theta, to)?)));
            match next {
                Ok((place, arc, rate)) => {
                    let last = sums[interval];
                    sums.push(Sum { place: last.place + place, arc: last.arc + arc, rate });
                }
                Err(error) if interval < ARM_INTERVALS => return Err(error),
                Err(_) => break, // past the arm a shorter table will do
            }
        }
        let scale = scale(theta, &sums)?;
        let nodes = sums.iter().map(|sum| [scale * sum.place, scale * sum.rate]).collect();
        Ok(Place { scale, nodes })
    }

    /// c.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// The largest abs(q₂) of the table, rad.
    pub fn end(&self) -> f64 {
        (self.nodes.len() - 1) as f64 * INTERVAL
    }

    /// z at q₂.
    pub fn z(&self, q2: f64) -> f64 {
        let ([from, to], fraction) = self.interval(q2.abs());
        let (t, u) = (fraction, 1.0 - fraction);
        // The difference of the ends rather than their weighted sum: exact at both nodes.
        let z = from[0]
            + (to[0] - from[0]) * t * t * (3.0 - 2.0 * t)
            + INTERVAL * t * u * (u * from[1] - t * to[1]);
        if q2 < 0.0 { -z } else { z }
    }

    /// dz/dq₂; 0 beyond the table's ends.
    pub fn slope(&self, q2: f64) -> f64 {
        if q2.abs() > self.end() {
            return 0.0;
        }
        let ([from, to], fraction) = self.interval(q2.abs());
        let (t, u) = (fraction, 1.0 - fraction);
        6.0 * t * u * (to[0] - from[0]) / INTERVAL + u * (u - 2.0 * t) * from[1] + t * (t - 2.0 * u) * to[1]
    }

    /// q₂ at a place, rad; the table's end for a place beyond it.
    pub fn q2(&self, z: f64) -> f64 {
        if z == 0.0 {
            return 0.0; // halving would end at a tiny positive number
        }
        let (mut low, mut high) = (0.0, self.end());
        let goal = z.abs();
        // z grows monotonically: halving until neighbouring numbers needs at most the bits of a double.
        for _ in 0..64 {
            let middle = 0.5 * (low + high);
            if self.z(middle) < goal { low = middle } else { high = middle }
        }
        if z < 0.0 { -high } else { high }
    }

    fn interval(&self, magnitude: f64) -> ([[f64; 2]; 2], f64) {
        let place = magnitude / INTERVAL;
        let last = self.nodes.len() - 2;
        let index = (place as usize).min(last);
        ([self.nodes[index], self.nodes[index + 1]], (place - index as f64).min(1.0))
    }
}

/// n(s)·x_e′(s) with s = q₂.
fn rate(theta: &Theta, q2: f64) -> Result<f64, MechanicsError> {
    let q1 = theta.manifold_q1(q2)?;
    let equation = theta.equation([q1, q2], [0.0; 2], None, false);
    let determinant = equation.determinant();
    if !equation.is_regular() {
        return Err(MechanicsError::SingularInertia { q1, q2, determinant });
    }
    Ok(-determinant / (theta.theta_9 * libm::cos(q1)))
}

/// Three-point Gauss quadrature of n·x_e′ and of the arc length; its error over one interval is below 1e-16.
fn integrals(theta: &Theta, from: f64, to: f64) -> Result<(f64, f64), MechanicsError> {
    const ABSCISSA: f64 = 0.774_596_669_241_483_4; // sqrt(3/5)
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let (mut place, mut arc) = (0.0, 0.0);
    for (abscissa, weight) in [(-ABSCISSA, 5.0 / 9.0), (0.0, 8.0 / 9.0), (ABSCISSA, 5.0 / 9.0)] {
        let q2 = middle + half * abscissa;
        let slope = theta.manifold_slope(q2)?;
        place += weight * rate(theta, q2)?;
        arc += weight * (1.0 + slope * slope).sqrt();
    }
    Ok((half * place, half * arc))
}

/// c: z is [`Z_OF_SHARE`] at [`ARC_SHARE`] of the arm's length.
fn scale(theta: &Theta, sums: &[Sum]) -> Result<f64, MechanicsError> {
    let goal = ARC_SHARE * sums[ARM_INTERVALS].arc;
    let interval = sums[..ARM_INTERVALS].partition_point(|sum| sum.arc <= goal) - 1;
    let from = interval as f64 * INTERVAL;
    let mut q2 = from;
    // Newton's method: the arc is nearly straight within an interval, so that five steps more than suffice.
    for _ in 0..5 {
        let slope = theta.manifold_slope(q2)?;
        let arc = sums[interval].arc + integrals(theta, from, q2)?.1;
        q2 += (goal - arc) / (1.0 + slope * slope).sqrt();
    }
    Ok(Z_OF_SHARE / (sums[interval].place + integrals(theta, from, q2)?.0))
}
