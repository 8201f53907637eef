//! The units of the master's measurement, compiled and packed, and the scenario of a ring of three: the nearly free one
//! of `ring.c`, one that costs what a small real one does, of `oscillator.c`, and one that hands on what it gets, of
//! `feedthrough.c`.

#![allow(unsafe_code)] // the plain C loop beside the master

use orchestrator::{Scenario, Simulation, UnitPath};
use std::ffi::c_void;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// A folder with the unit, as a library and as a `.fmu` file.
pub struct Ring {
    folder: TempDir,
    library: PathBuf,
    ports: &'static [(&'static str, &'static str)],
}

/// What each unit of a ring passes on to the next one: from, to.
const REALS: &[(&str, &str)] = &[("y1", "u1"), ("y2", "u2")];
const NUMBERS: &[(&str, &str)] = &[("y1", "u1"), ("y2", "u2"), ("n_out", "n_in"), ("b_out", "b_in")];
const ALL: &[(&str, &str)] =
    &[("y1", "u1"), ("y2", "u2"), ("n_out", "n_in"), ("b_out", "b_in"), ("t_out", "t_in")];

const REFERENCE: &[(&str, &str)] = &[
    ("Float64_continuous_output", "Float64_continuous_input"),
    ("Float64_discrete_output", "Float64_discrete_input"),
    ("Int32_output", "Int32_input"),
    ("Boolean_output", "Boolean_input"),
    ("String_output", "String_input"),
];

impl Default for Ring {
    fn default() -> Self {
        Self::new()
    }
}

impl Ring {
    /// The nearly free one.
    pub fn new() -> Self {
        Self::of("ring", REALS, &[], true)
    }

    /// The oscillator, with an integer and a Boolean on the way as well.
    pub fn of_oscillators() -> Self {
        Self::of("oscillator", NUMBERS, WHOLE, false)
    }

    /// The one that hands on what it gets, with the texts or without.
    pub fn of_feedthroughs(texts: bool) -> Self {
        Self::of("feedthrough", if texts { ALL } else { NUMBERS }, WHOLE_AND_TEXT, true)
    }

