//! Working only where circles are gives exactly what whole frames give.

mod common;
use camera::Variables;
use camera::photometry::{Area, FrameMaker, Shot, noise::Keys, noise::gain, quantise, tails};
use camera::scene::Pose;
use camera::vision::{Component, Labeller};
use common::*;

const SETTINGS: [(&str, Change); 8] = [
    ("clean", |_| ()),
    ("defocus", |v| v.effects.defocus.passes = 3),
    ("noise", |v| v.effects.noise.deviation = 15.0),
    ("noise that reaches the threshold", |v| {
        v.effects.noise.deviation = 30.0;
        v.sensor.threshold = 90.0;
        v.sensor.smallest_area = 1;
    }),
    ("all", |v| {
        v.effects.noise.deviation = 15.0;
        v.effects.defocus.passes = 2;
        v.effects.sensitivity.exponent = 2.0;
        v.effects.radial.cubic = 0.1;
        v.scene.background = 20.0;
    }),
    ("odd size", |v| {
        (v.sensor.width, v.sensor.height) = (333, 207);
        v.effects.noise.deviation = 5.0;
        v.effects.defocus.passes = 1;
    }),
    ("interlaced", |v| {
        v.sensor.interlaced = true;
        v.effects.noise.deviation = 15.0;
        v.effects.defocus.passes = 1;
    }),
    ("clean interlaced", |v| v.sensor.interlaced = true),
];

fn labelled(maker: &FrameMaker, windows: &[Area], variables: &Variables) -> Vec<Component> {
    let mut found = Vec::new();
    let step = if variables.sensor.interlaced { 2 } else { 1 };
    Labeller::default().label(maker.mask(), windows, step, &mut found);
    found
}

#[test]
fn every_setting_boxes_give_what_whole_frames_give() {
    for (name, change) in SETTINGS {
        let variables = variables(change);
        let fresh = || {
            FrameMaker::new(&variables.scene, &variables.sensor, &variables.effects)
                .expect("legal parameters")
        };
        let (mut boxes, mut whole) = (fresh(), fresh());
        let mut random = Random(99);
        for k in 0..60 {
            // Also poses whose circles leave the picture, and whose boxes meet.
            let pose =
                Pose { link1_angle: random.between(-1.5, 1.5), link2_angle: random.between(-3.1, 3.1) };
            let mut centres = variables.scene.centres_world(pose);
            if k % 7 == 3 {
                centres[2] = (centres[1].0 + random.between(-0.9, 0.9), centres[1].1 + 0.3);
            }
            let blurred = [centres, [(centres[0].0 + 0.1, centres[0].1), centres[1], centres[2]]];
            let centres_world = if k % 2 == 0 { &blurred[..1] } else { &blurred[..] };
            // Whole pictures now and then also in the maker that mostly does boxes.
            boxes.render(Shot { k, seed: 0, centres_world, whole: k % 5 == 4 });
            let mut new = fresh();
            new.render(Shot { k, seed: 0, centres_world, whole: true });
            whole.render(Shot { k, seed: 0, centres_world, whole: true });
            assert_eq!(boxes.base(), new.base(), "{name}, frame {k}: base");
            let rows = |maker: &FrameMaker| {
                let (first, step) = if variables.sensor.interlaced { (k as usize % 2, 2) } else { (0, 1) };
                let picture = maker.picture();
                (first..picture.height)
                    .step_by(step)
                    .flat_map(|y| picture.row(y).to_vec())
                    .collect::<Vec<u8>>()
            };
            assert!(rows(&whole) == rows(&new), "{name}, frame {k}: picture");
            if k % 5 == 4 {
                assert!(rows(&boxes) == rows(&new), "{name}, frame {k}: picture among boxes");
            }
            let (w, h) = (variables.sensor.width as usize, variables.sensor.height as usize);
            let first = if variables.sensor.interlaced { k as usize % 2 } else { 0 };
            // Everything labelled, from a mask made over the whole frame.
            let reference = everything(&new, &variables, k, Area { x0: 0, y0: first, x1: w, y1: h });
            assert_eq!(labelled(&boxes, boxes.windows(), &variables), reference, "{name}, frame {k}");
            assert_eq!(labelled(&whole, whole.windows(), &variables), reference, "{name}, frame {k}");
        }
    }
}

/// Regions of the whole frame, thresholded anew from its base by the portable path.
fn everything(maker: &FrameMaker, variables: &Variables, k: i64, all: Area) -> Vec<Component> {
    use camera::photometry::{Mask, Plane};
    let base = maker.base();
    let mut picture = Plane::filled(base.width, base.height, 0u8, 0);
    let mut mask = Mask::empty(base.width, base.height);
    let noise = match gain(variables.effects.noise.deviation) {
        0 => None,
        gain => Some((Keys::new(variables.sensor.seed, k), gain)),
    };
    let step = if variables.sensor.interlaced { 2 } else { 1 };
    let level = variables.sensor.threshold as u8;
    for y in (all.y0..all.y1).step_by(step) {
        let pixels = y * base.stride..(y + 1) * base.stride;
        let words = y * mask.stride..(y + 1) * mask.stride;
        let span = quantise::Span {
            base: &base.values[pixels.clone()],
            first_word: (pixels.start / 2) as u32,
            noise,
            level,
        };
        let (picture, mask) = (&mut picture.values[pixels], &mut mask.words[words]);
        quantise::portable(span, picture, mask);
        tails::draw(span, picture, mask);
    }
    let mut found = Vec::new();
    Labeller::default().label(&mask, &[all], step, &mut found);
    found
}

#[test]
fn every_region_is_found_as_a_flood_fill_finds_it() {
    use camera::photometry::Mask;
    let (width, height) = (75, 40);
    let mut random = Random(5);
    for density in [0.05, 0.3, 0.45, 0.6, 0.9] {
        let mut mask = Mask::empty(width, height);
        let mut set = vec![false; width * height];
        for (i, set) in set.iter_mut().enumerate() {
            *set = random.uniform() < density;
            if *set {
                mask.words[(i / width) * mask.stride + (i % width) / 32] |= 1 << (i % width % 32);
            }
        }
        let mut found = Vec::new();
        let all = Area { x0: 0, y0: 0, x1: width, y1: height };
        Labeller::default().label(&mask, &[all], 1, &mut found);
        let mut expected = Vec::new();
        for start in 0..set.len() {
            if !set[start] {
                continue;
            }
            set[start] = false;
            let (mut stack, mut sums) = (vec![start], (0u32, 0u64, 0u64));
            while let Some(at) = stack.pop() {
                let (x, y) = (at % width, at / width);
                sums = (sums.0 + 1, sums.1 + x as u64, sums.2 + y as u64);
                for ny in y.saturating_sub(1)..(y + 2).min(height) {
                    for nx in x.saturating_sub(1)..(x + 2).min(width) {
                        if core::mem::replace(&mut set[ny * width + nx], false) {
                            stack.push(ny * width + nx);
                        }
                    }
                }
            }
            expected.push(sums);
        }
        let found: Vec<_> = found.iter().map(|region| (region.area, region.sum_x, region.sum_y)).collect();
        assert_eq!(found, expected, "density {density}");
    }
}
