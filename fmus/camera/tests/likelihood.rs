//! The most likely centre of a disc: found from beside it, from a part of it, by the pixels that tell, or not at all.

use crate::common::*;
use camera::Variables;
use camera::geometry::{Outline, UnitCircle};
use camera::photometry::{Area, Coverage, Mask, Plane};
use camera::vision::likelihood::{Expected, Likelihood, Seen};
use camera::vision::{Component, Finder, View};

const SIZE: usize = 48;

/// A disc of the nominal size, of the scene's grey levels.
fn disc(variables: &Variables, centre: (f64, f64), radius: f64) -> Plane<u8> {
    let circle = UnitCircle::for_radius_px(100.0 * radius); // many vertices
    let (mut outline, mut coverage) = (Outline::default(), Coverage::default());
    outline.add_disc(&circle, centre, (radius, radius));
    coverage.begin(SIZE, SIZE);
    coverage.add(&outline.xs, &outline.ys, (0.0, 0.0), false);
    coverage.finish(1.0);
    let mut picture = Plane::filled(SIZE, SIZE, 0, 0);
    let (dark, bright) = (variables.scene.background, variables.scene.foreground);
    for y in 0..SIZE {
        for (to, share) in picture.row_mut(y).iter_mut().zip(coverage.row(y)) {
            *to = (dark + (bright - dark) * f64::from(*share)).round() as u8;
        }
    }
    picture
}

/// Grey levels that the picture holds without being cut at 0 and 255.
fn grey() -> Variables {
    variables(|v| (v.scene.foreground, v.scene.background) = (220.0, 30.0))
}

fn refined(variables: &Variables, picture: &Plane<u8>, window: Area, start: (f64, f64)) -> (f64, f64) {
    let (x, y) = (start.0 as usize, start.1 as usize);
    let bounds = Area {
        x0: (x - 4).max(window.x0),
        y0: (y - 4).max(window.y0),
        x1: (x + 5).min(window.x1),
        y1: (y + 5).min(window.y1),
    };
    let region = Component { area: 75, sum_x: 0, sum_y: 0, first: (0, 0), bounds };
    let (mask, windows) = (Mask::empty(SIZE, SIZE), [window]);
    let view = View { picture, mask: &mask, windows: &windows, row_step: 1 };
    let Variables { scene, sensor, effects, .. } = variables;
    let seen = Seen { component: &region, view: &view, window: &window };
    Likelihood::default().refine(start, &seen, &Expected { scene, sensor, effects })
}

const ALL: Area = Area { x0: 0, y0: 0, x1: SIZE, y1: SIZE };

#[test]
fn every_disc_is_found_from_half_a_pixel_beside_it() {
    let variables = grey();
    let mut random = Random(9);
    for _ in 0..100 {
        let mut near = |x: f64, reach: f64| x + random.between(-reach, reach);
        let centre = (near(23.0, 1.0), near(24.0, 1.0));
        let start = (near(centre.0, 0.4), near(centre.1, 0.4));
        let (x, y) = refined(&variables, &disc(&variables, centre, 5.12), ALL, start);
        // Rounding to levels is off by 0.29 of them, and the information of the rim, see below, makes 4e-4 px of that: six of
        // these.
        assert!((x - centre.0).abs() < 2.4e-3 && (y - centre.1).abs() < 2.4e-3, "{x} {y}, not {centre:?}");
    }
}

#[test]
fn every_disc_that_a_lens_makes_larger_or_smaller_is_found_between_the_two_rims() {
    // Black and white as in the paper: at the rim the disc that is reckoned with and the one that is seen are all of the grey
    // levels apart, hundreds of deviations.
    let variables = Variables::default();
    let mut random = Random(99);
    for radius in [4.3, 4.5, 4.8, 5.0, 5.3, 5.6, 5.9, 6.2] {
        for _ in 0..300 {
            let mut near = |x: f64, reach: f64| x + random.between(-reach, reach);
            let centre = (near(24.0, 0.5), near(24.0, 0.5));
            let start = (near(centre.0, 0.1), near(centre.1, 0.1));
            let (x, y) = refined(&variables, &disc(&variables, centre, radius), ALL, start);
            // Were it off by all that the radii differ by, the rims would touch on one side; by nothing, they would be apart
            // alike all around, which is likeliest but for the grid of pixels. Half of the way is allowed.
            let off = (x - centre.0).hypot(y - centre.1);
            assert!(off < 0.5 * (radius - 5.12).abs(), "{radius} at {centre:?} from {start:?}: off by {off}");
        }
    }
}

