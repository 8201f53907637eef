//! What README.md and the book print is what the program does. The packed units must be there: `cargo xtask pack`.

use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Each command of a page's console blocks without its comment, and the lines that follow it.
fn commands(page: &str) -> Vec<(String, Vec<String>)> {
    let text = std::fs::read_to_string(root().join(page)).unwrap_or_else(|why| panic!("{page}: {why}"));
    let mut found: Vec<(String, Vec<String>)> = Vec::new();
    for block in text.split("```console\n").skip(1) {
        for line in block.split("```").next().unwrap_or_default().lines() {
            match line.strip_prefix("$ ") {
                Some(command) => found
                    .push((command.split(" # ").next().unwrap_or_default().trim().to_owned(), Vec::new())),
                None => found.last_mut().expect("a command comes first").1.push(line.to_owned()),
            }
        }
    }
    found
}

#[test]
fn every_scenario_and_data_set_of_the_readme_is_there() {
    let commands = commands("README.md");
    let runs: Vec<&str> =
        commands.iter().filter_map(|(command, _)| command.strip_prefix("cargo acroscope run ")).collect();
    assert!(runs.len() >= 4, "{runs:?}");
    for run in runs.iter().filter(|run| !run.starts_with("my-")) {
        let name = run.split_whitespace().next().unwrap_or_default();
        let mut scenario = scenarios::load(name).unwrap_or_else(|why| panic!("{why}"));
        for set in run.split("--set ").skip(1) {
            let (name, value) = set.trim().split_once('=').expect("UNIT.VARIABLE=VALUE");
            scenario
                .set(name, value.split(' ').next().unwrap_or_default())
                .unwrap_or_else(|why| panic!("{why}"));
        }
        orchestrator::Simulation::new(&scenario, &scenarios::unit_path())
            .unwrap_or_else(|why| panic!("{run}: {why}"));
    }
}

#[test]
fn paper_the_diagnosis_on_the_first_screen_is_as_printed() {
    let commands = commands("README.md");
    let (command, printed) = &commands[0];
    let (told_command, told) = self::commands("docs/diagnosis-told.md").swap_remove(0);
    assert_eq!(&told_command, command, "the chapter tells the same case");
    assert_eq!(command, "cargo acroscope diagnose examples/hidden-effect", "the unusual thing comes first");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = Command::new(env!("CARGO_BIN_EXE_acroscope"))
        .args(command.split_whitespace().skip(2))
        .args(["--out".as_ref(), folder.path().as_os_str()])
        .current_dir(root())
        .output()
        .expect("the program starts");
    let text = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(printed.len() >= 2, "README shows what it says");
    for line in printed.iter().chain(&told).filter(|line| *line != "...") {
        assert!(text.lines().any(|said| said == line), "a page prints {line:?}, the program says\n{text}");
    }
    // The truth, as tests/hidden put it in (examples/README.md).
    let json = std::fs::read_to_string(folder.path().join("diagnosis.json")).expect("written");
    let diagnosis: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(diagnosis["effects"].as_array().map(Vec::len), Some(1));
    let effect = &diagnosis["effects"][0];
    assert_eq!(effect["name"], "plant.b_joint");
    let value = effect["value"].as_f64().expect("a number");
    // Three standard errors of 4e-5, which is what the printed interval says.
    assert!((value - 0.02).abs() < 1.2e-4, "{value}");
}
