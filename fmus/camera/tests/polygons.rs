//! Areas of pixels, and polygons over them whatever way they cross the grid and the borders: against exact clipping.

use crate::common::*;
use camera::geometry::STRIPS;
use camera::photometry::{Area, Coverage};
use std::collections::BTreeSet;

fn pixels(area: &Area) -> BTreeSet<(usize, usize)> {
    (area.y0..area.y1).flat_map(|y| (area.x0..area.x1).map(move |x| (x, y))).collect()
}

#[test]
fn every_area_is_what_its_pixels_are() {
    let mut random = Random(4);
    let mut area = || {
        let mut side = || {
            let from = random.between(0.0, 5.0) as usize;
            (from, from + 1 + random.between(0.0, 3.0) as usize)
        };
        let ((x0, x1), (y0, y1)) = (side(), side());
        Area { x0, y0, x1, y1 }
    };
    let (mut meeting, mut apart) = (0, 0);
    for _ in 0..2000 {
        let (one, other) = (area(), area());
        let (here, there) = (pixels(&one), pixels(&other));
        assert_eq!(one.width() * one.height(), here.len(), "{one:?}");
        assert!(one.width() == one.x1 - one.x0);
        let share = !here.is_disjoint(&there);
        *(if share { &mut meeting } else { &mut apart }) += 1;
        assert_eq!(one.overlaps(&other), share, "{one:?} {other:?}");
        // The smallest around both: it has all of their pixels, and each of its sides touches one of the two.
        let (around, both) =
            (pixels(&one.around(&other)), here.union(&there).copied().collect::<BTreeSet<_>>());
        assert!(both.is_subset(&around));
        let reach = |pixels: &BTreeSet<(usize, usize)>| {
            let (x, y) = (pixels.iter().map(|at| at.0), pixels.iter().map(|at| at.1));
            (x.clone().min(), x.max(), y.clone().min(), y.max())
        };
        assert_eq!(reach(&around), reach(&both));
        // With a margin: the pixels of an 8 x 7 frame that are no farther away.
        let near = |a: (usize, usize)| here.iter().any(|b| a.0.abs_diff(b.0) <= 2 && a.1.abs_diff(b.1) <= 2);
        let frame = pixels(&Area { x0: 0, y0: 0, x1: 8, y1: 7 });
        let grown: BTreeSet<_> = frame.into_iter().filter(|at| near(*at)).collect();
        assert_eq!(pixels(&one.grown(2, 8, 7)), grown, "{one:?}");
    }
    assert!(meeting > 100 && apart > 100, "{meeting} meet, {apart} do not");
}

type Point = (f64, f64);

/// The part of a polygon on one side of a line, given by a function that is positive there.
fn cut(polygon: &[Point], side: impl Fn(Point) -> f64) -> Vec<Point> {
    let mut left = Vec::new();
    for (place, a) in polygon.iter().enumerate() {
        let b = polygon[(place + 1) % polygon.len()];
        let (from, to) = (side(*a), side(b));
        if from >= 0.0 {
            left.push(*a);
        }
        if (from > 0.0) != (to > 0.0) && from != to {
            let share = from / (from - to);
            left.push((a.0 + share * (b.0 - a.0), a.1 + share * (b.1 - a.1)));
        }
    }
    left
}

/// Area of a polygon in a pixel; positive where it runs counter-clockwise as one looks at the picture, its y down.
fn inside(polygon: &[Point], x: f64, y: f64) -> f64 {
    let part = cut(&cut(polygon, |p| p.0 - x), |p| x + 1.0 - p.0);
    let part = cut(&cut(&part, |p| p.1 - y), |p| y + 1.0 - p.1);
    let edge = |k: usize| {
        let (a, b) = (part[k], part[(k + 1) % part.len()]);
        0.5 * (a.1 * b.0 - a.0 * b.1)
    };
    (0..part.len()).map(edge).sum()
}

/// A polygon as outlines are laid out, whose corners are those given, again and again: an edge from a corner to itself is
/// none.
fn laid_out(corners: &[Point]) -> (Vec<f32>, Vec<f32>) {
    let strip = corners.len().div_ceil(STRIPS);
    let corner = |k: usize| corners[(k % STRIPS * strip + k / STRIPS).min(corners.len()) % corners.len()];
    let all = 0..(strip + 1) * STRIPS;
    (all.clone().map(|k| corner(k).0 as f32).collect(), all.map(|k| corner(k).1 as f32).collect())
}