    /// The Feedthrough of the FMI project's reference units, from a file.
    pub fn of_reference(file: &Path, texts: bool) -> Self {
        let folder = TempDir::new().expect("a temporary folder");
        let archive = std::fs::File::open(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        zip::ZipArchive::new(archive).expect("an archive").extract(folder.path()).expect("extracted");
        let library = folder.path().join("binaries/linux64/Feedthrough.so");
        let ports = if texts { REFERENCE } else { REFERENCE.split_at(4).0 };
        let ring = Self { folder, library, ports };
        std::fs::copy(file, ring.fmu()).expect("copied");
        ring
    }

    fn of(
        name: &str,
        ports: &'static [(&'static str, &'static str)],
        more: &[Variable],
        feeds_through: bool,
    ) -> Self {
        let folder = TempDir::new().expect("a temporary folder");
        let library = compile(&format!("{name}.c"), folder.path());
        let ring = Self { folder, library, ports };
        let binary = std::fs::read(&ring.library).expect("compiled");
        let mut zip = zip::ZipWriter::new(std::fs::File::create(ring.fmu()).expect("writable"));
        // Not compressed: what is counted is to be the master's work, not that of packing its unit here.
        let options =
            zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
        let description = description(name, more, feeds_through);
        for (name, bytes) in
            [("modelDescription.xml", description.as_bytes()), ("binaries/linux64/unit.so", &binary)]
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

    /// What goes from one to the next: outputs and inputs.
    pub fn ports(&self) -> &'static [(&'static str, &'static str)] {
        self.ports
    }

    /// Three of them in a ring, for a number of steps, with variables to record.
    pub fn simulation(&self, steps: i64, record: &str) -> Simulation {
        self.built(steps, record, "")
    }

    /// The same, each of them in a process of its own.
    pub fn isolated(&self, steps: i64) -> Simulation {
        self.built(steps, "", "isolate = true\n")
    }

    fn built(&self, steps: i64, record: &str, more: &str) -> Simulation {
        let mut text = format!("format = 1\nexperiment = {{ stop = \"{steps}/1000\" }}\n");
        for name in ["a", "b", "c"] {
            text.push_str(&format!(
                "[[units]]\nname = \"{name}\"\nfmu = \"ring.fmu\"\ninterval = \"1/1000\"\n{more}"
            ));
        }
        for (from, to) in [("c", "a"), ("a", "b"), ("b", "c")] {
            for (out, into) in self.ports {
                text.push_str(&format!("[[connections]]\nfrom = \"{from}.{out}\"\nto = \"{to}.{into}\"\n"));
            }
        }
        text.push_str(&format!("[record]\nvariables = [{record}]\n"));
        let scenario = Scenario::parse(&text, "ring.toml").expect("a scenario");
        Simulation::new(&scenario, &UnitPath::new().with(self.path())).expect("builds")
    }
}

/// The functions that a ring's loop calls, in the order of its source.
#[repr(C)]
pub struct Calls<const N: usize>([*const c_void; N]);

/// What every loop needs while it steps.
pub const STEPPING: [&str; 7] =
    ["SetReal", "GetReal", "SetInteger", "SetBoolean", "GetInteger", "GetBoolean", "DoStep"];

impl<const N: usize> Calls<N> {
    /// Looks functions up by their names without `fmi2`.
    pub fn of(library: &libloading::Library, names: [&str; N]) -> Self {
        Self(names.map(|name| {
            // SAFETY: used only as an address.
            let symbol = unsafe { library.get::<unsafe extern "C" fn()>(format!("fmi2{name}")) };
            *symbol.unwrap_or_else(|error| panic!("fmi2{name}: {error}")) as *const c_void
        }))
    }
}

/// Compiles a source of this package to a shared library in a folder.
pub fn compile(source: &str, folder: &Path) -> PathBuf {
    let library = folder.join(source).with_extension("so");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join(source);
    let status = Command::new("cc")
        .args(["-O2", "-shared", "-fPIC", "-fvisibility=hidden", "-Wall", "-o"])
        .args([&library, &source])
        .status()
        .expect("a C compiler");
    assert!(status.success(), "{} compiles", source.display());
    library
}

/// Type, name, reference and causality.
type Variable = (&'static str, &'static str, u32, &'static str);
const REAL: &[Variable] = &[
    ("Real", "u1", 0, "input"),
    ("Real", "u2", 1, "input"),
    ("Real", "y1", 2, "output"),
    ("Real", "y2", 3, "output"),
];
const WHOLE_AND_TEXT: &[Variable] = &[
    ("Integer", "n_in", 0, "input"),
    ("Integer", "n_out", 1, "output"),
    ("Boolean", "b_in", 0, "input"),
    ("Boolean", "b_out", 1, "output"),
    ("String", "t_in", 0, "input"),
    ("String", "t_out", 1, "output"),
];
const WHOLE: &[Variable] = WHOLE_AND_TEXT.split_at(4).0;

/// The description; libcosim caches units by GUID, so it is that of this process. `more` are variables that are no
/// reals. Outputs depend on inputs while stepping, or on the state alone.
fn description(name: &str, more: &[Variable], feeds_through: bool) -> String {
    let variable = |(kind, name, reference, causality): Variable| {
        let (initial, start) = match (causality, kind) {
            ("input", "Boolean") => ("", " start=\"false\""),
            ("input", "String") => ("", " start=\"a text on its way\""),
            ("input", _) => ("", " start=\"0\""),
            _ => (" initial=\"calculated\"", ""),
        };
        let variability = if kind == "Real" { "continuous" } else { "discrete" };
        format!(
            "<ScalarVariable name=\"{name}\" valueReference=\"{reference}\" causality=\"{causality}\" \
             variability=\"{variability}\"{initial}><{kind}{start}/></ScalarVariable>"
        )
    };
    let variables: String = REAL.iter().chain(more).copied().map(variable).collect();
    let unknown = |index: usize, on: &str| format!("<Unknown index=\"{index}\" dependencies=\"{on}\"/>");
    let (mut step, mut initial) = (String::new(), String::new());
    for (at, (.., causality)) in REAL.iter().chain(more).enumerate() {
        if *causality == "output" {
            // An input comes two places before its output among the reals, one before among the others.
            let input = if at < REAL.len() { at - 1 } else { at }.to_string();
            step += &unknown(at + 1, if feeds_through { &input } else { "" });
            initial += &unknown(at + 1, "");
        }
    }
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"2.0\" modelName=\"{name}\" \
         guid=\"{name}-{}\"><CoSimulation modelIdentifier=\"unit\" canHandleVariableCommunicationStepSize=\"true\"/>\
         <ModelVariables>{variables}</ModelVariables><ModelStructure><Outputs>{step}</Outputs>\
         <InitialUnknowns>{initial}</InitialUnknowns></ModelStructure></fmiModelDescription>",
        std::process::id()
    )
}
