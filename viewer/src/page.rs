//! The page of one run, or of two side by side.

use crate::machine::Machine;
use crate::results::Results;
use crate::{Error, signals, wiring};
use maud::{Markup, PreEscaped, html};
use orchestrator::timing::diagram;
use report::Page;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::PathBuf;

const STYLE: &str = include_str!("../assets/view.css");
const SCRIPTS: [&str; 3] = [
    include_str!("../assets/scene.js"),
    include_str!("../assets/camera.js"),
    include_str!("../assets/player.js"),
];
/// Rows of a run that the drawing gets, at most; of more, every second, third, ... The graphs have their own.
const ROWS: usize = 131_072;

/// What the scripts get.
#[derive(Serialize)]
struct Data<'a> {
    runs: Vec<Run<'a>>,
}

/// A run, for the scripts: numbers are those of columns of the page.
#[derive(Serialize)]
struct Run<'a> {
    letter: &'static str,
    over: usize,
    /// Every column by its name, and whether its values hold until they change.
    signals: Vec<(&'a str, usize, bool)>,
    machine: Option<&'a Machine>,
    /// What the drawing needs, by what it is.
    parts: BTreeMap<&'static str, usize>,
    frames: &'a [crate::frames::Frame],
}

/// A page, and what a person should know of the files that it was made of.
#[derive(Debug, PartialEq, Eq)]
pub struct Shown {
    /// The page.
    pub html: String,
    /// What is odd in the files.
    pub notes: Vec<String>,
}

/// One self-contained HTML page of the folders of one or two runs.
///
/// # Errors
/// A folder holds no run, or a file in it can't be read.
pub fn page(folders: &[PathBuf]) -> Result<Shown, Error> {
    let runs = folders.iter().map(|folder| Results::read(folder)).collect::<Result<Vec<_>, _>>()?;
    let machines: Vec<Option<Machine>> = runs.iter().map(Machine::of).collect();
    let title: Vec<&str> = runs.iter().map(|run| run.title.as_str()).collect();
    let mut page = Page::new(title.join(" – "));
    let data = data(&mut page, &runs, &machines)?;
    let graphs: Vec<_> = signals::graphs(&runs).into_iter().map(|graph| (graph, String::new())).collect();
    let places = page.places(&graphs)?;
    let two = runs.len() > 1;
    let wired = connections(&runs);
    // Where there is nothing to draw, how the units are connected stands in its place.
    let (beside, below) =
        if machines.iter().any(Option::is_some) { (None, Some(wired)) } else { (Some(wired), None) };
    page.push(html! {
        div.view.two[two] {
            div.left {
                // Four pictures are higher than a screen: the clock would be below it.
                @if two { (player()) }
                div.stages {
                    @for (number, (run, machine)) in runs.iter().zip(&machines).enumerate() {
                        (stage(number, run, machine.as_ref(), two))
                    }
                }
                @if !two { (player()) }
                @if let Some(wired) = beside { (wired) }
            }
            div.signals { h2 { "Signals" } (places) (picker()) }
        }
        @if let Some(wired) = below { (wired) }
    });
    page.scripted("view", data, &SCRIPTS, STYLE);
    let notes = runs.into_iter().flat_map(|run| run.notes).collect();
    Ok(Shown { html: page.to_html(), notes })
}

/// Units and connections: once where two runs have the same.
fn connections(runs: &[Results]) -> Markup {
    let drawn = |run: &Results| {
        let timing = diagram(&run.scenario).ok().and_then(wiring::timing).map(|diagram| {
            let words =
                "When each unit is stepped, and when a value that one gives is first used by another.";
            html! { div.scroll tabindex="0" { (report::page::figure(&diagram.to_svg(), words)) } }
        });
        let drawn = [wiring::picture(&run.scenario), timing].into_iter().flatten();
        (drawn.map(PreEscaped::into_string).collect::<Vec<_>>(), wiring::table(&run.scenario))
    };
    let mut all: Vec<_> = runs.iter().map(drawn).collect();
    all.dedup();
    let several = all.len() > 1;
    html! { @for (number, (pictures, table)) in all.iter().enumerate() {
        h2 { "Units and connections" @if several { " of " (signals::LETTERS[number % 2]) } }
        @for picture in pictures { (PreEscaped(picture)) }
        @if !table.rows.is_empty() { (report::page::table(table)) }
    } }
}

