//! Limits to the last pixel, odd sensors, resets: what a small fault in the code would slip through elsewhere.

use crate::common::*;
use camera::vision::{Feature, correspondence};
use camera::{Camera, Variables};
use fmi2_export::{Model, ModelError};

/// Outputs of three frames of a moving robot.
fn watched(camera: &mut Camera, variables: &mut Variables) -> Vec<camera::variables::Outputs> {
    camera.initialize(variables, &EXPERIMENT, &mut Silent).expect("these parameters are legal");
    (0..60)
        .map(|k| {
            let (from, to) = (f64::from(k) / 600.0, f64::from(k + 1) / 600.0);
            step_to(camera, variables, from, to, [0.1 * to, 0.3 - 0.2 * to, 0.1, -0.2]);
            variables.outputs.clone()
        })
        .collect()
}

#[test]
fn every_reset_leaves_nothing_of_a_changed_parameter_or_of_a_queued_result() {
    let fresh = watched(&mut Camera::default(), &mut Variables::default());
    let changes: [Change; 14] = [
        |v| v.sensor.threshold = 100.0,
        |v| v.sensor.smallest_area = 120,
        |v| v.sensor.delay = 0.09, // two results are on their way at the end
        |v| v.sensor.exposure_factor = 1.0,
        |v| v.sensor.frame_rate = 60.0,
        |v| v.sensor.interlaced = true,
        |v| v.sensor.estimator = 1,
        |v| (v.sensor.width, v.sensor.height) = (400, 600),
        |v| v.scene.foreground = 220.0,
        |v| v.scene.circle_radius = 0.22,
        |v| v.effects.noise.deviation = 15.0,
        |v| v.effects.defocus.passes = 2,
        |v| v.effects.radial.cubic = 0.1,
        |v| v.effects.mounting.pan = 0.03,
    ];
    for (place, change) in changes.into_iter().enumerate() {
        let mut changed = variables(change);
        let mut camera = Camera::default();
        assert_ne!(watched(&mut camera, &mut changed), fresh, "change {place} is seen");
        let mut again = camera.renewed(); // what fmi2Reset does
        assert_eq!(watched(&mut again, &mut Variables::default()), fresh, "change {place}");
    }
}

#[test]
fn cross_a_long_exposure_over_many_steps_is_that_of_one_step() {
    let seen = |steps: u32| {
        let mut variables = variables(|v| {
            v.sensor.exposure_factor = 1.0;
            v.sensor.estimator = 1;
            (v.inputs.link1_rate, v.inputs.link2_rate) = (0.2, 0.3);
        });
        let mut camera = started(&mut variables);
        for k in 0..steps {
            let at = |k: u32| f64::from(k) / f64::from(steps) / 30.0;
            // Along a line, which a cubic through any of its points is.
            let pose = |t: f64| [0.2 * t, 0.3 * t, 0.2, 0.3];
            step_to(&mut camera, &mut variables, at(k), at(k + 1), pose(at(k + 1)));
        }
        assert!(variables.outputs.valid && variables.outputs.frame == 2, "{:?}", variables.outputs);
        variables.outputs
    };
    // The same line but for rounding; the grey centroid moves with the grey levels of single pixels.
    let (one, more) = (seen(1), seen(60));
    assert!((one.u3_px - more.u3_px).abs() < 1e-3, "{} {}", one.u3_px, more.u3_px);
    assert!(
        (more.u3_px - 25.6 * (6.19 * (0.2_f64 / 60.0).sin() + 0.2 / 60.0 + 6.9 * (0.3_f64 / 60.0).sin()))
            .abs()
            < 0.1
    );
}

#[test]
fn value_sensors_that_are_not_square_show_the_same_angles() {
    for (width, height) in [(768, 512), (512, 800), (640, 480)] {
        let base = variables(|v| {
            (v.sensor.width, v.sensor.height) = (width, height);
            (v.sensor.smallest_area, v.sensor.largest_area) = (20, 300);
        });
        for (q1, q2) in [(0.0, 0.0), (-0.2, 0.5), (0.3, -0.6)] {
            let out = still(&base, q1, q2);
            assert!(out.valid, "{width} x {height}");
            let error = (out.link1_angle - q1).abs().max((out.link2_angle - q2).abs());
            // Centroids to 0.15 px on links of 150 px and more, at both ends.
            assert!(error < 2.5e-3, "{width} x {height}: off by {error} at {q1} {q2}");
        }
    }
}

