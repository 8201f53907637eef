//! What is asked in vain, or can't be told to anybody, as a person meets it. The packed units must be there: `cargo xtask pack`.

use crate::common;

use crate::common::Units;
use std::path::Path;
use std::process::{Command, Output};

const SCENARIO: &str = "format = 1\nexperiment = { stop = 3 }\n[[units]]\nname = \"a\"\nfmu = \"stateful.fmu\"\ninterval = 0.5\n";

fn acroscope(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_acroscope"));
    command.current_dir(folder);
    command
}

fn told(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn bad_input_a_unit_is_no_scenario_and_a_limit_needs_something_to_limit() {
    let units = Units::new();
    std::fs::write(units.path().join("s.toml"), SCENARIO).expect("writable");
    for (words, expected) in [
        (&["run", "stateful.fmu"][..], "`acroscope new stateful.fmu` makes a scenario of it"),
        (&["run", "s.toml", "--step-limit", "2"], "--step-limit is for units in processes of their own"),
        (&["run", "s.toml", "--memory-limit", "64"], "add --isolate"),
        (&["params", "s.toml", "a.x", "zzz"], "nothing that can be set begins with \"zzz\": "),
        (&["run", "nodir/x.toml"], "; there is no folder nodir"),
    ] {
        let refused = acroscope(units.path()).args(words).output().expect("starts");
        assert!(refused.status.code() == Some(2) && told(&refused).contains(expected), "{}", told(&refused));
    }
}

#[test]
fn bad_input_a_place_to_unpack_that_is_not_there_is_told_as_such() {
    let units = Units::new();
    std::fs::write(units.path().join("s.toml"), SCENARIO).expect("writable");
    let refused = acroscope(units.path()).args(["run", "s.toml"]).env("TMPDIR", "/no/such/folder").output();
    let refused = refused.expect("starts");
    let text = told(&refused);
    assert!(
        refused.status.code() == Some(2) && text.contains("can't be unpacked in /no/such/folder"),
        "{text}"
    );
}

/// `/dev/full` is a full disk.
#[cfg(target_os = "linux")]
#[test]
fn law_lines_that_are_lost_are_told_in_the_end() {
    let units = Units::new();
    std::fs::write(units.path().join("s.toml"), SCENARIO).expect("writable");
    let full = std::fs::File::options().write(true).open("/dev/full").expect("there is one");
    let done =
        acroscope(units.path()).args(["run", "s.toml", "--out", "o"]).stdout(full).output().expect("starts");
    assert!(
        done.status.code() == Some(1) && told(&done).contains("the standard output can't be written"),
        "{}",
        told(&done)
    );
    assert!(units.path().join("o/report.html").is_file(), "the run itself is whole");
}

/// A unit splits the program, and both come back from the step: the rows are written once.
#[cfg(unix)]
#[test]
fn law_a_copy_of_the_program_writes_nothing() {
    let line = "u->i[I_OUT] = u->i[I_IN] + 1;";
    let splits = format!("{line} static int copy; if (size > 0 && !copy) copy = fork();");
    let units = Units::new();
    units.pack(
        "stateful.fmu",
        &common::description(common::STATEFUL),
        &common::library_with(&[(line, &splits)]),
    );
    std::fs::write(units.path().join("s.toml"), SCENARIO).expect("writable");
    let done = acroscope(units.path()).args(["run", "s.toml", "--out", "o"]).output().expect("starts");
    let out = String::from_utf8_lossy(&done.stdout).into_owned();
    assert!(done.status.success() && out.matches("ran to t = 3 s").count() == 1, "{out}");
    let rows = std::fs::read_to_string(units.path().join("o/results.csv")).expect("results");
    assert_eq!(rows.lines().count(), 8, "a head and seven points:\n{rows}");
}

/// A file of no bytes is no zip archive: one rule was looked at, and found it.
#[test]
fn value_check_counts_the_rules_that_were_looked_at() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("empty.fmu"), "").expect("writable");
    let checked = acroscope(folder.path()).args(["check", "empty.fmu", "--out", "ck"]).output();
    let text = String::from_utf8_lossy(&checked.expect("starts").stdout).into_owned();
    let expected = "empty.fmu: 1 error, 0 warnings, 0 notes of 1 rule; 57 rules not looked at, because the file is no zip archive";
    assert!(text.contains(expected), "{text}");
    let page = std::fs::read_to_string(folder.path().join("ck/report.html")).expect("a page");
    assert!(page.contains("Rules that were not looked at"), "it has a group of its own");
}

/// The file names the folder that it lies in.
#[test]
fn value_a_data_set_may_be_named_by_its_own_file() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::create_dir(folder.path().join("h")).expect("writable");
    std::fs::write(folder.path().join("h/dataset.toml"), "format = 1\n").expect("writable");
    let refused = acroscope(folder.path()).args(["diagnose", "h/dataset.toml"]).output().expect("starts");
    assert!(told(&refused).starts_with("error: h/dataset.toml:1: "), "{}", told(&refused));
}
