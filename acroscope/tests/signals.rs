//! A run that is asked to end: rows and report of what there is, the exit status of the signal, nothing left in the
//! temporary folder. The packed units must be there: `cargo xtask pack`.

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

fn start(folder: &Path, arguments: &[&str]) -> Child {
    let temporary = folder.join("tmp");
    std::fs::create_dir_all(&temporary).expect("writable");
    Command::new(env!("CARGO_BIN_EXE_acroscope"))
        .args(arguments)
        .current_dir(folder)
        .env("TMPDIR", temporary)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts")
}

/// Long enough for any machine.
fn wait_until(what: &str, mut holds: impl FnMut() -> bool) {
    let limit = Instant::now() + Duration::from_secs(120);
    while !holds() {
        assert!(Instant::now() < limit, "{what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn send(signal: &str, child: &Child) {
    let sent = Command::new("kill").args([format!("-{signal}"), child.id().to_string()]).status();
    assert!(sent.expect("there is a kill").success());
}

fn left(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder.join("tmp")).expect("readable").flatten();
    entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect()
}

fn rows_of(folder: &TempDir) -> impl FnMut() -> bool {
    let path = folder.path().join("o/results.csv");
    // Two simulated seconds.
    move || std::fs::read_to_string(&path).is_ok_and(|text| text.contains("\n2.0,"))
}

#[test]
fn law_a_signal_that_comes_twice_at_once_is_one_request() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let child = start(folder.path(), &["run", "visual-servo", "--stop", "100000", "--out", "o"]);
    wait_until("two simulated seconds", rows_of(&folder));
    // As `timeout` does: to the program, then to its group. Two kinds, since two of one kind may arrive as one.
    let both = format!("kill -TERM {0}; kill -HUP {0}", child.id());
    assert!(Command::new("sh").args(["-c", &both]).status().expect("a shell").success());
    let output = child.wait_with_output().expect("it ends");
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(matches!(output.status.code(), Some(143 | 129)), "{text}");
    for name in ["results.csv", "report.html", "summary.json"] {
        assert!(folder.path().join("o").join(name).is_file(), "{name}: {text}");
    }
}

#[test]
fn law_a_signal_ends_a_run_with_its_rows_and_report() {
    for (signal, status) in [("INT", 130), ("TERM", 143), ("HUP", 129), ("XCPU", 152)] {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let child = start(folder.path(), &["run", "visual-servo", "--stop", "100000", "--out", "o"]);
        wait_until("two simulated seconds", rows_of(&folder));
        assert_eq!(left(folder.path()).len(), 1, "one folder holds what is unpacked");
        send(signal, &child);
        let output = child.wait_with_output().expect("it ends");
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(status), "{text}");
        assert!(text.contains(&format!("SIG{signal} at t = ")), "{text}");

        let rows = std::fs::read_to_string(folder.path().join("o/results.csv")).expect("readable");
        assert!(rows.ends_with('\n'), "no half row");
        let last: f64 =
            rows.lines().next_back().and_then(|row| row.split(',').next()?.parse().ok()).expect("a time");
        let summary = std::fs::read_to_string(folder.path().join("o/summary.json")).expect("readable");
        let summary: serde_json::Value = serde_json::from_str(&summary).expect("JSON");
        assert_eq!(summary["ended"]["how"], "interrupted");
        // serde_json reads a double to its last digit but one.
        let told = summary["ended"]["time"].as_f64().expect("a time");
        assert!((told - last).abs() < 1e-12 * last, "every row up to the end is there: {told}, {last}");
        assert_eq!(summary["rows"], rows.lines().count() - 1);
        let page = std::fs::read_to_string(folder.path().join("o/report.html")).expect("readable");
        assert!(page.contains("interrupted at t = "));
        assert!(left(folder.path()).is_empty(), "{:?} is left", left(folder.path()));
    }
}

#[test]
fn law_work_without_an_end_of_its_own_ends_at_once_and_leaves_nothing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let child = start(folder.path(), &["reproduce", "stability-map", "tuning", "--out", "made/for/it"]);
    wait_until("units are unpacked", || !left(folder.path()).is_empty());
    send("TERM", &child);
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(143), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(left(folder.path()).is_empty(), "{:?} is left", left(folder.path()));
    assert!(!folder.path().join("made").exists(), "an empty folder is left");
}

#[test]
fn law_what_a_killed_process_left_is_swept_by_the_next() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut child = start(folder.path(), &["run", "visual-servo", "--stop", "100000", "--out", "o"]);
    wait_until("two simulated seconds", rows_of(&folder));
    child.kill().expect("killed with SIGKILL");
    child.wait().expect("ends");
    assert_eq!(left(folder.path()).len(), 1, "nobody takes it away");
    let next = start(folder.path(), &["run", "full-state", "--stop", "1", "--out", "next"]);
    assert!(next.wait_with_output().expect("it ends").status.success());
    assert!(left(folder.path()).is_empty(), "{:?} is left", left(folder.path()));
}
