//! Units that take the program down, or try to: in this process a word and the rows stay, in one of their own the run comes
//! to a clear end.

use crate::common;

use crate::common::Units;
use std::path::Path;
use std::process::Command;

/// One unit that steps by 1/8 s to 1 s, with a fault in the step to 0.5 s.
fn scenario_of(fault: i32) -> String {
    format!(
        "format = 1\nexperiment = {{ stop = 1 }}\n[[units]]\nname = \"a\"\nfmu = \"stateful.fmu\"\ninterval = 0.125\n\
         set = {{ fault = {fault}, fault_time = 0.5, mode = 2 }}\n"
    )
}

/// Exit status, standard error and the last time in `results.csv`.
pub(crate) fn run(units: &Units, out: &Path, fault: i32, more: &[&str]) -> (Option<i32>, String, f64) {
    let text = scenario_of(fault);
    let scenario = units.path().join("scenario.toml");
    std::fs::write(&scenario, text).expect("writable");
    let out = out.join(fault.to_string());
    let temporary = tempfile::TempDir::new().expect("a temporary folder");
    let done = Command::new(env!("CARGO_BIN_EXE_acroscope"))
        .arg("run")
        .args([scenario.as_os_str(), "--out".as_ref(), out.as_os_str()])
        .args(more)
        .env("TMPDIR", temporary.path())
        .output()
        .expect("starts");
    let left: Vec<_> = std::fs::read_dir(temporary.path()).expect("a folder").flatten().collect();
    assert!(left.is_empty(), "nothing stays behind: {left:?}");
    let rows = std::fs::read_to_string(out.join("results.csv")).expect("results");
    assert!(rows.ends_with('\n'), "whole rows");
    let last = rows.lines().last().and_then(|row| row.split(',').next()?.parse().ok());
    (done.status.code(), String::from_utf8_lossy(&done.stderr).into_owned(), last.expect("a row"))
}

/// Exit status and standard error of a run with another library.
fn run_with(source: &str, more: &[&str]) -> (Option<i32>, String, Vec<std::ffi::OsString>) {
    let units = Units::new();
    units.pack("stateful.fmu", &common::description(common::STATEFUL), &common::compile(source));
    let (scenario, out, temporary) =
        (units.path().join("s.toml"), units.path().join("o"), units.path().join("t"));
    std::fs::write(&scenario, scenario_of(0)).expect("writable");
    std::fs::create_dir(&temporary).expect("writable");
    let done = Command::new(env!("CARGO_BIN_EXE_acroscope"))
        .arg("run")
        .args([scenario.as_os_str(), "--out".as_ref(), out.as_os_str()])
        .args(more)
        .env("TMPDIR", &temporary)
        .output()
        .expect("starts");
    let left = std::fs::read_dir(temporary).expect("a folder").flatten().map(|entry| entry.file_name());
    (done.status.code(), String::from_utf8_lossy(&done.stderr).into_owned(), left.collect())
}

#[test]
fn every_end_that_a_library_brings_about_when_it_is_loaded_or_unloaded_is_told() {
    let when = "in what its library does when it is loaded or unloaded";
    let (status, text, left) = run_with("ends_when_loaded.c", &[]);
    assert_eq!((status, left.len()), (Some(1), 0), "{text}");
    assert!(text.contains(&format!("error: unit a: it ended the program by calling _exit {when}")), "{text}");
    let (status, text, left) = run_with("ends_when_loaded.c", &["--isolate"]);
    assert_eq!((status, left.len()), (Some(1), 0), "{text}");
    assert!(
        text.contains("error: unit a: in fmi2Instantiate its process ended by exit with status 0"),
        "{text}"
    );
    // All is done by then.
    let (status, text, left) = run_with("crashes_when_unloaded.c", &[]);
    assert_eq!((status, left.len()), (Some(0), 0), "{text}");
    assert!(text.contains(&format!("note: all is done, but unit a gave up (SIGABRT) {when}")), "{text}");
    let (status, text, left) = run_with("crashes_when_unloaded.c", &["--isolate"]);
    assert_eq!((status, left.len()), (Some(0), 0), "{text}");
}

