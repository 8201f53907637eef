//! Logs of an even clock whose timestamps scatter: the ticks that rows were taken at.

use super::{DataSet, Run, Table};
use crate::error::Notice;
use crate::rigs::acrobot::dataset::policy::LOGS;

/// Even times through timestamps that scatter about them, and by how much they do, s.
fn ticks(time: &[f64]) -> Option<(Vec<f64>, f64)> {
    if time.len() < LOGS.even_rows {
        return None;
    }
    // counted from the first: a sum of epochs is only known to 50 µs a row
    let first = time[0];
    let since: Vec<f64> = time.iter().map(|time| time - first).collect();
    let n = time.len() as f64;
    let (middle, mean) = (0.5 * (n - 1.0), since.iter().sum::<f64>() / n);
    let place = |row: usize| row as f64 - middle;
    let across: f64 = since.iter().enumerate().map(|(row, time)| place(row) * (time - mean)).sum();
    let interval = across / (0..time.len()).map(|row| place(row) * place(row)).sum::<f64>();
    let ticks: Vec<f64> = (0..time.len()).map(|row| mean + interval * place(row)).collect();
    let off: Vec<f64> = since.iter().zip(&ticks).map(|(time, tick)| time - tick).collect();
    let square: f64 = off.iter().map(|off| off * off).sum();
    let along: f64 = off.windows(2).map(|pair| pair[0] * pair[1]).sum();
    let scatter = (square / n).sqrt();
    // what a torque's step is off by is a time, however far its rows are apart
    let scatters = scatter > LOGS.known && scatter < LOGS.tick_scatter * interval;
    let known = scatter < LOGS.known * n.sqrt();
    let ticks = ticks.into_iter().map(|tick| first + tick).collect();
    (scatters && known && along.abs() < LOGS.wanders * square).then_some((ticks, scatter))
}

impl DataSet {
    /// The data with the rows of plant and controller at even times, where timestamps scatter about such; `None` where none do.
    pub fn at_ticks(&self) -> Option<Self> {
        let mut ticked = self.clone();
        let mut told = Vec::new();
        for run in &mut ticked.runs {
            let Run { name, controller, plant, .. } = run;
            let logs = [("controller.csv", controller.as_mut()), ("plant.csv", plant.as_mut())];
            for (file, log) in logs.into_iter().filter_map(|(file, log)| Some((file, log?))) {
                told.extend(put_at_ticks(log).map(|scatter| Notice {
                    file: format!("{name}/{file}"),
                    line: 0,
                    message: format!(
                        "timestamps jitter by {:.2} ms about an even clock, and the motion fits its ticks better: rows are taken \
                         at these",
                        1e3 * scatter
                    ),
                }));
            }
        }
        let some = !told.is_empty();
        ticked.notices.extend(told);
        some.then_some(ticked)
    }
}

/// Puts a log's rows at the ticks, and tells by how much they were off.
fn put_at_ticks(log: &mut Table) -> Option<f64> {
    let (ticks, scatter) = ticks(&log.time)?;
    // a line through n points is off by σ √(2/n), root mean square over them
    log.tick_error = scatter * (2.0 / log.len() as f64).sqrt();
    log.time = ticks;
    Some(scatter)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::random::Random;

    fn stamped(off: &mut dyn FnMut(usize) -> f64) -> Vec<f64> {
        (0..400).map(|row| 10.0 + 0.005 * row as f64 + off(row)).collect()
    }

    #[test]
    fn recovers_the_ticks_that_stamps_scatter_about() {
        let mut random = Random::new(3);
        let (found, scatter) = ticks(&stamped(&mut |_| 3e-4 * random.normal())).expect("they scatter");
        // an end of a line through 400 points is known to 2 σ / √400
        let worst = found.iter().enumerate().map(|(row, tick)| (tick - 10.0 - 0.005 * row as f64).abs());
        assert!(worst.fold(0.0, f64::max) < 1e-4 && (scatter - 3e-4).abs() < 3e-5, "{scatter}");
    }

    #[test]
    fn value_ticks_are_off_by_as_much_as_they_are_said_to_be() {
        let mut random = Random::new(6);
        let ratios = (0..60).map(|_| {
            let mut log = Table::new(stamped(&mut |_| 3e-4 * random.normal()), Vec::new());
            put_at_ticks(&mut log).expect("they scatter");
            let off = log.time.iter().enumerate().map(|(row, tick)| tick - 10.0 - 0.005 * row as f64);
            off.map(|off| off * off).sum::<f64>() / log.len() as f64 / log.tick_error.powi(2)
        });
        let mean = ratios.sum::<f64>() / 60.0;
        // of two values a log: a mean of 120 squares scatters by 0.13, thrice
        assert!((mean - 1.0).abs() < 0.4, "{mean}");
    }

    #[test]
    fn recovers_as_many_ticks_of_an_epoch() {
        let mut random = Random::new(5);
        let time: Vec<f64> = (0..100_000).map(|row| 0.001 * row as f64 + 1e-4 * random.normal()).collect();
        let late: Vec<f64> = time.iter().map(|time| time + 1.7e9).collect();
        let (here, there) = (ticks(&time).expect("they scatter").0, ticks(&late).expect("the same"));
        let worst = here.iter().zip(&there.0).map(|(here, there)| (there - here - 1.7e9).abs());
        // doubles there are 2.4e-7 s apart
        assert!(worst.fold(0.0, f64::max) < 1e-6);
    }

    #[test]
    fn value_times_off_by_a_third_of_a_millisecond_are_put_at_ticks_at_any_rate() {
        for interval in [0.005, 1.0 / 30.0, 0.1] {
            let mut random = Random::new(6);
            let off = |size: f64, random: &mut Random| {
                let time: Vec<f64> =
                    (0..600).map(|row| interval * row as f64 + size * random.normal()).collect();
                ticks(&time).map(|(_, scatter)| scatter)
            };
            let found = off(3.5e-4, &mut random).expect("it scatters");
            // 600 rows tell it to 3 %
            assert!((found / 3.5e-4 - 1.0).abs() < 0.12, "{found}");
            // half and twice of what ticks are known to
            assert!(off(1e-5, &mut random).is_none() && off(4e-5, &mut random).is_some());
        }
    }

    #[test]
    fn every_clock_that_wanders_or_loses_rows_is_left() {
        let mut random = Random::new(4);
        let mut walk = 0.0;
        let wandering = stamped(&mut |_| {
            walk += 2e-4 * random.normal();
            walk
        });
        assert!(ticks(&wandering).is_none());
        assert!(ticks(&stamped(&mut |row| if row < 200 { 0.0 } else { 0.005 })).is_none());
        // nor is there anything to do for one that is even
        assert!(ticks(&stamped(&mut |_| 0.0)).is_none());
        // 2 ms in 400 rows leave ticks 0.1 ms off
        assert!(ticks(&stamped(&mut |_| 2e-3 * random.normal().clamp(-1.0, 1.0))).is_none());
    }
}
