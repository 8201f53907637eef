//! Laws that no candidate gives, of a torque or of what an angle reads: each is held against what linked states leave, beside all that is
//! listed (a score test).
//!
//! Windows begin too free to tell: a cable's spring leaves them nothing that a gain and a bias don't take.

use super::lone_readings::{LoneReadings, lone_readings};
use super::periods::periodic_laws;
use super::problem::{MOTION, TORQUES};
use super::{Linked, LinkedFit, is_quiet};
use crate::dynamics::grid::Grid;
use crate::dynamics::machine::Role;
use crate::error::Error;
use crate::infer::fit::{Fit, Linearise};
use crate::infer::likelihood::{maximise, reduced};
use crate::infer::linearised::Follows;
use crate::infer::{Linearised, Noise, Sizes};
use crate::nuisance::least_gap;
use crate::observe::InputEffect;
use crate::rigs::acrobot::candidates::{Candidate, Motion};
use crate::rigs::acrobot::dataset::DataSet;
use crate::rigs::acrobot::model::Model;
use crate::rigs::acrobot::residual::Signal;
use crate::rigs::acrobot::selection::Study;
use crate::rigs::acrobot::simple_laws::{Law, Moment, On, all_laws};
use crate::statistics::levels::{DOUBTED, FEW, FINE, HALF};
use crate::statistics::linear::Reduced;
use std::sync::Arc;

/// The law that is told most surely.
pub struct UnlistedLaw {
    /// What it acts on.
    pub on: On,
    /// The law.
    pub law: Law,
    /// By how many standard deviations it is told.
    pub deviations: f64,
    /// The share of the process noise's variance that it takes away.
    pub share: f64,
    /// The model follows the log without process noise.
    pub quiet: bool,
    /// By how many standard deviations the dry friction is told that is on; 0 without any.
    pub friction: f64,
}

/// What linked states leave that has no name.
#[derive(Default)]
pub struct Left {
    /// The law that is told most surely.
    pub law: Option<UnlistedLaw>,
    /// Readings that lie far off.
    pub lone: Option<LoneReadings>,
}

/// What the plant's logs leave beside the study's effects and whatever else is listed. What is `known` of the same logs is taken where the study
/// stands there. `readings`: angles were read by encoders, which have laws of their own.
///
/// # Errors
/// The log can't be linked: a unit failed, or the fit comes to no end.
pub fn left_of(
    data: &DataSet,
    model: &Model,
    list: &Arc<Vec<Candidate>>,
    (study, signals): (&Study, &[Signal]),
    known: Option<&LinkedFit>,
    readings: bool,
) -> Result<Left, Error> {
    let linked;
    let LinkedFit { linked, fit, .. } = match known.filter(|known| known.is_of(study)) {
        Some(known) => known,
        None => {
            linked = LinkedFit::of(data, model, list, (study, signals))?;
            let Some(linked) = &linked else { return Ok(Left::default()) };
            linked
        }
    };
    let laws = Laws::of(linked, list, fit, readings)?;
    let friction = linked.friction(&study.active, fit);
    let law = laws.and_then(|laws| laws.surest(fit, &linked.built.sizes, friction));
    let lone = if readings { lone_readings(&fit.runs, &fit.at.noise, linked.angles()) } else { None };
    Ok(Left { law, lone })
}

/// Runs about where a fit ended, with columns for what laws are held against, the effects that are on or all that is listed, and for each law.
struct Laws {
    laws: Vec<(On, Law)>,
    runs: Vec<Linearised>,
    /// Those of the first columns that are free parameters of the fit.
    active: Vec<usize>,
    /// How many columns come before those of laws.
    listed: usize,
}

impl Laws {
    /// All laws beside all that is listed; `None` where none explains anything beside the effects that are on, which takes far fewer
    /// columns to see.
    fn of(linked: &Linked, list: &[Candidate], fit: &Fit, readings: bool) -> Result<Option<Self>, Error> {
        let angles = linked.angles();
        let quanta = angles.map(|angle| angle.map_or(0.0, |channel| linked.quantum(channel)));
        let all = |beside: &[Beside<'_>]| {
            let waves = periodic_laws(beside, &fit.at.noise.process, readings.then_some(quanta));
            all_laws(readings).into_iter().chain(waves).collect()
        };
        let Some(alone) = Self::beside(linked, fit, &fit.free, all)? else { return Ok(None) };
        if !may_be_told(&alone.told(fit)) {
            return Ok(None);
        }
        let listed = |(index, candidate): (usize, &Candidate)| {
            let place = linked.places[index]?;
            // what cuts nothing shows nothing
            let cuts = matches!(candidate.motion, Motion::Saturation { .. });
            (!candidate.is_discrete() && !cuts || fit.free.contains(&place)).then_some(place)
        };
        let listed: Vec<usize> = list.iter().enumerate().filter_map(listed).collect();
        Self::beside(linked, fit, &listed, |_| alone.laws.clone())
    }

