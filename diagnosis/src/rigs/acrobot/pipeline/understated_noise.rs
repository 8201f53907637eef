//! A noise that `[noise]` states too small: rows that scatter by more, each on its own, whatever torque the model lacks. Taken at its
//! word it would make noise of the sensor something that the machine lacks.

use super::Rig;
use super::compare::Part;
use super::policy::PIPELINE;
use crate::error::Notice;
use crate::rigs::acrobot::residual::{Block, Cut, Signal};
use crate::rigs::acrobot::selection::Evaluation;
use crate::statistics::levels::SAMPLE;
use crate::statistics::linear::bare;
use crate::text::brief;

/// A signal whose noise is stated too small.
struct Understated {
    name: String,
    unit: &'static str,
    stated: f64,
    seen: f64,
}

/// Forgets what `[noise]` states of such signals, and tells so. Answers whether anything was forgotten, so that all is compared again.
pub(super) fn forget_understated(rig: &mut Rig<'_>, parts: &[Part], notices: &mut Vec<Notice>) -> bool {
    let mut found: Vec<Understated> =
        parts.iter().flat_map(|part| understated(&part.signals, &part.study.last)).collect();
    // noise that is taken for something that the machine lacks hides the angles behind torques
    if parts.iter().any(|part| part.torque && part.signals.iter().all(|signal| signal.known.is_none())) {
        found.extend(understated_angles(rig).unwrap_or_default());
    }
    for Understated { name, unit, stated, seen } in &found {
        let stated = rig.data.manifest.noise.remove(name).unwrap_or(*stated);
        let message = format!(
            "[noise] {name} = {} {unit}, but its rows scatter by {} {unit}, each on its own: what they show is taken instead",
            brief(stated),
            brief(*seen)
        );
        notices.push(Notice { file: "dataset.toml".into(), line: 0, message });
    }
    !found.is_empty()
}

/// Angles whose noise is stated too small, by what the nominal plant leaves of them; `None` where it can't be compared with them.
fn understated_angles(rig: &Rig<'_>) -> Option<Vec<Understated>> {
    let point = rig.nominal_point();
    let mut rows = rig.plant_cut().ok()??;
    rows.begin(&point).ok()?;
    let there = Evaluation::at(&mut rows, &point, &[]).ok()?;
    Some(understated(rows.signals(), &there))
}

/// The signals whose stated noise is too small, by what a model leaves of them.
fn understated(signals: &[Signal], there: &Evaluation) -> Vec<Understated> {
    let clear = |(place, signal): (usize, &Signal)| {
        let (stated, seen) = (signal.known?, there.seen[place]);
        let larger = is_larger(seen, stated.hypot(signal.tolerance).max(signal.least));
        let found = || Understated { name: signal.name.clone(), unit: signal.unit, stated, seen };
        (larger && independent(&there.blocks, place)).then(found)
    };
    signals.iter().enumerate().filter_map(clear).collect()
}

/// Whether rows scatter by far more than is stated.
fn is_larger(seen: f64, stated: f64) -> bool {
    seen > PIPELINE.understated * stated
}

/// Whether what is left of a signal, beside start states and any torque, is another from row to row: neither a law of pose nor of time.
fn independent(blocks: &[Block], signal: usize) -> bool {
    let (mut along, mut square, mut pairs) = (0.0, 0.0, 0.0);
    for block in blocks {
        let mut rows: Vec<(f64, f64)> = Vec::new();
        for cell in &block.cells {
            let left = bare(cell, &cell.residual, cell.free());
            let own = (0..cell.signal.len()).filter(|row| cell.signal[*row] == signal);
            rows.extend(own.map(|row| (cell.time[row], left.residual[row])));
        }
        rows.sort_by(|one, other| one.0.total_cmp(&other.0));
        for pair in rows.windows(2) {
            along += pair[0].1 * pair[1].1;
            square += 0.5 * (pair[0].1 * pair[0].1 + pair[1].1 * pair[1].1);
            pairs += 1.0;
        }
    }
    pairs > SAMPLE as f64 && along < PIPELINE.alike_rows * square
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::linear::Cell;
    use crate::statistics::random::Random;
    use nalgebra::DMatrix;

    /// One cell of 400 rows whose residual follows the row before by so much.
    fn blocks(follows: f64) -> Vec<Block> {
        let (mut random, mut last) = (Random::new(7), 0.0);
        let mut next = || {
            last = follows * last + (1.0 - follows * follows).sqrt() * random.normal();
            last
        };
        let residual: Vec<f64> = (0..400).map(|_| next()).collect();
        let rows = residual.len();
        let none = || DMatrix::zeros(rows, 0);
        let cell = Cell {
            residual,
            sigma: vec![1.0; rows],
            signal: vec![0; rows],
            time: (0..rows).map(|row| row as f64).collect(),
            hard: none(),
            soft: none(),
            discrepancy: 0,
            inertia_scale: 1.0,
            columns: none(),
            floor: Vec::new(),
            state: Vec::new(),
            lattice: Vec::new(),
            drawn: Vec::new(),
        };
        vec![Block { run: 0, from: 0.0, to: 400.0, cells: vec![cell], state: [0.0; 4] }]
    }

    #[test]
    fn value_a_noise_of_more_than_three_times_what_is_stated_is_another() {
        assert_eq!([2.9e-4, 3.1e-4].map(|seen| is_larger(seen, 1e-4)), [false, true]);
    }

    #[test]
    fn value_rows_that_follow_one_another_by_three_tenths_are_no_noise() {
        // the correlation of 400 rows is known to 0.05
        assert_eq!(
            [0.0, 0.15, 0.45, 0.9].map(|follows| independent(&blocks(follows), 0)),
            [true, true, false, false]
        );
        assert!(!independent(&blocks(0.0), 1));
    }
}
