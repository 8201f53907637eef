//! A field of vectors over a plane: an arrow from each point. [`VectorField::normalized`] makes them as long as they can be
//! without running into each other.

use crate::Error;
use crate::graph::{Axis, FONT, tick};
use maud::html;

/// A place in the plane, or the way from one to another.
type Point = (f64, f64);

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
    pub arrows: Vec<(Point, Point)>,
}

/// Side of the picture and of the room for labels left and below, in CSS pixels.
const SIDE: f64 = 520.0;
const LABELS: f64 = 56.0;
/// The longest arrow, as a share of the distance of neighbouring points: a head never touches the next arrow.
pub const LONGEST: f64 = 0.85;
/// Length of a barb as a share of its arrow's, and at most, as a share of the axis.
const BARB: (f64, f64) = (0.45, 0.016);
/// How far a barb turns away from its arrow, rad.
const TURN: f64 = 0.5;
/// Labels along an axis, the ends included.
const TICKS: u32 = 4;

impl VectorField {
    /// Arrows at these points, so far apart, in proportion to these vectors; the longest is [`LONGEST`] of the distance.
    pub fn normalized(
        title: impl Into<String>,
        (x, y): (Axis, Axis),
        spacing: f64,
        vectors: &[(Point, Point)],
    ) -> Self {
        let length = |(_, (u, v)): &(Point, Point)| f64::hypot(*u, *v);
        let longest = vectors.iter().map(length).fold(0.0, f64::max);
        let scale = if longest > 0.0 { LONGEST * spacing / longest } else { 0.0 };
        let arrow = |(tail, by): &(Point, Point)| (*tail, (tail.0 + scale * by.0, tail.1 + scale * by.1));
        Self { title: title.into(), x, y, arrows: vectors.iter().map(arrow).collect() }
    }

    /// Draws the field as SVG.
    pub fn to_svg(&self) -> Result<String, Error> {
        let (Some(x), Some(y)) = (self.x.range, self.y.range) else {
            return Err(Error::Empty { title: self.title.clone() });
        };
        let (left, top, inner) = (LABELS, 28.0, SIDE - LABELS - 16.0);
        let bottom = top + inner;
        let across = |u: f64| left + inner * (u - x.0) / (x.1 - x.0);
        let up = |v: f64| bottom - inner * (v - y.0) / (y.1 - y.0);
        let most = BARB.1 * (x.1 - x.0);
        let path: String = self.arrows.iter().map(|arrow| drawn(*arrow, most, &across, &up)).collect();
        let ticks = |(low, high): (f64, f64)| {
            (0..=TICKS).map(move |at| low + (high - low) * f64::from(at) / f64::from(TICKS))
        };
        let height = bottom + 46.0;
        Ok(html! {
            svg xmlns="http://www.w3.org/2000/svg" viewBox=(format!("0 0 {SIDE} {height}")) width=(SIDE) height=(height)
                font-family=(FONT) font-size="13" {
                rect width=(SIDE) height=(height) fill="#fff" {}
                text x=(left + 0.5 * inner) y="18" text-anchor="middle" font-size="16" { (self.title) }
                rect x=(left) y=(top) width=(inner) height=(inner) fill="none" stroke="#888" {}
                @for at in ticks(x) { text x=(across(at)) y=(bottom + 17.0) text-anchor="middle" { (tick(at, x)) } }
                @for at in ticks(y) { text x=(left - 6.0) y=(up(at) + 4.0) text-anchor="end" { (tick(at, y)) } }
                text x=(left + 0.5 * inner) y=(bottom + 36.0) text-anchor="middle" { (self.x.label) }
                text x="14" y=(top + 0.5 * inner) text-anchor="middle" { (self.y.label) }
                path d=(path) fill="none" stroke="#000" stroke-width="1.1" {}
            }
        }
        .into_string())
    }
}

/// An arrow as a part of a path.
fn drawn(arrow: (Point, Point), most: f64, across: &dyn Fn(f64) -> f64, up: &dyn Fn(f64) -> f64) -> String {
    let place = |(number, (u, v)): (usize, &(f64, f64))| {
        format!("{}{:.2} {:.2}", if number == 0 { 'M' } else { 'L' }, across(*u), up(*v))
    };
    stroke(arrow, most).iter().enumerate().map(place).collect()
}

/// Tail, head, one barb, head, the other barb.
fn stroke((tail, head): (Point, Point), most: f64) -> Vec<(f64, f64)> {
    let (u, v) = (head.0 - tail.0, head.1 - tail.1);
    let length = u.hypot(v);
    if length <= 0.0 {
        return vec![tail, head];
    }
    let share = (BARB.0 * length).min(most) / length;
    let barb = |turn: f64| {
        let (sin, cos) = turn.sin_cos();
        (head.0 - share * (cos * u - sin * v), head.1 - share * (sin * u + cos * v))
    };
    vec![tail, head, barb(TURN), head, barb(-TURN)]
}

#[cfg(test)]
mod tests {
    use super::{LONGEST, Point, VectorField, stroke};
    use crate::Axis;

    #[test]
    fn value_the_longest_arrow_is_shorter_than_the_way_to_its_neighbour() {
        let axes = (Axis::over("u", -1.0, 1.0), Axis::over("v", -1.0, 1.0));
        let vectors = [((0.0, 0.0), (3.0, 4.0)), ((0.1, 0.0), (0.0, -2.5))];
        let field = VectorField::normalized("t", axes, 0.1, &vectors);
        let length = |((u, v), (x, y)): (Point, Point)| (x - u).hypot(y - v);
        let lengths: Vec<f64> = field.arrows.iter().map(|arrow| length(*arrow)).collect();
        // 5 is the longer one, 2.5 half of it.
        assert!((lengths[0] - LONGEST * 0.1).abs() < 1e-15 && (lengths[1] - 0.5 * lengths[0]).abs() < 1e-15);
        assert!(field.to_svg().expect("drawn").matches("<path").count() == 1, "all arrows are one path");
    }

    #[test]
    fn value_barbs_lie_behind_the_head_on_both_sides() {
        let points = stroke(((0.0, 0.0), (1.0, 0.0)), 0.2);
        assert_eq!(points.len(), 5);
        let (left, right) = (points[2], points[4]);
        assert!((left.0 - right.0).abs() < 1e-15 && left.0 < 1.0 && (left.1 + right.1).abs() < 1e-15);
        assert!((f64::hypot(1.0 - left.0, left.1) - 0.2).abs() < 1e-15);
        assert_eq!(stroke(((1.0, 1.0), (1.0, 1.0)), 0.2).len(), 2, "no direction, no barb");
    }
}
