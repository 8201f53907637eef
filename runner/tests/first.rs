//! `acroscope-run` as a fresh machine has it: it runs, and says what it doesn't do.

use std::path::Path;
use std::process::{Command, Output};

fn typed(folder: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_acroscope-run"))
        .args(words)
        .current_dir(folder)
        .output()
        .expect("the program starts")
}

#[test]
fn law_a_run_leaves_what_a_run_leaves() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = typed(folder.path(), &["run", "visual-servo", "--stop", "0.2"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let out = folder.path().join("out/visual-servo+stop=0.2");
    for file in ["results.csv", "resolved.toml", "report.html", "summary.json", "frames"] {
        assert!(out.join(file).exists(), "{file}");
    }
    let summary = std::fs::read_to_string(out.join("summary.json")).expect("a text");
    assert!(summary.contains("acroscope run visual-servo --stop 0.2"), "the command that makes it again");
}

#[test]
fn law_what_only_the_whole_program_does_is_refused_before_the_run() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (words, told) in [
        (&["run", "full-state", "--mcap"][..], "--mcap: acroscope-run writes no such file; acroscope does"),
        (&["run", "full-state", "--parquet"], "--parquet: acroscope-run"),
        (&["diagnose", "."], "unrecognized subcommand 'diagnose'"),
        (&["run", "visual-sevro"], "did you mean visual-servo?"),
    ] {
        let output = typed(folder.path(), words);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && said.contains(told), "{words:?}: {said}");
        assert_eq!(std::fs::read_dir(folder.path()).expect("readable").count(), 0, "nothing is left");
    }
}
