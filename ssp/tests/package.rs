//! Packages that are written and read again, and packages of all sorts: what they mean and why they are refused. The units
//! are the packed ones.

use orchestrator::package::pack;
use orchestrator::{CsvRecorder, Quiet, Scenario, Simulation, UnitPath};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

fn units() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/fmus")
}

fn unit(name: &str) -> Vec<u8> {
    std::fs::read(units().join(name)).expect("packed units: cargo xtask pack")
}

fn results(scenario: &Scenario, folder: &Path) -> String {
    let path = folder.join("results.csv");
    let mut simulation = Simulation::new(scenario, &UnitPath::new().with(units())).expect("builds");
    simulation.run(&mut CsvRecorder::create(&path).expect("writable"), &mut Quiet).expect("runs");
    std::fs::read_to_string(path).expect("written")
}

/// A package of a system's elements and connections around two `signal_effects`, `a` and `b`.
struct Package {
    folder: TempDir,
    files: BTreeMap<String, Vec<u8>>,
}

const HEAD: &str = r#"<?xml version="1.0"?>
<ssd:SystemStructureDescription xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"
  xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon" xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"
  xmlns:ssm="http://ssp-standard.org/SSP1/SystemStructureParameterMapping" version="VERSION" name="test">"#;
const UNITS: &str = r#"<ssd:Units>
  <ssc:Unit name="m"><ssc:BaseUnit m="1"/></ssc:Unit><ssc:Unit name="mm"><ssc:BaseUnit m="1" factor="0.001"/></ssc:Unit>
  <ssc:Unit name="K"><ssc:BaseUnit K="1"/></ssc:Unit><ssc:Unit name="degC"><ssc:BaseUnit K="1" offset="273.15"/></ssc:Unit>
</ssd:Units>"#;

/// A component with an input and an output, perhaps in units, and what else is in it.
fn component(name: &str, units: [&str; 2], more: &str) -> String {
    let unit = |unit: &str| if unit.is_empty() { String::new() } else { format!(" unit=\"{unit}\"") };
    format!(
        r#"<ssd:Component name="{name}" source="resources/effects.fmu"><ssd:Connectors>
        <ssd:Connector name="u" kind="input"><ssc:Real{}/></ssd:Connector>
        <ssd:Connector name="y" kind="output"><ssc:Real{}/></ssd:Connector>
        <ssd:Connector name="bias" kind="parameter"><ssc:Real/></ssd:Connector>
        </ssd:Connectors>{more}</ssd:Component>"#,
        unit(units[0]),
        unit(units[1])
    )
}

fn values(parameters: &str) -> String {
    format!(
        r#"<ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues>
        <ssv:ParameterSet version="1.0" name="p"><ssv:Parameters>{parameters}</ssv:Parameters></ssv:ParameterSet>
        </ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings>"#
    )
}

