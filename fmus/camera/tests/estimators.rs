//! The estimators beside the paper's: how well they place a circle.

use crate::common::*;
use camera::photometry::{FrameMaker, Shot};
use camera::scene::Pose;

/// Centroid errors of circles 2 and 3 (px per axis, rms) at random poses.
fn scatter(estimator: i32, interlaced: bool, sigma: f64, passes: i32, n: usize) -> f64 {
    let base = variables(|v| {
        (v.sensor.estimator, v.sensor.interlaced) = (estimator, interlaced);
        v.effects.noise.deviation = sigma;
        v.effects.defocus.passes = passes;
    });
    let mut random = Random(17);
    let mut errors = Vec::new();
    for i in 0..n {
        let (q1, q2) = (random.between(-0.4, 0.4), random.between(-2.0, 2.0));
        let mut variables = base.clone();
        variables.sensor.seed = i as i32;
        let out = still(&variables, q1, q2);
        assert!(out.valid);
        let centres = base.scene.centres_world(Pose { link1_angle: q1, link2_angle: q2 });
        errors.extend([out.u2_px - 25.6 * centres[1].0, out.v2_px - 25.6 * centres[1].1]);
        errors.extend([out.u3_px - 25.6 * centres[2].0, out.v3_px - 25.6 * centres[2].1]);
    }
    rms(errors.into_iter())
}

/// Cramér and Rao's bound (px per axis) for a circle at random places, from the frames' own derivatives: the
/// information of pixels with Gaussian noise that is not cut to 0..255, averaged over places and over both axes. A field has
/// every other row.
fn bound(interlaced: bool, sigma: f64, passes: i32) -> f64 {
    let base = variables(|v| v.effects.defocus.passes = passes);
    let mut maker = FrameMaker::new(&base.scene, &base.sensor, &base.effects).expect("legal parameters");
    let mut random = Random(23);
    let (mut sum, n) = (0.0, 200);
    for _ in 0..n {
        let place = (random.between(-5.0, 5.0), random.between(-5.0, 5.0));
        let mut grey = |dx: f64, dy: f64| {
            let centre = (place.0 + dx / 25.6, place.1 + dy / 25.6);
            maker.render(Shot {
                k: 0,
                seed: 0,
                centres_world: &[[centre, (40.0, 0.0), (0.0, 40.0)]],
                whole: false,
            });
            let rows = (0..512).step_by(if interlaced { 2 } else { 1 });
            rows.flat_map(|y| maker.base().row(y).to_vec())
                .map(|parts| f64::from(parts) / 64.0)
                .collect::<Vec<f64>>()
        };
        for (dx, dy) in [(0.1, 0.0), (0.0, 0.1)] {
            let (there, back) = (grey(dx, dy), grey(-dx, -dy));
            let information: f64 =
                there.iter().zip(&back).map(|(a, b)| ((a - b) / 0.2 / sigma).powi(2)).sum();
            sum += 0.5 / information;
        }
    }
    (sum / f64::from(n)).sqrt()
}

#[test]
fn value_scatter_of_the_estimators() {
    // Issue 5, item 2: grey 0.046 px, maximum likelihood 0.0195 px at sigma 15, 0.0355 px with N = 2, the bound
    // within 5 %. 3200 values: the rms itself scatters by 1.3 %.
    let grey = scatter(1, false, 15.0, 0, 800);
    println!("grey: {grey:.4} px");
    assert!(grey < 0.046);
    for (passes, expected) in [(0, 0.0195), (2, 0.0355)] {
        let (found, bound) = (scatter(2, false, 15.0, passes, 800), bound(false, 15.0, passes));
        println!("likelihood, N = {passes}: {found:.4} px, bound {bound:.4} px");
        assert!(found < expected * 1.05 && found < bound * 1.05, "N = {passes}: {found} {bound}");
    }
    // Without noise nothing but rounding to 256 levels is left.
    for estimator in [1, 2] {
        let found = scatter(estimator, false, 0.0, 0, 200);
        println!("estimator {estimator}, clean: {found:.5} px");
        assert!(found < 0.002, "{found}");
    }
}

#[test]
fn value_fields_are_used_as_well_as_frames() {
    // Every other row, defocused or not: the bound of these rows, within what 3200 values scatter by and 5 %.
    for passes in [0, 2] {
        let (found, bound) = (scatter(2, true, 15.0, passes, 800), bound(true, 15.0, passes));
        println!("likelihood of fields, N = {passes}: {found:.4} px, bound {bound:.4} px");
        assert!(found < bound * 1.05, "N = {passes}: {found} {bound}");
    }
}
