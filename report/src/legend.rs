//! The legend of a graph: a strip between title and frame, so that it never lies over the data.

use crate::graph::{Area, FONT, Marks, Refusal, SIZE, Style};
use plotters::element::DashedPathElement;
use plotters::prelude::*;

/// One entry: a sample of the line and its name.
pub(crate) struct Entry<'a> {
    pub(crate) text: &'a str,
    pub(crate) style: Style,
    pub(crate) colour: RGBColor,
}

/// Height of a row, where the first entry begins, length of the sample, and the gaps around the text, in pixels.
const ROW: i32 = 18;
const LEFT: i32 = 72;
const SAMPLE: i32 = 20;
const GAP: i32 = 6;
const BETWEEN: i32 = 18;

impl Entry<'_> {
    /// Letters of a sans-serif of 13 px are 6.6 px wide on average; nothing here knows the browser's font.
    fn width(&self) -> i32 {
        SAMPLE + GAP + (6.6 * self.text.chars().count() as f64).ceil() as i32 + BETWEEN
    }
}

/// Where each entry begins: row by row, as many as fit.
fn places(entries: &[Entry<'_>]) -> Vec<(i32, i32)> {
    let (mut x, mut row) = (LEFT, 0);
    let mut places = Vec::with_capacity(entries.len());
    for entry in entries {
        if x > LEFT && x + entry.width() > SIZE.0 as i32 {
            (x, row) = (LEFT, row + 1);
        }
        places.push((x, row * ROW));
        x += entry.width();
    }
    places
}

/// Height of the strip.
pub(crate) fn height(entries: &[Entry<'_>]) -> i32 {
    places(entries).last().map_or(0, |(_, y)| y + ROW)
}

/// Draws the strip.
pub(crate) fn draw(area: &Area<'_>, entries: &[Entry<'_>]) -> Result<(), Refusal> {
    for (entry, (x, y)) in entries.iter().zip(places(entries)) {
        let middle = y + ROW / 2;
        let ends = [(x, middle), (x + SAMPLE, middle)];
        let style = entry.style.connected();
        let stroke = entry.colour.stroke_width(if matches!(style, Style::Dotted) { 2 } else { 1 });
        match style {
            // `connected` leaves none that is held.
            Style::Solid | Style::Held(_) => area.draw(&PathElement::new(ends, stroke))?,
            Style::Dashed => area.draw(&DashedPathElement::new(ends, 6, 3, stroke))?,
            Style::Dotted => area.draw(&DashedPathElement::new(ends, 2, 3, stroke))?,
            Style::Points(Marks::Dot) => {
                area.draw(&Circle::new((x + SAMPLE / 2, middle), 2, entry.colour.filled()))?
            }
            Style::Points(Marks::Cross) => area.draw(&Cross::new((x + SAMPLE / 2, middle), 3, stroke))?,
        }
        area.draw(&Text::new(entry.text, (x + SAMPLE + GAP, middle - 7), (FONT, 13)))?;
    }
    Ok(())
}
