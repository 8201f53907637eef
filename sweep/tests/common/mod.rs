//! A folder with units, a scenario and studies, and rows read back from Parquet.

#![allow(dead_code, unused_imports)] // each test program uses its own share

#[path = "../../../orchestrator/tests/common/mod.rs"]
mod units;

pub use units::{
    Fixture, LEAKY, ONLY_ONCE, STATEFUL, Units, described_as_only_once, description, library_with,
};

use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::Field;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use sweep::{Done, Error, Limits, Options, Plan, Silent, Study, Watch};

/// One unit, a clock or an integrator of 2, that steps by 1/8 s to 1 s.
pub const SCENARIO: &str = "format = 1\nexperiment = { stop = 1 }\n[[units]]\nname = \"a\"\nfmu = \"stateful.fmu\"\ninterval = 0.125\n\
    [[sources]]\nto = \"a.u1\"\nkind = \"constant\"\nvalue = 2.0\n";

/// A place to work in.
pub struct Bench {
    pub units: Units,
}

impl Bench {
    pub fn new() -> Self {
        let bench = Self { units: Units::new() };
        std::fs::write(bench.path("scenario.toml"), SCENARIO).expect("writable");
        bench
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.units.path().join(name)
    }

    /// A study of the scenario.
    pub fn study(&self, text: &str) -> Result<Study, Error> {
        let text = format!("format = 1\nscenario = \"scenario.toml\"\n{text}");
        Study::parse(&text, &self.path("study.toml"))
    }

    pub fn plan(&self, text: &str) -> Result<Plan, Error> {
        Plan::new(&self.study(text)?, &self.units.unit_path(), &Limits::default())
    }

    pub fn options(&self, out: &str, jobs: usize, partition: Option<(u64, u64)>) -> Options {
        Options { jobs: Some(jobs), partition, ..Options::new(self.path(out)) }
    }

    /// Makes a data set with so many threads.
    pub fn sweep(
        &self,
        text: &str,
        out: &str,
        jobs: usize,
        partition: Option<(u64, u64)>,
    ) -> Result<Done, Error> {
        self.watched(text, out, jobs, partition, &Silent)
    }

    pub fn watched(
        &self,
        text: &str,
        out: &str,
        jobs: usize,
        partition: Option<(u64, u64)>,
        watch: &dyn Watch,
    ) -> Result<Done, Error> {
        sweep::sweep(&self.plan(text)?, &self.options(out, jobs, partition), watch)
    }

    /// The rows of all parts, in order of their names, each as name and value.
    pub fn rows(&self, out: &str, kind: &str) -> Vec<Vec<(String, Field)>> {
        let rows = |path: &PathBuf| {
            let reader =
                SerializedFileReader::new(std::fs::File::open(path).expect("there")).expect("Parquet");
            let rows = reader.get_row_iter(None).expect("rows");
            rows.map(|row| row.expect("a row").into_columns()).collect::<Vec<_>>()
        };
        self.files(out, kind).iter().flat_map(rows).collect()
    }

    /// The parts of a data set.
    pub fn files(&self, out: &str, kind: &str) -> Vec<PathBuf> {
        files(&self.path(out).join(kind))
    }
}

/// The files of a folder, hidden ones too.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    files.sort();
    files
}

/// A column of rows, as numbers; `None` where there is none.
pub fn column(rows: &[Vec<(String, Field)>], name: &str) -> Vec<Option<f64>> {
    let field = |row: &Vec<(String, Field)>| {
        row.iter().find(|(known, _)| known == name).map(|(_, field)| field.clone())
    };
    let number = |row| match field(row).unwrap_or_else(|| panic!("no column {name}")) {
        Field::Double(value) => Some(value),
        Field::Int(value) => Some(f64::from(value)),
        Field::Long(value) => Some(value as f64),
        Field::Bool(value) => Some(f64::from(u8::from(value))),
        _ => None,
    };
    rows.iter().map(number).collect()
}

/// Keeps what a sweep tells.
#[derive(Default)]
pub struct Notes(pub Mutex<Vec<String>>);

impl Watch for Notes {
    fn begin(&self, _: u64, _: u64) {}
    fn ran(&self, _: u64) {}
    fn note(&self, text: &str) {
        self.0.lock().expect("no panic").push(text.to_owned());
    }
    fn ends(&self) -> bool {
        false
    }
}
