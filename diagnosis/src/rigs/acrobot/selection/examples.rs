//! Candidates, columns and screens as tests of the search need them.

use super::evaluation::Evaluation;
use super::screen::{Hit, Screen};
use crate::error::Error;
use crate::rigs::acrobot::candidates::{Candidate, Motion, Side};
use crate::rigs::acrobot::channels::Measures;
use crate::rigs::acrobot::residual::{
    Block, Cut, Linearised, Nuisances, Perturbation, Policy, Signal, Tracked,
};
use crate::statistics::bootstrap::{Null, Scores};
use crate::statistics::linear::{Cell, Reduced};
use nalgebra::{DMatrix, DVector};

/// One that may go from -1000 to 1000, and is tried at 0.01.
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
        perturbations: (0..columns).map(|candidate| Perturbation { candidate, by: 0.1 }).collect(),
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
        drawn: Vec::new(),
    };
    Block { run: 0, from: 0.0, to: 1.0, cells: vec![cell], state: [0.0; 4] }
}

/// What the column of a candidate predicts, where it asks for one unit more.
pub(super) fn hit(candidate: usize, gain: f64) -> Hit {
    Hit { candidate, column: candidate, gain, statistic: gain.sqrt(), displacement: 1.0 }
}

/// A screen with these.
pub(crate) fn found(hits: Vec<Hit>) -> Screen {
    let none = DVector::zeros(0);
    let scores =
        Scores { blocks: DMatrix::zeros(0, 0), total: none.clone(), deviation: none, sided: Vec::new() };
    Screen { hits, null: Null::of(&scores), errors: Vec::new(), p_value: 1.0 }
}

/// Rows at a point.
type Rows = Box<dyn Fn(&[f64]) -> Vec<f64> + Send + Sync>;

/// A cut whose rows, of unit noise, are a function of the point: three at most, so that their noise stays what it is.
pub(crate) struct Toy {
    rows: Rows,
    signals: Vec<Signal>,
    policy: Policy,
}

/// Residuals that are a function of the point.
pub(crate) fn toy(rows: impl Fn(&[f64]) -> Vec<f64> + Send + Sync + 'static) -> Tracked<Toy> {
    toy_like(Policy::USUAL, rows)
}

/// The same, compared as the policy says.
pub(crate) fn toy_like(
    policy: Policy,
    rows: impl Fn(&[f64]) -> Vec<f64> + Send + Sync + 'static,
) -> Tracked<Toy> {
    let signal = Signal {
        name: "plant.q1".into(),
        unit: "rad",
        measures: Measures::Angle,
        known: None,
        sigma: 1.0,
        least: 0.0,
        tolerance: 0.0,
    };
    Tracked::new(Toy { rows: Box::new(rows), signals: vec![signal], policy })
}

impl Cut for Toy {
    fn name(&self) -> &'static str {
        "a toy"
    }

    fn signals(&self) -> &[Signal] {
        &self.signals
    }

    fn sees(&self, _: &Candidate) -> bool {
        true
    }

    fn policy(&self) -> Policy {
        self.policy
    }

    fn initial(&self) -> Nuisances {
        Nuisances::default()
    }

    fn linearise(
        &mut self,
        at: &[f64],
        perturbations: &[Perturbation],
        _: &Nuisances,
    ) -> Result<Linearised, Error> {
        let residual = (self.rows)(at);
        let count = residual.len();
        let mut columns = DMatrix::zeros(count, perturbations.len());
        for (place, perturbation) in perturbations.iter().enumerate() {
            let mut there = at.to_vec();
            there[perturbation.candidate] += perturbation.by;
            for (row, (here, there)) in residual.iter().zip((self.rows)(&there)).enumerate() {
                columns[(row, place)] = (here - there) / perturbation.by;
            }
        }
        let mut block = block(0.0, 1.0);
        for cell in &mut block.cells {
            (cell.residual, cell.columns) = (residual.clone(), columns.clone());
            (cell.sigma, cell.signal, cell.time) = (vec![1.0; count], vec![0; count], vec![0.0; count]);
            (cell.hard, cell.soft) = (DMatrix::zeros(count, 0), DMatrix::zeros(count, 0));
        }
        Ok(Linearised { blocks: vec![block], nuisances: Nuisances::default(), unseen: 0 })
    }

    fn chord(
        &mut self,
        at: &[f64],
        perturbations: &[Perturbation],
        from: &Nuisances,
    ) -> Result<Linearised, Error> {
        self.linearise(at, perturbations, from)
    }
}
