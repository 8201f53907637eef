//! What the studies of Section 4.2 share: sets of poles, a closed loop with its reference, and what became of it.

use crate::{Bench, Error};
use orchestrator::scenario::{Placed, Shape, SignalEntry};
use orchestrator::{Comparison, Ended, MemoryRecorder, Place, Quiet, Scenario, Simulation, time::Rational};
use rayon::prelude::*;
use std::fmt::Display;

/// A named choice of closed-loop poles: s² + 2ζωs + ω² twice. The paper's own set is that of its reference 27,
/// which is not available.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Poles {
    /// Name in tables and captions.
    pub name: &'static str,
    /// ω₁, ζ₁, ω₂, ζ₂ in rad/s and 1.
    pub pairs: [f64; 4],
}

/// Every claim on stability together.
pub const ALL: Poles = Poles { name: "all", pairs: [4.02, 1.03, 2.76, 0.35] };
/// Steady errors as the paper's, at the edge of stability.
pub const TIGHT: Poles = Poles { name: "tight", pairs: [4.51, 0.98, 2.96, 0.20] };
/// The shipped scenarios' choice.
pub const DAMPED: Poles = Poles { name: "damped", pairs: [6.11, 0.84, 3.52, 0.54] };
/// The three of them.
pub const SETS: [Poles; 3] = [ALL, TIGHT, DAMPED];

impl Poles {
    /// a₀, a₁, a₂, a₃ of s⁴ + a₃s³ + a₂s² + a₁s + a₀.
    pub fn polynomial(&self) -> [f64; 4] {
        let [omega_1, zeta_1, omega_2, zeta_2] = self.pairs;
        let (damping_1, damping_2) = (2.0 * zeta_1 * omega_1, 2.0 * zeta_2 * omega_2);
        let (square_1, square_2) = (omega_1 * omega_1, omega_2 * omega_2);
        [
            square_1 * square_2,
            damping_1 * square_2 + damping_2 * square_1,
            square_1 + square_2 + damping_1 * damping_2,
            damping_1 + damping_2,
        ]
    }
}

/// The camera's N_min and N_max for strong lenses: undistorted circles have 75 px.
pub const ANY_AREA: [(&str, f64); 2] = [("N_min", 15.0), ("N_max", 400.0)];

/// A closed loop to be run: which scenario, with what changed, along which reference.
#[derive(Debug, Clone)]
pub struct Case {
    scenario: &'static str,
    set: Vec<(String, String)>,
    /// Inputs that another output feeds than in the scenario: (input, output).
    fed: Vec<(String, String)>,
    points: Vec<(f64, f64)>,
    stop: Rational,
    intervals: Option<Rational>,
}

/// |q₁| at which link 1 counts as fallen although the links don't touch, rad.
const FALLEN: f64 = 1.5;

impl Case {
    /// The loop closed by the camera, `visual-servo`, along the reference 0 → 0.5 → 0 → −0.5 → 0.
    pub fn visual(poles: Poles) -> Case {
        Case::new("visual-servo", poles)
    }

    /// The loop closed by the true state, `full-state`, along the same reference.
    pub fn full_state(poles: Poles) -> Case {
        Case::new("full-state", poles)
    }

    /// An inner loop closed by the true state, whose set point the camera reads from an object, `dual-loop`.
    pub fn dual_loop(poles: Poles) -> Case {
        Case::new("dual-loop", poles)
    }

    fn new(scenario: &'static str, poles: Poles) -> Case {
        let [omega_1, zeta_1, omega_2, zeta_2] = poles.pairs;
        let both_ways = [(0.0, 0.0), (2.0, 0.0), (12.0, 0.5), (18.0, 0.5), (28.0, 0.0), (31.0, 0.0)];
        let back = [(41.0, -0.5), (47.0, -0.5), (57.0, 0.0)];
        let case = Case {
            scenario,
            set: Vec::new(),
            fed: Vec::new(),
            points: Vec::new(),
            stop: Rational::ZERO,
            intervals: None,
        };
        case.along([&both_ways[..], &back[..]].concat(), 60)
            .with("controller.omega_1", omega_1)
            .with("controller.zeta_1", zeta_1)
            .with("controller.omega_2", omega_2)
            .with("controller.zeta_2", zeta_2)
    }

    /// With a value of `unit.variable` changed.
    #[must_use]
    pub fn with(mut self, variable: &str, value: impl Display) -> Case {
        self.set.push((variable.to_owned(), value.to_string()));
        self
    }