fn real(name: &str, value: &str) -> String {
    format!(r#"<ssv:Parameter name="{name}"><ssv:Real value="{value}"/></ssv:Parameter>"#)
}

impl Package {
    fn new(version: &str, system: &str) -> Self {
        let package = Self {
            folder: tempfile::tempdir().expect("a temporary folder"),
            files: BTreeMap::from([("resources/effects.fmu".to_owned(), unit("signal_effects.fmu"))]),
        };
        let text = format!(
            "{}<ssd:System name=\"s\">{system}</ssd:System>{UNITS}<ssd:DefaultExperiment startTime=\"0\" stopTime=\"0.05\"/>\
             </ssd:SystemStructureDescription>",
            HEAD.replace("VERSION", version)
        );
        package.with("SystemStructure.ssd", &text)
    }

    fn with(mut self, name: &str, text: &str) -> Self {
        self.files.insert(name.to_owned(), text.as_bytes().to_vec());
        self
    }

    fn path(&self) -> PathBuf {
        let path = self.folder.path().join("test.ssp");
        std::fs::write(&path, pack(&self.files).expect("packed")).expect("writable");
        path
    }

    fn read(&self) -> Scenario {
        ssp::read(&self.path()).unwrap_or_else(|error| panic!("{error}"))
    }

    /// The last value of a variable.
    fn last(&self, name: &str) -> f64 {
        let mut simulation =
            Simulation::new(&self.read(), &UnitPath::new()).unwrap_or_else(|error| panic!("{error}"));
        simulation.advance_to(0.05).expect("runs");
        simulation.value(name).expect("a variable")
    }

    fn refused(&self) -> String {
        match ssp::read(&self.path()) {
            Ok(scenario) => Simulation::new(&scenario, &UnitPath::new()).err().expect("refused").to_string(),
            Err(error) => {
                assert!(error.is_input(), "{error}");
                error.to_string()
            }
        }
    }
}

/// Two components, a -> b, with the connection as it is given.
fn two(units: [&str; 2], connection: &str) -> String {
    format!(
        "<ssd:Elements>{}{}</ssd:Elements><ssd:Connections>{connection}</ssd:Connections>",
        component("a", ["", units[0]], &values(&real("bias", "5"))),
        component("b", [units[1], ""], "")
    )
}

const FORWARD: &str =
    r#"<ssd:Connection startElement="a" startConnector="y" endElement="b" endConnector="u"/>"#;

#[test]
fn law_a_scenario_gives_the_same_bytes_from_its_package() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let toml = r#"
format = 1
description = "effects & <more>"
[experiment]
stop = "1/3"
seed = 7
algorithm = "jacobi"
[[units]]
name = "a"
fmu = "signal_effects.fmu"
interval = "1/300"
[units.set]
bias = 0.1
gain = 1e-300
[[units]]
name = "b"
fmu = "signal_effects.fmu"
interval = "1/70"
offset = "1/140"
[units.set]
delay = 0.02
[[units]]
name = "c"
fmu = "signal_effects.fmu"
interval = "0.01"
[[connections]]
from = "a.y"
to = "b.u"
latency = "1/60"
jitter = 0.001
drop = 0.1
hold = "linear"
[[connections]]
from = "b.y"
to = "c.u"
gain = -0.3
bias = 1e-3
[[sources]]
to = "a.u"
kind = "smooth"
points = [[0.0, 0.0], [0.1, 0.7], [0.3, -0.2]]
[record]
variables = ["c.*", "a.y", "b.u", "b.u:age"]
[report]
[[report.graphs]]
title = "one\ntwo"
y = "y"
lines = [{ signal = "c.y", label = "c", style = "solid" }]
"#;
    let scenario = Scenario::parse(toml, folder.path().join("mine.toml")).expect("a scenario");
    let simulation = Simulation::new(&scenario, &UnitPath::new().with(units())).expect("builds");
    let bytes = ssp::write(&simulation).expect("written");
    assert!(bytes == ssp::write(&simulation).expect("written"), "the same bytes each time");
    let path = folder.path().join("mine.ssp");
    std::fs::write(&path, &bytes).expect("writable");
    let read = ssp::read(&path).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(results(&scenario, folder.path()), results(&read, folder.path()));
    assert_eq!((&read.description, &read.report), (&scenario.description, &scenario.report));
    // And once more, from the package's scenario.
    let simulation = Simulation::new(&read, &UnitPath::new()).expect("builds");
    let again = folder.path().join("again.ssp");
    std::fs::write(&again, ssp::write(&simulation).expect("written")).expect("writable");
    assert_eq!(results(&scenario, folder.path()), results(&ssp::read(&again).expect("read"), folder.path()));
    // What a run says that it used runs by itself.
    let resolved =
        Scenario::parse(&simulation.resolved(), folder.path().join("resolved.toml")).expect("a scenario");
    assert_eq!(results(&scenario, folder.path()), results(&resolved, folder.path()));
}

