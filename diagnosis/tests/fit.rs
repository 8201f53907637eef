//! A fit of a parameter whose effect bends: the heat capacity of a body that is heated on and off, a tenth to five times what the model
//! says.

use diagnosis::Error;
use diagnosis::testing::{
    At, FitOptions as Options, Linearise, Linearised, Measured, Noise, Path, Random, Sizes, fit,
};
use std::sync::atomic::{AtomicBool, Ordering};

const ROWS: usize = 400;
/// s between rows.
const ROW: f64 = 2.0;
/// W/K to the air, and W of the heater.
const LOSS: f64 = 0.15;
const HEAT: f64 = 0.6;
/// K, of the thermometer.
const SCATTER: f64 = 0.05;
/// K, of a good one.
const FINE_SCATTER: f64 = 2e-3;
/// J/K.
const NOMINAL: f64 = 60.0;

/// C dT/dt = P(t) - h T over one row, exactly.
fn next(temperature: f64, row: usize, capacity: f64) -> f64 {
    let power = if row % 100 < 40 { HEAT } else { 0.0 };
    let stays = libm::exp(-LOSS * ROW / capacity);
    stays * temperature + (1.0 - stays) * power / LOSS
}

struct Body {
    log: Vec<f64>,
}

impl Body {
    fn logged(truth: f64) -> Self {
        let (mut random, mut temperature) = (Random::new(3), 0.0);
        let mut log = Vec::new();
        for row in 0..ROWS {
            log.push(temperature + SCATTER * random.normal());
            temperature = next(temperature, row, truth);
        }
        Self { log }
    }
}

/// A log about a path, with columns by differences; `next` is the temperature a row later.
fn linearised(
    log: &[f64],
    path: &[f64],
    theta: &[f64],
    columns: &[usize],
    next: &dyn Fn(f64, usize, &[f64]) -> f64,
) -> Linearised {
    let p = columns.len();
    let mut run = Linearised {
        states: 1,
        parameters: p,
        time: (0..ROWS).map(|row| row as f64 * ROW).collect(),
        first: (0..=ROWS).collect(),
        torn: vec![false; ROWS - 1],
        start: (vec![-path[0]], vec![1.0]),
        observe: vec![1.0; ROWS],
        direct: vec![0.0; ROWS * p],
        ..Linearised::default()
    };
    for row in 0..ROWS {
        let (time, residual) = (run.time[row], log[row] - path[row]);
        run.measured.push(Measured { channel: 0, time, residual, slope: 0.0, weight: 1.0 });
        if row + 1 < ROWS {
            let here = next(path[row], row, theta);
            run.transition.push(next(path[row] + 1.0, row, theta) - here);
            run.defect.push(here - path[row + 1]);
            run.drive.extend(columns.iter().map(|column| {
                let (mut moved, step) = (theta.to_vec(), 1e-5 * theta[*column]);
                moved[*column] += step;
                (next(path[row], row, &moved) - here) / step
            }));
        }
    }
    run
}

impl Linearise for Body {
    fn linearise(&self, theta: &[f64], paths: &[Path], columns: &[usize]) -> Result<Vec<Linearised>, Error> {
        let next = |temperature, row, theta: &[f64]| next(temperature, row, theta[0]);
        Ok(vec![linearised(&self.log, &paths[0], theta, columns, &next)])
    }

    fn range(&self, _: usize) -> (f64, f64) {
        (1.0, 1e4)
    }

    fn is_relative(&self, _: usize) -> bool {
        true
    }

    fn scales(&self) -> &[f64] {
        &[1.0]
    }
}

/// Fits a body with this heat capacity from the nominal one.
fn recovers(truth: f64) {
    let body = Body::logged(truth);
    let noise = Noise { channels: vec![SCATTER], process: vec![0.02], jitter: 0.0, disturbance: None };
    let sizes = Sizes { channels: vec![None], process: vec![(1e-8, 1.0)], pinned: Vec::new(), jitter: 0.0 };
    let start = At { theta: vec![NOMINAL], paths: vec![body.log.clone()], noise };
    let nominal = fit(&body, &start, &[], Some(&sizes), &Options::default()).expect("it can be followed");
    let found = fit(&body, &nominal.at, &[0], Some(&sizes), &Options::default()).expect("it can be followed");
    let (capacity, deviation) = (found.at.theta[0], found.deviation(0));
    // three standard deviations of what 400 rows tell
    assert!(
        (capacity - truth).abs() < 3.0 * deviation && deviation < 0.05 * truth,
        "{truth}: {capacity} {deviation}"
    );
    // and what one number more is worth: the model lacks nothing else
    let known = At { theta: vec![truth], ..found.at.clone() };
    let known = fit(&body, &known, &[], Some(&sizes), &Options::default()).expect("it can be followed");
    assert!(found.deviance < known.deviance && known.deviance < found.deviance + 9.0, "{truth}");
    // more than a name must gain among 20 candidates
    assert!(found.deviance < nominal.deviance - 21.0, "{truth}: {} {}", found.deviance, nominal.deviance);
}

