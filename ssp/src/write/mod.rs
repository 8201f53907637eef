//! From a built scenario to a package of version 1.0: a system with its units in `resources/`, connectors with types and
//! physical units, start values, connections. The rest goes into annotations of ours; times also into those of
//! OMSimulator and libcosim.

mod interface;
mod xml;

use crate::Error;
use crate::annotation::{CONNECTION, NAMESPACE, OPTION, RECORD, REPORT, SOURCE, TYPE, UNIT};
use crate::read::MAIN;
use interface::Interface;
use orchestrator::scenario::{Channel, ConnectionEntry, Hold, Scenario, Shape, SignalEntry, UnitEntry};
use orchestrator::time::Rational;
use orchestrator::{Bundle, Simulation, Value};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use toml::Value as Toml;
use xml::Xml;

/// [`crate::annotation::EXPERIMENT`] with its prefix.
const EXPERIMENT_ELEMENT: &str = "acroscope:AcroscopeExperiment";
const REPORT_FILE: &str = "extra/report.toml";
const COMMON: &str = "http://ssp-standard.org/SSP1/SystemStructureCommon";
const DESCRIPTION: &str = "http://ssp-standard.org/SSP1/SystemStructureDescription";
const VALUES: &str = "http://ssp-standard.org/SSP1/SystemStructureParameterValues";
const OMSIMULATOR: &str = "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd";
const LIBCOSIM: &str = "http://opensimulationplatform.com/SSP/OSPAnnotations";

/// The bytes of a package that holds the scenario and its units.
///
/// # Errors
/// If a file of the scenario can't be read.
pub fn write(simulation: &Simulation) -> Result<Vec<u8>, Error> {
    let bundle = simulation.bundle();
    let mut files = BTreeMap::new();
    for (name, path) in &bundle.files {
        let bytes = std::fs::read(path).map_err(|source| Error::File { path: path.clone(), source })?;
        files.insert(format!("resources/{name}"), bytes);
    }
    let mut xml = Xml::new();
    let scenario = &bundle.scenario;
    let stem = scenario.origin.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let described = Some(scenario.description.as_str()).filter(|text| !text.is_empty());
    xml.open(
        "ssd:SystemStructureDescription",
        &[
            ("xmlns:ssd", Some(DESCRIPTION)),
            ("xmlns:ssc", Some(COMMON)),
            ("xmlns:ssv", Some(VALUES)),
            ("xmlns:acroscope", Some(NAMESPACE)),
            ("xmlns:osp", Some(LIBCOSIM)),
            ("version", Some("1.0")),
            ("name", Some(&stem)),
            ("description", described),
            ("generationTool", Some(concat!("acroscope ", env!("CARGO_PKG_VERSION")))),
        ],
    );
    let mut interface = Interface::new(simulation);
    system(&mut xml, simulation, &bundle, &mut interface);
    interface.definitions(&mut xml);
    experiment(&mut xml, scenario);
    own(&mut xml, scenario, &mut files);
    files.insert(MAIN.to_owned(), xml.finish().into_bytes());
    let wrong = |error: std::io::Error| Error::Scenario {
        what: format!("the package: {error}"),
        expected: "names that an archive can hold".to_owned(),
    };
    orchestrator::package::pack(&files).map_err(wrong)
}

fn system(xml: &mut Xml, simulation: &Simulation, bundle: &Bundle, interface: &mut Interface<'_>) {
    xml.open("ssd:System", &[("name", Some("root"))]);
    xml.open("ssd:Elements", &[]);
    for (at, (entry, given)) in bundle.scenario.units.iter().zip(simulation.given()).enumerate() {
        let source = format!("resources/{}", encoded(&entry.fmu.value));
        xml.open(
            "ssd:Component",
            &[
                ("name", Some(&entry.name)),
                ("type", Some("application/x-fmu-sharedlibrary")),
                ("source", Some(&source)),
                ("implementation", Some("CoSimulation")),
            ],
        );
        interface.connectors(xml, at);
        values(xml, interface, at, &given);
        unit(xml, entry);
        xml.close();
    }
    xml.close();
    connections(xml, &bundle.scenario, interface);
    let step = smallest(&bundle.scenario).to_f64();
    let step = number(step);
    xml.open("ssd:Annotations", &[]);
    xml.open("ssc:Annotation", &[("type", Some("org.openmodelica"))]);
    xml.open("oms:Annotations", &[("xmlns:oms", Some(OMSIMULATOR))]);
    xml.open("oms:SimulationInformation", &[]);
    xml.empty("oms:FixedStepMaster", &[("description", Some("oms-ma")), ("stepSize", Some(&step))]);
    for _ in 0..5 {
        xml.close(); // the last one is the system
    }
}

