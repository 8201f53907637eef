//! The graphs beside the picture: those that the scenario's `[report]` asks for, else all columns of each unit that move.

use crate::results::Results;
use report::extent;
use report::thin::Thinner;
use report::{Axis, Graph, Line, Style};

/// Graphs of a page that nobody asked for, at most; the page offers every other column.
const GRAPHS: usize = 12;
/// After a failure lines go on for this share of the time before it.
const AFTER: f64 = 0.25;
/// Letters by which two runs are told apart.
pub const LETTERS: [&str; 2] = ["A", "B"];

/// A line to draw: label, signal, and what is taken off it.
struct Wish {
    label: String,
    signal: String,
    minus: Option<String>,
    style: Style,
}

/// The graphs of the runs, the first run's wishes for all of them.
pub fn graphs(runs: &[Results]) -> Vec<Graph> {
    let Some(first) = runs.first() else { return Vec::new() };
    let wished = match wished(first) {
        wished if wished.is_empty() => usual(first),
        wished => wished,
    };
    let drawn = wished.into_iter().map(|(title, unit, wishes)| {
        let mut graph = Graph::new(title, Axis::fitted("time in s"), Axis::fitted(unit));
        let mut before = Vec::new();
        for wish in &wishes {
            for (number, run) in runs.iter().enumerate() {
                let Some(line) = line(run, wish, &graph.y.label, (runs.len() > 1).then_some(number)) else {
                    continue;
                };
                let failed = run.failed().unwrap_or(f64::INFINITY);
                before
                    .extend(line.points.iter().filter(|(time, _)| *time <= failed).map(|(_, value)| *value));
                graph.lines.push(line);
            }
        }
        scaled(&mut graph, runs, &before);
        graph
    });
    let finite = |graph: &Graph| {
        graph.lines.iter().flat_map(|line| &line.points).any(|(_, value)| extent::is_drawn(*value))
    };
    drawn.filter(finite).collect()
}

/// The scale is that of what came before a failure; what comes after it is no measure for anything.
fn scaled(graph: &mut Graph, runs: &[Results], before: &[f64]) {
    let Some(first) = runs.iter().filter_map(Results::failed).reduce(f64::min) else { return };
    let reached = extent::of(before.iter().copied()).filter(|(low, high)| low < high);
    graph.y.range = reached.map(extent::with_margin).or(graph.y.range);
    graph.event = Some((first, format!("failed at {} s; scaled up to then", report::head::short(first))));
}

fn line(run: &Results, wish: &Wish, unit: &str, of: Option<usize>) -> Option<Line> {
    let signal = run.recorded(&wish.signal)?;
    let minus = match &wish.minus {
        Some(name) => Some(run.recorded(name)?),
        None => None,
    };
    let held = signal.held && minus.is_none_or(|minus| minus.held);
    let minus = minus.map(|minus| &minus.values);
    let mut thinner = Thinner::default();
    // As long as the page of the run shows it.
    let end = run.failed().map_or(f64::INFINITY, |failed| failed + AFTER * (failed - run.times[0]));
    for (row, (time, value)) in
        run.times.iter().zip(&signal.values).enumerate().take_while(|(_, (time, _))| **time <= end)
    {
        thinner.push(*time, value - minus.map_or(0.0, |minus| minus[row]));
    }
    let name = if wish.label.is_empty() { unit } else { &wish.label };
    let (label, style) = match of {
        Some(number) => (
            format!("{name} ({})", LETTERS[number % 2]),
            if number == 0 { Style::Solid } else { Style::Dashed },
        ),
        None => (wish.label.clone(), wish.style),
    };
    let style = if held { style.held() } else { style };
    Some(Line { label, style, points: thinner.finish() })
}

type Wished = Vec<(String, String, Vec<Wish>)>;

/// What `[report]` asks for, as far as it was recorded.
fn wished(run: &Results) -> Wished {
    let graphs = run.scenario.report.get("graphs").and_then(|graphs| graphs.as_array());
    let mut wished = Vec::new();
    for graph in graphs.into_iter().flatten() {
        let text = |key: &str| graph.get(key).and_then(|text| text.as_str()).unwrap_or_default().to_owned();
        let mut wishes = Vec::new();
        for line in graph.get("lines").and_then(|lines| lines.as_array()).into_iter().flatten() {
            let word = |key: &str| line.get(key).and_then(|word| word.as_str());
            let Some(signal) = word("signal") else { continue };
            wishes.push(Wish {
                label: word("label").unwrap_or_default().to_owned(),
                signal: signal.to_owned(),
                minus: word("minus").map(str::to_owned),
                style: match word("style") {
                    Some("dashed") => Style::Dashed,
                    Some("dotted") => Style::Dotted,
                    _ => Style::Solid,
                },
            });
        }
        wished.push((text("title"), text("y"), wishes));
    }
    wished
}

/// The columns of each unit that move, each by itself: volts don't go with radians.
fn usual(run: &Results) -> Wished {
    let mut graphs = Vec::new();
    for unit in &run.scenario.units {
        let beginning = format!("{}.", unit.name);
        let moves = |values: &[f64]| values.iter().any(|value| *value != values[0] && value.is_finite());
        let of_unit = (run.columns.iter())
            .filter(|column| column.name.starts_with(&beginning) && moves(&column.values));
        for name in of_unit.map(|column| &column.name) {
            let label = name[beginning.len()..].to_owned();
            let wish = Wish { label: label.clone(), signal: name.clone(), minus: None, style: Style::Solid };
            let axis = run.units.get(name).map_or(label.clone(), |unit| format!("{label} in {unit}"));
            graphs.push((name.clone(), axis, vec![wish]));
        }
    }
    graphs.truncate(GRAPHS);
    graphs
}
