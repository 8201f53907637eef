//! The plant's cut as torques: for machines that the model misses by far more than the encoders' noise.
//!
//! There a plant that is driven by the torque alone leaves the log within a window, and what the model lacks is no
//! white noise on angles. So the unit is asked at the *measured* state, without any stepping: which accelerations does
//! it give? Against a test function φ that vanishes with its slopes at the ends of a stretch, ∫φ″q dt of the log is
//! ∫φ q̈ dt of the truth, and no log is differentiated twice. The difference, turned into torques by the unit's own
//! sensitivity to tau_1 and tau, is what the model lacks there.
//! Messenger and Bortz, Multiscale Model. Simul. 19 (2021) 1474; torques as in Gautier, Janot and Vandanjon, IEEE
//! Trans. Control Syst. Technol. 21 (2013) 428.

mod forced_stretches;

use super::actuator::{Actuator, key, passing, references};
use super::plant::jitter::torque_jitter;
use super::plant::zeros;
use super::settings::settings;
use super::trajectory::State;
use super::weak_stretches::{Node, Stretch, stretches};
use super::{Block, Cut, Linearised, Nuisances, Perturbation, Policy, Signal};
use crate::error::Error;
use crate::rigs::acrobot::bench::{Bench, Setting};
use crate::rigs::acrobot::candidates::{Attribute, Candidate, Side};
use crate::rigs::acrobot::channels::Measures;
use crate::rigs::acrobot::dataset::DataSet;
use crate::rigs::acrobot::model::Model;
use crate::rigs::acrobot::parameters;
use crate::rigs::acrobot::residual::policy::RESIDUAL;
use crate::statistics::levels::{FEW, HALF, MIDDLE, TASK};
use crate::statistics::linear::Cell;
use crate::statistics::linear::RANK_TOLERANCE;
use crate::statistics::median::median;
use nalgebra::{DMatrix, Matrix2, Vector2};
use orchestrator::Value;
use rayon::prelude::*;
use std::collections::VecDeque;
use std::sync::Arc;

/// Torque for the unit's sensitivity, N·m: it is linear in it.
const PUSH: f64 = 1.0;

/// An angle between the links that none reaches, rad.
const FAR: f64 = 1.0 / RANK_TOLERANCE;

/// For each stretch ∫φ q̈ dt.
type Given = Arc<Vec<Vector2<f64>>>;

/// Accelerations at measured states, read as torques.
pub struct Weak {
    bench: Arc<Bench>,
    candidates: Arc<Vec<Candidate>>,
    actuator: Actuator,
    stretches: Vec<Stretch>,
    nodes: Vec<Node>,
    /// What the unit gave lately: fits come back to where a linearisation or another fit was.
    known: VecDeque<(Vec<u64>, Given)>,
    signals: Vec<Signal>,
    inputs: [u32; 6],
    outputs: [u32; 2],
    /// Torque that the scatter of the torques' timestamps gives, N·m.
    explained: f64,
    contact: u32,
}

/// A torque as a signal, with a standard deviation to begin with.
fn torque(name: &str) -> Signal {
    Signal {
        name: name.into(),
        unit: "N·m",
        measures: Measures::LackingTorque,
        known: None,
        sigma: 0.1,
        least: 0.0,
        tolerance: 0.0,
    }
}

impl Weak {
    /// All stretches of all runs with motion and torque; `None` if there are none.
    ///
    /// # Errors
    /// The unit lacks a variable or failed.
    pub fn new(
        data: &DataSet,
        model: &Model,
        candidates: Arc<Vec<Candidate>>,
    ) -> Result<Option<Self>, Error> {
        let bench = model.plant.clone();
        let reference = |name: &str| bench.reference(name);
        let inputs = [
            reference("q1_0")?,
            reference("q2_0")?,
            reference("dq1_0")?,
            reference("dq2_0")?,
            reference("tau_1")?,
            reference("tau")?,
        ];
        let outputs = [reference("ddq1")?, reference("ddq2")?];
        let limit = reference("q2_max")?;
        let contact = data.contact(model.number(parameters::LIMIT).unwrap_or(f64::INFINITY));
        let (found, nodes) = stretches(data, contact);
        if found.is_empty() {
            return Ok(None);
        }
        let actuator = Actuator::new(data, &bench)?;
        let length = found[0].to - found[0].from;
        let explained = torque_jitter(&data.runs, 0.5 * length);
        let mut weak = Self {
            bench,
            candidates,
            actuator,
            stretches: found,
            nodes,
            known: VecDeque::new(),
            signals: ["plant.tau_1", "plant.tau"].map(torque).to_vec(),
            inputs,
            outputs,
            explained,
            contact: limit,
        };
        weak.weigh()?;
        Ok(Some(weak))
    }

