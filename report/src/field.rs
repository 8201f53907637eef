//! A field of vectors over a plane, as the paper's Figures 4 to 8 draw them: a line from each point, a dot at its head.

use crate::Error;
use crate::graph::{Area, Axis, FONT, Refusal, tick};
use plotters::prelude::*;

/// A field of vectors.
#[derive(Debug, Clone, PartialEq)]
pub struct VectorField {
    /// Title above the graph.
    pub title: String,
    /// Horizontal axis; needs a range.
    pub x: Axis,
    /// Vertical axis; needs a range.
    pub y: Axis,
    /// Pairs of (where it starts, where its head lies).
    pub arrows: Vec<((f64, f64), (f64, f64))>,
}

/// Side of the square picture, in CSS pixels.
const SIDE: u32 = 420;

impl VectorField {
    /// Draws the field as SVG.
    pub fn to_svg(&self) -> Result<String, Error> {
        let (Some(x), Some(y)) = (self.x.range, self.y.range) else {
            return Err(Error::Empty { title: self.title.clone() });
        };
        let mut svg = String::new();
        {
            let root = SVGBackend::with_string(&mut svg, (SIDE, SIDE)).into_drawing_area();
            self.draw(&root, x, y)
                .map_err(|why| Error::Draw { title: self.title.clone(), why: why.to_string() })?;
        }
        Ok(crate::compact::compact(&svg))
    }

    fn draw(&self, root: &Area<'_>, x: (f64, f64), y: (f64, f64)) -> Result<(), Refusal> {
        root.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(root)
            .caption(&self.title, (FONT, 16))
            .margin(8)
            .x_label_area_size(38)
            .y_label_area_size(52)
            .build_cartesian_2d(x.0..x.1, y.0..y.1)?;
        chart
            .configure_mesh()
            .disable_mesh()
            .x_desc(&self.x.label)
            .y_desc(&self.y.label)
            .label_style((FONT, 13))
            .x_label_formatter(&|value| tick(*value, x))
            .y_label_formatter(&|value| tick(*value, y))
            .draw()?;
        chart.draw_series(
            self.arrows.iter().map(|(tail, head)| PathElement::new(vec![*tail, *head], BLACK)),
        )?;
        chart.draw_series(self.arrows.iter().map(|(_, head)| Circle::new(*head, 1, BLACK.filled())))?;
        root.present()
    }
}
