//! Which poses a frame sees, when its result arrives, and that a saved state goes on to the bit.

use crate::common::*;
use camera::scene::Pose;
use camera::shutter::history::{History, Motion, Segment};
use camera::{Camera, Variables};
use fmi2_export::{Experiment, Model, Step};

/// Some smooth motion near the upright: pose and rates.
fn motion(t: f64) -> [f64; 4] {
    [0.05 * libm::sin(3.0 * t), 0.2 * libm::sin(2.0 * t), 0.15 * libm::cos(3.0 * t), 0.4 * libm::cos(2.0 * t)]
}

fn run(variables: &mut Variables, stop: f64, step: f64, mut each: impl FnMut(f64, &Variables)) -> Camera {
    [
        variables.inputs.link1_angle,
        variables.inputs.link2_angle,
        variables.inputs.link1_rate,
        variables.inputs.link2_rate,
    ] = motion(0.0);
    let mut camera = started(variables);
    each(0.0, variables);
    let n = (stop / step).round() as i32;
    for i in 0..n {
        let (from, to) = (f64::from(i) * step, f64::from(i + 1) * step);
        step_to(&mut camera, variables, from, to, motion(to));
        each(to, variables);
    }
    camera
}

#[test]
fn law_frames_arrive_when_they_should() {
    for delay in [0.0, 0.004, 1.0 / 30.0, 0.05] {
        for step in [1.0 / 600.0, 1.0 / 30.0, 0.007, 0.1] {
            let mut variables = variables(|v| v.sensor.delay = delay);
            run(&mut variables, 1.4, step, |now, v| {
                // Frame k arrives at k/30 + delay.
                let arrived = ((now - delay) * 30.0 + 1e-6).floor() as i32 + 1;
                assert_eq!(v.outputs.frame, arrived.max(0), "t {now}, delay {delay}, step {step}");
                assert_eq!(v.outputs.valid, arrived > 0);
                if arrived > 0 {
                    let k = f64::from(arrived - 1);
                    assert!((v.outputs.mid_exposure - (k - 0.005) / 30.0).abs() < 1e-12);
                }
            });
        }
    }
}

#[test]
fn law_ten_minutes_of_frames_do_not_drift() {
    // 1/600 s steps computed as i/600: coincident points are never missed, none comes twice.
    let mut variables = variables(|v| v.sensor.frame_rate = 600.0);
    let mut camera = started(&mut variables);
    for i in 0..60_000 {
        let (from, to) = (f64::from(i) / 600.0, f64::from(i + 1) / 600.0);
        step_to(&mut camera, &mut variables, from, to, [0.0; 4]);
        assert_eq!(variables.outputs.frame, i + 2);
    }
}

#[test]
fn law_delivery_keeps_its_order_when_the_delay_shrinks() {
    let mut variables = variables(|v| v.sensor.delay = 0.1);
    let mut camera = started(&mut variables);
    let (mut last, mut count) = (f64::NEG_INFINITY, 0);
    for i in 0..60 {
        if i == 20 {
            variables.sensor.delay = 0.0;
        }
        let (from, to) = (f64::from(i) / 30.0, f64::from(i + 1) / 30.0);
        step_to(&mut camera, &mut variables, from, to, motion(to));
        let out = &variables.outputs;
        assert!(out.frame >= count);
        if out.frame > 0 {
            assert!(out.mid_exposure >= last);
            last = out.mid_exposure;
        }
        count = out.frame;
    }
    assert_eq!(count, 61);
}

#[test]
fn alone_delay_changes_only_when() {
    let seen = |delay: f64| {
        let mut variables = variables(|v| v.sensor.delay = delay);
        let mut all = Vec::new();
        run(&mut variables, 2.0, 1.0 / 600.0, |_, v| {
            if all.last() != Some(&v.outputs) && v.outputs.frame > 0 {
                all.push(v.outputs.clone());
            }
        });
        all
    };
    let (now, later) = (seen(0.0), seen(0.05));
    assert_eq!(now[..later.len()], later[..]);
    assert!(later.len() == now.len() - 1 || later.len() == now.len() - 2);
}

#[test]
fn alone_loss_takes_frames_and_leaves_the_others_as_they_are() {
    let seen = |share: f64| {
        let mut variables = variables(|v| {
            v.effects.loss.share = share;
            v.effects.noise.deviation = 15.0;
        });
        let mut all = Vec::new();
        run(&mut variables, 10.0, 1.0 / 30.0, |_, v| all.push((v.outputs.mid_exposure, v.outputs.clone())));
        all.dedup_by(|a, b| a.1.frame == b.1.frame);
        all.retain(|(_, outputs)| outputs.frame > 0);
        all
    };
    let (whole, some) = (seen(0.0), seen(0.3));
    // 301 frames, 30 % lost: four standard deviations are 32.
    assert!((some.len() as f64 - 210.7).abs() < 32.0, "{}", some.len());
    for (i, (middle, outputs)) in some.iter().enumerate() {
        assert_eq!(outputs.frame, i as i32 + 1);
        let (_, full) = whole.iter().find(|(t, _)| t == middle).expect("it is one of the whole");
        assert_eq!((outputs.u3_px, outputs.link1_angle), (full.u3_px, full.link1_angle));
    }
}

