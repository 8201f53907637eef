//! Regions that may be circles: N_min ≤ area ≤ N_max (Section 3.2), and all of it in the picture: the centre of what is
//! left of a circle that the edge cuts is up to a radius off.

use super::Component;
use crate::variables::Sensor;

/// Area of a region in pixels of a full frame: a pixel of a field stands for two.
pub fn area_px(component: &Component, sensor: &Sensor) -> u32 {
    component.area * if sensor.interlaced { 2 } else { 1 }
}

/// Whether a region touches the edge of the picture.
fn may_be_cut(component: &Component, sensor: &Sensor) -> bool {
    let (width, height) = (sensor.width as usize, sensor.height as usize);
    let row_step = if sensor.interlaced { 2 } else { 1 };
    let bounds = component.bounds;
    bounds.x0 == 0 || bounds.x1 >= width || bounds.y0 < row_step || bounds.y1 + row_step > height
}

/// Whether a region is whole and its area that of a circle.
pub fn may_be_circle(component: &Component, sensor: &Sensor) -> bool {
    let area = i64::from(area_px(component, sensor));
    i64::from(sensor.smallest_area) <= area
        && area <= i64::from(sensor.largest_area)
        && !may_be_cut(component, sensor)
}
