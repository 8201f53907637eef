//! Each effect: the identity at its neutral value, and alone changing only what it claims.

use crate::common::*;
use camera::Variables;
use camera::effects::{Effects, Lens};
use camera::geometry::Projection;
use camera::photometry::{FrameMaker, Shot};
use camera::scene::Pose;
use fmi2_export::{Kind, ModelError, SlotMut, Table};

fn projection(effects: &Effects) -> Result<Projection, ModelError> {
    let variables = Variables::default();
    Projection::new(&variables.scene, &variables.sensor, effects)
}

fn effects(change: impl Fn(&mut Effects)) -> Effects {
    let mut effects = Effects::default();
    change(&mut effects);
    effects
}

/// All parameters that are effects, at a value that shows.
fn strengths() -> Vec<(&'static str, f64)> {
    vec![
        ("roll", 0.05),
        ("pan", 0.05),
        ("tilt", 0.05),
        ("k1", 0.1),
        ("k2", 0.1),
        ("p1", 0.05),
        ("p2", 0.05),
        ("s1", 0.05),
        ("s2", 0.05),
        ("scale", 1.05),
        ("u0", 0.05),
        ("v0", 0.05),
        ("beta", 2.0),
        ("N", 1.0),
        ("sigma", 15.0),
        ("drop_rate", 0.5),
    ]
}

fn set(variables: &mut Variables, name: &str, value: f64) {
    let index = Variables::variables().iter().position(|v| v.name == name).expect("the name is in the table");
    match variables.get_mut(index) {
        Some(SlotMut::Real(slot)) => *slot = value,
        Some(SlotMut::Integer(slot)) => *slot = value as i32,
        other => panic!("{name}: {other:?}"),
    }
}

fn frame(variables: &Variables) -> (Vec<i16>, Vec<u8>) {
    let mut maker = FrameMaker::new(&variables.scene, &variables.sensor, &variables.effects).expect("legal");
    let centres = variables.scene.centres_world(Pose { link1_angle: 0.123, link2_angle: -0.987 });
    maker.render(Shot { k: 3, seed: 0, centres_world: &[centres], whole: true });
    (maker.base().values.clone(), maker.picture().values.clone())
}

#[test]
fn law_every_effect_of_the_table_is_tested_here() {
    let declared: Vec<&str> = Variables::variables().iter().filter(|v| v.is_effect).map(|v| v.name).collect();
    let tested: Vec<&str> = strengths().iter().map(|(name, _)| *name).collect();
    assert_eq!(declared, tested);
}

#[test]
fn law_off_is_the_identity_to_the_bit() {
    let off = Effects::default();
    let mut random = Random(1);
    let rotation = off.mounting.rotation();
    for _ in 0..1000 {
        let (u, v) = (random.between(-2.0, 2.0), random.between(-2.0, 2.0));
        assert_eq!(off.distorted(u, v), (u, v));
        assert_eq!(off.placement.placed((u, v)), (u, v));
        assert_eq!(rotation.camera_from_square([u, v, 20.0]), [u, v, 20.0]);
        assert_eq!(off.sensitivity.gain(u * u + v * v, 2.0), 1.0);
        assert!(!off.loss.takes(3, (u * 1000.0) as i64));
    }
    // An effect switched on and off again leaves the very frame there was, whatever the others are.
    for (name, value) in strengths() {
        let others = variables(|v| {
            for (other, strength) in strengths().into_iter().filter(|(other, _)| *other != name) {
                set(v, other, strength);
            }
        });
        let mut back = others.clone();
        set(&mut back, name, value);
        let changed = frame(&back);
        let table = Variables::variables();
        let declared = table.iter().find(|v| v.name == name).expect("the name is in the table");
        match &declared.kind {
            Kind::Real(start) => set(&mut back, name, *start),
            Kind::Integer(start) => set(&mut back, name, f64::from(*start)),
            other => panic!("{name}: {other:?}"),
        }
        assert_eq!(frame(&back), frame(&others), "{name}");
        if name != "drop_rate" {
            assert_ne!(changed, frame(&others), "{name} does nothing");
        }
    }
}

#[test]
fn law_c2_c3_signs_of_decentering_and_prism() {
    let mut random = Random(2);
    let field = |change: fn(&mut Effects)| {
        let effects = effects(change);
        move |u: f64, v: f64| {
            let a = effects.decentering.displacement(u, v);
            let b = effects.thin_prism.displacement(u, v);
            (a.0 + b.0, a.1 + b.1)
        }
    };
    let (p1, minus_p1) =
        (field(|e| e.decentering.horizontal = 0.1), field(|e| e.decentering.horizontal = -0.1));
    let (p2, minus_p2) = (field(|e| e.decentering.vertical = 0.1), field(|e| e.decentering.vertical = -0.1));
    let (s, minus_s) = (
        field(|e| (e.thin_prism.horizontal, e.thin_prism.vertical) = (0.1, 0.07)),
        field(|e| (e.thin_prism.horizontal, e.thin_prism.vertical) = (-0.1, -0.07)),
    );
    for _ in 0..1000 {
        let (u, v) = (random.between(-1.0, 1.0), random.between(-1.0, 1.0));
        // C2: -p1 mirrors Figure 5 about the vertical axis, -p2 Figure 6 about the horizontal one. Exact.
        let (a, b) = (p1(u, v), minus_p1(-u, v));
        assert_eq!((a.0, a.1), (-b.0, b.1));
        let (a, b) = (p2(u, v), minus_p2(u, -v));
        assert_eq!((a.0, a.1), (b.0, -b.1));
        // C3: the vectors change their sign.
        let (a, b) = (s(u, v), minus_s(u, v));
        assert_eq!((a.0, a.1), (-b.0, -b.1));
    }
}

