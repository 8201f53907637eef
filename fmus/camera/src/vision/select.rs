//! Regions that may be circles: N_min ≤ area ≤ N_max (Section 3.2).

use super::Component;
use crate::variables::Sensor;

/// Area of a region in pixels of a full frame: a pixel of a field stands for two.
pub fn area_px(component: &Component, sensor: &Sensor) -> u32 {
    component.area * if sensor.interlaced { 2 } else { 1 }
}

/// Whether a region's area is that of a circle.
pub fn may_be_circle(component: &Component, sensor: &Sensor) -> bool {
    let area = i64::from(area_px(component, sensor));
    i64::from(sensor.smallest_area) <= area && area <= i64::from(sensor.largest_area)
}
