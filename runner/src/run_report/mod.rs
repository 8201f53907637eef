//! What is told of a run, from what lies in the folder of results: the verdict, where the run comes from, and the graphs
//! and the picture that the scenario's `[report]` table asks for. `report.html` shows it, `summary.json` holds it.

mod defaults;
mod layout;
mod picture;
mod series;
mod summary;
pub mod timing;
mod verdict;

pub use layout::{Layout, PictureEntry};
pub use picture::{Dated, clear as clear_pictures, dated as dated_pictures, pictures};
pub use summary::{Ended, How, Summary};

use crate::error::Error;
use layout::{GraphEntry, LineStyle, Mark};
use orchestrator::{Kind, Simulation};
use report::extent;
use report::head::short;
use report::{Axis, Figure, Graph, Line, Page, Provenance, Standing, Style, Verdict};
use series::{Series, Wanted};
use std::collections::BTreeSet;
use std::path::Path;

/// A run that came to an end, of whatever kind.
pub struct Finished<'a> {
    /// What was run.
    pub simulation: &'a Simulation,
    /// What the page shows.
    pub layout: &'a Layout,
    /// Folder with `results.csv` and, where the layout has a picture, `frames`.
    pub folder: &'a Path,
    /// How it ended.
    pub how: How,
    /// The unit that ended it, if one wanted to.
    pub by: Option<String>,
    /// The error that ended it.
    pub error: Option<String>,
    /// Where it comes from.
    pub provenance: Provenance,
}

