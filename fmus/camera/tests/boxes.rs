//! Working only where circles are gives exactly what whole frames give.

use crate::common::*;
use camera::Variables;
use camera::photometry::{Area, FrameMaker, Shot, noise::Keys, noise::gain, quantise, tails};
use camera::scene::Pose;
use camera::vision::{Component, Labeller};

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

/// A frame of the robot, from its boxes or whole.
fn shown(maker: &mut FrameMaker, variables: &Variables, k: i64, whole: bool) {
    let turn = 0.1 * k as f64;
    let centres = variables.scene.centres_world(Pose { link1_angle: -turn, link2_angle: 2.0 * turn });
    maker.render(Shot { k, seed: 0, centres_world: &[centres], whole });
}

#[test]
fn every_whole_picture_after_boxes_shows_all_of_the_background() {
    let base = variables(|v| v.scene.background = 20.0);
    let fresh = || FrameMaker::new(&base.scene, &base.sensor, &base.effects).expect("legal parameters");
    let mut maker = fresh();
    // The first frames are boxes on a picture that nobody has made; later ones follow a whole one.
    for (k, whole) in [false, false, true, false, true, true, false].into_iter().enumerate() {
        shown(&mut maker, &base, k as i64, whole);
        if whole {
            let mut alone = fresh();
            shown(&mut alone, &base, k as i64, true);
            assert!(maker.picture() == alone.picture(), "frame {k}");
            let dark = maker.picture().values.iter().filter(|grey| **grey == 20).count();
            assert!(dark > 512 * 512 - 400, "three circles cover 250 px and cross 150: {dark}");
        }
    }
}

#[test]
fn every_base_that_is_asked_for_again_is_the_same_under_other_noise() {
    for (name, change) in SETTINGS {
        let variables = variables(change);
        let fresh = || {
            FrameMaker::new(&variables.scene, &variables.sensor, &variables.effects)
                .expect("legal parameters")
        };
        let mut maker = fresh();
        // More frames than are kept at once; a round of 20 comes back to bases that are.
        for (seed, count) in [(1, 20), (2, 20), (3, 100), (4, 100)] {
            for k in 0..count {
                let turn = 0.02 * k as f64;
                let pose = Pose { link1_angle: -turn, link2_angle: 2.0 * turn };
                let centres = variables.scene.centres_world(pose);
                let shot = Shot { k, seed, centres_world: &[centres], whole: false };
                maker.render(shot);
                let mut alone = fresh();
                alone.render(shot);
                assert_eq!(maker.base(), alone.base(), "{name}, seed {seed}, frame {k}: base");
                let [again, once] =
                    [&maker, &alone].map(|maker| labelled(maker, maker.windows(), &variables));
                assert_eq!(again, once, "{name}, seed {seed}, frame {k}");
            }
        }
    }
}

#[test]
fn every_window_of_a_field_is_that_of_the_frame_from_its_first_row_on() {
    let frames = variables(|_| ());
    let fields = variables(|v| v.sensor.interlaced = true);
    let maker =
        |of: &Variables| FrameMaker::new(&of.scene, &of.sensor, &of.effects).expect("legal parameters");
    let (mut frame, mut field) = (maker(&frames), maker(&fields));
    let (mut moved, mut same) = (0, 0);
    for k in 0..20 {
        shown(&mut frame, &frames, k, false);
        shown(&mut field, &fields, k, false);
        assert_eq!(frame.windows().len(), field.windows().len());
        for (whole, half) in frame.windows().iter().zip(field.windows()) {
            let late = usize::from(whole.y0 % 2 != k as usize % 2);
            assert_eq!(*half, Area { y0: whole.y0 + late, ..*whole }, "field {k}");
            *(if late == 1 { &mut moved } else { &mut same }) += 1;
        }
    }
    assert!(moved > 5 && same > 5, "{moved} {same}");
}

#[test]
fn every_maker_knows_what_it_was_made_for() {
    let base = Variables::default();
    let maker = FrameMaker::new(&base.scene, &base.sensor, &base.effects).expect("legal parameters");
    let fits = |change: Change| {
        let other = variables(change);
        maker.is_for(&other.scene, &other.sensor, &other.effects)
    };
    let forms_the_picture: [Change; 10] = [
        |v| v.sensor.width = 511,
        |v| v.sensor.height = 511,
        |v| v.sensor.focal_length = 2.1,
        |v| v.sensor.interlaced = true,
        |v| v.sensor.threshold = 190.0,
        |v| v.sensor.estimator = 1,
        |v| v.scene.circle_radius = 0.3,
        |v| v.scene.background = 1.0,
        |v| v.effects.noise.deviation = 1.0,
        |v| v.effects.defocus.centre = 0.5,
    ];
    for (place, change) in forms_the_picture.into_iter().enumerate() {
        assert!(!fits(change), "change {place}");
    }
    // What differs from run to run, and what only the vision asks for.
    assert!(fits(|_| ()));
    assert!(fits(|v| (v.sensor.seed, v.sensor.frame_rate, v.sensor.exposure_factor) = (3, 60.0, 0.5)));
    assert!(fits(|v| (v.sensor.smallest_area, v.sensor.largest_area, v.sensor.delay) = (10, 90, 0.1)));
}

#[test]
fn every_circle_out_of_the_picture_has_no_window() {
    let base = Variables::default();
    let mut maker = FrameMaker::new(&base.scene, &base.sensor, &base.effects).expect("legal parameters");
    let mut windows = |centres: [(f64, f64); 3]| {
        maker.render(Shot { k: 0, seed: 0, centres_world: &[centres], whole: false });
        maker.windows().len()
    };
    // The picture ends at 10, a circle reaches 0.2.
    for side in [(-10.3, 0.0), (10.3, 0.0), (0.0, -10.3), (0.0, 10.3), (-40.0, 3.0), (11.0, 11.0)] {
        assert_eq!(windows([side, (0.0, 0.0), (5.0, 5.0)]), 2, "{side:?}");
        assert_eq!(windows([side; 3]), 0, "{side:?}");
        let (x, y) = (side.0.clamp(-10.1, 10.1), side.1.clamp(-10.1, 10.1));
        assert_eq!(windows([(x, y), (0.0, 0.0), (5.0, 5.0)]), 3, "partly in it at {x}, {y}");
    }
}
