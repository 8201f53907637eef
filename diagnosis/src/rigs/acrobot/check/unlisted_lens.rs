//! A lens that has a law of place which no candidate gives: each such law is held against what the model with its effects leaves of the
//! circles, beside these effects. Several effects may stand for one, each of them sure, and leave less of it than a gap shows.

use super::beside::{Laws, surest};
use super::torque_shape::nearest;
use super::{Found, Judgement};
use crate::diagnosis::Unknown;
use crate::rigs::acrobot::candidates::{Attribute, Candidate, Motion, Side};
use crate::rigs::acrobot::residual::studio::{CENTROIDS, circle_of};
use crate::rigs::acrobot::selection::Evaluation;
use crate::statistics::levels::{CERTAIN, DOUBTED};
use crate::statistics::linear::Cell;
use nalgebra::DMatrix;
use std::ops::Range;

/// How far a law moves a circle at a place (u, v), px from the image centre: along u and v.
type Law = (&'static str, fn(place: [f64; 2]) -> [f64; 2]);

/// Square of the distance from the centre.
fn squared([u, v]: [f64; 2]) -> f64 {
    u * u + v * v
}

/// Laws that lenses and sensors have. The first one is a candidate's, unless that is withheld.
const LAWS: [Law; 7] = [
    ("along the radius, with the fifth power of the distance from the centre", |at| {
        at.map(|x| x * squared(at).powi(2))
    }),
    ("along the radius, with the seventh power of the distance from the centre", |at| {
        at.map(|x| x * squared(at) * squared(at).powi(2))
    }),
    ("along u, with the fourth power of the distance from the centre", |at| [squared(at).powi(2), 0.0]),
    ("along v, with the fourth power of the distance from the centre", |at| [0.0, squared(at).powi(2)]),
    ("as pixels do that are wider than high", |[u, v]| [u, -v]),
    ("as rows do that are not at right angles to columns", |[u, v]| [v, u]),
    ("about the centre, by an angle that grows with the square of the distance", |at| {
        let [u, v] = at;
        [-v * squared(at), u * squared(at)]
    }),
];

/// Such a law, where nothing else has no name.
pub(super) fn doubt(found: &Found<'_>, so_far: Option<&Unknown>) -> Judgement {
    if so_far.is_some() || found.torque {
        return Judgement::Keep;
    }
    let Some((law, deviations)) = surest_of(found).filter(|(_, deviations)| deviations.abs() > CERTAIN)
    else {
        return Judgement::Keep;
    };
    let unknown = Unknown {
        signal: found.signals[most_moved(&found.study.last, law)].name.clone(),
        depends_on: vec!["u".into(), "v".into()],
        shape: format!("circles are moved {} ({:.1} standard deviations)", LAWS[law].0, deviations.abs()),
        nearest: nearest(found.study, found.list),
        ..Unknown::default()
    };
    Judgement::Unknown(unknown)
}

/// The law that is told most surely, and by how many standard deviations.
fn surest_of(found: &Found<'_>) -> Option<(usize, f64)> {
    surest(&found.study.last, &found.study.active, found.signals, &laws(open(found.list)))
}

/// These laws of the list.
fn laws(asked: Range<usize>) -> Laws<'static> {
    Laws { columns: &columns, asked, free: 0..0 }
}

/// The signal that a law moves most, in units of its noise.
fn most_moved(at: &Evaluation, law: usize) -> usize {
    let mut squares = [0.0; CENTROIDS.end];
    for cell in at.blocks.iter().flat_map(|block| &block.cells) {
        for row in (0..cell.residual.len()).filter(|row| CENTROIDS.contains(&cell.signal[*row])) {
            squares[cell.signal[row]] += (moves(cell, row)[law] / cell.sigma[row]).powi(2);
        }
    }
    CENTROIDS.max_by(|a, b| squares[*a].total_cmp(&squares[*b])).unwrap_or(CENTROIDS.start)
}

/// Whether effects that look as if they stood for another law do, where all are laws of place: one that nobody lists must show beside them, be it
/// as little as chance seldom gives. Such effects that are there leave 2.4 standard deviations at most, seen on seven sets; 3.5 where k2, k1
/// and a scale stood for a seventh power. Where no law can be asked for, as of angles that were read off circles, they may.
pub(super) fn may_stand_for_another(found: &Found<'_>) -> bool {
    is_open(surest_of(found))
}

/// Whether a law that is told so surely leaves it open.
fn is_open(surest: Option<(usize, f64)>) -> bool {
    surest.is_none_or(|(_, deviations)| deviations.abs() > DOUBTED)
}

