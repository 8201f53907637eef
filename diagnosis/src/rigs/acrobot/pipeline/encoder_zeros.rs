//! The zeros of the encoders: how a sensor was set up is no part of the machine. What is off is found, told, and cleared.

use super::compare::{Compared, Part, add_classes};
use super::policy::PIPELINE;
use crate::error::{Error, Notice};
use crate::rigs::acrobot::candidates::{Attribute, Candidate, Side};
use crate::rigs::acrobot::dataset::DataSet;
use crate::rigs::acrobot::gap::chained;
use crate::rigs::acrobot::residual::Tracked;
use crate::rigs::acrobot::residual::plant::{PlantCut, zeros};
use crate::rigs::acrobot::selection::policy::SELECTION;
use crate::rigs::acrobot::selection::{CLASS, Study, study};
use crate::statistics::linear::submatrix;
use crate::watch::{Known, Watch};

/// Places of the zeros in the list.
fn places(list: &[Candidate]) -> impl Iterator<Item = usize> {
    (0..list.len()).filter(|index| list[*index].side == Side::Zero)
}

/// Whether a zero does to the logs nearly what a found effect does.
fn resembles(study: &Study, zero: usize, effect: usize) -> bool {
    let gram = submatrix(&study.last.total.gram, &study.last.places(&[zero, effect]));
    gram.nrows() == 2 && gram[(0, 1)].abs() > SELECTION.trials_alike * (gram[(0, 0)] * gram[(1, 1)]).sqrt()
}

/// By how much the plant's logs were turned back, where pictures may say of the zeros what the plant can't: where it found one, or an
/// effect that a zero resembles. A plant in which nothing is missing knows its zeros better than pictures do.
pub(super) fn doubted_zeros(parts: &[Part], list: &[Candidate], point: &[f64]) -> Option<[f64; 2]> {
    let study = &parts.iter().find(|part| part.torque)?.study;
    let in_doubt = |index: &usize| {
        let own = list[*index].side == Side::Zero;
        own || !list[*index].side.is_of_log() && places(list).any(|zero| resembles(study, zero, *index))
    };
    let doubted = !study.discrepancy_dominated && study.active.iter().any(in_doubt);
    doubted.then(|| zeros(list, point, None))
}

/// An effect that the zero of one encoder explains as well, with as many numbers, so that these logs say of either only that it may be so.
pub(super) struct Shared {
    pub(super) effect: usize,
    /// The zero.
    zero: usize,
    /// By how much it would be off, rad.
    off: f64,
    /// The share of its certainty that the effect keeps.
    pub(super) share: f64,
}

/// Puts zeros in the place of effects that the logs can't tell from them. Where the ground lies is seen by no encoder but as angles that
/// are off, and encoders that are set by eye are off by as much: so ground gives way to zeros that fit nearly as well. But where that
/// takes as many numbers, nothing says which: then both are told.
pub(super) fn weigh_zeros(
    rows: &mut Tracked<PlantCut>,
    list: &[Candidate],
    mut part: Part,
    watch: &mut Watch<'_>,
) -> Result<Part, Error> {
    let found = part.study.active.clone();
    let (on, off): (Vec<usize>, Vec<usize>) = places(list).partition(|zero| found.contains(zero));
    let instead = replaceable(list, &part, on.len(), &off);
    if instead.is_empty() {
        return Ok(part);
    }
    let own = settle_anew(rows, list, &part.study.last.point, &found, watch)?;
    for (effects, allowed) in &instead {
        let others = found.iter().copied().filter(|index| !effects.contains(index));
        let known: Vec<usize> = others.chain(off.iter().copied()).collect();
        let mut there = part.study.last.point.clone();
        effects.iter().for_each(|effect| there[*effect] = list[*effect].off);
        let study = settle_anew(rows, list, &there, &known, watch)?;
        let study = settle_anew(rows, list, &study.last.point, &study.active, watch)?;
        let loss = study.last.under(&own.last).deviance() - own.last.deviance();
        let gone = effects.iter().all(|effect| !study.active.contains(effect));
        if loss >= *allowed
            || !gone
            || effects_of_machine(list, &study.active).count() >= effects_of_machine(list, &found).count()
        {
            continue;
        }
        let taken: Vec<usize> = off.iter().copied().filter(|zero| study.active.contains(zero)).collect();
        match (effects.as_slice(), taken.as_slice(), on.is_empty()) {
            ([effect], [zero], true) => {
                let share = 1.0 / (1.0 + libm::exp(-0.5 * loss));
                let off = study.last.point[*zero];
                part.shared.push(Shared { effect: *effect, zero: *zero, off, share });
            }
            _ => {
                return add_classes(rows, list, study, true, watch)
                    .map(|zeros| Part { coarse: part.coarse, ..zeros });
            }
        }
    }
    rows.reset();
    rows.linearise(&part.study.last.point, &[])?;
    Ok(part)
}

