//! The centre of a region: centroid of the binary image (Section 3.2).

use super::{Component, select};
use crate::variables::Sensor;
use serde::{Deserialize, Serialize};

/// A region that may be a circle.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Feature {
    /// Centre in pixels: u right, v up, origin at the image centre.
    pub centre_px: (f64, f64),
    /// Area in pixels of a full frame.
    pub area_px: f64,
}

impl Feature {
    /// The centroid of a region's pixels.
    pub fn binary(component: &Component, sensor: &Sensor) -> Self {
        let area = f64::from(component.area);
        let (x, y) = (component.sum_x as f64 / area, component.sum_y as f64 / area);
        Self {
            centre_px: pixel_from_raster((x + 0.5, y + 0.5), sensor),
            area_px: f64::from(select::area_px(component, sensor)),
        }
    }
}

/// Pixel coordinates (origin at the image centre, v up) of a place in raster coordinates.
pub fn pixel_from_raster((x, y): (f64, f64), sensor: &Sensor) -> (f64, f64) {
    (x - f64::from(sensor.width) / 2.0, f64::from(sensor.height) / 2.0 - y)
}
