//! The unit as a master sees it: limits of its variables, what it logs, and what each output shows.

use crate::common::*;
use camera::recorded::Recorded;
use camera::scene::Pose;
use camera::{Camera, Variables};
use fmi2_export::{Experiment, Log, Model, Slot, SlotMut, Step, Table};

fn set(variables: &mut Variables, index: usize, value: f64) {
    match variables.get_mut(index) {
        Some(SlotMut::Real(slot)) => *slot = value,
        Some(SlotMut::Integer(slot)) => *slot = value as i32,
        other => panic!("{other:?}"),
    }
}

/// What is said of these parameters, without a picture being made.
fn judged(variables: Variables) -> Result<(), String> {
    Recorded::new(variables).map(|_| ()).map_err(|error| error.to_string())
}

#[test]
fn every_limit_of_a_variable_is_legal_and_nothing_beyond_it() {
    let mut limits = 0;
    for (index, declared) in Variables::variables().iter().enumerate() {
        let base = || variables(|v| (v.sensor.smallest_area, v.sensor.largest_area) = (1, 1_000_000));
        let whole = matches!(base().get(index), Some(Slot::Integer(_)));
        let with = |value: f64| {
            let mut changed = base();
            if declared.name == "N_max" {
                changed.sensor.smallest_area = 1;
            }
            set(&mut changed, index, value);
            judged(changed)
        };
        for (limit, out, said) in [(declared.min, -1.0, "at least"), (declared.max, 1.0, "at most")] {
            let Some(limit) = limit else { continue };
            limits += 1;
            assert_eq!(with(limit), Ok(()), "{} = {limit}", declared.name);
            let beyond = limit + out * if whole { 1.0 } else { 1e-9 * f64::max(limit.abs(), 1e-9) };
            let error = with(beyond).expect_err("beyond its limit");
            let begin = format!("variable {} = {beyond}", declared.name);
            assert!(error.starts_with(&begin) && error.contains(&format!("{said} {limit}")), "{error}");
        }
        if matches!(base().get(index), Some(Slot::Real(_))) {
            for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let error = with(value).expect_err("no number");
                assert!(error.starts_with(&format!("variable {} = {value}", declared.name)), "{error}");
                assert!(error.contains("a finite number"), "{error}");
            }
        }
    }
    assert!(limits > 40, "{limits}");
}

#[test]
fn every_value_that_changes_while_stepping_is_looked_at_again() {
    let mut variables = Variables::default();
    let mut camera = started(&mut variables);
    let step = Step { from: 0.0, to: 1e-3, input_rates: &[] };
    let mut said = |change: Change| {
        let mut changed = variables.clone();
        change(&mut changed);
        camera.step(&mut changed, &step, &mut Silent).map_err(|error| error.to_string())
    };
    let refused: [(Change, &str); 9] = [
        (|v| v.inputs.link1_angle = f64::NAN, "variable q1 = NaN"),
        (|v| v.inputs.link2_angle = f64::INFINITY, "variable q2 = inf"),
        (|v| v.inputs.link1_rate = f64::NEG_INFINITY, "variable dq1 = -inf"),
        (|v| v.inputs.link2_rate = f64::NAN, "variable dq2 = NaN"),
        (|v| v.sensor.smallest_area = v.sensor.largest_area + 1, "variable N_min = 131"),
        (|v| v.sensor.delay = f64::INFINITY, "variable T_delay = inf"),
        (|v| v.sensor.delay = f64::NAN, "variable T_delay = NaN"),
        (|v| v.sensor.delay = -1e-9, "variable T_delay = -0.000000001"),
        (|v| v.sensor.largest_area = 39, "variable N_min = 40"),
    ];
    for (change, begin) in refused {
        let error = said(change).expect_err("it can't be");
        assert!(error.starts_with(begin), "{error}, not {begin}");
    }
    assert_eq!(said(|v| v.sensor.smallest_area = v.sensor.largest_area), Ok(()));
    assert_eq!(said(|v| v.sensor.delay = 0.0), Ok(()));
}

