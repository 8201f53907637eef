//! The level of all areas: no sign of anything, as far as right renderers differ in it.

use crate::rigs::acrobot::residual::Block;
use crate::rigs::acrobot::residual::image::policy::IMAGES;
use crate::rigs::acrobot::residual::studio::AREAS;
use crate::statistics::linear::Cell;
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

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    /// What is left of areas that all differ by so much.
    fn left(by: f64) -> f64 {
        let cell = Cell {
            residual: vec![by; AREAS.len()],
            sigma: vec![1.0; AREAS.len()],
            signal: AREAS.collect(),
            time: vec![0.0; AREAS.len()],
            hard: DMatrix::zeros(AREAS.len(), 0),
            soft: DMatrix::zeros(AREAS.len(), 0),
            discrepancy: 0,
            inertia_scale: 1.0,
            columns: DMatrix::from_element(AREAS.len(), 1, 1.0),
            floor: Vec::new(),
            state: Vec::new(),
            lattice: Vec::new(),
            drawn: Vec::new(),
        };
        let mut blocks = [Block { run: 0, from: 0.0, to: 0.0, cells: vec![cell], state: [0.0; 4] }];
        level(&mut blocks);
        blocks[0].cells[0].residual[0]
    }

    #[test]
    fn value_a_light_that_is_a_twentieth_lower_says_nothing() {
        for (by, rest) in [(-0.9, 0.0), (0.9, 0.0), (-4.3, -3.3), (1.1, 0.1)] {
            assert!((left(by) - rest).abs() < 1e-9, "{by}");
        }
    }
}