    /// Laws beside these parameters; `None` where there is no torque that they could be of.
    fn beside(
        linked: &Linked,
        fit: &Fit,
        parameters: &[usize],
        laws: impl Fn(&[Beside<'_>]) -> Vec<(On, Law)>,
    ) -> Result<Option<Self>, Error> {
        let [joint, first] = TORQUES.map(|input| linked.bias_of(input));
        let Some(pushes) = first.zip(joint).map(|(first, joint)| [first, joint]) else { return Ok(None) };
        let (commands, angles, listed) = (linked.commands(), linked.angles(), parameters.len());
        let columns = [parameters, &pushes].concat();
        let runs = linked.built.engine.linearise(&fit.at.theta, &fit.at.paths, &columns)?;
        let each = runs.iter().zip(&fit.at.paths).zip(&commands).enumerate();
        let beside = each.map(|(place, ((run, path), commands))| Beside {
            run,
            place,
            path,
            commands,
            angles: &angles,
            listed,
        });
        let beside: Vec<Beside<'_>> = beside.collect();
        let laws = laws(&beside);
        let runs = beside.iter().map(|beside| beside.with_laws(&laws)).collect();
        let active = (0..listed).filter(|place| fit.free.contains(&parameters[*place])).collect();
        Ok(Some(Self { laws, runs, active, listed }))
    }

    /// How surely each law is told.
    fn told(&self, fit: &Fit) -> Vec<(usize, f64)> {
        let columns: Vec<usize> = (0..self.listed + self.laws.len()).collect();
        let sum = reduced(&self.runs, &fit.at.noise, &columns);
        let told = Told::new(&sum, &self.active, self.listed);
        let of = |law: usize| (law, told.deviations(self.listed + law, self.laws[law].1.by_choice()));
        (0..self.laws.len()).map(of).collect()
    }

    /// The law that is told most surely: of the few that are, the one beside which the least deviance is left.
    fn surest(&self, fit: &Fit, sizes: &Sizes, friction: f64) -> Option<UnlistedLaw> {
        let mut told = self.told(fit);
        told.sort_by(|a, b| b.1.total_cmp(&a.1));
        let with = |(law, deviations): &(usize, f64)| {
            let columns: Vec<usize> = self.active.iter().copied().chain([self.listed + law]).collect();
            let (noise, deviance) = maximise(&self.runs, &columns, &fit.at.noise, sizes);
            (deviance, *law, *deviations, noise)
        };
        let all = told.iter().take(FEW).map(with);
        let (_, law, deviations, noise) = all.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let variance = |noise: &Noise| noise.process.iter().map(|size| size * size).sum::<f64>();
        let share = 1.0 - variance(&noise) / variance(&fit.at.noise);
        let (on, law) = self.laws[law].clone();
        Some(UnlistedLaw { on, law, deviations, share, quiet: is_quiet(fit, sizes), friction })
    }
}

/// Whether any law may be told beside all that is listed: beside the effects that are on alone, one is beyond chance. What had less there had
/// 3.9 at most beside all, on 107 sets; what had enough beside all had 3.5 at least there.
fn may_be_told(told: &[(usize, f64)]) -> bool {
    told.iter().any(|(_, deviations)| *deviations > DOUBTED)
}

/// How surely a law is told.
struct Told<'a> {
    sum: &'a Reduced,
    /// Columns of the effects that are on.
    active: &'a [usize],
    /// Columns of all that is listed.
    listed: Vec<usize>,
    /// Decrease of the squares by the best of the listed ones that are not on.
    best: f64,
}

impl<'a> Told<'a> {
    fn new(sum: &'a Reduced, active: &'a [usize], listed: usize) -> Self {
        let others = (0..listed).filter(|column| !active.contains(column));
        let best = others.filter_map(|column| gain(sum, active, column)).fold(0.0, f64::max);
        Self { sum, active, listed: (0..listed).collect(), best }
    }