    /// With an input fed by another output than in the scenario.
    #[must_use]
    pub fn fed(mut self, input: &str, output: &str) -> Case {
        self.fed.push((input.to_owned(), output.to_owned()));
        self
    }

    /// With some of the camera's variables changed, by bare name.
    #[must_use]
    pub fn through(self, lens: &[(&str, f64)]) -> Case {
        lens.iter().fold(self, |case, (variable, value)| case.with(&format!("camera.{variable}"), value))
    }

    /// With an N_min and an N_max that let circles through which a strong lens makes small or large, so that what
    /// fails is not the identification.
    #[must_use]
    pub fn finding_everything(self) -> Case {
        self.through(&ANY_AREA)
    }

    /// Along another reference, smooth between its points (time in s, z), for so many seconds.
    #[must_use]
    pub fn along(mut self, points: Vec<(f64, f64)>, seconds: u16) -> Case {
        self.points = points;
        self.stop = whole(seconds);
        self
    }

    /// From rest on the manifold at `q1`, `q2`, asked to stay at `z`.
    #[must_use]
    pub fn resting(self, [q1, q2]: [f64; 2], z: f64, seconds: u16) -> Case {
        self.with("plant.q1_0", q1).with("plant.q2_0", q2).along(vec![(0.0, z)], seconds)
    }

    /// With one communication interval for all units: 1/(`rate`·`parts`) s.
    #[must_use]
    pub fn every(mut self, rate: u16, parts: u16) -> Case {
        self.intervals = Rational::new(1, i128::from(rate) * i128::from(parts));
        self
    }

    /// The scenario, with everything that is looked at recorded.
    pub fn scenario(&self, bench: &Bench) -> Result<Scenario, Error> {
        let set: Vec<(&str, &str)> = self.set.iter().map(|(name, value)| (&**name, &**value)).collect();
        let mut scenario = bench.scenario(self.scenario, &set)?;
        for source in scenario.sources.iter_mut().filter(|source| source.to.ends_with(".z_desired")) {
            source.signal = SignalEntry::Table { shape: Shape::Smooth, points: self.points.clone() };
        }
        for (input, output) in &self.fed {
            for connection in scenario.connections.iter_mut().filter(|connection| connection.to == *input) {
                connection.from.clone_from(output);
            }
        }
        scenario.stop = self.stop;
        if let Some(interval) = self.intervals {
            scenario.units.iter_mut().for_each(|unit| unit.interval = interval);
        }
        let recorded = ["controller.z_desired", "plant.z", "plant.q1", "plant.q2", "controller.tau"];
        let placed = |name: &str| Placed { value: name.to_owned(), place: Place::Override("a study".into()) };
        scenario.record = Some(recorded.into_iter().chain(["plant.contact"]).map(placed).collect());
        Ok(scenario)
    }

    /// Builds it, to be run once or more often.
    pub fn build(&self, bench: &Bench) -> Result<ClosedLoop, Error> {
        let mut simulation = bench.simulation(&self.scenario(bench)?)?;
        simulation.stop_when("plant.contact", Comparison::Above, 0.5)?;
        simulation.stop_when("plant.q1", Comparison::AbsoluteAbove, FALLEN)?;
        Ok(ClosedLoop { simulation, bench: bench.clone() })
    }

    /// Builds and runs it.
    pub fn run(&self, bench: &Bench) -> Result<Trace, Error> {
        self.build(bench)?.run()
    }
}

/// So many seconds.
fn whole(seconds: u16) -> Rational {
    Rational::new(i128::from(seconds), 1).unwrap_or(Rational::ZERO) // a denominator of 1 always fits
}

/// A built loop; its units are used again from run to run.
pub struct ClosedLoop {
    simulation: Simulation,
    bench: Bench,
}

impl ClosedLoop {
    /// Gives a start value or parameter for the next runs.
    pub fn set(&mut self, variable: &str, value: f64) -> Result<(), Error> {
        Ok(self.simulation.set(variable, value * self.bench.factor(variable))?)
    }

    /// Runs it from the start to its end or to its fall.
    pub fn run(&mut self) -> Result<Trace, Error> {
        let mut results = MemoryRecorder::new();
        self.simulation.reset();
        let ended = self.simulation.run(&mut results, &mut Quiet)?;
        let series = |name: &str| results.series(name).map(<[f64]>::to_vec);
        Ok(Trace {
            fell: if let Ended::When { time, .. } = ended { Some(time) } else { None },
            times: results.times().to_vec(),
            z_desired: series("controller.z_desired")?,
            z: series("plant.z")?,
            q1: series("plant.q1")?,
            q2: series("plant.q2")?,
            tau: series("controller.tau")?,
        })
    }
}

