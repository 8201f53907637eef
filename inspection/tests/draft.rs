//! Drafted scenarios run, and say what they guessed.

mod common;

use common::{DESCRIPTION, OURS, Units};
use inspection::draft::draft;
use orchestrator::{MemoryRecorder, Quiet, Scenario, Simulation, UnitPath};
use std::path::{Path, PathBuf};

fn ours(names: &[&str]) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/fmus");
    names.iter().map(|name| folder.join(format!("{name}.fmu"))).collect()
}

/// Runs a drafted scenario from its file to a stop time.
fn run(path: &Path, text: &str, stop: &str) -> MemoryRecorder {
    std::fs::write(path, text).expect("writable");
    let mut scenario = Scenario::load(path).expect("loads");
    scenario.set_stop(stop).expect("a time");
    let mut simulation = Simulation::new(&scenario, &UnitPath::new()).expect("builds");
    let mut results = MemoryRecorder::new();
    simulation.run(&mut results, &mut Quiet).expect("runs");
    results
}

#[test]
fn law_our_own_loop_is_found_and_runs() {
    let units = Units::new();
    std::fs::create_dir(units.path().join("deep")).expect("writable");
    let path = units.path().join("deep/loop.toml");
    let text =
        draft(&ours(&["acrobot_plant", "acrobot_camera", "acrobot_controller"]), &path).expect("drafts");
    for line in [
        "interval = \"1/600\" # s, from its DefaultExperiment",
        "[[connections]] # guess: same name, both in rad; these fit, too: acrobot_camera.q1_est\nfrom = \"acrobot_plant.q1\"\nto = \"acrobot_controller.q1\"",
        "from = \"acrobot_controller.tau\"\nto = \"acrobot_plant.tau\"",
        "to = \"acrobot_plant.tau_1\"\nkind = \"constant\"\nvalue = 0.0 # N.m, its start value",
    ] {
        assert!(text.contains(line), "{line} in {text}");
    }
    let results = run(&path, &text, "0.1");
    assert_eq!(results.times().len(), 61);
    assert!(results.series("acrobot_controller.tau").expect("recorded").iter().any(|tau| *tau != 0.0));
}

#[test]
fn law_each_of_our_units_runs_alone() {
    let units = Units::new();
    let path = units.path().join("alone.toml");
    for name in OURS {
        let text = draft(&ours(&[name]), &path).expect("drafts");
        assert!(!run(&path, &text, "0.05").times().is_empty(), "{name}");
    }
}

/// The fixture with other names and units.
fn other(units: &Units, name: &str, changes: &[(&str, &str)]) -> PathBuf {
    let text = changes.iter().fold(DESCRIPTION.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    });
    units.pack(name, &text, &common::library())
}

#[test]
fn law_what_fits_twice_or_not_in_its_unit_is_left_to_the_reader() {
    let units = Units::new();
    let sink = other(&units, "sink.fmu", &[("name=\"u\"", "name=\"v\""), ("name=\"y\"", "name=\"place\"")]);
    let speed = ("<Real declaredType=\"Place\"/>", "<Real unit=\"m/s\"/>");
    let renamed = ("name=\"y\"", "name=\"v\"");
    let one = other(&units, "one.fmu", &[renamed, speed]);
    let two = other(&units, "two.fmu", &[renamed, speed]);
    let metres = other(&units, "metres.fmu", &[renamed]);
    let path = units.path().join("s.toml");
    let text = draft(&[sink.clone(), one.clone(), two], &path).expect("drafts");
    assert!(
        text.contains(
            "[[sources]] # guess: a constant; several outputs fit, choose one: one.v, two.v\nto = \"sink.v\""
        ),
        "{text}"
    );
    let text = draft(&[sink.clone(), metres], &path).expect("drafts");
    assert!(
        text.contains("# no output fits; metres.v has its name, but is in m, not in m/s\nto = \"sink.v\""),
        "{text}"
    );
    let text = draft(&[one.clone(), sink], &path).expect("drafts");
    assert!(
        text.contains("[[connections]] # same name, both in m/s\nfrom = \"one.v\"\nto = \"sink.v\""),
        "{text}"
    );
    // The same file twice has two names.
    let text = draft(&[one.clone(), one], &path).expect("drafts");
    assert!(text.contains("name = \"one\"") && text.contains("name = \"one_2\""), "{text}");
    run(&path, &text, "0.1");
}

#[test]
fn law_what_nobody_proposes_is_a_guess_that_says_so() {
    let units = Units::new();
    let experiment = "<DefaultExperiment startTime=\"0\" stopTime=\"2\" stepSize=\"0.01\"/>";
    let silent = other(
        &units,
        "silent.fmu",
        &[(experiment, ""), ("<Real start=\"1\" unit=\"m/s\"/>", "<Real unit=\"m/s\"/>")],
    );
    let path = units.path().join("silent.toml");
    let text = draft(&[silent], &path).expect("drafts");
    for line in [
        "start = 0.0 # guess: no unit proposes one",
        "stop = 10.0 # guess: no unit proposes one after the start",
        "interval = 0.01 # s, guess: its description proposes none",
        "value = 0.0 # m/s, guess: it has no start value",
    ] {
        assert!(text.contains(line), "{line} in {text}");
    }
    assert_eq!(run(&path, &text, "1").times().len(), 101);
    // What lay in memory when the description was written is no time.
    let odd = "<DefaultExperiment startTime=\"6.36599e-314\" stepSize=\"1e-310\"/>";
    let odd = draft(&[other(&units, "odd.fmu", &[(experiment, odd)])], &path).expect("drafts");
    for line in ["start = 0.0 # guess", "interval = 0.01 # s, guess: its description proposes none"] {
        assert!(odd.contains(line), "{line} in {odd}");
    }
    let endless = ("<Real start=\"1\" unit=\"m/s\"/>", "<Real start=\"INF\" unit=\"m/s\"/>");
    let endless = draft(&[other(&units, "endless.fmu", &[endless])], &path).expect("drafts");
    let line = "value = 0.0 # m/s, guess: its start value is inf, with which nothing can be run";
    assert!(endless.contains(line), "{line} in {endless}");
    let long = other(&units, "long.fmu", &[("stopTime=\"2\"", "stopTime=\"7\"")]);
    let short = other(&units, "short.fmu", &[]);
    let text = draft(&[long, short], &path).expect("drafts");
    assert!(
        text.contains("stop = 2.0 # guess: the shortest of what the units propose (long 7 s, short 2 s)"),
        "{text}"
    );
}
