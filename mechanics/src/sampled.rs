//! The loop as a computer closes it: the plant linearised at a point of the manifold, measured once a period, its
//! torque held, and a delay between the two.
//!
//! Measurements are of the instants m_k = k·T (with a shutter, the middle of an exposure), the torque u_k that belongs
//! to m_k acts from m_k + D until m_{k+1} + D. With D = (n + f)·T, 0 ≤ f < 1,
//!
//! ```text
//! x_{k+1} = Φ(T)·x_k + Φ(T−fT)·Γ(fT)·u_{k−n−1} + Γ(T−fT)·u_{k−n},   Φ(h) = e^{Ah},  Γ(h) = ∫₀ʰ e^{As}ds·b
//! u_k     = −g_q·q_k − g_r·r_k,     r_k = q̇_k  or  (q_k − q_{k−1})/T
//! ```
//!
//! and the loop is stable where the spectral radius of the matrix that takes (x_k, q_{k−1}, u_{k−1}, …, u_{k−n−1}) to
//! its successor is below 1. The gains are those of the pseudolinearizing law, whose linearisation at an equilibrium
//! is u = −p·(a₀ + a₂K + K²)·q − p·(a₁ + a₃K)·q̇ with p and K of [`Linearisation`].
//!
//! Source: K. J. Åström, B. Wittenmark, "Computer-Controlled Systems", sampling of systems with time delay.

use crate::{Linearisation, MechanicsError};

/// How the controller learns the rates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rates {
    /// They are measured.
    True,
    /// First-order differences of the angles (Section 3.1).
    FirstDifference,
}

/// When and how the loop is closed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampling {
    /// Time between measurements, s.
    pub period: f64,
    /// From the instant that a measurement is of to its torque, s, at least 0: T_delay + E_t/(2·ω_cam) with a camera.
    pub delay: f64,
    /// How the rates are had.
    pub rates: Rates,
}

impl Linearisation {
    /// (g_q, g_r) of the law u = −g_q·q − g_r·q̇ that gives the closed loop s⁴ + a₃s³ + a₂s² + a₁s + a₀, in N·m/rad
    /// and N·m·s/rad. Fails where the plant is not controllable.
    pub fn gains(&self, [a0, a1, a2, a3]: [f64; 4]) -> Result<[[f64; 2]; 2], MechanicsError> {
        let p = self.p()?;
        let pk = self.times_stiffness(p);
        let pkk = self.times_stiffness(pk);
        let angles = [0, 1].map(|i| a0 * p[i] + a2 * pk[i] + pkk[i]);
        let rates = [0, 1].map(|i| a1 * p[i] + a3 * pk[i]);
        Ok([angles, rates])
    }

    /// Spectral radius of the sampled closed loop for the polynomial `a`: below 1 it is stable. Fails where the plant
    /// is not controllable.
    pub fn spectral_radius(&self, a: [f64; 4], sampling: &Sampling) -> Result<f64, MechanicsError> {
        Ok(spectral_radius(self.sampled_loop(a, sampling)?))
    }

    /// The matrix that takes the sampled loop from one measurement to the next.
    fn sampled_loop(&self, a: [f64; 4], sampling: &Sampling) -> Result<Square, MechanicsError> {
        let [angles, rates] = self.gains(a)?;
        let Sampling { period, delay, .. } = *sampling;
        let periods = (delay / period).max(0.0);
        let whole = libm::floor(periods) as usize;
        let late = (periods - whole as f64) * period;
        let (transition, _) = self.held(period);
        let (transition_rest, input_rest) = self.held(period - late);
        let (_, input_late) = self.held(late);

        // Order of the state: x (0..4), q of the measurement before (4, 5), torques from the newest (6) to the oldest.
        let size = 6 + whole + 1;
        let mut law = vec![0.0; size]; // u_k as a row
        for i in 0..2 {
            match sampling.rates {
                Rates::True => {
                    law[i] = -angles[i];
                    law[2 + i] = -rates[i];
                }
                Rates::FirstDifference => {
                    law[i] = -angles[i] - rates[i] / period;
                    law[4 + i] = rates[i] / period;
                }
            }
        }
        let mut next = Square::zero(size);
        for i in 0..4 {
            for j in 0..4 {
                *next.at(i, j) += transition[i][j];
                *next.at(i, size - 1) += transition_rest[i][j] * input_late[j];
            }
            if whole == 0 {
                for (j, gain) in law.iter().enumerate() {
                    *next.at(i, j) += input_rest[i] * gain;
                }
            } else {
                *next.at(i, 5 + whole) += input_rest[i];
            }
        }
        *next.at(4, 0) = 1.0;
        *next.at(5, 1) = 1.0;
        for (j, gain) in law.iter().enumerate() {
            *next.at(6, j) = *gain;
        }
        for torque in 7..size {
            *next.at(torque, torque - 1) = 1.0;
        }
        Ok(next)
    }

    /// Φ(h), Γ(h).
    fn held(&self, time: f64) -> ([[f64; 4]; 4], [f64; 4]) {
        let (a, b) = (self.a(), self.b());
        let mut generator = Square::zero(5);
        for (i, (row, input)) in a.iter().zip(b).enumerate() {
            for (j, entry) in row.iter().enumerate() {
                *generator.at(i, j) = entry * time;
            }
            *generator.at(i, 4) = input * time;
        }
        let result = exponential(generator);
        let entry = |i: usize, j: usize| result.entries[i * 5 + j];
        let transition = [0, 1, 2, 3].map(|i| [0, 1, 2, 3].map(|j| entry(i, j)));
        (transition, [0, 1, 2, 3].map(|i| entry(i, 4)))
    }
}

/// A square matrix, row by row.
#[derive(Debug, Clone, PartialEq)]
struct Square {
    size: usize,
    entries: Vec<f64>,
}

