//! The plant log's clock: cleared before anything is named.

use super::compare::{Compared, Part};
use super::policy::PIPELINE;
use crate::diagnosis::Effect;
use crate::error::Notice;
use crate::rigs::acrobot::candidates::Attribute::{Exposure, ImageDelay, Retards};
use crate::rigs::acrobot::candidates::{Candidate, Side, place};
use crate::rigs::acrobot::dataset::{DataSet, Run};
use crate::rigs::acrobot::model::Model;
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::selection::{Alternative, CLASS, steadiness};
use crate::statistics::levels::CERTAIN;
use crate::statistics::squares;

/// The plant log's clock, s late, that explains what the image alone would have called a delay: logs of plant and torque know
/// their clock to some ten microseconds only, an image its delay to some microseconds.
fn clock_instead(list: &[Candidate], compared: &Compared) -> Option<f64> {
    let Compared { parts, point, .. } = compared;
    let clock = own_clock(list)?;
    let delay = place(list, ImageDelay).filter(|index| list[*index].side == Side::Camera)?;
    let plant = parts.iter().find(|part| part.torque && part.study.seen.contains(&clock))?;
    let (by, error) =
        parts.iter().filter(|part| !part.torque).find_map(|part| seen_late(part, list, delay))?;
    let (shift, blurred, alone) = lateness(plant, list, clock)?;
    let misses = (by + shift).abs() / error.hypot(blurred);
    if blurred > PIPELINE.blurred * alone || misses > PIPELINE.misses {
        return None;
    }
    let weights = (error.powi(-2), blurred.powi(-2));
    Some(point[clock] + (shift * weights.1 - by * weights.0) / (weights.0 + weights.1))
}

/// Whether images come after the plant's log by as much as that was found to be late: both at once would be two faults of one size, where one
/// does, an actuator that is late by it.
pub(super) fn is_the_actuators(list: &[Candidate], compared: &Compared) -> bool {
    let delay = place(list, ImageDelay).filter(|index| list[*index].side == Side::Camera);
    let (Some(clock), Some(delay)) = (own_clock(list), delay) else { return false };
    let (late, behind) = (compared.point[clock], compared.point[delay] - list[delay].off);
    late > 0.0 && (behind - late).abs() < PIPELINE.same + PIPELINE.close * late
}

/// Where the clock of the plant's log stands in the list.
fn own_clock(list: &[Candidate]) -> Option<usize> {
    list.iter().position(|candidate| candidate.side == Side::Clock)
}

/// By how much an image is late, s, and the standard error of that.
fn seen_late(part: &Part, list: &[Candidate], delay: usize) -> Option<(f64, f64)> {
    let late = |other: &&Alternative| other.candidate == delay && other.loss < CLASS;
    let (effect, by) = part.classes.iter().find_map(|(effect, class)| {
        let own = list[*effect].is(ImageDelay) || list[*effect].is(Exposure);
        let by = class.iter().find(late).map(|other| other.x - list[delay].off);
        own.then_some((*effect, by?))
    })?;
    let last = &part.study.last;
    let free = part.study.continuous(list);
    let place = free.iter().position(|index| *index == effect)?;
    let error = last.covariance(&free)?[(place, place)].sqrt();
    // an exposure is late by half of itself: the same share of the effect's size, whatever its name
    let share = error / (last.point[effect] - list[effect].off).abs();
    Some((by, share * by.abs()))
}

/// How much later the plant's log wants its clock still, s, with the standard errors of that beside what was found and alone.
fn lateness(part: &Part, list: &[Candidate], clock: usize) -> Option<(f64, f64, f64)> {
    let last = &part.study.last;
    let others = part.study.active.iter().copied().filter(|index| *index != clock);
    let mut free: Vec<usize> = others.filter(|index| !list[*index].is_discrete()).collect();
    let alone = last.covariance(&[clock])?[(0, 0)].sqrt();
    free.insert(0, clock);
    Some((last.newton_step(&free)?[0], last.covariance(&free)?[(0, 0)].sqrt(), alone))
}

/// What the clock leaves in doubt of a delay and of an exposure beside their own errors: candidates, and standard deviations of
/// their x. Without a torque that is logged beside the angles there is no clock, and with an actuator's delay nobody knows it.
pub(super) fn doubts_by_clock(model: &Model, list: &[Candidate], parts: &[Part]) -> Vec<(usize, f64)> {
    if let Some(timestamps) = list.iter().position(|candidate| candidate.side == Side::Timestamps) {
        // the images' clock is free, so that of an exposure its blur alone is known
        let seen = parts.iter().find(|part| part.study.seen.contains(&timestamps));
        let beside =
            |exposure: usize| seen?.study.last.covariance(&[exposure, timestamps])?.get((0, 0)).copied();
        let doubt = place(list, Exposure).and_then(|index| Some((index, beside(index)?.sqrt())));
        return doubt.into_iter().collect();
    }
    let unsure = own_clock(list).and_then(|clock| {
        let plant = parts.iter().find(|part| part.torque && part.study.seen.contains(&clock))?;
        lateness(plant, list, clock).filter(|(_, blurred, alone)| *blurred <= PIPELINE.blurred * alone)
    });
    let Some((shift, error, _)) = unsure else { return Vec::new() };
    // an offset that shows, but not clearly enough to be taken, may be there
    let error = error.max(shift.abs());
    let twice = 2.0 * model.frame_rate();
    let of = |attribute, each: f64| place(list, attribute).map(|index| (index, each * error));
    [of(ImageDelay, 1.0), of(Exposure, twice)].into_iter().flatten().collect()
}

