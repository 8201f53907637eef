//! Logs of an even clock whose times were rounded for the file, to a millisecond say: rows are taken at the clock's ticks. A torque that
//! changes at 1/30 s is a third of a millisecond off otherwise, which is more than low noise leaves unseen.

use super::{Run, Table};
use crate::error::Notice;
use crate::rigs::acrobot::dataset::policy::LOGS;
use crate::statistics::levels::{FINE, HALF, SEVERAL, SMALL, STEP};
use crate::text::brief;

/// Puts all logs at their ticks.
pub fn unround(run: &mut Run, notices: &mut Vec<Notice>) {
    let Run { name, camera, controller, plant } = run;
    let logs = [("camera.csv", camera), ("controller.csv", controller), ("plant.csv", plant)];
    for (file, log) in logs.map(|(file, log)| (file, log.as_mut())) {
        let Some((log, found)) = log.and_then(|log| ticks(&log.time).map(|found| (log, found))) else {
            continue;
        };
        let message = format!(
            "times are rounded to {} s, and the rows are those of an even clock of {} s: they are taken at its ticks",
            brief(found.decimal),
            brief(found.interval)
        );
        notices.push(Notice { file: format!("{name}/{file}"), line: 0, message });
        found.put(log);
    }
}

/// An even clock behind rounded times.
struct Clock {
    decimal: f64,
    interval: f64,
    ticks: Vec<f64>,
}

impl Clock {
    /// Whether times were rounded to the nearest decimal or down, nobody knows: they are all off alike by as much.
    fn put(self, log: &mut Table) {
        log.tick_error = self.decimal / 12.0_f64.sqrt();
        log.time = self.ticks;
    }
}

/// The clock, if all times are whole decimals and none is further from its tick than rounding takes it. Rows may be missing.
fn ticks(time: &[f64]) -> Option<Clock> {
    if time.len() < LOGS.even_rows {
        return None;
    }
    let decimal = quantum(time)?;
    let mut gaps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    gaps.sort_by(f64::total_cmp);
    let mut interval = gaps[gaps.len() / 2];
    if decimal > HALF * interval {
        return None;
    }
    // counted from the first: a sum of epochs is only known to 50 µs a row
    let since: Vec<f64> = time.iter().map(|at| at - time[0]).collect();
    let mut first = 0.0;
    for _ in 0..LOGS.few {
        (first, interval) = through(&since, interval);
    }
    let tick = |since: &f64| first + interval * ((since - first) / interval).round();
    let off: Vec<f64> = since.iter().map(|since| since - tick(since)).collect();
    let (low, high) = off
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), off| (low.min(*off), high.max(*off)));
    // rounding spreads rows over a decimal; a few that came late among many on time were not rounded
    let spread = (off.iter().map(|off| off * off).sum::<f64>() / off.len() as f64).sqrt();
    let rounded = spread > LOGS.spread * decimal && high - low < (1.0 + SMALL) * decimal;
    let ticks: Vec<f64> = since.iter().map(|since| time[0] + tick(since)).collect();
    // two rows at one tick are none of an even clock's
    let each = ticks.windows(2).all(|pair| pair[1] - pair[0] > HALF * interval);
    (rounded && each).then_some(Clock { decimal, interval, ticks })
}

/// What times are whole numbers of from the first one on, s: of a decimal, or of so many as a clock of 250 Hz counts in.
fn quantum(time: &[f64]) -> Option<f64> {
    let whole = |decimal: f64| {
        let off = |time: &f64| (time / decimal - (time / decimal).round()).abs();
        time.iter().all(|time| off(time) < FINE + SEVERAL * f64::EPSILON * time.abs() / decimal)
    };
    let mut decimals = [SMALL, STEP, FINE, SMALL * FINE].into_iter();
    let decimal = decimals.find(|decimal| whole(*decimal))?;
    let counts = time.iter().map(|at| ((at - time[0]) / decimal).round().abs() as u64);
    Some(decimal * counts.fold(0, divisor).max(1) as f64)
}

/// The greatest common divisor.
fn divisor(one: u64, other: u64) -> u64 {
    if other == 0 { one } else { divisor(other, one % other) }
}

