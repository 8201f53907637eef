//! Frames that were recorded are looked at as those that the unit has rendered.

use crate::common::*;
use camera::photometry::{FrameMaker, Shot};
use camera::recorded::Recorded;
use camera::scene::Pose;

const SETTINGS: [(&str, Change); 5] = [
    ("as it is", |_| ()),
    ("noise", |v| v.effects.noise.deviation = 15.0),
    ("a size that is no whole number of words", |v| {
        (v.sensor.width, v.sensor.height) = (333, 207);
        (v.sensor.smallest_area, v.sensor.largest_area) = (5, 130);
        v.sensor.threshold = 100.5;
    }),
    ("fields", |v| (v.sensor.interlaced, v.sensor.height) = (true, 511)),
    ("fields by maximum likelihood", |v| (v.sensor.interlaced, v.sensor.estimator) = (true, 2)),
];

#[test]
fn cross_recorded_frames_show_what_the_unit_sees() {
    for (name, change) in SETTINGS {
        let mut unit = variables(change);
        let mut recorded = Recorded::new(unit.clone()).expect("legal parameters");
        let mut maker = FrameMaker::new(&unit.scene, &unit.sensor, &unit.effects).expect("legal parameters");
        let rate = if unit.sensor.interlaced { 60.0 } else { 30.0 };
        let mut camera = started(&mut unit);
        let mut valid = 0;
        for k in 0..12 {
            // At rest while each is exposed.
            let pose = Pose { link1_angle: 0.02 * k as f64, link2_angle: 0.1 - 0.03 * k as f64 };
            if k > 0 {
                let [before, middle, now] = [1.0, 0.5, 0.0].map(|early| (k as f64 - early) / rate);
                let still = [pose.link1_angle, pose.link2_angle, 0.0, 0.0];
                step_to(&mut camera, &mut unit, before, middle, still);
                step_to(&mut camera, &mut unit, middle, now, still);
            } else {
                (unit.inputs.link1_angle, unit.inputs.link2_angle) = (pose.link1_angle, pose.link2_angle);
                camera = started(&mut unit);
            }
            maker.render(Shot { k, seed: 0, centres_world: &[unit.scene.centres_world(pose)], whole: true });
            let (first, step) = if unit.sensor.interlaced { (k as usize % 2, 2) } else { (0, 1) };
            let rows: Vec<&[u8]> =
                (first..maker.picture().height).step_by(step).map(|y| maker.picture().row(y)).collect();
            assert_eq!(recorded.size(k), (unit.sensor.width as usize, rows.len()), "{name}");
            let seen = recorded.look(k, unit.outputs.mid_exposure, &rows.concat());
            let out = &unit.outputs;
            assert_eq!((seen.number, seen.valid), (k, out.valid), "{name}, frame {k}");
            assert_eq!(seen.angles, (out.link1_angle, out.link2_angle), "{name}, frame {k}");
            assert_eq!(seen.rates, (out.link1_rate, out.link2_rate), "{name}, frame {k}");
            assert_eq!(seen.circles[2].centre_px, (out.u3_px, out.v3_px), "{name}, frame {k}");
            valid += usize::from(seen.valid);
            // The circles are among all regions.
            let areas = recorded.areas();
            assert!(
                !seen.valid
                    || [out.area1, out.area2, out.area3].iter().all(|area| areas.contains(&(*area as u32)))
            );
        }
        assert_eq!(valid, 12, "{name}");
    }
}

#[test]
fn every_pixel_at_the_threshold_counts_and_a_frame_of_another_size_shows_nothing() {
    let mut recorded =
        Recorded::new(variables(|v| (v.sensor.width, v.sensor.height, v.sensor.threshold) = (70, 20, 99.5)))
            .expect("legal parameters");
    // Bars of 4, 9, and 21 pixels, across a word's end, and one that is a level too dark.
    let mut grey = vec![0; 70 * 20];
    for (y, from, to, level) in [(2, 0, 4, 100), (5, 28, 37, 255), (9, 49, 70, 101), (12, 3, 60, 99)] {
        grey[y * 70 + from..y * 70 + to].fill(level);
    }
    recorded.look(0, 0.0, &grey);
    assert_eq!(recorded.areas(), [4, 9, 21]);
    for other in [70 * 20 - 1, 70 * 20 + 1, 70 * 19, 70 * 21, 0] {
        let mut cut = grey.clone();
        cut.resize(other, 255);
        assert!(!recorded.look(1, 0.1, &cut).valid);
        assert!(recorded.areas().is_empty(), "{other} pixels");
    }
    recorded.look(2, 0.2, &grey);
    assert_eq!(recorded.areas(), [4, 9, 21]);
}
