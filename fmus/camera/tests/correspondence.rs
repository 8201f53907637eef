//! Which region is which circle: found from nothing wherever the robot may stand, and never wrong.

use crate::common::*;
use camera::Variables;
use camera::scene::Pose;

/// The lenses of Section 4.1.2 at their strongest, with areas let through.
const LENSES: [(&str, Change); 12] = [
    ("none", |_| ()),
    ("k1", |v| v.effects.radial.cubic = 0.2),
    ("-k1", |v| v.effects.radial.cubic = -0.3),
    ("p1", |v| v.effects.decentering.horizontal = 0.1),
    ("-p1", |v| v.effects.decentering.horizontal = -0.1),
    ("p2", |v| v.effects.decentering.vertical = 0.1),
    ("-p2", |v| v.effects.decentering.vertical = -0.1),
    ("s1", |v| v.effects.thin_prism.horizontal = 0.1),
    ("s2", |v| v.effects.thin_prism.vertical = 0.1),
    ("-s2", |v| v.effects.thin_prism.vertical = -0.1),
    ("mounting", |v| {
        (v.effects.mounting.roll, v.effects.mounting.pan, v.effects.mounting.tilt) = (0.1, 0.05, 0.05)
    }),
    ("principal point", |v| (v.effects.placement.centre_u, v.effects.placement.centre_v) = (0.05, -0.05)),
];

#[test]
fn every_lens_is_identified_from_the_first_frame_and_never_wrongly() {
    for (name, lens) in LENSES {
        let base = variables(|v| {
            lens(v);
            (v.sensor.smallest_area, v.sensor.largest_area) = (15, 200);
        });
        let (mut found, mut n) = (0, 0);
        for i in -47..=47 {
            let q2 = 2.35 * f64::from(i) / 47.0;
            let (q1, out) = (manifold(q2), still(&base, manifold(q2), q2));
            n += 1;
            if out.valid {
                found += 1;
                // A wrong assignment is off by a radian; the strongest lens by 0.3 rad.
                let error = (out.link1_angle - q1).abs().max((out.link2_angle - q2).abs());
                assert!(error < 0.35, "{name}: off by {error} at q2 = {q2}");
            }
        }
        println!("{name}: {found} of {n}");
        // The strongest lens leaves 75 of 95; an ordinary one finds nearly all.
        assert!(found * 100 >= n * 78, "{name}: {found} of {n}");
    }
}

#[test]
fn every_camera_that_is_turned_aside_shows_the_right_circles_or_none() {
    let across = (-10..=10).map(|i| (0.005 * f64::from(i), 0.0, 0.0));
    let more = [(0.03, 0.02, 0.0), (0.0, 0.0, 0.08), (0.04, -0.03, -0.02), (-0.04, 0.03, 0.02)];
    for (pan, tilt, u0) in across.chain(more) {
        let base = variables(|v| {
            (v.effects.mounting.pan, v.effects.mounting.tilt) = (pan, tilt);
            v.effects.placement.centre_u = u0;
        });
        let (mut found, mut n) = (0, 0);
        for i in -94..=94 {
            let q2 = 2.35 * f64::from(i) / 94.0;
            let (q1, out) = (manifold(q2), still(&base, manifold(q2), q2));
            n += 1;
            if out.valid {
                found += 1;
                let error = (out.link1_angle - q1).abs().max((out.link2_angle - q2).abs());
                // A wrong assignment is off by a radian; the mounting by 0.02 rad.
                assert!(error < 0.1, "pan {pan}, tilt {tilt}, u0 {u0}: off by {error} at q2 = {q2}");
            }
        }
        // The strongest of them leave 165.
        println!("pan {pan}, tilt {tilt}, u0 {u0}: {found} of {n}");
        assert!(found * 10 >= n * 8, "pan {pan}: {found} of {n}");
    }
}

#[test]
fn every_turned_mount_that_the_vision_knows_of_shows_the_same_angles() {
    // a disc of 5 px on another lattice: its centroid lies up to 0.15 px elsewhere, links are 160 px long and more
    const SAME: f64 = 3e-3;
    let upright = variables(|_| ());
    for turned in [-1.2, 0.7, std::f64::consts::FRAC_PI_2, 3.1] {
        let mut other = variables(|_| ());
        other.effects.mounting.roll = turned;
        other.sensor.mount = turned;
        for (q1, q2) in [(0.0, 0.0), (-0.05, 0.1), (0.3, -0.6)] {
            let (here, there) = (still(&upright, q1, q2), still(&other, q1, q2));
            assert!(here.valid && there.valid, "{turned} {q1} {q2}");
            let apart = (here.link1_angle - there.link1_angle)
                .abs()
                .max((here.link2_angle - there.link2_angle).abs());
            assert!(apart < SAME, "{turned}: {apart}");
        }
    }
}

#[test]
fn every_pose_is_identified_rightly_or_not_at_all() {
    let base = Variables::default();
    let mut random = Random(3);
    let (mut found, mut n) = (0, 0);
    for _ in 0..3000 {
        let (q1, q2) = (random.between(-1.2, 1.2), random.between(-2.35, 2.35));
        let [_, _, tip] = base.scene.centres_world(Pose { link1_angle: q1, link2_angle: q2 });
        if tip.0.abs() > 9.7 || tip.1 < -8.0 {
            continue; // outside the picture, or in the ground
        }
        n += 1;
        let out = still(&base, q1, q2);
        if out.valid {
            found += 1;
            let error = (out.link1_angle - q1).abs().max((out.link2_angle - q2).abs());
            // Quantisation alone; the largest on the manifold is 1.24e-3.
            assert!(error < 2.5e-3, "off by {error} at {q1} {q2}");
        }
    }
    println!("{found} of {n}");
    // A few near-symmetric ones are not identified.
    assert!(found > n * 90 / 100, "{found} of {n}");
}

#[test]
fn every_circle_that_the_edge_cuts_is_not_valid() {
    for (interlaced, side) in [(false, 1.0), (false, -1.0), (true, 1.0)] {
        let base = variables(|v| v.sensor.interlaced = interlaced);
        let q1 = 0.5 * side;
        let joint = base.scene.centres_world(Pose { link1_angle: q1, link2_angle: 0.0 })[1];
        let (mut whole, mut cut) = (0, 0);
        for i in 0..48 {
            let x = side * (9.3 + 0.02 * f64::from(i));
            let q2 = ((x - joint.0) / base.scene.link2_length).asin();
            let out = still(&base, q1, q2);
            let reach = x.abs() + base.scene.circle_radius;
            if out.valid {
                whole += 1;
                // Half a pixel's worth of rows in a field.
                assert!((out.u3_px - 25.6 * x).abs() < 0.5, "off by {} px at x = {x}", out.u3_px - 25.6 * x);
                // The edge is at 10. A pixel's width of the disc may be beyond it and not fill a pixel at the edge.
                assert!(reach < 10.04, "cut, at x = {x}");
            } else {
                cut += 1;
                // The outermost column of pixels begins at 9.96.
                assert!(reach > 9.96, "whole, at x = {x}");
            }
        }
        assert!(whole > 10 && cut > 10, "{whole} whole, {cut} cut");
    }
}