/// The shortest interval, which a master of one rate would make its step.
fn smallest(scenario: &Scenario) -> Rational {
    let intervals = scenario.units.iter().map(|unit| unit.interval);
    let shorter = |a: Rational, b: Rational| if b.to_f64() < a.to_f64() { b } else { a };
    intervals.reduce(shorter).unwrap_or(Rational::ZERO)
}

/// Start values and parameters that the scenario sets.
fn values(xml: &mut Xml, interface: &Interface<'_>, unit: usize, given: &[(&str, &Value)]) {
    if given.is_empty() {
        return;
    }
    xml.open("ssd:ParameterBindings", &[]);
    xml.open("ssd:ParameterBinding", &[]);
    xml.open("ssd:ParameterValues", &[]);
    xml.open("ssv:ParameterSet", &[("version", Some("1.0")), ("name", Some("values"))]);
    xml.open("ssv:Parameters", &[]);
    for (name, value) in given {
        xml.open("ssv:Parameter", &[("name", Some(name))]);
        match value {
            // No unit: it is the variable's own.
            Value::Real(value) => xml.empty("ssv:Real", &[("value", Some(&number(*value)))]),
            Value::Integer(value) => match interface.item(unit, name, *value) {
                Some(item) => xml.empty("ssv:Enumeration", &[("value", Some(item))]),
                None => xml.empty("ssv:Integer", &[("value", Some(&value.to_string()))]),
            },
            Value::Boolean(value) => xml.empty("ssv:Boolean", &[("value", Some(&value.to_string()))]),
            Value::String(value) => xml.empty("ssv:String", &[("value", Some(value))]),
        }
        xml.close();
    }
    for _ in 0..5 {
        xml.close();
    }
}

fn unit(xml: &mut Xml, entry: &UnitEntry) {
    let offset = entry.offset.as_ref().map(|offset| offset.value.to_string());
    let isolation = entry.isolation.as_ref();
    let step_limit = isolation.map(|isolation| number(isolation.step_limit.as_secs_f64()));
    let memory_limit = isolation.and_then(|isolation| Some((isolation.memory_limit? >> 20).to_string()));
    annotated(xml, |xml| {
        xml.empty(
            &format!("acroscope:{UNIT}"),
            &[
                ("interval", Some(&entry.interval.to_string())),
                ("offset", offset.as_deref()),
                ("retry", entry.retry.then_some("true")),
                ("isolate", isolation.map(|_| "true")),
                ("step_limit", step_limit.as_deref()),
                ("memory_limit", memory_limit.as_deref()),
            ],
        );
    });
}

fn annotated(xml: &mut Xml, content: impl FnOnce(&mut Xml)) {
    xml.open("ssd:Annotations", &[]);
    xml.open("ssc:Annotation", &[("type", Some(TYPE))]);
    content(xml);
    xml.close();
    xml.close();
}