#[test]
fn every_quarter_of_a_disc_is_enough() {
    // What a quarter says of x and of y depends on one another: without that Newton's steps go astray.
    let variables = grey();
    let centre = (24.3, 23.6);
    let picture = disc(&variables, centre, 5.12);
    let quarters = [
        Area { x0: 24, y0: 0, x1: SIZE, y1: 24 },
        Area { x0: 0, y0: 0, x1: 24, y1: 24 },
        Area { x0: 0, y0: 24, x1: 24, y1: SIZE },
        Area { x0: 24, y0: 24, x1: SIZE, y1: SIZE },
    ];
    for window in quarters {
        for (dx, dy) in [(0.2, 0.2), (0.2, -0.2), (-0.25, 0.0), (0.0, 0.25)] {
            let (x, y) = refined(&variables, &picture, window, (centre.0 + dx, centre.1 + dy));
            // As above with fewer pixels, along the line on which a quarter says least.
            assert!((x - centre.0).hypot(y - centre.1) < 5e-3, "{window:?} {dx} {dy}: {x} {y}");
        }
    }
}

#[test]
fn every_pixel_at_the_rim_pulls_even_if_it_tells_of_one_direction_only() {
    let variables = grey();
    let centre = (24.5, 24.5);
    for (column, row, along) in
        [(29, 24, (1.0, 0.0)), (19, 24, (-1.0, 0.0)), (24, 29, (0.0, 1.0)), (24, 19, (0.0, -1.0))]
    {
        let mut picture = disc(&variables, centre, 5.12);
        picture.row_mut(row)[column] += 40;
        let (x, y) = refined(&variables, &picture, ALL, centre);
        let (dx, dy) = (x - centre.0, y - centre.1);
        // The information of the disc about a direction is half the outline times the contrast squared, a little less where
        // the rim's pixels share it: π r · 190² · 0.8; the pixel's slope is 190.
        let expected = 40.0 * 190.0 / (core::f64::consts::PI * 5.12 * 190.0 * 190.0 * 0.8);
        let (on, beside) = (dx * along.0 + dy * along.1, dx * along.1 + dy * along.0);
        assert!(
            (on / expected - 1.0).abs() < 0.4 && beside.abs() < 0.1 * expected,
            "{dx} {dy}, not {expected}"
        );
    }
}

#[test]
fn every_start_stays_where_what_is_seen_is_no_disc() {
    // Ten times as bright as the scene says: the steps would be ten times as long as they should be.
    let mut variables = grey();
    let picture = disc(&variables, (24.5, 24.5), 5.12);
    (variables.scene.foreground, variables.scene.background) = (49.0, 30.0);
    for start in [(24.1, 24.5), (24.9, 24.5), (24.5, 24.1), (24.5, 24.9)] {
        assert_eq!(refined(&variables, &picture, ALL, start), start);
    }
}

#[test]
fn law_what_was_looked_at_before_changes_nothing() {
    let (small, large) = (grey(), variables(|v| (v.scene.circle_radius, v.scene.foreground) = (0.55, 240.0)));
    let seen = |finder: &mut Finder, variables: &Variables, radius: f64| {
        let mut variables = variables.clone();
        (variables.sensor.estimator, variables.sensor.smallest_area, variables.sensor.largest_area) =
            (2, 1, 10_000);
        let picture = disc(&variables, (23.9, 24.2), radius);
        let mut mask = Mask::empty(SIZE, SIZE);
        for y in 0..SIZE {
            for (x, _) in picture.row(y).iter().enumerate().filter(|(_, grey)| **grey >= 128) {
                mask.words[y * mask.stride + x / 32] |= 1 << (x % 32);
            }
        }
        let view = View { picture: &picture, mask: &mask, windows: &[ALL], row_step: 1 };
        finder.find(&view, &variables.scene, &variables.sensor, &variables.effects).to_vec()
    };
    let mut used = Finder::default();
    for (variables, radius) in [(&large, 14.08), (&small, 5.12), (&small, 5.12), (&large, 14.08)] {
        let alone = seen(&mut Finder::default(), variables, radius);
        assert_eq!(alone.len(), 1);
        assert_eq!(seen(&mut used, variables, radius), alone, "radius {radius}");
    }
}
