//! A graph of lines over an axis, as the paper draws them: solid, dashed, dotted, or marks.

use crate::Error;
use crate::clip::clip;
use crate::extent;
use crate::legend;
use crate::map::rounded;
pub use crate::style::{Marks, Stroke, Style};
use crate::thin::{apart, steps, thin};
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Size of a graph on the page, in CSS pixels.
pub(crate) const SIZE: (u32, u32) = (640, 380);
/// Font of all labels. SVG only names it; the browser has it.
pub(crate) const FONT: &str = "sans-serif";

/// One line of a graph.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Line {
    /// Its entry in the legend; empty: none.
    pub label: String,
    /// How it is drawn.
    pub style: Style,
    /// Points ordered by x. Points that are not finite, or too large to be drawn ([`extent::is_drawn`]), interrupt the line.
    #[serde(with = "holes")]
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

/// Points as JSON, which has no word for what is no number: it stands as null.
mod holes {
    use serde::{Deserialize as _, Deserializer, Serializer};

    pub(super) fn serialize<S: Serializer>(points: &[(f64, f64)], to: S) -> Result<S::Ok, S::Error> {
        let finite = |value: f64| value.is_finite().then_some(value);
        to.collect_seq(points.iter().map(|(x, y)| (finite(*x), finite(*y))))
    }

    pub(super) fn deserialize<'a, D: Deserializer<'a>>(from: D) -> Result<Vec<(f64, f64)>, D::Error> {
        let points = Vec::<(Option<f64>, Option<f64>)>::deserialize(from)?;
        Ok(points.into_iter().map(|(x, y)| (x.unwrap_or(f64::NAN), y.unwrap_or(f64::NAN))).collect())
    }
}

/// An axis: what it shows, and over which range; without a range it fits the data.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// Label with unit.
    pub label: String,
    /// Fixed range.
    pub range: Option<(f64, f64)>,
    /// Even in the logarithm; of horizontal axes only, and all of its values are above 0.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub log: bool,
}

impl Axis {
    /// An axis that fits the data.
    pub fn fitted(label: impl Into<String>) -> Self {
        Self { label: label.into(), range: None, log: false }
    }

    /// An axis over a range of its own.
    pub fn over(label: impl Into<String>, from: f64, to: f64) -> Self {
        Self { label: label.into(), range: Some((from, to)), log: false }
    }
}

/// A graph.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Graph {
    /// Title above the graph; empty: none.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Lines, drawn in this order.
    pub lines: Vec<Line>,
    /// An upright line at this x, and what happened there.
    pub event: Option<(f64, String)>,
}

impl Graph {
    /// An empty graph with its axes.
    pub fn new(title: impl Into<String>, x: Axis, y: Axis) -> Self {
        Self { title: title.into(), x, y, lines: Vec::new(), event: None }
    }

    /// Adds a line.
    #[must_use]
    pub fn with(mut self, line: Line) -> Self {
        self.lines.push(line);
        self
    }

    /// Draws the graph as SVG.
    pub fn to_svg(&self) -> Result<String, Error> {
        self.over_even_axes().draw_svg()
    }

