//! An encoder that stood still: one value for many rows, while the other link moves. No link of an arm stands still beside one that moves.

use super::{Run, Table};
use crate::check::stood_still;
use crate::error::Notice;
use crate::rigs::acrobot::policy::POLICY;

/// Makes such rows not measured, in both angles.
pub fn exclude(run: &mut Run, notices: &mut Vec<Notice>) {
    let Some(plant) = &mut run.plant else { return };
    for (angle, other) in [("q1", "q2"), ("q2", "q1")] {
        let Some(rows) = still(plant, angle, other) else { continue };
        let [first, last] = [rows[0], rows[rows.len() - 1]];
        let message = format!(
            "{angle} has one value up to line {}, in {} rows, while {other} moves, and elsewhere a new one nearly every row: its sensor \
             stood still, and these rows are taken as not measured",
            plant.line[last],
            rows.len()
        );
        notices.push(Notice { file: format!("{}/plant.csv", run.name), line: plant.line[first], message });
        // one angle alone says too little of where the arm is for so long a time
        for name in [angle, other] {
            plant
                .column_mut(name)
                .iter_mut()
                .for_each(|values| rows.iter().for_each(|row| values[*row] = f64::NAN));
        }
    }
}

/// The rows in which an angle stood still and the other moved.
fn still(plant: &Table, angle: &str, other: &str) -> Option<Vec<usize>> {
    let (values, beside) = (plant.column(angle)?, plant.column(other)?);
    let rows: Vec<usize> = (0..values.len()).filter(|row| values[*row].is_finite()).collect();
    let measured: Vec<f64> = rows.iter().map(|row| values[*row]).collect();
    let moves = |from: usize, to: usize| {
        let there = rows[from..=to].iter().map(|row| beside[*row]).filter(|angle| angle.is_finite());
        let (low, high) = there
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), angle| (low.min(angle), high.max(angle)));
        high - low > POLICY.least_motion
    };
    let (from, to) = stood_still(&measured, &moves)?;
    moves(from, to).then(|| rows[from..=to].to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::random::Random;

    /// Rows 100 to 139 of an arm that sways, whose q2 stands still there, while q1 turns by so much.
    fn found(turns: f64) -> (Vec<Notice>, Vec<usize>) {
        let mut random = Random::new(4);
        let time: Vec<f64> = (0..300).map(|row| f64::from(row) / 30.0).collect();
        let q1 = (0..300).map(|row| turns * (f64::from(row) - 100.0) / 39.0).collect();
        let mut q2: Vec<f64> =
            time.iter().map(|time| 0.4 * libm::sin(4.0 * time) + 2e-4 * random.normal()).collect();
        (101..140).for_each(|row| q2[row] = q2[100]);
        let plant = Some(Table::new(time, vec![("q1".into(), q1), ("q2".into(), q2)]));
        let mut run = Run { name: "run-01".into(), camera: None, controller: None, plant };
        let mut notices = Vec::new();
        exclude(&mut run, &mut notices);
        let q2 = run.plant.as_ref().and_then(|log| log.column("q2")).unwrap_or(&[]);
        (notices, (0..q2.len()).filter(|row| q2[*row].is_nan()).collect())
    }

    #[test]
    fn every_row_of_an_encoder_that_stood_still_is_told_and_not_measured() {
        let (notices, rows) = found(0.3);
        assert_eq!(rows, (100..140).collect::<Vec<_>>());
        assert_eq!((notices.len(), notices[0].line), (1, 102));
        assert!(notices[0].message.contains("up to line 141, in 40 rows"), "{}", notices[0].message);
    }

    #[test]
    fn value_the_other_link_must_move_by_a_fiftieth_of_a_radian() {
        assert_eq!([0.0195, 0.0205].map(|turns| found(turns).1.len()), [0, 40]);
    }
}
