//! Is what is left noise?

use super::image_shape::image_shape;
use super::torque_shape::{nearest, torque_shape, widest};
use super::{Found, Judgement, unlisted_law};
use crate::diagnosis::{Gap, Unknown};
use crate::rigs::acrobot::check::policy::CHECK;
use crate::rigs::acrobot::gap::{chained, of_pictures};
use crate::rigs::acrobot::residual::studio::{AREAS, COLUMNS};
use crate::rigs::acrobot::residual::torque::{rms, torques};
use crate::rigs::acrobot::residual::{Block, Signal};
use crate::rigs::acrobot::selection::policy::SELECTION;
use crate::rigs::acrobot::selection::{Evaluation, lacking};
use crate::statistics::linear::bare;

/// For each signal, variance of the block means of a model's residual over what independent rows would give, and the rows of a block; beside
/// torques of a size that is accounted for (N·m).
fn block_means(evaluation: &Evaluation, signals: &[Signal], accounted: f64) -> Vec<(f64, f64)> {
    let mut means = vec![(0.0, 0.0, 0.0, 0.0); signals.len()];
    for block in &evaluation.blocks {
        for (s, sums) in means.iter_mut().enumerate() {
            let rows: Vec<f64> = whitened(block, s, accounted);
            if rows.len() > 3 {
                let mean = rows.iter().sum::<f64>() / rows.len() as f64;
                sums.0 += mean * mean * rows.len() as f64;
                sums.1 += rows.iter().map(|x| x * x).sum::<f64>() / rows.len() as f64;
                sums.2 += rows.len() as f64;
                sums.3 += 1.0;
            }
        }
    }
    means
        .iter()
        .map(|(a, b, rows, blocks)| if *b > 0.0 { (a / b, rows / blocks) } else { (1.0, 0.0) })
        .collect()
}

/// The whitened residual of one signal in a block, row by row, its nuisances taken out beside torques of the size `accounted`, N·m.
fn whitened(block: &Block, signal: usize, accounted: f64) -> Vec<f64> {
    let mut rows = Vec::new();
    for cell in &block.cells {
        let residual = bare(cell, &cell.residual, accounted).residual;
        rows.extend(
            (0..cell.residual.len()).filter(|row| cell.signal[*row] == signal).map(|row| residual[row]),
        );
    }
    rows
}

/// More than noise is left, of which nothing on the list has the form.
pub(super) fn doubt(found: &Found<'_>, _: Option<&Unknown>) -> Judgement {
    unknown(found).into()
}

/// Whether a gap stays open.
fn is_open(gap: &Gap) -> bool {
    gap.after > CHECK.open * gap.floor
}

/// Whether a torque (N·m) that only its many rows make evident is the form of the named effects: it is small beside what the model
/// lacked `before` they were named (N·m). Dry friction is smoothed at rest, and a saturation may begin between two rows.
fn is_form(discrepancy_sd: f64, before: f64) -> bool {
    discrepancy_sd < CHECK.form * before
}

/// The residual in words, if it is more than noise.
fn unknown(found: &Found<'_>) -> Option<Unknown> {
    let Found { study, signals, list: candidates, torque, .. } = *found;
    let stamps = SELECTION.stamps * study.explained;
    // what scattering timestamps of the torque do goes on from row to row, too
    let accounted = if study.last.discrepancy_sd <= stamps { study.last.discrepancy_sd } else { 0.0 };
    let nearest = nearest(study, candidates);
    let in_words = || unlisted_law::shape(found).unwrap_or_else(|| torque_shape(study, &study.last));
    if torque {
        let (size, floor) = rms(&torques(&study.last.blocks, &[], &[], &study.folds.of));
        let evident = lacking(&study.last, &study.folds, study.explained, false)
            && (study.active.is_empty() || !is_form(study.last.discrepancy_sd, found.gap.before));
        if !evident && size < CHECK.torque_ratio * floor.hypot(stamps) {
            return None;
        }
        let (signal, depends_on, shape) = in_words();
        return Some(Unknown { signal, depends_on, shape, nearest, ..Unknown::default() });
    }
    let chain = chained(signals);
    // circles that don't fit each other are no torque's, which moves the links that they are on
    let open =
        || is_open(&if chain { of_pictures(study, found.free, found.runs) } else { found.gap.clone() });
    if chain && !open() && lacking(&study.last, &study.folds, study.explained, true) {
        let (signal, depends_on, shape) = in_words();
        return Some(Unknown { signal, depends_on, shape, nearest, ..Unknown::default() });
    }
    let measured = study
        .last
        .blocks
        .iter()
        .flat_map(|block| &block.cells)
        .any(|cell| cell.signal.first().is_some_and(|s| *s < COLUMNS.len()) && cell.soft.ncols() > 0);
    // a circle that stays at one place on the lattice shows there the tolerance of renderers, row after row
    let tolerance = |s: usize, rows: f64| rows * (signals[s].tolerance / study.last.sigmas[s]).powi(2);
    let most = |rows: f64| {
        if measured { 1.0 + (CHECK.means - 1.0) * (rows / CHECK.rows).max(1.0) } else { CHECK.means }
    };
    let over = |s: usize, (mean, rows): (f64, f64)| mean / (most(rows) + tolerance(s, rows));
    let means = block_means(&study.last, signals, accounted);
    let means = means.iter().enumerate().take(COLUMNS.len()).filter(|(s, _)| !AREAS.contains(s));
    let worst = means.map(|(s, mean)| (s, over(s, *mean))).max_by(|a, b| a.1.total_cmp(&b.1));
    // a residual that comes and goes has a mean of zero, and isn't noise either
    let comes_and_goes = || open().then(|| widest(&study.last));
    let worst = worst.filter(|(_, size)| *size >= 1.0).map(|(worst, _)| worst).or_else(comes_and_goes)?;
    let (signal, depends_on, shape) = image_shape(&study.last, worst, &study.noise, signals, candidates);
    Some(Unknown { signal, depends_on, shape, nearest, ..Unknown::default() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::gap::{Measure, Sums};

    #[test]
    fn value_a_gap_is_open_from_half_as_much_again_as_noise() {
        let after = |after: f64| {
            let sums = Sums { before: (9.0, 1.0), after: (after * after, 1.0), floor: (1.0, 1.0) };
            is_open(&sums.gap(Measure::Centroids))
        };
        assert_eq!([1.16, 1.45, 1.55].map(after), [false, false, true]);
    }

    #[test]
    fn value_a_fiftieth_of_what_was_named_is_its_form() {
        assert_eq!([0.0019, 0.0021].map(|left| is_form(left, 0.1)), [true, false]);
    }
}
