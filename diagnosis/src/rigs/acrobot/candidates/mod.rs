//! What may be missing: every candidate is an FMU parameter with a neutral value.
//!
//! The list (in `list.rs`) is data: a name, how the parameter moves, and a phrase a person would use. Nothing here
//! says what a candidate does; its signature comes from moving it in the unit itself.

mod attributes;
mod list;
mod of_model;

pub use attributes::{Attribute, actuator, name, names, place, variable};
pub use list::{DEFOCUS, EXPOSURE, LIST};
pub use of_model::{candidates, continuous};

/// Which cut of the loop shows a candidate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Between commanded torque and motion.
    Plant,
    /// Between motion and the image.
    Camera,
    /// In the plant log's timestamps: a nuisance that is found like an effect and never named.
    Clock,
    /// In the zeros of the plant log's angles: a nuisance, too.
    Zero,
    /// In the timestamps of images, where they have a clock of their own: a nuisance in the place of a delay.
    Timestamps,
    /// In the count of images.
    Count,
    /// In the scatter of the image's signals.
    SensorNoise,
}

impl Side {
    /// It is about the log and no part of the machine: cleared, told, and never named.
    pub fn is_of_log(self) -> bool {
        matches!(self, Self::Clock | Self::Zero | Self::Timestamps)
    }
}

/// How a parameter moves away from its neutral value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motion {
    /// A real number; steps in the parameter's own unit.
    Real {
        /// Displacements from off at which it is tried; the first is also the step of its derivative.
        steps: &'static [f64],
        /// Smallest and largest value.
        range: (f64, f64),
    },
    /// A torque or what goes with one: a real number whose steps are those for an arm of inertia scale 1.
    Load {
        /// As in `Real`, times the arm's inertia scale.
        steps: &'static [f64],
        /// As in `Real`, times the arm's inertia scale.
        range: (f64, f64),
    },
    /// A real number whose steps and range are shares of its nominal value; not a candidate where that is 0.
    Share {
        /// As in `Real`, times the nominal value.
        steps: &'static [f64],
        /// As in `Real`, times the nominal value.
        range: (f64, f64),
    },
    /// A saturation with 0 = none. Works in 1/value, in which "none" is 0 and a tighter saturation is larger.
    Saturation {
        /// A quantity that the saturation cuts, whose quantiles are tried.
        cuts: Cuts,
    },
    /// A whole number, not below 0.
    Count {
        /// Largest that is tried at first; who wants that is tried further on, one by one.
        tried: i32,
        /// Largest that is tried.
        most: i32,
    },
    /// True or false; the other than nominal is tried.
    Switch,
}

/// What a saturation cuts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cuts {
    /// The commanded torque.
    Torque,
    /// Its rate.
    TorqueRate,
}

/// An entry of the list.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Entry {
    /// `instance.variable`.
    pub name: &'static str,
    /// Where it shows.
    pub side: Side,
    /// How it moves.
    pub motion: Motion,
    /// Its size changes what it does, not only how much: columns tell little of it before it is fitted.
    pub nonlinear: bool,
    /// What a person would call it.
    pub phrase: &'static str,
    /// What code asks of it.
    pub attributes: &'static [Attribute],
    /// The term of a correction that says the same.
    pub twin: Option<&'static str>,
}

/// A candidate of one diagnosis: an entry with the nominal model's neutral value.
///
/// `x` is the coordinate in which the diagnosis works: the value itself, or 1/value for a saturation.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// `instance.variable`.
    pub name: &'static str,
    /// Where it shows.
    pub side: Side,
    /// What a person would call it.
    pub phrase: &'static str,
    /// How it moves.
    pub motion: Motion,
    /// x at which the model is the nominal one.
    pub off: f64,
    /// Displacements of x at which it is tried.
    pub steps: Vec<f64>,
    /// Smallest and largest x.
    pub range: (f64, f64),
    /// Its size changes what it does, not only how much.
    pub nonlinear: bool,
    /// What code asks of it.
    pub attributes: &'static [Attribute],
}