/// What is told beside an actuator's delay whose log has a clock that nothing else tells of: the two are one reading each of the same data.
pub(super) fn late_log_instead(list: &[Candidate], parts: &[Part], effects: &[Effect]) -> Option<Notice> {
    let clock = own_clock(list)?;
    let plant = parts.iter().find(|part| part.torque && part.study.seen.contains(&clock))?;
    let unknown =
        lateness(plant, list, clock).is_none_or(|(_, error, alone)| error > PIPELINE.blurred * alone);
    let find = |index: usize| effects.iter().find(|effect| effect.name == list[index].name);
    let actuator = (0..list.len()).filter(|index| list[*index].is(Retards)).find_map(find);
    let actuator = actuator.filter(|_| unknown)?;
    let ms = |time: f64| 1e3 * time;
    let late = ms(actuator.value);
    // images, too, come that much later after what the motor was told then
    let delay = place(list, ImageDelay).filter(|_| parts.iter().any(|part| !part.torque));
    let camera = delay.map(|index| {
        let own = ms(find(index).map_or(list[index].value(list[index].off), |effect| effect.value));
        format!(", and {} is {:.2} ms, not {own:.2}", list[index].name, own + late)
    });
    let message = format!(
        "a log whose timestamps are {late:.2} ms late looks the same as {0}: if its clock is off by that, there is no {0}{1}",
        actuator.name,
        camera.unwrap_or_default()
    );
    Some(Notice { file: "plant.csv".into(), line: 0, message })
}

/// By how much the plant's logs were set back, s.
pub(super) struct Clocks {
    /// The time that is the same for all runs, s.
    common: f64,
    /// The time that is each run's own, s.
    own: Vec<f64>,
    /// The time that is left, found beside all else, s.
    left: f64,
    /// Names of the runs that have such a log.
    names: Vec<Option<String>>,
    rounds: usize,
}

impl Clocks {
    /// No log was set back yet.
    pub(super) fn new(data: &DataSet) -> Self {
        let name = |run: &Run| run.plant.as_ref().map(|_| run.name.clone());
        let names = data.runs.iter().map(name).collect();
        Self { common: 0.0, own: vec![0.0; data.runs.len()], left: 0.0, names, rounds: 0 }
    }

    /// Runs and the time by which their logs are late still, before anything else can be said.
    pub(super) fn find_late(&mut self, list: &[Candidate], compared: &Compared) -> Option<Vec<(usize, f64)>> {
        self.rounds += 1;
        if self.rounds > PIPELINE.rounds {
            return None;
        }
        if let Some(late) = lateness_by_run(list, compared) {
            late.iter().for_each(|(run, late)| self.own[*run] += late);
            return Some(late);
        }
        let late = clock_instead(list, compared)?;
        self.common += late;
        Some((0..self.own.len()).map(|run| (run, late)).collect())
    }

    /// Takes clocks that are off out of what is named. A plant log that is stamped late makes the actuator look slow and the
    /// camera early by the same time; a delay of either does only one of both.
    pub(super) fn remove_from_effects(
        &mut self,
        model: &Model,
        list: &[Candidate],
        compared: &mut Compared,
    ) -> Vec<Notice> {
        let Compared { parts, point, .. } = compared;
        let mut gone = Vec::new();
        let mut late = 0.0;
        if let Some(clock) = own_clock(list).filter(|index| point[*index] != 0.0) {
            late = point[clock];
            gone.push(clock);
        }
        if let Some(timestamps) = list.iter().position(|candidate| candidate.side == Side::Timestamps) {
            gone.push(timestamps);
        }
        if let Some((shown, by)) = early_images(list, point) {
            // one that was found, that is: nothing is the same as a clock that is off by less than `same`
            let found = |index: &usize| point[*index] != list[*index].off;
            let same = |index: &usize| {
                found(index) && (point[*index] - by).abs() < PIPELINE.same + PIPELINE.close * by
            };
            let actuator = (0..list.len()).find(|index| list[*index].is(Retards) && same(index));
            late = if late == 0.0 { by } else { late };
            gone.push(shown);
            gone.extend(actuator);
        }
        // what is no larger than the clock may be off
        let within = |(index, error): &(usize, f64)| {
            (point[*index] - list[*index].off).abs() < PIPELINE.doubted * error
        };
        gone.extend(
            doubts_by_clock(model, list, parts).iter().filter(|doubt| within(doubt)).map(|doubt| doubt.0),
        );
        for index in &gone {
            point[*index] = list[*index].off;
        }
        for part in parts {
            part.classes.retain(|(index, _)| !gone.contains(index));
        }
        self.left = late;
        self.notices(self.common + late)
    }

