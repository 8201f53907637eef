//! Is what is left noise?

use super::shape::{image_shape, nearest, torque_shape};
use super::{Found, Judgement};
use crate::diagnosis::Unknown;
use crate::rigs::acrobot::candidates::{Candidate, Side};
use crate::rigs::acrobot::check::policy::CHECK;
use crate::rigs::acrobot::gap::chained;
use crate::rigs::acrobot::residual::picture::{AREAS, COLUMNS};
use crate::rigs::acrobot::residual::plant::MOTION;
use crate::rigs::acrobot::residual::torque::{rms, torques};
use crate::rigs::acrobot::residual::{Block, Signal};
use crate::rigs::acrobot::selection::{Evaluation, STAMPS, Study, lacking};
use crate::statistics::linear::bare;

/// How a rest differs from noise.
#[derive(Debug, Clone, PartialEq)]
pub struct Rest {
    /// For each signal: scatter over what is known of it (1 where nothing is), and correlation from row to row.
    pub signals: Vec<(f64, f64)>,
    /// For each signal: variance of block means over what independent rows would give, and the rows of a block.
    pub means: Vec<(f64, f64)>,
}

/// Judges the rest of a model, beside torques of a size that is accounted for (N·m).
pub fn rest(evaluation: &Evaluation, signals: &[Signal], accounted: f64) -> Rest {
    let mut sums = vec![(0.0, 0.0, 0.0); signals.len()];
    let mut means = vec![(0.0, 0.0, 0.0, 0.0); signals.len()];
    for block in &evaluation.blocks {
        for s in 0..signals.len() {
            let rows: Vec<f64> = whitened(block, s, accounted);
            for pair in rows.windows(2) {
                sums[s].0 += pair[0] * pair[1];
                sums[s].1 += 0.5 * (pair[0] * pair[0] + pair[1] * pair[1]);
            }
            if rows.len() > 3 {
                let mean = rows.iter().sum::<f64>() / rows.len() as f64;
                means[s].0 += mean * mean * rows.len() as f64;
                means[s].1 += rows.iter().map(|x| x * x).sum::<f64>() / rows.len() as f64;
                means[s].2 += rows.len() as f64;
                means[s].3 += 1.0;
            }
            sums[s].2 += rows.len() as f64;
        }
    }
    let per_signal = signals
        .iter()
        .enumerate()
        .map(|(s, signal)| {
            let ratio = signal.known.map_or(1.0, |known| evaluation.seen[s] / known);
            (ratio, if sums[s].1 > 0.0 { sums[s].0 / sums[s].1 } else { 0.0 })
        })
        .collect();
    let means = means
        .iter()
        .map(|(a, b, rows, blocks)| if *b > 0.0 { (a / b, rows / blocks) } else { (1.0, 0.0) })
        .collect();
    Rest { signals: per_signal, means }
}

fn whitened(block: &Block, signal: usize, accounted: f64) -> Vec<f64> {
    let mut rows = Vec::new();
    for cell in &block.cells {
        let rest = bare(cell, &cell.residual, accounted).rest;
        rows.extend((0..cell.residual.len()).filter(|row| cell.signal[*row] == signal).map(|row| rest[row]));
    }
    rows
}

/// More than noise is left, of which nothing on the list has the form.
pub(super) fn doubt(found: &Found<'_>, _: Option<&Unknown>) -> Judgement {
    unknown(found.study, found.signals, found.list, found.torque).into()
}

/// The residual in words, if it is more than noise.
pub fn unknown(study: &Study, signals: &[Signal], candidates: &[Candidate], torque: bool) -> Option<Unknown> {
    let stamps = STAMPS * study.explained;
    // what scattering stamps of the torque do goes on from row to row, too
    let accounted = if study.last.discrepancy_sd <= stamps { study.last.discrepancy_sd } else { 0.0 };
    let rest = rest(&study.last, signals, accounted);
    let nearest = nearest(study, candidates);
    if torque {
        let quick = rest
            .signals
            .iter()
            .take(MOTION)
            .position(|(ratio, rho)| *ratio > CHECK.scatter && *rho > CHECK.correlated);
        let (size, floor) = rms(&torques(&study.last.blocks, &[], &[], &study.folds.of));
        let evident = lacking(&study.last, &study.folds, study.explained, false);
        if !evident && quick.is_none() && size < CHECK.torque_ratio * floor.hypot(stamps) {
            return None;
        }
        let (signal, depends_on, shape) = torque_shape(study, &study.last);
        return Some(Unknown { signal, depends_on, shape, nearest, ..Unknown::default() });
    }
    if chained(signals) && lacking(&study.last, &study.folds, study.explained, true) {
        let (signal, depends_on, shape) = torque_shape(study, &study.last);
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
    let worst = |rest: &Rest| {
        let all = rest.means.iter().enumerate().take(COLUMNS.len()).filter(|(s, _)| !AREAS.contains(s));
        let all = all.map(|(s, mean)| (s, over(s, *mean)));
        all.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, size)| *size >= 1.0)
    };
    let (worst, _) = worst(&rest).filter(|_| {
        let beside = beside_dropped(study, candidates);
        beside.is_none_or(|beside| worst(&self::rest(&beside, signals, accounted)).is_some())
    })?;
    let (depends_on, shape) = image_shape(&study.last, worst);
    Some(Unknown { signal: signals[worst].name.clone(), depends_on, shape, nearest, ..Unknown::default() })
}

/// The model with the likeliest effect of the picture that was dropped: right renderers may differ by as much, so that it is
/// neither named nor a rest.
fn beside_dropped(study: &Study, candidates: &[Candidate]) -> Option<Evaluation> {
    let dropped = |index: usize| study.steps.iter().any(|step| step.dropped.contains(&index));
    let pictured = |index: usize| candidates[index].side == Side::Camera && !study.active.contains(&index);
    let hit = study.screen.hits.iter().find(|hit| pictured(hit.candidate) && dropped(hit.candidate))?;
    let mut beside = study.last.clone();
    for cell in beside.blocks.iter_mut().flat_map(|block| &mut block.cells) {
        let column = cell.columns.column(hit.column);
        cell.residual.iter_mut().zip(&column).for_each(|(rest, slope)| *rest -= hit.displacement * slope);
    }
    Some(beside)
}
