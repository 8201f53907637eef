//! What the timing of a scenario does to its loops: lines for the terminal, and a diagram with them for the page.

use orchestrator::Simulation;
use orchestrator::timing::{budget_of, diagram_of};
use report::TimingDiagram;

/// Loops that are told of, the latest first.
const LOOPS: usize = 5;

/// What such a number leaves out: it follows from intervals, offsets, channels and algorithm, whatever values units are given.
const BETWEEN: &str = "between the units; what they delay inside comes on top";

/// How late each loop is and by what, a line each; nothing where there is no loop.
pub fn lines(simulation: &Simulation) -> Vec<String> {
    // A scenario without a common tick could not have been built.
    let (loops, more) = budget_of(simulation, LOOPS).unwrap_or_default();
    let mut lines: Vec<String> = loops.iter().map(|budget| format!("{budget}, {BETWEEN}")).collect();
    if more {
        lines.push("there are more loops, which are less late".into());
    }
    if loops.iter().any(|budget| budget.terms().scheme < 0.0) {
        let algorithm = &simulation.scenario().algorithm.value;
        lines.push(format!(
            "a scheme below 0 is a lead: {algorithm} gives a unit values of its step's end for the whole step"
        ));
    }
    lines
}

/// Why a part of a delay is below zero.
const EARLY: &str = " The scheme is negative where units are stepped one after the other: each is given what those before it hold at the end \
                     of its step, not at its begin.";

/// The diagram as SVG, and the words below it; nothing where there is no loop.
pub fn figure(simulation: &Simulation) -> Option<(String, String)> {
    let lines = lines(simulation);
    let diagram = diagram_of(simulation).ok().filter(|_| !lines.is_empty())?;
    let lanes = diagram.lanes.into_iter().map(|lane| (lane.unit, lane.interval, lane.points));
    let arrows = diagram.arrows.iter().map(|arrow| (arrow.from, arrow.to));
    let drawn = TimingDiagram::of(diagram.span, lanes.collect(), arrows)?;
    let words = format!(
        "When each unit is stepped, and when a value that one gives is first used by another. How late a value is on average \
         once round: {}.{}",
        lines.join("; "),
        if lines.iter().any(|line| line.contains("scheme -")) { EARLY } else { "" }
    );
    Some((drawn.to_svg(), words))
}
