//! What the logs fed in the first run, as tables beside the amended scenario.
//!
//! A master reads a source at the end of a step (Gauss-Seidel) and holds it over the step. So a held input is written half a
//! step late, which is inside the right step for one that reads at its begin, too; a line is written so that its middle
//! is held. Before an effect a line is wanted at the step's end: there the unit draws it itself.

use super::study::Studied;
use crate::dynamics::grid::{Course, Grid};
use crate::observe::Hold;
use std::fmt::Write as _;

/// What is fed as it is.
pub const INPUTS: &str = "inputs.csv";
/// What a unit before the input draws a line to.
pub const INPUT_LINES: &str = "inputs_lines.csv";

/// One logged input and where it goes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Feed {
    /// Place among the machine's inputs.
    pub place: usize,
    /// `unit.variable`.
    pub to: String,
    /// The unit draws a line to the value at the step's end.
    pub line: bool,
}

/// Files with the inputs of a run; appends the `[[sources]]` that read them.
pub(super) fn written(
    studied: &Studied,
    grid: &Grid,
    feeds: &[Feed],
    step: f64,
    sources: &mut String,
) -> Vec<(String, String)> {
    let engine = &studied.built.engine;
    let mut files = Vec::new();
    for (file, line, late) in [(INPUTS, false, 0.5 * step), (INPUT_LINES, true, 0.0)] {
        let own: Vec<&Feed> = feeds.iter().filter(|feed| feed.line == line).collect();
        if own.is_empty() {
            continue;
        }
        for feed in &own {
            let input = &engine.machine.inputs[feed.place];
            let kind = if input.hold == Hold::Linear { "linear" } else { "hold" };
            let _ = write!(
                sources,
                "\n[[sources]]\nto = \"{}\"\nkind = \"csv\"\nfile = \"{file}\"\ncolumn = \"{}\"\ninterpolation = \"{kind}\"\n",
                feed.to, input.name
            );
        }
        let mut names: Vec<String> =
            own.iter().map(|feed| engine.machine.inputs[feed.place].name.clone()).collect();
        let mut courses: Vec<&Course> = own.iter().map(|feed| &grid.inputs[feed.place]).collect();
        // where something was added, what was logged stands beside it
        for feed in &own {
            let logged = &engine.grids[0].inputs[feed.place];
            if *logged != grid.inputs[feed.place] {
                names.push(format!("{} as logged", engine.machine.inputs[feed.place].name));
                courses.push(logged);
            }
        }
        files.push((file.to_owned(), table(&names, &courses, grid.time[0], late)));
    }
    files
}

/// All times of all courses, each with a value of each.
fn table(names: &[String], courses: &[&Course], begin: f64, late: f64) -> String {
    let mut times: Vec<f64> = courses.iter().flat_map(|course| course.time.iter().copied()).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let mut text = String::from("time");
    names.iter().for_each(|name| {
        let _ = write!(text, ",{name}");
    });
    for time in times {
        let _ = write!(text, "\n{:?}", time - begin + late);
        courses.iter().for_each(|course| {
            let _ = write!(text, ",{:?}", course.value(time));
        });
    }
    text.push('\n');
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_courses_of_other_times_share_a_table() {
        let held = Course { time: vec![5.0, 7.0], values: vec![1.0, 2.0], hold: Hold::Zero };
        let line = Course { time: vec![5.0, 6.0, 9.0], values: vec![0.0, 1.0, 4.0], hold: Hold::Linear };
        let text = table(&["a".into(), "b".into()], &[&held, &line], 5.0, 0.25);
        let rows = ["time,a,b", "0.25,1.0,0.0", "1.25,1.0,1.0", "2.25,2.0,2.0", "4.25,2.0,4.0", ""];
        assert_eq!(text, rows.join("\n"));
    }
}
