//! A sensor that stood still: a stretch of one value in a log whose noise hardly ever repeats a value elsewhere.

use super::Doubt;
use super::policy::DOUBTS;
use crate::nuisance::{least_gap, scatter};
use crate::observe::{Problem, Role};
use crate::statistics::levels::MORE;

/// A compared channel of a run that stood still for a while.
pub(super) fn still(problem: &Problem) -> Option<Doubt> {
    for run in &problem.runs {
        for (channel, series) in problem.channels.iter().zip(&run.series) {
            let found = stood_still(&series.values, &|_, _| false);
            let Some((from, to)) = found.filter(|_| channel.role == Role::Compared) else {
                continue;
            };
            let time = |row: usize| series.time[row] / run.seconds;
            return Some(Doubt {
                line: channel.line,
                sentence: format!(
                    "{}: column {:?} ({}) has one value from time {} to {}, in {} rows, and elsewhere a new one nearly every row: \
                     the sensor stood still",
                    run.name,
                    channel.column,
                    channel.name,
                    time(from),
                    time(to),
                    to + 1 - from
                ),
                add: "Leave its cells empty there: an empty cell was not measured then".into(),
            });
        }
    }
    None
}

/// First and last row of the longest stretch of one value, where that can't be. `moves` says whether all else shows that what is measured
/// moved between two rows: else the noise must.
pub(crate) fn stood_still(values: &[f64], moves: &dyn Fn(usize, usize) -> bool) -> Option<(usize, usize)> {
    let (mut longest, mut begin) = ((0, 0), 0);
    for row in 1..=values.len() {
        if row == values.len() || values[row] != values[begin] {
            if row - begin > longest.1 - longest.0 {
                longest = (begin, row);
            }
            begin = row;
        }
    }
    let (from, to) = longest;
    if to - from < DOUBTS.still_rows {
        return None;
    }
    let elsewhere = [&values[..from], &values[to..]];
    let others: usize = elsewhere.iter().map(|part| part.len()).sum();
    let pairs = || elsewhere.iter().flat_map(|part| part.windows(2));
    let same = pairs().filter(|pair| pair[0] == pair[1]).count() as f64 / pairs().count().max(1) as f64;
    let noise = scatter(&elsewhere);
    let noisy = noise.noise >= noise.quantum && noise.noise > 0.0;
    let told = others >= DOUBTS.other_rows
        && same <= DOUBTS.repeats
        && (moves(from, to - 1) || alternates(&elsewhere) >= DOUBTS.alternates && noisy);
    let sound = || stays(values, from, to, noise.noise) || is_rounded(values, from, to, noise.noise);
    (told && !sound()).then_some((from, to - 1))
}

/// Whether one value is what a sound sensor says of a steady course: its log's step is larger than its noise, so it repeats its values where
/// little moves, however seldom it does elsewhere, and the rows around lie within a step: nothing moved meanwhile.
fn is_rounded(values: &[f64], from: usize, to: usize, noise: f64) -> bool {
    let step = least_gap(values);
    // one step is near one, and two are not
    let near = |row: Option<usize>| {
        row.and_then(|row| values.get(row)).is_none_or(|near| (near - values[from]).abs() < MORE * step)
    };
    noise < step && near(from.checked_sub(1)) && near(Some(to))
}

/// How often third differences change their sign from row to row, as a share.
pub(super) fn alternates(parts: &[&[f64]]) -> f64 {
    let thirds: Vec<Vec<f64>> = parts
        .iter()
        .map(|part| part.windows(4).map(|v| v[3] - 3.0 * v[2] + 3.0 * v[1] - v[0]).collect())
        .collect();
    let turns = || thirds.iter().flat_map(|part| part.windows(2)).map(|pair| pair[0] * pair[1] < 0.0);
    turns().filter(|turns| *turns).count() as f64 / turns().count().max(1) as f64
}

/// Whether a value is one at which a sound sensor stays: zero, or the end of the log's range, reached without a jump.
fn stays(values: &[f64], from: usize, to: usize, noise: f64) -> bool {
    let value = values[from];
    let end = values.iter().all(|other| *other <= value) || values.iter().all(|other| *other >= value);
    let jumps = |row: Option<usize>| {
        row.and_then(|row| values.get(row)).is_none_or(|near| (near - value).abs() > DOUBTS.jump * noise)
    };
    (value == 0.0 || end) && !(jumps(from.checked_sub(1)) && jumps(Some(to)))
}

#[cfg(test)]
mod tests {
    use super::stood_still;
    use crate::observe::Series;
    use crate::statistics::random::Random;

    fn stretch(series: &Series) -> Option<(usize, usize)> {
        stood_still(&series.values, &|_, _| false)
    }

    #[test]
    fn every_sensor_that_stands_still_where_all_else_moves_stood_still() {
        // a swing of twenty rows bends more from row to row than the noise
        let mut values = series(|row, random| libm::sin(0.3 * row as f64) + 1e-4 * random.normal()).values;
        let held = values[125];
        (125..150).for_each(|row| values[row] = held);
        assert_eq!(stood_still(&values, &|_, _| false), None, "it may have come to rest");
        assert_eq!(stood_still(&values, &|from, to| (from, to) == (125, 149)), Some((125, 149)));
    }

    fn series(value: impl Fn(usize, &mut Random) -> f64) -> Series {
        let mut random = Random::new(9);
        let values: Vec<f64> = (0..400).map(|row| value(row, &mut random)).collect();
        Series { time: (0..400).map(|row| row as f64 * 0.01).collect(), values }
    }

