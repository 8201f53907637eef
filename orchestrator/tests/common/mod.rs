//! Makes units for the tests: compiles `fixtures/unit.c` once per test program and packs it with a description.

#![allow(dead_code)] // each test program uses its own share

use orchestrator::{Error, Scenario, Simulation};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use tempfile::TempDir;

/// How a fixture's description differs.
#[derive(Clone, Copy)]
pub struct Fixture {
    pub name: &'static str,
    /// Names of the inputs on which y1 depends directly, as indices of the description (u1 is 1, u2 is 2).
    pub y1_dependencies: &'static str,
    pub u1_unit: &'static str,
    pub y1_unit: &'static str,
    pub guid: &'static str,
}

/// y1 depends on nothing: integrator and clock.
pub const STATEFUL: Fixture =
    Fixture { name: "stateful.fmu", y1_dependencies: "", u1_unit: "", y1_unit: "", guid: "{fixture}" };
/// y1 depends on u1: gain.
pub const FEEDTHROUGH: Fixture = Fixture { name: "feedthrough.fmu", y1_dependencies: "1", ..STATEFUL };

/// A folder with units.
pub struct Units {
    folder: TempDir,
}

impl Units {
    /// Holds the stateful and the feedthrough unit.
    pub fn new() -> Self {
        let units = Self { folder: TempDir::new().expect("a temporary folder") };
        units.add(STATEFUL);
        units.add(FEEDTHROUGH);
        units
    }

    pub fn add(&self, fixture: Fixture) -> PathBuf {
        self.pack(fixture.name, &description(fixture), &library())
    }

    /// Packs any description with any library as the model `unit`.
    pub fn pack(&self, name: &str, description: &str, library: &[u8]) -> PathBuf {
        self.pack_files(name, description, &[("binaries/linux64/unit.so", library)])
    }

    /// Packs any description with any files.
    pub fn pack_files(&self, name: &str, description: &str, files: &[(&str, &[u8])]) -> PathBuf {
        let path = self.folder.path().join(name);
        let mut zip = zip::ZipWriter::new(std::fs::File::create(&path).expect("writable"));
        let options = zip::write::SimpleFileOptions::default();
        for (name, bytes) in [("modelDescription.xml", description.as_bytes())].iter().chain(files) {
            zip.start_file(*name, options).expect("a new entry");
            zip.write_all(bytes).expect("written");
        }
        zip.finish().expect("finished");
        path
    }

    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// The unit path.
    pub fn unit_path(&self) -> orchestrator::UnitPath {
        orchestrator::UnitPath::new().with(self.path())
    }
}

/// The algorithms for units at different rates.
pub fn every_rate() -> impl Iterator<Item = &'static str> {
    orchestrator::algorithms().filter(|name| !orchestrator::needs(name).expect("an algorithm").one_rate)
}

/// Compiles a C file of `fixtures/` to a shared library.
pub fn compile(source: &str) -> Vec<u8> {
    compiled(&fixture(source))
}

/// `unit.c` compiled with some of its text replaced.
pub fn library_with(replaced: &[(&str, &str)]) -> Vec<u8> {
    let mut text = fixture("unit.c");
    for (honest, other) in replaced {
        assert!(text.contains(honest), "{honest}");
        text = text.replace(honest, other);
    }
    compiled(&text)
}

fn fixture(name: &str) -> String {
    let path = fixtures().join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../orchestrator/tests/fixtures")
}

/// The shared library of a text. Kept beside cargo's own results by what went in, since each test is a process of its own
/// and nearly all want the same one.
fn compiled(text: &str) -> Vec<u8> {
    let mut hasher = DefaultHasher::new();
    (text, fixture("unit.c")).hash(&mut hasher); // which others include
    let kept = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("fixture-{:016x}.so", hasher.finish()));
    if let Ok(library) = std::fs::read(&kept) {
        return library;
    }
    let folder = TempDir::new_in(env!("CARGO_TARGET_TMPDIR")).expect("a temporary folder");
    let (source, library) = (folder.path().join("fixture.c"), folder.path().join("unit.so"));
    std::fs::write(&source, text).expect("writable");
    let status = Command::new("cc")
        .args(["-O2", "-shared", "-fPIC", "-fvisibility=hidden", "-Wall", "-I"])
        .args([fixtures().as_path(), Path::new("-o"), &library, &source])
        .args(["-lm", "-lpthread"])
        .status()
        .expect("a C compiler");
    assert!(status.success(), "it compiles:\n{text}");
    let bytes = std::fs::read(&library).expect("compiled");
    std::fs::rename(&library, &kept).expect("the same file system"); // whole, or not there
    bytes
}

/// It refuses a second instance while one is alive.
pub const ONLY_ONCE: [(&str, &str); 3] = [
    ("API void *fmi2Instantiate(", "static int alive;\nAPI void *fmi2Instantiate("),
    ("    if (type != 1 ||", "    if (alive++) return NULL;\n    if (type != 1 ||"),
    ("API void fmi2FreeInstance(void *c) { ", "API void fmi2FreeInstance(void *c) { alive--; "),
];

/// What such a unit says of itself.
pub fn described_as_only_once(fixture: Fixture) -> String {
    description(fixture).replace(
        "canGetAndSetFMUstate=",
        "canBeInstantiatedOnlyOncePerProcess=\"true\" canGetAndSetFMUstate=",
    )
}

/// A reset that keeps `k`, and doubles it.
pub const LEAKY: (&str, &str) = (
    "API int fmi2Reset(void *c) { start(c); return 0; }",
    "API int fmi2Reset(void *c) { double k = ((Unit *)c)->r[K]; start(c); ((Unit *)c)->r[K] = 2 * k; return 0; }",
);