    /// What is over a logarithmic axis, over the logarithms; its ticks tell the values.
    fn over_even_axes(&self) -> Cow<'_, Self> {
        if !self.x.log {
            return Cow::Borrowed(self);
        }
        let mut even = self.clone();
        even.lines.iter_mut().flat_map(|line| &mut line.points).for_each(|(x, _)| *x = x.log10());
        even.x.range = even.x.range.map(|(from, to)| (from.log10(), to.log10()));
        even.event = even.event.map(|(at, what)| (at.log10(), what));
        Cow::Owned(even)
    }

    fn draw_svg(&self) -> Result<String, Error> {
        let x_range = self.range(&self.x, |point| point.0, |extent| extent)?;
        let y_range = self.range(&self.y, |point| point.1, extent::with_margin)?;
        let mut svg = String::new();
        {
            let root = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
            self.draw(&root, x_range, y_range).map_err(|why| self.refused(&why))?;
            root.present().map_err(|why| self.refused(&why))?;
        }
        Ok(crate::compact::compact(&svg))
    }

    fn refused(&self, why: &dyn std::fmt::Display) -> Error {
        Error::Draw { title: self.title.clone(), why: why.to_string() }
    }

    fn draw(&self, root: &Area<'_>, x: (f64, f64), y: (f64, f64)) -> Result<(), Refusal> {
        root.fill(&WHITE)?;
        let named = self.lines.iter().enumerate().filter(|(_, line)| !line.label.is_empty());
        let event = self.event.iter().map(|(_, what)| legend::Entry {
            text: what,
            style: Style::Dotted,
            colour: EVENT,
        });
        let entries: Vec<legend::Entry<'_>> = named
            .map(|(index, line)| legend::Entry {
                text: &line.label,
                style: line.style,
                colour: colour(index),
            })
            .chain(event)
            .collect();
        let titled = if self.title.is_empty() { root.clone() } else { root.titled(&self.title, (FONT, 16))? };
        let (top, plot) = titled.split_vertically(legend::height(&entries));
        legend::draw(&top, &entries)?;
        let mut chart = ChartBuilder::on(&plot)
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
            .x_label_formatter(&|value| {
                if self.x.log { rounded(10f64.powf(*value)) } else { tick(*value, x) }
            })
            .y_label_formatter(&|value| tick(*value, y))
            .draw()?;
        if let Some((at, _)) = self.event.iter().find(|(at, _)| (x.0..=x.1).contains(at)) {
            let upright = vec![(*at, y.0), (*at, y.1)];
            chart.draw_series(DashedLineSeries::new(upright, 2, 4, EVENT.stroke_width(1)))?;
        }
        for (index, line) in self.lines.iter().enumerate() {
            draw_line(&mut chart, line, colour(index), (x, y))?;
        }
        Ok(())
    }

    /// The range of an axis: its own, or that of the data, `widened`.
    fn range(
        &self,
        axis: &Axis,
        of: impl Fn(&(f64, f64)) -> f64,
        widened: impl Fn((f64, f64)) -> (f64, f64),
    ) -> Result<(f64, f64), Error> {
        if let Some(range) = axis.range {
            return extent::checked(range, &self.title);
        }
        let extent = extent::of(self.lines.iter().flat_map(|line| &line.points).map(of));
        let (low, high) = extent.ok_or_else(|| Error::Empty { title: self.title.clone() })?;
        Ok(if low < high { widened((low, high)) } else { extent::with_margin((low, high)) })
    }
}

/// Colour of the upright line at an event.
const EVENT: RGBColor = RGBColor(166, 54, 3);

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

type Span = (f64, f64);