impl Square {
    fn zero(size: usize) -> Square {
        Square { size, entries: vec![0.0; size * size] }
    }

    fn at(&mut self, row: usize, column: usize) -> &mut f64 {
        &mut self.entries[row * self.size + column]
    }

    fn times(&self, other: &Square) -> Square {
        let size = self.size;
        let mut product = Square::zero(size);
        for i in 0..size {
            for k in 0..size {
                let factor = self.entries[i * size + k];
                for j in 0..size {
                    product.entries[i * size + j] += factor * other.entries[k * size + j];
                }
            }
        }
        product
    }

    fn scaled(mut self, factor: f64) -> Square {
        self.entries.iter_mut().for_each(|entry| *entry *= factor);
        self
    }

    /// Frobenius norm.
    fn norm(&self) -> f64 {
        self.entries.iter().map(|entry| entry * entry).sum::<f64>().sqrt()
    }
}

/// e^M by its series, after halving M until its norm is below 1/2: 16 terms leave less than 1e-18.
fn exponential(matrix: Square) -> Square {
    let mut halvings = 0;
    let mut norm = matrix.norm();
    while norm > 0.5 {
        norm *= 0.5;
        halvings += 1;
    }
    let size = matrix.size;
    let matrix = matrix.scaled(libm::ldexp(1.0, -halvings));
    let mut identity = Square::zero(size);
    for i in 0..size {
        *identity.at(i, i) = 1.0;
    }
    let mut sum = identity.clone();
    for term in (1..=16).rev() {
        // Horner's rule: 1 + M/1·(1 + M/2·(1 + …))
        sum = matrix.times(&sum).scaled(1.0 / f64::from(term));
        for i in 0..size {
            *sum.at(i, i) += 1.0;
        }
    }
    for _ in 0..halvings {
        sum = sum.times(&sum);
    }
    sum
}

/// The largest modulus of an eigenvalue: Gelfand's formula, ρ = lim ‖Mᵏ‖^{1/k}, with k doubled by squaring. At k = 2³²
/// the norm's constant factor has shrunk to less than 1e-8.
fn spectral_radius(mut matrix: Square) -> f64 {
    let mut log_radius = 0.0;
    let mut weight = 1.0;
    for _ in 0..32 {
        let norm = matrix.norm();
        if norm == 0.0 {
            return 0.0;
        }
        log_radius += weight * libm::log(norm);
        matrix = matrix.scaled(1.0 / norm);
        matrix = matrix.times(&matrix);
        weight *= 0.5;
    }
    libm::exp(log_radius)
}

#[cfg(test)]
mod tests {
    use super::{Rates, Sampling, Square, exponential, spectral_radius};
    use crate::Theta;

    fn square(rows: &[&[f64]]) -> Square {
        Square { size: rows.len(), entries: rows.concat() }
    }

    #[test]
    fn value_exponential_of_a_rotation_and_of_a_nilpotent_matrix() {
        let turned = exponential(square(&[&[0.0, 3.0], &[-3.0, 0.0]]));
        for (entry, expected) in turned.entries.iter().zip([3f64.cos(), 3f64.sin(), -3f64.sin(), 3f64.cos()])
        {
            assert!((entry - expected).abs() < 1e-14, "{entry} {expected}"); // some squarings' rounding
        }
        let sheared = exponential(square(&[&[0.0, 5.0], &[0.0, 0.0]]));
        assert!((sheared.entries[1] - 5.0).abs() < 1e-13);
    }

    #[test]
    fn value_spectral_radius_of_known_matrices() {
        // Eigenvalues ±i·sqrt(6): a plain power iteration would not converge.
        let radius = spectral_radius(square(&[&[0.0, 2.0], &[-3.0, 0.0]]));
        assert!((radius - 6f64.sqrt()).abs() < 1e-7); // the constant factor of Gelfand's formula at k = 2^32
        assert_eq!(spectral_radius(square(&[&[0.0, 1.0], &[0.0, 0.0]])), 0.0);
        let defective = spectral_radius(square(&[&[0.9, 1.0], &[0.0, 0.9]]));
        assert!((defective - 0.9).abs() < 1e-6); // log(k)/k for a double eigenvalue
    }

    #[test]
    fn law_fast_sampling_with_true_rates_gives_the_poles_asked_for() {
        // Poles −1, −2, −3, −4: the slowest gives ρ = e^{−T} everywhere on the manifold.
        let a = [24.0, 50.0, 35.0, 10.0];
        let sampling = Sampling { period: 1e-4, delay: 0.0, rates: Rates::True };
        for q2 in [0.0, 0.7, 1.7559, 2.3] {
            let at = Theta::TABLE_2.linearisation(q2).expect("Table 2 has a manifold");
            let radius = at.spectral_radius(a, &sampling).expect("controllable");
            // Holding the torque is half a period of delay, which moves the pole by less than 1 % of 1/s here.
            assert!((radius.ln() / 1e-4 + 1.0).abs() < 0.01, "{q2}: {radius}");
        }
    }

    #[test]
    fn law_a_delay_is_continuous_at_whole_periods() {
        let a = [462.6, 509.5, 236.3, 14.07];
        let at = Theta::TABLE_2.linearisation(0.5).expect("Table 2 has a manifold");
        for periods in [1.0, 2.0] {
            let radius = |periods: f64| {
                let sampling =
                    Sampling { period: 1.0 / 30.0, delay: periods / 30.0, rates: Rates::FirstDifference };
                at.spectral_radius(a, &sampling).expect("controllable")
            };
            // Slope of ρ over the delay is of the order 1 a period.
            assert!((radius(periods - 1e-9) - radius(periods + 1e-9)).abs() < 1e-6);
        }
    }
}
