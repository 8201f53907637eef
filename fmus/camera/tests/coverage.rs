//! Pixels are covered as much as the exact outline covers them, and centroids scatter as those of a true disc.

use crate::common::*;
use camera::Variables;
use camera::photometry::{FrameMaker, Shot};
use camera::scene::Pose;

fn maker(variables: &Variables) -> FrameMaker {
    FrameMaker::new(&variables.scene, &variables.sensor, &variables.effects).expect("legal parameters")
}

fn shot(centres: &[[(f64, f64); 3]]) -> Shot<'_> {
    Shot { k: 0, seed: 0, centres_world: centres, whole: true }
}

/// Covered share of each pixel, from the base.
fn coverage(maker: &FrameMaker) -> Vec<f64> {
    let base = maker.base();
    (0..base.height)
        .flat_map(|y| base.row(y).iter().map(|parts| f64::from(*parts) / (64.0 * 255.0)))
        .collect()
}

/// Brute force: the share of 48 x 48 points of a pixel whose ideal image lies in a circle. The inverse of the lens by
/// fixed-point iteration, which knows nothing of outlines.
fn supersampled(variables: &Variables, centres: [(f64, f64); 3], x: usize, y: usize) -> f64 {
    const N: usize = 48;
    let effects = &variables.effects;
    let mut inside = 0;
    for i in 0..N {
        for j in 0..N {
            let u = (x as f64 + (i as f64 + 0.5) / N as f64) / 256.0 - 1.0;
            let v = 1.0 - (y as f64 + (j as f64 + 0.5) / N as f64) / 256.0;
            let (mut a, mut b) = (u, v);
            for _ in 0..30 {
                let (c, d) = effects.distorted(a, b);
                (a, b) = (a + u - c, b + v - d);
            }
            let r2 = variables.scene.circle_radius * variables.scene.circle_radius;
            let hit = |c: &(f64, f64)| (10.0 * a - c.0).powi(2) + (10.0 * b - c.1).powi(2) <= r2;
            inside += usize::from(centres.iter().any(hit));
        }
    }
    inside as f64 / (N * N) as f64
}

#[test]
fn value_pixels_are_covered_exactly() {
    let lenses: [fn(&mut Variables); 4] = [
        |_| (),
        |v| v.effects.radial.cubic = 0.2,
        |v| v.effects.decentering.vertical = 0.1,
        |v| (v.effects.thin_prism.horizontal, v.effects.radial.cubic) = (0.1, -0.15),
    ];
    let mut worst: f64 = 0.0;
    for lens in lenses {
        let variables = variables(lens);
        let mut maker = maker(&variables);
        for q2 in [-1.3, 0.37, 2.1] {
            let centres =
                variables.scene.centres_world(Pose { link1_angle: manifold(q2) + 0.003, link2_angle: q2 });
            maker.render(shot(&[centres]));
            let found = coverage(&maker);
            let windows = maker.windows().to_vec();
            for window in windows {
                for y in window.y0..window.y1 {
                    for x in window.x0..window.x1 {
                        let error = found[y * 512 + x] - supersampled(&variables, centres, x, y);
                        worst = worst.max(error.abs());
                    }
                }
            }
        }
    }
    // Issue 2 asks for 0.01. The polygon may be off by 0.002, the samples by about 0.5 · 48^-1.5 · a few = 0.004.
    println!("largest error of a pixel {worst:.4}");
    assert!(worst < 0.0065, "{worst}");
}

/// Exact area of the part of a disc about (cx, cy) in a pixel, by integrating chords: independent of polygons.
fn disc_in_pixel(cx: f64, cy: f64, r: f64, x: f64, y: f64) -> f64 {
    let n = 20_000;
    let mut area = 0.0;
    for i in 0..n {
        let px = x + (f64::from(i) + 0.5) / f64::from(n) - cx;
        if px.abs() < r {
            let half = (r * r - px * px).sqrt();
            area += ((cy + half).min(y + 1.0) - (cy - half).max(y)).max(0.0);
        }
    }
    area / f64::from(n)
}

