//! How well an experiment tells candidates apart: what a diagnosis of its data would lose by taking one of them for
//! another.
//!
//! In closed loop, trajectories with different candidates differ through the unstable plant and say nothing by
//! themselves. So the experiment is simulated with one member as the truth, its data are cut at the interfaces as in
//! any diagnosis, and the columns of all members are taken there. With start states, poses and the other effects
//! found projected out, a member A of size a has the signature a·A; the rival B, fitted in its place, leaves
//!
//! min over b within B's range of |a·A - b·B|²
//!
//! in units of deviance: twice the expected log of the likelihood ratio, under the noise of the logs
//! (Box and Hill, Technometrics 9 (1967) 57, for one truth at a time). To first order: with encoders, rivals that were
//! fitted in the truth's place through the unit gave the same within a tenth (39 and 42 for theta_1 and theta_2).

use super::cuts::Cuts;
use super::scenario::{Prepared, refused};
use super::simulate::{Simulated, Trial, simulate};
use super::{Member, Question};
use crate::error::Error;
use crate::rigs::acrobot::amend::written;
use crate::rigs::acrobot::candidates::{Attribute, Candidate, Motion, Side, name};
use crate::rigs::acrobot::dataset::Run;
use crate::rigs::acrobot::experiment::policy::DESIGN;
use crate::rigs::acrobot::model::Model;
use crate::rigs::acrobot::residual::Perturbation;
use crate::rigs::acrobot::selection::allowed_loss;
use crate::statistics::linear::{solve, submatrix};
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// `losses[a][b]`: what is lost if the truth is member a and b is taken for it.
pub type Losses = Vec<Vec<f64>>;

/// An experiment with the nominal model that it has.
pub struct Bench<'a> {
    question: &'a Question<'a>,
    prepared: &'a Prepared,
    model: Model,
    list: Arc<Vec<Candidate>>,
    point: Vec<f64>,
}

impl<'a> Bench<'a> {
    /// Loads the nominal model with what the experiment changes.
    ///
    /// # Errors
    /// The model can't be loaded so.
    pub fn new(question: &'a Question<'a>, prepared: &'a Prepared) -> Result<Self, Error> {
        let mut head = question.data.clone();
        head.runs = Vec::new();
        let mut set: Vec<(String, f64)> = prepared.set.clone();
        let noise = name(Attribute::SensorNoise);
        if question.model.number(noise).is_some() {
            set.push((noise.into(), 0.0));
        }
        let typed = |name: &str, value: f64| match question.list.iter().find(|c| c.name == name) {
            Some(candidate) if candidate.is_discrete() => toml::Value::Integer(value as i64),
            _ => toml::Value::Float(value),
        };
        head.manifest.set.extend(set.into_iter().map(|(name, value)| (name.clone(), typed(&name, value))));
        let model = Model::load(&head, question.units)?;
        let mut list = question.list.to_vec();
        let mut point = question.point.to_vec();
        for (candidate, x) in list.iter_mut().zip(&mut point) {
            let moved = prepared.set.iter().find(|(name, _)| name == candidate.name);
            if let Some((_, value)) = moved.filter(|_| !candidate.side.is_of_log()) {
                // what differs from nominal stays as it is, about another nominal value
                *x += value - candidate.off;
                candidate.off = *value;
            }
        }
        Ok(Self { question, prepared, model, list: Arc::new(list), point })
    }

    /// How far a member is from off.
    fn size(&self, member: &Member) -> f64 {
        member.x - self.question.list[member.candidate].off
    }

    /// The losses as data with member `truth` show them, from columns there. Only row `truth` is about that truth
    /// itself; the others use the same columns for other sizes.
    ///
    /// # Errors
    /// The experiment can't be simulated.
    pub fn losses(&self, truth: usize, simulated: &mut Simulated) -> Result<Losses, Error> {
        let (point, mut cuts) = self.cuts(truth, simulated)?;
        self.linear(&mut cuts, &point)
    }

