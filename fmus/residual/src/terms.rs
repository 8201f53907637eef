//! The dictionary: functions of one angle x and its rate v, of which a correction is a linear sum.
//!
//! ```text
//! τ = c₀ + c₁x + c₂x² + c₃x³ + c₄v + c₅v|v| + c₆ tanh(v/v₀) + c₇ tanh(v/v₀) exp(−(v/v_s)²)
//! ```
//!
//! Two axes have one each: the ground and link 1 (x = q₁), and the joint (x = q₂ − q₁), where it acts on both links.
//! Chosen so that what joints are known to do is spanned with few terms: an offset; a spring that stiffens (c₁, c₃) or
//! pulls more to one side (c₂), as cables do; friction that is viscous, dry and drag, with Stribeck's fall at small
//! rates (Armstrong-Hélouvry, Dupont and Canudas de Wit, Automatica 30 (1994) 1083). Not in it: what has a memory
//! (backlash, hysteresis), what follows time (gusts, warming up), and gravity and inertia, which the plant's own
//! parameters give.
//!
//! *Deviations*: beyond what the data covered (reach of x, largest v) each term keeps the value it has there: a
//! polynomial that was fitted inside says nothing outside.

/// Number of terms of an axis.
pub const TERMS: usize = 8;

/// The terms of one axis with their coefficients.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// In the order of the equation, N·m per the term's own unit.
    pub coefficients: [f64; TERMS],
    /// Angle from which x is measured, rad.
    pub centre: f64,
    /// Largest |x|, rad; 0: none.
    pub reach: f64,
    /// Largest |v|, rad/s; 0: none.
    pub speed: f64,
    /// v_s, rad/s.
    pub slow: f64,
}

impl Axis {
    /// The sum, N·m; nothing where all coefficients are 0.
    pub fn torque(&self, angle: f64, rate: f64, smooth: f64) -> Option<f64> {
        if self.coefficients.iter().all(|coefficient| *coefficient == 0.0) {
            return None;
        }
        let x = within(angle - self.centre, self.reach);
        let v = within(rate, self.speed);
        let sign = libm::tanh(v / smooth);
        let fall = libm::exp(-(v / self.slow) * (v / self.slow));
        let terms = [1.0, x, x * x, x * x * x, v, v * v.abs(), sign, sign * fall];
        let used = self.coefficients.iter().zip(terms).filter(|(coefficient, _)| **coefficient != 0.0);
        Some(used.map(|(coefficient, term)| coefficient * term).sum())
    }
}

impl Axis {
    /// Its derivatives by angle and rate, N·m/rad and N·m·s/rad; at a corner that of the inner side.
    pub fn slopes(&self, angle: f64, rate: f64, smooth: f64) -> [f64; 2] {
        let (inside_x, inside_v) = (is_within(angle - self.centre, self.reach), is_within(rate, self.speed));
        let x = within(angle - self.centre, self.reach);
        let v = within(rate, self.speed);
        let sign = libm::tanh(v / smooth);
        let fall = libm::exp(-(v / self.slow) * (v / self.slow));
        let by_x = [0.0, 1.0, 2.0 * x, 3.0 * x * x, 0.0, 0.0, 0.0, 0.0];
        let steep = (1.0 - sign * sign) / smooth;
        let falls = (steep - sign * 2.0 * v / (self.slow * self.slow)) * fall;
        let by_v = [0.0, 0.0, 0.0, 0.0, 1.0, 2.0 * v.abs(), steep, falls];
        let sum = |slopes: [f64; TERMS], inside: bool| match inside {
            true => self
                .coefficients
                .iter()
                .zip(slopes)
                .map(|(coefficient, slope)| coefficient * slope)
                .sum::<f64>(),
            false => 0.0,
        };
        [sum(by_x, inside_x), sum(by_v, inside_v)]
    }
}

fn is_within(value: f64, limit: f64) -> bool {
    limit <= 0.0 || value.abs() <= limit
}

fn within(value: f64, limit: f64) -> f64 {
    if limit > 0.0 { value.clamp(-limit, limit) } else { value }
}
