//! The four graphs that Figures 19 to 27 have in common.

use crate::closed_loop::Trace;
use crate::{Error, Outcome};
use report::{Axis, Graph, Line};

/// Adds them: tracking (z_desired solid, z dashed), q₁ solid and q₂ dashed, torque, tracking error, over time.
pub fn add(outcome: &mut Outcome, trace: &Trace, figure: &str, what: &str) -> Result<(), Error> {
    let points = |values: &[f64]| trace.times.iter().copied().zip(values.iter().copied()).collect::<Vec<_>>();
    let graph = |title: &str, y: &str| {
        Graph::new(format!("{figure}: {title}"), Axis::fitted("time in s"), Axis::fitted(y))
    };
    let tracking = graph("tracking along the manifold", "z")
        .with(Line::solid("z desired", points(&trace.z_desired)))
        .with(Line::dashed("z", points(&trace.z)));
    let state = graph("state", "angle in rad")
        .with(Line::solid("q₁", points(&trace.q1)))
        .with(Line::dashed("q₂", points(&trace.q2)));
    let torque = graph("torque", "τ in N·m").with(Line::solid("", points(&trace.tau)));
    let error = graph("tracking error", "z desired − z").with(Line::solid("", trace.tracking_error()));
    let captions = [
        format!("{figure} of the paper, {what}. z_desired solid, z dashed."),
        "The angles, q₁ solid, q₂ dashed.".to_owned(),
        "The torque between the links.".to_owned(),
        "The tracking error.".to_owned(),
    ];
    for (graph, caption) in [tracking, state, torque, error].into_iter().zip(captions) {
        outcome.graph(graph, caption)?;
    }
    Ok(())
}