/// Hands the columns to the page and answers what the scripts need to find them.
fn data(page: &mut Page, runs: &[Results], machines: &[Option<Machine>]) -> Result<String, Error> {
    let mut data = Data { runs: Vec::new() };
    for (number, (run, machine)) in runs.iter().zip(machines).enumerate() {
        let every = run.times.len().div_ceil(ROWS);
        let thinned = |values: &[f64]| values.iter().copied().step_by(every).collect::<Vec<_>>();
        let over = page.column(&thinned(&run.times))?;
        let mut signals = Vec::new();
        for column in &run.columns {
            signals.push((column.name.as_str(), page.column(&thinned(&column.values))?, column.held));
        }
        let found =
            |name: &String| signals.iter().find(|(known, ..)| known == name).map(|(_, number, _)| *number);
        let parts = machine.iter().flat_map(|machine| &machine.columns);
        let parts = parts.filter_map(|(part, name)| Some((*part, found(name)?))).collect();
        let letter = signals::LETTERS[number % 2];
        data.runs.push(Run { letter, over, signals, machine: machine.as_ref(), parts, frames: &run.frames });
    }
    serde_json::to_string(&data).map_err(|why| report::Error::Data { why: why.to_string() }.into())
}

/// The pictures of a run.
fn stage(number: usize, run: &Results, machine: Option<&Machine>, two: bool) -> Markup {
    let name = if two { format!("{}: {}", signals::LETTERS[number % 2], run.title) } else { String::new() };
    html! {
        section.stage data-run=(number) {
            @if two { h2 { (name) } }
            @if let Some(words) = &run.verdict { p.said { (words) } }
            @if let Some(machine) = machine {
                div.pictures {
                    figure {
                        canvas.scene width="480" height="480" role="img"
                            aria-label="The acrobot on the ground: drum, two links, torque at the joint; dashed where the controller wants it" {}
                        figcaption.of-scene { "The machine. Dashed: the equilibrium that is wished." }
                    }
                    @if machine.camera.is_some() {
                        figure {
                            canvas.camera width="480" height="480" role="img"
                                aria-label="What the camera saw last: circles at drum, joint and tip, where they are and where they were found" {}
                            figcaption.of-camera {}
                        }
                    }
                }
            }
        }
    }
}

/// The clock.
fn player() -> Markup {
    html! {
        div.player role="group" aria-label="Clock" {
            button #back type="button" aria-label="One frame back" { "◀◀" }
            button #play type="button" aria-label="Play" { "Play" }
            button #on type="button" aria-label="One frame on" { "▶▶" }
            label { "speed " select #speed {
                @for speed in ["0.05", "0.1", "0.25", "0.5", "1", "2", "4", "8"] {
                    option value=(speed) selected[speed == "1"] { (speed) " ×" }
                }
            } }
            output #now { "" }
            input #clock type="range" min="0" max="1" step="any" value="0" aria-label="Time";
        }
    }
}

