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

/// Each would write over what it reads; what it reads stays as it is.
#[test]
fn what_is_read_is_not_written_over() {
    let folder = tempfile::TempDir::new().expect("a temporary folder");
    let at = |name: &str| folder.path().join(name);
    let unit = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/fmus/acrobot_plant.fmu");
    std::fs::copy(unit, at("plant.fmu")).expect("packed");
    std::fs::write(at("results.csv"), "time,tau\n0,0\n1,0.1\n").expect("writable");
    let text = "format = 1\nexperiment = { stop = 0.1 }\n[[units]]\nname = \"plant\"\nfmu = \"plant.fmu\"\ninterval = 0.05\n\
                [[sources]]\nto = \"plant.tau\"\nkind = \"csv\"\nfile = \"results.csv\"\ncolumn = \"tau\"\n";
    std::fs::write(at("s.toml"), text).expect("writable");
    std::fs::write(at("resolved.toml"), text).expect("writable");
    let names = ["plant.fmu", "results.csv", "s.toml", "resolved.toml"];
    let read = || names.map(|name| std::fs::read(at(name)).expect("it is there"));
    let before = read();
    for (arguments, name) in [
        (&["run", "s.toml", "--out", "."][..], "results.csv"),
        (&["run", "resolved.toml", "--out", "."], "results.csv"),
        (&["container", "s.toml", "-o", "plant.fmu"], "plant.fmu"),
    ] {
        let output = run(folder.path(), arguments);
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
        let told = format!("{name}: it is read for this, and would be written over");
        assert!(text.contains(&told), "{arguments:?}: {text}");
        assert_eq!(read(), before, "{arguments:?}");
    }
    let study = "format = 1\nscenario = \"resolved.toml\"\n[grid]\n\"plant.b_joint\" = [0.0, 0.1]\n\
                 [scalars]\nlast = { signal = \"plant.q1\", reduce = \"last\" }\n";
    std::fs::write(at("study.toml"), study).expect("writable");
    let output = run(folder.path(), &["sweep", "study.toml", "--out", "."]);
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(text.contains("resolved.toml: it is read for this"), "{text}");
    assert_eq!((output.status.code(), read() == before), (Some(2), true), "{text}");
    // a log that is called as a diagnosis calls what it feeds an amended scenario
    std::fs::create_dir(at("set")).expect("writable");
    std::fs::write(at("set/inputs.csv"), "time,tau\n0,0\n1,0.1\n").expect("writable");
    let data = "format = 2\nfmu = \"../plant.fmu\"\n[[channel]]\nvariable = \"plant.tau\"\n[[run]]\nfile = \"inputs.csv\"\n";
    std::fs::write(at("set/dataset.toml"), data).expect("writable");
    let output = run(folder.path(), &["diagnose", "set", "--out", "set"]);
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(text.contains("set/inputs.csv: it is read for this, and would be written over"), "{text}");
    assert_eq!(output.status.code(), Some(2), "{text}");
    // its own results in a place of their own, and once more there: the resolved scenario says the same again
    for scenario in ["s.toml", "out/resolved.toml"] {
        let output = run(folder.path(), &["run", scenario, "--out", "out"]);
        assert!(output.status.success(), "{scenario}: {}", String::from_utf8_lossy(&output.stderr));
    }
    let page = run(folder.path(), &["view", "out", "-o", "out/results.csv"]);
    assert_eq!(page.status.code(), Some(2), "{}", String::from_utf8_lossy(&page.stderr));
}