/// The line through times against the numbers of their ticks: the first tick, and how far apart they are, s.
fn through(since: &[f64], interval: f64) -> (f64, f64) {
    // each from the one before: over a whole log an interval that is a tenth off would lose count
    let mut number = 0.0;
    let mut numbers = vec![number];
    for pair in since.windows(2) {
        number += ((pair[1] - pair[0]) / interval).round();
        numbers.push(number);
    }
    let n = since.len() as f64;
    let (x, y) = (numbers.iter().sum::<f64>() / n, since.iter().sum::<f64>() / n);
    let across: f64 = numbers.iter().zip(since).map(|(number, since)| (number - x) * (since - y)).sum();
    let slope = across / numbers.iter().map(|number| (number - x) * (number - x)).sum::<f64>();
    (y - slope * x, slope)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::random::Random;

    fn rounded(time: f64, decimal: f64) -> f64 {
        (time / decimal).round() * decimal
    }

    /// By how much ticks are off at most, s, that are found behind 900 times 1/30 s apart, rounded so.
    fn off(decimal: f64, begin: f64, kept: &dyn Fn(usize) -> bool) -> Option<f64> {
        let truth: Vec<f64> =
            (0..900).filter(|row| kept(*row)).map(|row| begin + row as f64 / 30.0).collect();
        let time: Vec<f64> = truth.iter().map(|time| rounded(*time, decimal)).collect();
        let found = ticks(&time)?;
        assert_eq!(found.decimal, decimal);
        Some(found.ticks.iter().zip(&truth).map(|(tick, truth)| (tick - truth).abs()).fold(0.0, f64::max))
    }

    #[test]
    fn recovers_the_ticks_behind_milliseconds_and_hundredths() {
        // a third of what times are rounded to, by which three rows in turn may be off in the mean
        assert!(off(1e-3, 0.0123, &|_| true).is_some_and(|off| off < 0.4e-3));
        assert!(off(1e-2, 0.0, &|_| true).is_some_and(|off| off < 4e-3));
        // an epoch, and rows that are missing
        assert!(off(1e-3, 1.7e9 + 0.004, &|row| row % 7 != 3).is_some_and(|off| off < 0.4e-3));
    }

    #[test]
    fn recovers_the_ticks_behind_the_counts_of_another_clock() {
        // 60 Hz in counts of 4 ms, cut off
        let truth: Vec<f64> = (0..900).map(|row| f64::from(row) / 60.0).collect();
        let time: Vec<f64> =
            truth.iter().map(|time| ((time / 0.004 + 1e-9).floor() * 4.0).round() / 1e3).collect();
        let found = ticks(&time).expect("an even clock");
        assert!((found.decimal - 0.004).abs() < 1e-12, "{}", found.decimal);
        let off: Vec<f64> = found.ticks.iter().zip(&truth).map(|(tick, truth)| tick - truth).collect();
        // all alike; a line through a sawtooth of 4 ms is off by less than a hundredth of it at its ends
        let first = off[0];
        assert!(first.abs() < 0.004 && off.iter().all(|off| (off - first).abs() < 4e-5), "{first}");
    }

    #[test]
    fn every_log_of_a_run_is_taken_at_its_ticks() {
        let log = || {
            Some(Table::new((0..200).map(|row| rounded(f64::from(row) / 30.0, 1e-2)).collect(), Vec::new()))
        };
        let mut run = Run { name: "run-01".into(), camera: log(), controller: log(), plant: log() };
        let mut notices = Vec::new();
        unround(&mut run, &mut notices);
        let files: Vec<&str> = notices.iter().map(|notice| notice.file.as_str()).collect();
        assert_eq!(files, ["run-01/camera.csv", "run-01/controller.csv", "run-01/plant.csv"]);
        let (camera, plant) = (run.camera.map(|log| log.time), run.plant.map(|log| log.time));
        assert!(camera == plant && camera.is_some_and(|time| (time[100] - 100.0 / 30.0).abs() < 4e-3));
    }

    #[test]
    fn value_rows_that_rounding_spreads_by_less_than_a_tenth_of_a_decimal_came_late() {
        // one row in 200 and one in 30, a millisecond late: 0.07 and 0.18 of it, root mean square
        let found = |each: usize| {
            let late = |row: usize| if row % each == 7 { 1e-3 } else { 0.0 };
            ticks(&(0..200).map(|row| rounded(row as f64 / 20.0 + late(row), 1e-3)).collect::<Vec<_>>())
                .is_some()
        };
        assert_eq!([200, 30].map(found), [false, true]);
    }

    #[test]
    fn every_other_log_stays_as_it_is() {
        let mut random = Random::new(2);
        let even: Vec<f64> = (0..200).map(|row| f64::from(row) * 0.005).collect();
        assert!(ticks(&even).is_none());
        // not rounded
        assert!(ticks(&(0..200).map(|row| f64::from(row) / 30.0).collect::<Vec<_>>()).is_none());
        // rounded, but rows come when they come
        let ragged: Vec<f64> =
            (0..200).map(|row| rounded(f64::from(row) / 30.0 + 2e-3 * random.normal(), 1e-3)).collect();
        assert!(ticks(&ragged).is_none());
        // one row in 200 that came 2 ms late
        let mut late: Vec<f64> = (0..200).map(|row| rounded(f64::from(row) / 30.0, 1e-3)).collect();
        assert!(ticks(&late).is_some());
        late[120] += 2e-3;
        assert!(ticks(&late).is_none());
        // a row that was written twice, a millisecond later, of a clock that needs no rounding and of one that does
        for apart in [20.0, 30.0] {
            let mut twice: Vec<f64> = (0..200).map(|row| rounded(f64::from(row) / apart, 1e-3)).collect();
            twice.insert(121, twice[120] + 1e-3);
            assert!(ticks(&twice).is_none(), "{apart}");
        }
    }
}