#[test]
fn law_whole_results_stay_whole_though_a_unit_ends_the_program_when_it_is_freed() {
    const EXIT_WHEN_FREED: i32 = 33;
    let units = Units::new();
    let out = tempfile::TempDir::new().expect("a temporary folder");
    let (status, text, last) = run(&units, out.path(), EXIT_WHEN_FREED, &[]);
    assert_eq!((status, last), (Some(0), 1.0), "{text}");
    let word = "note: all is done, but unit a ended the program by calling exit in fmi2FreeInstance";
    assert!(text.contains(word), "{text}");
    assert!(out.path().join(EXIT_WHEN_FREED.to_string()).join("report.html").is_file());
    let (status, text, _) = run(&units, out.path(), EXIT_WHEN_FREED, &["--isolate"]);
    assert_eq!((status, text.as_str()), (Some(0), ""));
}

/// A program that goes on in the background closes what it has open; the one that it is a part of has rows to write.
#[test]
fn law_a_unit_that_closes_all_descriptors_costs_no_row() {
    const CLOSES_ALL: i32 = 30;
    const TAKES_ALL: i32 = 31;
    let units = Units::new();
    let out = tempfile::TempDir::new().expect("a temporary folder");
    let rows =
        |fault: i32| std::fs::read(out.path().join(fault.to_string()).join("results.csv")).expect("rows");
    run(&units, out.path(), 0, &[]);
    for fault in [CLOSES_ALL, TAKES_ALL] {
        for more in [&[][..], &["--isolate"]] {
            let (status, text, last) = run(&units, out.path(), fault, more);
            assert_eq!((status, last), (Some(0), 1.0), "{text}");
            assert!(!text.contains("panicked"), "{text}");
            assert!(out.path().join(fault.to_string()).join("report.html").is_file(), "{text}");
            assert!(rows(fault) == rows(0), "every row is there");
        }
    }
}

#[test]
fn law_a_disk_that_is_full_for_a_unit_is_the_machines() {
    const NO_ROOM: i32 = 32;
    let units = Units::new();
    let out = tempfile::TempDir::new().expect("a temporary folder");
    for more in [&[][..], &["--isolate"]] {
        let (status, text, last) = run(&units, out.path(), NO_ROOM, more);
        assert_eq!((status, last), (Some(1), 0.375), "{text}");
        assert!(text.contains("my file: No space left on device"), "{text}");
    }
}

#[test]
fn law_a_run_that_a_unit_ended_says_so() {
    const WANTS_TO_END: i32 = 15;
    let units = Units::new();
    let out = tempfile::TempDir::new().expect("a temporary folder");
    let (status, text, last) = run(&units, out.path(), WANTS_TO_END, &[]);
    assert_eq!((status, last), (Some(0), 0.4375), "{text}");
    assert_eq!(noted(out.path(), WANTS_TO_END, "\"how\": \"unit\""), 1);
    assert_eq!(noted(out.path(), WANTS_TO_END, "to t = 0.4375 s, where unit a ended the run"), 1);
}

#[test]
fn law_an_error_keeps_its_status_where_nobody_can_be_told() {
    let full = std::fs::File::options().write(true).open("/dev/full").expect("Linux has one");
    let done = Command::new(env!("CARGO_BIN_EXE_acroscope")).args(["run", "none.toml"]).stderr(full).status();
    assert_eq!(done.expect("starts").code(), Some(2));
}