    /// Standard deviations of a column beside all that is listed, or what it explains beside the effects that are on beyond the best of the
    /// list: a law that all of them together stand for is still the simpler story. Deviance that comes `by_choice` doesn't count.
    fn deviations(&self, column: usize, by_choice: f64) -> f64 {
        let all = gain(self.sum, &self.listed, column).unwrap_or(0.0);
        let beyond = gain(self.sum, self.active, column).unwrap_or(0.0) - self.best;
        (all.max(beyond) - by_choice).max(0.0).sqrt()
    }
}

/// Decrease of the squares that a column brings beside others; nothing where it is one of them, as far as columns of laws are good: to the bend
/// of a motion within an interval.
fn gain(sum: &Reduced, beside: &[usize], column: usize) -> Option<f64> {
    let known = |place: usize| sum.gram[(place, place)];
    let own: Vec<usize> = beside.iter().copied().filter(|place| known(*place) > 0.0).collect();
    let (length, score) = sum.beside(&own, column)?;
    (length > FINE * known(column)).then(|| score * score / length)
}

/// A run with what laws depend on.
pub(super) struct Beside<'a> {
    pub(super) run: &'a Linearised,
    /// Its place among the runs.
    pub(super) place: usize,
    path: &'a [f64],
    /// The commanded torque in each interval.
    commands: &'a [f64],
    /// The channels of the angles.
    pub(super) angles: &'a [Option<usize>],
    /// How many columns are listed; those of a constant torque on either link stand behind them.
    listed: usize,
}

impl Beside<'_> {
    /// The middle of an interval.
    pub(super) fn middle(&self, row: usize) -> Moment {
        let (from, to) = (self.row(row), self.row(row + 1));
        let state = std::array::from_fn(|state| HALF * (from.state[state] + to.state[state]));
        Moment { run: self.place, state, time: HALF * (from.time + to.time), tau: self.commands[row] }
    }

    /// What a constant torque on a link does in an interval.
    pub(super) fn push(&self, row: usize, link: usize) -> &[f64] {
        self.run.column(row, self.listed + link)
    }

    /// A row, with the torque that led there.
    pub(super) fn row(&self, row: usize) -> Moment {
        // what an actuator remembers is a state of the run, and none of the path
        let states = self.path.len() / self.run.rows();
        let state = std::array::from_fn(|state| self.path[row * states + state]);
        let tau = self.commands.get(row.saturating_sub(1)).copied().unwrap_or(0.0);
        Moment { run: self.place, state, time: self.run.time[row], tau }
    }

    /// The run with the listed columns and one for each law. A torque's is what a constant torque does in an interval, times the law there; the
    /// columns of the two constant torques stand behind the listed ones.
    fn with_laws(&self, laws: &[(On, Law)]) -> Linearised {
        let (run, n, listed) = (self.run, self.run.states, self.listed);
        let parameters = listed + laws.len();
        let (mut drive, mut direct) = (Vec::new(), Vec::new());
        for row in 0..run.rows() {
            let at = self.row(row);
            for value in run.values(row) {
                let first = value * run.parameters;
                direct.extend_from_slice(&run.direct[first..first + listed]);
                let reads = |angle: usize| self.angles[angle] == Some(run.measured[value].channel);
                direct.extend(laws.iter().map(|(on, law)| match on {
                    On::Reading(angle) if reads(*angle) => law.value(&at),
                    _ => 0.0,
                }));
            }
            if row + 1 == run.rows() {
                break;
            }
            let at = self.middle(row);
            (0..listed).for_each(|column| drive.extend_from_slice(run.column(row, column)));
            for (on, law) in laws {
                match on {
                    On::Torque(link) => {
                        let size = law.value(&at);
                        drive.extend(self.push(row, *link).iter().map(|push| size * push));
                    }
                    On::Reading(_) => drive.resize(drive.len() + n, 0.0),
                }
            }
        }
        let follows = run.follows.iter().map(|known| {
            let none = std::iter::repeat_n(0.0, laws.len());
            Follows { direct: known.direct[..listed].iter().copied().chain(none).collect(), ..known.clone() }
        });
        Linearised { parameters, drive, direct, follows: follows.collect(), ..run.clone() }
    }
}

