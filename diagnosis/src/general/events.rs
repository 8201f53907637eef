//! Stretches where what has no name stands out: a door that was opened five times, a push.

use super::policy::GENERAL;
use crate::statistics::levels::{HALF, SAMPLE};
use crate::statistics::median::median;

/// The course of one run: its name, times and values.
pub struct Course<'a> {
    /// Name of the run.
    pub run: &'a str,
    /// Times of its rows, s.
    pub time: &'a [f64],
    /// A value for each of them, in the unit of the equation's state per s.
    pub value: &'a [f64],
}

/// When it acted, in each run in which it did, if all runs are quiet between. An event stands out from what is usual by a share of the most
/// that any run shows.
pub fn events(courses: &[Course<'_>]) -> Option<String> {
    let all: Vec<f64> = courses.iter().flat_map(|course| course.value).copied().collect();
    let quiet = median(all.iter().copied())?;
    let most = all.iter().map(|value| (value - quiet).abs()).fold(0.0, f64::max);
    let stands_out = |value: &f64| (value - quiet).abs() > GENERAL.event * most;
    let rows = all.iter().filter(|value| stands_out(value)).count();
    let begins: Vec<(&str, Vec<f64>)> =
        courses.iter().map(|course| (course.run, begins(course, &stands_out))).collect();
    let seldom = (rows as f64) < HALF * all.len() as f64;
    if !seldom || begins.iter().any(|(_, begins)| begins.len() > SAMPLE) {
        return None;
    }
    let alone = courses.len() == 1;
    let rows = courses.iter().flat_map(|course| course.time.windows(2).map(|pair| pair[1] - pair[0]));
    let decimals = decimals(median(rows).unwrap_or(1.0));
    let told = begins.iter().filter(|(_, begins)| !begins.is_empty()).map(|(run, begins)| {
        let many = if begins.len() == 1 { "1 event" } else { &format!("{} events", begins.len()) };
        let run = if alone { String::new() } else { format!(" in {run}") };
        let times: Vec<String> = begins.iter().map(|time| format!("{time:.decimals$}")).collect();
        format!("{many}{run}, beginning at {} s", times.join(", "))
    });
    Some(format!("{}; quiet between", told.collect::<Vec<_>>().join("; ")))
}

/// Decimals that tell rows apart which lie so far from each other, s: four at least.
fn decimals(row: f64) -> usize {
    if row > 0.0 { (-libm::floor(libm::log10(row))).clamp(4.0, 15.0) as usize } else { 4 }
}

/// Times of the rows at which an event begins.
fn begins(course: &Course<'_>, stands_out: &dyn Fn(&f64) -> bool) -> Vec<f64> {
    let out: Vec<bool> = course.value.iter().map(stands_out).collect();
    let begins = (0..out.len()).filter(|row| out[*row] && (*row == 0 || !out[row - 1]));
    begins.map(|row| course.time[row]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_times_of_rows_a_microsecond_apart_are_told_apart() {
        assert_eq!([1e-6, 3e-6, 0.01, 300.0, 0.0].map(decimals), [6, 6, 4, 4, 4]);
    }

    /// Bumps of three rows in a hundred, by the rows at which they begin and their sizes.
    fn told(runs: &[&[(usize, f64)]]) -> Option<String> {
        let time: Vec<f64> = (0..100).map(f64::from).collect();
        let value = |bumps: &[(usize, f64)]| -> Vec<f64> {
            let at = |row| {
                bumps.iter().find(|(begin, _)| (*begin..begin + 3).contains(&row)).map_or(0.0, |bump| bump.1)
            };
            (0..100).map(at).collect()
        };
        let values: Vec<Vec<f64>> = runs.iter().map(|bumps| value(bumps)).collect();
        let courses: Vec<Course<'_>> = values
            .iter()
            .zip(["a.csv", "b.csv"])
            .map(|(value, run)| Course { run, time: &time, value })
            .collect();
        events(&courses)
    }

    #[test]
    fn value_an_event_stands_out_by_a_third_of_the_largest() {
        let with = |share: f64| told(&[&[(20, 1.0), (60, share)]]).expect("it is quiet between");
        assert_eq!(with(0.27), "1 event, beginning at 20.0000 s; quiet between");
        assert_eq!(with(0.33), "2 events, beginning at 20.0000, 60.0000 s; quiet between");
    }

    #[test]
    fn law_events_are_told_with_their_run_and_are_those_of_all_runs() {
        // a small bump in a run of its own is none beside a large one elsewhere
        assert_eq!(
            told(&[&[(10, 0.2)], &[(40, -1.0)]]).as_deref(),
            Some("1 event in b.csv, beginning at 40.0000 s; quiet between")
        );
        assert_eq!(
            told(&[&[(10, 0.5), (30, 0.5)], &[(40, 1.0)]]).as_deref(),
            Some(
                "2 events in a.csv, beginning at 10.0000, 30.0000 s; 1 event in b.csv, beginning at 40.0000 s; quiet between"
            )
        );
        // a wave stands out from its middle in four rows of five
        let time: Vec<f64> = (0..100).map(f64::from).collect();
        let value: Vec<f64> = time.iter().map(|time| libm::sin(0.1 * time)).collect();
        assert_eq!(events(&[Course { run: "a.csv", time: &time, value: &value }]), None);
        assert_eq!(events(&[]), None);
    }
}
