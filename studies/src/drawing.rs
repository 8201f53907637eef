//! A line drawing to scale as SVG, for what is no graph: lines, circles, words.

use maud::{PreEscaped, html};

/// A plane that is drawn on, y up, both axes to the same scale.
pub(crate) struct Drawing {
    x: [f64; 2],
    y: [f64; 2],
    shapes: Vec<PreEscaped<String>>,
}

/// Width of the picture, CSS pixels.
const WIDTH: f64 = 560.0;

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Pen {
    Solid,
    Thin,
    Dashed,
}

impl Drawing {
    /// A plane over these ranges.
    pub(crate) fn new(x: [f64; 2], y: [f64; 2]) -> Self {
        Self { x, y, shapes: Vec::new() }
    }

    fn scale(&self) -> f64 {
        WIDTH / (self.x[1] - self.x[0])
    }

    fn px(&self, [x, y]: [f64; 2]) -> [String; 2] {
        [self.scale() * (x - self.x[0]), self.scale() * (self.y[1] - y)].map(|px| format!("{px:.2}"))
    }

    /// A line through points.
    pub(crate) fn line(&mut self, points: &[[f64; 2]], pen: Pen) {
        let points: Vec<String> = points.iter().map(|point| self.px(*point).join(",")).collect();
        let (width, dashes) = match pen {
            Pen::Solid => ("2", "none"),
            Pen::Thin => ("1", "none"),
            Pen::Dashed => ("1", "5 4"),
        };
        self.shapes.push(html! {
            polyline points=(points.join(" ")) fill="none" stroke="#1a1a1a" stroke-width=(width) stroke-dasharray=(dashes) {}
        });
    }

    /// A circle, filled or not.
    pub(crate) fn circle(&mut self, centre: [f64; 2], radius: f64, filled: bool) {
        let [x, y] = self.px(centre);
        let radius = format!("{:.2}", self.scale() * radius);
        let fill = if filled { "#0072b2" } else { "none" };
        self.shapes.push(html! { circle cx=(x) cy=(y) r=(radius) fill=(fill) stroke="#1a1a1a" {} });
    }

    /// A mark where something was measured.
    pub(crate) fn cross(&mut self, [x, y]: [f64; 2], size: f64) {
        self.line(&[[x - size, y - size], [x + size, y + size]], Pen::Solid);
        self.line(&[[x - size, y + size], [x + size, y - size]], Pen::Solid);
    }

    /// Words that begin at a point.
    pub(crate) fn words(&mut self, at: [f64; 2], text: &str) {
        let [x, y] = self.px(at);
        self.shapes.push(html! { text x=(x) y=(y) { (text) } });
    }

    /// The drawing.
    pub(crate) fn to_svg(&self) -> String {
        let height = self.scale() * (self.y[1] - self.y[0]);
        html! {
            svg xmlns="http://www.w3.org/2000/svg" viewBox=(format!("0 0 {WIDTH} {height:.2}"))
                width=(WIDTH) height=(format!("{height:.2}")) font-family="sans-serif" font-size="15" {
                @for shape in &self.shapes { (shape) }
            }
        }
        .into_string()
    }
}