#[test]
fn law_units_delay_as_latencies_do() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let toml = r#"
format = 1
[experiment]
stop = 0.5
algorithm = "jacobi"
[[units]]
name = "a"
fmu = "signal_effects.fmu"
interval = 0.01
[[units]]
name = "delay_1"
fmu = "signal_effects.fmu"
interval = 0.02
[[units]]
name = "c"
fmu = "signal_effects.fmu"
interval = 0.01
[[connections]]
from = "a.y"
to = "delay_1.u"
latency = 0.1
gain = 2.0
bias = 1.0
[[connections]]
from = "delay_1.y"
to = "c.u"
latency = 0.1
jitter = 0.01
[[sources]]
to = "a.u"
kind = "linear"
points = [[0.0, 0.0], [0.5, 1.0]]
[record]
variables = ["delay_1.u", "a.u"]
"#;
    let scenario = Scenario::parse(toml, folder.path().join("mine.toml")).expect("a scenario");
    let simulation = Simulation::new(&scenario, &UnitPath::new().with(units())).expect("builds");
    let (with_units, notes) = ssp::with_delay_units(&simulation);
    assert_eq!(notes.len(), 1, "{notes:?}");
    assert!(notes[0].starts_with("delay_1.y -> c.u: its latency stays an annotation of ours"), "{notes:?}");
    let names: Vec<&str> = with_units.units.iter().map(|unit| unit.name.as_str()).collect();
    assert_eq!(names, ["a", "delay_1", "c", "delay_2"]);
    let table = |scenario: &Scenario| {
        let rows = results(scenario, folder.path());
        let number = |cell: &str| cell.parse::<f64>().expect("a number");
        rows.lines().skip(1).map(|row| row.split(',').map(number).collect::<Vec<_>>()).collect::<Vec<_>>()
    };
    let (latency, units) = (table(&scenario), table(&with_units));
    assert_eq!(latency.len(), units.len());
    for (by_latency, by_unit) in latency.iter().zip(&units).filter(|(row, _)| row[0] >= 0.2) {
        // The ramp's 2/s, doubled, over two steps of the delay's unit with Jacobi and one that the receiver is behind.
        let late = by_latency[1] - by_unit[1];
        assert!(late.abs() <= 4.0 * 0.031, "{by_latency:?} {by_unit:?}");
    }
    // The package runs in our master as it would in another one.
    let simulation = Simulation::new(&with_units, &UnitPath::new().with(self::units())).expect("builds");
    let path = folder.path().join("mine.ssp");
    std::fs::write(&path, ssp::write(&simulation).expect("written")).expect("writable");
    assert_eq!(table(&ssp::read(&path).expect("read")), units);
}

fn table(kind: &str, source: &str, target: &str) -> String {
    format!(
        "<ssc:{kind}MappingTransformation><ssc:MapEntry source=\"{source}\" target=\"{target}\"/></ssc:{kind}MappingTransformation>"
    )
}

#[test]
fn law_mappings_of_values_come_back() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let toml = r#"
format = 1
[experiment]
stop = 0.2
[[units]]
name = "camera"
fmu = "acrobot_camera.fmu"
interval = "1/60"
[[units]]
name = "controller"
fmu = "acrobot_controller.fmu"
interval = "1/60"
[[units]]
name = "other"
fmu = "acrobot_controller.fmu"
interval = "1/60"
[[connections]]
from = "camera.frame"
to = "controller.frame"
map = [[1, -1], [3, 0]]
[[connections]]
from = "camera.valid"
to = "other.frame"
map = [[true, 8]]
[record]
variables = ["camera.frame", "controller.frame", "other.frame"]
"#;
    let scenario = Scenario::parse(toml, folder.path().join("mine.toml")).expect("a scenario");
    let simulation = Simulation::new(&scenario, &UnitPath::new().with(units())).expect("builds");
    let path = folder.path().join("mine.ssp");
    std::fs::write(&path, ssp::write(&simulation).expect("written")).expect("writable");
    let read = ssp::read(&path).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(results(&scenario, folder.path()), results(&read, folder.path()));
    let rows = results(&read, folder.path());
    // Frames come at 30 Hz: the second one passes, the first and the third become others.
    let seen: Vec<&str> =
        rows.lines().skip(1).filter_map(|row| row.split_once(',')).map(|(_, rest)| rest).collect();
    for row in ["1,-1,8", "2,2,8", "3,0,8"] {
        assert!(seen.contains(&row), "{row}: {rows}");
    }
}

#[test]
fn law_a_connection_may_be_written_backwards() {
    let backward = r#"<ssd:Connection startElement="b" startConnector="u" endElement="a" endConnector="y"/>"#;
    for (version, connection) in [("1.0", FORWARD), ("2.0", FORWARD), ("1.0", backward)] {
        assert_eq!(Package::new(version, &two(["", ""], connection)).last("b.u"), 5.0);
    }
}

