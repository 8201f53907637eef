//! `modelDescription.xml` of a container, and the GUID that is the checksum of what it says.

use crate::interface::{Interface, Variable};
use orchestrator::fmu::{BaseUnit, Causality, Variability};
use orchestrator::{Kind, Scenario, Value};
use quick_xml::escape::escape;
use sha2::{Digest as _, Sha256};
use std::fmt::Write as _;

/// Attributes that need a value.
type Attributes<'a> = &'a [(&'a str, Option<String>)];

/// The GUID of a scenario, given as its text, and what the outside sees of it.
pub(crate) fn guid(interface: &Interface, scenario: &str, units: &[&str]) -> String {
    let mut digest = Sha256::new();
    for text in [body(interface).as_str(), scenario].into_iter().chain(units.iter().copied()) {
        digest.update((text.len() as u64).to_le_bytes());
        digest.update(text.as_bytes());
    }
    let bytes = digest.finalize();
    let hex = |range: std::ops::Range<usize>| {
        bytes[range].iter().fold(String::new(), |mut text, byte| {
            let _ = write!(text, "{byte:02x}"); // into a String: can't fail
            text
        })
    };
    format!("{{{}-{}-{}-{}-{}}}", hex(0..4), hex(4..6), hex(6..8), hex(8..10), hex(10..16))
}

/// The whole description.
pub(crate) fn description(
    interface: &Interface,
    identifier: &str,
    guid: &str,
    scenario: &Scenario,
) -> String {
    let mut out = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let tool = concat!("acroscope ", env!("CARGO_PKG_VERSION"));
    let head = [
        ("fmiVersion", Some("2.0".to_owned())),
        ("modelName", Some(identifier.to_owned())),
        ("guid", Some(guid.to_owned())),
        ("description", Some(scenario.description.clone()).filter(|text| !text.is_empty())),
        ("generationTool", Some(tool.to_owned())),
        ("variableNamingConvention", Some("flat".to_owned())),
    ];
    begin(&mut out, 0, "fmiModelDescription", &head, ">");
    let yes = |on: bool| on.then(|| "true".to_owned());
    let flags = [
        ("modelIdentifier", Some(identifier.to_owned())),
        ("canHandleVariableCommunicationStepSize", yes(true)),
        ("canNotUseMemoryManagementFunctions", yes(true)),
        ("canGetAndSetFMUstate", yes(interface.saves)),
        ("canSerializeFMUstate", yes(interface.saves)),
    ];
    begin(&mut out, 1, "CoSimulation", &flags, "/>");
    units(&mut out, interface);
    out.push_str("  <LogCategories>\n");
    for category in fmi2_export::logger::categories(&[]) {
        let text = |text: &str| Some(text.to_owned());
        let attributes = [("name", text(category.name)), ("description", text(category.description))];
        begin(&mut out, 2, "Category", &attributes, "/>");
    }
    out.push_str("  </LogCategories>\n");
    let intervals = scenario.units.iter().map(|unit| unit.interval.to_f64());
    let experiment = [
        ("startTime", Some(number(scenario.start.to_f64()))),
        ("stopTime", Some(number(scenario.stop.to_f64()))),
        ("stepSize", Some(number(intervals.fold(f64::INFINITY, f64::min)))),
    ];
    begin(&mut out, 1, "DefaultExperiment", &experiment, "/>");
    out.push_str(&body(interface));
    out.push_str("</fmiModelDescription>\n");
    out
}

fn units(out: &mut String, interface: &Interface) {
    let used =
        |name: &String| interface.variables.iter().any(|variable| variable.unit.as_ref() == Some(name));
    let used: Vec<_> = interface.units.iter().filter(|(name, _)| used(name)).collect();
    if used.is_empty() {
        return;
    }
    out.push_str("  <UnitDefinitions>\n");
    for (name, base) in used {
        let attributes = [("name", Some(name.clone()))];
        let Some(base) = base else {
            begin(out, 2, "Unit", &attributes, "/>");
            continue;
        };
        begin(out, 2, "Unit", &attributes, ">");
        base_unit(out, base);
        out.push_str("    </Unit>\n");
    }
    out.push_str("  </UnitDefinitions>\n");
}

fn base_unit(out: &mut String, base: &BaseUnit) {
    let names = ["kg", "m", "s", "A", "K", "mol", "cd", "rad"];
    let exponent = |exponent: i32| (exponent != 0).then(|| exponent.to_string());
    let mut attributes: Vec<(&str, Option<String>)> =
        names.into_iter().zip(base.exponents.map(exponent)).collect();
    attributes.push(("factor", (base.factor != 1.0).then(|| number(base.factor))));
    attributes.push(("offset", (base.offset != 0.0).then(|| number(base.offset))));
    begin(out, 3, "BaseUnit", &attributes, "/>");
}

/// Variables and their structure.
fn body(interface: &Interface) -> String {
    let mut out = String::from("  <ModelVariables>\n");
    for (reference, variable) in interface.variables.iter().enumerate() {
        scalar(&mut out, reference, variable);
    }
    out.push_str("  </ModelVariables>\n  <ModelStructure>\n");
    let outputs = || {
        let is_output = |(_, variable): &(usize, &Variable)| variable.causality == Causality::Output;
        interface.variables.iter().enumerate().filter(is_output).map(|(at, _)| at + 1)
    };
    // Nothing is said of dependencies, so that each output may depend on each input: inside, units may hand a value on
    // within one point.
    for list in ["Outputs", "InitialUnknowns"] {
        if outputs().next().is_none() {
            continue;
        }
        begin(&mut out, 2, list, &[], ">");
        for index in outputs() {
            begin(&mut out, 3, "Unknown", &[("index", Some(index.to_string()))], "/>");
        }
        let _ = writeln!(out, "    </{list}>"); // into a String: can't fail
    }
    out.push_str("  </ModelStructure>\n");
    out
}

fn scalar(out: &mut String, reference: usize, variable: &Variable) {
    let causality = match variable.causality {
        Causality::Input => "input",
        Causality::Output => "output",
        Causality::Parameter => "parameter",
        _ => "local",
    };
    let is_given = matches!(variable.causality, Causality::Input | Causality::Parameter);
    let variability = match variable.variability {
        Variability::Fixed => "fixed",
        Variability::Tunable => "tunable",
        Variability::Constant if is_given => "fixed",
        // A constant would need its value here; to the outside it is one that happens not to change.
        Variability::Continuous if variable.kind == Kind::Real => "continuous",
        _ => "discrete",
    };
    let initial = match variable.causality {
        Causality::Input => None,
        Causality::Parameter => Some("exact"),
        _ => Some("calculated"),
    };
    let text = |text: &str| Some(text.to_owned()).filter(|text| !text.is_empty());
    let attributes = [
        ("name", text(&variable.name)),
        ("valueReference", Some(reference.to_string())),
        ("description", text(&variable.description)),
        ("causality", text(causality)),
        ("variability", text(variability)),
        ("initial", initial.map(str::to_owned)),
    ];
    begin(out, 2, "ScalarVariable", &attributes, ">");
    let start = variable.start.as_ref().filter(|_| is_given).map(|start| match start {
        Value::Real(value) => number(*value),
        Value::Integer(value) => value.to_string(),
        Value::Boolean(value) => value.to_string(),
        Value::String(value) => value.clone(),
    });
    let limit = |limit: Option<f64>| match variable.kind {
        Kind::Real => limit.map(number),
        Kind::Integer => limit.map(|limit| (limit as i64).to_string()),
        _ => None,
    };
    let unit = variable.unit.clone().filter(|_| variable.kind == Kind::Real);
    let typed =
        [("unit", unit), ("min", limit(variable.min)), ("max", limit(variable.max)), ("start", start)];
    begin(out, 3, &variable.kind.to_string(), &typed, "/>");
    out.push_str("    </ScalarVariable>\n");
}

fn begin(out: &mut String, depth: usize, name: &str, attributes: Attributes<'_>, end: &str) {
    out.push_str(&"  ".repeat(depth));
    out.push('<');
    out.push_str(name);
    for (key, value) in attributes {
        if let Some(value) = value {
            let value =
                escape(value.as_str()).replace('\n', "&#10;").replace('\r', "&#13;").replace('\t', "&#9;");
            let _ = write!(out, " {key}=\"{value}\""); // into a String: can't fail
        }
    }
    out.push_str(end);
    out.push('\n');
}

/// The shortest digits that read back to the same bits.
fn number(value: f64) -> String {
    zmij::Buffer::new().format(value).to_owned()
}

/// The description of the blank unit, which has no scenario yet.
pub(crate) fn blank() -> String {
    let head = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"2.0\" modelName=\"{0}\" \
         guid=\"{{00000000-0000-0000-0000-000000000000}}\" description=\"The library of containers, without a scenario: \
         `acroscope container` makes a unit of it.\">\n  <CoSimulation modelIdentifier=\"{0}\"/>\n  <ModelVariables>\n    \
         <ScalarVariable name=\"scenario\" valueReference=\"0\" causality=\"local\" variability=\"constant\" \
         initial=\"exact\">\n      <String start=\"none\"/>\n    </ScalarVariable>\n  </ModelVariables>\n  <ModelStructure/>\n</fmiModelDescription>\n",
        crate::pack::IDENTIFIER
    );
    head
}