#[test]
fn value_an_undistorted_disc_is_covered_to_a_fifth_percent() {
    let mut random = Random(7);
    let mut maker = maker(&Variables::default());
    let mut worst: f64 = 0.0;
    for _ in 0..20 {
        let centre = (random.between(-5.0, 5.0), random.between(-5.0, 5.0));
        // The other two circles are outside the picture.
        maker.render(shot(&[[centre, (30.0, 0.0), (0.0, -30.0)]]));
        let (cx, cy, r) = (256.0 + 25.6 * centre.0, 256.0 - 25.6 * centre.1, 5.12);
        let found = coverage(&maker);
        for y in (cy - 7.0) as usize..(cy + 7.0) as usize {
            for x in (cx - 7.0) as usize..(cx + 7.0) as usize {
                let error = found[y * 512 + x] - disc_in_pixel(cx, cy, r, x as f64, y as f64);
                worst = worst.max(error.abs());
            }
        }
        let total: f64 = found.iter().sum();
        let exact = core::f64::consts::PI * r * r;
        // About 100 pixels, each rounded to 1/16320.
        assert!((total - exact).abs() < 2e-3, "{total} {exact}");
    }
    println!("largest error of a pixel {worst:.5}");
    // The outline's own bound, and rounding to 1/64 grey level.
    assert!(worst < camera::geometry::outline::COVERAGE_ERROR + 1e-4, "{worst}");
}

#[test]
fn law_a_circle_at_the_border_is_cut_there() {
    // The part within the picture is that of the same circle in a larger picture with the same pixels.
    let small = Variables::default();
    let large = variables(|v| {
        (v.sensor.width, v.sensor.height) = (1024, 1024);
        v.scene.field_of_view = 40.0;
    });
    let (mut small, mut large) = (maker(&small), maker(&large));
    let mut random = Random(8);
    for _ in 0..50 {
        let mut edge = || random.between(9.7, 10.3) * if random.uniform() < 0.5 { -1.0 } else { 1.0 };
        let (a, b) = (edge(), edge());
        let centres = [[(a, random.between(-10.2, 10.2)), (random.between(-10.2, 10.2), b), (a, b)]];
        small.render(shot(&centres));
        large.render(shot(&centres));
        for y in 0..512 {
            for (found, expected) in small.base().row(y).iter().zip(&large.base().row(y + 256)[256..]) {
                // Single precision at twice the distance from the corner: 3e-5 px, less than a part in 16320.
                assert!((found - expected).abs() <= 8, "{found} {expected} in row {y}");
            }
        }
    }
}

#[test]
fn value_large_circles_are_covered_exactly() {
    // Edges of several pixels go the general way: the area of a disc of 100 px radius.
    for (radius, (width, height)) in [(3.90625, (512, 512)), (2.0, (300, 800))] {
        let variables = variables(|v| {
            v.scene.circle_radius = radius;
            (v.sensor.width, v.sensor.height) = (width, height);
        });
        let mut maker = maker(&variables);
        maker.render(shot(&[[(0.3, -0.2), (60.0, 0.0), (0.0, 60.0)]]));
        let total: f64 = coverage(&maker).iter().sum();
        let exact = core::f64::consts::PI * radius * radius / 400.0 * f64::from(width) * f64::from(height);
        assert!((total / exact - 1.0).abs() < 1e-5, "{total} {exact}");
    }
}

