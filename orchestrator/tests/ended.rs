//! A unit that ends the program under a guard: what is said, which rows are kept, and with which status it ends. The program is
//! this one with one test; `acroscope/tests/misbehave.rs` looks at the command line likewise.

#![cfg(target_os = "linux")]

use crate::common;

use crate::common::Units;
use orchestrator::{CsvRecorder, Guard, NoRecorder, Quiet, Recorder, Scenario, Simulation, Twice};
use std::path::Path;
use std::process::Command;

/// Set in the process that is to end: the folder with the scenario and the results, and the algorithm.
const CHILD: &str = "ORCHESTRATOR_ENDED_RUN";

#[test]
fn runs() {
    let Some(folder) = std::env::var_os(CHILD) else { return };
    let folder = Path::new(&folder);
    let guard = Guard::begin();
    let scenario = Scenario::load(folder.join("scenario.toml")).expect("a scenario");
    let path = orchestrator::UnitPath::new().with(folder);
    let mut simulation = Simulation::new(&scenario, &path).expect("builds");
    if folder.join("signalled").exists() {
        let number = std::process::id().to_string();
        Command::new("kill").args(["-USR1", &number]).status().expect("of POSIX");
        // It comes to some thread of this program, while none is in a call.
        std::thread::sleep(std::time::Duration::from_secs(60));
    }
    let again = folder.join("again").exists().then(Guard::begin);
    let mut csv = CsvRecorder::create(folder.join("results.csv")).expect("writable");
    let recorder: &mut dyn Recorder = if folder.join("unseen").exists() { &mut NoRecorder } else { &mut csv };
    if folder.join("twice").exists() {
        simulation.run(&mut Twice(recorder, &mut NoRecorder), &mut Quiet).expect("runs");
    } else {
        simulation.run(recorder, &mut Quiet).expect("runs");
    }
    if folder.join("closed").exists() {
        let standard = |place: u32| std::fs::read_link(format!("/proc/self/fd/{place}")).ok();
        assert!((0..3).all(|place| standard(place).is_some_and(|to| to == Path::new("/dev/null"))));
    }
    orchestrator::all_done(7);
    drop(simulation);
    orchestrator::fmu::discard_unpacked();
    if folder.join("at_once").exists() {
        orchestrator::exit_at_once(3);
    }
    drop(again);
    let status = guard.done(7);
    // The test harness would make it 0.
    std::process::exit(status.into());
}

/// Status, standard error and the time of the last row of a run with a fault from 0.25 s on.
fn ended(fault: i32, algorithm: &str, unseen: bool) -> (Option<i32>, String, Option<f64>) {
    ended_of(&Units::new(), fault, algorithm, unseen)
}

fn ended_of(units: &Units, fault: i32, algorithm: &str, unseen: bool) -> (Option<i32>, String, Option<f64>) {
    let text = format!(
        "format = 1\nexperiment = {{ stop = 1, algorithm = \"{algorithm}\" }}\n\
         [[units]]\nname = \"b\"\nfmu = \"stateful.fmu\"\ninterval = 0.125\n\
         [[units]]\nname = \"a\"\nfmu = \"stateful.fmu\"\ninterval = 0.125\nset = {{ fault = {fault}, fault_time = 0.25 }}\n"
    );
    std::fs::write(units.path().join("scenario.toml"), text).expect("writable");
    if unseen {
        std::fs::write(units.path().join("unseen"), "").expect("writable");
    }
    let temporary = units.path().join("temporary");
    std::fs::create_dir(&temporary).expect("writable");
    let done = Command::new(std::env::current_exe().expect("this program"))
        .args(["--exact", "ended::runs", "--nocapture", "--test-threads=1"])
        .env(CHILD, units.path())
        .env("TMPDIR", &temporary)
        .output()
        .expect("starts");
    let text = String::from_utf8_lossy(&done.stderr).into_owned();
    let left: Vec<_> =
        std::fs::read_dir(&temporary).expect("a folder").flatten().map(|e| e.file_name()).collect();
    assert!(left.is_empty(), "nothing stays behind of fault {fault}: {left:?}\n{text}");
    // none where it ended before there was a recorder
    let rows = std::fs::read_to_string(units.path().join("results.csv")).unwrap_or_default();
    assert!(rows.is_empty() || rows.ends_with('\n'), "whole rows: {rows}");
    let last = rows.lines().last().and_then(|row| row.split(',').next()?.parse().ok());
    (done.status.code(), text, last)
}