impl Finished<'_> {
    /// The summary, and the page as HTML. `None` if the run ended before its first row.
    pub fn tell(self) -> Result<Option<(Summary, String)>, Error> {
        let shots = match &self.layout.picture {
            Some(_) => pictures(&self.folder.join("frames"))?,
            None => Vec::new(),
        };
        let wanted = self.wanted(shots.iter().map(|(_, number)| *number).collect());
        let series = series::read(&self.folder.join("results.csv"), &wanted)?;
        if series.rows == 0 {
            return Ok(None);
        }
        let summary = self.summary(&series);
        let mut page = Page::new(&summary.title);
        page.verdict(&summary.verdict).provenance(&summary.provenance);
        page.text(
            "Every signal is in `results.csv`, every value that was used in `resolved.toml`, this head for programs in \
             `summary.json`, all beside this page.",
        );
        self.graphs(&series, &mut page)?;
        if let Some(figure) = timing::figure(self.simulation) {
            page.heading("Timing of the units").figures(&[figure]);
        }
        if let Some(entry) = &self.layout.picture {
            entry.show(&shots, &series.at_index, series.failed, &mut page)?;
        }
        Ok(Some((summary, page.to_html())))
    }

    fn wanted(&self, numbers: Vec<u64>) -> Wanted<'_> {
        let lines = self.layout.graphs().flat_map(|graph| &graph.lines);
        let mut lines: Vec<_> = lines.map(|line| (line.signal.clone(), line.minus.clone())).collect();
        lines.sort();
        lines.dedup();
        let watch = self.layout.picture.as_ref().map(|entry| {
            let named = |name: &String| format!("{}.{name}", entry.unit);
            let marks = entry.marks.iter().flat_map(|Mark(u, v)| [named(u), named(v)]).collect();
            (named(&entry.index), numbers, marks)
        });
        Wanted { lines, watch, verdict: &self.layout.verdict }
    }

    fn summary(&self, series: &Series) -> Summary {
        Summary {
            format: 1,
            title: self.simulation.scenario().description.clone(),
            ended: Ended { how: self.how, time: series.last, error: self.error.clone() },
            rows: series.rows,
            failed_at: series.failed,
            verdict: self.verdict(series),
            units: (self.simulation.columns().iter())
                .filter_map(|column| Some((column.name.clone(), column.unit.clone()?)))
                .collect(),
            provenance: self.provenance.clone(),
        }
    }

    fn verdict(&self, series: &Series) -> Verdict {
        let entry = &self.layout.verdict;
        let last = short(series.last);
        let words = match (series.failed, self.how) {
            (Some(failed), How::Stop | How::Unit) => format!("{} at t = {} s", entry.failed, short(failed)),
            (Some(failed), How::Interrupted) => {
                format!("{} at t = {} s, interrupted at t = {last} s", entry.failed, short(failed))
            }
            (Some(failed), How::Error) => {
                format!("{} at t = {} s, ended by an error after t = {last} s", entry.failed, short(failed))
            }
            (None, How::Stop) => format!("{} to t = {last} s", entry.held),
            (None, How::Unit) => {
                let unit = self.by.as_deref().unwrap_or("?");
                format!("{} to t = {last} s, where unit {unit} ended the run", entry.held)
            }
            (None, How::Interrupted) => format!("{} until it was interrupted at t = {last} s", entry.held),
            (None, How::Error) => format!("ended by an error after t = {last} s"),
        };
        let standing = match (series.failed, self.how) {
            (Some(_), _) | (_, How::Error) => Standing::Bad,
            (None, How::Stop | How::Unit) if entry.fails_when.is_some() && series.not_finite.is_empty() => {
                Standing::Good
            }
            _ => Standing::Plain,
        };
        let figures = entry.figures.iter().zip(&series.figures);
        let figures = figures.map(|(figure, value)| Figure::new(&figure.label, *value, self.unit(figure)));
        Verdict { standing, words, figures: figures.collect(), notes: self.notes(series) }
    }

    /// Physical unit of a figure, as its signal's description has it.
    fn unit(&self, figure: &verdict::FigureEntry) -> String {
        let column = self.simulation.columns().iter().find(|column| column.name == figure.signal);
        let unit = column.and_then(|column| column.unit.clone());
        unit.filter(|unit| unit != "1" && figure.reduce != verdict::Reduce::Lost).unwrap_or_default()
    }

    fn notes(&self, series: &Series) -> Vec<String> {
        let mut notes = Vec::new();
        if let Some(error) = &self.error {
            notes.push(format!("The error: {error}"));
        }
        if series.failed.is_some() {
            notes.push(
                "The numbers are those up to then; graphs are scaled up to then and end a little later."
                    .to_owned(),
            );
        }
        notes.extend(series.told.iter().cloned());
        let told = self.simulation.notices();
        let is_told = |name: &str| told.iter().any(|notice| notice.starts_with(&format!("{name} is ")));
        if let Some((name, time, text)) = series.not_finite.iter().find(|(name, ..)| !is_told(name)) {
            let others = match series.not_finite.len() - 1 {
                0 => String::new(),
                more => format!("; {more} more signals are not finite at some time"),
            };
            notes.push(format!("{name} is {text} at t = {} s{others}", short(*time)));
        }
        notes.extend(told);
        notes
    }

    fn graphs(&self, series: &Series, page: &mut Page) -> Result<(), Error> {
        let event = series.failed.map(|time| {
            let words = &self.layout.verdict.failed;
            (time, format!("{words} at {} s; scaled up to then", short(time)))
        });
        let columns = self.simulation.columns().iter().filter(|column| column.kind != Kind::Real);
        let held: BTreeSet<&str> = columns.map(|column| column.name.as_str()).collect();
        let mut drawn = Vec::new();
        let mut empty = Vec::new();
        for entry in self.layout.graphs() {
            let graph = graph(entry, series, event.clone(), &held);
            match graph.lines.iter().flat_map(|line| &line.points).any(|(_, value)| extent::is_drawn(*value))
            {
                true => drawn.push((graph, String::new())),
                false => empty.push(entry.title.as_str()),
            }
        }
        if !drawn.is_empty() {
            page.heading("Signals").graphs(&drawn)?;
        }
        if !empty.is_empty() {
            page.text(&format!("Without a finite value, and so without a graph: {}.", empty.join(", ")));
        }
        if self.layout.more_graphs > 0 {
            page.text(&format!(
                "{} more graphs of outputs are left out; `[report]` in the scenario chooses which are shown.",
                self.layout.more_graphs
            ));
        }
        Ok(())
    }
}

/// One graph, values of `held` as steps; after the event lines go on a little, but the scale is that of what came before.
fn graph(entry: &GraphEntry, series: &Series, event: Option<(f64, String)>, held: &BTreeSet<&str>) -> Graph {
    let mut graph = Graph::new(entry.title.clone(), Axis::fitted("time in s"), Axis::fitted(entry.y.clone()));
    for line in &entry.lines {
        let style = match line.style {
            LineStyle::Solid => Style::Solid,
            LineStyle::Dashed => Style::Dashed,
            LineStyle::Dotted => Style::Dotted,
        };
        let is_held = |name: &String| held.contains(name.as_str());
        let steps = is_held(&line.signal) && line.minus.iter().all(is_held);
        let style = if steps { style.held() } else { style };
        let key = (line.signal.clone(), line.minus.clone());
        let points = series.lines.get(&key).cloned().unwrap_or_default();
        graph.lines.push(Line { label: line.label.clone(), style, points });
    }
    if let Some((time, _)) = &event {
        let before = graph.lines.iter().flat_map(|line| &line.points).filter(|(at, _)| at <= time);
        let reached = extent::of(before.map(|(_, value)| *value)).filter(|(low, high)| low < high);
        graph.y.range = reached.map(extent::with_margin).or(graph.y.range);
    }
    graph.event = event;
    graph
}
