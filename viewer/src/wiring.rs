//! Units and connections of a scenario: a picture, when each unit is stepped, and the connections as a list.

use maud::{Markup, PreEscaped, html};
use orchestrator::Scenario;
use orchestrator::scenario::ConnectionEntry;
use orchestrator::timing::Diagram;
use report::timing::interval;
use report::{Cell, Table, TimingDiagram};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Size of a box, of the gap between boxes, and of the room above and below for arcs, in CSS pixels.
const BOX: (f64, f64) = (130.0, 54.0);
const GAP: f64 = 46.0;
/// Units in one picture, at most: beyond, arcs run together and the list says more.
const UNITS: usize = 9;

/// Arcs from unit to unit: the boxes stand in the order of stepping, arcs forward run above them, arcs back below.
pub fn picture(scenario: &Scenario) -> Option<Markup> {
    let names: Vec<&str> = scenario.units.iter().map(|unit| unit.name.as_str()).collect();
    if names.is_empty() || names.len() > UNITS {
        return None;
    }
    let mut arcs: BTreeMap<(usize, usize), Vec<&str>> = BTreeMap::new();
    for connection in &scenario.connections {
        let place = |variable: &str| {
            let unit = variable.split('.').next().unwrap_or_default();
            names.iter().position(|name| *name == unit)
        };
        if let (Some(from), Some(to)) = (place(&connection.from), place(&connection.to)) {
            let variable = connection.from.split_once('.').map_or("", |(_, variable)| variable);
            arcs.entry((from, to)).or_default().push(variable);
        }
    }
    let reach = |forward: bool| {
        let of_kind = arcs.keys().filter(|(from, to)| (from < to) == forward);
        of_kind.map(|(from, to)| from.abs_diff(*to).max(1)).max().map_or(10.0, height)
    };
    let (above, below) = (reach(true), reach(false));
    let width = names.len() as f64 * (BOX.0 + GAP);
    let total = above + BOX.1 + below;
    let mut svg = format!(
        r#"<svg class="wiring" xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {total}" width="{width}" role="img" aria-label="Units in the order of stepping, and what they hand on">"#
    );
    for ((from, to), variables) in &arcs {
        arc(&mut svg, (*from, *to), variables, above);
    }
    for (index, unit) in scenario.units.iter().enumerate() {
        let left = index as f64 * (BOX.0 + GAP) + GAP / 2.0;
        let name = html! { (unit.name) }.into_string();
        let every = html! { "each " (interval(unit.interval.to_f64())) }.into_string();
        // Writing into a String can't fail.
        let _ = write!(
            svg,
            r#"<rect x="{left}" y="{above}" width="{}" height="{}" rx="5"/><text x="{}" y="{}" class="name">{name}</text><text x="{}" y="{}">{every}</text>"#,
            BOX.0,
            BOX.1,
            left + BOX.0 / 2.0,
            above + 23.0,
            left + BOX.0 / 2.0,
            above + 42.0,
        );
    }
    svg.push_str("</svg>");
    Some(html! { div.scroll tabindex="0" { (PreEscaped(svg)) } })
}

/// Height of the room for an arc over so many boxes.
fn height(boxes: usize) -> f64 {
    26.0 + 24.0 * boxes as f64
}

fn arc(svg: &mut String, (from, to): (usize, usize), variables: &[&str], above: f64) {
    let forward = from < to;
    let middle = |index: usize, shift: f64| index as f64 * (BOX.0 + GAP) + GAP / 2.0 + BOX.0 / 2.0 + shift;
    let (x0, x1) =
        (middle(from, if forward { 24.0 } else { -24.0 }), middle(to, if forward { -24.0 } else { 24.0 }));
    let edge = if forward { above } else { above + BOX.1 };
    let tall = height(from.abs_diff(to).max(1)) - 20.0;
    let (bend, head) = if forward { (edge - 1.33 * tall, -6.0) } else { (edge + 1.33 * tall, 6.0) };
    let words = match variables {
        [one] => (*one).to_owned(),
        many => format!("{} signals", many.len()),
    };
    let (words, all) = (html! { (words) }.into_string(), html! { (variables.join(", ")) }.into_string());
    let _ = write!(
        svg,
        r#"<path d="M{x0} {edge}C{x0} {bend} {x1} {bend} {x1} {edge}"><title>{all}</title></path><path class="head" d="M{x1} {edge}l-4 {head}h8z"/><text x="{}" y="{}">{words}<title>{all}</title></text>"#,
        (x0 + x1) / 2.0,
        if forward { edge - tall - 4.0 } else { edge + tall + 14.0 },
    );
}

/// What happens to a value on its way.
fn way(connection: &ConnectionEntry) -> String {
    let latency = connection.delay.to_f64();
    let (jitter, drop) = (connection.channel.jitter.to_f64(), connection.channel.drop);
    let told = [
        (latency > 0.0).then(|| format!("{} late", interval(latency))),
        (jitter > 0.0).then(|| format!("scattered by {}", interval(jitter))),
        (drop > 0.0).then(|| format!("{} % lost", 100.0 * drop)),
    ];
    told.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// The connections and sources as a list.
pub fn table(scenario: &Scenario) -> Table {
    let connections = scenario.connections.iter().map(|connection| {
        vec![connection.from.as_str().into(), connection.to.as_str().into(), way(connection).into()]
    });
    let sources = scenario
        .sources
        .iter()
        .map(|source| vec!["a source".into(), source.to.as_str().into(), Cell::from("")]);
    Table {
        head: ["from", "to", "on the way"].map(str::to_owned).to_vec(),
        rows: connections.chain(sources).collect(),
    }
}

/// When each unit is stepped, over a few of the longest intervals, and when a value that one gives is first used by another.
pub fn timing(diagram: Diagram) -> Option<TimingDiagram> {
    let lanes = diagram.lanes.into_iter().map(|lane| (lane.unit, lane.interval, lane.points));
    TimingDiagram::of(
        diagram.span,
        lanes.collect(),
        diagram.arrows.iter().map(|arrow| (arrow.from, arrow.to)),
    )
}