#[test]
fn value_units_and_linear_transformations() {
    let linear = |suppress: &str| {
        format!(
            r#"<ssd:Connection startElement="a" startConnector="y" endElement="b" endConnector="u"{suppress}>
            <ssc:LinearTransformation factor="2" offset="3"/></ssd:Connection>"#
        )
    };
    let suppressed = FORWARD.replace("/>", " suppressUnitConversion=\"true\"/>");
    for (units, connection, expected) in [
        (["m", "mm"], FORWARD.to_owned(), 5000.0),
        (["degC", "K"], FORWARD.to_owned(), 278.15),
        (["m", "mm"], suppressed, 5.0),
        (["m", "m"], linear(""), 13.0),
        // The unit first, then the transformation.
        (["m", "mm"], linear(""), 10003.0),
        (["m", "mm"], linear(" suppressUnitConversion=\"1\""), 13.0),
    ] {
        assert_eq!(
            Package::new("1.0", &two(units, &connection)).last("b.u"),
            expected,
            "{units:?} {connection}"
        );
    }
}

#[test]
fn law_values_pass_through_systems_within_systems_and_dictionaries() {
    let inner = format!(
        r#"<ssd:System name="inner"><ssd:Connectors>
        <ssd:Connector name="u" kind="input"><ssc:Real unit="mm"/></ssd:Connector>
        <ssd:Connector name="y" kind="output"><ssc:Real unit="m"/></ssd:Connector>
        <ssd:Connector name="p" kind="parameter"><ssc:Real/></ssd:Connector></ssd:Connectors>
        <ssd:Elements>{}</ssd:Elements><ssd:Connections>
        <ssd:Connection startConnector="u" endElement="b" endConnector="u"/>
        <ssd:Connection startConnector="p" endElement="b" endConnector="bias"/>
        <ssd:Connection startConnector="y" endElement="b" endConnector="y"/></ssd:Connections></ssd:System>"#,
        component("b", ["m", "m"], &values(&real("bias", "100")))
    );
    let bus = |name: &str| {
        format!(
            r#"<ssd:SignalDictionaryReference name="{name}" dictionary="bus"><ssd:Connectors>
            <ssd:Connector name="x" kind="inout"><ssc:Real/></ssd:Connector></ssd:Connectors></ssd:SignalDictionaryReference>"#
        )
    };
    let system = format!(
        r#"{}<ssd:Elements>{}{inner}{}{}{}</ssd:Elements><ssd:Connections>
        <ssd:Connection startElement="a" startConnector="y" endElement="inner" endConnector="u"/>
        <ssd:Connection startElement="inner" startConnector="y" endElement="left" endConnector="x"/>
        <ssd:Connection startElement="right" startConnector="x" endElement="c" endConnector="u"/></ssd:Connections>
        <ssd:SignalDictionaries><ssd:SignalDictionary name="bus"/></ssd:SignalDictionaries>"#,
        values(&format!("{}{}", real("inner.p", "0.25"), real("a.bias", "7"))),
        component("a", ["", "m"], &values(&real("bias", "1"))),
        bus("left"),
        bus("right"),
        component("c", ["mm", ""], ""),
    );
    let package = Package::new("1.0", &system);
    // The outer binding counts: 7 m through the system's connector in mm, 0.25 m more, and on in mm.
    assert_eq!(package.last("inner/b.u"), 7.0);
    assert_eq!(package.last("c.u"), 7250.0);
}

