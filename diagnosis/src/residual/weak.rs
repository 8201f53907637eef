//! The plant's cut as torques: for machines that the model misses by far more than the encoders' noise.
//!
//! There, the rows of a window say less than they seem to: what the model lacks is no white noise on angles, and the
//! fastest windows would outvote all others. Each window is turned into the few torques that the model lacks in it,
//! and these count alike. (Weak form: Messenger and Bortz, Multiscale Model. Simul. 19 (2021) 1474; the test
//! functions here are the plant's own responses.)

use super::plant::PlantCut;
use super::torque::deviations;
use super::{Block, Cut, Probe, Signal};
use crate::candidates::{Candidate, Side};
use crate::error::Error;
use crate::selection::FREE;
use crate::statistics::linear::{Cell, nuisances};
use nalgebra::DMatrix;

/// Torques this many typical sizes out count less (Huber).
const OUTLYING: f64 = 4.0;

/// Windows in use: a lacking model doesn't become clearer by more of them, and friction makes them slow.
const WINDOWS: usize = 90;

/// A plant's cut, read as torques.
pub struct Weak {
    /// The rows.
    pub rows: PlantCut,
    signals: Vec<Signal>,
}

impl Weak {
    /// Reads a cut so.
    pub fn new(mut rows: PlantCut) -> Self {
        rows.thin(WINDOWS);
        let signal = |name: &str| Signal { name: name.into(), unit: "N·m", known: None, sigma: 0.1 };
        Self { rows, signals: vec![signal("plant.tau_1"), signal("plant.tau")] }
    }
}

impl Cut for Weak {
    fn name(&self) -> &'static str {
        "plant: torque that the model lacks"
    }

    fn signals(&self) -> &[Signal] {
        &self.signals
    }

    fn sees(&self, candidate: &Candidate) -> bool {
        // where torques are coarse, an offset of a clock is none of them
        self.rows.sees(candidate) && candidate.side == Side::Plant
    }

    fn linearise(&mut self, point: &[f64], probes: &[Probe], quick: bool) -> Result<Vec<Block>, Error> {
        let mut blocks = self.rows.linearise(point, probes, quick)?;
        for block in &mut blocks {
            for cell in &mut block.cells {
                *cell = self.turned(cell);
            }
        }
        let mut sizes: Vec<f64> = blocks
            .iter()
            .flat_map(|block| &block.cells)
            .flat_map(|cell| &cell.residual)
            .map(|x| x.abs())
            .collect();
        sizes.sort_by(f64::total_cmp);
        let typical = sizes.get(sizes.len() / 2).copied().unwrap_or(1.0) / 0.6745;
        for cell in blocks.iter_mut().flat_map(|block| &mut block.cells) {
            for row in 0..cell.residual.len() {
                cell.sigma[row] *= (cell.residual[row].abs() / (OUTLYING * typical)).max(1.0);
            }
        }
        Ok(blocks)
    }

    fn outweighed(&self) -> bool {
        true
    }

    fn discrepancy_unit(&self) -> &'static str {
        "N·m"
    }
}

impl Weak {
    fn turned(&self, cell: &Cell) -> Cell {
        let hard = cell.hard.ncols();
        let solve = |residual: Vec<f64>| nuisances(&Cell { residual, ..cell.clone() }, FREE);
        let torque = solve(cell.residual.clone());
        let rows = torque.len().saturating_sub(hard);
        let mut columns = DMatrix::zeros(rows, cell.columns.ncols());
        for place in 0..cell.columns.ncols() {
            let column: Vec<f64> = cell.columns.column(place).iter().copied().collect();
            if column.iter().any(|value| *value != 0.0) {
                let turned = solve(column);
                (0..rows).for_each(|row| columns[(row, place)] = turned[hard + row]);
            }
        }
        let floor = deviations(cell);
        let middle = cell.time.iter().sum::<f64>() / cell.time.len().max(1) as f64;
        Cell {
            residual: (0..rows).map(|row| torque[hard + row]).collect(),
            sigma: (0..rows).map(|row| self.signals[row % 2].sigma).collect(),
            signal: (0..rows).map(|row| row % 2).collect(),
            time: vec![middle; rows],
            hard: DMatrix::zeros(rows, 0),
            soft: DMatrix::zeros(rows, 0),
            discrepancy: 0,
            columns,
            floor: floor.get(hard..).unwrap_or(&[]).to_vec(),
        }
    }
}
