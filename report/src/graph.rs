//! A graph of lines over an axis, as the paper draws them: solid, dashed, dotted, or marks.

use crate::Error;
use crate::thin::thin;
use plotters::chart::SeriesAnno;
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::element::DashedPathElement;
use plotters::prelude::*;

/// Size of a graph on the page, in CSS pixels.
pub(crate) const SIZE: (u32, u32) = (640, 380);
/// Font of all labels. SVG only names it; the browser has it.
pub(crate) const FONT: &str = "sans-serif";

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// Connected points.
    Solid,
    /// Connected points, dashed.
    Dashed,
    /// Connected points, dotted.
    Dotted,
    /// Each point by itself.
    Points(Marks),
}

/// The mark of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marks {
    /// A disc.
    Dot,
    /// A diagonal cross.
    Cross,
}

/// One line of a graph.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Its entry in the legend; empty: none.
    pub label: String,
    /// How it is drawn.
    pub style: Style,
    /// Points ordered by x. Points that are not finite interrupt the line.
    pub points: Vec<(f64, f64)>,
}

impl Line {
    /// A solid line.
    pub fn solid(label: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self { label: label.into(), style: Style::Solid, points }
    }

    /// A dashed line.
    pub fn dashed(label: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self { label: label.into(), style: Style::Dashed, points }
    }

    /// Dots.
    pub fn dots(label: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self { label: label.into(), style: Style::Points(Marks::Dot), points }
    }
}

/// An axis: what it shows, and over which range; without a range it fits the data.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Axis {
    /// Label with unit.
    pub label: String,
    /// Fixed range.
    pub range: Option<(f64, f64)>,
}

impl Axis {
    /// An axis that fits the data.
    pub fn fitted(label: impl Into<String>) -> Self {
        Self { label: label.into(), range: None }
    }

    /// An axis over a range of its own.
    pub fn over(label: impl Into<String>, from: f64, to: f64) -> Self {
        Self { label: label.into(), range: Some((from, to)) }
    }
}

/// A graph.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Graph {
    /// Title above the graph; empty: none.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Lines, drawn in this order.
    pub lines: Vec<Line>,
}

impl Graph {
    /// An empty graph with its axes.
    pub fn new(title: impl Into<String>, x: Axis, y: Axis) -> Self {
        Self { title: title.into(), x, y, lines: Vec::new() }
    }

    /// Adds a line.
    #[must_use]
    pub fn with(mut self, line: Line) -> Self {
        self.lines.push(line);
        self
    }

    /// Draws the graph as SVG.
    pub fn to_svg(&self) -> Result<String, Error> {
        let x_range = self.range(&self.x, |point| point.0, 0.0)?;
        let y_range = self.range(&self.y, |point| point.1, 0.06)?;
        let mut svg = String::new();
        {
            let root = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
            self.draw(&root, x_range, y_range).map_err(|why| self.refused(&why))?;
            root.present().map_err(|why| self.refused(&why))?;
        }
        Ok(svg)
    }

    fn refused(&self, why: &dyn std::fmt::Display) -> Error {
        Error::Draw { title: self.title.clone(), why: why.to_string() }
    }

    fn draw(&self, root: &Area<'_>, x: (f64, f64), y: (f64, f64)) -> Result<(), Refusal> {
        root.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(root)
            .caption(&self.title, (FONT, 16))
            .margin(8)
            .x_label_area_size(38)
            .y_label_area_size(64)
            .build_cartesian_2d(x.0..x.1, y.0..y.1)?;
        chart
            .configure_mesh()
            .light_line_style(WHITE)
            .bold_line_style(RGBColor(225, 225, 225))
            .x_desc(&self.x.label)
            .y_desc(&self.y.label)
            .label_style((FONT, 13))
            .axis_desc_style((FONT, 14))
            .x_label_formatter(&|value| tick(*value, x))
            .y_label_formatter(&|value| tick(*value, y))
            .draw()?;
        for (index, line) in self.lines.iter().enumerate() {
            draw_line(&mut chart, line, colour(index))?;
        }
        if self.lines.iter().any(|line| !line.label.is_empty()) {
            chart
                .configure_series_labels()
                .background_style(WHITE.mix(0.85))
                .border_style(RGBColor(200, 200, 200))
                .label_font((FONT, 13))
                .position(SeriesLabelPosition::UpperRight)
                .draw()?;
        }
        Ok(())
    }

    /// The range of an axis: its own, or that of the data with a margin (a share of the range).
    fn range(&self, axis: &Axis, of: impl Fn(&(f64, f64)) -> f64, margin: f64) -> Result<(f64, f64), Error> {
        if let Some(range) = axis.range {
            return Ok(range);
        }
        let finite =
            self.lines.iter().flat_map(|line| &line.points).map(of).filter(|value| value.is_finite());
        let (low, high) =
            finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        if low > high {
            return Err(Error::Empty { title: self.title.clone() });
        }
        let span = high - low;
        // A constant line gets a band around it, so that it doesn't lie on the frame.
        let pad = if span > 0.0 { margin * span } else { 0.5 * high.abs().max(1e-3) };
        Ok((low - pad, high + pad))
    }
}

