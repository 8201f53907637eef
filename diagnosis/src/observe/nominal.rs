//! The nominal model of a data set: a scenario, or one unit alone, with `[set]`.

use super::raw::File;
use super::{Channel, Nominal, Role, Series, VariableId};
use crate::error::{Error, Notice};
use crate::opened::{open, text};
use crate::statistics::median::median;
use orchestrator::fmu::Description;
use orchestrator::scenario::{Given, UnitEntry};
use orchestrator::{Fmu, Kind, Place, Scenario, Simulation, UnitPath, Value, nearest};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// The model that the file names, before the logs are known.
pub(super) fn load(folder: &Path, file: &File, units: &UnitPath) -> Result<Nominal, Error> {
    let raw = &file.raw;
    let mut scenario = match (&raw.scenario, &raw.fmu) {
        (Some(name), None) => {
            named(folder, name.get_ref()).map_err(|problem| file.wrong(&name.span(), problem))?
        }
        (None, Some(name)) => unit_alone(folder, file, name, units)?,
        (Some(_), Some(name)) => {
            return Err(file.wrong(&name.span(), "`scenario` and `fmu` both: one of them names the model"));
        }
        (None, None) => {
            let problem =
                "which model? Write `fmu = \"FILE.fmu\"` for one unit alone, or `scenario = \"FILE.toml\"`";
            return Err(file.wrong(&(0..0), problem));
        }
    };
    let beside = scenario.origin.parent().unwrap_or(Path::new("")).to_owned();
    let fmus: Vec<Fmu> =
        scenario.units.iter().map(|unit| open(&unit.fmu.value, &beside, units)).collect::<Result<_, _>>()?;
    apply(&mut scenario, &fmus, file)?;
    let set = values(&scenario, &fmus, file)?;
    Simulation::new(&scenario, units).map_err(|error| match error {
        orchestrator::Error::Scenario { place: Place::Override(given), what, expected } => {
            let name = given.split('=').next().unwrap_or("");
            Error::Manifest {
                path: file.path.clone(),
                line: file.line_of_set(name),
                problem: format!("[set] {name}: {what}: {expected}"),
            }
        }
        other => crate::opened::model(other),
    })?;
    Ok(Nominal { scenario, fmus, set })
}

fn named(folder: &Path, name: &str) -> Result<Scenario, String> {
    let beside = folder.join(name);
    if beside.is_file() {
        return Scenario::load(beside).map_err(|error| error.to_string());
    }
    scenarios::load(name).map_err(|error| format!("{error}; looked for {}", beside.display()))
}

/// A scenario of one unit, which steps once a row until [`pace`] knows the logs.
fn unit_alone(
    folder: &Path,
    file: &File,
    name: &toml::Spanned<String>,
    units: &UnitPath,
) -> Result<Scenario, Error> {
    let wrong = |problem: String| file.wrong(&name.span(), problem);
    let given = name.get_ref().as_str();
    open(given, folder, units).map_err(|error| wrong(error.to_string()))?;
    let own = orchestrator::scenario::name_of_file(Path::new(given));
    let quoted = |text: &str| toml::Value::String(text.to_owned()).to_string();
    let scenario = format!(
        "format = 1\n[experiment]\nstop = 1\n[[units]]\nname = {}\nfmu = {}\ninterval = 1\n",
        quoted(&own),
        quoted(given)
    );
    Scenario::parse(&scenario, folder.join("dataset.toml")).map_err(|error| match error {
        orchestrator::Error::Scenario { what, expected, .. } => {
            wrong(format!("{what}, from the name of the file: {expected}; rename the file"))
        }
        other => wrong(other.to_string()),
    })
}