#[test]
fn every_thread_that_a_unit_begins_or_ends_is_survived_or_told() {
    const LEAVES_A_THREAD: i32 = 25;
    const ENDS_ITS_THREAD: i32 = 26;
    const CRASHES_ELSEWHERE: i32 = 28;
    let units = Units::new();
    let out = tempfile::TempDir::new().expect("a temporary folder");
    for more in [&[][..], &["--isolate"]] {
        // Its code must stay where it is, though the unit has gone.
        let (status, text, last) = run(&units, out.path(), LEAVES_A_THREAD, more);
        assert_eq!((status, last), (Some(0), 1.0), "{text}");
    }
    let (status, text, last) = run(&units, out.path(), ENDS_ITS_THREAD, &[]);
    assert_eq!((status, last), (Some(1), 0.375), "{text}");
    // What its way out of the program met last is what is told.
    assert!(text.contains("error: unit a: it gave up (SIGABRT) in "), "{text}");
    let (status, text, last) = run(&units, out.path(), CRASHES_ELSEWHERE, &[]);
    assert_eq!((status, last), (None, 0.375), "{text}");
    let word = "error: the program crashed with a segmentation fault (SIGSEGV) outside of any call into a unit, perhaps in a \
                thread that a unit has started; unit a was in fmi2DoStep, the rows up to there are kept";
    assert!(text.contains(word), "{text}");
    let (status, text, last) = run(&units, out.path(), CRASHES_ELSEWHERE, &["--isolate"]);
    assert_eq!((status, last), (Some(1), 0.375), "{text}");
    assert!(
        text.contains("error: unit a: in fmi2DoStep at t = 0.375 s") && text.contains("SIGSEGV"),
        "{text}"
    );
}

/// The notes of a run's summary that have a word in them.
pub(crate) fn noted(out: &Path, fault: i32, word: &str) -> usize {
    let text = std::fs::read_to_string(out.join(fault.to_string()).join("summary.json")).expect("a summary");
    text.lines().filter(|line| line.contains(word)).count()
}

#[test]
fn law_a_unit_that_rounds_otherwise_changes_nobody_elses_numbers() {
    const ROUNDS_UP: i32 = 27;
    const ROUNDS: &str = "unit a changes how the processor rounds reals";
    let units = Units::new();
    let out = tempfile::TempDir::new().expect("a temporary folder");
    let rows =
        |folder: &str| std::fs::read_to_string(out.path().join(folder).join("results.csv")).expect("rows");
    run(&units, out.path(), 0, &[]);
    assert_eq!(noted(out.path(), 0, ROUNDS), 0);
    let plain = rows("0");
    for more in [&[][..], &["--isolate"]] {
        let (status, text, _) = run(&units, out.path(), ROUNDS_UP, more);
        assert_eq!(status, Some(0), "{text}");
        assert_eq!(rows("27"), plain);
        // In a process of its own it is nobody else's business.
        assert_eq!(noted(out.path(), ROUNDS_UP, ROUNDS), usize::from(more.is_empty()));
    }
}

#[test]
fn law_what_is_not_finite_is_noted_once() {
    const NAN_UNREAD: i32 = 17;
    let units = Units::new();
    let out = tempfile::TempDir::new().expect("a temporary folder");
    for more in [&[][..], &["--isolate"]] {
        let (status, text, _) = run(&units, out.path(), NAN_UNREAD, more);
        assert_eq!(status, Some(0), "{text}");
        assert_eq!(noted(out.path(), NAN_UNREAD, "a.y2 is NaN at t = 0.5 s, for the first time"), 1);
        assert_eq!(noted(out.path(), NAN_UNREAD, " is NaN "), 1);
    }
}

