//! What happens to a value between the output and the log: y = gain · h(t - delay) + offset + drift · (t - t₀).

/// The effects at one output, each at a value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effects {
    /// Factor.
    pub gain: f64,
    /// Summand.
    pub offset: f64,
    /// s.
    pub delay: f64,
    /// s.
    pub lag: f64,
    /// Per s.
    pub drift: f64,
}

impl Effects {
    /// None.
    pub const OFF: Self = Self { gain: 1.0, offset: 0.0, delay: 0.0, lag: 0.0, drift: 0.0 };

    /// What the log shows of a value, so long after the run's begin.
    pub fn shown(&self, value: f64, since: f64) -> f64 {
        self.gain * value + self.offset + self.drift * since
    }
}
