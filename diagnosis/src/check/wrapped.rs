//! An angle that wraps: its log jumps by a turn where the machine turns on.
//!
//! All values lie within one turn, and where one jumps by more than half of it, a turn more or less makes it a step like those of other rows.
//! A unit that wraps as its sensor does is followed as it is: begun a turn farther, it shows no angle that is a turn farther.

use super::Doubt;
use crate::dynamics::build::build;
use crate::observe::{Channel, Problem, Role, Run, Series};
use crate::statistics::levels::{HALF, PART, ROUNDING, SLIGHT};
use crate::text::brief;
use orchestrator::fmu::Variable;
use std::f64::consts::TAU;

/// A compared channel of a run that jumps by a turn, where the model turns on.
pub(super) fn wrapped(problem: &Problem) -> Option<Doubt> {
    let of_run = |run| (0..problem.channels.len()).map(move |place| (place, run));
    let asked = problem.runs.iter().flat_map(of_run);
    let jumping: Vec<(usize, &Run, f64)> =
        asked.filter_map(|(place, run)| Some((place, run, turn(problem, place, run)?))).collect();
    if jumping.is_empty() {
        return None;
    }
    let engine = build(problem, &problem.whole_runs()).ok()?.engine;
    jumping.into_iter().find_map(|(place, run, turn)| {
        let beyond = run.series[place].values[0] + turn;
        let shown = engine.shown_begun_at(&run.name, place, beyond)?;
        ((shown - beyond).abs() < HALF * turn).then(|| doubt(problem, place, run, turn))
    })
}

/// The turn by which a compared channel jumps in a run, in the variable's unit, if it does.
fn turn(problem: &Problem, place: usize, run: &Run) -> Option<f64> {
    let channel = &problem.channels[place];
    let all = turns(problem.model.variable(channel.variable));
    all.iter().copied().find(|turn| channel.role == Role::Compared && wraps(&run.series[place], *turn))
}

fn doubt(problem: &Problem, place: usize, run: &Run, turn: f64) -> Doubt {
    let Channel { name, column, conversion, line, .. } = &problem.channels[place];
    let series = &run.series[place];
    let mut rows = jumps(&series.values, turn);
    let time = rows.next().map_or(0.0, |row| series.time[row + 1] / run.seconds);
    let later = match rows.count() {
        0 => String::new(),
        count => format!(" and {count} times later"),
    };
    let (period, option) = period((turn / conversion.scale).abs());
    Doubt {
        line: *line,
        sentence: format!(
            "{}: column {column:?} ({name}) jumps by a turn ({period}) at time {time}{later}: the angle wraps in the log, and the model turns on",
            run.name
        ),
        add: format!(
            "Write it without jumps: add or take a turn behind each, as numpy.unwrap(column{option}) does"
        ),
    }
}

/// A turn in the log's unit, and what numpy.unwrap must be told of it.
fn period(turn: f64) -> (String, String) {
    if (turn - TAU).abs() < ROUNDING {
        ("2π".into(), String::new())
    } else {
        (brief(turn), format!(", period={}", brief(turn)))
    }
}

/// What a turn may be in a variable's unit.
fn turns(variable: &Variable) -> &'static [f64] {
    match variable.unit.as_deref() {
        Some("rad") => &[TAU],
        Some("deg") => &[360.0],
        None | Some("" | "1") => &[TAU, 360.0],
        Some(_) => &[],
    }
}

/// Rows before a jump of more than half a turn.
fn jumps(values: &[f64], turn: f64) -> impl Iterator<Item = usize> {
    let is_jump = move |(_, pair): &(usize, &[f64])| (pair[1] - pair[0]).abs() > HALF * turn;
    values.windows(2).enumerate().filter(is_jump).map(|(row, _)| row)
}

/// Whether values lie within a turn, and jump by nearly all of it where they jump.
fn wraps(series: &Series, turn: f64) -> bool {
    let values = &series.values;
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    let steps = || values.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let largest = steps().filter(|step| *step <= HALF * turn).fold(0.0, f64::max);
    let smooth = largest > 0.0 && largest <= PART * turn;
    let mut rest = steps().filter(|step| *step > HALF * turn).map(|step| (step - turn).abs()).peekable();
    high - low <= (1.0 + SLIGHT) * turn && smooth && rest.peek().is_some() && rest.all(|step| step <= largest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::tests::swung;

    /// A turn after 40 rows, within 0 to 2π.
    fn turning(row: usize) -> f64 {
        (0.3 + row as f64 * TAU / 40.0).rem_euclid(TAU)
    }

    fn series(of: impl Fn(usize) -> f64) -> Series {
        Series { time: (0..100).map(f64::from).collect(), values: (0..100).map(of).collect() }
    }

    #[test]
    fn bad_data_an_angle_that_wraps_is_told_with_the_time_of_its_first_jump() {
        let mut problem = swung("wraps", 100);
        assert_eq!(wrapped(&problem), None, "it swings");
        let last = problem.channels.len() - 1;
        let values = &mut problem.runs[0].series[last].values;
        (0..values.len()).for_each(|row| values[row] = turning(row));
        let time = problem.runs[0].series[last].time[39];
        let Doubt { line, sentence, add } = wrapped(&problem).expect("it jumps at rows 39 and 79");
        assert_eq!(line, problem.channels[last].line);
        assert!(sentence.contains(&format!("jumps by a turn (2π) at time {time} and ")), "{sentence}");
        assert!(add.contains("numpy.unwrap(column) does"), "{add}");
        assert_eq!(period(360.0), ("360".into(), ", period=360".into()));
    }

    #[test]
    fn law_what_jumps_otherwise_does_not_wrap() {
        assert!(wraps(&series(turning), TAU));
        assert!(wraps(&series(|row| turning(row) - 3.0), TAU), "from any angle on");
        assert!(!wraps(&series(turning), 360.0), "another turn");
        assert!(!wraps(&series(|row| row as f64 * TAU / 40.0), TAU), "it turns on");
        assert!(!wraps(&series(|row| if row < 50 { 0.0 } else { 0.9 * TAU }), TAU), "a step of nine tenths");
        assert!(
            !wraps(&series(|row| if row == 50 { TAU } else { 0.0 }), TAU),
            "a spike in what stands still"
        );
        assert!(!wraps(&series(|row| if row % 2 == 0 { 0.0 } else { 0.4 * TAU }), TAU), "steps of any size");
        assert!(!wraps(&series(|row| if row == 50 { 9.0 * TAU } else { turning(row) }), TAU), "an outlier");
    }
}
