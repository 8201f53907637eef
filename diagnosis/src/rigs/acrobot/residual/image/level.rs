//! The level of all areas: no sign of anything, as far as right renderers differ in it.

use super::*;
use crate::rigs::acrobot::residual::image::policy::IMAGES;
use nalgebra::RowDVector;

/// Takes off the areas what they differ by alike, as far as right renderers may: that is no sign of anything.
pub(super) fn level(blocks: &mut [Block]) {
    let mut cells: Vec<&mut Cell> = blocks.iter_mut().flat_map(|block| &mut block.cells).collect();
    let areas = |cell: &Cell| -> Vec<usize> {
        (0..cell.signal.len()).filter(|row| AREAS.contains(&cell.signal[*row])).collect()
    };
    let Some(perturbations) = cells.first().map(|cell| cell.columns.ncols()) else { return };
    let (mut count, mut sum, mut columns) = (0.0, 0.0, RowDVector::zeros(perturbations));
    for cell in &cells {
        for row in areas(cell) {
            count += 1.0;
            sum += cell.residual[row];
            columns += cell.columns.row(row);
        }
    }
    if count == 0.0 {
        return;
    }
    let mean = sum / count;
    let within = mean.abs() < IMAGES.level;
    for cell in &mut cells {
        for row in areas(cell) {
            cell.residual[row] -= mean.clamp(-IMAGES.level, IMAGES.level);
            // beyond, the level is fixed, and columns say all of it
            if within {
                let centred = cell.columns.row(row) - &columns / count;
                cell.columns.set_row(row, &centred);
            }
        }
    }
}