    /// Torque per acceleration at the middle of each stretch, by the nominal unit.
    fn weigh(&mut self) -> Result<(), Error> {
        let middles: Vec<Node> = self.stretches.iter().map(|s| self.nodes[s.middle()].clone()).collect();
        let through: Vec<Setting> = passing(&self.bench).collect();
        let pushed = |tau_1: f64, tau: f64| {
            let nodes: Vec<Node> = middles
                .iter()
                .map(|node| Node { tau_1: node.tau_1 + tau_1, tau: node.tau + tau, ..*node })
                .collect();
            self.accelerations(&through, &nodes)
        };
        // a torque that needs time to arrive, or is cut off, moves nothing at once
        let (still, one, two) = (pushed(0.0, 0.0)?, pushed(PUSH, 0.0)?, pushed(0.0, PUSH)?);
        for (place, stretch) in self.stretches.iter_mut().enumerate() {
            let by = |moved: &[f64; 2], axis: usize| (moved[axis] - still[place][axis]) / PUSH;
            let (one, two) = (&one[place], &two[place]);
            let sensitivity = Matrix2::new(by(one, 0), by(two, 0), by(one, 1), by(two, 1));
            stretch.inertia = sensitivity.try_inverse().unwrap_or_else(Matrix2::zeros);
        }
        Ok(())
    }

    /// What the unit gives at states, in initialization mode: inputs and start values are set, outputs are read.
    fn accelerations(&self, settings: &[Setting], nodes: &[Node]) -> Result<Vec<[f64; 2]>, Error> {
        let failed = |error: orchestrator::Error| Error::Model(error.to_string());
        self.bench.initialising(&self.with_open_limit(settings), |instance| {
            let mut all = Vec::with_capacity(nodes.len());
            for node in nodes {
                let [q1, q2, dq1, dq2] = node.state;
                instance.set_real(&self.inputs, &[q1, q2, dq1, dq2, node.tau_1, node.tau]).map_err(failed)?;
                let mut found = [0.0; 2];
                instance.get_real(&self.outputs, &mut found).map_err(failed)?;
                all.push(found);
            }
            Ok(all)
        })
    }

    /// Rows at which the links touch are no part of a stretch, so the unit must not hold them.
    fn with_open_limit(&self, settings: &[Setting]) -> Vec<Setting> {
        let open = (self.contact, Value::Real(FAR));
        settings.iter().cloned().chain([open]).collect()
    }

    /// For each stretch ∫φ q̈ dt, by the unit at a point.
    fn given(&mut self, point: &[f64], moved: Option<Perturbation>) -> Result<Given, Error> {
        let all = settings(&self.bench, &self.candidates, Side::Plant, point, moved)?;
        let zeros = zeros(&self.candidates, point, moved);
        let mut key = key(&all);
        key.extend(zeros.map(f64::to_bits));
        if let Some((_, known)) = self.known.iter().find(|(known, _)| *known == key) {
            return Ok(known.clone());
        }
        let given = Arc::new(self.weigh_accelerations(all, zeros, point, moved)?);
        // a linearisation with all candidates and the fits around it
        if self.known.len() > FEW * self.candidates.len() {
            self.known.pop_front();
        }
        self.known.push_back((key, given.clone()));
        Ok(given)
    }

    /// The torques that a stretch lacks at a point, N·m, with the columns of the perturbations. `base` and `columns` are what the unit
    /// gives there and beside it.
    fn stretch_cell(
        &self,
        place: usize,
        base: &Given,
        perturbations: &[Perturbation],
        columns: &[Option<Given>],
    ) -> Cell {
        let stretch = &self.stretches[place];
        let torque = stretch.inertia * (stretch.measured - base[place]);
        let mut matrix = DMatrix::zeros(2, perturbations.len());
        for (column, (perturbation, moved)) in perturbations.iter().zip(columns).enumerate() {
            let Some(moved) = moved else { continue };
            let change = stretch.inertia * (moved[place] - base[place]) / perturbation.by;
            (0..2).for_each(|row| matrix[(row, column)] = change[row]);
        }
        Cell {
            residual: vec![torque[0], torque[1]],
            sigma: self.signals.iter().map(|signal| signal.sigma).collect(),
            signal: vec![0, 1],
            time: vec![self.nodes[stretch.middle()].time; 2],
            hard: DMatrix::zeros(2, 0),
            soft: DMatrix::zeros(2, 0),
            discrepancy: 0,
            inertia_scale: 1.0,
            columns: matrix,
            floor: stretch.floor().to_vec(),
            state: Vec::new(),
            lattice: Vec::new(),
            drawn: Vec::new(),
        }
    }