/// Whether all that is on are laws of place by themselves, so that what they may stand for is asked for here.
pub(super) fn are_laws_of_place(active: &[usize], list: &[Candidate]) -> bool {
    active
        .iter()
        .map(|index| &list[*index])
        .all(|own| own.side == Side::Camera && !own.nonlinear && matches!(own.motion, Motion::Real { .. }))
}

/// The laws that no candidate gives: a series of radial terms begins with the third power, so that two reach the fifth.
fn open(list: &[Candidate]) -> Range<usize> {
    let terms = list.iter().filter(|own| own.is(Attribute::RadialSeries)).count();
    usize::from(terms > 1)..LAWS.len()
}

/// What each law moves the rows of a frame by.
fn columns(cell: &Cell) -> DMatrix<f64> {
    let rows: Vec<[f64; LAWS.len()]> = (0..cell.residual.len()).map(|row| moves(cell, row)).collect();
    DMatrix::from_fn(rows.len(), LAWS.len(), |row, law| rows[row][law])
}

/// By how much each law moves what a row measures; nothing where that is no circle's place.
fn moves(cell: &Cell, row: usize) -> [f64; LAWS.len()] {
    let signal = cell.signal[row];
    match cell.drawn.get(row) {
        Some(drawn) if CENTROIDS.contains(&signal) => {
            let axis = signal - CENTROIDS.start - 2 * circle_of(signal);
            LAWS.map(|(_, law)| law(drawn.place)[axis])
        }
        _ => [0.0; LAWS.len()],
    }
}

#[cfg(test)]
mod tests {
    use super::super::examples::{candidates, frames, place, signals};
    use super::*;

    /// What is told where a model leaves so much of each law.
    fn told(sizes: [f64; LAWS.len()]) -> Option<(usize, f64)> {
        let at = frames(|moment, signal| {
            if !CENTROIDS.contains(&signal) {
                return 0.0;
            }
            let at = place(signal, moment.state);
            LAWS.iter().zip(sizes).map(|((_, law), size)| size * law(at)[signal % 2]).sum()
        });
        surest(&at, &[0], &signals(), &laws(0..LAWS.len()))
    }

    #[test]
    fn value_each_law_is_told_by_its_words() {
        // a tenth of a pixel at 200 px from the centre
        let powers = [5, 7, 4, 4, 1, 1, 3];
        for (law, power) in powers.into_iter().enumerate() {
            let mut sizes = [0.0; LAWS.len()];
            sizes[law] = 0.1 / 200_f64.powi(power);
            let (found, deviations) = told(sizes).expect("900 frames of 0.025 px");
            assert_eq!(found, law);
            assert!(deviations > 10.0, "{deviations}");
        }
        let (_, none) = told([0.0; LAWS.len()]).expect("all laws are told from noise");
        // the largest of seven
        assert!(none.abs() < DOUBTED, "{none}");
    }

    #[test]
    fn law_a_law_is_told_of_a_signal_that_it_moves() {
        let at = frames(|_, _| 0.0);
        // along u, and along v
        assert_eq!([2, 3].map(|law| most_moved(&at, law) % 2), [0, 1]);
    }

    #[test]
    fn value_what_resembles_others_is_open_from_three_deviations_on_or_where_nothing_is_told() {
        assert_eq!([2.9, 3.1, -3.1].map(|deviations| is_open(Some((1, deviations)))), [false, true, true]);
        assert!(is_open(None));
        // angles alone, without their circles
        let mut at = frames(|_, _| 0.0);
        at.blocks.iter_mut().flat_map(|block| &mut block.cells).for_each(|cell| cell.drawn.clear());
        assert_eq!(surest(&at, &[0], &signals(), &laws(0..LAWS.len())), None);
    }

    #[test]
    fn law_a_term_of_the_series_that_is_a_candidate_is_no_unlisted_law() {
        let [shift, delay] = candidates();
        let term = Candidate { attributes: &[Attribute::RadialSeries], ..shift.clone() };
        assert_eq!(open(&[shift.clone(), term.clone(), delay]), 0..LAWS.len());
        assert_eq!(open(&[shift, term.clone(), term]), 1..LAWS.len());
    }

    #[test]
    fn every_effect_of_a_lens_is_a_law_of_place() {
        let list = candidates();
        assert!(are_laws_of_place(&[0], &list));
        let of_plant = [Candidate { side: Side::Plant, ..list[0].clone() }];
        assert!(!are_laws_of_place(&[0], &of_plant));
    }
}
