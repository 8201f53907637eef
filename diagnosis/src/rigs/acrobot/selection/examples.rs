//! Candidates, columns and screens as tests of the search need them.

use super::evaluation::Evaluation;
use super::screen::{Hit, Screen};
use crate::rigs::acrobot::candidates::{Candidate, Motion, Side};
use crate::rigs::acrobot::residual::{Block, Probe};
use crate::statistics::bootstrap::{Null, Scores};
use crate::statistics::linear::{Cell, Reduced};
use nalgebra::{DMatrix, DVector};

/// One that may go from -1000 to 1000, and is looked for at 0.01.
pub(crate) fn candidate(side: Side, nonlinear: bool) -> Candidate {
    Candidate {
        name: "any",
        side,
        phrase: "",
        motion: Motion::Real { steps: &[0.01], range: (-1e3, 1e3) },
        off: 0.0,
        steps: vec![0.01],
        range: (-1e3, 1e3),
        nonlinear,
        attributes: &[],
    }
}

/// A point with a column for each candidate, as sums: the steps of the columns are 0.1.
pub(super) fn evaluation(point: &[f64], score: &[f64], gram: &[f64]) -> Evaluation {
    let columns = point.len();
    let total = Reduced {
        score: DVector::from_column_slice(score),
        gram: DMatrix::from_row_slice(columns, columns, gram),
        ..Reduced::zero(columns)
    };
    Evaluation {
        point: point.to_vec(),
        probes: (0..columns).map(|candidate| Probe { candidate, by: 0.1 }).collect(),
        blocks: Vec::new(),
        reduced: vec![total.clone()],
        total,
        discrepancy_sd: 0.0,
        sigmas: Vec::new(),
        seen: Vec::new(),
    }
}

/// A block of one row that only a discrepancy may explain.
pub(super) fn block(residual: f64, sigma: f64) -> Block {
    let cell = Cell {
        residual: vec![residual],
        sigma: vec![sigma],
        signal: vec![0],
        time: vec![0.0],
        hard: DMatrix::zeros(1, 0),
        soft: DMatrix::from_element(1, 1, 1.0),
        discrepancy: 0,
        inertia_scale: 1.0,
        columns: DMatrix::zeros(1, 0),
        floor: Vec::new(),
        state: Vec::new(),
        lattice: Vec::new(),
    };
    Block { run: 0, from: 0.0, to: 1.0, cells: vec![cell], state: [0.0; 4] }
}

/// What the column of a candidate predicts, where it asks for one unit more.
pub(super) fn hit(candidate: usize, gain: f64) -> Hit {
    Hit { candidate, column: candidate, gain, statistic: gain.sqrt(), displacement: 1.0 }
}

/// A screen with these.
pub(super) fn found(hits: Vec<Hit>) -> Screen {
    let none = DVector::zeros(0);
    let scores =
        Scores { blocks: DMatrix::zeros(0, 0), total: none.clone(), deviation: none, sided: Vec::new() };
    Screen { hits, null: Null::of(&scores), errors: Vec::new(), p_value: 1.0 }
}