    /// The point at which one member is on, and the others of its class are off.
    fn point(&self, truth: usize) -> Vec<f64> {
        let mut point = self.point.clone();
        for member in &self.question.members {
            point[member.candidate] = self.list[member.candidate].off;
        }
        let own = &self.question.members[truth];
        let candidate = &self.list[own.candidate];
        point[own.candidate] = (candidate.off + self.size(own)).clamp(candidate.range.0, candidate.range.1);
        point
    }

    /// The experiment, simulated with one member and cut.
    fn cuts(&self, truth: usize, simulated: &mut Simulated) -> Result<(Vec<f64>, Cuts<'_>), Error> {
        let (point, trial, repeats) = self.trial(truth, simulated)?;
        let logged = (self.prepared.logs, repeats);
        let cuts = Cuts::new(self.question, (&self.model, self.list.clone()), trial, logged)?;
        Ok((point, cuts))
    }

    /// What a lab would log with one member as the truth.
    ///
    /// # Errors
    /// The experiment can't be simulated.
    pub fn logged(&self, truth: usize, simulated: &mut Simulated) -> Result<Run, Error> {
        let (_, trial, _) = self.trial(truth, simulated)?;
        trial.data.runs.into_iter().next().ok_or_else(|| Error::Model("the experiment has no run".into()))
    }

    /// The point at which one member is on, the experiment simulated there, and how often it stands for its run.
    fn trial(&self, truth: usize, simulated: &mut Simulated) -> Result<(Vec<f64>, Trial, f64), Error> {
        let point = self.point(truth);
        let values: Vec<(String, String)> = (0..point.len())
            .filter(|index| point[*index] != self.list[*index].off)
            .filter(|index| matches!(self.list[*index].side, Side::Plant | Side::Camera))
            .map(|index| {
                let candidate = &self.list[index];
                (candidate.name.to_owned(), written(candidate, candidate.value(point[index])))
            })
            .collect();
        let mut prepared = self.prepared.clone();
        let logs = prepared.logs;
        let chained = !logs.encoders
            && self.question.members.iter().any(|m| self.list[m.candidate].side == Side::Camera);
        let length = prepared.scenario.stop.to_f64();
        if chained && length > DESIGN.short {
            prepared.scenario.set_stop(&DESIGN.short.to_string()).map_err(refused)?;
            prepared.repeats *= length / DESIGN.short;
        }
        let trial = simulate(&prepared, &values, self.question.data, self.question.units, simulated)?;
        Ok((point, trial, prepared.repeats))
    }

    /// Losses of each member in the place of each other, by their columns about one point.
    fn linear(&self, cuts: &mut Cuts<'_>, point: &[f64]) -> Result<Losses, Error> {
        let members = &self.question.members;
        let mut perturbations: Vec<Perturbation> = Vec::new();
        for member in members {
            perturbations.push(cuts.perturbation(
                member.candidate,
                point[member.candidate],
                self.size(member),
            ));
        }
        for (index, x) in point.iter().enumerate() {
            let active = *x != self.list[index].off && !self.list[index].is_discrete();
            if active && members.iter().all(|member| member.candidate != index) {
                perturbations.push(cuts.perturbation(index, *x, 0.0));
            }
        }
        let gram = cuts.reduced(point, &perturbations)?.gram;
        let nuisances: Vec<usize> = (members.len()..perturbations.len()).collect();
        let cleaned = cleaned(&gram, members.len(), &nuisances);
        let sizes: Vec<f64> = members.iter().map(|member| self.size(member)).collect();
        let row = |a: usize| (0..members.len()).map(|b| self.loss(&cleaned, &sizes, a, b)).collect();
        Ok((0..members.len()).map(row).collect())
    }

