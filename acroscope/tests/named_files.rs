//! What people name instead of a file: pipes, folders, devices, empty files. Every command says so with exit status 2, and none waits.

#![cfg(unix)]

use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Runs the program; one that hangs is ended and told. The limit is far above what any of these takes on a machine that is busy.
fn run(folder: &Path, arguments: &[&str]) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_acroscope"))
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("starts");
    let limit = Instant::now() + Duration::from_secs(60);
    while child.try_wait().expect("ours").is_none() {
        if Instant::now() > limit {
            child.kill().expect("ours");
            panic!("{arguments:?} hangs");
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    child.wait_with_output().expect("ended")
}

#[test]
fn what_is_no_file_is_refused_by_every_command() {
    let folder = tempfile::TempDir::new().expect("a temporary folder");
    let at = |name: &str| folder.path().join(name);
    for name in ["pipe", "pipe.ssp", "pipe.fmu"] {
        assert!(Command::new("mkfifo").arg(at(name)).status().expect("mkfifo").success());
    }
    std::fs::create_dir(at("folder")).expect("writable");
    for name in ["empty", "log.csv"] {
        std::fs::write(at(name), "").expect("writable");
    }
    let commands: [&[&str]; 11] = [
        &["run", "--out", "out"],
        &["check"],
        &["new"],
        &["import", "--out", "out", "--fmu", "empty"],
        &["import", "--out", "out", "log.csv", "--fmu"],
        &["diagnose", "--out", "out"],
        &["view"],
        &["sweep", "--out", "out"],
        &["ssp", "-o", "made.ssp"],
        &["container", "-o", "made.fmu"],
        &["params"],
    ];
    for name in ["pipe", "pipe.ssp", "pipe.fmu", "folder", "/dev/zero", "empty"] {
        for command in commands {
            let arguments: Vec<&str> = command.iter().copied().chain([name]).collect();
            let output = run(folder.path(), &arguments);
            let text = String::from_utf8_lossy(&output.stderr).into_owned();
            // What `check` finds wrong is a finding, an empty file, too.
            let expected = if (command[0], name) == ("check", "empty") { 1 } else { 2 };
            assert_eq!(output.status.code(), Some(expected), "{arguments:?}: {text}");
            let told =
                if expected == 1 { String::from_utf8_lossy(&output.stdout).into_owned() } else { text };
            assert!(told.contains(name) || told.contains("log.csv"), "{arguments:?}: {told}");
            assert!(!["out", "made.ssp", "made.fmu"].iter().any(|made| at(made).exists()), "{arguments:?}");
        }
    }
}

#[test]
fn a_pipe_is_called_one() {
    let folder = tempfile::TempDir::new().expect("a temporary folder");
    assert!(Command::new("mkfifo").arg(folder.path().join("pipe.fmu")).status().expect("mkfifo").success());
    let text = String::from_utf8(run(folder.path(), &["check", "pipe.fmu"]).stderr).expect("UTF-8");
    assert_eq!(text, "error: pipe.fmu: it is a pipe, not a file; expected an ordinary file\n");
}
