//! The zeros of the encoders: how a sensor was set up is no part of the machine. What is off is found, told, and cleared.

use super::*;
use crate::rigs::acrobot::residual::plant::{PlantCut, zeros};
use crate::rigs::acrobot::selection::policy::SELECTION;
use crate::statistics::linear::submatrix;

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
pub(super) fn doubted(parts: &[Part], list: &[Candidate], point: &[f64]) -> Option<[f64; 2]> {
    let study = &parts.iter().find(|part| part.torque)?.study;
    let in_doubt = |index: &usize| {
        let own = list[*index].side == Side::Zero;
        own || !list[*index].side.is_of_log() && places(list).any(|zero| resembles(study, zero, *index))
    };
    let doubted = !study.discrepancy_dominated && study.active.iter().any(in_doubt);
    doubted.then(|| zeros(list, point, None))
}

/// Zeros in the place of effects that the logs can't tell from them. Encoders of which one was set up badly are two for all that these
/// logs say; where neither is known to be off, it takes two effects, and zeros that fit no worse.
pub(super) fn both(
    rows: &mut Tracked<PlantCut>,
    list: &[Candidate],
    part: &Part,
    watch: &mut Watch<'_>,
) -> Result<Option<Part>, Error> {
    let (found, last) = (&part.study.active, &part.study.last);
    let (on, off): (Vec<usize>, Vec<usize>) = places(list).partition(|zero| found.contains(zero));
    let like = |index: &usize| off.iter().any(|zero| resembles(&part.study, *zero, *index));
    let alike: Vec<usize> =
        found.iter().copied().filter(|index| !list[*index].side.is_of_log() && like(index)).collect();
    let (instead, allowed): (Vec<&[usize]>, f64) = match (on.len(), alike.len()) {
        (1, _) => (alike.chunks(1).collect(), CLASS),
        (0, 2) => (vec![&alike], PIPELINE.first),
        _ => (Vec::new(), 0.0),
    };
    for effects in instead.into_iter().filter(|effects| effects.len() == off.len()) {
        let others = found.iter().copied().filter(|index| !effects.contains(index));
        let known: Vec<usize> = others.chain(off.iter().copied()).collect();
        let mut there = last.point.clone();
        effects.iter().for_each(|effect| there[*effect] = list[*effect].off);
        rows.reset();
        let study = study(rows, list, &there, &known, watch)?;
        let fits = study.last.under(last).deviance() < last.deviance() + allowed;
        let gone = effects.iter().all(|effect| !study.active.contains(effect));
        if fits && gone && study.active.len() <= found.len() {
            return classed(rows, list, study, true, watch).map(Some);
        }
    }
    if !alike.is_empty() {
        rows.reset();
        rows.linearise(&last.point, &[])?;
    }
    Ok(None)
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
    pub(super) fn seen(&mut self, list: &[Candidate], compared: &Compared) -> Option<[f64; 2]> {
        self.rounds += 1;
        let pictured = compared.parts.iter().filter(|part| !part.torque);
        let found = pictured.flat_map(|part| &part.study.active).any(|index| list[*index].side == Side::Zero);
        (found && self.rounds <= PIPELINE.rounds).then(|| zeros(list, &compared.point, None))
    }

    /// Takes them off the logs.
    pub(super) fn turn(&mut self, data: &mut DataSet, by: [f64; 2]) {
        (0..2).for_each(|angle| self.turned[angle] += by[angle]);
        data.turn_back(by);
    }

    /// Takes zeros that are off out of what is named.
    pub(super) fn clear(&self, list: &[Candidate], parts: &mut [Part], point: &mut [f64]) -> Vec<Notice> {
        let left = zeros(list, point, None);
        for index in places(list).filter(|index| point[*index] != 0.0).collect::<Vec<_>>() {
            point[index] = 0.0;
            parts.iter_mut().for_each(|part| part.classes.retain(|(other, _)| *other != index));
        }
        let off = ["q1", "q2"].into_iter().zip((0..2).map(|angle| self.turned[angle] + left[angle]));
        off.filter(|(_, off)| *off != 0.0).map(|(angle, off)| told(angle, off)).collect()
    }
}

/// An angle that is off, in words.
fn told(angle: &str, off: f64) -> Notice {
    let message = format!(
        "{angle} reads {off:.4} rad ({:.2}°) too large against gravity or the pictures: taken as its sensor's zero (or the camera's \
         upright), not as an effect",
        off.to_degrees()
    );
    Notice { file: "plant.csv".into(), line: 0, message }
}

/// How many effects of the machine stand in all parts.
pub(super) fn effects(compared: &Compared, list: &[Candidate]) -> usize {
    let active = compared.parts.iter().flat_map(|part| &part.study.active);
    active.filter(|index| !list[**index].side.is_of_log()).count()
}
