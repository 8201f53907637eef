//! A law of place: circles that stay off by a smooth function of the pose, below what a gap shows. Effects that together explain a lens which none of them is
//! leave one, each of them sure; noise does not, nor what renderers draw otherwise, which changes from one place on the pixel lattice to the
//! next.

use super::policy::CHECK;
use super::torque_shape::nearest;
use super::{Found, Judgement};
use crate::diagnosis::Unknown;
use crate::rigs::acrobot::residual::Signal;
use crate::rigs::acrobot::residual::image::IMAGES;
use crate::rigs::acrobot::residual::studio::CENTROIDS;
use crate::rigs::acrobot::selection::Evaluation;
use crate::statistics::levels::ROUNDING;
use crate::statistics::linear::{Cell, Reduced, reduce};
use nalgebra::DMatrix;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Such a law, where nothing else has no name.
pub(super) fn doubt(found: &Found<'_>, so_far: Option<&Unknown>) -> Judgement {
    if so_far.is_some() || found.torque {
        return Judgement::Keep;
    }
    let Some(law) = Law::of(&found.study.last, found.signals) else { return Judgement::Keep };
    let told = || Unknown {
        signal: found.signals[law.worst].name.clone(),
        depends_on: vec!["q1".into(), "q2".into()],
        shape: format!("a smooth law of place in the image ({:.0} % of what is left)", 100.0 * law.share),
        nearest: nearest(found.study, found.list),
        ..Unknown::default()
    };
    law.is_evident().then(told).into()
}

/// What smooth functions of the pose explain of the circles' places, a function for each.
#[derive(Debug, Clone, Copy)]
struct Law {
    /// Share of all squares that they explain.
    share: f64,
    /// Squares that each of their coefficients explains, over what it would of noise, and of the errors of renderers with it.
    times: f64,
    /// The signal of which they explain most.
    worst: usize,
}

impl Law {
    /// Of what a model leaves; nothing where there are too few frames.
    fn of(at: &Evaluation, signals: &[Signal]) -> Option<Self> {
        let cells: Vec<&Cell> = at.blocks.iter().flat_map(|block| &block.cells).collect();
        let columns = columns();
        let parts: Vec<Option<Reduced>> =
            cells.par_iter().map(|cell| beside(cell, &columns, at.discrepancy_sd)).collect();
        let mut all = Reduced::zero(columns.len());
        parts.iter().flatten().for_each(|part| all.add(part));
        let (explained, rank) = explained(&all, &columns)?;
        let square: f64 = explained.iter().sum();
        let freedom = all.freedom - rank;
        if freedom < rank || all.square <= square {
            return None;
        }
        let by_noise = (all.square - square) / freedom;
        let worst = (0..CENTROIDS.len()).max_by(|a, b| explained[*a].total_cmp(&explained[*b]))?;
        let drawn = 1.0 + crowd(&cells, at, signals) / by_noise;
        Some(Self { share: square / all.square, times: square / (rank * by_noise * drawn), worst })
    }

    /// Whether it is none of noise, and more than a little beside it.
    fn is_evident(&self) -> bool {
        self.times > CHECK.means && self.share > CHECK.form
    }
}

/// A monomial of the angles for one signal.
struct Column {
    signal: usize,
    powers: (i32, i32),
}

/// Those of all circles, as high as a surface over the poses goes: the first two move with the first link alone.
fn columns() -> Vec<Column> {
    let most = IMAGES.degree as i32;
    let of = |signal: usize| {
        // the last circle's places are the last two
        let second = if signal + 2 < CENTROIDS.end { 0 } else { most };
        let all = (0..=most).flat_map(move |a| (0..=second.min(most - a)).map(move |b| (a, b)));
        all.map(move |powers| Column { signal, powers })
    };
    CENTROIDS.flat_map(of).collect()
}

/// A frame with these columns in the place of candidates'; nothing where it shows no pose.
fn beside(cell: &Cell, columns: &[Column], discrepancy_sd: f64) -> Option<Reduced> {
    let [q1, q2, ..] = cell.state[..] else { return None };
    let value = |row: usize, column: usize| {
        let Column { signal, powers } = columns[column];
        if cell.signal[row] == signal { q1.powi(powers.0) * q2.powi(powers.1) } else { 0.0 }
    };
    let matrix = DMatrix::from_fn(cell.residual.len(), columns.len(), value);
    Some(reduce(&Cell { columns: matrix, ..cell.clone() }, discrepancy_sd))
}