#[test]
fn law_the_pose_between_points_is_hermites_cubic() {
    // A cubic is met exactly.
    let cubic = |t: f64| (1.0 + t * (0.3 + t * (-2.0 + t * 4.0)), 0.3 + t * (-4.0 + t * 12.0));
    let at = |time: f64| {
        let (p, m) = cubic(time);
        let both = |x| Pose { link1_angle: x, link2_angle: -x };
        Motion { time, pose: both(p), rates: both(m) }
    };
    let mut history = History::starting(at(0.1));
    history.push(Segment { from: at(0.1), to: at(0.2) });
    history.push(Segment { from: at(0.2), to: at(0.5) });
    for i in 0..=40 {
        let t = 0.1 + 0.01 * f64::from(i);
        assert!((history.pose(t).link1_angle - cubic(t).0).abs() < 1e-14);
        assert!((history.pose(t).link2_angle + cubic(t).0).abs() < 1e-14);
    }
    // Before it, the straight line.
    assert!((history.pose(0.0).link1_angle - (cubic(0.1).0 - 0.1 * cubic(0.1).1)).abs() < 1e-15);
}

#[test]
fn law_input_derivatives_extrapolate_from_the_inputs() {
    // Values at the beginning of the step and their rates: the frame at its end sees value + rate · h.
    let mut variables = Variables::default();
    let mut camera = started(&mut variables);
    let period = 1.0 / 30.0;
    variables.inputs.link2_angle = 0.3;
    let step = Step { from: 0.0, to: period, input_rates: &[("q1", 0.6), ("q2", -3.0)] };
    camera.step(&mut variables, &step, &mut Silent).expect("a legal step");
    let out = &variables.outputs;
    // Mid-exposure is 0.17 ms before; quantisation 1.2e-3.
    assert!((out.link1_angle - 0.02).abs() < 1.5e-3 && (out.link2_angle - 0.2).abs() < 2e-3, "{out:?}");
}

#[test]
fn law_rates_are_differences_of_valid_estimates() {
    let mut variables = Variables::default();
    let mut before = None;
    run(&mut variables, 1.0, 1.0 / 30.0, |_, v| {
        let out = v.outputs.clone();
        let expected = before.map_or(0.0, |(t, q)| (out.link2_angle - q) / (out.mid_exposure - t));
        assert_eq!(out.link2_rate, expected);
        before = Some((out.mid_exposure, out.link2_angle));
    });
}

#[test]
fn law_a_lost_identification_holds_the_estimate() {
    let mut variables = Variables::default();
    let mut camera = started(&mut variables);
    let step = |camera: &mut Camera, variables: &mut Variables, i: i32, q2: f64| {
        step_to(camera, variables, f64::from(i) / 30.0, f64::from(i + 1) / 30.0, [0.0, q2, 0.0, 0.0]);
    };
    step(&mut camera, &mut variables, 0, 0.1);
    let held = variables.outputs.clone();
    assert!(held.valid);
    // A threshold that nothing reaches, for two frames.
    variables.effects.sensitivity.exponent = 60.0;
    for i in 1..3 {
        step(&mut camera, &mut variables, i, 0.1);
        let out = &variables.outputs;
        assert!(!out.valid && out.frame == i + 2);
        assert_eq!(
            (out.link2_angle, out.link2_rate, out.u3_px),
            (held.link2_angle, held.link2_rate, held.u3_px)
        );
    }
    variables.effects.sensitivity.exponent = 0.0;
    step(&mut camera, &mut variables, 3, 0.13);
    let out = &variables.outputs;
    assert!(out.valid);
    // The rate spans the gap of three periods.
    assert!((out.link2_rate - (out.link2_angle - held.link2_angle) * 10.0).abs() < 1e-9);
}

#[test]
fn law_a_saved_state_goes_on_to_the_bit() {
    let settings: [fn(&mut Variables); 2] = [
        |v| (v.sensor.delay, v.sensor.exposure_factor, v.effects.noise.deviation) = (0.05, 1.0, 15.0),
        |v| (v.sensor.interlaced, v.effects.defocus.passes, v.effects.loss.share) = (true, 2, 0.2),
    ];
    for change in settings {
        let mut one = variables(change);
        let mut camera = run(&mut one, 0.37, 1.0 / 600.0, |_, _| ());
        let saved = postcard::to_allocvec(&(&camera, &one)).expect("it can be serialised");
        assert!(saved.len() < 8000, "{} bytes", saved.len());
        let (mut restored, mut two): (Camera, Variables) =
            postcard::from_bytes(&saved).expect("it was saved");
        let mut cloned = (camera.clone(), one.clone());
        for i in 222..600 {
            let (from, to) = (f64::from(i) / 600.0, f64::from(i + 1) / 600.0);
            step_to(&mut camera, &mut one, from, to, motion(to));
            step_to(&mut restored, &mut two, from, to, motion(to));
            step_to(&mut cloned.0, &mut cloned.1, from, to, motion(to));
            assert_eq!(one.outputs, two.outputs);
            assert_eq!(one.outputs, cloned.1.outputs);
        }
        assert_eq!(postcard::to_allocvec(&camera).ok(), postcard::to_allocvec(&restored).ok());
    }
}

