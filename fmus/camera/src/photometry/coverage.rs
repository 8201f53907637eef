//! Exact area coverage: signed areas of polygon edges accumulated per pixel, then summed along each row.
//!
//! For each edge and each row that it crosses, the area between the edge and the right border of a pixel is added to
//! that pixel and the rest of its height to the next; the running sum along the row is then the covered area. It is
//! linear, so the sub-frames of an exposure are accumulated together and summed once.

use super::simd;

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
    cells: Vec<f32>,
    stride: usize,
    width: f32,
    height: f32,
    rows: usize,
}

/// What edges shorter than a pixel add: three cells from a column on in their upper row, and in the row below.
#[derive(Debug, Clone, Copy)]
struct Edges<const LANES: usize> {
    row: [i32; LANES],
    upper_column: [i32; LANES],
    lower_column: [i32; LANES],
    upper: [[f32; LANES]; 3],
    lower: [[f32; LANES]; 3],
}

impl<const LANES: usize> Edges<LANES> {
    /// Edges from the vertices `a` to the vertices `b`, given as (x, y) and relative to (x0, y0). Written lane by lane
    /// without branches, so that the compiler makes vector code of it; `always`, so that it makes it for the machine
    /// that the caller was compiled for.
    #[inline(always)]
    fn new(a: [&[f32; LANES]; 2], b: [&[f32; LANES]; 2], (x0, y0): (f32, f32)) -> Self {
        let (none, zero) = ([0; LANES], [[0.0; LANES]; 3]);
        let mut edges = Self { row: none, upper_column: none, lower_column: none, upper: zero, lower: zero };
        for lane in 0..LANES {
            let (xa, ya, xb, yb) = (a[0][lane] - x0, a[1][lane] - y0, b[0][lane] - x0, b[1][lane] - y0);
            let down = ya < yb;
            let sign = if down { 1.0 } else { -1.0 };
            let (top_x, top) = (if down { xa } else { xb }, if down { ya } else { yb });
            let (bottom_x, bottom) = (if down { xb } else { xa }, if down { yb } else { ya });
            let row = top as i32;
            let border = (row + 1) as f32;
            let height = bottom - top;
            let above = if bottom < border { height } else { border - top };
            let share = above / if height > TINY { height } else { TINY };
            let middle = top_x + (bottom_x - top_x) * share;
            let (upper_column, upper) = part(top_x, middle, sign * above);
            let (lower_column, lower) = part(middle, bottom_x, sign * (height - above));
            (edges.row[lane], edges.upper_column[lane], edges.lower_column[lane]) =
                (row, upper_column, lower_column);
            for cell in 0..3 {
                (edges.upper[cell][lane], edges.lower[cell][lane]) = (upper[cell], lower[cell]);
            }
        }
        edges
    }
}

/// Keeps a division by nothing from being one; what it divides is nothing as well.
const TINY: f32 = 1e-30;

/// What a part of an edge within a row, from x = a to b and `height` high (signed), adds to three cells. The covered
/// share of the first pixel is the mean of (border − x)₊ along the part, of the first two that of min(1, border + 1 − x).
#[inline(always)]
fn part(a: f32, b: f32, height: f32) -> (i32, [f32; 3]) {
    let (left, right) = if a < b { (a, b) } else { (b, a) };
    let column = left as i32;
    let border = (column + 1) as f32;
    let width = right - left;
    let half = 0.5 / if width > TINY { width } else { TINY };
    let (before, beyond) = (border - left, right - border);
    let crosses = right > border;
    let first = if crosses { before * before * half } else { border - 0.5 * (left + right) };
    let rest = if crosses { beyond * beyond * half } else { 0.0 };
    (column, [height * first, height * (1.0 - rest - first), height * rest])
}

impl Coverage {
    /// Starts an area of this size with nothing covered.
    pub fn begin(&mut self, width: usize, height: usize) {
        // Two columns more for what edges put beyond the right border, and a row below, to which edges that end on
        // the lower border add nothing.
        self.stride = width + 2;
        self.cells.clear();
        self.cells.resize(self.stride * (height + 1) + 1, 0.0);
        (self.width, self.height, self.rows) = (width as f32, height as f32, height);
    }

    /// Adds a closed polygon (its first vertex stands at the end again) that runs counter-clockwise as one looks at
    /// the picture. Its y points down; the area's upper left corner is at (x0, y0). `short_inside` promises that no
    /// edge is a pixel long and that no vertex is outside the area; then it goes faster.
    pub fn add(&mut self, xs: &[f32], ys: &[f32], (x0, y0): (f32, f32), short_inside: bool) {
        if short_inside {
            return simd::add_short(self, xs, ys, (x0, y0));
        }
        for (x, y) in xs.windows(2).zip(ys.windows(2)) {
            self.edge(x[0] - x0, y[0] - y0, x[1] - x0, y[1] - y0);
        }
    }