#[test]
fn value_parameters_from_files_with_mappings_and_prefixes() {
    let set = |parameters: &str| {
        format!(
            r#"<ssv:ParameterSet xmlns:ssv="v" xmlns:ssc="c" version="2.0" name="p"><ssv:Parameters>{parameters}</ssv:Parameters>
            <ssv:Units><ssc:Unit name="cm"><ssc:BaseUnit m="1" factor="0.01"/></ssc:Unit></ssv:Units></ssv:ParameterSet>"#
        )
    };
    let mapping = r#"<ssm:ParameterMapping xmlns:ssm="m" xmlns:ssc="c" version="1.0">
        <ssm:MappingEntry source="a.offset" target="a.bias"><ssc:LinearTransformation factor="10" offset="1"/></ssm:MappingEntry>
        <ssm:MappingEntry source="a.offset" target="b.bias"/></ssm:ParameterMapping>"#;
    let system = format!(
        r#"<ssd:ParameterBindings><ssd:ParameterBinding source="resources/a%20set.ssv" prefix="a.">
        <ssd:ParameterMapping source="resources/map.ssm"/></ssd:ParameterBinding></ssd:ParameterBindings>{}"#,
        two(["", ""], FORWARD)
    );
    let parameters = r#"<ssv:Parameter name="offset"><ssv:Float64 value="3"/></ssv:Parameter>
        <ssv:Parameter name="nobody"><ssv:Boolean value="true"/></ssv:Parameter>"#;
    let package = Package::new("2.0", &system)
        .with("resources/a set.ssv", &set(parameters))
        .with("resources/map.ssm", mapping);
    assert_eq!(package.last("a.bias"), 31.0);
    assert_eq!(package.last("b.bias"), 3.0);
    // A unit of the set is converted to that of the connector.
    let cm = r#"<ssv:Parameter name="u"><ssv:Real value="250" unit="cm"/></ssv:Parameter>
        <ssv:Parameter name="nobody"><ssv:Real value="1"/></ssv:Parameter>"#;
    let bound =
        r#"<ssd:ParameterBindings><ssd:ParameterBinding source="resources/s.ssv"/></ssd:ParameterBindings>"#;
    let system = format!("<ssd:Elements>{}</ssd:Elements>", component("a", ["mm", ""], bound));
    let package = Package::new("1.0", &system).with("resources/s.ssv", &set(cm));
    assert_eq!(package.last("a.u"), 2500.0);
    let simulation = Simulation::new(&package.read(), &UnitPath::new()).expect("builds");
    let notes = simulation.notices().join("\n");
    assert!(notes.contains("1 of 2 parameters name nothing") && notes.contains("nobody"), "{notes}");
}

#[test]
fn law_packages_and_documents_lie_in_packages() {
    let inner = Package::new("1.0", &two(["", ""], FORWARD));
    let nested = |kind: &str, source: &str| {
        format!(
            r#"<ssd:Elements><ssd:Component name="sub" type="application/x-ssp-{kind}" source="{source}">{}</ssd:Component></ssd:Elements>"#,
            values(&real("a.bias", "8"))
        )
    };
    let package = Package::new("1.0", &nested("definition", "sub/other.ssd"));
    let text = String::from_utf8(inner.files["SystemStructure.ssd"].clone()).expect("text");
    let package = package.with("sub/other.ssd", &text.replace("resources/", "../resources/"));
    assert_eq!(package.last("sub/b.u"), 8.0);
    let mut package = Package::new("1.0", &nested("package", "resources/inner.ssp"));
    package.files.insert("resources/inner.ssp".to_owned(), pack(&inner.files).expect("packed"));
    assert_eq!(package.last("sub/b.u"), 8.0);
    let package = Package::new("1.0", &nested("definition", "SystemStructure.ssd"));
    assert!(package.refused().contains("systems deep"), "{}", package.refused());
}

#[test]
fn law_times_come_from_whoever_says_them() {
    let interval = |scenario: &Scenario| scenario.units[0].interval.to_string();
    let package = Package::new("1.0", &two(["", ""], FORWARD));
    let plain = package.read();
    let hint = r#"<ssd:Annotations><ssc:Annotation type="org.acroscope"><x:AcroscopeUnit xmlns:x="y" interval="1/7"/></ssc:Annotation>
        <ssc:Annotation type="another"><x:AcroscopeUnit xmlns:x="y" interval="1/9"/></ssc:Annotation></ssd:Annotations>"#;
    let own = format!("<ssd:Elements>{}</ssd:Elements>", component("a", ["", ""], hint));
    assert_eq!(interval(&Package::new("1.0", &own).read()), "1/7");
    let master = r#"<ssd:Annotations><ssc:Annotation type="org.openmodelica"><oms:Annotations xmlns:oms="o"><oms:SimulationInformation>
        <oms:FixedStepMaster stepSize="0.002"/></oms:SimulationInformation></oms:Annotations></ssc:Annotation></ssd:Annotations>"#;
    let stepped = Package::new("1.0", &format!("{}{master}", two(["", ""], FORWARD))).read();
    assert_eq!(interval(&stepped), "1/500");
    let simulation = Simulation::new(&plain, &UnitPath::new()).expect("builds");
    let notes = simulation.notices().join("\n");
    assert!(notes.contains("says no communication intervals") && notes.contains("a 1/"), "{notes}");
}

