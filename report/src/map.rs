//! A value over a plane as colours, with curves drawn over it.

use crate::Error;
use crate::graph::{Area, Axis, FONT, Refusal, Style, tick};
use crate::legend::{self, Entry};
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

/// A value over a plane. Cells are rectangles around their centres.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatMap {
    /// Title above the graph.
    pub title: String,
    /// Horizontal axis; needs a range.
    pub x: Axis,
    /// Vertical axis; needs a range.
    pub y: Axis,
    /// Where ticks stand along x and y; empty: where round numbers are.
    pub ticks: [Vec<f64>; 2],
    /// Everything along x is given as its decimal logarithm; the ticks show the value itself.
    pub log_x: bool,
    /// Edges of the cells along x, one more than columns.
    pub x_edges: Vec<f64>,
    /// Edges of the cells along y, one more than rows.
    pub y_edges: Vec<f64>,
    /// Values from 0 (white) to 1 (full colour), row by row; `NaN` stays white.
    pub values: Vec<f64>,
    /// Curves over the cells.
    pub contours: Vec<Contour>,
    /// What the colours stand for.
    pub bar: Option<Bar>,
}

/// A colour bar: what the colours of a map stand for.
#[derive(Debug, Clone, PartialEq)]
pub struct Bar {
    /// What is shown, with its unit.
    pub label: String,
    /// Share of the full colour, and the value that it stands for: of the least value and of the greatest one.
    pub ends: [(f64, f64); 2],
}

/// A curve over the cells.
#[derive(Debug, Clone, PartialEq)]
pub struct Contour {
    /// Its entry in the legend.
    pub label: String,
    /// Points in drawing order.
    pub points: Vec<(f64, f64)>,
}

impl HeatMap {
    /// Draws the map as SVG.
    pub fn to_svg(&self) -> Result<String, Error> {
        let (Some(x), Some(y)) = (self.x.range, self.y.range) else {
            return Err(Error::Empty { title: self.title.clone() });
        };
        let (x, y) = (crate::extent::checked(x, &self.title)?, crate::extent::checked(y, &self.title)?);
        let mut svg = String::new();
        {
            let root = SVGBackend::with_string(&mut svg, crate::graph::SIZE).into_drawing_area();
            self.draw(&root, x, y)
                .map_err(|why| Error::Draw { title: self.title.clone(), why: why.to_string() })?;
        }
        Ok(crate::compact::compact(&svg))
    }

    fn draw(&self, root: &Area<'_>, x: (f64, f64), y: (f64, f64)) -> Result<(), Refusal> {
        root.fill(&WHITE)?;
        let entries: Vec<Entry<'_>> = (self.contours.iter().enumerate())
            .map(|(index, contour)| Entry {
                text: &contour.label,
                style: Style::Solid,
                colour: crate::graph::colour(index),
            })
            .collect();
        let titled = root.titled(&self.title, (FONT, 16))?;
        let (top, plot) = titled.split_vertically(legend::height(&entries));
        legend::draw(&top, &entries)?;
        let wide = plot.dim_in_pixel().0 as i32;
        let (plot, beside) = plot.split_horizontally(if self.bar.is_some() { wide - BAR } else { wide });
        let mut chart = ChartBuilder::on(&plot)
            .margin(8)
            .x_label_area_size(38)
            .y_label_area_size(64)
            .build_cartesian_2d(
                Ticked { axis: (x.0..x.1).into(), ticks: thinned(&self.ticks[0]) },
                Ticked { axis: (y.0..y.1).into(), ticks: thinned(&self.ticks[1]) },
            )?;
        chart.draw_series(self.cells())?;
        chart
            .configure_mesh()
            .disable_mesh()
            .x_desc(&self.x.label)
            .y_desc(&self.y.label)
            .label_style((FONT, 13))
            .x_label_formatter(&|value| match self.log_x {
                true => rounded(10f64.powf(*value)),
                false if self.ticks[0].is_empty() => tick(*value, x),
                false => crate::head::short(*value),
            })
            .y_label_formatter(&|value| match self.ticks[1].is_empty() {
                true => tick(*value, y),
                false => crate::head::short(*value),
            })
            .draw()?;
        for (index, contour) in self.contours.iter().enumerate() {
            let colour = crate::graph::colour(index);
            chart.draw_series(LineSeries::new(contour.points.iter().copied(), colour.stroke_width(2)))?;
        }
        if let Some(bar) = &self.bar {
            bar.draw(&beside)?;
        }
        root.present()
    }

    fn cells(&self) -> impl Iterator<Item = Rectangle<(f64, f64)>> + '_ {
        let columns = self.x_edges.len().saturating_sub(1);
        self.values.iter().enumerate().filter(|(_, value)| value.is_finite()).filter_map(
            move |(index, value)| {
                let (row, column) = (index.checked_div(columns)?, index.checked_rem(columns)?);
                let corner = (*self.x_edges.get(column)?, *self.y_edges.get(row)?);
                let opposite = (*self.x_edges.get(column + 1)?, *self.y_edges.get(row + 1)?);
                Some(Rectangle::new([corner, opposite], shade(*value).filled()))
            },
        )
    }
}

/// Room of a colour bar, its own width, and how many steps it has, in pixels.
const BAR: i32 = 96;
const BAR_WIDTH: i32 = 16;
const STEPS: i32 = 40;