#[test]
fn every_end_that_a_unit_brings_about_is_told_and_rows_are_kept() {
    let units = Units::new();
    let out = tempfile::TempDir::new().expect("a temporary folder");
    for (fault, here, elsewhere) in [
        (9, "it ended the program by calling exit in fmi2DoStep", "its process ended by exit with status 0"),
        (10, "it crashed with a segmentation fault (SIGSEGV) in fmi2DoStep", "SIGSEGV"),
        (11, "it gave up (SIGABRT) in fmi2DoStep", "SIGABRT"),
        (13, "it sent this program SIGTERM in fmi2DoStep", "its process was ended by signal 15 (SIGTERM)"),
        (
            12,
            "it ended the program by calling _exit in fmi2DoStep",
            "its process ended by exit with status 0",
        ),
        (
            29,
            "it was ended by a timer (SIGALRM) in fmi2DoStep",
            "its process was ended by signal 14 (SIGALRM, a timer)",
        ),
        (
            34,
            "it met a breakpoint (SIGTRAP) in fmi2DoStep",
            "its process was ended by signal 5 (SIGTRAP, a breakpoint)",
        ),
        (24, "it ended the program by calling exit in fmi2DoStep", "its process ended by exit with status 0"),
        (
            21,
            "it crashed with a segmentation fault (SIGSEGV) in fmi2DoStep",
            "its process was ended by signal",
        ),
    ] {
        let (status, text, last) = run(&units, out.path(), fault, &[]);
        assert_eq!((status, last), (Some(1), 0.375), "{text}");
        let word = format!(
            "error: unit a: {here} after t = 0.375 s; the rows up to there are kept; in a process of its own"
        );
        assert!(text.contains(&word), "{text}");

        let (status, text, last) = run(&units, out.path(), fault, &["--isolate"]);
        assert_eq!((status, last), (Some(1), 0.375), "{text}");
        assert!(
            text.contains("error: unit a: in fmi2DoStep at t = 0.375 s") && text.contains(elsewhere),
            "{text}"
        );
        assert!(
            text.contains("last calls: ") && text.contains("fmi2DoStep from 0.375 s by 0.125 s"),
            "{text}"
        );
    }
    let (status, text, _) = run(&units, out.path(), 14, &["--isolate", "--step-limit", "0.5"]);
    assert_eq!(status, Some(1), "{text}");
    assert!(text.contains("did not come back within 0.5 s"), "{text}");
    let (status, text, last) = run(&units, out.path(), 0, &["--isolate", "--memory-limit", "512"]);
    assert_eq!((status, last), (Some(0), 1.0), "{text}");
}

#[test]
fn law_results_go_where_they_were_asked_to_though_a_unit_changes_the_folder() {
    const CHANGES_DIRECTORY: i32 = 18;
    let units = Units::new();
    let folder = tempfile::TempDir::new().expect("a temporary folder");
    std::fs::write(units.path().join("scenario.toml"), scenario_of(CHANGES_DIRECTORY)).expect("writable");
    let done = Command::new(env!("CARGO_BIN_EXE_acroscope"))
        .current_dir(folder.path())
        .arg("run")
        .arg(units.path().join("scenario.toml"))
        .args(["--checkpoint", "0.25", "--out", "here/o"])
        .output()
        .expect("starts");
    let text = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(0), "{text}");
    for name in ["results.csv", "report.html", "summary.json", "resolved.toml", "checkpoint.bin"] {
        assert!(folder.path().join("here/o").join(name).is_file(), "{name}: {text}");
    }
    let said = String::from_utf8_lossy(&done.stdout);
    assert!(said.contains("the report is here/o/report.html"), "{said}");
}

#[test]
fn law_a_unit_that_hangs_is_named_when_somebody_ends_it() {
    is_named_when_it_hangs(&scenario_of(14));
}

#[test]
fn law_a_unit_that_hangs_in_a_thread_of_its_own_is_named_as_well() {
    let parallel = "stop = 1, algorithm = \"parallel-jacobi\", options = { threads = 2 }";
    let beside = "[[units]]\nname = \"b\"\nfmu = \"stateful.fmu\"\ninterval = 0.125\n";
    is_named_when_it_hangs(&(scenario_of(14).replace("stop = 1", parallel) + beside));
}

