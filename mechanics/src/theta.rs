//! The dynamic parameters: Table 2 as a constant, Table 1 as their definition.

/// The dynamic parameters of eq. (12). The gaps in the numbering are the paper's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Theta {
    /// θ₁ in kg·m²: m₁R² + m₂l₁² + m₂R² + J₁
    pub theta_1: f64,
    /// θ₂ in kg·m²: 2m₁R l_c1 + 2m₂R l₁; 0 for a pinned pendulum
    pub theta_2: f64,
    /// θ₅ in kg·m²: J₂
    pub theta_5: f64,
    /// θ₇ in kg·m²: m₂R l_c2; 0 for a pinned pendulum
    pub theta_7: f64,
    /// θ₈ in kg·m²: m₂l₁l_c2
    pub theta_8: f64,
    /// θ₉ in N·m (printed as "Nt"): m₁g l_c1 + m₂g l₁
    pub theta_9: f64,
    /// θ₁₀ in N·m (printed as "Nt"): m₂g l_c2
    pub theta_10: f64,
}

/// What Table 1 defines theta from.
///
/// *Deviations*: Table 1 leaves open about which points J₁ and J₂ are taken. The Lagrangian of the rolling double
/// pendulum agrees with it if J₁ is about the drum's centre and J₂ about the joint; so it is here.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Links {
    /// Mass of link 1, kg.
    pub m1: f64,
    /// Mass of link 2, kg.
    pub m2: f64,
    /// Drum's centre to the joint, m.
    pub l1: f64,
    /// Drum's centre to the centre of mass of link 1, m.
    pub lc1: f64,
    /// Joint to the centre of mass of link 2, m.
    pub lc2: f64,
    /// Moment of inertia of link 1 about the drum's centre, kg·m².
    pub j1: f64,
    /// Moment of inertia of link 2 about the joint, kg·m².
    pub j2: f64,
    /// Radius of the drum, m; 0 for a pinned pendulum.
    pub radius: f64,
    /// Acceleration of gravity, m/s².
    pub gravity: f64,
}

impl Links {
    /// Table 1.
    pub fn theta(&self) -> Theta {
        let Links { m1, m2, l1, lc1, lc2, j1, j2, radius: r, gravity: g } = *self;
        Theta {
            theta_1: m1 * r * r + m2 * l1 * l1 + m2 * r * r + j1,
            theta_2: 2.0 * m1 * r * lc1 + 2.0 * m2 * r * l1,
            theta_5: j2,
            theta_7: m2 * r * lc2,
            theta_8: m2 * l1 * lc2,
            theta_9: m1 * g * lc1 + m2 * g * l1,
            theta_10: m2 * g * lc2,
        }
    }

    /// (m₁ + m₂)·g·R in N·m: the weight that pulls the drum down an incline, times its lever. The paper's ground is
    /// level, so it has no such parameter.
    pub fn theta_slope(&self) -> f64 {
        (self.m1 + self.m2) * self.gravity * self.radius
    }
}

impl Theta {
    /// Table 2.
    ///
    /// No single set of lengths and masses gives these seven numbers: R/g is 0.00614 s² by θ₂/2θ₉ and 0.00764 s² by
    /// θ₇/θ₁₀. They are used as printed.
    pub const TABLE_2: Theta = Theta {
        theta_1: 0.203_86,
        theta_2: 0.058_67,
        theta_5: 0.11,
        theta_7: 0.014_37,
        theta_8: 0.0989,
        theta_9: 4.779,
        theta_10: 1.880,
    };

    /// (m₁ + m₂)·g·R in N·m, assumed: Table 2 can't tell it.
    pub const THETA_SLOPE: f64 = 0.956;
}

impl Default for Theta {
    fn default() -> Self {
        Theta::TABLE_2
    }
}
