//! The data of a simulated experiment, cut at the interfaces as in any diagnosis.

use super::scenario::Logs;
use super::simulate::Trial;
use super::{Member, Question};
use crate::error::Error;
use crate::rigs::acrobot::candidates::{Attribute, Candidate, Motion, Side, name};
use crate::rigs::acrobot::dataset::{DataSet, Table};
use crate::rigs::acrobot::experiment::policy::DESIGN;
use crate::rigs::acrobot::model::Model;
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::residual::chain::Chain;
use crate::rigs::acrobot::residual::image::{ImageCut, Pose};
use crate::rigs::acrobot::residual::plant::PlantCut;
use crate::rigs::acrobot::residual::trajectory::{PREROLL, State};
use crate::rigs::acrobot::residual::{Block, Cut, Perturbation, Tracked};
use crate::statistics::linear::{Reduced, reduce};
use std::sync::Arc;

/// All cuts that the logs of an experiment allow, as far as a member shows there.
pub struct Cuts<'a> {
    question: &'a Question<'a>,
    list: Arc<Vec<Candidate>>,
    logs: Logs,
    repeats: f64,
    /// With how many times the rows that are compared stand for.
    all: Vec<(Box<Tracked>, f64)>,
}

impl<'a> Cuts<'a> {
    /// Cuts a trial.
    ///
    /// # Errors
    /// A unit failed, or nothing can be compared.
    pub fn new(
        question: &'a Question<'a>,
        (model, list): (&Model, Arc<Vec<Candidate>>),
        trial: Trial,
        (logs, repeats): (Logs, f64),
    ) -> Result<Self, Error> {
        let data = &trial.data;
        let filmed = question.members.iter().any(|member| list[member.candidate].side == Side::Camera);
        let mut all: Vec<(Box<Tracked>, f64)> = Vec::new();
        if !logs.encoders && filmed {
            let chain = Chain::new(data, model, list.clone())?;
            all.extend(chain.map(|cut| (Box::new(Tracked::new(cut)) as Box<Tracked>, 1.0)));
        } else {
            let read = if logs.encoders { None } else { Some(read(&trial, model)) };
            let plant = PlantCut::new(read.as_ref().unwrap_or(data), model, list.clone())?;
            // what is in question of a camera alone does nothing to an arm that is driven by what was logged
            let shows =
                |cut: &PlantCut| question.members.iter().any(|member| cut.sees(&list[member.candidate]));
            let plant = plant.filter(shows);
            all.extend(plant.map(|cut| (Box::new(Tracked::new(cut)) as Box<Tracked>, 1.0)));
        }
        if logs.encoders && logs.images && filmed {
            let sigma = POLICY.motion_share * question.noise.of("plant.q1", true);
            let pose = Pose::Logged(vec![trial.motion.clone()], sigma);
            let frames: usize =
                data.runs.iter().filter_map(|run| run.camera.as_ref()).map(|log| log.len()).sum();
            if let Some(cut) = ImageCut::new(data, model, list.clone(), pose, DESIGN.frames)? {
                let share = frames as f64 / cut.frames.len() as f64;
                all.push((Box::new(Tracked::new(cut)), share));
            }
        }
        if all.is_empty() {
            return Err(Error::Model("nothing of it can be compared".into()));
        }
        Ok(Self { question, list, logs, repeats, all })
    }

    /// A column. In the plant it is a tangent: secants over whole sizes bend with the motion that runs away, each its
    /// own way, and predict to tell members apart that no fit would. In the image it is a secant over a step of some
    /// pixels, since the lattice is no part of a prediction. What has separate values only, or a saturation, is moved by
    /// its whole `size`.
    pub fn perturbation(&self, candidate: usize, x: f64, size: f64) -> Perturbation {
        let here = &self.list[candidate];
        let step = here.derivative_step(x);
        let by = match here.motion {
            Motion::Saturation { .. } | Motion::Count { .. } | Motion::Switch if x == here.off => size,
            Motion::Count { .. } | Motion::Switch => here.off - x,
            Motion::Saturation { .. } => step,
            _ if here.side == Side::Plant => step * DESIGN.tangent,
            _ => step,
        };
        Perturbation { candidate, by }
    }

