//! The scenario's `[report]` table: which signals the page shows, and where pictures come from.

use crate::error::Error;
use orchestrator::Scenario;
use serde::Deserialize;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// What the page shows.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Layout {
    /// Graphs over time, in order.
    pub graphs: Vec<GraphEntry>,
    /// A picture that a unit wrote.
    pub picture: Option<PictureEntry>,
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
    /// Reads the table of a scenario; a scenario without one gets a page without graphs.
    pub fn of(scenario: &Scenario) -> Result<Self, Error> {
        let table = scenario.report.clone();
        table.try_into().map_err(|error: toml::de::Error| Error::Layout {
            scenario: scenario.origin.display().to_string(),
            why: error.message().to_owned(),
        })
    }

    /// Refuses a page that needs a variable which is not recorded, before the run rather than after it.
    pub fn check<'a>(
        &self,
        scenario: &Scenario,
        recorded: impl Iterator<Item = &'a str>,
    ) -> Result<(), Error> {
        let recorded: BTreeSet<&str> = recorded.collect();
        match self.signals().into_iter().find(|name| !recorded.contains(name.as_str())) {
            None => Ok(()),
            Some(missing) => Err(Error::Layout {
                scenario: scenario.origin.display().to_string(),
                why: format!("`{missing}` is shown but not recorded: no such variable, or not in [record]"),
            }),
        }
    }

    /// Every variable that the page needs.
    fn signals(&self) -> Vec<String> {
        let lines = self.graphs.iter().flat_map(|graph| &graph.lines);
        let mut names: Vec<String> =
            lines.flat_map(|line| [Some(line.signal.clone()), line.minus.clone()]).flatten().collect();
        if let Some(picture) = &self.picture {
            let marks = picture.marks.iter().flat_map(|(u, v)| [u, v]);
            names.extend(marks.chain([&picture.index]).map(|name| format!("{}.{name}", picture.unit)));
        }
        names
    }
}

impl PictureEntry {
    /// The folder for this run's pictures, emptied of those of the last run.
    pub fn fresh_folder(&self, out: &Path) -> Result<PathBuf, Error> {
        let folder = out.join("frames");
        std::fs::create_dir_all(&folder).map_err(Error::file(&folder))?;
        for (path, _) in pictures(&folder)? {
            std::fs::remove_file(&path).map_err(Error::file(&path))?;
        }
        std::path::absolute(&folder).map_err(Error::file(&folder))
    }

    /// `unit.variable` of the parameter that takes the folder.
    pub fn directory_parameter(&self) -> String {
        format!("{}.{}", self.unit, self.directory)
    }
}

/// The numbered pictures of a folder, in order.
pub fn pictures(folder: &Path) -> Result<Vec<(PathBuf, u64)>, Error> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(Error::file(folder))? {
        let path = entry.map_err(Error::file(folder))?.path();
        let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        let number = stem.strip_prefix("frame_").and_then(|digits| digits.parse().ok());
        if let (Some(number), Some("png")) =
            (number, path.extension().and_then(|extension| extension.to_str()))
        {
            found.push((path, number));
        }
    }
    found.sort_by_key(|(_, number)| *number);
    Ok(found)
}
