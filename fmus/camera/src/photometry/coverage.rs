//! Exact area coverage: signed areas of polygon edges accumulated per pixel, then summed along each row.
//!
//! For each edge and each row that it crosses, the area between the edge and the right border of a pixel is added to
//! that pixel and the rest of its height to the next; the running sum along the row is then the covered area. It is
//! linear, so the sub-frames of an exposure are accumulated together and summed once. Sums are of whole numbers, so
//! that they don't depend on the order of the edges. Short edges, nearly all there are, go by [`super::edges`].

use super::edges::{CELLS, WHOLE, whole};
use super::simd;
use crate::geometry::STRIPS;

/// A rectangle of pixels in raster coordinates; ends are exclusive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Area {
    /// First column.
    pub x0: usize,
    /// First row.
    pub y0: usize,
    /// One past the last column.
    pub x1: usize,
    /// One past the last row.
    pub y1: usize,
}

impl Area {
    /// Number of columns.
    pub fn width(&self) -> usize {
        self.x1 - self.x0
    }

    /// Number of rows.
    pub fn height(&self) -> usize {
        self.y1 - self.y0
    }

    /// This area and a margin around it, within a frame.
    pub fn grown(&self, margin: usize, width: usize, height: usize) -> Self {
        Self {
            x0: self.x0.saturating_sub(margin),
            y0: self.y0.saturating_sub(margin),
            x1: (self.x1 + margin).min(width),
            y1: (self.y1 + margin).min(height),
        }
    }

    /// Whether two areas share a pixel.
    pub fn overlaps(&self, other: &Self) -> bool {
        self.x0 < other.x1 && other.x0 < self.x1 && self.y0 < other.y1 && other.y0 < self.y1
    }

    /// The smallest area around both.
    pub fn around(&self, other: &Self) -> Self {
        Self {
            x0: self.x0.min(other.x0),
            y0: self.y0.min(other.y0),
            x1: self.x1.max(other.x1),
            y1: self.y1.max(other.y1),
        }
    }
}

/// Accumulates the coverage of polygons over an area.
#[derive(Debug, Clone, Default)]
pub struct Coverage {
    /// In parts of a covered pixel.
    cells: Vec<i32>,
    stride: usize,
    shares: Vec<f32>,
    columns: usize,
    width: f32,
    height: f32,
    rows: usize,
}

impl Coverage {
    /// Starts an area of this size with nothing covered.
    pub fn begin(&mut self, width: usize, height: usize) {
        // Two columns more for what edges put beyond the right border, and a row below, to which edges that end on
        // the lower border add nothing; in its last columns a vector of cells must fit.
        self.stride = width + 2;
        self.cells.clear();
        self.cells.resize(self.stride * (height + 1) + CELLS, 0);
        (self.width, self.height) = (width as f32, height as f32);
        (self.columns, self.rows) = (width, height);
    }

    /// Adds a closed polygon, laid out as [`STRIPS`] says, that runs counter-clockwise as one looks at the picture. Its
    /// y points down; the area's upper left corner is at (x0, y0). `short_inside` promises that no edge is a pixel
    /// long and that no vertex is outside the area; then it goes faster.
    pub fn add(&mut self, xs: &[f32], ys: &[f32], (x0, y0): (f32, f32), short_inside: bool) {
        if short_inside {
            return simd::add_short(&mut self.cells, self.stride, xs, ys, (x0, y0));
        }
        let ends = xs.iter().zip(ys).skip(STRIPS);
        for ((xa, ya), (xb, yb)) in xs.iter().zip(ys).zip(ends) {
            self.edge(xa - x0, ya - y0, xb - x0, yb - y0);
        }
    }

    /// The covered share of each pixel of a row, `share` times the sum over the polygons, as a running sum.
    pub fn row(&self, row: usize) -> &[f32] {
        &self.shares[row * self.columns..][..self.columns]
    }

    /// One edge, cut to the area: above and below nothing counts, to the left it counts at the left border, to the
    /// right of the area it covers nothing.
    #[inline]
    fn edge(&mut self, xa: f32, ya: f32, xb: f32, yb: f32) {
        if ya == yb {
            return;
        }
        // The edge downwards, and the sign of what it covers to its right.
        let (sign, xa, ya, xb, yb) = if ya < yb { (1.0, xa, ya, xb, yb) } else { (-1.0, xb, yb, xa, ya) };
        if yb <= 0.0 || ya >= self.height {
            return;
        }
        let slope = (xb - xa) / (yb - ya);
        let (mut x, top) = if ya < 0.0 { (xa - ya * slope, 0.0) } else { (xa, ya) };
        let bottom = yb.min(self.height);
        let mut row = top as usize;
        let mut y = top;
        while row < self.rows && y < bottom {
            let end = ((row + 1) as f32).min(bottom);
            let next_x = if end == yb { xb } else { x + (end - y) * slope };
            self.span(row, x, next_x, (end - y) * sign);
            (x, y) = (next_x, end);
            row += 1;
        }
    }

    /// Part of an edge within one row, from x = `a` to `b`, of height `dy` (signed).
    #[inline]
    fn span(&mut self, row: usize, a: f32, b: f32, dy: f32) {
        let (left, right) = if a < b { (a, b) } else { (b, a) };
        if left >= 0.0 && right < self.width {
            return self.span_inside(row, left, right, dy);
        }
        // Cut at the borders; the pieces have their share of the height.
        let length = right - left;
        let cells = row * self.stride;
        if right <= 0.0 || length == 0.0 {
            if left <= 0.0 {
                self.put(cells, dy);
            }
            return;
        }
        if left >= self.width {
            return;
        }
        if left < 0.0 {
            self.put(cells, dy * (-left / length));
        }
        let (from, to) = (left.max(0.0), right.min(self.width));
        self.span_inside(row, from, to, dy * ((to - from) / length));
    }

    #[inline]
    fn span_inside(&mut self, row: usize, left: f32, right: f32, dy: f32) {
        let first = left as usize;
        let last = right as usize;
        let base = row * self.stride + first;
        if first == last {
            let middle = 0.5 * (left + right) - first as f32;
            self.put(base, dy * (1.0 - middle));
            self.put(base + 1, dy * middle);
            return;
        }
        let per_column = dy / (right - left);
        let mut begin = left;
        for column in first..=last {
            let end = right.min((column + 1) as f32);
            let part = per_column * (end - begin);
            let middle = 0.5 * (begin + end) - column as f32;
            let cell = row * self.stride + column;
            self.put(cell, part * (1.0 - middle));
            self.put(cell + 1, part * middle);
            begin = end;
        }
    }

    #[inline]
    fn put(&mut self, cell: usize, area: f32) {
        self.cells[cell] += whole(area * WHOLE);
    }

    /// Turns the accumulated edges into covered shares: running sums along the rows times `share`, kept in 0..1.
    /// Circles that lie over one another cover a pixel no more than once.
    pub fn finish(&mut self, share: f32) {
        let scale = share / WHOLE;
        self.shares.clear();
        for row in self.cells.chunks_exact(self.stride).take(self.rows) {
            let mut sum = 0;
            self.shares.extend(row[..self.columns].iter().map(|cell| {
                sum += *cell;
                let share = sum as f32 * scale;
                if share > 0.0 { if share < 1.0 { share } else { 1.0 } } else { 0.0 }
            }));
        }
    }
}
