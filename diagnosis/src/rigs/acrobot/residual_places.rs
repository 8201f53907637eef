//! Where simulation and data disagree: in which signals, when, in which states; and the residual over time for the report.

use crate::diagnosis::{Trace, Where};
use crate::rigs::acrobot::check::link_of;
use crate::rigs::acrobot::gap::measures;
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::residual::Signal;
use crate::rigs::acrobot::residual::studio::{ANGLES, COLUMNS};
use crate::rigs::acrobot::residual::torque::torques;
use crate::rigs::acrobot::selection::{Evaluation, Study};
use crate::statistics::linear::bare;

/// Which signals disagree under the nominal model, when, and where.
pub fn places(study: &Study, signals: &[Signal]) -> Vec<(f64, Where)> {
    let nominal = study.nominal.under(&study.last);
    let mut excess = vec![0.0; signals.len()];
    let mut spans = vec![(f64::INFINITY, f64::NEG_INFINITY); signals.len()];
    let mut worst: Vec<Vec<(f64, [f64; 4])>> = vec![Vec::new(); signals.len()];
    for block in &nominal.blocks {
        let mut own = vec![0.0; signals.len()];
        let mut rows = vec![0.0; signals.len()];
        for cell in &block.cells {
            let residual = bare(cell, &cell.residual, 0.0).residual;
            for row in 0..cell.residual.len() {
                own[cell.signal[row]] += residual[row] * residual[row];
                rows[cell.signal[row]] += 1.0;
            }
        }
        for s in 0..signals.len() {
            if rows[s] == 0.0 {
                continue;
            }
            let over = own[s] - rows[s];
            excess[s] += over;
            worst[s].push((over, block.state));
            // three standard deviations of a sum of squares
            if over > 3.0 * (2.0 * rows[s]).sqrt() {
                spans[s] = (spans[s].0.min(block.from), spans[s].1.max(block.to));
            }
        }
    }
    (0..signals.len())
        .filter(|s| excess[*s] > 0.0 && spans[*s].0.is_finite())
        .map(|s| {
            let place = Where {
                signal: signals[s].name.clone(),
                share: excess[s],
                from: spans[s].0,
                to: spans[s].1,
                region: region(&mut worst[s]),
            };
            (excess[s], place)
        })
        .collect()
}

/// Turns excesses into shares and drops crumbs.
pub fn shares(found: Vec<(f64, Where)>) -> Vec<Where> {
    let total: f64 = found.iter().map(|(excess, _)| excess).sum();
    let mut all: Vec<Where> =
        found.into_iter().map(|(excess, place)| Where { share: excess / total, ..place }).collect();
    all.retain(|place| place.share >= POLICY.listed);
    all.sort_by(|a, b| b.share.total_cmp(&a.share));
    all
}

/// The states of the tenth of the blocks that disagree most.
fn region(worst: &mut [(f64, [f64; 4])]) -> String {
    worst.sort_by(|a, b| b.0.total_cmp(&a.0));
    let many = worst.len().div_ceil(10);
    let of = |index: usize, slice: &[(f64, [f64; 4])]| {
        let values = slice.iter().map(|(_, state)| state[index]);
        (values.clone().fold(f64::INFINITY, f64::min), values.fold(f64::NEG_INFINITY, f64::max))
    };
    let ((a, b), (c, d)) = (of(1, &worst[..many]), of(1, worst));
    let ((e, f), (g, h)) = (of(3, &worst[..many]), of(3, worst));
    format!(
        "most where q2 is {a:.2} to {b:.2} rad (of {c:.2} to {d:.2}) and dq2 {e:.2} to {f:.2} rad/s (of {g:.2} to {h:.2})"
    )
}

/// Which signal of an image is shown, if it was measured: the tip goes furthest.
const SHOWN: [usize; 8] = [4, 5, 2, 3, 10, 9, 0, 1];

/// Residuals over time for the report, of the signal that is blamed: torque on a link, or a coordinate in the image.
pub fn trace(study: &Study, torque: bool, blamed: &str) -> Trace {
    let measured = |signal: &usize| measures(&study.last.blocks, &(*signal..*signal + 1));
    let named = COLUMNS.iter().position(|name| blamed.ends_with(&format!(".{name}"))).filter(measured);
    let shown = named.or_else(|| SHOWN.into_iter().find(measured)).unwrap_or(SHOWN[0]);
    let link = link_of(blamed).unwrap_or(1);
    let of = |evaluation: &Evaluation| -> Vec<(f64, f64)> {
        let mut base = 0.0;
        let mut run = usize::MAX;
        let (mut begin, mut end) = (0.0, 0.0);
        let lacking =
            if torque { torques(&evaluation.blocks, &[], &[], &study.folds.of) } else { Vec::new() };
        let mut points = Vec::new();
        for (index, block) in evaluation.blocks.iter().enumerate() {
            if block.run != run {
                base += end - begin;
                (run, begin) = (block.run, block.from);
            }
            end = block.to + 1.0;
            if torque {
                let own: Vec<f64> =
                    lacking.iter().filter(|t| t.block == index).map(|t| t.torque[link]).collect();
                let middle = base - begin + 0.5 * (block.from + block.to);
                points.push((middle, own.iter().sum::<f64>() / own.len().max(1) as f64));
            } else {
                for cell in &block.cells {
                    if let Some(row) = cell.signal.iter().position(|s| *s == shown) {
                        points.push((base - begin + cell.time[row], cell.residual[row]));
                    }
                }
            }
        }
        points
    };
    Trace {
        title: match torque {
            true => format!("Torque that the model lacks {}", ["on link 1", "at the joint"][link]),
            false => format!("In the image, {}: measured - rendered", COLUMNS[shown]),
        },
        unit: match torque {
            true => "N·m",
            false if ANGLES.contains(&shown) => "rad",
            false => "px",
        }
        .into(),
        link,
        before: of(&study.nominal),
        after: of(&study.last),
    }
}
