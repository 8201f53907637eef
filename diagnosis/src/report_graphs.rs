//! The graphs of `report.html`: measured, nominal and amended over each other; `residuals` has what is left.

mod residuals;

use crate::diagnosis::{Diagnosis, RunTrace, Unknown};
use crate::error::Error;
use crate::overlay::Overlaid;
use crate::statistics::levels::SEVERAL;
use crate::statistics::median::median;
use report::thin::thin;
use report::{Axis, Graph, Line, Page};
pub use residuals::residuals;

/// Channels that are shown, at most: with more nobody finds the one that matters.
const CHANNELS: usize = 10;
/// Rows before that the autocorrelation looks at, and bins of a state or an input.
const LAGS: usize = 40;
const BINS: usize = 24;
/// Columns of a picture, of each of which a course keeps its first, least, greatest and last value: the page stays small.
const COLUMNS: usize = 900;
/// States and inputs that the residual is shown over, at most: those that it follows most.
const OVER: usize = 6;

/// Why a curve ends and begins again.
const BROKEN: &str = " Where a curve is broken no window was compared: rows were left out or too few, or no start was found there from which \
                      the models follow them.";

/// The windows know no residual unit: without this, "amended" would seem to say that the correction is of no use.
const UNCORRECTED: &str =
    " The labelled correction is not in these curves, the named effects alone are; `amended.toml` has both.";

fn refused(error: report::Error) -> Error {
    Error::Model(error.to_string())
}

/// The course of an unlisted input, where it is known: of the runs in which it does most.
pub fn unlisted(unknown: &Unknown, page: &mut Page) -> Result<(), Error> {
    let mut told: Vec<&RunTrace> = unknown.traces.iter().filter(|run| run.trace.len() > 1).collect();
    let square = |run: &RunTrace| run.trace.iter().map(|[_, value]| value * value).sum::<f64>();
    told.sort_by(|a, b| square(b).total_cmp(&square(a)));
    told.truncate(OVER);
    // in the order of the runs again
    told.sort_by_key(|run| unknown.traces.iter().position(|known| known.run == run.run));
    // what a sensor shows is none of the machine's inputs
    let (what, axis, course) = match unknown.signal.strip_prefix("what ") {
        Some(shown) => (format!("What {shown} beyond the model"), "residual", "residual"),
        None => (format!("What acts on {}", unknown.signal), "unlisted input", "most likely course"),
    };
    let graph = |run: &&RunTrace| {
        let points: Vec<(f64, f64)> = run.trace.iter().map(|[time, value]| (*time, *value)).collect();
        let axis = Axis::fitted(labelled(axis, &unknown.unit));
        let line = Line::solid(course, thin(&points, COLUMNS));
        let title = format!("{what}, {}", run.run);
        (Graph::new(title, Axis::fitted("time in s"), axis).with(line), String::new())
    };
    let graphs: Vec<(Graph, String)> = told.iter().map(graph).collect();
    if !graphs.is_empty() {
        page.graphs(&graphs).map_err(refused)?;
    }
    Ok(())
}

/// The first picture any engineer asks for.
pub fn overlays(diagnosis: &Diagnosis, page: &mut Page) -> Result<(), Error> {
    let shown: Vec<&Overlaid> =
        diagnosis.channels.iter().filter(|channel| channel.drawn).take(CHANNELS).collect();
    let Some(first) = shown.first() else { return Ok(()) };
    page.heading("Measured, nominal and amended");
    page.text(&format!(
        "{}{}, the last run with rows of a channel. Where the motion is compared, a window of it starts at the state that fits it best, \
         since a small error of the start would hide what the model lacks; nominal and amended are what the model gives from there.{}{}",
        first.run,
        match first.left_out {
            true if diagnosis.left_out_a_part() => ", to this part of which nothing was fitted",
            true => ", to which nothing was fitted",
            false => "",
        },
        if shown.iter().any(|channel| parts(channel, &channel.nominal).len() > 1) { BROKEN } else { "" },
        if diagnosis.correction.is_some() { UNCORRECTED } else { "" },
    ));
    let graphs: Vec<(Graph, String)> =
        shown.iter().map(|channel| (overlay(channel), String::new())).collect();
    page.graphs(&graphs).map_err(refused)?;
    Ok(())
}

