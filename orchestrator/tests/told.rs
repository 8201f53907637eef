//! What is told of a call that failed: the variables that it was about, want of memory where there was any, and a state that is too large.

use crate::common::{STATEFUL, Units, description, library_with};
use orchestrator::{Isolation, MemoryRecorder, Quiet, Scenario, Simulation};
use std::time::Duration;

/// The units' processes are this program with only this test, which serves them and never returns.
#[test]
fn unit_host() {
    let program = std::env::current_exe().expect("this program");
    orchestrator::host_units_by(program, ["--exact", "told::unit_host", "--nocapture", "--test-threads=1"]);
}

/// How a run of a unit `a`, which another one drives, ends.
fn ends(units: &Units, fmu: &str, set: &str, isolation: Option<Isolation>) -> String {
    let text = format!(
        "format = 1\nexperiment = {{ stop = 0.55 }}\n[[units]]\nname = \"a\"\nfmu = \"{fmu}\"\ninterval = 0.05\nset = {{ {set} }}\n\
         [[units]]\nname = \"b\"\nfmu = \"stateful.fmu\"\ninterval = 0.05\n[[connections]]\nfrom = \"b.y1\"\nto = \"a.u1\"\n"
    );
    let mut scenario = Scenario::parse(&text, "test.toml").expect("a scenario");
    scenario.units[0].isolation = isolation;
    let mut simulation = Simulation::new(&scenario, &units.unit_path()).expect("builds");
    simulation.run(&mut MemoryRecorder::new(), &mut Quiet).expect_err("ends").to_string()
}

#[test]
fn law_want_of_memory_is_told_where_there_was_and_nowhere_else() {
    unit_host();
    let units = Units::new();
    // Takes what it can get, and says so only by an error.
    let takes = library_with(&[
        ("if (!more) abort();", "if (!more) { u->i[FAULT] = 3; return; }"),
        (
            "misbehave(u, from + size);\n        return 0;",
            "misbehave(u, from + size);\n        return u->i[FAULT] == 3 ? 3 : 0;",
        ),
    ]);
    units.pack("takes.fmu", &description(STATEFUL), &takes);
    // Long enough to fill the memory on any machine.
    let isolation =
        Isolation { step_limit: Duration::from_secs(60), memory_limit: Some(256 << 20), host: None };
    for (fmu, fault, told) in [
        ("stateful.fmu", 20, Some("perhaps for want of memory: it may have 256 MiB")),
        ("takes.fmu", 20, Some("of the 256 MiB that it may have: perhaps it wants memory")),
        // A null pointer, a call of `abort`, an error.
        ("stateful.fmu", 10, None),
        ("stateful.fmu", 11, None),
        ("stateful.fmu", 3, None),
    ] {
        let set = format!("fault = {fault}, fault_time = 0.25");
        let error = ends(&units, fmu, &set, Some(isolation.clone()));
        match told {
            Some(told) => assert!(error.contains(told), "{fmu}, fault {fault}: {error}"),
            None => assert!(!error.contains("memory"), "fault {fault}: {error}"),
        }
    }
}

#[test]
fn law_a_call_about_variables_that_fails_names_them() {
    unit_host();
    let units = Units::new();
    let read =
        "        for (size_t i = 0; i < n; i++) values[i] = ((Unit *)c)->FIELD[refs[i]];             \\\n";
    let write =
        "        for (size_t i = 0; i < n; i++) ((Unit *)c)->FIELD[refs[i]] = values[i];             \\\n";
    let refuse = |fault: i32| {
        format!("        if (((Unit *)c)->reached > 0.2 && ((Unit *)c)->i[FAULT] == {fault}) return 3; \\\n")
    };
    let (no_read, no_write) = (format!("{}{read}", refuse(40)), format!("{}{write}", refuse(41)));
    let refuses = library_with(&[(read, &no_read), (write, &no_write)]);
    units.pack("refuses.fmu", &description(STATEFUL), &refuses);
    for (fault, told) in [
        (40, "unit a: fmi2GetReal of y1, y2 at t = 0.25 s answered error"),
        (41, "unit a: fmi2SetReal of u1 at t = 0.25 s answered error"),
    ] {
        for isolation in [None, Some(Isolation::default())] {
            let error = ends(&units, "refuses.fmu", &format!("fault = {fault}"), isolation.clone());
            assert_eq!(error, told, "{isolation:?}");
        }
    }
}

#[test]
fn bad_sizes_of_a_state_are_told_here_and_elsewhere() {
    unit_host();
    let units = Units::new();
    for (place, size) in ["(size_t)-1", "(size_t)1 << 62"].into_iter().enumerate() {
        let library = library_with(&[("*size = sizeof(Unit);", &format!("*size = {size};"))]);
        let path = units.pack(&format!("size-{place}.fmu"), &description(STATEFUL), &library);
        let fmu = orchestrator::Fmu::open(path).expect("opens");
        let told = |fmu: &orchestrator::Fmu| {
            let mut instance = fmu.instantiate("a").expect("instantiates");
            let saved = instance.save_state().expect("saved");
            let error = instance.serialize_state(&saved).expect_err("too large");
            assert!(!error.is_input(), "the unit is wrong: {error}");
            error.to_string()
        };
        let asks = "unit a: fmi2SerializedFMUstateSize asks for ";
        let here = told(&fmu);
        assert!(here.starts_with(asks) && here.ends_with(" bytes, for which there is no memory"), "{here}");
        let there = told(&fmu.isolated(Isolation::default()));
        assert!(there.contains("its process was ended, since the unit says that its state has"), "{there}");
    }
}

#[test]
fn bad_limits_are_those_that_no_clock_counts_on_from_now() {
    for seconds in ["1e19", "1e9", "0", "-1", "nan", "inf"] {
        let text = format!(
            "format = 1\nexperiment = {{ stop = 1 }}\n[[units]]\nname = \"a\"\nfmu = \"stateful.fmu\"\ninterval = 0.05\nisolate = true\nstep_limit = {seconds}\n"
        );
        let error = Scenario::parse(&text, "test.toml").expect_err(seconds).to_string();
        assert!(error.starts_with("test.toml:8: step_limit = "), "{error}");
        assert!(error.ends_with(": seconds, above zero and below 1e9"), "{error}");
    }
}