#[test]
fn alone_interlaced_fields_come_twice_as_often_with_half_the_rows() {
    let mut fields = variables(|v| v.sensor.interlaced = true);
    let mut worst: f64 = 0.0;
    run(&mut fields, 1.0, 1.0 / 600.0, |now, v| {
        assert_eq!(v.outputs.frame, (now * 60.0 + 1e-6).floor() as i32 + 1);
        assert!(v.outputs.valid, "{now}");
        assert_eq!(v.outputs.area1 % 2.0, 0.0);
        let truth = motion(v.outputs.mid_exposure);
        worst = worst.max((v.outputs.link2_angle - truth[1]).abs());
    });
    // Half the rows: about twice the error of frames (1.2e-3).
    assert!(worst < 4e-3, "{worst}");
}

#[test]
fn value_a_frame_is_written_as_png() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let inside = folder.path().join("a/b");
    let mut variables = variables(|v| {
        v.sensor.frames_dir = inside.display().to_string();
        v.sensor.frames_every = 2;
    });
    run(&mut variables, 0.1, 1.0 / 30.0, |_, _| ());
    let mut names: Vec<String> = std::fs::read_dir(&inside)
        .expect("the folder was made")
        .map(|entry| entry.expect("readable").file_name().into_string().expect("plain"))
        .collect();
    names.sort();
    assert_eq!(names, ["frame_000000.png", "frame_000002.png"]);
    let file = std::fs::File::open(inside.join(&names[0])).expect("it is there");
    let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().expect("a PNG");
    let mut pixels = vec![0; reader.output_buffer_size().expect("small")];
    let info = reader.next_frame(&mut pixels).expect("whole");
    assert_eq!((info.width, info.height, info.color_type), (512, 512, png::ColorType::Grayscale));
    // Circle 2 of the upright robot is at v = -20.7 px, row 276.
    assert_eq!((pixels[276 * 512 + 255], pixels[200 * 512 + 255]), (255, 0));
    // A folder that can't be: the message names the path.
    variables.sensor.frames_dir = inside.join(&names[0]).join("c").display().to_string();
    let error = Camera::default()
        .initialize(&mut variables, &Experiment { start: 0.0, stop: None, tolerance: None }, &mut Silent)
        .expect_err("a file is not a folder");
    assert!(error.to_string().contains(&variables.sensor.frames_dir), "{error}");
}

#[test]
fn alone_writing_frames_changes_nothing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for estimator in 0..3 {
        for interlaced in [false, true] {
            let outputs = |frames_dir: String| {
                let mut variables = variables(|v| {
                    v.sensor.frames_dir.clone_from(&frames_dir);
                    (v.sensor.frames_every, v.sensor.estimator, v.sensor.interlaced) =
                        (2, estimator, interlaced);
                    (v.effects.noise.deviation, v.effects.defocus.passes) = (15.0, 1);
                });
                let mut all = Vec::new();
                run(&mut variables, 0.4, 1.0 / 60.0, |_, v| all.push(v.outputs.clone()));
                all
            };
            let written = outputs(folder.path().display().to_string());
            assert_eq!(written, outputs(String::new()), "estimator {estimator}, interlaced {interlaced}");
            assert!(written.iter().all(|out| out.valid));
        }
    }
}

#[test]
fn law_values_that_cant_be_are_refused_by_name() {
    let refused = |change: fn(&mut Variables)| {
        let mut variables = variables(change);
        let mut camera = Camera::default();
        camera.initialize(&mut variables, &EXPERIMENT, &mut Silent).expect_err("it can't be").to_string()
    };
    assert!(refused(|v| v.sensor.width = 8).starts_with("variable width = 8"));
    assert!(refused(|v| v.sensor.estimator = 9).starts_with("variable estimator = 9"));
    assert!(refused(|v| v.effects.noise.deviation = f64::NAN).starts_with("variable sigma = NaN"));
    assert!(refused(|v| v.sensor.smallest_area = 500).starts_with("variable N_min = 500"));
    assert!(refused(|v| v.effects.radial.cubic = -0.6).starts_with("variable k1 = -0.6"));
    let mut variables = Variables::default();
    let mut camera = started(&mut variables);
    variables.inputs.link1_angle = f64::NAN;
    let step = Step { from: 0.0, to: 0.1, input_rates: &[] };
    let error = camera.step(&mut variables, &step, &mut Silent).expect_err("not a pose").to_string();
    assert!(error.starts_with("variable q1 = NaN"), "{error}");
    (variables.inputs.link1_angle, variables.sensor.delay) = (0.0, -1.0);
    let error = camera.step(&mut variables, &step, &mut Silent).expect_err("not a delay").to_string();
    assert!(error.starts_with("variable T_delay = -1"), "{error}");
}