/// The compiled `unit.c`.
pub fn library() -> Vec<u8> {
    static LIBRARY: OnceLock<Vec<u8>> = OnceLock::new();
    LIBRARY.get_or_init(|| compile("unit.c")).clone()
}

/// The description that goes with `unit.c`.
pub fn description(fixture: Fixture) -> String {
    let Fixture { y1_dependencies, u1_unit, y1_unit, guid, .. } = fixture;
    let unit = |name: &str| if name.is_empty() { String::new() } else { format!(" unit=\"{name}\"") };
    let (u1_unit, y1_unit) = (unit(u1_unit), unit(y1_unit));
    format!(
        r#"<?xml version="1.0" encoding="UTF-8"?>
<!-- what the standard allows and importers stumble over: xsi, annotations, flags of the last maintenance release -->
<fmiModelDescription xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:noNamespaceSchemaLocation="x.xsd"
    fmiVersion="2.0" modelName="fixture" guid="{guid}" description="a &quot;fixture&quot; &amp; more">
  <CoSimulation modelIdentifier="unit" canGetAndSetFMUstate="true" canSerializeFMUstate="true" canHandleVariableCommunicationStepSize="true"
      canHandleMultipleSetPerTimeInstant="true"><SourceFiles><File name="unit.c"/></SourceFiles></CoSimulation>
  <UnitDefinitions>
    <Unit name="rad"><BaseUnit rad="1"/><DisplayUnit name="turn" factor="0.15915494309189535"/></Unit>
    <Unit name="deg"><BaseUnit rad="1" factor="0.0174532925199432957"/></Unit>
    <Unit name="K"><BaseUnit K="1"/></Unit>
    <Unit name="degC"><BaseUnit K="1" offset="273.15"/></Unit>
    <Unit name="degF"><BaseUnit K="1" factor="0.5555555555555556" offset="255.37222222222223"/></Unit>
    <Unit name="m"><BaseUnit m="1"/></Unit>
    <Unit name="apples"/>
  </UnitDefinitions>
  <TypeDefinitions><SimpleType name="Positive"><Real min="0" unit="m"/></SimpleType></TypeDefinitions>
  <LogCategories><Category name="logStatusError"/><Category name="logEvents"/></LogCategories>
  <DefaultExperiment startTime="0" stopTime="1" stepSize="0.01"/>
  <VendorAnnotations><Tool name="any"><anything at="all"/></Tool></VendorAnnotations>
  <ModelVariables>
    <ScalarVariable name="u1" valueReference="0" causality="input"><Real start="0"{u1_unit}/><Annotations><Tool name="t"/></Annotations></ScalarVariable>
    <ScalarVariable name="u2" valueReference="1" causality="input"><Real start="0"/></ScalarVariable>
    <ScalarVariable name="y1" valueReference="2" causality="output"><Real{y1_unit}/></ScalarVariable>
    <ScalarVariable name="y2" valueReference="3" causality="output"><Real/></ScalarVariable>
    <ScalarVariable name="k" valueReference="4" causality="parameter" variability="tunable"><Real start="1" max="1e6"/></ScalarVariable>
    <ScalarVariable name="x0" valueReference="5" causality="parameter" variability="fixed"><Real start="0"/></ScalarVariable>
    <ScalarVariable name="fault_time" valueReference="6" causality="parameter" variability="fixed"><Real start="1e300" declaredType="Positive"/></ScalarVariable>
    <ScalarVariable name="i_in" valueReference="0" causality="input"><Integer start="0"/></ScalarVariable>
    <ScalarVariable name="i_out" valueReference="1" causality="output"><Integer/></ScalarVariable>
    <ScalarVariable name="fault" valueReference="2" causality="parameter" variability="fixed"><Integer start="0"/></ScalarVariable>
    <ScalarVariable name="mode" valueReference="3" causality="parameter" variability="fixed"><Integer start="0" min="0" max="2"/></ScalarVariable>
    <ScalarVariable name="b_in" valueReference="0" causality="input"><Boolean start="false"/></ScalarVariable>
    <ScalarVariable name="b_out" valueReference="1" causality="output"><Boolean/></ScalarVariable>
    <ScalarVariable name="s_in" valueReference="0" causality="input"><String start=""/></ScalarVariable>
    <ScalarVariable name="s_out" valueReference="1" causality="output"><String/></ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs>
      <Unknown index="3" dependencies="{y1_dependencies}"/><Unknown index="4" dependencies="2"/>
      <Unknown index="9" dependencies="8"/><Unknown index="13" dependencies="12"/><Unknown index="15" dependencies="14"/>
    </Outputs>
    <InitialUnknowns>
      <Unknown index="3" dependencies="{y1_dependencies} 6"/><Unknown index="4" dependencies="2"/>
      <Unknown index="9" dependencies="8"/><Unknown index="13" dependencies="12"/><Unknown index="15" dependencies="14"/>
    </InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"#
    )
}

/// A unit of a scenario, with a period of 0.125 s.
pub fn unit(name: &str, fmu: &str, set: &str) -> String {
    format!("[[units]]\nname = \"{name}\"\nfmu = \"{fmu}\"\ninterval = 0.125\nset = {{ {set} }}\n")
}

/// A connection of a scenario.
pub fn connection(from: &str, to: &str) -> String {
    format!("[[connections]]\nfrom = \"{from}\"\nto = \"{to}\"\n")
}

/// A simulation of a scenario of these parts, which stops at 1 s.
///
/// # Errors
/// What the scenario or a unit refuses.
pub fn build(units: &Units, parts: &[String]) -> Result<Simulation, Error> {
    let text = format!("format = 1\nexperiment = {{ stop = 1 }}\n{}", parts.concat());
    Simulation::new(&Scenario::parse(&text, "test.toml")?, &units.unit_path())
}
