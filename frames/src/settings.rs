//! The camera of a scenario as values of the unit's own variables, and what is told of frames that do not fit them.

use crate::error::Error;
use camera::Variables;
use fmi2_export::{ModelError, SlotMut, Table};
use orchestrator::scenario::{Given, UnitEntry};
use orchestrator::suggest::nearest;
use std::path::Path;

/// Stem of the file of the camera unit.
const CAMERA: &str = "acrobot_camera";
/// What the instance is called if a scenario has several cameras.
const NAME: &str = "camera";
/// Regions whose areas are told of a frame without circles.
const TOLD: usize = 6;

/// The camera of a scenario.
#[derive(Debug, Clone)]
pub struct Settings {
    /// The scenario, as the user named it.
    pub scenario: String,
    /// Name of the instance.
    pub instance: String,
    /// Its values.
    pub variables: Variables,
}

/// Reads the camera of a scenario.
pub fn read(name: &str, set: &[String]) -> Result<Settings, Error> {
    let mut scenario = scenarios::load(name)?;
    for given in set {
        let (variable, value) = given.split_once('=').unwrap_or((given, ""));
        scenario.set(variable, value)?;
    }
    let of_ours =
        |unit: &&UnitEntry| Path::new(&unit.fmu.value).file_stem().is_some_and(|stem| stem == CAMERA);
    let cameras: Vec<&UnitEntry> = scenario.units.iter().filter(of_ours).collect();
    let wrong = |what: String, expected: String| Error::Camera { scenario: name.to_owned(), what, expected };
    let unit = match cameras.as_slice() {
        [] => {
            return Err(wrong(
                format!("no unit {CAMERA}.fmu"),
                "the vision is that unit's; try --scenario visual-servo".into(),
            ));
        }
        [unit] => unit,
        several => several.iter().find(|unit| unit.name == NAME).ok_or_else(|| {
            wrong(
                format!("{} cameras", several.len()),
                format!("the one whose frames these are must be called {NAME}"),
            )
        })?,
    };
    let mut variables = Variables::default();
    for (variable, given) in &unit.set {
        let declared = Variables::variables();
        let Some(index) = declared.iter().position(|declared| declared.name == variable) else {
            let known = nearest(variable, declared.iter().map(|declared| declared.name));
            return Err(wrong(format!("{}.{variable} is no variable of the camera", unit.name), known));
        };
        let text = match &given.value {
            Given::Toml(toml::Value::String(text)) | Given::Text(text) => text.clone(),
            Given::Toml(value) => value.to_string(),
        };
        if let Some(expected) = variables.get_mut(index).and_then(|slot| refused(slot, &text)) {
            return Err(wrong(format!("{}.{variable} = {text}", unit.name), format!("expected {expected}")));
        }
    }
    Ok(Settings { scenario: name.to_owned(), instance: unit.name.clone(), variables })
}

/// Puts a value where it belongs, or says what was expected.
fn refused(slot: SlotMut<'_>, text: &str) -> Option<&'static str> {
    fn put<T: std::str::FromStr>(into: &mut T, text: &str, kind: &'static str) -> Option<&'static str> {
        match text.parse() {
            Ok(value) => {
                *into = value;
                None
            }
            Err(_) => Some(kind),
        }
    }
    match slot {
        SlotMut::Real(into) => put(into, text, "a number"),
        SlotMut::Integer(into) => put(into, text, "a whole number"),
        SlotMut::Boolean(into) => put(into, text, "true or false"),
        SlotMut::String(into) => put(into, text, "a text"),
    }
}

impl Settings {
    /// A value that the unit itself refuses.
    pub fn refused(&self, source: ModelError) -> Error {
        let (what, expected) = match source {
            ModelError::Value { name, value, expected } => {
                (format!("{}.{name} = {value}", self.instance), format!("expected {expected}"))
            }
            other => (self.instance.clone(), other.to_string()),
        };
        Error::Camera { scenario: self.scenario.clone(), what, expected }
    }

    /// Whether a frame has the size that the sensor has.
    pub fn fits(
        &self,
        path: &Path,
        (columns, rows): (usize, usize),
        (width, height): (usize, usize),
    ) -> Result<(), Error> {
        if (columns, rows) == (width, height) {
            return Ok(());
        }
        let sensor = &self.variables.sensor;
        let right = if sensor.interlaced {
            format!(
                "{} is interlaced, so that an image is a field of {width} x {height}; cut the rows of the fields apart, or add --set \
                 {}.interlaced=false",
                self.scenario, self.instance
            )
        } else {
            format!(
                "the camera of {} takes {width} x {height}; add --set {i}.width={columns} --set {i}.height={rows}",
                self.scenario,
                i = self.instance
            )
        };
        Err(Error::Image { path: path.to_owned(), what: format!("{columns} x {rows} pixels, but {right}") })
    }

    /// What the first frame without circles shows instead.
    pub fn lost(&self, path: &Path, areas: &[u32], lost: usize, frames: usize) -> String {
        let sensor = &self.variables.sensor;
        let mut largest = areas.to_vec();
        largest.sort_unstable_by(|a, b| b.cmp(a));
        let some: Vec<String> = largest.iter().take(TOLD).map(ToString::to_string).collect();
        let shows = match areas.len() {
            0 => "no pixel".to_owned(),
            1 => format!("one region of {} px", some.join(", ")),
            count => format!("{count} regions, the largest of {} px,", some.join(", ")),
        };
        format!(
            "{lost} of {frames} frames do not show all three circles (valid = 0); the first is {}, with {shows} at or above {i}.threshold = {} \
             where {i}.N_min = {} to {i}.N_max = {} px may be a circle",
            path.display(),
            sensor.threshold,
            sensor.smallest_area,
            sensor.largest_area,
            i = self.instance
        )
    }
}
