//! The next experiment as a picture: what drives it, and what would be measured if each member of the class were the truth.

use crate::error::Error;
use report::thin::thin;
use report::{Axis, Graph, Line, Page, Style};

/// Columns of a picture.
const COLUMNS: usize = 600;
/// Signals that are shown, at most: those that tell most.
const SHOWN: usize = 4;

/// What is planned.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Planned {
    /// What is driven.
    pub inputs: Vec<Course>,
    /// What would be measured.
    pub outputs: Vec<Predicted>,
}

/// A value over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// `instance.variable`.
    pub name: String,
    /// Its unit; empty: none is known.
    pub unit: String,
    /// Time in s and value.
    pub points: Vec<(f64, f64)>,
}

/// A signal with each member as the truth.
#[derive(Debug, Clone, PartialEq)]
pub struct Predicted {
    /// `instance.variable`.
    pub name: String,
    /// Its unit; empty: none is known.
    pub unit: String,
    /// Standard deviation of what is measured there, where it is known.
    pub noise: Option<f64>,
    /// Name of each member and what it predicts, the best guess first, all at the same times.
    pub members: Vec<(String, Vec<(f64, f64)>)>,
}

impl Predicted {
    /// Each other member less the best guess.
    fn differences(&self) -> Vec<(&str, Vec<(f64, f64)>)> {
        let Some(((_, best), others)) = self.members.split_first() else { return Vec::new() };
        let less = |points: &[(f64, f64)]| -> Vec<(f64, f64)> {
            points.iter().zip(best).map(|((time, value), (_, best))| (*time, value - best)).collect()
        };
        others.iter().map(|(name, points)| (name.as_str(), less(points))).collect()
    }

    /// How far two members part, in standard deviations where one is known, else as a share of the swing.
    fn tells(&self) -> f64 {
        let all = || self.members.iter().flat_map(|(_, points)| points).map(|point| point.1);
        let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
        let most =
            self.differences().iter().flat_map(|(_, points)| points).fold(0.0, |m: f64, p| m.max(p.1.abs()));
        let scale = self.noise.filter(|noise| *noise > 0.0).unwrap_or(high - low);
        if scale > 0.0 { most / scale } else { 0.0 }
    }
}

fn labelled(name: &str, unit: &str) -> String {
    if unit.is_empty() { name.to_owned() } else { format!("{name} in {unit}") }
}

/// The pictures.
pub fn show(planned: &Planned, page: &mut Page) -> Result<(), Error> {
    let mut told: Vec<&Predicted> =
        planned.outputs.iter().filter(|output| output.members.len() > 1).collect();
    told.sort_by(|a, b| b.tells().total_cmp(&a.tells()));
    told.truncate(SHOWN);
    let mut graphs: Vec<(Graph, String)> = planned.inputs.iter().map(driven).collect();
    for output in told {
        graphs.push(predicted(output));
        graphs.extend(apart(output));
    }
    if graphs.is_empty() {
        return Ok(());
    }
    page.text(
        "What is driven, and what each explanation predicts, with its value as it was found and without noise; signals that tell most \
         come first. What a diagnosis would lose by taking one for another is less: each other value is fitted anew there.",
    );
    page.graphs(&graphs).map_err(|error| Error::Model(error.to_string()))?;
    Ok(())
}

fn driven(course: &Course) -> (Graph, String) {
    let axis = Axis::fitted(labelled(&course.name, &course.unit));
    let line = Line::solid(course.name.as_str(), thin(&course.points, COLUMNS));
    (
        Graph::new(format!("Driven: {}", course.name), Axis::fitted("time in s"), axis).with(line),
        String::new(),
    )
}

fn predicted(output: &Predicted) -> (Graph, String) {
    let axis = Axis::fitted(labelled(&output.name, &output.unit));
    let mut graph = Graph::new(format!("Predicted: {}", output.name), Axis::fitted("time in s"), axis);
    for (place, (name, points)) in output.members.iter().enumerate() {
        let points = thin(points, COLUMNS);
        graph = graph.with(if place == 0 { Line::solid(name, points) } else { Line::dashed(name, points) });
    }
    (graph, String::new())
}

fn apart(output: &Predicted) -> Option<(Graph, String)> {
    let best = &output.members.first()?.0;
    let axis = Axis::fitted(labelled("difference", &output.unit));
    let title = format!("{}: the others less {best}", output.name);
    let mut graph = Graph::new(title, Axis::fitted("time in s"), axis);
    let differences = output.differences();
    let span = differences.first().and_then(|(_, points)| Some((points.first()?.0, points.last()?.0)))?;
    // The best guess as a line of its own, so that each member keeps its colour.
    graph = graph.with(Line::solid(best, vec![(span.0, 0.0), (span.1, 0.0)]));
    for (name, points) in differences {
        graph = graph.with(Line::dashed(name, thin(&points, COLUMNS)));
    }
    if let Some(noise) = output.noise {
        for (label, side) in [("one sd of noise, above", noise), ("below", -noise)] {
            let points = vec![(span.0, side), (span.1, side)];
            graph = graph.with(Line { label: label.to_owned(), style: Style::Dotted, points });
        }
    }
    Some((graph, String::new()))
}

#[cfg(test)]
mod tests {
    use super::{Course, Planned, Predicted, show};
    use report::Page;

    #[test]
    fn value_the_signal_that_tells_most_comes_first() {
        let points =
            |scale: f64| (0..20).map(|row| (f64::from(row), scale * f64::from(row))).collect::<Vec<_>>();
        let output = |name: &str, other: f64| Predicted {
            name: name.into(),
            unit: "K".into(),
            noise: Some(0.5),
            members: vec![("box.C".into(), points(1.0)), ("box.k".into(), points(other))],
        };
        let inputs = vec![Course { name: "box.u".into(), unit: "W".into(), points: points(0.0) }];
        let (little, much) = (output("box.little", 1.1), output("box.much", 2.0));
        // The last row lies 0.1 · 19 and 19 apart, in noises of 0.5.
        assert!((little.tells() - 3.8).abs() < 1e-12 && (much.tells() - 38.0).abs() < 1e-12);
        let mut page = Page::new("x");
        show(&Planned { inputs, outputs: vec![little, much] }, &mut page).expect("drawn");
        let html = page.to_html();
        let at = |text: &str| html.find(text).unwrap_or_else(|| panic!("{text} is on the page"));
        assert!(
            at("Driven: box.u") < at("Predicted: box.much")
                && at("Predicted: box.much") < at("Predicted: box.little")
        );
        assert!(html.contains("box.much: the others less box.C"));
    }
}