/// Colours that stay apart in print and for colour-blind eyes (Okabe and Ito, 2008).
pub(crate) fn colour(index: usize) -> RGBColor {
    const PALETTE: [RGBColor; 6] = [
        RGBColor(0, 0, 0),
        RGBColor(213, 94, 0),
        RGBColor(0, 114, 178),
        RGBColor(0, 158, 115),
        RGBColor(204, 121, 167),
        RGBColor(230, 159, 0),
    ];
    PALETTE[index % PALETTE.len()]
}

/// A tick's label: as many decimals as the range asks for.
pub(crate) fn tick(value: f64, range: (f64, f64)) -> String {
    let span = (range.1 - range.0).abs().max(f64::MIN_POSITIVE);
    if value != 0.0 && !(1e-3..1e6).contains(&span) {
        return format!("{value:.1e}");
    }
    let decimals = (1.3 - span.log10()).ceil().clamp(0.0, 6.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.trim_start_matches('-').chars().all(|c| matches!(c, '0' | '.')) { "0".to_owned() } else { text }
}

pub(crate) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a> = ChartContext<'a, SVGBackend<'a>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
pub(crate) type Refusal = DrawingAreaErrorKind<<SVGBackend<'static> as DrawingBackend>::ErrorType>;

fn draw_line<'a>(chart: &mut Chart<'a>, line: &Line, colour: RGBColor) -> Result<(), Refusal> {
    let stroke = colour.stroke_width(if matches!(line.style, Style::Dotted) { 2 } else { 1 });
    let pieces =
        line.points.split(|(x, y)| !x.is_finite() || !y.is_finite()).filter(|piece| !piece.is_empty());
    let mut label = (!line.label.is_empty()).then_some(line.label.as_str());
    for piece in pieces {
        let points = thin(piece, SIZE.0 as usize);
        let style = line.style;
        let drawn = match style {
            Style::Solid => chart.draw_series(LineSeries::new(points, stroke))?,
            Style::Dashed => chart.draw_series(DashedLineSeries::new(points, 6, 4, stroke))?,
            Style::Dotted => chart.draw_series(DashedLineSeries::new(points, 2, 4, stroke))?,
            Style::Points(Marks::Dot) => {
                chart.draw_series(points.iter().map(|at| Circle::new(*at, 2, colour.filled())))?
            }
            Style::Points(Marks::Cross) => {
                chart.draw_series(points.iter().map(|at| Cross::new(*at, 3, stroke)))?
            }
        };
        if let Some(text) = label.take() {
            name(drawn, text, style, colour);
        }
    }
    Ok(())
}

/// Enters a line in the legend, with a sample of how it is drawn.
fn name<'a>(drawn: &mut SeriesAnno<'a, SVGBackend<'a>>, text: &str, style: Style, colour: RGBColor) {
    let drawn = drawn.label(text);
    let ends = |(x, y): (i32, i32)| vec![(x, y), (x + 18, y)];
    match style {
        Style::Solid => drawn.legend(move |at| PathElement::new(ends(at), colour)),
        Style::Dashed => drawn.legend(move |at| DashedPathElement::new(ends(at), 6, 3, colour)),
        Style::Dotted => drawn.legend(move |at| DashedPathElement::new(ends(at), 2, 3, colour)),
        Style::Points(Marks::Dot) => drawn.legend(move |(x, y)| Circle::new((x + 9, y), 2, colour.filled())),
        Style::Points(Marks::Cross) => drawn.legend(move |(x, y)| Cross::new((x + 9, y), 3, colour)),
    };
}

#[cfg(test)]
mod tests {
    use super::{Axis, Graph, Line, tick};

    #[test]
    fn law_a_line_ends_up_in_the_drawing() {
        let graph = Graph::new("z < 1", Axis::fitted("time in s"), Axis::over("z", -1.0, 1.0))
            .with(Line::solid(
                "desired",
                vec![(0.0, 0.0), (1.0, 0.5), (2.0, f64::NAN), (3.0, 0.1), (4.0, 0.2)],
            ))
            .with(Line::dashed("", vec![(0.0, 0.1), (4.0, 0.4)]));
        let svg = graph.to_svg().expect("the graph has finite points");
        assert!(svg.starts_with("<svg") && svg.contains("desired") && svg.contains("time in s"));
        assert!(svg.contains("z &lt; 1"), "the title is escaped");
        assert_eq!(svg, graph.to_svg().expect("drawn once already"), "same data, same bytes");
    }

    #[test]
    fn law_nothing_to_draw_is_an_error() {
        let graph = Graph::new("empty", Axis::default(), Axis::default())
            .with(Line::solid("", vec![(f64::NAN, f64::INFINITY)]));
        assert!(graph.to_svg().is_err());
    }

    #[test]
    fn value_ticks_have_as_many_digits_as_the_range_asks_for() {
        assert_eq!(tick(0.25, (0.0, 1.0)), "0.25");
        assert_eq!(tick(-0.0001, (0.0, 1.0)), "0");
        assert_eq!(tick(30.0, (0.0, 30.0)), "30");
        assert_eq!(tick(2.5e-4, (0.0, 5e-4)), "2.5e-4");
    }
}
