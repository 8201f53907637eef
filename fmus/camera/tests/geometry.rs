//! Where points of the scene come to lie: rotations by what they must keep, folds by their equations.

use camera::Camera;
use camera::Variables;
use camera::effects::mounting::Mounting;

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[test]
fn law_a_mounting_turns_the_scene_as_its_three_angles_say() {
    let close = |a: [f64; 3], b: [f64; 3]| {
        assert!((0..3).all(|i| (a[i] - b[i]).abs() < 1e-14), "{a:?}, not {b:?}"); // rounding
    };
    for (pan, tilt, roll) in
        [(0.3, 0.0, 0.0), (0.0, -0.4, 0.0), (0.0, 0.0, 0.7), (0.5, -0.3, 2.0), (-1.1, 0.9, -0.2)]
    {
        let mut mounting = Mounting::default();
        (mounting.pan, mounting.tilt, mounting.roll) = (pan, tilt, roll);
        let rotation = mounting.rotation();
        let turned = |point| rotation.camera_from_square(point);
        let ((sa, ca), (st, ct), (sr, cr)) = (f64::sin_cos(pan), f64::sin_cos(tilt), f64::sin_cos(roll));
        // The axis was panned towards +u and then tilted towards +v: what lies there is ahead now.
        close(turned([sa * ct, st, ca * ct]), [0.0, 0.0, 1.0]);
        // What lay across the panned axis, level, is turned counter-clockwise by the roll; and what lay above it.
        close(turned([ca, 0.0, -sa]), [cr, sr, 0.0]);
        close(turned([-sa * st, ct, -ca * st]), [-sr, cr, 0.0]);
        // Lengths and angles stay.
        let (a, b) = ([3.0, -7.0, 20.0], [-1.5, 0.25, 18.0]);
        assert!((dot(turned(a), turned(b)) - dot(a, b)).abs() < 1e-12);
    }
}

#[test]
fn value_the_fold_of_a_decentred_lens_in_every_direction() {
    // (u, v) + p1·(3u² + v², 2uv) has the Jacobian (1 + 6 p1 u)(1 + 2 p1 u) − (2 p1 v)², a parabola along each ray.
    let p1 = -0.1;
    let mut variables = Variables::default();
    variables.effects.decentering.horizontal = p1;
    let projection = Camera::projection(&variables).expect("it folds outside the picture");
    let mut folds = 0;
    for degrees in 0..360 {
        let (s, c) = f64::from(degrees).to_radians().sin_cos();
        let (a, b) = (p1 * p1 * (12.0 * c * c - 4.0 * s * s), 8.0 * p1 * c);
        let root = (b * b - 4.0 * a).max(0.0).sqrt();
        let roots = [(-b - root) / (2.0 * a), (-b + root) / (2.0 * a)];
        let fold = roots.into_iter().filter(|r| *r > 0.0).fold(f64::INFINITY, f64::min);
        let contains = |r: f64| projection.images((r * c, r * s));
        // The fold is known on 64 rays, and taken at the nearer one's of two.
        assert!(contains(0.8 * fold.min(7.0)), "{degrees}°: {fold}");
        if fold < 6.0 {
            assert!(!contains(1.05 * fold), "{degrees}°: {fold}");
            folds += 1;
        }
    }
    assert!(folds > 180, "{folds}");
}

#[test]
fn value_a_lens_that_distorts_images_nothing_beyond_eight() {
    // r + k1 r³ folds at r = sqrt(-1/(3 k1)): at 20, 6 and nowhere; what does not distort images everything.
    for (k1, reach) in [(-1.0 / 1200.0, 8.0), (-1.0 / 108.0, 6.0), (0.1, 8.0), (0.0, f64::INFINITY)] {
        let mut variables = Variables::default();
        variables.effects.radial.cubic = k1;
        let projection = Camera::projection(&variables).expect("it folds outside the picture");
        for (u, v) in [(1.0, 0.0), (0.0, -1.0), (-0.6, 0.8)] {
            for r in [5.9, 6.1, 7.9, 8.1, 19.0, 1e6] {
                assert_eq!(
                    projection.images((r * u, r * v)),
                    r < reach,
                    "k1 = {k1} at {r} towards ({u}, {v})"
                );
            }
        }
    }
}

#[test]
fn value_how_much_larger_a_lens_makes_things() {
    // (1 + k1 r²)·I + 2 k1·(u, v)(u, v)ᵀ: in the corner (1.4, 0.2) along u for k1 = 0.1. Where it makes all smaller: as at the axis.
    for (k1, scale, expected) in [
        (0.1, 1.0, 2.0_f64.sqrt()),
        (0.1, 1.5, 1.5 * 2.0_f64.sqrt()),
        (-0.1, 1.0, 1.0),
        (0.0, 0.8, 0.8),
        (5.0, 1.0, 4.0),
    ] {
        let mut variables = Variables::default();
        (variables.effects.radial.cubic, variables.effects.placement.scale) = (k1, scale);
        let found = Camera::projection(&variables).expect("no fold in the picture").largest_magnification();
        assert!((found - expected).abs() < 1e-3, "{found}, not {expected}"); // differences over 1e-3
    }
}

#[test]
fn law_radial_lenses_move_points_along_their_rays_by_odd_powers() {
    for (u, v) in [(0.6, -0.8), (-0.3, 0.4), (0.0, 1.2), (-0.9, -0.1)] {
        let r = f64::hypot(u, v);
        let mut effects = Variables::default().effects;
        (effects.radial.cubic, effects.fifth_order.quintic) = (0.2, -0.07);
        let (a, b) = effects.distorted(u, v);
        let factor = 1.0 + 0.2 * r.powi(2) - 0.07 * r.powi(4);
        assert!((a - factor * u).abs() < 1e-15 && (b - factor * v).abs() < 1e-15, "{u} {v}: {a} {b}"); // rounding
    }
}

#[test]
fn value_a_fold_is_told_where_it_lies() {
    // Decentering is P r² + 2 (P·x) x with P = (p1, p2): a turned P turns the picture. Along −P its Jacobian is
    // 1 − 6 |P| r, so that it folds at 1/(6 |P|); here on the sixth of the 64 rays that are looked along.
    for ray in [5, 13, 27, 50] {
        let (s, c) = (std::f64::consts::TAU * f64::from(ray) / 64.0).sin_cos();
        let mut variables = Variables::default();
        let decentering = &mut variables.effects.decentering;
        (decentering.horizontal, decentering.vertical) = (-0.25 * c, -0.25 * s);
        let error = Camera::projection(&variables).expect_err("it folds in the picture").to_string();
        let (r, u, v) = (1.0 / 1.5, c / 1.5, s / 1.5);
        let told =
            format!("at radius {r:.4} image units from the optical axis (at ideal u = {u:.4}, v = {v:.4})");
        assert!(error.contains(&told), "{error}, not {told}");
        // Without the larger of the two less is left of the fold.
        let culprit = if c.abs() > s.abs() { "variable p1 = " } else { "variable p2 = " };
        assert!(error.starts_with(culprit), "{error}");
    }
}