fn draw_line(
    chart: &mut Chart<'_>,
    line: &Line,
    colour: RGBColor,
    (x, y): (Span, Span),
) -> Result<(), Refusal> {
    let style = line.style.connected();
    let stroke = colour.stroke_width(if matches!(style, Style::Dotted) { 2 } else { 1 });
    let pieces = line
        .points
        .split(|(x, y)| !extent::is_drawn(*x) || !extent::is_drawn(*y))
        .filter(|piece| !piece.is_empty());
    for piece in pieces {
        let points = match line.style {
            // A line's peaks stand for the rest of it; of points each is one.
            Style::Points(_) => apart(piece, (x, y), SIZE),
            Style::Held(_) => steps(&thin(piece, SIZE.0 as usize)),
            _ => thin(piece, SIZE.0 as usize),
        };
        match style {
            Style::Points(marks) => {
                let inside = points.iter().filter(|(_, value)| (y.0..=y.1).contains(value));
                match marks {
                    Marks::Dot => chart.draw_series(inside.map(|at| Circle::new(*at, 2, colour.filled())))?,
                    Marks::Cross => chart.draw_series(inside.map(|at| Cross::new(*at, 3, stroke)))?,
                };
            }
            style => {
                for part in clip(&points, y) {
                    match style {
                        Style::Dashed => chart.draw_series(DashedLineSeries::new(part, 6, 4, stroke))?,
                        Style::Dotted => chart.draw_series(DashedLineSeries::new(part, 2, 4, stroke))?,
                        _ => chart.draw_series(LineSeries::new(part, stroke))?,
                    };
                }
            }
        }
    }
    Ok(())
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
    fn bad_values_whose_range_has_no_width_are_drawn_as_holes() {
        // a coupling that diverges ends so: the drawing library looked for ticks without end
        let points = vec![(0.0, 0.0), (1.0, -1e308), (2.0, 1e308), (3.0, 1.0)];
        let graph = Graph::new("t", Axis::fitted("x"), Axis::fitted("y")).with(Line::solid("a", points));
        assert!(graph.to_svg().expect("drawn").contains("svg"));
        let graph =
            Graph::new("t", Axis::fitted("x"), Axis::over("y", -1e308, 1e308)).with(graph.lines[0].clone());
        let told = graph.to_svg().expect_err("no width").to_string();
        assert!(told.contains("from -1e308 to 1e308"), "{told}");
    }

    #[test]
    fn law_a_graph_comes_back_from_json_with_its_holes() {
        let points = vec![(0.0, 0.1), (1.0, f64::NAN), (2.0, 0.3)];
        let graph =
            Graph::new("t", Axis::fitted("x"), Axis::over("y", -1.0, 1.0)).with(Line::solid("a", points));
        let text = serde_json::to_string(&graph).expect("written");
        let back: Graph = serde_json::from_str(&text).expect("read");
        assert_eq!((back.to_svg().expect("drawn"), back.y), (graph.to_svg().expect("drawn"), graph.y));
        assert!(back.lines[0].points[1].1.is_nan() && back.lines[0].points[2] == (2.0, 0.3));
    }

    #[test]
    fn value_a_logarithmic_axis_has_decades_of_one_length() {
        let points = (0..=30).map(|i| (10f64.powf(f64::from(i) / 10.0 - 2.0), f64::from(i % 2))).collect();
        let mut graph = Graph::new("t", Axis::fitted("x"), Axis::fitted("y")).with(Line::solid("", points));
        graph.x.log = true;
        let svg = graph.to_svg().expect("drawn");
        let line = svg.split("points=\"").filter_map(|rest| rest.split('"').next());
        let xs = |points: &str| -> Vec<f64> {
            points.split_whitespace().filter_map(|pair| pair.split(',').next()?.parse().ok()).collect()
        };
        let xs = line.map(xs).find(|xs| xs.len() == 31).expect("the line");
        assert!(((xs[10] - xs[0]) - (xs[20] - xs[10])).abs() <= 1.0, "{xs:?}");
        assert!(svg.contains("0.1"), "ticks tell the values themselves");
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
        assert_eq!(tick(1000.5, (1000.0, 1001.0)), "1000.50");
        assert_eq!(tick(-3.5, (-4.0, -3.0)), "-3.50");
    }

    #[test]
    fn law_the_legend_lies_above_the_data() {
        // Lines that fill the whole frame: wherever a legend lay inside it, it would lie over them.
        let full =
            |phase: f64| (0..200).map(|i| (f64::from(i), (f64::from(i) * 0.7 + phase).sin())).collect();
        let graph = Graph::new("t", Axis::fitted("x"), Axis::fitted("y"))
            .with(Line::solid("first of the lines", full(0.0)))
            .with(Line::dashed("second of the lines", full(1.0)));
        let svg = graph.to_svg().expect("drawn");
        let y_of = |tag: &str| -> f64 {
            let at = svg.find(tag).unwrap_or_else(|| panic!("{tag} is drawn"));
            let open = svg[..at].rfind("<text").expect("in a text");
            let y = svg[open..at].split(" y=\"").nth(1).expect("placed");
            y.split('"').next().and_then(|y| y.parse().ok()).expect("a number")
        };
        let highest = svg
            .split("<polyline")
            .skip(1)
            .filter_map(|line| line.split("points=\"").nth(1)?.split('"').next())
            .filter(|points| points.split_whitespace().count() > 100)
            .flat_map(|points| {
                points.split_whitespace().filter_map(|pair| pair.split(',').nth(1)?.parse::<f64>().ok())
            })
            .fold(f64::INFINITY, f64::min);
        assert!(highest.is_finite(), "the solid line is drawn as one");
        for label in ["first of the lines", "second of the lines"] {
            assert!(y_of(label) + 10.0 < highest, "{label} at {}, data from {highest}", y_of(label));
        }
    }
}