impl Candidate {
    /// The parameter's value at a coordinate.
    pub fn value(&self, x: f64) -> f64 {
        match self.motion {
            Motion::Saturation { .. } => {
                if x > 0.0 {
                    1.0 / x
                } else {
                    0.0
                }
            }
            // no zero with a sign
            Motion::Count { .. } | Motion::Switch => x.round() + 0.0,
            _ => x,
        }
    }

    /// Coulomb friction: with it the arm rests until it is pushed hard enough.
    pub fn sticks(&self) -> bool {
        self.is(Attribute::Sticks)
    }

    /// The whole number after the largest that is tried, or after one beyond it.
    pub fn count_after(&self, x: f64) -> Option<f64> {
        let tried = self.steps.last().map_or(f64::INFINITY, |step| self.off + step);
        let counts = matches!(self.motion, Motion::Count { .. });
        (counts && x >= tried && x < self.range.1).then_some(x + 1.0)
    }

    /// It takes a few separate values only.
    pub fn is_discrete(&self) -> bool {
        matches!(self.motion, Motion::Count { .. } | Motion::Switch)
    }

    /// It stands at an end of what is searched, where values may lie beyond: not of a switch, which has two.
    pub fn ends_at(&self, x: f64) -> bool {
        self.motion != Motion::Switch && x != self.off && (x <= self.range.0 || x >= self.range.1)
    }

    /// Stopped by a bound that is there against nonsense: something else is missing, for which this one stands in. None at all is
    /// no nonsense, where a nominal machine has friction that the real one lacks.
    pub fn is_at_its_end(&self, x: f64) -> bool {
        let bounded = self.side == Side::Plant && !self.is_discrete();
        bounded && x != self.off && x != 0.0 && (x <= self.range.0 || x >= self.range.1)
    }