    /// For each stretch ∫φ q̈ dt, by the unit with all these settings and with encoders' zeros off by `zeros`, rad.
    fn weigh_accelerations(
        &self,
        all: Vec<Setting>,
        zeros: [f64; 2],
        point: &[f64],
        moved: Option<Perturbation>,
    ) -> Result<Vec<Vector2<f64>>, Error> {
        let applied = self.actuator.applied(&self.bench, &self.candidates, point, moved)?;
        let chain = references(&self.bench, Attribute::InActuator);
        let driven = applied.is_some();
        let mut fixed: Vec<Setting> =
            all.into_iter().filter(|(reference, _)| !(driven && chain.contains(reference))).collect();
        fixed.extend(passing(&self.bench).filter(|_| driven));
        let found: Vec<Vec<[f64; 2]>> = self
            .nodes
            .par_chunks(TASK)
            .map(|nodes| match &applied {
                None if zeros == [0.0; 2] => self.accelerations(&fixed, nodes),
                applied => {
                    let tau = |node: &Node| match applied {
                        Some(applied) => applied.at(node.run, node.time),
                        None => node.tau,
                    };
                    let [q1, q2] = zeros;
                    let turned = |[a, b, da, db]: State| [a - q1, b - q2, da, db];
                    let nodes: Vec<Node> = (nodes.iter())
                        .map(|node| Node { tau: tau(node), state: turned(node.state), ..*node })
                        .collect();
                    self.accelerations(&fixed, &nodes)
                }
            })
            .collect::<Result<_, _>>()?;
        let sum = |stretch: &Stretch, axis: usize| {
            let weighed = stretch.nodes.iter().zip(&stretch.weights);
            weighed.map(|(node, weight)| found[node / TASK][node % TASK][axis] * weight).sum()
        };
        Ok(self.stretches.iter().map(|s| Vector2::new(sum(s, 0), sum(s, 1))).collect())
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
        matches!(candidate.side, Side::Plant | Side::Zero)
    }

    fn policy(&self) -> Policy {
        Policy { steady: true, discrepancy_dominated: true, explained: self.explained, ..Policy::USUAL }
    }

    fn initial(&self) -> Nuisances {
        Nuisances::default()
    }

    fn linearise(
        &mut self,
        point: &[f64],
        perturbations: &[Perturbation],
        from: &Nuisances,
    ) -> Result<Linearised, Error> {
        let base = self.given(point, None)?;
        let mut columns: Vec<Option<Given>> = Vec::with_capacity(perturbations.len());
        for perturbation in perturbations {
            let seen = self.sees(&self.candidates[perturbation.candidate]);
            columns.push(if seen { Some(self.given(point, Some(*perturbation))?) } else { None });
        }
        let mut blocks: Vec<Block> = Vec::new();
        let covered: f64 = self.stretches.iter().map(|stretch| 0.5 * (stretch.to - stretch.from)).sum();
        let length = (covered / RESIDUAL.blocks).clamp(HALF * RESIDUAL.length, RESIDUAL.block);
        for (place, stretch) in self.stretches.iter().enumerate() {
            let cell = self.stretch_cell(place, &base, perturbations, &columns);
            match blocks.last_mut() {
                Some(block) if block.run == stretch.run && stretch.from - block.from < length - 1e-9 => {
                    block.to = stretch.to;
                    block.cells.push(cell);
                }
                _ => blocks.push(Block {
                    run: stretch.run,
                    from: stretch.from,
                    to: stretch.to,
                    cells: vec![cell],
                    state: self.nodes[stretch.middle()].state,
                }),
            }
        }
        count_less(&mut blocks);
        Ok(Linearised { blocks, nuisances: from.clone(), unseen: 0 })
    }

    fn chord(
        &mut self,
        point: &[f64],
        perturbations: &[Perturbation],
        from: &Nuisances,
    ) -> Result<Linearised, Error> {
        self.linearise(point, perturbations, from)
    }
}

/// Rows far out count less, by link.
fn count_less(blocks: &mut [Block]) {
    for signal in 0..2 {
        let sizes = blocks.iter().flat_map(|block| &block.cells).map(|cell| cell.residual[signal].abs());
        let typical = median(sizes).unwrap_or(1.0) / MIDDLE;
        for cell in blocks.iter_mut().flat_map(|block| &mut block.cells) {
            cell.sigma[signal] *= (cell.residual[signal].abs() / (RESIDUAL.outlying * typical)).max(1.0);
        }
    }
}
