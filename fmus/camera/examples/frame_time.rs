//! Time of one camera frame (render, defocus, noise, quantise, threshold, label, centroids), one thread.
//!
//! `cargo run --release -p camera --example frame_time [-- FRAMES [CASE]]` prints the 10th percentile and the median in
//! microseconds for: a clean; b16 moving with E_t = 1, 16 sub-frames; c sigma 15 and defocus N = 2; d all of it with
//! every lens effect; each with the whole frame made, and with only the boxes that the vision system needs.

use camera::Variables;
use camera::photometry::{FrameMaker, Shot};
use camera::scene::Pose;
use camera::vision::{Feature, Labeller, select};
use std::hint::black_box;
use std::time::Instant;

type Case = (&'static str, fn(&mut Variables), usize);

fn noisy(variables: &mut Variables) {
    variables.effects.noise.deviation = 15.0;
    variables.effects.defocus.passes = 2;
}

fn all(variables: &mut Variables) {
    noisy(variables);
    variables.effects.radial.cubic = 0.1;
    variables.effects.decentering.horizontal = 0.002;
    variables.effects.decentering.vertical = 0.002;
    variables.effects.thin_prism.horizontal = 0.02;
    variables.effects.thin_prism.vertical = 0.01;
    variables.effects.sensitivity.exponent = 1.0;
}

const CASES: [Case; 4] = [("a", |_| (), 1), ("b16", |_| (), 16), ("c", noisy, 1), ("d", all, 16)];

fn main() {
    let frames = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(5000);
    println!(
        "{:6} {:6} {:>9} {:>9}   µs a frame of 512 x 512, {frames} frames",
        "case", "made", "p10", "median"
    );
    let only = std::env::args().nth(2);
    for (name, change, sub_frames) in CASES {
        if only.as_ref().is_some_and(|only| only != name) {
            continue;
        }
        for whole in [true, false] {
            let mut variables = Variables::default();
            change(&mut variables);
            let times = measure(&variables, sub_frames, whole, frames);
            let made = if whole { "whole" } else { "boxes" };
            let at = |share: f64| times[(share * times.len() as f64) as usize];
            println!("{name:6} {made:6} {:9.2} {:9.2}", at(0.1), at(0.5));
        }
    }
}

/// Sorted times of frames, in µs.
fn measure(variables: &Variables, sub_frames: usize, whole: bool, frames: usize) -> Vec<f64> {
    let Variables { scene, sensor, effects, .. } = variables;
    let mut maker = FrameMaker::new(scene, sensor, effects).expect("the cases' parameters are legal");
    let mut labeller = Labeller::default();
    let (mut components, mut features, mut centres) = (Vec::new(), Vec::new(), Vec::new());
    let mut times = Vec::with_capacity(frames);
    for k in 0..frames {
        // Along the manifold's middle part, about 4 px from the first sub-frame to the last.
        let q2 = 1.2 * (k as f64 * 0.01).sin();
        let pose = |share: f64| Pose { link1_angle: -0.3 * q2, link2_angle: q2 + 0.02 * share };
        let start = Instant::now();
        centres.clear();
        centres.extend((0..sub_frames).map(|i| scene.centres_world(pose(i as f64 / sub_frames as f64))));
        maker.render(Shot { k: k as i64, seed: 0, centres_world: &centres, whole });
        labeller.label(maker.mask(), maker.windows(), 1, &mut components);
        features.clear();
        let circles = components.iter().filter(|component| select::may_be_circle(component, sensor));
        features.extend(circles.map(|component| Feature::binary(component, sensor)));
        times.push(start.elapsed().as_secs_f64() * 1e6);
        assert!(k == 0 || features.len() == 3, "case with {} circles", features.len());
        black_box(maker.picture());
    }
    times.sort_by(f64::total_cmp);
    times
}