/// Gives a unit alone its interval: the usual distance of rows, divided so that it is no more than the unit's own step.
pub(super) fn pace<'a>(model: &mut Nominal, logs: impl Iterator<Item = &'a Series> + Clone) {
    let gaps = logs.clone().flat_map(|s| s.time.windows(2).map(|pair| pair[1] - pair[0]));
    let Some(gap) = median(gaps).map(rounded) else { return };
    let own = model.description(0).default_experiment.step_size.filter(|step| *step > 0.0).unwrap_or(gap);
    let parts = (gap / own - 1e-9).ceil().max(1.0);
    let whole = |series: &Series| Some(series.time.last()? - series.time.first()?);
    let stop = logs.filter_map(whole).fold(gap, f64::max);
    let time = |text: &str| orchestrator::time::Rational::parse(text);
    if let Some(interval) = time(&format!("{gap}/{parts}")) {
        model.scenario.units[0].interval = interval;
    }
    if let Some(stop) = time(&format!("{}", rounded(stop))) {
        model.scenario.stop = stop;
    }
}

/// Four digits: what timestamps that jitter mean.
fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// Writes `[set]` into the scenario.
fn apply(scenario: &mut Scenario, fmus: &[Fmu], file: &File) -> Result<(), Error> {
    let mut given = BTreeMap::new();
    flatten(&file.raw.set, "", &mut given);
    for (name, value) in &given {
        let wrong = |problem: String| Error::Manifest {
            path: file.path.clone(),
            line: file.line_of_set(name),
            problem: format!("[set] {problem}"),
        };
        let id = find(scenario, fmus, name).map_err(|problem| wrong(problem.clone()))?;
        let instance = &scenario.units[id.instance].name;
        let variable = &fmus[id.instance].description().variables[id.place].name;
        scenario
            .set(&format!("{instance}.{variable}"), &text(value))
            .map_err(|error| wrong(format!("{name}: {error}")))?;
    }
    Ok(())
}

/// A value of `[set]` for an input that a channel feeds would count for nothing, as `run --set` says of one that a source drives.
pub(super) fn refuse_fed(model: &Nominal, channels: &[Channel], file: &File) -> Result<(), Error> {
    let mut given = BTreeMap::new();
    flatten(&file.raw.set, "", &mut given);
    for name in given.keys() {
        let Ok(id) = find(&model.scenario, &model.fmus, name) else { continue };
        let feeds = |channel: &&Channel| channel.variable == id && matches!(channel.role, Role::Fed(_));
        if let Some(channel) = channels.iter().find(feeds) {
            let problem = format!(
                "[set] {name} is fed: the [[channel]] of line {} would overwrite it; leave one of both out",
                channel.line
            );
            return Err(Error::Manifest { path: file.path.clone(), line: file.line_of_set(name), problem });
        }
    }
    Ok(())
}

/// `"heater.T_0" = 1`, or `heater.T_0 = 1`, or a table `[set.heater]`.
fn flatten(
    table: &toml::map::Map<String, toml::Value>,
    prefix: &str,
    into: &mut BTreeMap<String, toml::Value>,
) {
    for (key, value) in table {
        let name = if prefix.is_empty() { key.clone() } else { format!("{prefix}.{key}") };
        match value {
            toml::Value::Table(inner) => flatten(inner, &name, into),
            other => drop(into.insert(name, other.clone())),
        }
    }
}

/// A variable by its full name; an error is what is wrong and what would be right.
pub(super) fn find(scenario: &Scenario, fmus: &[Fmu], full: &str) -> Result<VariableId, String> {
    let of = |unit: &UnitEntry| full.strip_prefix(unit.name.as_str())?.strip_prefix('.').map(str::to_owned);
    let found = scenario.units.iter().enumerate().find_map(|(place, entry)| Some((place, of(entry)?)));
    let Some((instance, name)) = found else {
        let instances: Vec<&str> = scenario.units.iter().map(|unit| unit.name.as_str()).collect();
        let holders =
            scenario.units.iter().zip(fmus).filter(|(_, fmu)| fmu.description().variable(full).is_some());
        let holder = holders.map(|(unit, _)| format!("{}.{full}", unit.name)).next();
        return Err(match (holder, full.split_once('.')) {
            (Some(whole), _) => format!("{full:?} lacks its instance: write {whole:?}"),
            (None, Some((instance, _))) => {
                format!(
                    "{full:?}: there is no instance {instance:?}: {}",
                    nearest(instance, instances.into_iter())
                )
            }
            (None, None) => {
                format!("{full:?} names no variable: write instance.variable, e.g. {}.…", instances[0])
            }
        });
    };
    let description = fmus[instance].description();
    if description.is_ambiguous(&name) && description.place(&name).is_some() {
        return Err(format!(
            "{} declares {name:?} more than once, and names are unique (FMI 2.0.4, section 2.2.7): which is meant? Mend its \
             modelDescription.xml",
            scenario.units[instance].name
        ));
    }
    description.place(&name).map(|place| VariableId { instance, place }).ok_or_else(|| {
        let known = description.variables.iter().map(|variable| variable.name.as_str());
        format!("{} has no variable {name:?}: {}", scenario.units[instance].name, nearest(&name, known))
    })
}

