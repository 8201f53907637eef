//! What the nominal model says of sizes before any FMU runs: how large an image is, how fast an arm falls. Values are those of
//! `[set]`, else those of the scenario, else the start values of our FMUs, which are the paper's.

use super::manifest::number;
use super::{Manifest, lines};
use crate::error::Error;
use crate::opened::model;
use crate::rigs::acrobot::candidates::{Attribute, name};
use crate::rigs::acrobot::dataset::policy::LOGS;
use crate::rigs::acrobot::parameters;
use mechanics::Theta;
use orchestrator::Scenario;
use orchestrator::scenario::Given;
use std::collections::BTreeMap;
use std::path::Path;
use toml::Value;

/// Sizes by which logs are judged before they are compared with the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nominal {
    /// The rate (rad/s) that gravity gives each link, √(θ₉/θ₁) and √(θ₁₀/θ₅). A free arm of 9 cm that tumbles moves up to 4 times
    /// as fast (seen on a real one); in degrees a swing of 10° is 10 times as fast.
    pub falling: [f64; 2],
    /// The torque by which gravity pulls at most on the links, N·m.
    pub gravity: f64,
    /// Width and height of the image, px.
    pub image: (f64, f64),
    /// Time between frames, s.
    pub interval: f64,
    /// Height of circle 1, the drum's centre, over the middle of the image, px; `None` where the mount is turned.
    pub ground: Option<f64>,
    /// How long it shows the links, px.
    pub links: [f64; 2],
}

impl Nominal {
    /// The sizes that a data set in `folder` states.
    ///
    /// # Errors
    /// The scenario isn't there or can't be read.
    pub fn of(folder: &Path, manifest: &Manifest) -> Result<Self, Error> {
        Ok(Self::by(&scenario(folder, &manifest.scenario)?, &manifest.set))
    }

    /// The sizes that a scenario with `[set]` states; what neither says is the paper's arm's.
    fn by(scenario: &Scenario, set: &BTreeMap<String, Value>) -> Self {
        let value = |name: &str, usual: f64| {
            set.get(name).and_then(number).or_else(|| given(scenario, name)).unwrap_or(usual)
        };
        let Theta { theta_1, theta_5, theta_9, theta_10, .. } = Theta::TABLE_2;
        let of_plant = |name: &str, usual: f64| value(&format!("plant.{name}"), usual);
        let [inertias, weights] = [
            [of_plant("theta_1", theta_1), of_plant("theta_5", theta_5)],
            [of_plant("theta_9", theta_9), of_plant("theta_10", theta_10)],
        ];
        // a sign that is wrong is the nominal model's fault, and told when that is loaded
        let positive = |value: f64, usual: f64| if value > 0.0 { value } else { usual };
        let rate = |weight: f64, inertia: f64| (weight / inertia).sqrt();
        let falling = [
            rate(positive(weights[0], theta_9), positive(inertias[0], theta_1)),
            rate(positive(weights[1], theta_10), positive(inertias[1], theta_5)),
        ];
        let image = (value(parameters::WIDTH, 512.0), value(parameters::HEIGHT, 512.0));
        let turned = [name(Attribute::CameraRoll), parameters::MOUNT]
            .iter()
            .any(|name| value(name, 0.0).abs() > LOGS.turned);
        let scale = image.0 / value(parameters::FIELD_OF_VIEW, 20.0);
        let drum = value(parameters::GROUND, -8.0) + value(parameters::DRUM, 1.0);
        Self {
            falling,
            gravity: weights.iter().map(|weight| weight.abs()).sum(),
            image,
            interval: 1.0 / value(parameters::FRAME_RATE, 30.0),
            ground: (!turned).then_some(drum * scale),
            links: parameters::LINKS.map(|(name, usual)| scale * value(name, usual)),
        }
    }
}

/// The scenario that a data set names: a path beside it, or the name of a shipped one.
///
/// # Errors
/// There is none, or it can't be read.
pub fn scenario(folder: &Path, name: &str) -> Result<Scenario, Error> {
    let beside = folder.join(name);
    if beside.is_file() {
        return Scenario::load(beside).map_err(model);
    }
    let path = folder.join("dataset.toml");
    scenarios::load(name).map_err(|error| Error::Manifest {
        line: lines::line_of(&path, "scenario"),
        problem: error.to_string(),
        path,
    })
}

/// A value that the scenario sets, `instance.variable`.
fn given(scenario: &Scenario, name: &str) -> Option<f64> {
    let (instance, variable) = name.split_once('.')?;
    let unit = scenario.units.iter().find(|unit| unit.name == instance)?;
    match &unit.set.iter().find(|(own, _)| own == variable)?.1.value {
        Given::Toml(value) => number(value),
        Given::Text(text) => text.parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(set: &str, camera: &str) -> Nominal {
        let unit = |name: &str| {
            format!("[[units]]\nname = \"{name}\"\nfmu = \"acrobot_{name}.fmu\"\ninterval = \"1/60\"\n")
        };
        let text = format!(
            "format = 1\n[experiment]\nstop = 1\n{}{}[units.set]\n{camera}\n",
            unit("plant"),
            unit("camera")
        );
        let scenario = Scenario::parse(&text, "mine.toml").expect("it is good");
        let set: toml::Table = set.parse().expect("it is TOML");
        Nominal::by(&scenario, &set.into_iter().collect())
    }

    #[test]
    fn the_size_of_an_image_is_that_of_set_then_of_the_scenario_then_the_paper_s() {
        assert_eq!(of("", "").image, (512.0, 512.0));
        assert_eq!(of("", "width = 640\nheight = 480").image, (640.0, 480.0));
        assert_eq!(of("\"camera.width\" = 800", "width = 640\nheight = 480").image, (800.0, 480.0));
        // 7 of 20 world units below the middle
        assert_eq!(of("", "width = 640").ground, Some(-224.0));
        assert_eq!(of("", "mount = 0.7").ground, None);
        assert_eq!(of("", "omega_cam = 60").interval, 1.0 / 60.0);
    }

    #[test]
    fn an_arm_that_weighs_nothing_is_told_by_its_model_and_not_by_a_division_here() {
        let of = |theta: usize, value: f64| of(&format!("\"plant.theta_{theta}\" = {value:?}"), "").falling;
        assert!(of(9, 9.0)[0] > of(9, 4.0)[0]);
        assert!([of(1, 0.0), of(9, -1.0)].iter().flatten().all(|rate| rate.is_finite()));
    }
}
