//! Edges shorter than a pixel, many at a time: what each adds to the cells of [`super::coverage`].
//!
//! Such an edge lies in at most two rows, and its part within a row in at most two columns, so that it adds to three
//! cells of its upper row and to three of the row below. Cells are whole numbers: sums don't depend on their order, and
//! any path may take the edges as suits it.

use crate::geometry::STRIPS;

/// Parts of a covered pixel in a cell. The sums of three circles in 256 sub-frames stay below 2³⁰.
pub const WHOLE: f32 = (1 << 20) as f32;

/// Cells that are added to at once: three that matter, and a zero, so that they make a vector.
pub const CELLS: usize = 4;

/// What `LANES` edges add: from the cell `upper_first` on in their upper row, and from `lower_first` on in the row below.
#[derive(Debug, Clone, Copy)]
pub struct Edges<const LANES: usize> {
    /// First cell in the upper row.
    pub upper_first: [u32; LANES],
    /// First cell in the row below.
    pub lower_first: [u32; LANES],
    /// What is added to the three cells in the upper row.
    pub upper: [[i32; LANES]; 3],
    /// What is added to the three cells in the row below.
    pub lower: [[i32; LANES]; 3],
}

impl<const LANES: usize> Edges<LANES> {
    /// Edges from the vertices `a` to the vertices `b`, given as (x, y) and relative to (x0, y0). Written lane by lane
    /// without branches, so that the compiler makes vector code of it; `always`, so that it makes it for the machine
    /// that the caller was compiled for.
    #[inline(always)]
    fn new(a: [&[f32; LANES]; 2], b: [&[f32; LANES]; 2], (x0, y0): (f32, f32), stride: i32) -> Self {
        let (none, zero) = ([0; LANES], [[0; LANES]; 3]);
        let mut edges = Self { upper_first: none, lower_first: none, upper: zero, lower: zero };
        for lane in 0..LANES {
            let (xa, ya, xb, yb) = (a[0][lane] - x0, a[1][lane] - y0, b[0][lane] - x0, b[1][lane] - y0);
            let down = ya < yb;
            let sign = if down { WHOLE } else { -WHOLE };
            let (top_x, top) = (if down { xa } else { xb }, if down { ya } else { yb });
            let (bottom_x, bottom) = (if down { xb } else { xa }, if down { yb } else { ya });
            let (row, border) = (below(top), below(top) + 1.0);
            let height = bottom - top;
            let above = if bottom < border { height } else { border - top };
            let share = above / if height > TINY { height } else { TINY };
            let middle = top_x + (bottom_x - top_x) * share;
            let (upper_column, upper) = part(top_x, middle, sign * above);
            let (lower_column, lower) = part(middle, bottom_x, sign * (height - above));
            let cells = whole(row) * stride;
            edges.upper_first[lane] = (cells + whole(upper_column)) as u32;
            edges.lower_first[lane] = (cells + stride + whole(lower_column)) as u32;
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
fn part(a: f32, b: f32, height: f32) -> (f32, [i32; 3]) {
    let (left, right) = if a < b { (a, b) } else { (b, a) };
    let (column, border) = (below(left), below(left) + 1.0);
    let width = right - left;
    let half = 0.5 / if width > TINY { width } else { TINY };
    let (before, beyond) = (border - left, right - border);
    let crosses = right > border;
    let first = if crosses { before * before * half } else { border - 0.5 * (left + right) };
    let rest = if crosses { beyond * beyond * half } else { 0.0 };
    // The second is what is left over, so that the three together are the whole height.
    let (all, first, rest) = (whole(height), whole(height * first), whole(height * rest));
    (column, [first, all - first - rest, rest])
}

/// 1.5 · 2²³: what is added to it is rounded to a whole number.
const ROOM: f32 = 12_582_912.0;

/// The nearest whole number, for values below 2²²: the sum has no room for a fraction.
#[inline(always)]
pub fn whole(value: f32) -> i32 {
    ((value + ROOM).to_bits() as i32).wrapping_sub(ROOM.to_bits() as i32)
}

/// The whole number at or below a value in 0..2²²; a cast would not become vector code.
#[inline(always)]
pub fn below(value: f32) -> f32 {
    let nearest = (value + ROOM) - ROOM;
    nearest - if nearest > value { 1.0 } else { 0.0 }
}

/// Adds a·cos + b·sin to each place, [`STRIPS`] at a time: of how many vertices an outline has is a multiple.
#[inline(always)]
pub fn add_wave(places: &mut [f32], cosines: &[f32], sines: &[f32], (a, b): (f32, f32)) {
    let (places, _) = places.as_chunks_mut::<STRIPS>();
    let ((cosines, _), (sines, _)) = (cosines.as_chunks::<STRIPS>(), sines.as_chunks::<STRIPS>());
    for ((places, cosines), sines) in places.iter_mut().zip(cosines).zip(sines) {
        for ((place, cos), sin) in places.iter_mut().zip(cosines).zip(sines) {
            *place += a * cos + b * sin;
        }
    }
}

/// Hands the edges of a closed polygon to `put`, `LANES` at a time; edge k runs from the vertex k to k + [`STRIPS`].
#[inline(always)]
pub fn each<const LANES: usize>(
    xs: &[f32],
    ys: &[f32],
    origin: (f32, f32),
    stride: i32,
    mut put: impl FnMut(&Edges<LANES>),
) {
    const { assert!(STRIPS.is_multiple_of(LANES), "the lanes divide the edges of every polygon") };
    let (xa, _) = xs.as_chunks::<LANES>();
    let (ya, _) = ys.as_chunks::<LANES>();
    let ahead = STRIPS / LANES;
    let ends = xa.iter().zip(ya).skip(ahead);
    for ((xa, ya), (xb, yb)) in xa.iter().zip(ya).zip(ends) {
        put(&Edges::new([xa, ya], [xb, yb], origin, stride));
    }
}

/// Adds edges to the cells one after the other. Cells beyond the last are left out.
#[inline(always)]
pub fn add<const LANES: usize>(cells: &mut [i32], edges: &Edges<LANES>) {
    for lane in 0..LANES {
        for (first, parts) in
            [(edges.upper_first[lane], &edges.upper), (edges.lower_first[lane], &edges.lower)]
        {
            let first = first as usize;
            if let Some([a, b, c]) = cells.get_mut(first..first + 3) {
                *a += parts[0][lane];
                *b += parts[1][lane];
                *c += parts[2][lane];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{CELLS, WHOLE, add, each};
    use crate::geometry::{Outline, UnitCircle};
    use crate::photometry::{Coverage, simd};

    /// Forty discs at as many places inside an area of 24 x 24 pixels, one after the other.
    fn discs(radius: f64, mut take: impl FnMut(&[f32], &[f32])) {
        let circle = UnitCircle::for_radius_px(radius);
        let mut outline = Outline::default();
        for i in 0..40 {
            let at = |k: f64| 12.0 + 3.0 * libm::sin(k * f64::from(i));
            outline.clear();
            outline.add_disc(&circle, (at(1.7), at(2.3)), (radius, radius));
            take(&outline.xs, &outline.ys);
        }
    }

    #[test]
    fn law_lanes_change_no_bit() {
        const STRIDE: usize = 26;
        for radius in [2.0, 3.3, 5.12, 7.9] {
            let made = [0, 1, 2].map(|which| {
                let mut cells = vec![0; STRIDE * 25 + CELLS];
                discs(radius, |xs, ys| match which {
                    0 => each::<1>(xs, ys, (0.0, 0.0), STRIDE as i32, |edges| add(&mut cells, edges)),
                    1 => each::<4>(xs, ys, (0.0, 0.0), STRIDE as i32, |edges| add(&mut cells, edges)),
                    _ => simd::add_short(&mut cells, STRIDE, xs, ys, (0.0, 0.0)),
                });
                cells
            });
            let mut total = 0.0;
            for row in made[0].chunks(STRIDE) {
                let mut sum = 0;
                for cell in row {
                    sum += cell;
                    total += f64::from(sum) / f64::from(WHOLE);
                }
            }
            let area = 40.0 * core::f64::consts::PI * radius * radius;
            // Single precision of the vertices, and half a cell's part for each that is added.
            assert!((total / area - 1.0).abs() < 1e-5, "radius {radius}: {total} {area}");
            assert_eq!(made[0], made[1], "radius {radius}");
            assert_eq!(made[0], made[2], "radius {radius}");
        }
    }

    #[test]
    fn cross_short_edges_add_what_edges_of_any_length_add() {
        for radius in [2.0, 3.3, 5.12, 7.9] {
            let [short, any] = [true, false].map(|short_inside| {
                let mut coverage = Coverage::default();
                coverage.begin(24, 24);
                discs(radius, |xs, ys| coverage.add(xs, ys, (0.0, 0.0), short_inside));
                coverage.finish(1.0 / 40.0);
                (0..24).flat_map(|row| coverage.row(row).to_vec()).collect::<Vec<f32>>()
            });
            let worst = short.iter().zip(&any).fold(0.0, |worst: f32, (a, b)| worst.max((a - b).abs()));
            // Some thirty roundings to 2^-20 in a row, and single precision within an edge: 1e-6 each, at random.
            assert!(worst < 2e-5, "radius {radius}: {worst}");
            assert!(short.iter().sum::<f32>() > 10.0, "radius {radius}: nothing is covered");
        }
    }
}