/// Variables that a unit declares more than once: a notice for each name.
pub(super) fn repeated_names(model: &Nominal) -> Vec<Notice> {
    let of = |(fmu, unit): (&Fmu, &UnitEntry)| {
        let notice = |name| Notice {
            file: "dataset.toml".into(),
            line: 0,
            message: format!(
                "{} declares {name:?} more than once, and names are unique (FMI 2.0.4, section 2.2.7): it is left as it is, for nobody knows \
                 which is meant",
                unit.name
            ),
        };
        repeated(fmu.description()).into_iter().map(notice).collect::<Vec<_>>()
    };
    model.fmus.iter().zip(&model.scenario.units).flat_map(of).collect()
}

/// Names that several variables of a unit have.
fn repeated(description: &Description) -> BTreeSet<&str> {
    let names = description.variables.iter().map(|variable| variable.name.as_str());
    names.filter(|name| !name.is_empty() && description.is_ambiguous(name)).collect()
}

/// What the units are given, as values of the variables' types.
fn values(scenario: &Scenario, fmus: &[Fmu], file: &File) -> Result<Vec<(VariableId, Value)>, Error> {
    let mut set = Vec::new();
    for (instance, (entry, fmu)) in scenario.units.iter().zip(fmus).enumerate() {
        for (name, given) in &entry.set {
            let Some(place) = fmu.description().place(name) else { continue };
            let kind = fmu.description().variables[place].kind;
            let Some(value) = Value::parse(kind, &describe_given(&given.value)) else {
                let full = format!("{}.{name}", entry.name);
                return Err(Error::Manifest {
                    path: file.path.clone(),
                    line: file.line_of_set(&full),
                    problem: format!(
                        "{full} = {:?}: not a value of type {kind}",
                        describe_given(&given.value)
                    ),
                });
            };
            set.push((VariableId { instance, place }, value));
        }
    }
    Ok(set)
}

/// A given value as text.
fn describe_given(given: &Given) -> String {
    match given {
        Given::Text(text) => text.clone(),
        Given::Toml(value) => text(value),
    }
}

/// A value as a number, where a candidate's neutral value is meant.
pub(super) fn number(kind: Kind, value: &toml::Value) -> Option<f64> {
    match (kind, value) {
        (Kind::Boolean, toml::Value::Boolean(value)) => Some(f64::from(u8::from(*value))),
        (Kind::String, _) => None,
        (_, toml::Value::Float(value)) => Some(*value),
        (_, toml::Value::Integer(value)) => Some(*value as f64),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::repeated;
    use orchestrator::fmu::Description;

    #[test]
    fn value_names_that_a_unit_declares_twice() {
        let variable = |name: &str, reference: u32| {
            format!(
                r#"<ScalarVariable name="{name}" valueReference="{reference}" causality="parameter" variability="fixed"><Real start="1"/></ScalarVariable>"#
            )
        };
        let of = |names: [&str; 3]| {
            let all: String =
                names.iter().zip(0..).map(|(name, reference)| variable(name, reference)).collect();
            let text = format!(
                r#"<fmiModelDescription fmiVersion="2.0" modelName="m" guid="g"><CoSimulation modelIdentifier="m"/><ModelVariables>{all}</ModelVariables>
                <ModelStructure/></fmiModelDescription>"#
            );
            let description = Description::parse(&text).expect("a description");
            repeated(&description).into_iter().map(str::to_owned).collect::<Vec<_>>()
        };
        assert_eq!(of(["R", "L", "R"]), ["R"]);
        assert!(of(["R", "L", "r"]).is_empty(), "names differ by their case");
    }
}