    /// What moves a torque in time, by its whole size, with the place among the perturbations.
    fn late(&self, point: &[f64], perturbations: &[Perturbation]) -> Vec<(usize, Perturbation)> {
        let size = |member: &Member| member.x - self.list[member.candidate].off;
        let whole = |(place, perturbation): (usize, &Perturbation)| {
            let member =
                self.question.members.iter().find(|member| member.candidate == perturbation.candidate)?;
            let (here, x) = (&self.list[perturbation.candidate], point[perturbation.candidate]);
            let late = self.logs.torque && here.side == Side::Plant && here.steps.len() > 1;
            let by = if x == here.off { size(member) } else { here.off - x };
            late.then_some((place, Perturbation { by, ..*perturbation }))
        };
        perturbations.iter().enumerate().filter_map(whole).collect()
    }

    /// What is left of all rows at a point, with the nuisances projected out, under the noise that the logs have.
    ///
    /// # Errors
    /// A unit failed.
    pub fn reduced(&mut self, point: &[f64], perturbations: &[Perturbation]) -> Result<Reduced, Error> {
        let mut sum = Reduced::zero(perturbations.len());
        let late = self.late(point, perturbations);
        for (cut, share) in &mut self.all {
            let mut blocks = cut.linearise(point, perturbations)?;
            if !late.is_empty() {
                torque_columns(cut.as_mut(), point, &late, &mut blocks)?;
            }
            // the actuator's past is not known where a log begins, and that is no way to learn of a delay
            let begin = blocks.iter().map(|block| block.from).fold(f64::INFINITY, f64::min);
            blocks.retain(|block| block.from > begin + PREROLL);
            let factors: Vec<f64> = (cut.signals().iter())
                .map(|signal| self.question.noise.of(&signal.name, self.logs.encoders) / signal.sigma)
                .collect();
            for cell in blocks.iter_mut().flat_map(|block| &mut block.cells) {
                for (sigma, signal) in cell.sigma.iter_mut().zip(&cell.signal) {
                    *sigma *= factors[*signal];
                }
                sum.add(&reduce(cell, self.question.discrepancy_sd).dispersed(1.0 / (*share * self.repeats)));
            }
        }
        Ok(sum)
    }
}

/// Columns of the logged torque by whole sizes: a torque that jumps has no tangent.
fn torque_columns(
    cut: &mut Tracked,
    point: &[f64],
    late: &[(usize, Perturbation)],
    blocks: &mut [Block],
) -> Result<(), Error> {
    let whole: Vec<Perturbation> = late.iter().map(|(_, perturbation)| *perturbation).collect();
    let torque = cut.signals().iter().position(|signal| signal.name == "plant.tau_applied");
    let other = cut.chord(point, &whole)?;
    let cells = other.iter().flat_map(|block| &block.cells);
    for (cell, other) in blocks.iter_mut().flat_map(|block| &mut block.cells).zip(cells) {
        for row in (0..cell.signal.len()).filter(|row| Some(cell.signal[*row]) == torque) {
            for (from, (to, _)) in late.iter().enumerate() {
                cell.columns[(row, *to)] = other.columns[(row, from)];
            }
        }
    }
    Ok(())
}

/// Angles as they are read off the frames: where only the plant is in question, what else the image shows needs no
/// rendering.
fn read(trial: &Trial, model: &Model) -> DataSet {
    let mut data = trial.data.clone();
    let delay = model.number(name(Attribute::ImageDelay)).unwrap_or(0.0);
    for run in &mut data.runs {
        let Some(camera) = &run.camera else { continue };
        let seen = camera.time.iter().map(|time| time - delay);
        let (times, states): (Vec<f64>, Vec<State>) =
            seen.filter_map(|time| Some((time, trial.motion.at(time)?))).unzip();
        let angle = |name: &str, place: usize| (name.to_owned(), states.iter().map(|s| s[place]).collect());
        run.plant = Some(Table::new(times, vec![angle("q1", 0), angle("q2", 1)]));
    }
    data
}