#[test]
fn law_c1_positive_k1_moves_points_outwards() {
    let effects = effects(|e| e.radial.cubic = 0.1);
    let (u, v) = effects.distorted(0.6, -0.8);
    assert!((u - 0.66).abs() < 1e-15 && (v + 0.88).abs() < 1e-15, "{u} {v}");
}

#[test]
fn value_pinhole_and_pixels() {
    // Half the field of view is one image unit, 256 px: (2.5, -7) is at (64, -179.2) px, whatever f.
    for f in [0.5, 2.0, 7.0] {
        let variables = variables(|v| v.sensor.focal_length = f);
        let projection =
            Projection::new(&variables.scene, &variables.sensor, &variables.effects).expect("legal");
        let ideal = projection.ideal_from_world((2.5, -7.0)).expect("in front of the camera");
        let (u, v) = projection.pixel_from_ideal(ideal);
        assert!((u - 64.0).abs() < 1e-12 && (v + 179.2).abs() < 1e-12, "{u} {v}");
        assert_eq!(projection.raster_from_ideal(ideal), (256.0 + u, 256.0 - v));
    }
}

#[test]
fn value_fold_back_is_refused_where_it_is() {
    let refused = |change: fn(&mut Effects)| match projection(&effects(change)) {
        Err(ModelError::Value { name, expected, .. }) => (name, expected),
        other => panic!("not refused: {other:?}"),
    };
    // Radial: d(r + k1 r³)/dr = 0 at r = sqrt(1/(-3 k1)) = 0.8165 for k1 = -0.5.
    let (name, text) = refused(|e| e.radial.cubic = -0.5);
    assert_eq!(name, "k1");
    assert!(text.contains("radius 0.8165"), "{text}");
    // p1 alone along v = 0: 1 + 6 p1 u = 0 at u = -0.5556 for p1 = 0.3.
    let (name, text) = refused(|e| e.decentering.horizontal = 0.3);
    assert_eq!(name, "p1");
    assert!(text.contains("radius 0.5556"), "{text}");
    // Radial 1 + 5 k2 r⁴ = 0 at r = 0.8409 for k2 = -0.4; the stronger of two culprits is named.
    let (name, text) = refused(|e| (e.fifth_order.quintic, e.radial.cubic) = (-0.4, 0.001));
    assert_eq!(name, "k2");
    assert!(text.contains("radius 0.84"), "{text}");
    // All that the paper and docs/claims.md use is usable.
    for change in [
        |e: &mut Effects| e.radial.cubic = -0.3,
        |e: &mut Effects| e.radial.cubic = 0.3,
        |e: &mut Effects| e.decentering.horizontal = -0.1,
        |e: &mut Effects| e.decentering.vertical = 0.1,
        |e: &mut Effects| e.decentering.vertical = -0.1,
        |e: &mut Effects| e.thin_prism.vertical = 0.1,
        |e: &mut Effects| e.thin_prism.horizontal = -0.1,
    ] {
        assert!(projection(&effects(change)).is_ok());
    }
}

#[test]
fn alone_mounting_and_placement_move_the_picture_as_they_say() {
    let (q1, q2) = (0.1, -0.4);
    let nominal = still(&Variables::default(), q1, q2);
    let with = |name: &str, value: f64| still(&variables(|v| set(v, name, value)), q1, q2);
    // Two centroids of 75 px differ by quantisation: 0.06 px each, at most 0.2.
    let near = |a: f64, b: f64| assert!((a - b).abs() < 0.35, "{a} {b}");
    let roll = with("roll", 0.05);
    // Counter-clockwise: angles to the right of the upright shrink.
    assert!((roll.link1_angle - (nominal.link1_angle - 0.05)).abs() < 2.5e-3);
    assert!((roll.link2_angle - (nominal.link2_angle - 0.05)).abs() < 2.5e-3);
    // The axis turns towards +u: the point on the axis moves to -f tan(pan).
    let pan = with("pan", 0.05);
    let x = nominal.u3_px / 256.0;
    near(pan.u3_px, 256.0 * 2.0 * libm::tan(libm::atan(x / 2.0) - 0.05));
    let tilt = with("tilt", 0.05);
    assert!(tilt.v1_px < nominal.v1_px - 20.0 && tilt.v3_px < nominal.v3_px - 20.0);
    let moved = with("u0", 0.05);
    near(moved.u1_px, nominal.u1_px + 12.8);
    near(moved.v1_px, nominal.v1_px);
    let moved = with("v0", 0.05);
    near(moved.u2_px, nominal.u2_px);
    near(moved.v2_px, nominal.v2_px + 12.8);
    let scaled = with("scale", 1.05);
    near(scaled.u3_px, nominal.u3_px * 1.05);
    near(scaled.v1_px, nominal.v1_px * 1.05);
    // 1.05² of 76 px, each of which may be off by 3 px on the grid.
    assert!((scaled.area2 / nominal.area2 - 1.1025).abs() < 0.1, "{} {}", scaled.area2, nominal.area2);
}

