//! `report.html` of a run: the graphs and the picture that the scenario's `[report]` table asks for.

mod layout;
mod series;

pub use layout::Layout;

use crate::error::Error;
use layout::{GraphEntry, LineStyle, PictureEntry, pictures};
use orchestrator::Scenario;
use report::{Axis, Graph, Line, Page, Picture, Style};
use series::{Series, Wanted};
use std::path::Path;

/// The page as HTML, from what lies in the folder of results.
pub fn page(scenario: &Scenario, layout: &Layout, out: &Path) -> Result<String, Error> {
    let title = if scenario.description.is_empty() { "A run" } else { &scenario.description };
    let mut page = Page::new(title);
    page.text(&format!(
        "Scenario {}. Every signal is in results.csv, every value that was used in resolved.toml, both beside this page.",
        scenario.origin.display()
    ));
    let shots = match &layout.picture {
        Some(_) => pictures(&out.join("frames"))?,
        None => Vec::new(),
    };
    let wanted = wanted(layout, shots.iter().map(|(_, number)| *number).collect());
    let series = series::read(&out.join("results.csv"), &wanted)?;
    let graphs = layout.graphs.iter().map(|entry| Ok((graph(entry, &series).to_svg()?, String::new())));
    page.figures(&graphs.collect::<Result<Vec<_>, Error>>()?);
    if let Some(entry) = &layout.picture {
        // The middle of the pictures that were delivered with their marks: the arm is at its farthest there.
        let delivered: Vec<_> =
            shots.iter().filter(|(_, number)| series.at_index.contains_key(number)).collect();
        if let Some((path, number)) = delivered.get(delivered.len() / 2) {
            let svg = picture(entry, path, &series.at_index[number])?.to_svg();
            page.figure(&svg, &format!("{}: frame {number}", entry.caption));
        }
    }
    Ok(page.to_html())
}

fn wanted(layout: &Layout, numbers: Vec<u64>) -> Wanted {
    let lines = layout.graphs.iter().flat_map(|graph| &graph.lines);
    let mut lines: Vec<_> = lines.map(|line| (line.signal.clone(), line.minus.clone())).collect();
    lines.sort();
    lines.dedup();
    let watch = layout.picture.as_ref().map(|entry| {
        let named = |name: &String| format!("{}.{name}", entry.unit);
        let marks = entry.marks.iter().flat_map(|(u, v)| [named(u), named(v)]).collect();
        (named(&entry.index), numbers, marks)
    });
    Wanted { lines, watch }
}

fn graph(entry: &GraphEntry, series: &Series) -> Graph {
    let axes = (Axis::fitted("time in s"), Axis::fitted(entry.y.clone()));
    let mut graph = Graph::new(entry.title.clone(), axes.0, axes.1);
    for line in &entry.lines {
        let style = match line.style {
            LineStyle::Solid => Style::Solid,
            LineStyle::Dashed => Style::Dashed,
            LineStyle::Dotted => Style::Dotted,
        };
        let key = (line.signal.clone(), line.minus.clone());
        let points = series.lines.get(&key).cloned().unwrap_or_default();
        graph.lines.push(Line { label: line.label.clone(), style, points });
    }
    graph
}

/// The picture with its marks; `places` holds u and v of each in turn, in pixels from the centre, v up.
fn picture(entry: &PictureEntry, path: &Path, places: &[f64]) -> Result<Picture, Error> {
    let png = std::fs::read(path).map_err(Error::file(path))?;
    let decoder = png::Decoder::new(std::io::Cursor::new(png.as_slice()));
    let reader =
        decoder.read_info().map_err(|why| Error::File { path: path.to_owned(), why: why.to_string() })?;
    let size = (reader.info().width, reader.info().height);
    let centre = (f64::from(size.0) / 2.0, f64::from(size.1) / 2.0);
    let names = entry.marks.iter().map(|(u, v)| format!("{u}, {v}"));
    let marks = names
        .zip(places.chunks_exact(2))
        .map(|(name, place)| (name, centre.0 + place[0], centre.1 - place[1]));
    Ok(Picture { png, size, marks: marks.collect() })
}