    /// A polygon of short edges inside the area: an edge shorter than a pixel lies in at most two rows, and its part
    /// within a row in at most two columns. The bits don't depend on the number of lanes: edges are worked out each
    /// for itself and added one after the other.
    #[inline(always)]
    pub(super) fn add_short<const LANES: usize>(&mut self, xs: &[f32], ys: &[f32], origin: (f32, f32)) {
        let start = self.add_edges::<LANES>(xs, ys, origin, 0);
        let start = self.add_edges::<4>(xs, ys, origin, start);
        // The number of edges is a multiple of four for the outlines there are.
        for (x, y) in xs[start..].windows(2).zip(ys[start..].windows(2)) {
            self.edge(x[0] - origin.0, y[0] - origin.1, x[1] - origin.0, y[1] - origin.1);
        }
    }

    /// Adds short edges from the vertex `start` on, as many as fill the lanes; returns the first vertex left over.
    #[inline(always)]
    fn add_edges<const LANES: usize>(
        &mut self,
        xs: &[f32],
        ys: &[f32],
        origin: (f32, f32),
        mut start: usize,
    ) -> usize {
        let lanes =
            |of: &[f32], at: usize| of.get(at..).and_then(|rest| rest.first_chunk::<LANES>().copied());
        while let (Some(xa), Some(ya), Some(xb), Some(yb)) =
            (lanes(xs, start), lanes(ys, start), lanes(xs, start + 1), lanes(ys, start + 1))
        {
            let edges = Edges::new([&xa, &ya], [&xb, &yb], origin);
            for lane in 0..LANES {
                let upper = edges.row[lane] as usize * self.stride;
                let cells = [
                    (upper + edges.upper_column[lane] as usize, &edges.upper),
                    (upper + self.stride + edges.lower_column[lane] as usize, &edges.lower),
                ];
                for (first, parts) in cells {
                    if let Some([a, b, c]) = self.cells.get_mut(first..first + 3) {
                        *a += parts[0][lane];
                        *b += parts[1][lane];
                        *c += parts[2][lane];
                    }
                }
            }
            start += LANES;
        }
        start
    }

    /// The covered share of each pixel of a row, `share` times the sum over the polygons, as a running sum.
    pub fn row(&self, row: usize) -> &[f32] {
        let start = row * self.stride;
        &self.cells[start..start + self.stride - 2]
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
                self.cells[cells] += dy;
            }
            return;
        }
        if left >= self.width {
            return;
        }
        if left < 0.0 {
            self.cells[cells] += dy * (-left / length);
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
            self.cells[base] += dy * (1.0 - middle);
            self.cells[base + 1] += dy * middle;
            return;
        }
        let per_column = dy / (right - left);
        let mut begin = left;
        for column in first..=last {
            let end = right.min((column + 1) as f32);
            let part = per_column * (end - begin);
            let middle = 0.5 * (begin + end) - column as f32;
            let cell = row * self.stride + column;
            self.cells[cell] += part * (1.0 - middle);
            self.cells[cell + 1] += part * middle;
            begin = end;
        }
    }

    /// Turns the accumulated edges into covered shares: running sums along the rows times `share`, kept in 0..1.
    /// Circles that lie over one another cover a pixel no more than once.
    pub fn finish(&mut self, share: f32) {
        for row in self.cells.chunks_exact_mut(self.stride) {
            let mut sum = 0.0;
            for cell in row {
                sum += *cell;
                *cell = (sum * share).clamp(0.0, 1.0);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Coverage;
    use crate::geometry::{Outline, UnitCircle};
    use crate::photometry::simd;

    #[test]
    fn law_lanes_change_no_bit() {
        // Circles of numbers of vertices that eight lanes divide, and that they don't.
        for radius in [2.0, 3.3, 5.12, 7.9] {
            let circle = UnitCircle::for_radius_px(radius);
            let made = [0, 1, 2].map(|which| {
                let mut outline = Outline::default();
                let mut coverage = Coverage::default();
                coverage.begin(24, 24);
                for i in 0..40 {
                    let at = |k: f64| 10.5 + 3.0 * libm::sin(k * f64::from(i));
                    outline.clear();
                    outline.add_disc(&circle, (at(1.7), at(2.3)), (radius, radius));
                    let (xs, ys) = (&outline.xs, &outline.ys);
                    match which {
                        0 => coverage.add_short::<4>(xs, ys, (0.0, 0.0)),
                        1 => coverage.add_short::<8>(xs, ys, (0.0, 0.0)),
                        _ => simd::add_short(&mut coverage, xs, ys, (0.0, 0.0)),
                    }
                }
                coverage.cells.iter().map(|cell| cell.to_bits()).collect::<Vec<u32>>()
            });
            assert!(made[0].iter().any(|bits| *bits != 0));
            assert_eq!(made[0], made[1], "radius {radius}");
            assert_eq!(made[0], made[2], "radius {radius}");
        }
    }
}
