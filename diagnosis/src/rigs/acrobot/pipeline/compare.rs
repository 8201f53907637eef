//! Every cut of the loop compared: what was found on each, and with what else it may be confused.

use super::Rig;
use super::compare_images::compare_images;
use super::compare_plant::compare_plant;
use super::encoder_zeros::Shared;
use super::integer_interval::{IntegerInterval, integer_intervals};
use super::replace_effect::put_best_first;
use crate::error::{Error, Notice};
use crate::rigs::acrobot::candidates::{Candidate, Side};
use crate::rigs::acrobot::gap::chained;
use crate::rigs::acrobot::linked::LinkedFit;
use crate::rigs::acrobot::residual::image::{Laws, Noise};
use crate::rigs::acrobot::residual::{Signal, Tracked};
use crate::rigs::acrobot::selection::policy::SELECTION;
use crate::rigs::acrobot::selection::{Alternative, Questioned, Study, alternatives, study};
use crate::watch::Watch;

/// One cut with all that was found on it.
pub(super) struct Part {
    pub(super) study: Study,
    pub(super) signals: Vec<Signal>,
    /// Each effect that is named, with all candidates that could stand in its place.
    pub(super) classes: Vec<(usize, Vec<Alternative>)>,
    /// The cut is the plant's: a torque was logged beside the angles.
    pub(super) torque: bool,
    /// Candidates that torques found before the plant could follow the log.
    pub(super) coarse: Vec<usize>,
    /// The sensor's noise as images scatter by it.
    pub(super) noise: Option<Noise>,
    /// Candidates, and the standard deviation of their coordinate from one linearisation to the next.
    pub(super) rough: Vec<(usize, f64)>,
    /// What moving candidates does to the image.
    pub(super) laws: Laws,
    /// Between which numbers an effect lies that only has whole ones.
    pub(super) integers: Vec<IntegerInterval>,
    /// Effects that the zero of an encoder explains as well.
    pub(super) shared: Vec<Shared>,
    /// The fit with linked states that the plant's classes needed.
    pub(super) linked: Option<LinkedFit>,
}

impl Part {
    /// Whether a circle was found to stand beside its link, of which no scenario knows.
    pub(super) fn has_circle_beside(&self, list: &[Candidate]) -> bool {
        chained(&self.signals) && self.study.active.iter().any(|index| list[*index].side == Side::Zero)
    }
}

/// What all cuts say.
pub(super) struct Compared {
    pub(super) parts: Vec<Part>,
    /// Coordinates of all candidates.
    pub(super) point: Vec<f64>,
    pub(super) notices: Vec<Notice>,
}

impl Compared {
    /// Adds a part, and goes on from where it has the candidates.
    pub(super) fn add(&mut self, part: Part) {
        self.point.clone_from(&part.study.last.point);
        self.parts.push(part);
    }
}

/// Compares all cuts of the loop. What candidates do to the image is taken from `laws` where they say it.
pub(super) fn compare(rig: &Rig<'_>, laws: &Laws, watch: &mut Watch<'_>) -> Result<Compared, Error> {
    let point = watch.known().map_or_else(|| rig.nominal_point(), |known| known.point.clone());
    let mut compared = Compared { parts: Vec::new(), point, notices: Vec::new() };
    let motions = compare_plant(rig, &mut compared, watch)?;
    compare_images(rig, motions, laws, &mut compared, watch)?;
    Ok(compared)
}

/// Searches a cut, on which the `known` are on already.
pub(super) fn search_cut(
    cut: &mut Tracked,
    list: &[Candidate],
    point: &[f64],
    known: &[usize],
    torque: bool,
    watch: &mut Watch<'_>,
) -> Result<Part, Error> {
    // what a first search found is on, unless it is superfluous here
    let before = watch.known().into_iter().flat_map(|before| before.active.iter().copied());
    let before = before.filter(|index| cut.sees(&list[*index]) && !known.contains(index));
    let known: Vec<usize> = known.iter().copied().chain(before).collect();
    let study = study(cut, list, point, &known, watch)?;
    add_classes(cut, list, study, torque, watch)
}

/// What was found on a cut, with all that could stand in the place of each effect.
pub(super) fn add_classes(
    cut: &mut Tracked,
    list: &[Candidate],
    mut study: Study,
    torque: bool,
    watch: &mut Watch<'_>,
) -> Result<Part, Error> {
    let mut classes = Vec::new();
    let named = if watch.known().is_some() { Vec::new() } else { study.active.clone() };
    for mut effect in named {
        let known = study.class.as_ref().filter(|(accepted, _)| *accepted == effect);
        let mut class = match known {
            Some((_, class)) => class.clone(),
            None => {
                let Study { last, active, steps, .. } = &study;
                alternatives(cut, &Questioned { candidates: list, last, active, effect, steps }, watch)?
            }
        };
        put_best_first(cut, list, &mut study, (&mut effect, &mut class), SELECTION.settled)?;
        classes.push((effect, class));
    }
    let integers = if watch.known().is_some() { Vec::new() } else { integer_intervals(cut, list, &study) };
    Ok(Part {
        study,
        signals: cut.signals().to_vec(),
        classes,
        torque,
        coarse: Vec::new(),
        noise: None,
        rough: Vec::new(),
        laws: Laws::default(),
        integers,
        shared: Vec::new(),
        linked: None,
    })
}