#[test]
fn every_fault_names_document_line_and_element() {
    let connect = |text: &str| Package::new("1.0", &two(["", ""], text)).refused();
    let element = |text: &str| Package::new("1.0", &format!("<ssd:Elements>{text}</ssd:Elements>")).refused();
    let with = |from: &str, to: &str| element(&component("a", ["", ""], "").replace(from, to));
    for (told, parts) in [
        (
            connect(&FORWARD.replace("\"a\"", "\"aa\"")),
            ["SystemStructure.ssd:", "no such element", "did you mean a"],
        ),
        (
            connect(&FORWARD.replace("\"u\"", "\"uu\"")),
            ["has no such connector", "did you mean u", "endConnector"],
        ),
        (connect(&FORWARD.replace("\"u\"", "\"y\"")), ["a.y and b.y", "both give a value", "kind input"]),
        (
            connect(&format!("{FORWARD}{FORWARD}")),
            ["second connection into b.u", "the first one is at", ".ssd:"],
        ),
        (
            connect(&FORWARD.replace("/>", "><ssc:IntegerMappingTransformation/></ssd:Connection>")),
            ["IntegerMappingTransformation", "b.u", "MapEntry"],
        ),
        (
            connect(&FORWARD.replace("/>", &format!(">{}</ssd:Connection>", table("Integer", "1", "2.5")))),
            ["target=\"2.5\"", "IntegerMappingTransformation", "a whole number"],
        ),
        (
            connect(&FORWARD.replace("/>", &format!(">{}</ssd:Connection>", table("Boolean", "yes", "0")))),
            ["source=\"yes\"", "BooleanMappingTransformation", "true or false"],
        ),
        (
            connect(&FORWARD.replace("/>", &format!(">{}</ssd:Connection>", table("Integer", "1", "2")))),
            ["map from a.y (Real) to b.u (Real)", "between Integers", ".ssd:"],
        ),
        (
            Package::new("1.0", &two(["m", "K"], FORWARD)).refused(),
            ["b.u", "a value in m for one in K", "same quantity"],
        ),
        (
            with("resources/effects.fmu", "resources/effect.fmu"),
            ["test.ssp", "no \"resources/effect.fmu\"", "effects.fmu"],
        ),
        (with("resources/effects.fmu", "../x.fmu"), ["../x.fmu", "leads out of it", ".ssd:"]),
        (with("resources/effects.fmu", "/etc/passwd"), ["/etc/passwd", "nothing outside is opened", ".ssd:"]),
        (
            with("resources/effects.fmu", "file:///etc/passwd"),
            ["file:///etc/passwd", "nothing outside", ".ssd:"],
        ),
        (with("resources/effects.fmu", "http://x.org/x.fmu"), ["http://x.org", "nothing outside", ".ssd:"]),
        (with("resources/effects.fmu", "%2e%2e/x.fmu"), ["%2e%2e", "leads out of it", ".ssd:"]),
        (
            with(" source=\"resources/effects.fmu\"", ""),
            ["component a without source", "resources/UNIT.fmu", ".ssd:"],
        ),
        (
            with("source=", "type=\"text/plain\" source="),
            ["type \"text/plain\"", "application/x-ssp-package", ".ssd:"],
        ),
        (with("source=", "implementation=\"Analog\" source="), ["Analog", "CoSimulation", "component a"]),
        (with("kind=\"input\"", "kind=\"imput\""), ["kind=\"imput\"", "did you mean input", "connector u"]),
        (
            element(&component("a", ["", ""], &values(&real("bias", "x")))),
            ["bias = \"x\"", "a finite number", ".ssd:"],
        ),
        (
            element(&component("a", ["", ""], &values(&real("y", "1")))),
            ["a.y", "computed by the unit", ".ssd:"],
        ),
        (
            element(&component("a", ["", ""], &values(&real("bias", "1 2")))),
            ["bias", "an array", "one value"],
        ),
        (Package::new("3.0", "").refused(), ["version=\"3.0\"", "1.0 and 2.0", ".ssd:"]),
        (
            Package::new("1.0", "").with("SystemStructure.ssd", "<a><b></a>").refused(),
            ["SystemStructure.ssd:1", "b", "a"],
        ),
    ] {
        for part in parts {
            assert!(told.contains(part), "{told}\nlacks {part}");
        }
    }
    let mut empty = Package::new("1.0", "");
    empty.files.remove("SystemStructure.ssd");
    assert!(empty.refused().contains("it holds no \"SystemStructure.ssd\""), "{}", empty.refused());
}