#[test]
fn value_rates_go_on_through_half_a_turn() {
    // A pinned robot in the middle of the picture whose links turn at 3 rad/s, through the straight-down.
    let mut variables = variables(|v| {
        (v.scene.drum_radius, v.scene.ground_height) = (0.0, 0.0);
        (v.scene.link1_length, v.scene.link2_length) = (4.0, 3.0);
    });
    for direction in [1.0, -1.0] {
        let pose = |t: f64| {
            [direction * (2.8 + 3.0 * t), direction * (2.6 + 3.0 * t), 3.0 * direction, 3.0 * direction]
        };
        [variables.inputs.link1_angle, variables.inputs.link2_angle, ..] = [pose(0.0)[0], pose(0.0)[1]];
        let mut camera = started(&mut variables);
        let mut wrapped = false;
        for k in 0..10 {
            let (from, to) = (f64::from(k) / 30.0, f64::from(k + 1) / 30.0);
            step_to(&mut camera, &mut variables, from, to, pose(to));
            let out = &variables.outputs;
            assert!(out.valid);
            wrapped |= out.link1_angle * direction < 0.0;
            for rate in [out.link1_rate, out.link2_rate] {
                // 0.15 px at each end of a link of 77 px, over a thirtieth of a second.
                assert!((rate - 3.0 * direction).abs() < 0.12, "{rate} at frame {k}");
            }
        }
        assert!(wrapped, "it went through half a turn");
    }
}

#[test]
fn value_the_principal_point_is_added_after_the_scale() {
    let base = variables(|v| {
        let placement = &mut v.effects.placement;
        (placement.scale, placement.centre_u, placement.centre_v) = (0.8, 0.05, -0.03);
    });
    let projection = Camera::projection(&base).expect("usable");
    for (x, y) in [(0.0, 0.0), (3.0, -5.0), (-7.0, 2.0)] {
        let (column, row) = projection.raster_from_world((x, y)).expect("before the camera");
        let expected = (256.0 * (1.0 + 0.8 * x / 10.0 + 0.05), 256.0 * (1.0 - 0.8 * y / 10.0 + 0.03));
        assert!((column - expected.0).abs() < 1e-10 && (row - expected.1).abs() < 1e-10, "{column} {row}");
    }
}

#[test]
fn every_area_of_exactly_n_min_and_n_max_is_a_circles() {
    let base = Variables::default();
    let out = still(&base, -0.2, 0.5);
    let areas = [out.area1, out.area2, out.area3].map(|area| area as i32);
    let (least, most) = (*areas.iter().min().expect("three"), *areas.iter().max().expect("three"));
    let valid = |smallest, largest| {
        still(
            &{
                let mut variables = base.clone();
                (variables.sensor.smallest_area, variables.sensor.largest_area) = (smallest, largest);
                variables
            },
            -0.2,
            0.5,
        )
        .valid
    };
    assert!(valid(least, most));
    assert!(!valid(least + 1, most.max(least + 1)) && !valid(least.min(most - 1), most - 1));
}

#[test]
fn every_circle_is_followed_within_half_the_smallest_separation() {
    let at = |u: f64, v: f64| Feature { centre_px: (u, v), area_px: 75.0 };
    let last = [at(0.0, 0.0), at(0.0, 100.0), at(80.0, 100.0)]; // the last two are 80 apart
    for (moved, found) in [(39.9, true), (40.0, false), (40.1, false)] {
        for (circle, (du, dv)) in [(0, (0.0, -1.0)), (1, (-1.0, 0.0)), (2, (1.0, 0.0)), (2, (0.6, 0.8))] {
            let mut now = last;
            let (u, v) = now[circle].centre_px;
            now[circle] = at(u + du * moved, v + dv * moved);
            let seen = correspondence::nearest(&[now[2], now[0], now[1]], &last);
            assert_eq!(seen, found.then_some(now), "circle {circle} moved by {moved}");
        }
    }
    assert_eq!(correspondence::nearest(&last[..2], &last), None, "one is missing");
}

#[test]
fn value_the_fold_lies_on_one_side_where_the_lens_is_decentred() {
    let images = |change: Change, at: (f64, f64)| {
        Camera::projection(&variables(change)).map(|projection| projection.images(at))
    };
    // Radial: d(r + k1 r³)/dr = 0 at r = 1.0541, in every direction.
    let radial: Change = |v| v.effects.radial.cubic = -0.3;
    for (at, inside) in
        [((1.05, 0.0), true), ((1.06, 0.0), false), ((-0.742, 0.742), true), ((0.75, -0.75), false)]
    {
        assert_eq!(images(radial, at), Ok(inside), "{at:?}");
    }
    // Along v = 0 the Jacobian is (1 + 6 p1 u)(1 + 2 p1 u): 0 at u = 1.6667 for p1 = -0.1, and not on the other side.
    let decentred: Change = |v| v.effects.decentering.horizontal = -0.1;
    for (at, inside) in [((1.66, 0.0), true), ((1.68, 0.0), false), ((-1.68, 0.0), true), ((-4.0, 0.0), true)]
    {
        assert_eq!(images(decentred, at), Ok(inside), "{at:?}");
    }
    let folded: Result<bool, ModelError> = images(|v| v.effects.decentering.horizontal = -0.2, (0.0, 0.0));
    assert!(folded.is_err(), "it folds at u = 0.8333");
}

#[test]
fn every_word_of_the_description_is_committed() {
    let committed = include_str!("../../../modelDescriptions/acrobot_camera.xml");
    assert!(fmi2_export::description::Unit::of::<Camera>().xml() == committed, "stale: cargo xtask pack");
}
