//! Bases of the frames that were made last. Who asks for the same poses under other noise, as a diagnosis does that averages it out,
//! gets them without outlines, coverage and blur.

use super::coverage::Area;
use super::plane::Plane;
use std::collections::VecDeque;

/// Frames that are kept: a second of them and more, some kilobytes each.
const MOST: usize = 64;

/// Centres of the three circles in world units, one entry a sub-frame.
type Centres = [[(f64, f64); 3]];

/// The last frames' bases, the newest at the end.
#[derive(Debug, Clone, Default)]
pub struct Recent(VecDeque<Base>);

/// What lies in the boxes of one frame.
#[derive(Debug, Clone, Default)]
struct Base {
    centres: Vec<[(f64, f64); 3]>,
    boxes: Vec<Area>,
    /// Rows of the boxes, one after the other.
    parts: Vec<i16>,
}

impl Recent {
    /// Draws the base that was kept for these centres; answers its boxes.
    pub fn draw(&self, centres: &Centres, into: &mut Plane<i16>) -> Option<Vec<Area>> {
        let known = self.0.iter().find(|base| base.centres == centres)?;
        let mut parts = known.parts.as_slice();
        for area in &known.boxes {
            for y in area.y0..area.y1 {
                let (row, rest) = parts.split_at(area.width());
                into.row_mut(y)[area.x0..area.x1].copy_from_slice(row);
                parts = rest;
            }
        }
        Some(known.boxes.clone())
    }

    /// Keeps what was made for these centres, in the place of the oldest.
    pub fn keep(&mut self, centres: &Centres, boxes: &[Area], made: &Plane<i16>) {
        let oldest = if self.0.len() < MOST { None } else { self.0.pop_front() };
        let mut base = oldest.unwrap_or_default();
        base.centres.clear();
        base.centres.extend_from_slice(centres);
        base.boxes.clear();
        base.boxes.extend_from_slice(boxes);
        base.parts.clear();
        for area in boxes {
            (area.y0..area.y1).for_each(|y| base.parts.extend_from_slice(&made.row(y)[area.x0..area.x1]));
        }
        self.0.push_back(base);
    }
}
