//! Rates that tell nothing, or something else than the angles beside them: differences of those angles, one value throughout, another
//! unit or sign. Angles hold what such a column could say, so it goes, with a notice.

use super::row_times::typical_gap;
use super::{Run, Table};
use crate::error::Notice;
use crate::rigs::acrobot::dataset::policy::LOGS;
use crate::rigs::acrobot::policy::POLICY;
use crate::text::brief;

/// Rates and the angles whose they are.
const PAIRS: [(&str, &str); 2] = [("dq1", "q1"), ("dq2", "q2")];

/// Factors by which a rate comes out in another unit, and what it is then.
fn units() -> [(f64, &'static str); 3] {
    let turn = std::f64::consts::TAU;
    [
        (1.0_f64.to_degrees(), "degrees a second"),
        (60.0 / turn, "turns a minute"),
        (1.0 / turn, "turns a second"),
    ]
}

/// Takes such columns out of `plant.csv`.
pub fn exclude(run: &mut Run, notices: &mut Vec<Notice>) {
    let Some(plant) = &mut run.plant else { return };
    for (rate, angle) in PAIRS {
        let Some(why) = fault(plant, rate, angle) else { continue };
        let message = format!("{why}; column `{rate}` excluded");
        notices.push(Notice { file: format!("{}/plant.csv", run.name), line: 1, message });
        plant.remove(rate);
    }
}

/// What is wrong with a rate, if anything.
fn fault(plant: &Table, rate: &str, angle: &str) -> Option<String> {
    let (rates, angles) = (plant.column(rate)?, plant.column(angle)?);
    let near = neighbours(plant, rates, angles);
    if near.len() < POLICY.rows {
        return None;
    }
    constant(rates, angles, rate, angle)
        .or_else(|| differences(&near, rate, angle))
        .or_else(|| other_scale(&near, rate, angle))
}

/// A rate and what the angle's differences give there, rad/s: central, backward and forward.
struct Near {
    rate: f64,
    differences: [f64; 3],
}

/// Rows whose neighbours are there and no further off than usual.
fn neighbours(plant: &Table, rates: &[f64], angles: &[f64]) -> Vec<Near> {
    let usual = typical_gap(plant).unwrap_or(0.0);
    let rows = 1..plant.len().saturating_sub(1);
    rows.filter_map(|row| {
        let (before, after) = (plant.time[row] - plant.time[row - 1], plant.time[row + 1] - plant.time[row]);
        let (back, on) = (angles[row] - angles[row - 1], angles[row + 1] - angles[row]);
        let near = Near {
            rate: rates[row],
            differences: [(back + on) / (before + after), back / before, on / after],
        };
        let known = near.rate.is_finite() && near.differences.iter().all(|x| x.is_finite());
        (known && before.max(after) < LOGS.neighbour * usual).then_some(near)
    })
    .collect()
}

/// One value throughout, while the angle moves.
fn constant(rates: &[f64], angles: &[f64], rate: &str, angle: &str) -> Option<String> {
    let span = |values: &[f64]| {
        let known = || values.iter().copied().filter(|value| value.is_finite());
        known().fold(f64::NEG_INFINITY, f64::max) - known().fold(f64::INFINITY, f64::min)
    };
    let value = rates.iter().find(|value| value.is_finite())?;
    let moves = span(angles);
    (span(rates) == 0.0 && moves > POLICY.least_motion).then(|| {
        format!("{rate} is {} rad/s in all rows, while {angle} moves by {} rad", brief(*value), brief(moves))
    })
}

/// The difference of angles from row to row, in nearly all rows.
fn differences(near: &[Near], rate: &str, angle: &str) -> Option<String> {
    let square: f64 = near.iter().map(|row| row.rate * row.rate).sum();
    let close = LOGS.rounded * (square / near.len() as f64).sqrt();
    let share = |way: usize| {
        let same = near.iter().filter(|row| (row.rate - row.differences[way]).abs() < close).count();
        same as f64 / near.len() as f64
    };
    let ways = ["central", "backward", "forward"];
    let way = (0..ways.len()).find(|way| share(*way) > LOGS.nearly_all)?;
    Some(format!(
        "{rate} is the {} difference of {angle} in nearly all rows and says nothing beyond it",
        ways[way]
    ))
}

/// Another unit or sign: in proportion to the angle's differences, but by another factor.
fn other_scale(near: &[Near], rate: &str, angle: &str) -> Option<String> {
    let sum = |of: &dyn Fn(&Near) -> f64| near.iter().map(of).sum::<f64>();
    let (own, cross) =
        (sum(&|row| row.differences[0] * row.differences[0]), sum(&|row| row.rate * row.differences[0]));
    let square = sum(&|row| row.rate * row.rate);
    let alike = cross * cross / (own * square);
    let factor = cross / own;
    let proportional = alike > LOGS.in_proportion;
    if !proportional || (factor > 0.0 && factor.ln().abs() < LOGS.other_scale) {
        return None;
    }
    let unit = units().into_iter().find(|(by, _)| (factor / by).abs().ln().abs() < LOGS.other_scale);
    let question = match unit {
        Some((_, unit)) => format!("are these {unit}?"),
        None if (-factor).ln().abs() < LOGS.other_scale => "is its sign turned?".to_owned(),
        None => "in which unit is it?".to_owned(),
    };
    Some(format!("{rate} is {} times as fast as {angle} moves ({question})", brief(factor)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::random::Random;

    const STEP: f64 = 0.01;

    /// What is said of a log that swings once a second by 1 rad and was read to 0.1 mrad, whose rate is made of time and angles.
    fn said(rate: &mut dyn FnMut(usize, &[f64]) -> f64) -> Option<String> {
        let mut random = Random::new(3);
        let angles: Vec<f64> = (0..300)
            .map(|row| libm::sin(std::f64::consts::TAU * row as f64 * STEP) + 1e-4 * random.normal())
            .collect();
        let rates = (0..angles.len()).map(|row| rate(row, &angles)).collect();
        let time = (0..angles.len()).map(|row| row as f64 * STEP).collect();
        fault(&Table::new(time, vec![("q1".into(), angles), ("dq1".into(), rates)]), "dq1", "q1")
    }

    fn measured(row: usize) -> f64 {
        std::f64::consts::TAU * libm::cos(std::f64::consts::TAU * row as f64 * STEP)
    }

    #[test]
    fn a_rate_that_was_measured_stays() {
        let mut random = Random::new(4);
        assert_eq!(said(&mut |row, _| measured(row) + 0.01 * random.normal()), None);
        // a tachometer that reads a tenth too much is a matter of the model
        assert_eq!(said(&mut |row, _| 1.1 * measured(row) + 0.01 * random.normal()), None);
    }

    #[test]
    fn differences_of_the_angles_say_nothing() {
        let at = |angles: &[f64], row: usize| angles[row.min(angles.len() - 1)];
        let backward = |row: usize, angles: &[f64]| (angles[row] - angles[row.saturating_sub(1)]) / STEP;
        let central =
            |row: usize, angles: &[f64]| (at(angles, row + 1) - angles[row.saturating_sub(1)]) / (2.0 * STEP);
        assert!(said(&mut { backward }).is_some_and(|said| said.contains("backward difference of q1")));
        assert!(said(&mut { central }).is_some_and(|said| said.contains("central difference of q1")));
        // one row in 12 that was not
        let mut mostly =
            |row: usize, angles: &[f64]| if row.is_multiple_of(8) { 9.0 } else { central(row, angles) };
        assert_eq!(said(&mut mostly), None);
    }

    #[test]
    fn every_other_unit_or_sign_is_told() {
        for (factor, told) in [
            (57.3, Some("degrees a second")),
            (9.55, Some("turns a minute")),
            (0.159, Some("turns a second")),
            (-1.0, Some("sign")),
            (3.0, Some("which unit")),
            (1.4, Some("which unit")),
            (1.2, None),
        ] {
            let said = said(&mut |row, _| factor * measured(row));
            assert_eq!(said.is_some(), told.is_some(), "{factor}: {said:?}");
            assert!(told.is_none_or(|told| said.is_some_and(|said| said.contains(told))), "{factor}");
        }
    }

    #[test]
    fn one_value_throughout_is_no_rate_of_what_moves() {
        assert!(said(&mut |_, _| 0.0).is_some_and(|said| said.contains("0 rad/s in all rows")));
        let rest = Table::new(
            (0..50).map(|row| f64::from(row) * STEP).collect(),
            vec![("q1".into(), vec![0.2; 50]), ("dq1".into(), vec![0.0; 50])],
        );
        assert_eq!(fault(&rest, "dq1", "q1"), None);
    }
}