/// Largest difference to the exact areas, and how much is covered, for a polygon over an area at (3, 5) of this size.
fn difference(corners: &[Point], (width, height): (usize, usize)) -> (f64, f64) {
    let (xs, ys) = laid_out(corners);
    let mut coverage = Coverage::default();
    coverage.begin(width, height);
    coverage.add(&xs, &ys, (3.0, 5.0), false);
    coverage.finish(1.0);
    let (mut worst, mut total) = (0.0_f64, 0.0);
    for y in 0..height {
        assert_eq!(coverage.row(y).len(), width);
        for (x, found) in coverage.row(y).iter().enumerate() {
            let expected = inside(corners, 3.0 + x as f64, 5.0 + y as f64);
            worst = worst.max((f64::from(*found) - expected).abs());
            total += expected;
        }
    }
    (worst, total)
}

/// Corners in the order of their angles about the middle: counter-clockwise as one looks at the picture.
fn around(mut corners: Vec<Point>) -> Vec<Point> {
    let n = corners.len() as f64;
    let middle = corners.iter().fold((0.0, 0.0), |sum, p| (sum.0 + p.0 / n, sum.1 + p.1 / n));
    let angle = |p: &Point| libm::atan2(middle.1 - p.1, p.0 - middle.0);
    corners.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    corners
}

#[test]
fn every_polygon_covers_its_exact_share_of_each_pixel() {
    // Cells are whole parts of 2⁻²⁰; an edge rounds two of them in a column, of which a row sums some twenty. Single
    // precision of places up to 20 adds 1e-6 each.
    const WITHIN: f64 = 4e-5;
    let size = (9, 7);
    let mut random = Random(12);
    let mut covered = [0.0; 3];
    for trial in 0..3000 {
        // Within the area, all about it, and with corners on the lines of the grid and the borders.
        let kind = trial % 3;
        let mut corner = |_| match kind {
            0 => (random.between(3.0, 12.0), random.between(5.0, 12.0)),
            1 => (random.between(-5.0, 20.0), random.between(-3.0, 20.0)),
            _ => (random.between(1.0, 15.0).floor(), random.between(3.0, 15.0).floor()),
        };
        // Three corners make a convex polygon in any order of angles; single precision, as the coverage takes them.
        let corners: Vec<Point> =
            (0..3).map(&mut corner).map(|p| (f64::from(p.0 as f32), f64::from(p.1 as f32))).collect();
        let corners = around(corners);
        let (worst, total) = difference(&corners, size);
        assert!(worst < WITHIN, "{corners:?}: {worst}");
        covered[kind] += total / 1000.0;
    }
    // The mean triangle within a rectangle has 11/144 of its area, 4.8 of 63 px.
    assert!((covered[0] - 4.8125).abs() < 0.5 && covered[1] > 5.0 && covered[2] > 5.0, "{covered:?}");
}

#[test]
fn every_border_is_the_end_of_what_is_covered() {
    // Rectangles whose sides lie on borders, and beyond.
    let size = (9, 7);
    for (x0, x1) in
        [(3.0, 12.0), (0.0, 3.0), (12.0, 14.0), (-2.0, 20.0), (3.0, 3.5), (11.25, 12.0), (1.5, 4.5)]
    {
        for (y0, y1) in
            [(5.0, 12.0), (2.0, 5.0), (12.0, 13.0), (0.0, 20.0), (5.0, 5.5), (11.25, 12.0), (4.5, 6.5)]
        {
            let corners = [(x0, y1), (x1, y1), (x1, y0), (x0, y0)];
            let (worst, total) = difference(&corners, size);
            // Sides are halves and quarters, which parts of 2⁻²⁰ hold; what is expected is clipped in double precision.
            assert!(worst < 1e-12, "{corners:?}: {worst}");
            let along = |from: f64, to: f64, most: f64| (f64::min(to, most) - from).max(0.0);
            let expected = along(f64::max(x0, 3.0), x1, 12.0) * along(f64::max(y0, 5.0), y1, 12.0);
            assert!((total - expected).abs() < 1e-10, "{corners:?}: {total}");
        }
    }
}

#[test]
fn every_short_edge_out_of_the_area_leaves_what_lies_behind_the_cells_alone() {
    use camera::geometry::{Outline, UnitCircle};
    use camera::photometry::{edges::CELLS, simd};
    let (columns, rows) = (20, 15);
    let n = columns * rows;
    let circle = UnitCircle::for_radius_px(3.0);
    for centre in [(8.0, 14.0), (8.0, 16.0), (8.0, 40.0), (300.0, 300.0), (8.0, -1.0), (-40.0, -40.0)] {
        let mut outline = Outline::default();
        outline.add_disc(&circle, centre, (3.0, 3.0));
        let mut memory = vec![0; n + 4 * CELLS];
        simd::add_short(&mut memory[..n], columns, &outline.xs, &outline.ys, (0.0, 0.0));
        assert_eq!(memory[n..], vec![0; 4 * CELLS], "{centre:?}");
    }
}
