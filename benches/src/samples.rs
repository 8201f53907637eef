//! Measured values and their quantiles.

use std::time::Instant;

/// Values of one quantity, in the order they were measured.
#[derive(Debug, Clone, Default)]
pub struct Samples(pub Vec<f64>);

impl Samples {
    /// The value below which a share (0..1) of all lies.
    pub fn at(&self, share: f64) -> f64 {
        let mut sorted = self.0.clone();
        sorted.sort_by(f64::total_cmp);
        sorted[((share * sorted.len() as f64) as usize).min(sorted.len() - 1)]
    }

    /// The 10th percentile: what it costs when nothing else is on the machine.
    pub fn quiet(&self) -> f64 {
        self.at(0.1)
    }

    /// The median.
    pub fn median(&self) -> f64 {
        self.at(0.5)
    }

    /// How many.
    pub fn n(&self) -> usize {
        self.0.len()
    }

    /// 10th percentile, and median to 90th percentile in brackets.
    pub fn text(&self) -> String {
        format!("{} ({}–{})", short(self.quiet()), short(self.median()), short(self.at(0.9)))
    }
}

/// Three significant digits.
pub fn short(value: f64) -> String {
    let digits = if value == 0.0 { 0 } else { (2 - value.abs().log10().floor() as i32).max(0) };
    format!("{value:.*}", digits as usize)
}

/// Seconds that some work takes.
pub fn seconds(work: impl FnOnce()) -> f64 {
    let began = Instant::now();
    work();
    began.elapsed().as_secs_f64()
}
