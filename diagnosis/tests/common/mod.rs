//! Data sets for tests: written by hand, or recorded from a simulation with an effect switched on.

use diagnosis::testing::Random;
use diagnosis::{Diagnosis, Notice};
use orchestrator::{MemoryRecorder, Quiet, Scenario, Simulation, UnitPath};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// The repository.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The packed units; `cargo xtask pack` makes them.
pub fn units() -> UnitPath {
    scenarios::unit_path().with(root().join("target/fmus"))
}

/// Options of a test.
pub fn options() -> diagnosis::Options {
    diagnosis::Options::default()
}

/// A folder that goes with the test.
pub struct Folder(PathBuf);

impl Folder {
    pub fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("diagnosis-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(path.join("run-01")).expect("a temporary folder can be made");
        Self(path)
    }

    pub fn path(&self) -> &Path {
        &self.0
    }

    pub fn put(&self, name: &str, text: &str) {
        let path = self.0.join(name);
        std::fs::create_dir_all(path.parent().expect("a file lies in a folder")).expect("it can be made");
        std::fs::write(path, text).expect("a temporary file can be written");
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A head with so many runs.
pub fn manifest(runs: usize) -> String {
    let mut text =
        "format = 1\nscenario = \"visual-servo\"\n[set]\n\"camera.sigma\" = 4.0\n[noise]\n\"plant.q1\" = 2e-4\n\"plant.q2\" = 2e-4\n"
            .to_owned();
    for run in 1..=runs {
        let _ = writeln!(text, "[[run]]\ndir = \"run-{run:02}\"");
    }
    text
}

/// Steps of z_desired.
pub const LIVELY: &str = "[[0, 0], [1, 0], [1.5, 0.3], [3, 0.3], [3.5, -0.2], [5, -0.2], [5.5, 0.3], [7, 0.3], [7.5, -0.2], [9, -0.2], \
                      [9.5, 0.3], [12, 0.3]]";

/// Runs visual-servo with `set` and writes what encoders (2e-4 rad) and the camera saw, two runs of 12 s from
/// different starts.
pub fn recorded(name: &str, set: &[(&str, &str)]) -> Folder {
    recorded_along(name, "[[0, 0], [2, 0], [12, 0.5], [15, 0.5], [25, 0], [30, 0]]", set)
}

/// As `recorded`, along another z_desired than the shipped one.
pub fn recorded_along(name: &str, points: &str, set: &[(&str, &str)]) -> Folder {
    logged_along(name, points, set, false)
}

/// As `recorded_along`; with the torque logged, too (0.01 N·m), 200 times a second where `torque`.
pub fn logged_along(name: &str, points: &str, set: &[(&str, &str)], torque: bool) -> Folder {
    let text = shipped().replace("[[0, 0], [2, 0], [12, 0.5], [15, 0.5], [25, 0], [30, 0]]", points);
    logged_in(name, &text, set, torque)
}

/// The shipped scenario that all of these record.
pub fn shipped() -> String {
    std::fs::read_to_string(root().join("scenarios/visual-servo.toml")).expect("it is shipped")
}

/// As `logged_along`, of a scenario's text.
pub fn logged_in(name: &str, text: &str, set: &[(&str, &str)], torque: bool) -> Folder {
    let folder = Folder::new(name);
    folder.put("dataset.toml", &manifest(2));
    for (run, start) in [(1_u64, "0.1"), (2, "0.2")] {
        let mut scenario = Scenario::parse(text, "visual-servo.toml").expect("it is shipped");
        for (name, value) in [("plant.q2_0", start), ("camera.sigma", "4.0")].iter().chain(set) {
            scenario.set(name, value).expect("the names are right");
        }
        scenario.set_stop("12").expect("a time");
        let mut simulation = Simulation::new(&scenario, &units()).expect("cargo xtask pack was run");
        let mut memory = MemoryRecorder::new();
        simulation.run(&mut memory, &mut Quiet).expect("it runs");
        write_run(&folder, run, &memory, torque);
    }
    if torque {
        let noise = manifest(2).replace("[noise]", "[noise]\n\"plant.tau_applied\" = 0.01");
        folder.put("dataset.toml", &noise);
    }
    folder
}

fn write_run(folder: &Folder, run: u64, memory: &MemoryRecorder, torque: bool) {
    let series = |name: &str| memory.series(name).expect("all outputs are recorded").to_vec();
    let names = ["u1", "v1", "u2", "v2", "u3", "v3", "area1", "area2", "area3", "valid", "q1_est", "q2_est"];
    let seen: Vec<Vec<f64>> = names.iter().map(|name| series(&format!("camera.{name}"))).collect();
    let (frame, tau, q1, q2) =
        (series("camera.frame"), series("controller.tau"), series("plant.q1"), series("plant.q2"));
    let mut random = Random::new(run);
    let mut camera = format!("time,{}\n", names.join(","));
    let head = if torque { "time,q1,q2,tau_applied\n" } else { "time,q1,q2\n" };
    let (mut controller, mut plant) = ("time,tau\n".to_owned(), head.to_owned());
    let applied = series("plant.tau_applied");
    for (row, time) in memory.times().iter().enumerate() {
        if row == 0 || frame[row] != frame[row - 1] {
            let cells: Vec<String> = seen.iter().map(|column| column[row].to_string()).collect();
            let _ = writeln!(camera, "{time},{}", cells.join(","));
            let _ = writeln!(controller, "{time},{}", tau[row]);
        }
        if row % if torque { 3 } else { 20 } == 0 {
            let (a, b) = (q1[row] + 2e-4 * random.normal(), q2[row] + 2e-4 * random.normal());
            let _ = write!(plant, "{time},{a},{b}");
            if torque {
                let _ = write!(plant, ",{}", applied[row] + 0.01 * random.normal());
            }
            plant.push('\n');
        }
    }
    folder.put(&format!("run-{run:02}/camera.csv"), &camera);
    folder.put(&format!("run-{run:02}/controller.csv"), &controller);
    folder.put(&format!("run-{run:02}/plant.csv"), &plant);
}

/// What is found in data that are good.
pub fn found(folder: &Folder) -> Diagnosis {
    diagnosis::diagnose(folder.path(), &units(), &options(), &mut |_| {}).expect("the data is good")
}

/// Names of what was found, in that order.
pub fn names(found: &Diagnosis) -> Vec<&str> {
    found.effects.iter().map(|effect| effect.name.as_str()).collect()
}

/// A log of angles by hand, 30 rows a second.
pub fn plant(rows: usize, scale: f64) -> String {
    let mut text = "time,q1,q2\n".to_owned();
    for row in 0..rows {
        let time = row as f64 / 30.0;
        let _ = writeln!(text, "{time},{},{}", scale * 0.1 * time.sin(), scale * 0.8 * time.cos());
    }
    text
}

/// A log of a torque that is held.
pub fn torque(rows: usize) -> String {
    let mut text = "time,tau\n".to_owned();
    for row in 0..rows {
        let _ = writeln!(text, "{},0.1", row as f64 / 30.0);
    }
    text
}

/// The notice with some words.
pub fn notice<'a>(notices: &'a [Notice], words: &str) -> &'a Notice {
    notices
        .iter()
        .find(|notice| notice.message.contains(words))
        .unwrap_or_else(|| panic!("no {words}: {notices:?}"))
}
