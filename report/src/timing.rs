//! A timing diagram: a lane for each unit with its points, and arrows for values that go from one to another.

use crate::graph::FONT;
use maud::html;

/// What is drawn.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TimingDiagram {
    /// Begin and end in s.
    pub span: (f64, f64),
    /// Label and points, lane by lane.
    pub lanes: Vec<(String, Vec<f64>)>,
    /// From a lane at a time to another one at a later time.
    pub arrows: Vec<((usize, f64), (usize, f64))>,
}

const WIDTH: f64 = 640.0;
/// Room for labels, at most and for each letter, for a lane, above the first and below the last one.
const LABELS: f64 = 190.0;
const LETTER: f64 = 7.0;
const LANE: f64 = 46.0;
const ABOVE: f64 = 20.0;
const BELOW: f64 = 40.0;
/// One colour for each lane that values come from; then they repeat.
const COLOURS: [&str; 6] = ["#1f5fa8", "#b3541e", "#2e7d4f", "#7a3e8e", "#9c2f3c", "#55606b"];

/// Lanes beyond which a timing diagram shows nothing any more.
const LANES: usize = 24;

/// An interval as a person says it.
pub fn interval(seconds: f64) -> String {
    match seconds {
        s if s >= 1.0 => format!("{s} s"),
        s if s >= 1e-3 => format!("{:.4} ms", s * 1e3).replace(".0000", ""),
        s => format!("{:.4} µs", s * 1e6).replace(".0000", ""),
    }
}

impl TimingDiagram {
    /// Of units with their intervals in s and their points, which are none where there are too many; nothing where there are too many units.
    pub fn of(
        span: (f64, f64),
        lanes: Vec<(String, f64, Vec<f64>)>,
        arrows: impl Iterator<Item = ((usize, f64), (usize, f64))>,
    ) -> Option<Self> {
        if !(1..=LANES).contains(&lanes.len()) {
            return None;
        }
        let label = |unit: String, each: f64, points: &[f64]| match points.is_empty() {
            true => format!("{unit}, each {}", interval(each)),
            false => unit,
        };
        let lanes = lanes.into_iter().map(|(unit, each, points)| (label(unit, each, &points), points));
        Some(Self { span, lanes: lanes.collect(), arrows: arrows.collect() })
    }

    /// As SVG, for a page.
    pub fn to_svg(&self) -> String {
        let lanes = self.lanes.len() as f64;
        let (bottom, height) = (ABOVE + LANE * (lanes - 0.5), ABOVE + LANE * lanes + BELOW - LANE / 2.0);
        let (begin, end) = self.span;
        let letters = self.lanes.iter().map(|(label, _)| label.chars().count()).max().unwrap_or(0);
        let left = (16.0 + LETTER * letters as f64).clamp(40.0, LABELS);
        let across = if end > begin { (WIDTH - left - 24.0) / (end - begin) } else { 0.0 };
        let x = |time: f64| format!("{:.2}", left + (time - begin) * across);
        let y = |lane: usize| ABOVE + LANE * lane as f64;
        let colour = |lane: usize| COLOURS[lane % COLOURS.len()];
        let ticks = || crate::timing::ticks(begin, end);
        html! {
            svg xmlns="http://www.w3.org/2000/svg" viewBox=(format!("0 0 {WIDTH} {height}")) width=(WIDTH) height=(height)
                font-family=(FONT) font-size="12" role="img" aria-label="timing diagram" {
                defs {
                    @for lane in 0..COLOURS.len() {
                        marker id=(format!("timing-{lane}")) viewBox="0 0 8 8" refX="8" refY="4" markerWidth="7" markerHeight="7"
                            orient="auto" { path d="M0 1L8 4L0 7z" fill=(colour(lane)) {} }
                    }
                }
                @for (time, label) in ticks() {
                    line x1=(x(time)) x2=(x(time)) y1=(ABOVE / 2.0) y2=(bottom) stroke="#e4e4e4" {}
                    text x=(x(time)) y=(bottom + 14.0) text-anchor="middle" { (label) }
                }
                text x=(left) y=(bottom + 32.0) { "time in s" }
                @for (lane, (label, points)) in self.lanes.iter().enumerate() {
                    text x=(left - 10.0) y=(y(lane) + 4.0) text-anchor="end" { (label) }
                    line x1=(x(begin)) x2=(x(end)) y1=(y(lane)) y2=(y(lane)) stroke="#888" {}
                    @for &point in points {
                        line x1=(x(point)) x2=(x(point)) y1=(y(lane) - 5.0) y2=(y(lane) + 5.0) stroke="#222" {}
                    }
                }
                @for &((from, sent), (to, taken)) in &self.arrows {
                    line x1=(x(sent)) y1=(y(from)) x2=(x(taken)) y2=(y(to)) stroke=(colour(from)) stroke-opacity="0.75"
                        marker-end=(format!("url(#timing-{})", from % COLOURS.len())) {}
                }
            }
        }
        .into_string()
    }
}

/// Round times, four to ten of them, with their labels.
fn ticks(begin: f64, end: f64) -> Vec<(f64, String)> {
    let span = end - begin;
    if !(span > 0.0 && span.is_finite()) {
        return vec![(begin, begin.to_string())];
    }
    let decade = 10f64.powf((span / 5.0).log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|n| n * decade).into_iter().find(|step| span / step <= 7.0);
    let step = step.unwrap_or(span);
    let places = (-step.log10().floor()).clamp(0.0, 17.0) as usize;
    let first = (begin / step).ceil() as i64;
    let count = ((end - first as f64 * step) / step + 1e-9).floor() as i64;
    (first..=first + count).map(|n| n as f64 * step).map(|time| (time, format!("{time:.places$}"))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_lanes_points_and_arrows_are_drawn_and_names_escaped() {
        let diagram = TimingDiagram {
            span: (0.0, 0.1),
            lanes: vec![("a <b>".into(), vec![0.0, 0.05, 0.1]), ("c".into(), vec![0.0, 0.1])],
            arrows: vec![((0, 0.05), (1, 0.1))],
        };
        let svg = diagram.to_svg();
        assert!(svg.contains("a &lt;b&gt;") && svg.contains("marker-end=\"url(#timing-0)\""));
        assert_eq!(svg.matches("stroke=\"#222\"").count(), 5, "a mark for each point");
        // Half of the time is half of the way (from 51, five letters, to 616), from the upper lane to the end of the lower one.
        assert!(svg.contains("x1=\"333.50\" y1=\"20\" x2=\"616.00\" y2=\"66\""), "{svg}");
    }

    #[test]
    fn value_ticks_are_round() {
        let labels = |begin, end| ticks(begin, end).into_iter().map(|(_, label)| label).collect::<Vec<_>>();
        assert_eq!(labels(0.0, 0.1), ["0.00", "0.02", "0.04", "0.06", "0.08", "0.10"]);
        assert_eq!(labels(1.0, 1.0), ["1"]);
        assert_eq!(labels(0.5, 12.0), ["2", "4", "6", "8", "10", "12"]);
    }
}
