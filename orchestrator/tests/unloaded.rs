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
        let of_units =
            |line: &&str| line.ends_with("/binaries/linux64/unit.so") || line.contains("unit.so (deleted)");
        // Address, rights, offset, device and number of the file before its name.
        let files = maps.lines().filter(of_units).filter_map(|line| line.split_whitespace().nth(4));
        files.collect::<std::collections::BTreeSet<_>>().len()
    };
    let run = |fault: i32| {
        let text = format!(
            "format = 1\nexperiment = {{ stop = 1 }}\n[[units]]\nname = \"a\"\nfmu = \"stateful.fmu\"\ninterval = 0.25\n\
             set = {{ fault = {fault}, fault_time = 0.25 }}\n"
        );
        let scenario = Scenario::parse(&text, "test.toml").expect("a scenario");
        let mut simulation = Simulation::new(&scenario, &units.unit_path()).expect("builds");
        simulation.run(&mut MemoryRecorder::new(), &mut Quiet).expect("runs");
        loaded()
    };
    assert_eq!((run(0), loaded()), (1, 0));
    // It leaves a handler of a signal that may come at any time.
    let handles = (
        "    Unit *u = callbacks->allocate(",
        "    signal(SIGURG, handle);\n    Unit *u = callbacks->allocate(",
    );
    let handler = (
        "API void *fmi2Instantiate(",
        "static void handle(int number) { (void)number; }\nAPI void *fmi2Instantiate(",
    );
    units.pack(
        "stateful.fmu",
        &common::description(common::STATEFUL),
        &common::library_with(&[handles, handler]),
    );
    assert_eq!((run(0), loaded()), (1, 1));
    // It leaves a thread, which would run into nothing.
    units.add(common::STATEFUL);
    assert_eq!((run(25), loaded()), (2, 2));
}
