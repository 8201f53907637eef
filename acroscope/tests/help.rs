//! What the program says of itself: parameters, completions, manual pages. The packed units must be there.

use std::process::{Command, Output};

fn acroscope(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_acroscope")).args(arguments).output().expect("the program starts")
}

fn text(arguments: &[&str]) -> String {
    let output = acroscope(arguments);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn every_parameter_has_its_value_unit_range_and_neutral_value() {
    let list = text(&["params", "visual-servo", "--json"]);
    let list: Vec<serde_json::Value> = serde_json::from_str(&list).expect("a list");
    let of = |name: &str| {
        list.iter().find(|entry| entry["name"] == name).unwrap_or_else(|| panic!("{name} is missing"))
    };
    let k1 = of("camera.k1");
    assert_eq!((&k1["value"], &k1["neutral"], &k1["unit"]), (&"0.0".into(), &"0.0".into(), &"1/iu2".into()));
    let every = of("camera.frames_every");
    assert_eq!((&every["value"], &every["neutral"]), (&"150".into(), &"1".into()), "the scenario sets it");
    assert_eq!(of("camera.drop_rate")["min"], 0.0);
    assert!(
        of("camera.drop_rate")["max"].is_number() && k1["description"].as_str().is_some_and(|d| d.len() > 20)
    );
    assert!(list.iter().all(|entry| entry["name"] != "plant.tau"), "a connection drives it");
    // Every parameter of the committed description is there, and nothing else of the plant but inputs that are free.
    let xml = concat!(env!("CARGO_MANIFEST_DIR"), "/../modelDescriptions/acrobot_plant.xml");
    let parameters =
        std::fs::read_to_string(xml).expect("committed").matches("causality=\"parameter\"").count();
    let listed =
        list.iter().filter(|entry| entry["name"].as_str().is_some_and(|name| name.starts_with("plant.")));
    assert_eq!(listed.count(), parameters + 2, "tau_1 and tau_2 are free");
}

#[test]
fn law_beginnings_choose() {
    let table = text(&["params", "visual-servo", "camera.k"]);
    let names: Vec<&str> = table.lines().skip(1).filter_map(|line| line.split_whitespace().next()).collect();
    assert_eq!(names, ["camera.k1", "camera.k2"], "{table}");
}

#[test]
fn law_shells_take_the_completions() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("acroscope.bash");
    std::fs::write(&path, text(&["completions", "bash"])).expect("writable");
    // bash reads it and completes "acroscope dia".
    let script = format!(
        "source {}; COMP_WORDS=(acroscope dia); COMP_CWORD=1; _acroscope acroscope dia acroscope; echo ${{COMPREPLY[@]}}",
        path.display()
    );
    let output = Command::new("bash").args(["-c", &script]).output().expect("there is a bash");
    assert_eq!(
        String::from_utf8_lossy(&output.stdout).trim(),
        "diagnose",
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    for shell in ["zsh", "fish", "elvish", "powershell"] {
        assert!(text(&["completions", shell]).contains("diagnose"), "{shell}");
    }
}

#[test]
fn every_command_has_a_manual_page() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("man");
    text(&["man", "--out", &out.to_string_lossy()]);
    for page in [
        "acroscope.1",
        "acroscope-run.1",
        "acroscope-diagnose.1",
        "acroscope-reproduce.1",
        "acroscope-params.1",
    ] {
        let text = std::fs::read_to_string(out.join(page)).unwrap_or_else(|why| panic!("{page}: {why}"));
        assert!(text.contains(".SH NAME") && text.contains(".SH SYNOPSIS"), "{page}");
    }
    let run = std::fs::read_to_string(out.join("acroscope-run.1")).expect("written");
    assert!(run.contains("acroscope run visual"), "with its examples");
}

#[test]
fn law_a_diagnosis_that_fails_leaves_no_folder() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::create_dir(folder.path().join("empty")).expect("writable");
    let output = Command::new(env!("CARGO_BIN_EXE_acroscope"))
        .args(["diagnose", "empty"])
        .current_dir(folder.path())
        .output()
        .expect("the program starts");
    assert_eq!(output.status.code(), Some(2));
    assert!(!folder.path().join("out").exists(), "an empty folder is left");
}

#[test]
fn law_help_tells_of_itself_and_of_all_that_is_taken() {
    assert_eq!(text(&["help", "--help"]), text(&["--help"]));
    assert_eq!(text(&["help", "sweep", "-h"]), text(&["help", "sweep"]));
    let sweep = text(&["sweep", "--help"]);
    assert!(sweep.contains("rms, peak or first_true") && !sweep.contains('\\'), "{sweep}");
    let diagnose = text(&["diagnose", "--help"]);
    assert!(diagnose.contains("format = 2 a log file for each run"), "{diagnose}");
}
