//! The nearly free unit of the master's measurement: `ring.c` compiled and packed, and its scenarios.

use orchestrator::{Scenario, Simulation, UnitPath};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// A folder with the unit, as a library and as a `.fmu` file.
pub struct Ring {
    folder: TempDir,
    library: PathBuf,
}

impl Default for Ring {
    fn default() -> Self {
        Self::new()
    }
}

impl Ring {
    /// Compiles and packs.
    pub fn new() -> Self {
        let folder = TempDir::new().expect("a temporary folder");
        let library = folder.path().join("ring.so");
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("ring.c");
        let status = Command::new("cc")
            .args(["-O2", "-shared", "-fPIC", "-fvisibility=hidden", "-Wall", "-o"])
            .args([&library, &source])
            .status()
            .expect("a C compiler");
        assert!(status.success(), "{} compiles", source.display());
        let ring = Self { folder, library };
        let binary = std::fs::read(&ring.library).expect("compiled");
        let mut zip = zip::ZipWriter::new(std::fs::File::create(ring.fmu()).expect("writable"));
        let options = zip::write::SimpleFileOptions::default();
        for (name, bytes) in
            [("modelDescription.xml", description().as_bytes()), ("binaries/linux64/unit.so", &binary)]
        {
            zip.start_file(name, options).expect("a new entry");
            zip.write_all(bytes).expect("written");
        }
        zip.finish().expect("finished");
        ring
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// The library.
    pub fn library(&self) -> &Path {
        &self.library
    }

    /// The packed unit.
    pub fn fmu(&self) -> PathBuf {
        self.folder.path().join("ring.fmu")
    }

    /// Three of them in a ring with six connections, for a number of steps, with variables to record.
    pub fn simulation(&self, steps: i64, record: &str) -> Simulation {
        let mut text = format!("format = 1\nexperiment = {{ stop = \"{steps}/1000\" }}\n");
        for name in ["a", "b", "c"] {
            text.push_str(&format!(
                "[[units]]\nname = \"{name}\"\nfmu = \"ring.fmu\"\ninterval = \"1/1000\"\n"
            ));
        }
        for (from, to) in [("c", "a"), ("a", "b"), ("b", "c")] {
            for port in [1, 2] {
                text.push_str(&format!(
                    "[[connections]]\nfrom = \"{from}.y{port}\"\nto = \"{to}.u{port}\"\n"
                ));
            }
        }
        text.push_str(&format!("[record]\nvariables = [{record}]\n"));
        let scenario = Scenario::parse(&text, "ring.toml").expect("a scenario");
        Simulation::new(&scenario, &UnitPath::new().with(self.path())).expect("builds")
    }
}

/// The description; libcosim caches units by GUID, so it is that of this process.
fn description() -> String {
    let variable = |name: &str, reference: u32, causality: &str| {
        let (initial, start) =
            if causality == "input" { ("", " start=\"0\"") } else { (" initial=\"calculated\"", "") };
        format!(
            "<ScalarVariable name=\"{name}\" valueReference=\"{reference}\" causality=\"{causality}\" \
             variability=\"continuous\"{initial}><Real{start}/></ScalarVariable>"
        )
    };
    let variables = [("u1", 0, "input"), ("u2", 1, "input"), ("y1", 2, "output"), ("y2", 3, "output")]
        .map(|(name, reference, causality)| variable(name, reference, causality))
        .concat();
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"2.0\" modelName=\"ring\" \
         guid=\"ring-{}\"><CoSimulation modelIdentifier=\"unit\" canHandleVariableCommunicationStepSize=\"true\"/>\
         <ModelVariables>{variables}</ModelVariables><ModelStructure><Outputs><Unknown index=\"3\" dependencies=\"1\"/>\
         <Unknown index=\"4\" dependencies=\"2\"/></Outputs><InitialUnknowns><Unknown index=\"3\" dependencies=\"\"/>\
         <Unknown index=\"4\" dependencies=\"\"/></InitialUnknowns></ModelStructure></fmiModelDescription>",
        std::process::id()
    )
}