/// Of a scenario whose unit `a` hangs in its step from 0.375 s.
fn is_named_when_it_hangs(text: &str) {
    let units = Units::new();
    let folder = tempfile::TempDir::new().expect("a temporary folder");
    let scenario = units.path().join("scenario.toml");
    std::fs::write(&scenario, text).expect("writable");
    let child = Command::new(env!("CARGO_BIN_EXE_acroscope"))
        .arg("run")
        .args([scenario.as_os_str(), "--out".as_ref(), folder.path().as_os_str()])
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("starts");
    // Once its first row is there it is about to hang; asked twice, it does not wait for the unit.
    let results = folder.path().join("results.csv");
    let limit = std::time::Instant::now() + std::time::Duration::from_secs(60);
    while std::fs::read_to_string(&results).map_or(0, |text| text.lines().count()) < 2 {
        assert!(std::time::Instant::now() < limit, "a row in a minute");
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    for _ in 0..2 {
        std::thread::sleep(std::time::Duration::from_millis(500));
        let pid = child.id().to_string();
        assert!(Command::new("kill").args(["-INT", &pid]).status().expect("kill").success());
    }
    let done = child.wait_with_output().expect("ends");
    let text = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(130), "{text}");
    let word =
        "unit a: it does not come back from fmi2DoStep after t = 0.375 s; the rows up to there are kept";
    assert!(text.contains(word), "{text}");
    let rows = std::fs::read_to_string(&results).expect("results");
    assert!(rows.lines().last().is_some_and(|row| row.starts_with("0.375,")), "{rows}");
}

#[test]
fn law_a_run_goes_on_from_its_checkpoint() {
    let units = Units::new();
    let folder = tempfile::TempDir::new().expect("a temporary folder");
    let out = folder.path();
    let (status, text, last) = run(&units, out, 0, &["--checkpoint", "0.25", "--resume"]);
    assert_eq!((status, last), (Some(0), 1.0), "{text}");
    assert!(text.contains("so the run begins at its start"), "{text}");
    let files =
        ["results.csv", "report.html", "summary.json", "resolved.toml"].map(|name| out.join("0").join(name));
    let read = || files.clone().map(|file| std::fs::read(file).expect("written"));
    let whole = read();
    // The last checkpoint is at the end; what came after it is nothing, and what is beside it is made again.
    std::fs::write(&files[0], [&whole[0][..], b"half a row"].concat()).expect("writable");
    let (status, text, _) = run(&units, out, 0, &["--checkpoint", "0.25", "--resume"]);
    assert_eq!(status, Some(0), "{text}");
    assert!(text.contains("the run goes on from t = "), "{text}");
    assert!(read() == whole);
    let (status, text, _) = run(&units, out, 0, &["--resume", "--set", "a.k=2"]);
    assert_eq!(status, Some(2), "{text}");
    let told = "error: time of the checkpoint = 1 s: it is of another run; this one differs: `k = 2.0` instead of `k = 1.0`";
    assert!(text.starts_with(told), "and no word of going on before it: {text}");
    assert!(read() == whole, "what another run left stays, and nothing is told of it under this one's name");
    // Another build of the unit, under the same GUID.
    let other = [&common::library()[..], b"another build"].concat();
    units.pack("stateful.fmu", &common::description(common::STATEFUL), &other);
    let (status, text, _) = run(&units, out, 0, &["--resume"]);
    assert_eq!(status, Some(2), "{text}");
    assert!(text.contains("this one differs: `unit a: GUID {fixture}, file of checksum "), "{text}");
    assert!(read() == whole);
    units.add(common::STATEFUL);
    // One run at a time.
    let folder_of_results = std::fs::File::open(out.join("0")).expect("a folder");
    folder_of_results.lock().expect("locked");
    let (status, text, _) = run(&units, out, 0, &[]);
    assert_eq!(status, Some(2), "{text}");
    assert!(
        text.contains("/0: another run is writing its results there; --out names another folder"),
        "{text}"
    );
    assert!(read() == whole);
    drop(folder_of_results);
    std::fs::remove_file(&files[0]).expect("removed");
    let scenario = units.path().join("scenario.toml");
    let done = Command::new(env!("CARGO_BIN_EXE_acroscope"))
        .args([
            "run".as_ref(),
            scenario.as_os_str(),
            "--resume".as_ref(),
            "--out".as_ref(),
            out.join("0").as_os_str(),
        ])
        .output()
        .expect("starts");
    let text = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(2), "{text}");
    assert!(
        text.contains(
            "it is gone, though the checkpoint goes on with it; without --resume the run begins anew"
        ),
        "{text}"
    );
}