    /// Loss, in deviance, of member `b` in the place of member `a`, fitted within its range, by their Gram matrix.
    fn loss(&self, gram: &DMatrix<f64>, sizes: &[f64], a: usize, b: usize) -> f64 {
        if a == b {
            return 0.0;
        }
        let candidate = &self.list[self.question.members[b].candidate];
        let (size, aa, ab, bb) = (sizes[a], gram[(a, a)], gram[(a, b)], gram[(b, b)]);
        let wanted = if bb > 0.0 { size * ab / bb } else { 0.0 };
        let range = (candidate.range.0 - candidate.off, candidate.range.1 - candidate.off);
        let within = match candidate.motion {
            Motion::Count { .. } | Motion::Switch => wanted.round(),
            _ => wanted,
        }
        .clamp(range.0.min(0.0), range.1.max(0.0));
        let loss = (size * size * aa - 2.0 * within * size * ab + within * within * bb).max(0.0);
        let pair = [a, b].map(|place| &self.list[self.question.members[place].candidate]);
        allowed(loss, size * size * aa, pair, self.prepared.logs.encoders)
    }
}

/// What a diagnosis will believe of a loss, where images tell a pair apart: it compares these by columns, and no more is known of them in data that
/// are still to be made. With `encoders` rows of a log tell a plant's effect from one of the camera.
fn allowed(loss: f64, strength: f64, pair: [&Candidate; 2], encoders: bool) -> f64 {
    let smooth = |one: &Candidate| !one.is_discrete() && !matches!(one.motion, Motion::Saturation { .. });
    let pictured = |one: &Candidate| one.side == Side::Camera && !one.is(Attribute::ImageDelay);
    let by_images = !encoders || pair.into_iter().all(|one| one.side == Side::Camera);
    let by_columns = by_images && pair.into_iter().all(smooth) && pair.into_iter().any(pictured);
    let bent = pair.into_iter().any(|one| one.nonlinear);
    if by_columns { allowed_loss(loss, 0.0, strength, bent) } else { loss }
}

/// The members' part of a Gram matrix with the other effects projected out.
fn cleaned(gram: &DMatrix<f64>, members: usize, nuisances: &[usize]) -> DMatrix<f64> {
    let own: Vec<usize> = (0..members).collect();
    // an effect that doesn't show here takes nothing away
    let shown: Vec<usize> = nuisances.iter().copied().filter(|place| gram[(*place, *place)] > 0.0).collect();
    let mut left = submatrix(gram, &own);
    let inner = submatrix(gram, &shown);
    for b in 0..members {
        let across = DVector::from_fn(shown.len(), |i, _| gram[(shown[i], b)]);
        let Some(weights) = solve(&inner, &across).filter(|_| !shown.is_empty()) else { continue };
        for a in 0..members {
            left[(a, b)] -=
                shown.iter().zip(weights.iter()).map(|(place, w)| gram[(a, *place)] * w).sum::<f64>();
        }
    }
    left
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::selection::examples::candidate;

    #[test]
    fn value_a_promise_is_what_a_diagnosis_of_images_will_believe() {
        let [lens, exposure, joint] = [(Side::Camera, false), (Side::Camera, true), (Side::Plant, false)]
            .map(|(side, nonlinear)| candidate(side, nonlinear));
        let delay = Candidate { attributes: &[Attribute::ImageDelay], ..lens.clone() };
        let passes = Candidate { motion: Motion::Switch, ..lens.clone() };
        let of = |a: &Candidate, b: &Candidate| allowed(100.0, 1.6e5, [a, b], false);
        // 0.2 of what tells a blur from a delay, and 0.0025 of 400 standard deviations is one
        assert!((of(&delay, &exposure) - 100.0 / 6.0).abs() < 1e-9);
        assert!((of(&lens, &lens) - 50.0).abs() < 1e-9 && of(&joint, &lens) == of(&lens, &lens));
        let logged = |a: &Candidate, b: &Candidate| allowed(100.0, 1.6e5, [a, b], true);
        assert!(logged(&joint, &lens) == 100.0 && logged(&delay, &exposure) == of(&delay, &exposure));
        // rows of a log are no columns of an image, and whole numbers are fitted
        assert_eq!([of(&joint, &joint), of(&joint, &delay), of(&passes, &lens)], [100.0; 3]);
    }
}
