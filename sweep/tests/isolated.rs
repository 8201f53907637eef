//! Units that take their process down: in processes of their own they cost their case only.

mod common;

use common::{Bench, STATEFUL, column, description, library_with};
use std::time::Duration;
use sweep::{Limits, Plan, Silent};

/// The units' processes are this program with only this test, which serves them and never returns.
#[test]
fn unit_host() {
    orchestrator::host_units(["--exact", "unit_host", "--nocapture", "--test-threads=1"]);
}

#[test]
fn law_a_crash_or_a_hang_is_a_row() {
    unit_host();
    let bench = Bench::new();
    // 0 nothing, 9 exit, 10 a segmentation fault, 14 an endless loop.
    let text = "[set]\n\"a.fault_time\" = 0.5\n[list]\n\"a.fault\" = [0, 9, 0, 10, 14, 0]\n\"a.x0\" = [1, 2, 3, 4, 5, 6]\n\
        [scalars]\nend = { signal = \"a.y1\", reduce = \"last\" }\n";
    let limits = Limits { isolate: true, step: Some(Duration::from_millis(700)), ..Limits::default() };
    let plan =
        Plan::new(&bench.study(text).expect("a study"), &bench.units.unit_path(), &limits).expect("fits");
    let done = sweep::sweep(&plan, &bench.options("out", 2, None), &Silent).expect("runs");
    assert_eq!((done.ran, done.failed), (6, 3));
    let rows = bench.rows("out", "cases");
    assert_eq!(column(&rows, "end"), [Some(3.0), None, Some(5.0), None, None, Some(8.0)]);
    for (row, said) in
        [(1, "its process ended by exit"), (3, "SIGSEGV"), (4, "did not come back within 0.7 s")]
    {
        let error = rows[row].last().map(|(_, field)| field.to_string()).unwrap_or_default();
        assert!(error.contains("unit a: in fmi2DoStep at t = 0.375 s") && error.contains(said), "{error}");
    }
}

#[test]
fn law_a_library_that_remembers_what_ran_before_gets_a_process_for_each_case() {
    unit_host();
    let bench = Bench::new();
    let remembers = [
        ("static void start(Unit *u) {", "static double lives;\nstatic void start(Unit *u) {"),
        ("    u->r[K] = 1;", "    u->r[K] = 1 + lives++;"),
    ];
    bench.units.pack("stateful.fmu", &description(STATEFUL), &library_with(&remembers));
    let text = "[grid]\n\"a.x0\" = [0, 1, 2]\n[scalars]\nend = { signal = \"a.y1\", reduce = \"last\" }\n";
    let limits = Limits { isolate: true, ..Limits::default() };
    let plan =
        Plan::new(&bench.study(text).expect("a study"), &bench.units.unit_path(), &limits).expect("fits");
    sweep::sweep(&plan, &bench.options("out", 1, None), &Silent).expect("runs");
    assert_eq!(column(&bench.rows("out", "cases"), "end"), [Some(2.0), Some(3.0), Some(4.0)]);
}