fn overlay(channel: &Overlaid) -> Graph {
    let title = format!("{} of {}", channel.signal, channel.run);
    let y = labelled(&channel.signal, &channel.unit);
    let graph = Graph::new(title, Axis::fitted("time in s"), Axis::fitted(y))
        .with(Line::dots("measured", thin(&channel.measured, COLUMNS)))
        .with(Line::dashed("nominal", broken(channel, &channel.nominal)));
    match amended(channel) {
        true => graph.with(Line::solid("amended", broken(channel, &channel.amended))),
        false => graph,
    }
}

/// The stretches of a model's course. Where rows of the log lie between two of its points, and these are several times as far apart as
/// usual, it has no value.
fn parts<'a>(channel: &Overlaid, course: &'a [(f64, f64)]) -> Vec<&'a [(f64, f64)]> {
    let usual = median(course.windows(2).map(|pair| pair[1].0 - pair[0].0)).unwrap_or(f64::INFINITY);
    let is_one = |one: &(f64, f64), next: &(f64, f64)| {
        let rows = || channel.measured.iter().filter(|row| row.0 > one.0 && row.0 < next.0).count();
        next.0 - one.0 <= SEVERAL * usual || rows() == 0
    };
    course.chunk_by(is_one).collect()
}

/// A model's course as it is drawn: between its stretches a point without a value, since a line across would say that it was followed.
fn broken(channel: &Overlaid, course: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut drawn: Vec<(f64, f64)> = Vec::new();
    for part in parts(channel, course) {
        let hole = drawn.last().map(|(end, _)| (0.5 * (end + part[0].0), f64::NAN));
        drawn.extend(hole);
        drawn.extend(thin(part, COLUMNS));
    }
    drawn
}

/// Whether anything was amended: two equal lines over each other look like one that is wrong.
fn amended(channel: &Overlaid) -> bool {
    channel.amended != channel.nominal
}

/// What an axis shows, with its unit if it has one.
fn labelled(what: &str, unit: &str) -> String {
    if unit.is_empty() { what.to_owned() } else { format!("{what} in {unit}") }
}

#[cfg(test)]
mod tests {
    use super::{broken, overlays};
    use crate::diagnosis::Diagnosis;
    use crate::overlay::Overlaid;

    /// Rows each second, compared up to 9 s and from 40 s on.
    #[test]
    fn law_no_line_runs_across_rows_that_were_not_compared() {
        let row = |second: i32| (f64::from(second), 1.0);
        let mut channel = Overlaid {
            run: "run-01".into(),
            left_out: true,
            signal: "heater.T".into(),
            unit: String::new(),
            drawn: true,
            measured: (0..60).map(row).collect(),
            nominal: (0..10).chain(40..60).map(row).collect(),
            amended: (0..60).map(row).collect(),
            residual: Vec::new(),
            over: Vec::new(),
        };
        let drawn = broken(&channel, &channel.nominal);
        assert!(drawn.len() == 31 && drawn[10].0 == 24.5 && drawn[10].1.is_nan(), "{drawn:?}");
        assert_eq!(broken(&channel, &channel.amended), channel.amended);
        let told = |channel: &Overlaid| {
            let mut page = report::Page::new("x");
            let channels = vec![channel.clone()];
            overlays(&Diagnosis { channels, ..Diagnosis::default() }, &mut page).expect("drawn");
            page.to_html().contains("Where a curve is broken")
        };
        assert!(told(&channel));
        // a log that has no rows there either was compared as it is
        channel.measured.retain(|(time, _)| *time < 10.0 || *time >= 40.0);
        assert_eq!(broken(&channel, &channel.nominal), channel.nominal);
        assert!(!told(&channel));
    }

    #[test]
    fn every_channel_that_its_rig_lets_draw_is_drawn_whatever_its_name() {
        let course = vec![(0.0, 1.0), (1.0, 2.0)];
        let channel = |signal: &str, drawn: bool| Overlaid {
            run: "run-01".into(),
            left_out: false,
            signal: signal.into(),
            unit: String::new(),
            drawn,
            measured: course.clone(),
            nominal: course.clone(),
            amended: course.clone(),
            residual: Vec::new(),
            over: Vec::new(),
        };
        let channels = vec![channel("valve.area", true), channel("camera.extent", false)];
        let mut page = report::Page::new("x");
        overlays(&Diagnosis { channels, ..Diagnosis::default() }, &mut page).expect("drawn");
        let html = page.to_html();
        assert!(html.contains("valve.area of run-01") && !html.contains("camera.extent"));
    }
}