fn connections(xml: &mut Xml, scenario: &Scenario, interface: &Interface<'_>) {
    if scenario.connections.is_empty() {
        return;
    }
    xml.open("ssd:Connections", &[]);
    for entry in &scenario.connections {
        // Names were checked when the simulation was built: each has a dot.
        let split = |name: &'_ str| {
            name.split_once('.').map(|(unit, variable)| (unit.to_owned(), variable.to_owned()))
        };
        let (Some(from), Some(to)) = (split(&entry.from), split(&entry.to)) else { continue };
        let transform = entry.transform;
        let is_scaled = transform.gain != 1.0 || transform.bias != 0.0;
        let attributes = [
            ("startElement", Some(from.0.as_str())),
            ("startConnector", Some(from.1.as_str())),
            ("endElement", Some(to.0.as_str())),
            ("endConnector", Some(to.1.as_str())),
            ("suppressUnitConversion", (!transform.convert_units).then_some("true")),
        ];
        let is_delayed = entry.delay.is_positive() || entry.channel != Channel::default();
        if !is_scaled && !is_delayed && entry.map.is_empty() {
            xml.empty("ssd:Connection", &attributes);
            continue;
        }
        xml.open("ssd:Connection", &attributes);
        if is_scaled {
            let (factor, offset) = (number(transform.gain), number(transform.bias));
            xml.empty("ssc:LinearTransformation", &[("factor", Some(&factor)), ("offset", Some(&offset))]);
        }
        if !entry.map.is_empty() {
            mapping(xml, entry, interface);
        }
        if is_delayed {
            annotated(xml, |xml| way(xml, entry));
        }
        xml.close();
    }
    xml.close();
}

/// What becomes of single values: the type of the table is that of the output.
fn mapping(xml: &mut Xml, entry: &ConnectionEntry, interface: &Interface<'_>) {
    let text = |value: &Toml| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    let number_of =
        |value: &Toml| value.as_bool().map_or_else(|| text(value), |yes| u8::from(yes).to_string());
    let item = |name: &str, value: &Toml| match value {
        Toml::Integer(number) => i32::try_from(*number).ok().and_then(|number| interface.named(name, number)),
        _ => None,
    };
    let shown = |name: &str, value: &Toml| item(name, value).map_or_else(|| text(value), str::to_owned);
    let is_item = |name: &str, value: &Toml| value.is_str() || item(name, value).is_some();
    let element = match &entry.map[0] {
        (Toml::Boolean(_), Toml::Boolean(_)) => "ssc:BooleanMappingTransformation",
        (from, to) if is_item(&entry.from, from) && is_item(&entry.to, to) => {
            "ssc:EnumerationMappingTransformation"
        }
        _ => "ssc:IntegerMappingTransformation",
    };
    xml.open(element, &[]);
    for (from, to) in &entry.map {
        let (source, target) = match element {
            "ssc:EnumerationMappingTransformation" => (shown(&entry.from, from), shown(&entry.to, to)),
            "ssc:BooleanMappingTransformation" => (text(from), text(to)),
            // Between types numbers stand for both.
            _ => (number_of(from), number_of(to)),
        };
        xml.empty("ssc:MapEntry", &[("source", Some(&source)), ("target", Some(&target))]);
    }
    xml.close();
}

/// What happens to values on their way.
fn way(xml: &mut Xml, entry: &ConnectionEntry) {
    let Channel { jitter, drop, hold, seed } = &entry.channel;
    let time = |time: Rational| time.is_positive().then(|| time.to_string());
    let (latency, jitter) = (time(entry.delay), time(*jitter));
    let (drop, seed) = ((*drop > 0.0).then(|| number(*drop)), seed.map(|seed| seed.to_string()));
    xml.empty(
        &format!("acroscope:{CONNECTION}"),
        &[
            ("latency", latency.as_deref()),
            ("jitter", jitter.as_deref()),
            ("drop", drop.as_deref()),
            ("hold", (*hold != Hold::Zero).then_some(hold.name())),
            ("seed", seed.as_deref()),
        ],
    );
}

fn experiment(xml: &mut Xml, scenario: &Scenario) {
    let (start, stop) = (number(scenario.start.to_f64()), number(scenario.stop.to_f64()));
    let step = number(smallest(scenario).to_f64());
    xml.open("ssd:DefaultExperiment", &[("startTime", Some(&start)), ("stopTime", Some(&stop))]);
    xml.open("ssd:Annotations", &[]);
    xml.open("ssc:Annotation", &[("type", Some("com.opensimulationplatform"))]);
    // Its prefix is declared at the root: libcosim takes the first thing in here for the algorithm.
    xml.open("osp:Algorithm", &[]);
    xml.empty("osp:FixedStepAlgorithm", &[("baseStepSize", Some(&step))]);
    for _ in 0..4 {
        xml.close();
    }
}