#[test]
fn value_large_circles_behind_a_lens_are_covered_exactly() {
    // Circles of 40 and 80 px, whose outlines are mapped vertex by vertex; the others are out of sight.
    let lenses: [fn(&mut Variables); 3] = [
        |v| v.effects.radial.cubic = 0.15,
        |v| (v.effects.decentering.vertical, v.effects.thin_prism.horizontal) = (0.05, -0.05),
        |v| v.effects.decentering.horizontal = 0.08,
    ];
    for (lens, radius) in lenses.into_iter().zip([1.6, 3.1, 1.6]) {
        let variables = variables(|v| {
            lens(v);
            v.scene.circle_radius = radius;
        });
        let mut maker = maker(&variables);
        let centres = [(2.3, -3.1), (300.0, 0.0), (0.0, 300.0)];
        maker.render(shot(&[centres]));
        let found = coverage(&maker);
        let (mut edge, mut worst) = (0, 0.0_f64);
        for y in (0..512).step_by(3) {
            for x in (0..512).step_by(3) {
                // On the edge, and now and then inside and outside.
                let here = found[y * 512 + x];
                if (here > 0.0 && here < 1.0) || (x + y) % 41 == 0 {
                    edge += u32::from(here > 0.0 && here < 1.0);
                    worst = worst.max((here - supersampled(&variables, centres, x, y)).abs());
                }
            }
        }
        assert!(edge > 30, "{edge}");
        // As above; among ten times as many pixels the samples are off by more.
        assert!(worst < 0.01, "{worst}");
    }
}

#[test]
fn value_an_exposure_is_the_mean_over_the_motion() {
    // Sub-frames a quarter of a pixel apart against forty times as many, for the fastest circle 4 px.
    let scene = Variables::default().scene;
    let mean = |n: usize| {
        let mut maker = maker(&Variables::default());
        let at = |i: usize| {
            let share = (i as f64 + 0.5) / n as f64;
            scene.centres_world(Pose { link1_angle: 0.02 - 0.003 * share, link2_angle: 0.5 + 0.022 * share })
        };
        maker.render(shot(&(0..n).map(at).collect::<Vec<_>>()));
        coverage(&maker)
    };
    let worst = largest(mean(16).into_iter().zip(mean(640)).map(|(a, b)| a - b));
    println!("largest error of a pixel {worst:.4}");
    // The outline's own error, and the midpoint rule over steps of 0.25 px.
    assert!(worst < 0.01, "{worst}");
}

#[test]
fn value_binary_centroids_scatter_as_a_true_discs() {
    // Issue 2: at a 50 % threshold 0.081 px rms per axis (± 5 %) and 82 px; at the nominal threshold 75 ± 1 px.
    for (threshold, scatter, area, area_tolerance) in
        [(128.0, Some(0.081), 82.35, 0.35), (191.0, None, 75.0, 1.0)]
    {
        let base = variables(|v| v.sensor.threshold = threshold);
        let mut random = Random(42);
        let (mut errors, mut areas, mut n) = (Vec::new(), 0.0, 0.0);
        for _ in 0..4000 {
            let (q1, q2) = (random.between(-0.4, 0.4), random.between(-2.0, 2.0));
            let out = still(&base, q1, q2);
            assert!(out.valid, "{q1} {q2} {threshold}");
            let centres = base.scene.centres_world(Pose { link1_angle: q1, link2_angle: q2 });
            // Circle 1 never leaves its row; circles 2 and 3 are at random places in the grid.
            errors.extend([out.u2_px - 25.6 * centres[1].0, out.v2_px - 25.6 * centres[1].1]);
            errors.extend([out.u3_px - 25.6 * centres[2].0, out.v3_px - 25.6 * centres[2].1]);
            areas += out.area2 + out.area3;
            n += 2.0;
        }
        let found = rms(errors.into_iter());
        println!("threshold {threshold}: {found:.4} px rms, {:.2} px", areas / n);
        if let Some(scatter) = scatter {
            assert!((found / scatter - 1.0).abs() < 0.05, "{found}");
        }
        assert!((areas / n - area).abs() < area_tolerance, "{}", areas / n);
    }
}