/// Squares that the columns of each signal explain beside those of the signals before it, and how many of them count.
fn explained(all: &Reduced, columns: &[Column]) -> Option<(Vec<f64>, f64)> {
    let (mut gram, mut score) = (all.gram.clone(), all.score.clone());
    let (mut squares, mut rank) = (vec![0.0; CENTROIDS.len()], 0.0);
    let lengths: Vec<f64> = (0..columns.len()).map(|i| all.gram[(i, i)]).collect();
    for (i, column) in columns.iter().enumerate() {
        let length = gram[(i, i)];
        // what the columns before it leave nothing of
        if length <= ROUNDING * lengths[i] || length.is_nan() {
            continue;
        }
        squares[column.signal - CENTROIDS.start] += score[i] * score[i] / length;
        rank += 1.0;
        let along = gram.column(i) / length;
        score.axpy(-score[i], &along, 1.0);
        let row = gram.row(i).clone_owned();
        gram -= along * row;
    }
    (rank > 0.0).then_some((squares, rank))
}

/// Mean square of what renderers draw otherwise, in units of noise, times the rows that share a place on the lattice: those have one error.
fn crowd(cells: &[&Cell], at: &Evaluation, signals: &[Signal]) -> f64 {
    let mut places: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    for cell in cells {
        let of_circles =
            cell.signal.iter().zip(&cell.lattice).filter(|(signal, _)| CENTROIDS.contains(signal));
        of_circles.for_each(|(signal, place)| *places.entry((*signal, *place)).or_default() += 1.0);
    }
    let (mut sum, mut rows) = (0.0, 0.0);
    for ((signal, _), count) in places {
        sum += (count * signals[signal].tolerance / at.sigmas[signal]).powi(2);
        rows += count;
    }
    if rows > 0.0 { sum / rows } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::super::examples::{frames, signals};
    use super::*;

    /// A law of the tip's u, of this size in px, beside noise of 0.025 px.
    fn law(size: f64) -> Law {
        let bent = |q1: f64, q2: f64| size * (libm::sin(4.0 * q1) * libm::cos(3.0 * q2));
        let at =
            frames(|moment, signal| if signal == 4 { bent(moment.state[0], moment.state[1]) } else { 0.0 });
        Law::of(&at, &signals()).expect("900 frames")
    }

    #[test]
    fn law_noise_follows_no_place_and_a_lens_does() {
        let none = law(0.0);
        // fifty squares of noise are known to a fifth
        assert!((0.4..1.6).contains(&none.times) && !none.is_evident(), "{none:?}");
        let lens = law(0.1);
        assert!(lens.is_evident() && lens.worst == 4, "{lens:?}");
    }

    #[test]
    fn value_a_law_counts_from_a_fiftieth_of_what_is_left_and_three_times_noise() {
        let evident = |times: f64, share: f64| Law { share, times, worst: 0 }.is_evident();
        assert!(evident(3.1, 0.021) && !evident(2.9, 0.021) && !evident(3.1, 0.019));
    }

    #[test]
    fn law_rows_at_one_place_of_the_lattice_share_an_error() {
        let mut at = frames(|_, _| 0.0);
        let tolerance =
            |own: f64| signals().into_iter().map(|s| Signal { tolerance: own, ..s }).collect::<Vec<_>>();
        let crowd = |at: &Evaluation| {
            let cells: Vec<&Cell> = at.blocks.iter().flat_map(|block| &block.cells).collect();
            crowd(&cells, at, &tolerance(0.005))
        };
        assert_eq!(crowd(&at), 0.0, "nothing is rendered");
        for cell in at.blocks.iter_mut().flat_map(|block| &mut block.cells) {
            cell.lattice = vec![7; cell.signal.len()];
        }
        // a fifth of the noise, all 900 rows alike; the noise of 900 rows is known to a fortieth
        assert!((crowd(&at) / (900.0 * 0.04) - 1.0).abs() < 0.1, "{}", crowd(&at));
    }
}
