//! One camera frame: render, defocus, noise, quantise, threshold, label, centroids; 512 x 512, one thread.
//!
//! Cases: `a` clean; `b16` moving with E_t = 1, 16 sub-frames; `c` sigma 15 and defocus N = 2; `d` all of it with every
//! lens effect. `scripts/peers/opencv_frame.py` makes the same frames.

use crate::{Peer, Row, Samples};
use camera::Variables;
use camera::photometry::{FrameMaker, Shot};
use camera::scene::Pose;
use camera::vision::{Component, Feature, Labeller, select};
use std::hint::black_box;
use std::time::Instant;

/// Name, changed variables, sub-frames, and the ratio to reach.
pub type Case = (&'static str, fn(&mut Variables), usize, f64);

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

/// The cases with the ratios of issue 5.
pub const CASES: [Case; 4] =
    [("a", |_| (), 1, 10.0), ("b16", |_| (), 16, 8.0), ("c", noisy, 1, 10.0), ("d", all, 16, 10.0)];

/// Everything that makes and sees frames of one case.
pub struct Rig {
    variables: Variables,
    sub_frames: usize,
    maker: FrameMaker,
    labeller: Labeller,
    components: Vec<Component>,
    features: Vec<Feature>,
    centres: Vec<[(f64, f64); 3]>,
}

impl Rig {
    /// A camera for a case.
    pub fn new((_, change, sub_frames, _): Case) -> Self {
        let mut variables = Variables::default();
        change(&mut variables);
        let maker = FrameMaker::new(&variables.scene, &variables.sensor, &variables.effects);
        Self {
            maker: maker.expect("the cases' parameters are legal"),
            variables,
            sub_frames,
            labeller: Labeller::default(),
            components: Vec::new(),
            features: Vec::new(),
            centres: Vec::new(),
        }
    }

    /// Frame `k`: every pixel of it, or only the boxes that the vision needs.
    pub fn shoot(&mut self, k: i64, whole: bool) -> &[Feature] {
        let Variables { scene, sensor, .. } = &self.variables;
        // Along the manifold's middle part, about 4 px from the first sub-frame to the last.
        let q2 = 1.2 * (k as f64 * 0.01).sin();
        let pose = |share: f64| Pose { link1_angle: -0.3 * q2, link2_angle: q2 + 0.02 * share };
        self.centres.clear();
        let n = self.sub_frames;
        self.centres.extend((0..n).map(|i| scene.centres_world(pose(i as f64 / n as f64))));
        self.maker.render(Shot { k, seed: 0, centres_world: &self.centres, whole });
        self.labeller.label(self.maker.mask(), self.maker.windows(), 1, &mut self.components);
        self.features.clear();
        let circles = self.components.iter().filter(|component| select::may_be_circle(component, sensor));
        self.features.extend(circles.map(|component| Feature::binary(component, sensor)));
        black_box(self.maker.picture());
        &self.features
    }

    fn measure(&mut self, first: i64, count: i64, whole: bool, times: &mut Samples) -> Vec<f64> {
        for k in first..first + count {
            let start = Instant::now();
            self.shoot(k, whole);
            times.0.push(start.elapsed().as_secs_f64() * 1e6);
        }
        let mut centres: Vec<(f64, f64)> = self.features.iter().map(|feature| feature.centre_px).collect();
        centres.sort_by(|a, b| a.1.total_cmp(&b.1));
        centres.into_iter().flat_map(|(u, v)| [u, v]).collect()
    }
}

const ROUNDS: i64 = 40;
const FRAMES: i64 = 40;
/// The peer's pipelines, and what tells them apart.
const PIPELINES: [(&str, &str); 4] = [
    ("operators", "OpenCV: contours of the whole frame, randn"),
    ("labels", "OpenCV: 16-bit labels of the whole frame, randn"),
    ("boxes", "OpenCV: vision in known boxes"),
    ("table", "OpenCV: known boxes, noise by 16-bit LUT"),
];

/// All cases against all pipelines, in turns.
pub fn rows() -> Vec<Row> {
    let mut peer = Peer::start("opencv_frame.py", &[]);
    let mut rows = Vec::new();
    for case in CASES {
        let (name, _, _, target) = case;
        let noisy = matches!(name, "c" | "d");
        let pipelines = &PIPELINES[..if noisy { 4 } else { 3 }];
        let (mut whole, mut boxes) = (Rig::new(case), Rig::new(case));
        let (mut ours, mut quick) = (Samples::default(), Samples::default());
        let mut theirs = vec![Samples::default(); pipelines.len()];
        let mut apart = vec![Vec::new(); pipelines.len()];
        for round in 0..ROUNDS {
            let first = round * FRAMES;
            let mine = whole.measure(first, FRAMES, true, &mut ours);
            boxes.measure(first, FRAMES, false, &mut quick);
            for (which, (pipeline, _)) in pipelines.iter().enumerate() {
                let question = format!("{name} {pipeline} {first} {FRAMES}");
                let seen = peer.measure(&question, &mut theirs[which]);
                assert_eq!(mine.len(), seen.len(), "case {name}, frame {}: circles", first + FRAMES - 1);
                apart[which].extend(mine.iter().zip(&seen).map(|(a, b)| a - b));
            }
        }
        for (which, (pipeline, words)) in pipelines.iter().enumerate() {
            let rms = (apart[which].iter().map(|x| x * x).sum::<f64>() / apart[which].len() as f64).sqrt();
            // Two independent noises move binary centroids apart by about 0.15 px; without noise the shapes differ.
            assert!(rms < if noisy { 0.3 } else { 0.15 }, "{name} {pipeline}: {rms} px apart");
            let row = Row::faster("frame", format!("camera frame {name}, whole frame made"), "µs", &ours)
                .than(words, &theirs[which])
                .note(format!("centroids {rms:.3} px rms apart"));
            // What issue 5 compares with are OpenCV's operators; the others are for who tunes further.
            rows.push(if *pipeline == "operators" { row.at_least(target) } else { row });
        }
        let row = Row::faster("frame", format!("camera frame {name}, only the boxes made"), "µs", &quick);
        rows.push(row.than(pipelines[0].1, &theirs[0]).note("identical centroids".into()));
    }
    rows
}
