//! Centroid of the grey levels above the background over a region dilated by two pixels.
//!
//! The partly covered pixels at the rim say where in them the rim runs, which the binary centroid throws away.
//! *Deviations*: beyond the paper.

use super::{Component, estimator::View};
use crate::photometry::{Area, plane::BLOCK};
use crate::variables::Scene;

/// Pixels by which the region is dilated (rows of the field, if interlaced).
pub const DILATION: usize = 2;

/// The centroid in raster coordinates; `None` if nothing is brighter than the background.
pub fn centroid(component: &Component, view: &View<'_>, window: &Area, scene: &Scene) -> Option<(f64, f64)> {
    let bounds = component.bounds;
    let (step, reach) = (view.row_step, DILATION * view.row_step);
    let (mut sum, mut sum_x, mut sum_y) = (0.0, 0.0, 0.0);
    // The first row of the field within reach: as many whole steps up as there is room for.
    let up = ((bounds.y0 - window.y0.min(bounds.y0)) / step * step).min(reach);
    for y in (bounds.y0 - up..(bounds.y1 + reach).min(window.y1)).step_by(step) {
        let rows = (y.saturating_sub(reach).max(bounds.y0)..(y + reach + 1).min(bounds.y1))
            .filter(|row| (row + reach - y) % step == 0);
        let columns =
            bounds.x0.saturating_sub(DILATION).max(window.x0)..(bounds.x1 + DILATION).min(window.x1);
        let near: Vec<&[u32]> = rows.map(|row| view.mask.row(row)).collect();
        for x in columns {
            let from = x.saturating_sub(DILATION).max(bounds.x0);
            let to = (x + DILATION + 1).min(bounds.x1);
            let set = |row: &&[u32]| (from..to).any(|x| row[x / BLOCK] >> (x % BLOCK) & 1 == 1);
            if near.iter().any(set) {
                let weight = f64::from(view.picture.row(y)[x]) - scene.background;
                sum += weight;
                sum_x += weight * (x as f64 + 0.5);
                sum_y += weight * (y as f64 + 0.5);
            }
        }
    }
    // Dark circles on bright ground have negative weights throughout; only a vanishing sum is of no use.
    (sum.abs() > 0.0).then(|| (sum_x / sum, sum_y / sum))
}
