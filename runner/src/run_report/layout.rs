//! The scenario's `[report]` table: which signals the page shows, and where pictures come from.

use super::defaults;
use super::verdict::VerdictEntry;
use crate::error::Error;
use orchestrator::{Kind, Scenario, Simulation};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What the page shows.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Layout {
    /// Graphs over time, in order; without the key, the outputs of all units.
    graphs: Option<Vec<GraphEntry>>,
    /// A picture that a unit wrote.
    pub picture: Option<PictureEntry>,
    /// What is wished and counted.
    pub verdict: VerdictEntry,
    /// Graphs that were left out for want of room.
    #[serde(skip)]
    pub more_graphs: usize,
}

/// One graph over time.
#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct GraphEntry {
    /// Title above it.
    pub title: String,
    /// Label of the vertical axis.
    pub y: String,
    /// Its lines.
    pub lines: Vec<LineEntry>,
}

/// One line: a recorded signal, or the difference of two.
#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct LineEntry {
    /// `unit.variable`
    pub signal: String,
    /// Taken off the signal.
    pub minus: Option<String>,
    /// Entry in the legend.
    #[serde(default)]
    pub label: String,
    /// How it is drawn.
    #[serde(default)]
    pub style: LineStyle,
}

/// How a line is drawn.
#[derive(Debug, Clone, Copy, Default, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum LineStyle {
    /// Connected points.
    #[default]
    Solid,
    /// Dashed.
    Dashed,
    /// Dotted.
    Dotted,
}

/// Pictures that a unit writes as numbered PNG files, and the places it found in them.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PictureEntry {
    /// Text below the picture.
    pub caption: String,
    /// The unit.
    pub unit: String,
    /// Its String parameter that takes the folder.
    pub directory: String,
    /// Its output that gives the number of the newest picture.
    pub index: String,
    /// Pairs of outputs: places in pixels, u right and v up from the centre of the picture.
    pub marks: Vec<Mark>,
}

/// The outputs that give a place: u and v. Not a tuple: of those a third name would be dropped without a word.
#[derive(Debug, Deserialize)]
#[serde(try_from = "Vec<String>")]
pub struct Mark(pub String, pub String);

impl TryFrom<Vec<String>> for Mark {
    type Error = String;

    fn try_from(names: Vec<String>) -> Result<Self, String> {
        let count = names.len();
        let [u, v] = names
            .try_into()
            .map_err(|_| format!("a mark of {count} names: two outputs are wanted, u and v"))?;
        Ok(Self(u, v))
    }
}

/// The error, with the line of the file, if there is one to be read and the mistake is found in it.
fn wrong(scenario: &Scenario, line: impl Fn(&str) -> Option<usize>, why: String) -> Error {
    let file = scenario.origin.display();
    // As the scenario itself was read: what is no plain file may wait for ever.
    let text = orchestrator::plain::read_text(&scenario.origin).ok();
    let scenario = match text.and_then(|text| line(&text)) {
        Some(line) => format!("{file}:{line}"),
        None => file.to_string(),
    };
    Error::Layout { scenario, why }
}

/// Where a table that can't be read is wrong.
fn line_of_mistake(text: &str) -> Option<usize> {
    #[derive(Deserialize)]
    struct Whole {
        #[serde(rename = "report")]
        _report: Layout,
    }
    let place = toml::from_str::<Whole>(text).err()?.span()?.start;
    Some(1 + text.get(..place)?.matches('\n').count())
}

/// Where a variable is named first, from the first table of the report on.
fn line_of_name(text: &str, name: &str) -> Option<usize> {
    let begin = text.lines().position(|line| {
        line.trim_start().starts_with("[report") || line.trim_start().starts_with("[[report")
    })?;
    let named = |line: &str| ['"', '\''].iter().any(|quote| line.contains(&format!("{quote}{name}{quote}")));
    text.lines().skip(begin).position(named).map(|line| 1 + begin + line)
}

impl Layout {
    /// Reads the table of a scenario.
    pub fn of(scenario: &Scenario) -> Result<Self, Error> {
        let table = scenario.report.clone();
        table
            .try_into()
            .map_err(|error: toml::de::Error| wrong(scenario, line_of_mistake, error.message().to_owned()))
    }

    /// Chooses graphs where the scenario names none, and refuses a page that needs a variable which is not recorded, or of another
    /// type, before the run rather than after it.
    pub fn complete(&mut self, simulation: &Simulation) -> Result<(), Error> {
        let recorded: BTreeMap<&str, Kind> =
            simulation.columns().iter().map(|column| (column.name.as_str(), column.kind)).collect();
        let refused = |name: &str, why: String| {
            Err(wrong(simulation.scenario(), |text| line_of_name(text, name), format!("`{name}` {why}")))
        };
        for name in self.signals() {
            match recorded.get(name.as_str()) {
                None => {
                    return refused(
                        &name,
                        "is shown but not recorded: no such variable, or not in [record]".into(),
                    );
                }
                Some(Kind::String) => {
                    return refused(&name, "is of type String: a number or a Boolean is wanted".into());
                }
                Some(_) => {}
            }
        }
        for (key, name) in self.verdict.booleans() {
            match recorded.get(name.as_str()) {
                Some(Kind::Boolean) | None => {}
                Some(other) => return refused(name, format!("is of type {other}: {key} wants a Boolean")),
            }
        }
        for (signal, minus) in self.differences() {
            if let Some(why) = simulation.unlike(signal, minus) {
                let line = |text: &str| line_of_name(text, minus);
                return Err(wrong(simulation.scenario(), line, format!("minus = {minus:?}: {why}")));
            }
        }
        if self.graphs.is_none() {
            let (graphs, more) = defaults::graphs(simulation);
            self.graphs = Some(graphs);
            self.more_graphs = more;
        }
        Ok(())
    }

    /// The graphs.
    pub fn graphs(&self) -> impl Iterator<Item = &GraphEntry> {
        self.graphs.iter().flatten()
    }

    /// The graphs as JSON, for a host that draws them itself.
    pub fn graphs_as_json(&self) -> String {
        // Texts only: nothing can fail.
        serde_json::to_string(&self.graphs().collect::<Vec<_>>()).unwrap_or_default()
    }

    /// Signals, and what is taken off them.
    fn differences(&self) -> impl Iterator<Item = (&str, &str)> {
        let lines = self.graphs().flat_map(|graph| &graph.lines);
        let lines = lines.filter_map(|line| Some((line.signal.as_str(), line.minus.as_deref()?)));
        let figures = self.verdict.figures.iter();
        lines.chain(figures.filter_map(|figure| Some((figure.signal.as_str(), figure.minus.as_deref()?))))
    }

    /// Every variable that the page needs.
    fn signals(&self) -> Vec<String> {
        let lines = self.graphs().flat_map(|graph| &graph.lines);
        let mut names: Vec<String> =
            lines.flat_map(|line| [Some(line.signal.clone()), line.minus.clone()]).flatten().collect();
        if let Some(picture) = &self.picture {
            let marks = picture.marks.iter().flat_map(|Mark(u, v)| [u, v]);
            names.extend(marks.chain([&picture.index]).map(|name| format!("{}.{name}", picture.unit)));
        }
        names.extend(self.verdict.signals().cloned());
        names
    }
}