#[test]
fn alone_beta_darkens_the_background_too() {
    let variables = variables(|v| {
        v.effects.sensitivity.exponent = 2.0;
        (v.effects.placement.centre_u, v.effects.placement.centre_v) = (0.25, -0.5);
        v.scene.background = 100.0;
    });
    let (_, picture) = frame(&variables);
    // (11) about the optical axis, which is 64 px right of and 128 px below the middle.
    for (x, y) in [(320, 384), (10, 10), (500, 250)] {
        let (u, v) = ((x as f64 + 0.5 - 320.0) / 256.0, (y as f64 + 0.5 - 384.0) / 256.0);
        let expected = 100.0 * libm::cos(libm::atan(libm::sqrt(u * u + v * v) / 2.0)).powi(2);
        assert!((f64::from(picture[y * 512 + x]) - expected).abs() <= 0.52, "{x} {y}");
    }
}

#[test]
fn alone_defocus_keeps_the_light() {
    let sum = |passes| {
        let (base, _) = frame(&variables(|v| v.effects.defocus.passes = passes));
        base.iter().map(|parts| f64::from((*parts).max(0))).sum::<f64>()
    };
    // C6: the mask sums to one, so light is spread, not lost; each of 2000 pixels is rounded to 1/64 grey level.
    for passes in [1, 2, 5] {
        assert!((sum(passes) / sum(0) - 1.0).abs() < 1e-4, "{passes}");
    }
    // Figure 9 by hand: one bright pixel of a small patch.
    let mut patch = vec![0.0; 25];
    patch[12] = 27.0;
    let defocus = variables(|v| v.effects.defocus.passes = 1).effects.defocus;
    camera::photometry::defocus::blur(&mut patch, 5, &mut Vec::new(), &defocus);
    let expected = [1.0, 2.0, 1.0, 2.0, 15.0, 2.0, 1.0, 2.0, 1.0];
    let found = [6, 7, 8, 11, 12, 13, 16, 17, 18].map(|i| patch[i]);
    assert!(found.iter().zip(expected).all(|(a, b): (&f32, f32)| (a - b).abs() < 1e-5), "{found:?}");
}

#[test]
fn value_the_light_of_every_pixel_is_that_at_its_centre() {
    let variables = variables(|v| {
        (v.sensor.width, v.sensor.height, v.sensor.focal_length) = (400, 300, 1.5);
        (v.scene.background, v.scene.circle_radius) = (200.0, 0.5);
        v.effects.sensitivity.exponent = 4.0;
        (v.effects.placement.centre_u, v.effects.placement.centre_v) = (0.1, -0.2);
    });
    let mut maker = FrameMaker::new(&variables.scene, &variables.sensor, &variables.effects).expect("legal");
    let centres = [(5.0, 6.0), (-7.0, -3.0), (2.0, -5.0)];
    maker.render(Shot { k: 0, seed: 0, centres_world: &[centres], whole: true });
    let mut circles = 0;
    for y in 0..300 {
        for (x, found) in maker.base().row(y).iter().enumerate() {
            let (u, v) = ((x as f64 + 0.5) / 200.0 - 1.1, 1.0 - (y as f64 + 0.5) / 150.0 + 0.2);
            let light = libm::cos(libm::atan(libm::hypot(u, v) / 1.5)).powi(4); // (11)
            // How far outside the nearest circle, in world units; a pixel reaches 0.042 from its centre.
            let beyond = |c: &(f64, f64)| libm::hypot(10.0 * u - c.0, 10.0 * v - c.1) - 0.5;
            let beyond = centres.iter().map(beyond).fold(f64::INFINITY, f64::min);
            let grey = match beyond {
                _ if beyond < -0.05 => 255.0,
                _ if beyond > 0.05 => 200.0,
                _ => continue,
            };
            circles += usize::from(beyond < -0.05);
            // Half a part, and single precision of 255 · 64 parts.
            let expected = 64.0 * grey * light;
            assert!((f64::from(*found) - expected).abs() < 0.52, "{x} {y}: {found}, not {expected}");
        }
    }
    assert!(circles > 500, "{circles}");
}
