//! A run that is killed leaves a readable file up to its last full second.

use crate::common::Units;
use orchestrator::{CsvRecorder, Quiet, Scenario, Simulation};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Set in the process that is to be killed: the file it writes.
const CHILD: &str = "ORCHESTRATOR_KILLED_RUN";

#[test]
fn law_a_killed_run_leaves_whole_rows_up_to_its_last_second() {
    if let Some(file) = std::env::var_os(CHILD) {
        // Each step takes 2 ms, each simulated second 0.1 s.
        let text = "format = 1\nexperiment = { stop = 600 }\n[[units]]\nname = \"a\"\nfmu = \"stateful.fmu\"\n\
                    interval = \"1/50\"\nset = { fault = 8, fault_time = 0, mode = 2 }\n";
        let units = Units::new();
        let scenario = Scenario::parse(text, "test.toml").expect("a scenario");
        let mut simulation = Simulation::new(&scenario, &units.unit_path()).expect("builds");
        simulation.run(&mut CsvRecorder::create(file).expect("writable"), &mut Quiet).expect("runs");
        return;
    }
    let folder = tempfile::TempDir::new().expect("a temporary folder");
    let file = folder.path().join("results.csv");
    let mut child = Command::new(std::env::current_exe().expect("this program"))
        .args(["--exact", "killed::law_a_killed_run_leaves_whole_rows_up_to_its_last_second"])
        .env(CHILD, &file)
        // Its units lie here, since a killed process cleans nothing up.
        .env("TMPDIR", folder.path())
        .stdout(Stdio::null())
        .spawn()
        .expect("starts");
    // Long enough for any machine: the two seconds take 0.2 s.
    let limit = Instant::now() + Duration::from_secs(60);
    while std::fs::read_to_string(&file).map_or(true, |text| !text.contains("\n2.0,")) {
        assert!(Instant::now() < limit, "two simulated seconds in a minute");
        std::thread::sleep(Duration::from_millis(5));
    }
    child.kill().expect("killed with SIGKILL");
    child.wait().expect("ends");

    let text = std::fs::read_to_string(&file).expect("readable");
    assert!(text.ends_with('\n'), "no half row");
    let mut lines = text.lines();
    let columns = lines.next().expect("a header").split(',').count();
    let mut last = f64::NAN;
    for (row, line) in lines.enumerate() {
        assert_eq!(line.split(',').count(), columns);
        last = line.split(',').next().and_then(|time| time.parse().ok()).expect("a time");
        assert_eq!(last, row as f64 / 50.0, "no row is missing");
    }
    assert!(last >= 2.0 && last.fract() == 0.0, "up to a full second: {last}");
}