/// Any other column as a graph.
fn picker() -> Markup {
    html! { p { label { "Add a graph of " select #add { option value="" { "…" } } } } }
}

#[cfg(test)]
mod tests {
    use super::page;
    use std::path::PathBuf;

    const SCENARIO: &str = "format = 1\ndescription = \"a <machine>\"\n[experiment]\nstop = 1\n[[units]]\nname = \"plant\"\n\
        fmu = \"acrobot_plant.fmu\"\ninterval = \"1/2\"\n[units.set]\nslope = 0.01\n";

    fn result(rows: &str) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let put = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("written");
        put("resolved.toml", SCENARIO);
        put("results.csv", rows);
        let path = folder.path().to_owned();
        (folder, path)
    }

    #[test]
    fn law_a_page_needs_nothing_from_elsewhere_and_is_the_same_twice() {
        let (_kept, folder) = result("time,plant.q1,plant.q2\n0,0.1,0.2\n0.5,0.2,0.3\n1,0.3,NaN\n");
        let html = page(&[folder.clone(), folder.clone()]).expect("a page").html;
        assert_eq!(html, page(&[folder.clone(), folder]).expect("once more").html);
        assert!(html.contains("a &lt;machine>") || html.contains("a &lt;machine&gt;"));
        assert_eq!(html.matches("<canvas").count(), 2, "two machines, no camera");
        let fetches =
            ["src=\"http", "href=\"http", "@import", "fetch("].map(|word| html.matches(word).count());
        assert_eq!(fetches, [0; 4]);
    }

    #[test]
    fn law_columns_of_no_unit_are_told_and_signals_that_are_missing() {
        let (_kept, folder) = result("time,plant.q1,plnt.q2\n0.0,0.1,1\n1.0,0.2,0\n");
        let told = |folder: &PathBuf| page(std::slice::from_ref(folder)).expect("a page").notes;
        let notes = told(&folder);
        assert!(notes.len() == 1 && notes[0].contains("column \"plnt.q2\" is of no unit"), "{notes:?}");
        let graphs = "[[report.graphs]]\ntitle = \"t\"\ny = \"\"\nlines = [{ signal = \"plant.q3\" }]\n";
        std::fs::write(folder.join("resolved.toml"), format!("{SCENARIO}{graphs}")).expect("written");
        let notes = told(&folder);
        assert!(notes.len() == 2 && notes[1].contains("no column \"plant.q3\", which [report]"), "{notes:?}");
    }

    #[test]
    fn law_whole_numbers_are_drawn_as_steps() {
        let (_kept, folder) = result("time,plant.q1,plant.contact\n0.0,0.1,1\n0.5,0.2,0\n1.0,0.3,1\n");
        let html = page(&[folder]).expect("a page").html;
        assert_eq!(html.matches("\"held\":true").count(), 1, "contact, not the angle");
    }

    #[test]
    fn law_pictures_in_a_folder_of_their_own_are_found_and_else_told() {
        let (_kept, folder) = result("time,plant.q1,plant.q2\n0,0.1,0.2\n1,0.2,0.3\n");
        let elsewhere = tempfile::tempdir().expect("a temporary folder");
        let given = elsewhere.path().display();
        let camera = format!(
            "[[units]]\nname = \"camera\"\nfmu = \"acrobot_camera.fmu\"\ninterval = \"1/2\"\n[units.set]\nframes_dir = {:?}\n\
             [report.picture]\nunit = \"camera\"\ndirectory = \"frames_dir\"\n",
            given.to_string()
        );
        std::fs::write(folder.join("resolved.toml"), format!("{SCENARIO}{camera}")).expect("written");
        let shown = || page(std::slice::from_ref(&folder)).expect("a page");
        let told = shown().notes;
        assert!(told.len() == 1 && told[0].contains("no pictures: camera.frames_dir = "), "{told:?}");
        std::fs::write(elsewhere.path().join("frame_000007.png"), "PNG").expect("written");
        let found = shown();
        assert!(found.html.contains("\"number\":7"), "the picture is on the page");
        assert_eq!(found.notes, [format!("pictures are those of {given}, where camera.frames_dir put them")]);
    }

    #[test]
    fn law_what_is_no_result_is_told() {
        let empty = tempfile::tempdir().expect("a temporary folder");
        let told = page(&[empty.path().to_owned()]).expect_err("nothing there");
        assert!(told.is_input() && told.to_string().contains("no results.csv"), "{told}");
        let (_kept, folder) = result("time,plant.q1,plant.q2\n0,0.1,0.2\n");
        assert!(page(&[folder]).expect_err("one row").to_string().contains("two rows"));
    }
}
