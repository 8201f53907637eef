//! When a unit's library leaves the memory. A file with one test: a thread that another test begins would count as the unit's.

#![cfg(target_os = "linux")]

mod common;

use common::Units;
use orchestrator::{MemoryRecorder, Quiet, Scenario, Simulation};

#[test]
fn law_a_library_goes_with_its_last_instance_unless_something_of_it_runs_on() {
    let units = Units::new();
    let loaded = || {
        let maps = std::fs::read_to_string("/proc/self/maps").expect("Linux has it");
        maps.lines()
            .any(|line| line.ends_with("/binaries/linux64/unit.so") || line.contains("unit.so (deleted)"))
    };
    let run = |fault: i32| {
        let text = format!(
            "format = 1\nexperiment = {{ stop = 1 }}\n[[units]]\nname = \"a\"\nfmu = \"stateful.fmu\"\ninterval = 0.25\n\
             set = {{ fault = {fault}, fault_time = 0.25 }}\n"
        );
        let scenario = Scenario::parse(&text, "test.toml").expect("a scenario");
        let mut simulation = Simulation::new(&scenario, &units.unit_path()).expect("builds");
        simulation.run(&mut MemoryRecorder::new(), &mut Quiet).expect("runs");
        assert!(loaded());
    };
    run(0);
    assert!(!loaded());
    // It leaves a thread, which would run into nothing.
    run(25);
    assert!(loaded());
}