impl Bar {
    /// Draws the bar from above down, the greatest value at the top, with three values beside it.
    fn draw(&self, area: &Area<'_>) -> Result<(), Refusal> {
        let [(pale, low), (full, high)] = self.ends;
        // as high as the frame of the map beside it
        let (top, bottom) = (22, area.dim_in_pixel().1 as i32 - 8 - 38);
        let at = |step: i32| bottom - (bottom - top) * step / STEPS;
        for step in 0..STEPS {
            let share = pale + (full - pale) * f64::from(step) / f64::from(STEPS - 1);
            let corners = [(0, at(step + 1)), (BAR_WIDTH, at(step))];
            area.draw(&Rectangle::new(corners, shade(share).filled()))?;
        }
        for share in [0.0, 0.5, 1.0] {
            let place = bottom - (f64::from(bottom - top) * share) as i32;
            let text = crate::head::short(low + (high - low) * share);
            area.draw(&Text::new(text, (BAR_WIDTH + 6, place - 7), (FONT, 13)))?;
        }
        area.draw(&Text::new(self.label.clone(), (0, 0), (FONT, 13)))
    }
}

/// Ticks of an axis, at most: more labels would lie over each other.
const TICKS: usize = 9;

/// Evenly thinned where they are many.
fn thinned(ticks: &[f64]) -> Vec<f64> {
    ticks.iter().copied().step_by(ticks.len().div_ceil(TICKS).max(1)).collect()
}

/// An axis with ticks of its own; without any they stand at round numbers.
struct Ticked {
    axis: RangedCoordf64,
    ticks: Vec<f64>,
}

impl Ranged for Ticked {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        self.axis.map(value, limit)
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if self.ticks.is_empty() { self.axis.key_points(hint) } else { self.ticks.clone() }
    }

    fn range(&self) -> std::ops::Range<f64> {
        self.axis.range()
    }
}

/// A number with two digits.
pub(crate) fn rounded(value: f64) -> String {
    let unit = 10f64.powf(value.abs().log10().floor() - 1.0);
    let decimals = (-unit.log10()).max(0.0) as usize;
    format!("{:.decimals$}", (value / unit).round() * unit)
}

/// White to the blue of the palette.
fn shade(value: f64) -> RGBColor {
    let share = value.clamp(0.0, 1.0);
    let mix = |full: f64| (255.0 + (full - 255.0) * 0.75 * share).round() as u8;
    RGBColor(mix(0.0), mix(114.0), mix(178.0))
}

#[cfg(test)]
mod tests {
    use super::{Bar, Contour, HeatMap, STEPS, shade};
    use crate::Axis;

    /// Numbers of an attribute of all elements of a kind.
    fn all(svg: &str, element: &str, attribute: &str) -> Vec<f64> {
        let beginning = format!("<{element} ");
        let value =
            |tag: &str| tag.split(&format!(" {attribute}=\"")).nth(1)?.split('"').next()?.parse().ok();
        svg.split(&beginning).skip(1).filter_map(|rest| value(&format!(" {rest}"))).collect()
    }

    #[test]
    fn law_the_legend_lies_above_the_cells() {
        let map = HeatMap {
            title: "map".into(),
            x: Axis::over("x", 0.0, 2.0),
            y: Axis::over("y", 0.0, 2.0),
            log_x: false,
            ticks: Default::default(),
            x_edges: vec![0.0, 1.0, 2.0],
            y_edges: vec![0.0, 1.0, 2.0],
            values: vec![0.0, 0.3, 0.6, 1.0],
            contours: vec![Contour { label: "boundary".into(), points: vec![(0.0, 2.0), (2.0, 0.0)] }],
            bar: None,
        };
        let svg = map.to_svg().expect("it can be drawn");
        let words = svg.split("boundary").next().expect("text").rsplit("<text ").next().expect("its tag");
        let legend = all(&format!("<text {words}"), "text", "y")[0];
        // The first rectangle is the paper.
        let cells = all(&svg, "rect", "y").into_iter().skip(1).fold(f64::INFINITY, f64::min);
        assert!(legend < cells, "legend at {legend}, cells from {cells} on\n{svg}");
        assert_eq!(svg.matches("<rect").count(), 5, "paper and four cells, no box of a legend");
    }

    #[test]
    fn law_a_bar_goes_from_the_colour_of_the_least_value_to_that_of_the_greatest() {
        let map = HeatMap {
            title: String::new(),
            x: Axis::over("x", 0.0, 2.0),
            y: Axis::over("y", 0.0, 1.0),
            log_x: false,
            ticks: Default::default(),
            x_edges: vec![0.0, 1.0, 2.0],
            y_edges: vec![0.0, 1.0],
            values: vec![0.12, 1.0],
            contours: Vec::new(),
            bar: Some(Bar { label: "fell in s".into(), ends: [(0.12, 0.5), (1.0, 4.5)] }),
        };
        let svg = map.to_svg().expect("it can be drawn");
        // paper and cells come first: the cells of a page are counted so
        let rects: Vec<&str> = svg.split("<rect ").skip(1).collect();
        assert_eq!(rects.len(), 1 + 2 + STEPS as usize);
        let colour = |share: f64| {
            let plotters::style::RGBColor(r, g, b) = shade(share);
            format!("#{r:02X}{g:02X}{b:02X}").to_lowercase()
        };
        let drawn = |place: usize, share: f64| rects[place].to_lowercase().contains(&colour(share));
        assert!(drawn(1, 0.12) && drawn(2, 1.0), "{}", rects[1]);
        assert!(drawn(3, 0.12) && drawn(2 + STEPS as usize, 1.0), "{}", rects[3]);
        for words in ["fell in s", "0.5", "2.5", "4.5"] {
            assert!(svg.contains(words), "{words} is beside the bar");
        }
    }
}
