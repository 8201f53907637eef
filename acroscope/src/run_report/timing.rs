//! What the timing of a scenario does to its loops: lines for the terminal, and a diagram with them for the page.

use orchestrator::Simulation;
use orchestrator::timing::{Lane, budget_of, diagram_of};
use report::TimingDiagram;

/// Loops that are told of, the latest first.
const LOOPS: usize = 5;

/// Lanes beyond which a diagram shows nothing any more.
const LANES: usize = 24;

/// How late each loop is and by what, a line each; nothing where there is no loop.
pub fn lines(simulation: &Simulation) -> Vec<String> {
    // A scenario without a common tick could not have been built.
    let (loops, more) = budget_of(simulation, LOOPS).unwrap_or_default();
    let mut lines: Vec<String> = loops.iter().map(ToString::to_string).collect();
    if more {
        lines.push("there are more loops, which are less late".into());
    }
    lines
}

/// The diagram as SVG, and the words below it; nothing where there is no loop.
pub fn figure(simulation: &Simulation) -> Option<(String, String)> {
    let lines = lines(simulation);
    let diagram =
        diagram_of(simulation).ok().filter(|diagram| !lines.is_empty() && diagram.lanes.len() <= LANES)?;
    let label = |lane: &Lane| match lane.points.is_empty() {
        true => format!("{}, each {} s", lane.unit, report::head::short(lane.interval)),
        false => lane.unit.clone(),
    };
    let drawn = TimingDiagram {
        span: diagram.span,
        lanes: diagram.lanes.iter().map(|lane| (label(lane), lane.points.clone())).collect(),
        arrows: diagram.arrows.iter().map(|arrow| (arrow.from, arrow.to)).collect(),
    };
    let words = format!(
        "Points of the units, and the first use of each value. How late a value is on average once round, without what the \
         units delay inside: {}.",
        lines.join("; ")
    );
    Some((drawn.to_svg(), words))
}
