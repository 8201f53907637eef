//! The scenario's `[report]` table: which signals the page shows, and where pictures come from.

use super::defaults;
use super::verdict::VerdictEntry;
use crate::error::Error;
use orchestrator::{Scenario, Simulation};
use serde::Deserialize;
use std::collections::BTreeSet;

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
#[derive(Debug, Deserialize)]
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
#[derive(Debug, Deserialize)]
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
#[derive(Debug, Clone, Copy, Default, Deserialize)]
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
    pub marks: Vec<(String, String)>,
}

impl Layout {
    /// Reads the table of a scenario.
    pub fn of(scenario: &Scenario) -> Result<Self, Error> {
        let table = scenario.report.clone();
        table.try_into().map_err(|error: toml::de::Error| Error::Layout {
            scenario: scenario.origin.display().to_string(),
            why: error.message().to_owned(),
        })
    }

    /// Chooses graphs where the scenario names none, and refuses a page that needs a variable which is not recorded,
    /// before the run rather than after it.
    pub fn complete(&mut self, simulation: &Simulation) -> Result<(), Error> {
        let recorded: BTreeSet<&str> =
            simulation.columns().iter().map(|column| column.name.as_str()).collect();
        if let Some(missing) = self.signals().into_iter().find(|name| !recorded.contains(name.as_str())) {
            let why = format!("`{missing}` is shown but not recorded: no such variable, or not in [record]");
            return Err(Error::Layout { scenario: simulation.scenario().origin.display().to_string(), why });
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

    /// Every variable that the page needs.
    fn signals(&self) -> Vec<String> {
        let lines = self.graphs().flat_map(|graph| &graph.lines);
        let mut names: Vec<String> =
            lines.flat_map(|line| [Some(line.signal.clone()), line.minus.clone()]).flatten().collect();
        if let Some(picture) = &self.picture {
            let marks = picture.marks.iter().flat_map(|(u, v)| [u, v]);
            names.extend(marks.chain([&picture.index]).map(|name| format!("{}.{name}", picture.unit)));
        }
        names.extend(self.verdict.signals().cloned());
        names
    }
}