    #[test]
    fn law_a_sensor_that_stood_still_is_told_from_rest_and_from_rounding() {
        let wave = |row: usize| libm::sin(0.03 * row as f64);
        let stood = |noise: f64, quantum: f64| {
            let held = std::cell::Cell::new(0.0);
            series(|row, random| {
                let own = wave(row) + noise * random.normal();
                if !(120..150).contains(&row) {
                    held.set(if quantum > 0.0 { (own / quantum).round() * quantum } else { own });
                }
                held.get()
            })
        };
        assert_eq!(stretch(&stood(0.01, 0.0)), Some((119, 149)));
        assert_eq!(stretch(&stood(0.01, 0.005)), Some((119, 149)), "rounded to half of the noise");
        assert_eq!(stretch(&stood(0.0, 0.0)), None, "a simulation without noise may rest");
        assert_eq!(stretch(&stood(0.01, 0.05)), None, "a coarse encoder repeats its values anyway");
        assert_eq!(stretch(&series(|row, random| wave(row) + 0.01 * random.normal())), None);
        let short = series(|row, random| if (120..139).contains(&row) { 0.3 } else { random.normal() });
        assert_eq!(stretch(&short), None, "nineteen rows");
        let slow = series(|row, _| wave(row / 5 * 5) + 0.01 * Random::new(row as u64 / 5).normal());
        assert_eq!(stretch(&slow), None, "a sensor that is five times as slow as the log");
    }

    #[test]
    fn law_a_step_as_large_as_the_noise_repeats_where_the_course_is_steady_and_nowhere_else() {
        // a compass: it turns far, so that hardly a value comes twice, and then holds its course, with noise of half a step
        let heading = |turned: f64, held: f64| {
            series(|row, random| {
                let own = 0.2 * f64::from(u32::try_from(row.min(250)).expect("few rows"));
                match row {
                    300..322 => 50.0 + held,
                    299 | 322 => 50.0 + turned,
                    _ => ((own + 0.05 * random.normal()) * 10.0).round() / 10.0,
                }
            })
        };
        assert_eq!(stretch(&heading(0.1, 0.0)), None, "the rows around flicker by a step");
        assert_eq!(stretch(&heading(0.0, 0.5)), Some((300, 321)), "it was elsewhere before and behind");
        // and of a finer step the same value says that it stood still
        let fine = |row: usize, random: &mut Random| match row {
            300..322 => 0.0,
            _ => random.normal(),
        };
        let fine = series(|row, random| 50.0 + 0.05 * (fine(row, random) * 10.0).round() / 10.0);
        assert_eq!(stretch(&fine), Some((300, 321)));
    }

    #[test]
    fn law_a_sensor_may_stay_at_zero_or_at_its_end_but_not_jump_there() {
        // 0.6 is where it ends: the wave above it is cut for 70 rows
        let ends = |row: usize, random: &mut Random| {
            f64::min(libm::sin(0.03 * row as f64) + 0.01 * random.normal(), 0.6)
        };
        assert_eq!(stretch(&series(ends)), None, "a range that ends");
        let flow = |row: usize, random: &mut Random| {
            let flow = 1.0 - row as f64 / 200.0 + 0.01 * random.normal();
            if flow > 0.0 { flow } else { 0.0 }
        };
        assert_eq!(stretch(&series(flow)), None, "no flow is exactly none");
        let dead =
            series(|row, random| if (120..150).contains(&row) { 0.0 } else { 1.0 + 0.01 * random.normal() });
        assert_eq!(stretch(&dead), Some((120, 149)), "a wire that broke");
    }

    #[test]
    fn value_how_often_a_sensor_repeats_itself_where_it_does_not_stand_still() {
        // rows that are written twice, at random; from row 120 to 150 it stands still
        let repeating = |share: f64| {
            let before = std::cell::Cell::new(0.0);
            stretch(&series(|row, random| {
                let again = random.uniform() < share || (120..150).contains(&row);
                before.set(if again { before.get() } else { random.normal() });
                before.get()
            }))
        };
        // noise as large as a quantum repeats 28 of 100 values, and that is no sensor that stands still now and then
        assert_eq!(repeating(0.28).map(|(from, to)| (from.div_ceil(10), to / 10)), Some((12, 14)));
        assert_eq!(repeating(0.42), None, "a log that repeats what a slower sensor said");
    }

    #[test]
    fn value_a_log_that_hardly_moves_elsewhere_says_nothing() {
        let of = |rows: usize| {
            let Series { time, values } = series(|row, random| if row < 30 { 0.3 } else { random.normal() });
            stretch(&Series { time: time[..rows].to_vec(), values: values[..rows].to_vec() })
        };
        // a share of forty turns is known to 0.07, and noise that turns in 77 of 100 lies not two of these above what is asked
        assert_eq!((of(30 + 36), of(30 + 44)), (None, Some((0, 29))));
    }

    #[test]
    fn value_how_far_a_sensor_jumps_to_where_it_may_stay() {
        // zero for 30 rows, from and to a level of so many times the noise
        let jumps = |times: f64| {
            let level = |row: usize, random: &mut Random| match row {
                119 | 150 => times,
                120..150 => 0.0,
                _ => times + random.normal(),
            };
            let mut course = series(level);
            course.values.iter_mut().for_each(|value| *value *= 0.01);
            stretch(&course)
        };
        // a motor that coasts to rest within a row or two comes from a few times the noise; a wire breaks from anywhere
        assert_eq!(jumps(6.5), None);
        assert_eq!(jumps(9.5), Some((120, 149)));
    }
}