/// Effects that zeros are tried in the place of, and what they may lose there: the ground, by each of its effects. Of what a zero
/// resembles otherwise, one gives way where a zero is off already, and two give way to two that fit no worse.
fn replaceable(list: &[Candidate], part: &Part, on: usize, off: &[usize]) -> Vec<(Vec<usize>, f64)> {
    let found = &part.study.active;
    let like = |index: &usize| off.iter().any(|zero| resembles(&part.study, *zero, *index));
    let ground: Vec<usize> =
        effects_of_machine(list, found).filter(|index| list[*index].is(Attribute::Ground)).collect();
    let alike: Vec<usize> = effects_of_machine(list, found).filter(like).collect();
    let mut instead = Vec::new();
    if !ground.is_empty() && !off.is_empty() {
        instead.push((ground.clone(), CLASS * ground.len() as f64));
    }
    match (on, alike.len()) {
        (1, _) => instead.extend(alike.iter().map(|one| (vec![*one], CLASS))),
        (0, 2) if alike != ground => instead.push((alike, PIPELINE.first)),
        _ => {}
    }
    instead
}

/// The active candidates that are effects of the machine, and no faults of a log.
fn effects_of_machine<'a>(list: &'a [Candidate], active: &'a [usize]) -> impl Iterator<Item = usize> + 'a {
    active.iter().copied().filter(|index| !list[*index].side.is_of_log())
}

/// What is on, settled from a point without what windows have come to on their way there: where an arm sticks, that weighs more than a
/// zero against the ground. No other candidate takes a place, or the same would be compared twice.
fn settle_anew(
    rows: &mut Tracked<PlantCut>,
    list: &[Candidate],
    point: &[f64],
    active: &[usize],
    watch: &mut Watch<'_>,
) -> Result<Study, Error> {
    let before = watch.known().cloned();
    watch.begin_from(Some(Known { point: point.to_vec(), active: active.to_vec(), by_torques: false }));
    rows.reset();
    let study = study(rows, list, point, active, watch);
    watch.begin_from(before);
    study
}

/// By how much the zeros of the plant's logs were found to be off.
#[derive(Default)]
pub(super) struct Zeros {
    /// What was taken off the logs, rad.
    turned: [f64; 2],
    rounds: usize,
}

impl Zeros {
    /// How far pictures say that the logs' angles are off still.
    pub(super) fn seen_in_images(&mut self, list: &[Candidate], compared: &Compared) -> Option<[f64; 2]> {
        self.rounds += 1;
        // where images alone tell the angles, no log is off
        let pictured = compared.parts.iter().filter(|part| !part.torque && !chained(&part.signals));
        let found = pictured.flat_map(|part| &part.study.active).any(|index| list[*index].side == Side::Zero);
        (found && self.rounds <= PIPELINE.rounds).then(|| zeros(list, &compared.point, None))
    }

    /// Takes them off the logs.
    pub(super) fn turn_back(&mut self, data: &mut DataSet, by: [f64; 2]) {
        (0..2).for_each(|angle| self.turned[angle] += by[angle]);
        data.turn_back(by);
    }

    /// Takes zeros that are off out of what is named. Of encoders they are told; of circles they are what has no name.
    pub(super) fn remove_from_effects(&self, list: &[Candidate], compared: &mut Compared) -> Vec<Notice> {
        let Compared { parts, point, .. } = compared;
        let of_circles = parts.iter().any(|part| chained(&part.signals));
        let left = if of_circles { [0.0; 2] } else { zeros(list, point, None) };
        for index in places(list).filter(|index| point[*index] != 0.0).collect::<Vec<_>>() {
            point[index] = 0.0;
            parts.iter_mut().for_each(|part| part.classes.retain(|(other, _)| *other != index));
        }
        let off = ["q1", "q2"].into_iter().zip((0..2).map(|angle| self.turned[angle] + left[angle]));
        let off = off.filter(|(_, off)| *off != 0.0).map(|(angle, off)| notice_of_zero(angle, off));
        off.chain(parts.iter().flat_map(|part| &part.shared).map(|shared| shared.notice(list))).collect()
    }
}

/// An angle that is off, in words.
fn notice_of_zero(angle: &str, off: f64) -> Notice {
    let message = format!(
        "{angle} reads {off:.4} rad ({:.2}°) too large against gravity or the images: taken as its sensor's zero (or the camera's \
         upright), not as an effect",
        off.to_degrees()
    );
    Notice { file: "plant.csv".into(), line: 0, message }
}

impl Shared {
    /// Says that the logs don't tell the effect from the zero.
    fn notice(&self, list: &[Candidate]) -> Notice {
        let (effect, zero, off) = (list[self.effect].name, list[self.zero].phrase, self.off);
        let message = format!(
            "{effect} may as well be the {zero}, {off:.4} rad too large: only images tell them apart"
        );
        Notice { file: "plant.csv".into(), line: 0, message }
    }
}

/// How many effects of the machine stand in all parts.
pub(super) fn effects_in_all(compared: &Compared, list: &[Candidate]) -> usize {
    let active = compared.parts.iter().flat_map(|part| &part.study.active);
    active.filter(|index| !list[**index].side.is_of_log()).count()
}
