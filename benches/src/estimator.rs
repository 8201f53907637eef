//! The estimators beside Cramér and Rao's bound: not speed, but what speed is not traded for.

use crate::{Row, Samples};
use camera::photometry::{FrameMaker, Shot};
use camera::scene::Pose;
use camera::{Camera, Variables};
use fmi2_export::{Experiment, Log, Model};

struct Silent;
impl Log for Silent {
    fn log(&mut self, _: &'static str, _: &dyn Fn() -> String) {}
}

const FRAMES: i32 = 600;

/// Places spread evenly over an interval, with no period that could meet the pixels' (golden ratio).
fn spread(i: i32, low: f64, high: f64, which: f64) -> f64 {
    low + (high - low) * (f64::from(i) * (0.618_033_988_749_894_9 + which)).fract()
}

/// Root mean square error (px per axis) of circles 2 and 3.
fn scatter(base: &Variables) -> f64 {
    let (mut sum, mut n) = (0.0, 0.0);
    for i in 0..FRAMES {
        let (q1, q2) = (spread(i, -0.4, 0.4, 0.0), spread(i, -2.0, 2.0, 0.137_4));
        let mut variables = base.clone();
        variables.sensor.seed = i;
        variables.inputs.link1_angle = q1;
        variables.inputs.link2_angle = q2;
        let experiment = Experiment { start: 0.0, stop: None, tolerance: None };
        Camera::default().initialize(&mut variables, &experiment, &mut Silent).expect("legal parameters");
        let out = variables.outputs;
        let centres = base.scene.centres_world(Pose { link1_angle: q1, link2_angle: q2 });
        for (found, true_world) in [
            (out.u2_px, centres[1].0),
            (out.v2_px, centres[1].1),
            (out.u3_px, centres[2].0),
            (out.v3_px, centres[2].1),
        ] {
            sum += (found - 25.6 * true_world).powi(2);
            n += 1.0;
        }
    }
    (sum / n).sqrt()
}

/// The bound (px per axis) in Gaussian noise that is not cut to 0..255, averaged over places.
fn bound(base: &Variables) -> f64 {
    let mut maker = FrameMaker::new(&base.scene, &base.sensor, &base.effects).expect("legal parameters");
    let (mut sum, n) = (0.0, 200);
    for i in 0..n {
        let (x, y) = (spread(i, -5.0, 5.0, 0.0), spread(i, -5.0, 5.0, 0.137_4));
        let mut grey = |dx: f64| {
            let centres_world = &[[(x + dx / 25.6, y), (40.0, 0.0), (0.0, 40.0)]];
            maker.render(Shot { k: 0, seed: 0, centres_world, whole: false });
            maker.base().values.iter().map(|parts| f64::from(*parts) / 64.0).collect::<Vec<f64>>()
        };
        let (right, left) = (grey(0.1), grey(-0.1));
        let slope = |(a, b): (&f64, &f64)| (a - b) / 0.2 / base.effects.noise.deviation;
        sum += 1.0 / right.iter().zip(&left).map(|pair| slope(pair).powi(2)).sum::<f64>();
    }
    (sum / f64::from(n)).sqrt()
}

fn camera(estimator: i32, passes: i32, background: f64, foreground: f64) -> Variables {
    let mut variables = Variables::default();
    variables.sensor.estimator = estimator;
    variables.effects.noise.deviation = 15.0;
    variables.effects.defocus.passes = passes;
    variables.scene.background = background;
    variables.scene.foreground = foreground;
    variables.sensor.threshold = background + 0.75 * (foreground - background);
    variables
}

/// Scatter of each estimator beside the bound, at the start values and at a contrast where nothing is cut.
pub fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    for (estimator, name) in [(0, "binary"), (1, "grey"), (2, "ml")] {
        for (passes, background, foreground, issue) in [
            (0, 0.0, 255.0, Some(0.0195)),
            (2, 0.0, 255.0, Some(0.0355)),
            (0, 28.0, 228.0, None),
            (2, 28.0, 228.0, None),
        ] {
            let variables = camera(estimator, passes, background, foreground);
            let (found, least) = (scatter(&variables), bound(&variables));
            let what = format!("{name}, σ = 15, N = {passes}, grey levels {background} to {foreground}");
            let row = Row::faster("estimator", what, "px", &Samples(vec![found]))
                .than("the bound without cutting", &Samples(vec![least]));
            rows.push(match (estimator, issue) {
                (2, Some(_)) => row.at_most_times(1.05),
                (2, None) => row.at_most_times(1.05),
                (1, Some(_)) if passes == 0 => row.at_most(0.046),
                _ => row,
            });
        }
    }
    rows
}