    /// What was done before all else, in words.
    pub(super) fn story(&self) -> Option<String> {
        let late = self.own.iter().zip(&self.names).filter(|(_, name)| name.is_some());
        let late: Vec<f64> = late.map(|(own, _)| 1e3 * (self.common + own)).collect();
        let told = late.iter().map(|late| format!("{late:.2}")).collect::<Vec<_>>().join(", ");
        let more = match 1e3 * self.left {
            0.0 => String::new(),
            left => format!(" What was left of that, {left:.2} ms, was found beside all else."),
        };
        let back = late.iter().any(|late| *late != 0.0);
        back.then(|| {
            format!("First the plant's logs were set back to the other logs' clock, run by run by {told} ms.{more}")
        })
    }

    /// Whether runs have clocks of their own.
    pub(super) fn differ_by_run(&self) -> bool {
        self.own.iter().any(|late| *late != 0.0)
    }

    /// Says of each log by how much its clock was off; `common` is what is the same for all runs, s.
    fn notices(&self, common: f64) -> Vec<Notice> {
        let notice = |file: String, late: f64| {
            let message = format!(
                "timestamps are {:.2} ms late against the other logs: taken as its clock, not as an effect",
                1e3 * late
            );
            Notice { file, line: 0, message }
        };
        if self.differ_by_run() {
            let runs = self.names.iter().zip(&self.own);
            let told = |(name, own): (&Option<String>, &f64)| {
                name.as_ref().map(|name| notice(format!("{name}/plant.csv"), common + own))
            };
            return runs.filter_map(told).collect();
        }
        if common == 0.0 { Vec::new() } else { vec![notice("plant.csv".into(), common)] }
    }
}

/// Runs whose logs have clocks of their own, and by how much they are late against all: where that explains more than
/// any effect, and clearly more than one clock for all.
fn lateness_by_run(list: &[Candidate], compared: &Compared) -> Option<Vec<(usize, f64)>> {
    let clock = own_clock(list)?;
    let of_log = |index: usize| list[index].side.is_of_log();
    let study = &compared.parts.iter().find(|part| part.torque && part.study.seen.contains(&clock))?.study;
    if study.discrepancy_dominated {
        return None;
    }
    let open = study.screen.hits.iter().filter(|hit| !of_log(hit.candidate));
    let best = open.map(|hit| hit.gain).fold(0.0, f64::max);
    // what was found may have stood for the clocks
    let total = &study.nominal.total;
    let gains = (study.nominal.perturbations.iter().enumerate())
        .filter(|(_, perturbation)| !of_log(perturbation.candidate))
        .map(|(column, _)| total.score[column].powi(2) / total.gram[(column, column)].max(f64::MIN_POSITIVE));
    let evaluations =
        [(&study.last, study.active.as_slice(), best), (&study.nominal, &[], gains.fold(0.0, f64::max))];
    evaluations.into_iter().find_map(|(evaluation, active, best)| {
        let clocks = steadiness(evaluation, clock, active)?;
        // each run more wants a time of its own by chance, too
        let more = clocks.runs.len().saturating_sub(1) as f64;
        let clear = clocks.apart > runs_apart(more) && clocks.decrease - more > best + POLICY.clock_behind;
        clear.then(|| clocks.runs.iter().map(|(run, (late, _))| (*run, late - clocks.mean)).collect())
    })
}

/// Decrease of the deviance that times of their own of so many runs more than one must bring.
fn runs_apart(more: f64) -> f64 {
    POLICY.runs_apart.max(squares::as_rare_as(CERTAIN, more.max(1.0)))
}

/// The delay by which images come early, and by how much, s: below zero there is none.
fn early_images(list: &[Candidate], point: &[f64]) -> Option<(usize, f64)> {
    let delay = place(list, ImageDelay).filter(|index| list[*index].side == Side::Camera)?;
    (point[delay] < 0.0).then(|| (delay, -point[delay]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_each_run_more_differs_by_chance_too() {
        // of thirty runs 29 times of their own gain 29 by chance alone, and more than 77 once in 300 000
        assert_eq!([0.0, 1.0, 2.0].map(runs_apart), [POLICY.runs_apart; 3]);
        assert!((runs_apart(29.0) - 77.0).abs() < 0.5, "{}", runs_apart(29.0));
    }
}
