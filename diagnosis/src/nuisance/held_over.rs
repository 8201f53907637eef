//! Readings that were held over: rows that repeat the one before, digit by digit, in a log whose noise leaves no two rows alike. Such a row says
//! again what the one before said, at the wrong time. It was late, or the sensor is slower than the log.

use super::policy::NUISANCE;
use crate::statistics::levels::{HALF, ROUNDING, SAMPLE};

/// The rows that repeat the one before, if some do and chance has none of it.
pub fn held_over(values: &[f64]) -> Option<Vec<usize>> {
    let measured: Vec<usize> = (0..values.len()).filter(|row| values[*row].is_finite()).collect();
    let repeats = |pair: &&[usize]| values[pair[0]] == values[pair[1]];
    let rows: Vec<usize> = measured.windows(2).filter(repeats).map(|pair| pair[1]).collect();
    let often = rows.len() as f64 / measured.len().max(1) as f64;
    let is_fresh = |pair: &&[usize]| !repeats(pair);
    let mut fresh: Vec<f64> = measured.iter().take(1).map(|row| values[*row]).collect();
    fresh.extend(measured.windows(2).filter(is_fresh).map(|pair| values[pair[1]]));
    let in_turn = longest(values, &measured);
    let seldom = often <= HALF && in_turn <= NUISANCE.in_turn;
    let steady =
        fresh.len() >= SAMPLE && (in_turn * fresh.len()) as f64 <= NUISANCE.steady * measured.len() as f64;
    if rows.len() < NUISANCE.in_turn || !(seldom || steady) || is_coarse(&fresh) {
        return None;
    }
    fresh.sort_by(f64::total_cmp);
    // where few numbers can be told, be it by an encoder's codes or by the file's digits, rows that lie apart are alike, too
    let alike = fresh.windows(2).filter(|pair| pair[0] == pair[1]).count() as f64 / fresh.len() as f64;
    (often > NUISANCE.times * alike).then_some(rows)
}

/// Most rows in turn that repeat the one before: an arm at rest without any noise repeats for long.
fn longest(values: &[f64], measured: &[usize]) -> usize {
    let mut most = (0, 0);
    for pair in measured.windows(2) {
        let again = if values[pair[0]] == values[pair[1]] { most.0 + 1 } else { 0 };
        most = (again, most.1.max(again));
    }
    most.1
}

/// Whether values change by few steps of a converter, or of the file's digits: what rises slowly repeats itself then, and no value comes again.
fn is_coarse(fresh: &[f64]) -> bool {
    let mut changes: Vec<f64> = fresh.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    changes.sort_by(f64::total_cmp);
    let least = ROUNDING * changes.last().copied().unwrap_or(0.0);
    let sizes = changes.windows(2).filter(|pair| pair[1] - pair[0] > least).count() + 1;
    sizes < SAMPLE
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::random::Random;

    /// A swing with noise, rounded to a quantum, of which each of these rows repeats the one before.
    fn log(quantum: f64, repeats: impl Fn(usize) -> bool) -> Vec<f64> {
        let mut random = Random::new(3);
        let mut values: Vec<f64> = (0..1000)
            .map(|row| 0.4 * libm::sin(0.04 * row as f64) + 2e-4 * random.normal())
            .map(|value| (value / quantum).round() * quantum)
            .collect();
        (1..1000).filter(|row| repeats(*row)).for_each(|row| values[row] = values[row - 1]);
        values
    }

    #[test]
    fn every_row_that_repeats_the_one_before_is_found() {
        let found = held_over(&log(1e-9, |row| row % 20 == 7));
        assert_eq!(found, Some((0..50).map(|k| 7 + 20 * k).collect()));
        assert_eq!(held_over(&log(1e-9, |_| false)), None);
        // every other row of a log that is twice as dense as its encoder
        assert_eq!(held_over(&log(1e-9, |row| row % 2 == 1)).map(|rows| rows.len()), Some(500));
    }

    #[test]
    fn law_what_is_rounded_or_at_rest_repeats_itself() {
        // an encoder of 4096 codes repeats where the arm turns back
        assert_eq!(held_over(&log(std::f64::consts::TAU / 4096.0, |_| false)), None);
        // codes written with too few digits to be whole numbers of anything, at rest in noise of two of them: one row in seven
        let mut random = Random::new(9);
        let codes: Vec<f64> =
            (0..60).map(|_| (10.0 * (2.0 * random.normal()).round() * 1.534).round() / 1e4).collect();
        let again = codes.windows(2).filter(|pair| pair[0] == pair[1]).count();
        assert!(
            again >= NUISANCE.in_turn && longest(&codes, &(0..60).collect::<Vec<_>>()) <= NUISANCE.in_turn,
            "{again}"
        );
        assert_eq!(held_over(&codes), None);
        let rest: Vec<f64> = (0..300).map(|row| f64::from(row.max(100))).collect();
        assert_eq!(held_over(&rest), None);
    }

    #[test]
    fn value_three_rows_are_the_fewest_and_three_in_turn_the_most() {
        let few = |count: usize| held_over(&log(1e-9, |row| row % 100 == 7 && row / 100 < count)).is_some();
        assert_eq!([2, 3].map(few), [false, true]);
        let turns = |length: usize| held_over(&log(1e-9, |row| (1..=length).contains(&(row % 50)))).is_some();
        assert_eq!([3, 4].map(turns), [true, false]);
    }

    #[test]
    fn law_a_sensor_that_is_slower_than_its_log_is_told_from_a_coarse_one() {
        let rows = |values: &[f64]| held_over(values).map(|rows| rows.len());
        assert_eq!(rows(&log(1e-9, |row| row % 10 != 0)), Some(900));
        // a slow rise in steps of a converter: each value once, for five rows
        let rise: Vec<f64> = (0..1000).map(|row| 0.1 * f64::from(row / 5)).collect();
        assert_eq!(rows(&rise), None);
        // and a quicker one in noise of less than a step: one row in three repeats the one before
        let mut random = Random::new(7);
        let mut warms = || 0.67 + 0.05 * random.normal();
        let mut at = 0.0;
        let rise: Vec<f64> = (0..1000)
            .map(|_| {
                at += warms();
                f64::round(at) * 0.1
            })
            .collect();
        assert!(rise.windows(2).filter(|pair| pair[0] == pair[1]).count() > 250);
        assert_eq!(rows(&rise), None);
        // one that moves now and then: it repeats itself for far longer than usual
        assert_eq!(rows(&log(1e-9, |row| row % 10 != 0 || (200..300).contains(&row))), None);
        assert_eq!(rows(&log(1e-9, |row| row % 10 != 0)[..280]), None, "28 values are few");
    }
}