impl Linked {
    /// The parameter that is a constant torque at one of the inputs.
    fn bias_of(&self, name: &str) -> Option<usize> {
        let input = self.input(name)?;
        let own = |role: Role| matches!(role, Role::Input(place, InputEffect::Bias) if place == input);
        self.built.engine.machine.parameters.iter().position(|one| own(one.role))
    }

    /// By how many standard deviations the dry friction is told that is on: the strongest.
    fn friction(&self, active: &[usize], fit: &Fit) -> f64 {
        let sticks = active.iter().filter(|index| self.list[**index].sticks());
        let told = |place: usize| (fit.at.theta[place] - self.nominal[place]).abs() / fit.deviation(place);
        sticks.filter_map(|index| self.places[*index]).map(told).fold(0.0, f64::max)
    }

    /// The commanded torque in the middle of each interval of each run.
    fn commands(&self) -> Vec<Vec<f64>> {
        let input = self.input(TORQUES[0]);
        let of = |grid: &Grid| {
            let course = input.and_then(|input| grid.inputs.get(input));
            let middles = grid.time.windows(2).map(|pair| HALF * (pair[0] + pair[1]));
            middles.map(|time| course.map_or(0.0, |course| course.value(time))).collect()
        };
        self.built.engine.grids.iter().map(of).collect()
    }

    /// The channels that show the two angles.
    fn angles(&self) -> [Option<usize>; 2] {
        let machine = &self.built.engine.machine;
        [0, 1].map(|angle| {
            machine.channels.iter().position(|own| own.name == format!("plant.{}", MOTION[angle].0))
        })
    }

    /// What a log rounds a channel to.
    fn quantum(&self, channel: usize) -> f64 {
        let samples = self.built.engine.grids.iter().flat_map(|grid| &grid.samples);
        let own = samples.filter(|sample| sample.channel == channel).map(|sample| sample.value);
        least_gap(&own.collect::<Vec<_>>())
    }

    /// The place of an input of the plant.
    fn input(&self, name: &str) -> Option<usize> {
        self.built.engine.machine.inputs.iter().position(|own| own.name == format!("plant.{name}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    /// The sums of columns of length 1, of which this is the gram matrix, and of a residual that the last one explains by so many standard
    /// deviations.
    fn sums(gram: DMatrix<f64>, deviations: f64) -> Reduced {
        let last = gram.ncols() - 1;
        let score = gram.column(last) * deviations;
        Reduced { square: deviations * deviations, score, gram, freedom: 100.0, log_det: 0.0 }
    }

    #[test]
    fn value_a_law_that_listed_ones_stand_for_together_counts_for_what_it_explains_beyond_the_best() {
        let half = 0.5_f64.sqrt();
        let gram = DMatrix::from_row_slice(3, 3, &[1.0, 0.0, half, 0.0, 1.0, half, half, half, 1.0]);
        let sum = sums(gram, 6.0);
        // each of the two explains half of 36
        assert!((Told::new(&sum, &[], 2).deviations(2, 0.0) - 18_f64.sqrt()).abs() < 1e-9);
        // beside one of them half is left, which the other one explains
        assert!(Told::new(&sum, &[0], 2).deviations(2, 0.0) < 1e-6);
    }

    #[test]
    fn value_a_law_that_no_listed_one_resembles_counts_for_all_of_it() {
        let told =
            |listed: usize| Told::new(&sums(DMatrix::identity(3, 3), 6.0), &[], listed).deviations(2, 0.0);
        assert!((told(2) - 6.0).abs() < 1e-9);
        // and one that is listed itself for nothing
        assert_eq!(told(3), 0.0);
    }

    #[test]
    fn value_more_columns_are_taken_from_three_deviations_on() {
        assert_eq!([2.9, 3.1].map(|most| may_be_told(&[(0, 1.0), (1, most)])), [false, true]);
    }

    #[test]
    fn every_law_has_words_of_its_own() {
        for readings in [false, true] {
            let laws = all_laws(readings);
            let known: std::collections::BTreeSet<_> =
                laws.iter().map(|(on, law)| (on.signal(), law.words.clone())).collect();
            assert_eq!(known.len(), laws.len());
        }
    }
}
