//! The state from the circles, and the estimate that is delivered.
//!
//! q₁ = atan2(u₂ − u₁, v₂ − v₁), q₂ = atan2(u₃ − u₂, v₃ − v₂); rates are first-order differences of the two newest
//! valid estimates (Section 3.2). A frame in which the circles are not found leaves the last estimate standing.

use super::Feature;
use super::correspondence::{self, Triple};
use crate::variables::{Scene, Sensor};
use serde::{Deserialize, Serialize};

/// What the vision system knows after a frame.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Estimate {
    /// Number k of the frame: its exposure ended at k/omega_cam.
    pub number: i64,
    /// The circles were found and matched in this frame.
    pub valid: bool,
    /// Time of mid-exposure of this frame, in s.
    pub mid_exposure: f64,
    /// Estimated angles q₁, q₂ in rad, from the newest valid frame.
    pub angles: (f64, f64),
    /// Their rates in rad/s.
    pub rates: (f64, f64),
    /// The circles of the newest valid frame.
    pub circles: Triple,
}

/// Follows the circles from frame to frame.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Tracker {
    newest: Estimate,
    /// Time of mid-exposure of the newest valid frame.
    newest_valid: Option<f64>,
}

impl Tracker {
    /// Takes the regions of the next frame and says what is known now.
    pub fn follow(
        &mut self,
        candidates: &[Feature],
        mid_exposure: f64,
        scene: &Scene,
        sensor: &Sensor,
    ) -> Estimate {
        let tracked =
            if self.newest.valid { correspondence::nearest(candidates, &self.newest.circles) } else { None };
        let circles = tracked.or_else(|| correspondence::by_geometry(candidates, scene, sensor));
        self.newest.mid_exposure = mid_exposure;
        self.newest.valid = circles.is_some();
        if let Some(circles) = circles {
            let angles = angles(&circles, sensor);
            self.newest.rates = match self.newest_valid {
                Some(last) => {
                    let rate = |new: f64, old: f64| turn(new - old) / (mid_exposure - last);
                    (rate(angles.0, self.newest.angles.0), rate(angles.1, self.newest.angles.1))
                }
                None => (0.0, 0.0),
            };
            self.newest.angles = angles;
            self.newest.circles = circles;
            self.newest_valid = Some(mid_exposure);
        }
        self.newest
    }
}

/// The link angles that the circles show.
pub fn angles(circles: &Triple, sensor: &Sensor) -> (f64, f64) {
    // Pixels need not be square.
    let shape = f64::from(sensor.height) / f64::from(sensor.width);
    let link = |from: &Feature, to: &Feature| {
        let (du, dv) = (to.centre_px.0 - from.centre_px.0, to.centre_px.1 - from.centre_px.1);
        let (du, dv) = sensor.upright((du * shape, dv));
        libm::atan2(du, dv)
    };
    (link(&circles[0], &circles[1]), link(&circles[1], &circles[2]))
}

/// A difference of angles without whole turns.
fn turn(difference: f64) -> f64 {
    use core::f64::consts::{PI, TAU};
    if difference > PI {
        difference - TAU
    } else if difference < -PI {
        difference + TAU
    } else {
        difference
    }
}