/// Keeps what is logged.
#[derive(Default)]
struct Kept(Vec<(&'static str, String)>);
impl Log for Kept {
    fn log(&mut self, category: &'static str, message: &dyn Fn() -> String) {
        self.0.push((category, message()));
    }
}

#[test]
fn every_frame_that_is_lost_or_shows_no_circles_is_logged_once() {
    let watched = |change: Change| {
        let mut variables = variables(change);
        let (mut camera, mut log) = (Camera::default(), Kept::default());
        camera.initialize(&mut variables, &EXPERIMENT, &mut log).expect("legal parameters");
        for k in 0..60 {
            let step = Step { from: f64::from(k) / 30.0, to: f64::from(k + 1) / 30.0, input_rates: &[] };
            camera.step(&mut variables, &step, &mut log).expect("a legal step");
        }
        (variables.outputs, log.0)
    };
    let vision = |message: String| ("logVision", message);
    let (out, log) = watched(|_| ());
    assert_eq!((out.frame, out.frame_index, log.len()), (61, 60, 0));
    // A hundredth of what a circle covers: none is one.
    let (out, log) = watched(|v| (v.sensor.smallest_area, v.sensor.largest_area) = (1, 2));
    let all = |what: &str| (0..=60).map(|k| vision(format!("frame {k}{what}"))).collect::<Vec<_>>();
    assert_eq!(log, all(": the circles were not identified"));
    assert_eq!((out.frame, out.frame_index, out.valid), (61, 60, false));
    let (out, log) = watched(|v| v.effects.loss.share = 1.0);
    assert_eq!(log, all(" is lost"));
    assert_eq!((out.frame, out.frame_index, out.valid), (0, -1, false));
    let (out, log) = watched(|v| v.effects.loss.share = 0.5);
    assert_eq!(out.frame as usize, 61 - log.len());
    assert!(log.len() > 15 && log.len() < 46, "four deviations about a half: {}", log.len());
}

#[test]
fn every_output_shows_what_its_name_says() {
    // Before the time 0, where frames have numbers below 0; the pose holds from the start on.
    let mut variables = variables(|v| {
        (v.inputs.link1_angle, v.inputs.link2_angle) = (0.2, -0.3);
        v.sensor.delay = 0.01;
    });
    let mut camera = Camera::default();
    let experiment = Experiment { start: -1.0, ..EXPERIMENT };
    camera.initialize(&mut variables, &experiment, &mut Silent).expect("legal parameters");
    assert_eq!(variables.outputs, Variables::default().outputs, "nothing has arrived");
    step_to(&mut camera, &mut variables, -1.0, -0.985, [0.2, -0.3, 0.0, 0.0]);
    let out = &variables.outputs;
    assert_eq!((out.frame, out.frame_index, out.valid), (1, -30, true));
    assert!((out.mid_exposure - (-30.0 - 0.005) / 30.0).abs() < 1e-12, "{}", out.mid_exposure);
    let centres = variables.scene.centres_world(Pose { link1_angle: 0.2, link2_angle: -0.3 });
    let found = [(out.u1_px, out.v1_px), (out.u2_px, out.v2_px), (out.u3_px, out.v3_px)];
    for (found, centre) in found.into_iter().zip(centres) {
        // Centroids of 75 px: 0.15 px.
        assert!(
            (found.0 - 25.6 * centre.0).abs() < 0.2 && (found.1 - 25.6 * centre.1).abs() < 0.2,
            "{found:?}"
        );
    }
    for area in [out.area1, out.area2, out.area3] {
        assert!((area - 75.0).abs() < 8.0 && area.fract() == 0.0, "{area}");
    }
    // Quantisation, as along the manifold.
    assert!((out.link1_angle - 0.2).abs() < 1.5e-3 && (out.link2_angle + 0.3).abs() < 1.5e-3, "{out:?}");
    assert_eq!((out.link1_rate, out.link2_rate), (0.0, 0.0), "the first has none");
}

#[test]
fn cross_a_bent_motion_through_a_long_exposure_is_seen_alike_in_one_step_and_in_many() {
    let period = 1.0 / 30.0;
    let seen = |steps: u32| {
        let mut variables = variables(|v| (v.sensor.exposure_factor, v.sensor.estimator) = (1.0, 1));
        let mut camera = started(&mut variables);
        // A cubic, which is met exactly; its tip moves 3 px in two frames, most of them at the end.
        let pose = |t: f64| [0.0, 0.004 * (t / period).powi(3), 0.0, 0.012 * (t / period).powi(2) / period];
        for k in 0..2 * steps {
            let at = |k: u32| f64::from(k) / f64::from(steps) * period;
            step_to(&mut camera, &mut variables, at(k), at(k + 1), pose(at(k + 1)));
        }
        assert!(variables.outputs.valid && variables.outputs.frame == 3, "{:?}", variables.outputs);
        variables.outputs
    };
    // The mean of the cubic over the second frame: 15/4 of 0.004 rad, on links of 25.6 · 6.9 px.
    let expected = 25.6 * 6.9 * 0.015;
    for steps in [1, 2, 7, 30] {
        let out = seen(steps);
        // Sub-frames a quarter of a pixel apart at their middles, rounded grey levels.
        assert!((out.u3_px - expected).abs() < 0.02, "{steps} steps: {}, not {expected}", out.u3_px);
    }
}
