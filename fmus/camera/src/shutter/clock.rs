//! Times of frames: the exposure of frame k ends at k/ω_cam and lasts E_t/ω_cam (Section 2.3).

use crate::variables::Sensor;

/// Times this close, relative to their size (or to 1 s), are the same communication point. Masters reach a point by
/// different roundings; a frame must not be missed for it.
pub const SAME_TIME: f64 = 1e-9;

/// Whether `time` has come at `now`.
pub fn has_come(time: f64, now: f64) -> bool {
    time <= now + SAME_TIME * now.abs().max(1.0)
}

/// The camera's clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameClock {
    rate: f64,
    exposure_factor: f64,
}

impl FrameClock {
    /// The clock of these parameters: fields come at twice ω_cam.
    pub fn new(sensor: &Sensor) -> Self {
        let rate = if sensor.interlaced { 2.0 * sensor.frame_rate } else { sensor.frame_rate };
        Self { rate, exposure_factor: sensor.exposure_factor }
    }

    /// The first frame whose exposure ends at or after `start`.
    pub fn first_frame(&self, start: f64) -> i64 {
        let mut k = libm::ceil(start * self.rate) as i64;
        while has_come(start, self.exposure_end(k - 1)) {
            k -= 1;
        }
        k
    }

    /// End of the exposure of frame k, in s. Divided, never summed, so that no error grows.
    pub fn exposure_end(&self, k: i64) -> f64 {
        k as f64 / self.rate
    }

    /// Duration of an exposure in s.
    pub fn exposure(&self) -> f64 {
        self.exposure_factor / self.rate
    }

    /// Middle of the exposure of frame k, in s.
    pub fn mid_exposure(&self, k: i64) -> f64 {
        (k as f64 - 0.5 * self.exposure_factor) / self.rate
    }
}
