//! Sizes of the noises: of each channel, of each state equation, of the timestamps.

/// What the model leaves to chance.
#[derive(Debug, Clone, PartialEq)]
pub struct Noise {
    /// Standard deviation of each channel, in its own unit.
    pub channels: Vec<f64>,
    /// Size of the process noise of each state equation, unit of the state per √s; states beyond them have none.
    pub process: Vec<f64>,
    /// Standard deviation of the timestamps, s.
    pub jitter: f64,
    /// An unlisted input at one equation, with a memory.
    pub disturbance: Option<Disturbance>,
}

/// An unlisted input as a first-order Gauss-Markov process: white noise for a short time constant, a random walk for a long one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disturbance {
    /// The state equation it acts on.
    pub equation: usize,
    /// Standard deviation, unit of the state per s.
    pub size: f64,
    /// Correlation time, s.
    pub memory: f64,
}

/// Size of a process noise from which its search begins: over ten rows, so far apart, it moves a state by a third of its scale. Numerical only.
pub fn first_process_noise(scale: f64, row: f64) -> f64 {
    0.3 * scale / (10.0 * row).sqrt()
}

impl Noise {
    /// Variance of a measured value.
    #[inline]
    pub fn variance(&self, channel: usize, slope: f64) -> f64 {
        let sigma = self.channels[channel];
        let late = self.jitter * slope;
        sigma * sigma + late * late
    }
}