#[test]
fn every_end_of_the_program_by_a_unit_is_told_and_its_rows_are_kept() {
    for (fault, what) in [
        (9, "ended the program by calling exit"),
        (10, "crashed with a segmentation fault (SIGSEGV)"),
        (11, "gave up (SIGABRT)"),
        (21, "crashed with a segmentation fault (SIGSEGV)"),
        (24, "ended the program by calling exit"),
        (29, "was ended by a timer (SIGALRM)"),
        (34, "met a breakpoint (SIGTRAP)"),
    ] {
        for algorithm in ["gauss-seidel", "parallel-jacobi"] {
            let (status, text, last) = ended(fault, algorithm, false);
            let told = format!(
                "\nerror: unit a: it {what} in fmi2DoStep after t = 0.125 s; the rows up to there are kept; in a process"
            );
            assert!(text.contains(&told), "fault {fault}, {algorithm}: {text}");
            assert_eq!((status, last), (Some(1), Some(0.125)), "fault {fault}, {algorithm}: {text}");
        }
        let (status, text, last) = ended(fault, "gauss-seidel", true);
        assert!(text.contains(&format!("\nerror: unit a: it {what} in fmi2DoStep after t = ")), "{text}");
        assert!(!text.contains("rows") && (status, last) == (Some(1), None), "{text}");
    }
}

#[test]
fn every_end_before_the_first_row_names_unit_and_function() {
    const CRASH: &str = "*(volatile int *)0 = 1;";
    let read = ("        fresh(c); ", format!("        {CRASH}"), "fmi2GetReal");
    let version = ("return \"2.0\";", format!("{CRASH} return \"2.0\";"), "fmi2GetVersion");
    for (honest, broken, function) in [read, version] {
        let units = Units::new();
        let library = common::library_with(&[(honest, &broken)]);
        units.pack("stateful.fmu", &common::description(common::STATEFUL), &library);
        let (status, text, last) = ended_of(&units, 0, "gauss-seidel", false);
        let told = format!("error: unit b: it crashed with a segmentation fault (SIGSEGV) in {function}");
        assert!(text.contains(&told), "{function}: {text}");
        assert_eq!((status, last), (Some(1), None), "{text}");
    }
}

#[test]
fn law_rows_of_the_first_of_two_recorders_are_kept() {
    let units = Units::new();
    std::fs::write(units.path().join("twice"), "").expect("writable");
    let (status, text, last) = ended_of(&units, 10, "gauss-seidel", false);
    assert_eq!((status, last), (Some(1), Some(0.125)), "{text}");
    assert!(text.contains("the rows up to there are kept"), "{text}");
}

#[test]
fn law_a_run_that_ends_by_itself_keeps_its_status() {
    assert_eq!(ended(0, "gauss-seidel", false), (Some(7), String::new(), Some(1.0)));
    // A library that ends the program when it is freed is told, and changes the status no more.
    let (status, text, last) = ended(33, "gauss-seidel", false);
    assert_eq!((status, last), (Some(7), Some(1.0)), "{text}");
    assert!(
        text.contains("note: all is done, but unit a ended the program by calling exit in fmi2FreeInstance"),
        "{text}"
    );
    // Nor does one that ends the program at once when all is done.
    let units = Units::new();
    std::fs::write(units.path().join("at_once"), "").expect("writable");
    let (status, text, last) = ended_of(&units, 0, "gauss-seidel", false);
    assert_eq!((status, text.as_str(), last), (Some(7), "", Some(1.0)));
}