    /// Step for a derivative at a coordinate, towards the inside of the range.
    pub fn derivative_step(&self, x: f64) -> f64 {
        let size = match self.motion {
            Motion::Saturation { .. } => 0.002 * x.abs(),
            _ => self.steps.first().copied().unwrap_or(0.0).abs(),
        };
        if x + size > self.range.1 { -size } else { size }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::dataset::{DataSet, Manifest};
    use crate::rigs::acrobot::model::Model;
    use std::collections::BTreeMap;
    use toml::Value;

    #[test]
    fn no_load_is_tried_that_makes_the_unit_a_thousand_times_as_slow() {
        // an arm of inertia scale 1 has inertias of some 0.1 kg·m²: the unit then resolves decays of 0.5 ms
        let stiff = |entry: &&Entry| matches!(entry.motion, Motion::Load { range, .. } if range.1 > 200.0);
        assert_eq!(LIST.iter().filter(stiff).map(|entry| entry.name).collect::<Vec<_>>(), [""; 0]);
    }

    #[test]
    fn no_switch_is_less_than_off() {
        let switch = Candidate {
            name: "plant.velocity_terms",
            side: Side::Plant,
            phrase: "",
            motion: Motion::Switch,
            off: 1.0,
            steps: vec![-1.0],
            range: (0.0, 1.0),
            nonlinear: true,
            attributes: &[],
        };
        // an end of an interval
        assert_eq!(switch.value(-1e-9).to_string(), "0");
        // there is nothing beyond
        assert!(!switch.ends_at(0.0));
    }

    #[test]
    fn value_a_ceiling_works_in_the_inverse_and_none_is_zero() {
        let motion = Motion::Saturation { cuts: Cuts::Torque };
        let saturation = Candidate {
            name: "plant.tau_max",
            side: Side::Plant,
            phrase: "",
            motion,
            off: 0.0,
            steps: vec![0.5],
            range: (0.0, f64::INFINITY),
            nonlinear: true,
            attributes: &[],
        };
        assert_eq!([0.0, -1e-9, 0.5, 4.0].map(|x| saturation.value(x)), [0.0, 0.0, 2.0, 0.25]);
        assert_eq!(saturation.derivative_step(0.5), 0.001);
    }

    /// Candidates of an arm whose inertias are so many times those of the paper, with more set.
    fn found(scale: f64, more: &[(&str, f64)]) -> Vec<Candidate> {
        let theta = [0.20386, 0.05867, 0.11, 0.01437, 0.0989, 4.779, 1.880]; // Table 2
        let names = [1, 2, 5, 7, 8, 9, 10].map(|k| format!("plant.theta_{k}"));
        let set = names.into_iter().zip(theta).map(|(name, value)| (name, Value::Float(scale * value)));
        let more = more.iter().map(|(name, value)| ((*name).to_owned(), Value::Float(*value)));
        let manifest = Manifest {
            stated: crate::rigs::acrobot::dataset::stated_log::Stated::default(),
            scenario: "visual-servo".into(),
            set: set.chain(more).collect(),
            noise: BTreeMap::new(),
            runs: Vec::new(),
        };
        let data = DataSet {
            path: ".".into(),
            manifest,
            runs: Vec::new(),
            notices: Vec::new(),
            clocks_apart: false,
            late_by_hand: 0.0,
            frames_apart: false,
            blind: BTreeMap::new(),
        };
        let model = Model::load(&data, &scenarios::unit_path()).expect("cargo xtask pack was run");
        candidates(&model, &[], &|_| vec![0.5])
    }

    #[test]
    fn every_bound_of_a_load_goes_with_the_inertia() {
        // the lighter link's inertia is 0.11 kg·m², usual; then 0.24, twice the largest usual one
        let (usual, heavy) = (found(1.0, &[]), found(24.0 / 11.0, &[]));
        for (name, times) in [("plant.b_joint", 2.0), ("plant.tau_bias", 2.0), ("plant.T_act", 1.0)] {
            let of =
                |list: &[Candidate]| list.iter().find(|one| one.name == name).expect("a candidate").clone();
            let (one, other) = (of(&usual), of(&heavy));
            for (a, b) in
                [(one.range.0, other.range.0), (one.range.1, other.range.1), (one.steps[0], other.steps[0])]
            {
                assert!((b - times * a).abs() <= 1e-12 * a.abs(), "{name}: {a}, {b}");
            }
            assert!(one.range.1 > 0.0 && one.steps[0] > 0.0);
        }
    }

    #[test]
    fn value_a_ceiling_begins_at_the_nominal_one_or_at_none() {
        let of = |more: &[(&str, f64)]| {
            let all = found(1.0, more);
            all.into_iter().find(|one| one.name == "plant.tau_max").expect("a candidate")
        };
        // the only level that is tried is 0.5 N·m
        let none = of(&[]);
        assert_eq!((none.off, none.value(none.off), none.steps.as_slice()), (0.0, 0.0, [2.0].as_slice()));
        // of 4 N·m: a tenth and a half tighter, in the inverse
        let some = of(&[("plant.tau_max", 4.0)]);
        assert_eq!((some.off, some.value(some.off)), (0.25, 4.0));
        assert!((some.steps[0] - 0.025).abs() < 1e-15 && (some.steps[1] - 0.125).abs() < 1e-15);
        // however heavy the arm, from none to no torque at all
        let heavy = found(24.0 / 11.0, &[]).into_iter().find(|one| one.name == "plant.tau_max");
        assert_eq!(heavy.map(|one| (one.range, one.steps)), Some(((0.0, f64::INFINITY), vec![2.0])));
    }

    #[test]
    fn every_bound_of_a_plant_but_none_at_all_is_an_end() {
        let motion = Motion::Real { steps: &[0.1], range: (0.0, 1.0) };
        let lag = |side, off| Candidate {
            name: "plant.T_act",
            side,
            phrase: "",
            motion,
            off,
            steps: vec![0.1],
            range: (0.0, 1.0),
            nonlinear: false,
            attributes: &[],
        };
        for off in [0.0, 0.2] {
            let ends = [0.0, 0.5, 1.0].map(|x| lag(Side::Plant, off).is_at_its_end(x));
            assert_eq!(ends, [false, false, true]);
        }
        // an exposure of the whole interval is one
        assert!(!lag(Side::Camera, 0.0).is_at_its_end(1.0));
    }
}
