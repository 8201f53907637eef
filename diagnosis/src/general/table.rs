//! What the logs fed in the first run, as tables beside the amended scenario.
//!
//! A master reads a source at the end of a step (Gauss-Seidel) and holds it over the step. So a held input is written half a
//! step late, which is inside the right step for one that reads at its begin, too; a line is written so that its middle
//! is held. Before an effect a line is wanted at the step's end: there the unit draws it itself.

use super::study::Studied;
use crate::dynamics::grid::Course;
use crate::observe::Hold;
use std::fmt::Write as _;

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

/// Files with the logged inputs; appends the `[[sources]]` that read them.
pub(super) fn written(
    studied: &Studied,
    feeds: &[Feed],
    step: f64,
    sources: &mut String,
) -> Vec<(String, String)> {
    let engine = &studied.built.engine;
    let grid = &engine.grids[0];
    let mut files = Vec::new();
    for (file, line, late) in [("inputs.csv", false, 0.5 * step), ("inputs_lines.csv", true, 0.0)] {
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
        let names: Vec<&str> =
            own.iter().map(|feed| engine.machine.inputs[feed.place].name.as_str()).collect();
        let courses: Vec<&Course> = own.iter().map(|feed| &grid.inputs[feed.place]).collect();
        files.push((file.to_owned(), table(&names, &courses, grid.time[0], late)));
    }
    files
}

/// All times of all courses, each with a value of each.
fn table(names: &[&str], courses: &[&Course], begin: f64, late: f64) -> String {
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
        let text = table(&["a", "b"], &[&held, &line], 5.0, 0.25);
        let rows = ["time,a,b", "0.25,1.0,0.0", "1.25,1.0,1.0", "2.25,2.0,2.0", "4.25,2.0,4.0", ""];
        assert_eq!(text, rows.join("\n"));
    }
}
