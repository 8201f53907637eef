//! Packages around the packed units, put together in a test.

#![allow(dead_code)] // each test program uses its own share

use orchestrator::package::pack;
use orchestrator::{CsvRecorder, Quiet, Scenario, Simulation, UnitPath};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

pub fn units() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/fmus")
}

pub fn unit(name: &str) -> Vec<u8> {
    std::fs::read(units().join(name)).expect("packed units: cargo xtask pack")
}

pub fn results(scenario: &Scenario, folder: &Path) -> String {
    let path = folder.join("results.csv");
    let mut simulation = Simulation::new(scenario, &UnitPath::new().with(units())).expect("builds");
    simulation.run(&mut CsvRecorder::create(&path).expect("writable"), &mut Quiet).expect("runs");
    std::fs::read_to_string(path).expect("written")
}

/// A package of a system's elements and connections around two `signal_effects`, `a` and `b`.
pub struct Package {
    folder: TempDir,
    pub files: BTreeMap<String, Vec<u8>>,
}

pub const HEAD: &str = r#"<?xml version="1.0"?>
<ssd:SystemStructureDescription xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"
  xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon" xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"
  xmlns:ssm="http://ssp-standard.org/SSP1/SystemStructureParameterMapping" version="VERSION" name="test">"#;
pub const UNITS: &str = r#"<ssd:Units>
  <ssc:Unit name="m"><ssc:BaseUnit m="1"/></ssc:Unit><ssc:Unit name="mm"><ssc:BaseUnit m="1" factor="0.001"/></ssc:Unit>
  <ssc:Unit name="K"><ssc:BaseUnit K="1"/></ssc:Unit><ssc:Unit name="degC"><ssc:BaseUnit K="1" offset="273.15"/></ssc:Unit>
</ssd:Units>"#;

/// A component with an input and an output, perhaps in units, and what else is in it.
pub fn component(name: &str, units: [&str; 2], more: &str) -> String {
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

pub fn values(parameters: &str) -> String {
    format!(
        r#"<ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues>
        <ssv:ParameterSet version="1.0" name="p"><ssv:Parameters>{parameters}</ssv:Parameters></ssv:ParameterSet>
        </ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings>"#
    )
}

pub fn real(name: &str, value: &str) -> String {
    format!(r#"<ssv:Parameter name="{name}"><ssv:Real value="{value}"/></ssv:Parameter>"#)
}

impl Package {
    pub fn new(version: &str, system: &str) -> Self {
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

    pub fn with(mut self, name: &str, text: &str) -> Self {
        self.files.insert(name.to_owned(), text.as_bytes().to_vec());
        self
    }

    pub fn path(&self) -> PathBuf {
        let path = self.folder.path().join("test.ssp");
        std::fs::write(&path, pack(&self.files).expect("packed")).expect("writable");
        path
    }

    pub fn read(&self) -> Scenario {
        ssp::read(&self.path()).unwrap_or_else(|error| panic!("{error}"))
    }

    /// The last value of a variable.
    pub fn last(&self, name: &str) -> f64 {
        let mut simulation =
            Simulation::new(&self.read(), &UnitPath::new()).unwrap_or_else(|error| panic!("{error}"));
        simulation.advance_to(0.05).expect("runs");
        simulation.value(name).expect("a variable")
    }

    pub fn refused(&self) -> String {
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
pub fn two(units: [&str; 2], connection: &str) -> String {
    format!(
        "<ssd:Elements>{}{}</ssd:Elements><ssd:Connections>{connection}</ssd:Connections>",
        component("a", ["", units[0]], &values(&real("bias", "5"))),
        component("b", [units[1], ""], "")
    )
}

pub const FORWARD: &str =
    r#"<ssd:Connection startElement="a" startConnector="y" endElement="b" endConnector="u"/>"#;