#[test]
fn law_a_library_that_crashes_at_the_very_end_changes_no_status() {
    // It stays in memory for its thread, and goes when the program does.
    let crashes = (
        "static int overflow(",
        "__attribute__((destructor)) static void last(void) { *nowhere = 1; }\nstatic int overflow(",
    );
    let units = Units::new();
    let library = common::library_with(&[crashes]);
    units.pack("stateful.fmu", &common::description(common::STATEFUL), &library);
    let (status, text, last) = ended_of(&units, 25, "gauss-seidel", false);
    let told = "note: all is done, but a library of a unit crashed with a segmentation fault (SIGSEGV) when it was unloaded";
    assert!(text.contains(told), "{text}");
    assert_eq!((status, last), (Some(7), Some(1.0)), "{text}");
}

#[test]
fn law_a_signal_from_elsewhere_ends_the_program_as_it_would_by_itself() {
    let units = Units::new();
    std::fs::write(units.path().join("signalled"), "").expect("writable");
    std::fs::write(units.path().join("results.csv"), "").expect("writable");
    let (status, text, _) = ended_of(&units, 0, "gauss-seidel", false);
    assert!(
        text.contains("error: the program was ended by SIGUSR1 outside of any call into a unit"),
        "{text}"
    );
    assert_eq!(status, None, "by the signal: {text}");
}

#[test]
fn law_a_signal_that_a_unit_handles_is_its_own() {
    // It has its handler before the program is guarded anew, and one timer after the other.
    let handles = [
        (
            "typedef struct {\n    double r[REALS]",
            "static void handle(int number) { (void)number; }\ntypedef struct {\n    double r[REALS]",
        ),
        (
            "    Unit *u = callbacks->allocate(",
            "    signal(SIGALRM, handle);\n    Unit *u = callbacks->allocate(",
        ),
    ];
    let units = Units::new();
    units.pack("stateful.fmu", &common::description(common::STATEFUL), &common::library_with(&handles));
    std::fs::write(units.path().join("again"), "").expect("writable");
    let (status, text, last) = ended_of(&units, 29, "gauss-seidel", false);
    assert_eq!((status, text.as_str(), last), (Some(7), "", Some(1.0)));
}

#[test]
fn law_a_crash_outside_of_any_call_is_told_as_such() {
    let (status, text, last) = ended(28, "gauss-seidel", false);
    assert!(
        text.contains("outside of any call into a unit, perhaps in a thread that a unit has started"),
        "{text}"
    );
    assert_eq!((status, last), (None, Some(0.125)), "{text}");
}

#[test]
fn law_rows_are_kept_though_a_unit_has_closed_their_file() {
    const CLOSES_ALL: i32 = 30;
    const TAKES_ALL: i32 = 31;
    // So nothing is heard of it either.
    for fault in [CLOSES_ALL, TAKES_ALL] {
        assert_eq!(ended(fault, "gauss-seidel", false), (Some(7), String::new(), Some(1.0)), "fault {fault}");
    }
    // Nothing else takes the places of standard input, output and error.
    let units = Units::new();
    std::fs::write(units.path().join("closed"), "").expect("writable");
    assert_eq!(ended_of(&units, CLOSES_ALL, "gauss-seidel", false), (Some(7), String::new(), Some(1.0)));
    for (fault, done) in [(CLOSES_ALL, "close(i); break;"), (TAKES_ALL, "dup2(mine, i); break; }")] {
        let units = Units::new();
        let gives_up = common::library_with(&[(done, &done.replace("break;", "abort();"))]);
        units.pack("stateful.fmu", &common::description(common::STATEFUL), &gives_up);
        let (status, _, last) = ended_of(&units, fault, "gauss-seidel", false);
        assert_eq!((status, last), (Some(1), Some(0.125)), "fault {fault}");
    }
}