/// What became of a closed loop, a value a communication point.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// When the links touched or link 1 fell, s.
    pub fell: Option<f64>,
    /// Times, s.
    pub times: Vec<f64>,
    /// The reference.
    pub z_desired: Vec<f64>,
    /// Where the acrobot truly was.
    pub z: Vec<f64>,
    /// Angle of link 1, rad.
    pub q1: Vec<f64>,
    /// Angle of link 2, rad.
    pub q2: Vec<f64>,
    /// Torque asked for, N·m.
    pub tau: Vec<f64>,
}

impl Trace {
    /// It stood to the end.
    pub fn is_stable(&self) -> bool {
        self.fell.is_none()
    }

    /// Places of the rows of a span of time, both ends included.
    fn rows(&self, from: f64, to: f64) -> std::ops::Range<usize> {
        let edge = |time: f64| self.times.partition_point(|&t| t < time - 1e-9);
        edge(from)..self.times.partition_point(|&t| t <= to + 1e-9)
    }

    /// Mean of z_desired − z over a span of time: the steady error, with the chatter averaged out. NaN where it fell
    /// before.
    pub fn steady_error(&self, from: f64, to: f64) -> f64 {
        if self.fell.is_some_and(|time| time < to) {
            return f64::NAN;
        }
        let rows = self.rows(from, to);
        let count = rows.len() as f64;
        rows.map(|row| self.z_desired[row] - self.z[row]).sum::<f64>() / count
    }

    /// Mean of z over a span of time; NaN where it fell before.
    pub fn mean_z(&self, from: f64, to: f64) -> f64 {
        if self.fell.is_some_and(|time| time < to) {
            return f64::NAN;
        }
        let rows = self.rows(from, to);
        let count = rows.len() as f64;
        rows.map(|row| self.z[row]).sum::<f64>() / count
    }

    /// Standard deviation of the torque over a span of time at rest.
    pub fn ripple(&self, from: f64, to: f64) -> f64 {
        let torques = &self.tau[self.rows(from, to)];
        let mean = torques.iter().sum::<f64>() / torques.len() as f64;
        rms(torques.iter().map(|torque| torque - mean))
    }

    /// z_desired − z over time, thirty times a second: with full state feedback the reference is read that often, and
    /// between two readings the old one would be compared with the new place.
    pub fn tracking_error(&self) -> Vec<(f64, f64)> {
        let is_read = |time: f64| (30.0 * time - (30.0 * time).round()).abs() < 1e-6;
        let rows = self.times.iter().zip(self.z_desired.iter().zip(&self.z));
        rows.filter(|(time, _)| is_read(**time)).map(|(time, (desired, z))| (*time, desired - z)).collect()
    }

    /// Root mean square of z_desired − z.
    pub fn rms_error(&self) -> f64 {
        rms(self.tracking_error().into_iter().map(|(_, error)| error))
    }

    /// The torque at frame times k·`period` over a span of time.
    pub fn torques(&self, period: f64, from: f64, to: f64) -> Vec<f64> {
        let frames = (from / period).ceil() as usize..=(to / period + 1e-6).floor() as usize;
        frames
            .filter_map(|frame| {
                let row = self.times.partition_point(|&t| t < frame as f64 * period - 1e-9);
                self.tau.get(row).copied()
            })
            .collect()
    }

    /// Root mean square of the steps of the torque from frame to frame: the chatter.
    pub fn chatter(&self, period: f64, from: f64, to: f64) -> f64 {
        rms(self.torques(period, from, to).windows(2).map(|pair| pair[1] - pair[0]))
    }

    /// "stable", or when it fell.
    pub fn fate(&self) -> String {
        self.fell.map_or_else(|| "stable".to_owned(), |time| format!("loses balance at {time:.1} s"))
    }
}

/// Root mean square.
pub fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value * value, count + 1.0));
    (sum / count).sqrt()
}

/// Runs cases side by side; results in the order of the cases.
pub fn run_all(bench: &Bench, cases: &[Case]) -> Result<Vec<Trace>, Error> {
    cases.par_iter().map(|case| case.run(bench)).collect()
}
