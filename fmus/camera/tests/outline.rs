//! Outlines of circles: how many vertices, where they lie, and what is said of their box and their edges.

use crate::common::*;
use camera::geometry::outline::COVERAGE_ERROR;
use camera::geometry::{Outline, Projection, STRIPS, UnitCircle};
use camera::{Camera, Variables};
use std::f64::consts::{PI, TAU};

/// From each vertex to the next one.
fn edges(outline: &Outline) -> impl Iterator<Item = ([f64; 2], [f64; 2])> + '_ {
    let at = |k: usize| [f64::from(outline.xs[k]), f64::from(outline.ys[k])];
    (0..outline.xs.len() - STRIPS).map(move |k| (at(k), at(k + STRIPS)))
}

/// By the sum of the cross products; positive where it runs counter-clockwise in the picture, whose y points down.
fn area(outline: &Outline) -> f64 {
    edges(outline).map(|(a, b)| 0.5 * (a[1] * b[0] - a[0] * b[1])).sum()
}

/// The longest that an edge is along x or y.
fn longest(outline: &Outline) -> f64 {
    edges(outline).fold(0.0, |most: f64, (a, b)| most.max((b[0] - a[0]).abs()).max((b[1] - a[1]).abs()))
}

/// Smallest x and y, largest x and y of the vertices.
fn extremes(outline: &Outline) -> [f32; 4] {
    let least = |places: &[f32]| places.iter().copied().fold(f32::MAX, f32::min);
    let most = |places: &[f32]| places.iter().copied().fold(f32::MIN, f32::max);
    [least(&outline.xs), least(&outline.ys), most(&outline.xs), most(&outline.ys)]
}

fn projection(change: impl Fn(&mut Variables)) -> Projection {
    Camera::projection(&variables(change)).expect("a usable lens")
}

#[test]
fn law_a_circle_has_the_vertices_that_its_error_asks_for_and_no_more() {
    for radius in [0.5, 1.0, 2.0, 3.3, 5.12, 8.0, 20.0, 100.0, 1000.0] {
        let circle = UnitCircle::for_radius_px(radius);
        assert!(!circle.is_empty());
        assert_eq!(circle.len() % STRIPS, 0);
        let n = (circle.len() - STRIPS) as f64;
        // One swing about the circle encloses 3.98 r²/n³ at most, see the file; 2π r edges of a pixel go round.
        let error = |n: f64| 3.98 * radius * radius / (n * n * n);
        let edge = |n: f64| TAU * radius / n;
        assert!(error(n) <= COVERAGE_ERROR && edge(n) < 1.0, "{n} for radius {radius}");
        // A vertex fewer in each strip would not do, were edges to be shorter than a pixel by the 3 % that a lens stretches.
        let fewer = n - STRIPS as f64;
        assert!(n == 16.0 || error(fewer) > COVERAGE_ERROR || edge(fewer) > 0.966, "{n} for radius {radius}");
    }
}

#[test]
fn law_a_disc_is_told_with_its_box_and_its_longest_edge() {
    for (radii, far) in
        [((5.12, 5.12), 300.0), ((8.0, 3.0), 20.0), ((3.0, 8.0), 20.0), ((1000.0, 1000.0), 1500.0)]
    {
        let circle = UnitCircle::for_radius_px(f64::max(radii.0, radii.1));
        let mut outline = Outline::default();
        outline.add_disc(&circle, (far, far + 0.3), radii);
        // Single precision: 2⁻²⁴ of the place and of the radius a vertex.
        assert!((area(&outline) / (PI * radii.0 * radii.1) - 1.0).abs() < 2e-6 * far, "{radii:?}");
        let (found, told) = (longest(&outline), outline.longest_edge);
        // A chord is shorter than its arc by a 24th of its angle squared: 1 % at most, for sixteen vertices.
        assert!(told >= found - 1e-3 && told <= 1.01 * found + 1e-3, "{radii:?}: {told}, not {found}");
        let (seen, bounds) = (extremes(&outline), outline.bounds.expect("it has a box"));
        for (side, (bound, vertex)) in bounds.into_iter().zip(seen).enumerate() {
            let beyond = if side < 2 { vertex - bound } else { bound - vertex };
            // Never within; and no farther out than the slack of 1e-3 px, twice for single precision, and what an edge
            // bulges, an eighth of its length times its angle.
            let bulge = told * TAU / (circle.len() - STRIPS) as f64 / 8.0;
            assert!((0.0..2e-3 + bulge as f32).contains(&beyond), "{radii:?}, side {side}: {beyond}");
        }
    }
}

#[test]
fn law_a_rolled_camera_shows_discs_of_the_same_area_and_edges() {
    let circle = UnitCircle::for_radius_px(5.12);
    for roll in [0.3, 0.8, 1.3, 2.4] {
        let mut outline = Outline::default();
        assert!(outline.add(&circle, (2.0, -3.0), 0.2, &projection(|v| v.effects.mounting.roll = roll)));
        // 0.2 of 10 world units are 5.12 of 256 px; single precision of the places, about 300 px.
        assert!((area(&outline) / (PI * 5.12 * 5.12) - 1.0).abs() < 1e-4, "{roll}");
        let (found, told) = (longest(&outline), outline.longest_edge);
        // An arc of a fortieth turn is 0.1 % longer than its chord, and the longest one need not lie along x or y: it is
        // at most half of that angle off, 0.3 %. Single precision as above.
        assert!(told >= found - 1e-4 && told < 1.005 * found, "{roll}: {told}, not {found}");
    }
}