#[test]
fn recovers_a_parameter_whose_first_step_leaves_its_range() {
    recovers(20.0);
}

#[test]
fn recovers_a_parameter_that_is_far_from_its_nominal_value() {
    [30.0, 10.0, 6.0, 120.0, 300.0].into_iter().for_each(recovers);
}

/// The body with a second parameter: so many times the heat. No number of it works by its inverse.
struct Heated {
    log: Vec<f64>,
}

impl Heated {
    fn next(temperature: f64, row: usize, theta: &[f64]) -> f64 {
        let stays = libm::exp(-LOSS * ROW / theta[0]);
        let rises = next(0.0, row, theta[0]);
        stays * temperature + theta[1] * rises
    }

    fn logged(truth: &[f64]) -> Self {
        let (mut random, mut temperature) = (Random::new(3), 0.0);
        let mut log = Vec::new();
        for row in 0..ROWS {
            log.push(temperature + FINE_SCATTER * random.normal());
            temperature = Self::next(temperature, row, truth);
        }
        Self { log }
    }
}

impl Linearise for Heated {
    fn linearise(&self, theta: &[f64], paths: &[Path], columns: &[usize]) -> Result<Vec<Linearised>, Error> {
        Ok(vec![linearised(&self.log, &paths[0], theta, columns, &Self::next)])
    }

    fn range(&self, _: usize) -> (f64, f64) {
        (1e-3, 1e4)
    }

    fn scales(&self) -> &[f64] {
        &[1.0]
    }
}

#[test]
fn recovers_two_parameters_whose_first_step_leaves_much_more_than_noise() {
    // bodies that are larger or smaller, heated more or less: the first step is short of both, and what it leaves is far above a noise of 2 mK
    for (larger, gain) in
        [(1.05, 0.8), (1.1, 1.3), (1.15, 0.9), (1.2, 0.9), (1.2, 0.8), (1.3, 1.0), (1.5, 1.1), (1.5, 0.9)]
    {
        let truth = [larger * NOMINAL, gain];
        let body = Heated::logged(&truth);
        let noise =
            Noise { channels: vec![FINE_SCATTER], process: vec![0.02], jitter: 0.0, disturbance: None };
        let sizes = Sizes {
            channels: vec![Some(1e-5)],
            process: vec![(1e-12, 1.0)],
            pinned: Vec::new(),
            jitter: 0.0,
        };
        let start = At { theta: vec![NOMINAL, 1.0], paths: vec![body.log.clone()], noise };
        let nominal = fit(&body, &start, &[], Some(&sizes), &Options::default()).expect("it can be followed");
        let found =
            fit(&body, &nominal.at, &[0, 1], Some(&sizes), &Options::default()).expect("it can be followed");
        for (place, truth) in truth.iter().enumerate() {
            let (value, deviation) = (found.at.theta[place], found.deviation(place));
            // four standard deviations of what 400 rows tell
            assert!(
                (value - truth).abs() < 4.0 * deviation && deviation < 0.01 * truth,
                "{larger}, {gain}: {value} {deviation}"
            );
        }
    }
}

/// The body, which can be followed once.
struct Once<'a> {
    body: Body,
    followed: AtomicBool,
    then: &'a (dyn Fn() -> Error + Sync),
}

impl Linearise for Once<'_> {
    fn linearise(&self, theta: &[f64], paths: &[Path], columns: &[usize]) -> Result<Vec<Linearised>, Error> {
        match self.followed.swap(true, Ordering::Relaxed) {
            false => self.body.linearise(theta, paths, columns),
            true => Err((self.then)()),
        }
    }

    fn range(&self, parameter: usize) -> (f64, f64) {
        self.body.range(parameter)
    }

    fn scales(&self) -> &[f64] {
        self.body.scales()
    }
}

#[test]
fn law_a_fit_ends_where_its_unit_is_given_up_and_not_where_it_fails_on_the_way() {
    let ends = |then: &(dyn Fn() -> Error + Sync)| {
        let body = Body::logged(30.0);
        let noise = Noise { channels: vec![SCATTER], process: vec![0.02], jitter: 0.0, disturbance: None };
        let start = At { theta: vec![NOMINAL], paths: vec![body.log.clone()], noise };
        let once = Once { body, followed: AtomicBool::new(false), then };
        fit(&once, &start, &[0], None, &Options::default())
    };
    assert!(matches!(ends(&|| Error::TooSlow), Err(Error::TooSlow)));
    assert!(ends(&|| Error::Model("it runs away".into())).is_ok());
}
