//! Commands that try units out: what hangs comes to an end, what crashes leaves nothing, and what changes at once is drawn so.

use crate::common::{self, Units};
use std::path::Path;
use std::process::Command;

/// Where `unit.c` begins to make an instance.
const INSTANTIATE: &str = "    if (type != 1 ||";

/// A unit that does something first in `fmi2Instantiate`.
fn units_with(what: &str) -> Units {
    let units = Units::new();
    let library = common::library_with(&[(INSTANTIATE, &format!("    {what}\n{INSTANTIATE}"))]);
    units.pack("stateful.fmu", &common::description(common::STATEFUL), &library);
    units
}

/// Exit status, standard output and error, and what is left of temporary files.
fn acroscope(folder: &Path, words: &[&str]) -> (Option<i32>, String, String, Vec<std::ffi::OsString>) {
    let temporary = tempfile::TempDir::new().expect("a temporary folder");
    let done = Command::new(env!("CARGO_BIN_EXE_acroscope"))
        .args(words)
        .current_dir(folder)
        .env("TMPDIR", temporary.path())
        .output()
        .expect("starts");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let left = std::fs::read_dir(temporary.path()).expect("a folder").flatten();
    (
        done.status.code(),
        text(&done.stdout),
        text(&done.stderr),
        left.map(|entry| entry.file_name()).collect(),
    )
}

#[test]
fn law_commands_that_try_a_unit_come_back_from_one_that_hangs() {
    let units = units_with("for (;;) usleep(1000);");
    let scenario = "format = 1\nexperiment = { stop = 1 }\n[[units]]\nname = \"a\"\nfmu = \"stateful.fmu\"\ninterval = 0.125\n";
    std::fs::write(units.path().join("s.toml"), scenario).expect("writable");
    for command in [&["new", "stateful.fmu"], &["params", "s.toml"]] {
        let limited = [&command[..], &["--step-limit", "0.5"]].concat();
        let (status, _, said, left) = acroscope(units.path(), &limited);
        assert_eq!((status, left.len()), (Some(1), 0), "{said}");
        assert!(said.contains("does not come back from fmi2Instantiate within 0.5 s"), "{said}");
        let (status, _, said, left) = acroscope(units.path(), &[&limited[..], &["--isolate"]].concat());
        assert_eq!((status, left.len()), (Some(1), 0), "{said}");
        assert!(said.contains("did not come back within 0.5 s"), "{said}");
    }
}

#[test]
fn law_a_check_leaves_nothing_of_a_unit_that_ends_its_process() {
    for (what, rule) in [
        ("*(volatile int *)8 = 1;", "[crash]"),
        ("exit(0);", "[exit]"),
        ("for (;;) usleep(1000);", "[endless-loop]"),
    ] {
        let units = units_with(what);
        let (status, said, error, left) =
            acroscope(units.path(), &["check", "stateful.fmu", "--step-limit", "1"]);
        assert_eq!((status, left.len()), (Some(1), 0), "{said}{error}{left:?}");
        assert!(said.contains(rule), "{said}");
    }
}

#[test]
fn law_a_unit_that_closes_its_outputs_is_checked_as_any_other() {
    let findings =
        |units: &Units| acroscope(units.path(), &["check", "stateful.fmu", "--json", "--step-limit", "5"]).1;
    let plain = findings(&Units::new());
    assert!(!plain.contains("\"exit\""), "{plain}");
    for what in ["close(1); close(2);", "for (int file = 0; file < 64; file++) close(file);"] {
        assert_eq!(findings(&units_with(what)), plain, "{what}");
    }
}

#[test]
fn law_booleans_and_integers_are_drawn_as_steps() {
    let units = Units::new();
    let scenario = "format = 1\nexperiment = { stop = 1 }\n[[units]]\nname = \"a\"\nfmu = \"stateful.fmu\"\ninterval = 0.125\n\
        [[report.graphs]]\ntitle = \"t\"\ny = \"\"\nlines = [{ signal = \"a.y1\" }, { signal = \"a.b_out\" }, { signal = \"a.i_out\", style = \"dashed\" }]\n";
    std::fs::write(units.path().join("s.toml"), scenario).expect("writable");
    let (status, _, said, _) = acroscope(units.path(), &["run", "s.toml", "--out", "o"]);
    assert_eq!(status, Some(0), "{said}");
    let page = std::fs::read_to_string(units.path().join("o/report.html")).expect("a page");
    assert_eq!(page.matches("\"held\":true").count(), 2, "not the Real one");
}