#[test]
fn value_a_circle_of_the_largest_size_that_has_harmonics_is_as_long_as_they_say() {
    // x = r cos φ + p2 r² sin 2φ about the axis: its fastest is r + 2 p2 r², at φ = π/2. Half a world unit is 12.8 px.
    let circle = UnitCircle::for_radius_px(14.0);
    let mut outline = Outline::default();
    let lens = projection(|v| v.effects.decentering.vertical = 0.1);
    assert!(outline.add(&circle, (0.0, 0.0), 0.499, &lens));
    let (r, p2) = (0.0499, 0.1);
    let angle = TAU / (circle.len() - STRIPS) as f64;
    let expected = 256.0 * angle * (r + 2.0 * p2 * r * r);
    // The polygon lies outside of the circle by a twelfth of the angle squared, 4e-4.
    assert!((outline.longest_edge / expected - 1.0).abs() < 1e-3, "{}, not {expected}", outline.longest_edge);
    assert!(longest(&outline) <= outline.longest_edge);
}

#[test]
fn every_outline_behind_a_lens_lies_where_the_lens_shows_the_circle() {
    let lens = projection(|v| (v.effects.decentering.vertical, v.effects.radial.cubic) = (0.1, 0.2));
    let centre = (4.0, -5.0);
    // Up to 0.5 world units by harmonics, in a way that knows how long its edges are; from there on vertex by vertex.
    for (radius, by_harmonics, within) in
        [(0.2, true, 1e-4), (0.49, true, 4e-3), (0.52, false, 1e-4), (2.0, false, 1e-4)]
    {
        let circle = UnitCircle::for_radius_px(40.0 * radius);
        let (mut outline, mut there) = (Outline::default(), Outline::default());
        assert!(outline.add(&circle, centre, radius, &lens));
        assert_eq!(outline.longest_edge.is_finite(), by_harmonics, "{radius}");
        // The same polygon before the lens, in world units.
        there.add_disc(&circle, centre, (radius, radius));
        let mut worst: f64 = 0.0;
        for k in 0..outline.xs.len() {
            // Raster coordinates point down, those of the world up.
            let world = (f64::from(there.xs[k]), 2.0 * centre.1 - f64::from(there.ys[k]));
            let (x, y) = lens.raster_from_world(world).expect("before the camera");
            worst = worst.max((x - f64::from(outline.xs[k])).hypot(y - f64::from(outline.ys[k])));
        }
        println!("radius {radius}: {worst:.2e} px");
        assert!(worst < within, "radius {radius}: {worst}");
        let (seen, bounds) = (extremes(&outline), outline.bounds.expect("it has a box"));
        assert!(bounds[0] <= seen[0] && bounds[1] <= seen[1] && bounds[2] >= seen[2] && bounds[3] >= seen[3]);
    }
}

#[test]
fn every_picture_that_is_only_a_scaled_one_is_told_apart() {
    let scaled: Change = |v| {
        (v.sensor.width, v.sensor.height, v.sensor.focal_length) = (640, 480, 3.0);
        (v.effects.placement.scale, v.effects.placement.centre_u) = (1.5, 0.1);
    };
    // A world unit is a tenth of half of the picture, times 1.5.
    let (x, y) = projection(scaled).plain_scale().expect("nothing but scaled");
    assert!((x - 48.0).abs() < 1e-12 && (y - 36.0).abs() < 1e-12, "{x} {y}"); // rounding
    let others: [Change; 4] = [
        |v| v.effects.thin_prism.vertical = 0.01,
        |v| v.effects.mounting.roll = 0.01,
        |v| v.effects.mounting.tilt = -0.01,
        |v| (v.effects.radial.cubic, v.effects.mounting.pan) = (0.01, 0.01),
    ];
    for other in others {
        assert_eq!(projection(other).plain_scale(), None);
    }
}

#[test]
fn value_what_lies_a_thousandth_of_the_distance_before_the_camera_is_seen_and_nothing_nearer() {
    // Panned by α, the plane at D = 20 is z = D cos α + x sin α from the camera: 0 at x = −D cot α.
    let pan: f64 = 1.0;
    let camera = projection(|v| v.effects.mounting.pan = pan);
    let at = |share: f64| camera.ideal_from_world(((20.0 * share - 20.0 * pan.cos()) / pan.sin(), 1.0));
    for (share, seen) in [(-1.0, false), (0.0, false), (0.9e-3, false), (1.1e-3, true), (0.5, true)] {
        assert_eq!(at(share).is_some(), seen, "{share} of the distance");
    }
    let (_, v) = at(0.5).expect("seen");
    assert!((v - 2.0 / 10.0).abs() < 1e-12, "{v}"); // f y / z, to rounding
}

#[test]
fn value_a_decentred_lens_makes_things_largest_on_one_side() {
    // Along u the Jacobian of p1·(3u² + v², 2uv) has (1 + 6 p1 u, 2 p1 v): sqrt(1.6² + 0.2²) in a corner; for −p1 in the
    // one across, for p2 along v.
    let largest: [Change; 4] = [
        |v| v.effects.decentering.horizontal = 0.1,
        |v| v.effects.decentering.horizontal = -0.1,
        |v| v.effects.decentering.vertical = 0.1,
        |v| v.effects.decentering.vertical = -0.1,
    ];
    for lens in largest {
        let found = projection(lens).largest_magnification();
        assert!((found - 2.6_f64.sqrt()).abs() < 1e-3, "{found}"); // differences over 1e-3
    }
}