#[test]
fn cross_a_frame_has_outlines_of_as_many_vertices_as_its_circles_need() {
    use camera::geometry::{Outline, UnitCircle};
    use camera::photometry::Coverage;
    // Radii in pixels of the larger side: 0.2 of 20 world units of 512 px, and what scale and lens add. For k1 = 0.1 the
    // picture is larger by the root of 2 in a corner.
    let settings: [(Change, f64); 5] = [
        (|_| (), 5.12),
        (|v| v.scene.field_of_view = 40.0, 2.56),
        (|v| v.effects.placement.scale = 1.7, 1.7 * 5.12),
        (|v| (v.sensor.width, v.sensor.height, v.scene.circle_radius) = (300, 400, 0.6), 12.0),
        (|v| v.effects.radial.cubic = 0.1, 5.12 * core::f64::consts::SQRT_2),
    ];
    for (change, radius_px) in settings {
        let variables = variables(change);
        let (width, height) = (variables.sensor.width as usize, variables.sensor.height as usize);
        let mut maker = maker(&variables);
        let centres = variables.scene.centres_world(Pose { link1_angle: 0.11, link2_angle: -0.31 });
        maker.render(shot(&[centres]));
        let found = coverage(&maker);
        // 1e-3 more for how the magnification is found, by differences over 1e-3.
        let [circle, other] = [1.0, 1.001].map(|more| UnitCircle::for_radius_px(more * radius_px));
        assert_eq!(circle.len(), other.len(), "{radius_px}: between two numbers");
        let (mut outline, mut expected) = (Outline::default(), Coverage::default());
        for centre in centres {
            outline.add(&circle, centre, variables.scene.circle_radius, maker.projection());
        }
        expected.begin(width, height);
        for (xs, ys) in outline.xs.chunks(circle.len()).zip(outline.ys.chunks(circle.len())) {
            expected.add(xs, ys, (0.0, 0.0), true);
        }
        expected.finish(1.0);
        for y in 0..height {
            for (found, share) in found[y * width..][..width].iter().zip(expected.row(y)) {
                // Single precision relative to the box instead of the frame, 3e-5 px, and half a part of 16320; polygons
                // of other numbers of vertices differ by up to COVERAGE_ERROR.
                assert!((found - f64::from(*share)).abs() < 1.5e-4, "{radius_px}: {found} {share}");
            }
        }
    }
}

#[test]
fn cross_a_circle_that_a_mounting_shows_larger_than_was_reckoned_with_is_covered_as_well() {
    use camera::geometry::{Outline, UnitCircle};
    use camera::photometry::Coverage;
    // A short lens that looks aside shows the near side 3.3 times as large: edges are 3 px long.
    let variables = variables(|v| {
        (v.sensor.focal_length, v.effects.mounting.pan, v.scene.circle_radius) = (0.5, 0.8, 0.48);
    });
    let mut maker = maker(&variables);
    let centre = (-1.0, 0.7);
    maker.render(shot(&[[centre, (-400.0, 0.0), (-400.0, 0.0)]])); // the others are behind it
    let circle = UnitCircle::for_radius_px(25.6 * 0.48);
    let (mut outline, mut expected) = (Outline::default(), Coverage::default());
    outline.add(&circle, centre, 0.48, maker.projection());
    assert!(outline.longest_edge > 2.0, "{}", outline.longest_edge);
    expected.begin(512, 512);
    expected.add(&outline.xs, &outline.ys, (0.0, 0.0), false);
    expected.finish(1.0);
    let found = coverage(&maker);
    let mut total = 0.0;
    for (found, share) in found.chunks(512).enumerate().flat_map(|(y, row)| row.iter().zip(expected.row(y))) {
        // Half a part of 16320, and single precision relative to the box instead of the frame.
        assert!((found - f64::from(*share)).abs() < 1.5e-4, "{found} {share}");
        total += found;
    }
    // The near side is 3.3 times as large along u, and 1.8 times along v.
    assert!(total > 4.0 * core::f64::consts::PI * (25.6_f64 * 0.48).powi(2), "{total}");
}