/// Our annotation on the whole.
fn own(xml: &mut Xml, scenario: &Scenario, files: &mut BTreeMap<String, Vec<u8>>) {
    let seed = scenario.seed.to_string();
    annotated(xml, |xml| {
        xml.open(
            EXPERIMENT_ELEMENT,
            &[
                ("start", Some(&scenario.start.to_string())),
                ("stop", Some(&scenario.stop.to_string())),
                ("algorithm", Some(&scenario.algorithm.value)),
                ("seed", (scenario.seed > 0).then_some(seed.as_str())),
                ("record", scenario.record.as_ref().map(|_| "chosen")),
            ],
        );
        for (name, value) in &scenario.options {
            let value = number(value.value);
            xml.empty(&format!("acroscope:{OPTION}"), &[("name", Some(name)), ("value", Some(&value))]);
        }
        for pattern in scenario.record.iter().flatten() {
            xml.empty(&format!("acroscope:{RECORD}"), &[("pattern", Some(&pattern.value))]);
        }
        for (at, source) in scenario.sources.iter().enumerate() {
            signal(xml, &source.to, &source.signal, at + 1, files);
        }
        if !scenario.report.is_empty() {
            files.insert(REPORT_FILE.to_owned(), scenario.report.to_string().into_bytes());
            xml.empty(&format!("acroscope:{REPORT}"), &[("source", Some(REPORT_FILE))]);
        }
        xml.close();
    });
}

fn signal(
    xml: &mut Xml,
    to: &str,
    signal: &SignalEntry,
    number_of_table: usize,
    files: &mut BTreeMap<String, Vec<u8>>,
) {
    let element = format!("acroscope:{SOURCE}");
    let table = |xml: &mut Xml, shape: Shape, file: &str, column: &str| {
        let kind = match shape {
            Shape::Hold => "hold",
            Shape::Linear => "linear",
            Shape::Smooth => "smooth",
        };
        let file = format!("resources/{}", encoded(file));
        let attributes =
            [("to", Some(to)), ("kind", Some(kind)), ("file", Some(&*file)), ("column", Some(column))];
        xml.empty(&element, &attributes);
    };
    match signal {
        SignalEntry::Constant(value) => {
            let (kind, text) = match value {
                Toml::Float(value) => ("Real", number(*value)),
                Toml::Integer(value) => ("Integer", value.to_string()),
                Toml::Boolean(value) => ("Boolean", value.to_string()),
                Toml::String(value) => ("String", value.clone()),
                other => ("String", other.to_string()), // refused when the simulation was built
            };
            let attributes =
                [("to", Some(to)), ("kind", Some("constant")), ("type", Some(kind)), ("value", Some(&*text))];
            xml.empty(&element, &attributes);
        }
        SignalEntry::Table { shape, points } => {
            let mut text = String::from("time,value\n");
            for (time, value) in points {
                // Writing to a String can't fail.
                let _ = writeln!(text, "{},{}", number(*time), number(*value));
            }
            let mut name = format!("signal-{number_of_table}.csv");
            while files.contains_key(&format!("resources/{name}")) {
                name.insert(0, '_');
            }
            files.insert(format!("resources/{name}"), text.into_bytes());
            table(xml, *shape, &name, "value");
        }
        SignalEntry::Csv { file, column, shape } => table(xml, *shape, file, column),
    }
}

/// The shortest digits that read back to the same bits.
fn number(value: f64) -> String {
    zmij::Buffer::new().format(value).to_owned()
}

/// A file's name as part of a URI.
fn encoded(name: &str) -> String {
    let mut uri = String::new();
    for byte in name.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' | b'~' => uri.push(byte as char),
            other => {
                let _ = write!(uri, "%{other:02X}"); // into a String: can't fail
            }
        }
    }
    uri
}
