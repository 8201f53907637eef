//! The acrobot of a scenario, if it has one: which unit is the plant, which the camera, and the numbers that it is drawn by.

use crate::results::Results;
use mechanics::{place::Place, theta::Theta};
use orchestrator::scenario::{Given, UnitEntry};
use serde::Serialize;
use std::collections::BTreeMap;

/// The acrobot as the scripts draw it.
#[derive(Debug, Serialize)]
pub struct Machine {
    /// Name of the plant in its scenario.
    pub plant: String,
    /// Name of the camera, where there is one.
    pub camera: Option<String>,
    /// Numbers of the scene: world units, pixels, rad.
    scene: BTreeMap<&'static str, f64>,
    /// Points (z, q1, q2) of the manifold of equilibria, in order of z; none where there is no manifold.
    manifold: Vec<[f64; 3]>,
    /// Columns by what they are to the drawing: q1, q2, tau, z, z_desired, u1, seen_q1, ...
    #[serde(skip)]
    pub columns: BTreeMap<&'static str, String>,
}

/// The scene where no camera says otherwise: the paper's.
const SCENE: [(&str, f64); 10] = [
    ("R", 1.0),
    ("l1", 6.19),
    ("l2", 6.9),
    ("radius", 0.2),
    ("ground", -8.0),
    ("field_of_view", 20.0),
    ("width", 512.0),
    ("height", 512.0),
    ("omega_cam", 30.0),
    ("background", 0.0),
];
/// What is shown of the plant and of the camera.
const OF_PLANT: [&str; 6] = ["q1", "q2", "tau_applied", "z", "contact", "tau"];
const OF_CAMERA: [&str; 12] =
    ["u1", "v1", "u2", "v2", "u3", "v3", "area1", "area2", "area3", "valid", "frame_index", "t_mid"];
/// Points of the manifold on each side of the upright.
const POINTS: i32 = 60;

impl Machine {
    /// The machine of a run, if its plant's angles were recorded.
    pub fn of(results: &Results) -> Option<Self> {
        let of_kind = |kind: &str| {
            let mut units = results.scenario.units.iter().filter(|unit| file_stem(unit) == kind);
            let first = units.clone().next();
            units.find(|unit| matches!(unit.name.as_str(), "plant" | "camera")).or(first)
        };
        let plant = of_kind("acrobot_plant")?;
        let camera = of_kind("acrobot_camera");
        let mut columns = BTreeMap::new();
        let mut take = |part: &'static str, unit: &str, variable: &str| {
            let name = format!("{unit}.{variable}");
            if results.column(&name).is_some() {
                columns.insert(part, name);
            }
        };
        OF_PLANT.iter().for_each(|variable| take(variable, &plant.name, variable));
        if let Some(camera) = camera {
            OF_CAMERA.iter().for_each(|variable| take(variable, &camera.name, variable));
            // What the camera looks at may be another arm than the one that is drawn.
            take("seen_q1", &camera.name, "q1");
            take("seen_q2", &camera.name, "q2");
        }
        if let Some(controller) = drives(results, &plant.name) {
            take("z_desired", controller, "z_desired");
        }
        if !columns.contains_key("q1") || !columns.contains_key("q2") {
            return None;
        }
        let mut scene: BTreeMap<&'static str, f64> = SCENE.into();
        for (name, value) in &mut scene {
            *value = camera.and_then(|camera| number(camera, name)).unwrap_or(*value);
        }
        scene.insert("slope", number(plant, "slope").unwrap_or(0.0));
        Some(Self {
            plant: plant.name.clone(),
            camera: camera.map(|camera| camera.name.clone()),
            scene,
            manifold: manifold(plant),
            columns,
        })
    }
}

/// The unit whose torque the plant gets.
fn drives<'a>(results: &'a Results, plant: &str) -> Option<&'a str> {
    let input = format!("{plant}.tau");
    let connection = results.scenario.connections.iter().find(|connection| connection.to == input)?;
    connection.from.split_once('.').map(|(unit, _)| unit)
}

fn file_stem(unit: &UnitEntry) -> &str {
    let name = unit.fmu.value.rsplit(['/', '\\']).next().unwrap_or_default();
    name.strip_suffix(".fmu").unwrap_or(name)
}

/// A number that was set.
fn number(unit: &UnitEntry, name: &str) -> Option<f64> {
    let (_, given) = unit.set.iter().find(|(known, _)| known == name)?;
    match &given.value {
        Given::Toml(value) => value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64)),
        Given::Text(text) => text.parse().ok(),
    }
}

/// The equilibria of the plant's own parameters.
fn manifold(plant: &UnitEntry) -> Vec<[f64; 3]> {
    let of = |name: &str| number(plant, name);
    let theta = || {
        Some(Theta {
            theta_1: of("theta_1")?,
            theta_2: of("theta_2")?,
            theta_5: of("theta_5")?,
            theta_7: of("theta_7")?,
            theta_8: of("theta_8")?,
            theta_9: of("theta_9")?,
            theta_10: of("theta_10")?,
        })
    };
    // A plant without a manifold is drawn without one.
    let Some((theta, place)) = theta().and_then(|theta| Some((theta, Place::new(&theta).ok()?))) else {
        return Vec::new();
    };
    let point = |step: i32| {
        let q2 = f64::from(step) / f64::from(POINTS) * mechanics::place::ARM_END;
        Some([place.z(q2), theta.manifold_q1(q2).ok()?, q2])
    };
    (-POINTS..=POINTS).filter_map(point).collect()
}
