//! What the tests share: the fixture unit, and the process in which rules run it.

#![allow(dead_code, unused_imports)] // each test program uses its own share

#[path = "../../../orchestrator/tests/common/mod.rs"]
mod units;

pub use units::Units;

use inspection::{Finding, Limits, Severity};
use std::path::Path;
use std::sync::OnceLock;
use std::time::Duration;

/// Our own units that run by themselves.
pub const OURS: [&str; 5] =
    ["acrobot_plant", "acrobot_camera", "acrobot_controller", "acrobot_residual", "signal_effects"];

/// The process of a rule is the test program with only the test `rule_host`, which calls this.
pub fn host() {
    inspection::host_rules(["--exact", "rule_host", "--nocapture", "--test-threads=1"]);
}

/// The description of `fixtures/faulty.c`, which no rule has anything to say about.
pub const DESCRIPTION: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="faulty" guid="{fault-0}" generationDateAndTime="2026-11-24T12:00:00Z" variableNamingConvention="structured">
  <CoSimulation modelIdentifier="unit" canHandleVariableCommunicationStepSize="true" canInterpolateInputs="true" maxOutputDerivativeOrder="1" canGetAndSetFMUstate="true" canSerializeFMUstate="true" providesDirectionalDerivative="true"/>
  <UnitDefinitions>
    <Unit name="m"><BaseUnit m="1"/><DisplayUnit name="mm" factor="1000"/></Unit>
    <Unit name="m/s"><BaseUnit m="1" s="-1"/></Unit>
  </UnitDefinitions>
  <TypeDefinitions>
    <SimpleType name="Place"><Real unit="m" displayUnit="mm" min="-1e6" max="1e6"/></SimpleType>
    <SimpleType name="Mode"><Enumeration><Item name="slow" value="1"/><Item name="fast" value="2"/></Enumeration></SimpleType>
  </TypeDefinitions>
  <LogCategories><Category name="logStatusError"/></LogCategories>
  <DefaultExperiment startTime="0" stopTime="2" stepSize="0.01"/>
  <ModelVariables>
    <ScalarVariable name="u" valueReference="0" causality="input"><Real start="1" unit="m/s"/></ScalarVariable>
    <ScalarVariable name="y" valueReference="1" causality="output"><Real declaredType="Place"/></ScalarVariable>
    <ScalarVariable name="d" valueReference="2" causality="output"><Real/></ScalarVariable>
    <ScalarVariable name="k" valueReference="3" causality="parameter" variability="fixed"><Real start="2"/></ScalarVariable>
    <ScalarVariable name="x0" valueReference="4" causality="parameter" variability="fixed"><Real declaredType="Place" start="0.5"/></ScalarVariable>
    <ScalarVariable name="n" valueReference="0" causality="input" variability="discrete"><Integer start="0" min="0" max="9"/></ScalarVariable>
    <ScalarVariable name="c" valueReference="1" causality="output" variability="discrete"><Integer/></ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs>
      <Unknown index="2" dependencies=""/>
      <Unknown index="3" dependencies="1" dependenciesKind="dependent"/>
      <Unknown index="7" dependencies="6"/>
    </Outputs>
    <InitialUnknowns>
      <Unknown index="2" dependencies="5"/>
      <Unknown index="3" dependencies="1 4 5"/>
      <Unknown index="7" dependencies="6"/>
    </InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"#;

/// The compiled fixture.
pub fn library() -> Vec<u8> {
    static LIBRARY: OnceLock<Vec<u8>> = OnceLock::new();
    LIBRARY.get_or_init(|| units::compile("../../../inspection/tests/fixtures/faulty.c")).clone()
}

/// What is found in a file.
pub fn check(path: &Path) -> Vec<Finding> {
    host();
    inspection::check(path, &Limits { call: Duration::from_secs(3), memory: 1 << 30 }).expect("looked at")
}

/// Findings in short: rule, severity, variable.
pub fn short(findings: &[Finding]) -> Vec<(&str, Severity, Option<&str>)> {
    findings
        .iter()
        .map(|finding| (finding.rule.as_str(), finding.severity, finding.variable.as_deref()))
        .collect()
}

/// A unit with a fault of `fixtures/faulty.c`.
pub fn faulty(units: &Units, fault: u32) -> std::path::PathBuf {
    let text = DESCRIPTION.replace("{fault-0}", &format!("{{fault-{fault}}}"));
    units.pack(&format!("faulty-{fault}.fmu"), &text, &library())
}
