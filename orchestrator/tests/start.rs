//! The start: values along dependencies, and where a run begins and ends.

use crate::common::{Units, build, connection, unit};
use orchestrator::{Comparison, Ended, MemoryRecorder, Quiet, Scenario, Simulation};

#[test]
fn law_start_values_go_along_the_dependencies() {
    // A chain of gains in the wrong order: c needs b, b needs a.
    let parts = [
        unit("c", "feedthrough.fmu", "mode = 1, k = 5"),
        unit("b", "feedthrough.fmu", "mode = 1, k = 3, u1 = 9"),
        unit("a", "stateful.fmu", "x0 = 2"),
        connection("b.y1", "c.u1"),
        connection("a.y1", "b.u1"),
    ];
    let mut simulation = build(&Units::new(), &parts).expect("builds");
    assert_eq!(simulation.value("c.y1").expect("known"), 30.0);
    assert_eq!(simulation.replaced_starts(), ["b.u1 = 9.0 (now 2.0)", "c.u1 = 0.0 (now 6.0)"]);
    assert!(simulation.notices().is_empty());
}

#[test]
fn value_sources_hold_at_the_start_where_they_lead() {
    let source = |to: &str, value: &str| {
        format!("[[sources]]\nto = \"{to}\"\nkind = \"hold\"\npoints = [[0, {value}], [9, 0]]\n")
    };
    let parts = [
        unit("a", "feedthrough.fmu", "mode = 1"),
        source("a.u2", "5"),
        source("a.i_in", "7"),
        source("a.b_in", "1"),
    ];
    let mut simulation = build(&Units::new(), &parts).expect("builds");
    let found = ["a.y1", "a.y2", "a.i_out", "a.b_out"].map(|name| simulation.value(name).expect("known"));
    assert_eq!(found, [0.0, 5.0, 8.0, 0.0]);
}

#[test]
fn value_a_last_step_is_told_in_seconds() {
    // The tick is 2 s: 4 s and then one of them.
    let text = "format = 1\nexperiment = { stop = 6 }\n[[units]]\nname = \"a\"\nfmu = \"stateful.fmu\"\ninterval = 4\nset = { mode = 2 }\n";
    let units = Units::new();
    let mut simulation =
        Simulation::new(&Scenario::parse(text, "test.toml").expect("a scenario"), &units.unit_path())
            .expect("builds");
    assert!(simulation.notices()[0].ends_with("its last step has 2 s"), "{:?}", simulation.notices());
    // One that ends with its first point makes no other one.
    let only = text.replace("stop = 6", "stop = 2").replace("interval = 4", "interval = 4\noffset = 2");
    let only = Simulation::new(&Scenario::parse(&only, "test.toml").expect("a scenario"), &units.unit_path());
    assert_eq!(only.expect("builds").notices(), Vec::<String>::new());
    // It is counted from the start.
    let later = text.replace("stop = 6", "start = 1, stop = 6");
    let later =
        Simulation::new(&Scenario::parse(&later, "test.toml").expect("a scenario"), &units.unit_path());
    let told = later.expect("builds").notices();
    assert!(told[0].ends_with("its last step has 1 s"), "{told:?}");
    for stop in [6.0, 10.0] {
        assert!(simulation.end_at(stop));
        simulation.run(&mut MemoryRecorder::new(), &mut Quiet).expect("runs");
        let found = ["a.y1", "a.y2"].map(|name| simulation.value(name).expect("known"));
        assert_eq!(found, [stop, 2.0]);
    }
}

#[test]
fn law_a_limit_is_passed_and_not_reached() {
    let parts = [unit("a", "stateful.fmu", "u1 = -1"), "[record]\nvariables = [\"a.y1\"]\n".into()];
    let units = Units::new();
    let ended = |comparison: Comparison, limit: f64| {
        let mut simulation = build(&units, &parts).expect("builds");
        simulation.stop_when("a.y1", comparison, limit).expect("recorded");
        match simulation.run(&mut MemoryRecorder::new(), &mut Quiet).expect("runs") {
            Ended::When { time, .. } => Some(time),
            _ => None,
        }
    };
    // y = -t, in eighths: exact.
    assert_eq!(ended(Comparison::AbsoluteAbove, 0.5), Some(0.625));
    assert_eq!(ended(Comparison::AbsoluteAbove, 1.0), None);
    assert_eq!(ended(Comparison::Below, -0.5), Some(0.625));
    assert_eq!(ended(Comparison::Above, -0.5), Some(0.0));
    assert_eq!(ended(Comparison::Above, 0.0), None);
}

#[test]
fn law_what_is_to_be_known_of_a_scenario_is_among_the_notices() {
    let text = "format = 1\nexperiment = { start = 1, stop = 1 }\n[[units]]\nname = \"a\"\nfmu = \"stateful.fmu\"\ninterval = 1\n";
    let mut scenario = Scenario::parse(text, "test.toml").expect("a run may end where it begins");
    scenario.note("read from elsewhere".into());
    let mut simulation = Simulation::new(&scenario, &Units::new().unit_path()).expect("builds");
    assert_eq!(simulation.notices(), ["read from elsewhere"]);
    let mut results = MemoryRecorder::new();
    simulation.run(&mut results, &mut Quiet).expect("runs");
    assert_eq!(results.times(), [1.0]);
    // What is wrong at the end of a line is told with that line.
    let error =
        Scenario::parse("format = 1\nunits =\n\nx = 1\n", "test.toml").expect_err("no value").to_string();
    assert!(error.starts_with("test.toml:2: not a scenario: "), "{error}");
}

#[test]
fn every_stop_is_at_the_start_or_after_it() {
    let text = "format = 1\nexperiment = { start = 0.5, stop = 1 }\n[[units]]\nname = \"a\"\nfmu = \"stateful.fmu\"\ninterval = 0.25\n";
    let units = Units::new();
    for (stop, steps) in [("0.5", 0), ("1/2", 0), ("0.75", 1), ("2", 6)] {
        let mut scenario = Scenario::parse(text, "test.toml").expect("a scenario");
        scenario.set_stop(stop).expect("not before the start");
        let mut simulation = Simulation::new(&scenario, &units.unit_path()).expect("builds");
        let mut results = MemoryRecorder::new();
        simulation.run(&mut results, &mut Quiet).expect("runs");
        assert_eq!(results.times().len(), steps + 1, "{stop}");
    }
    let mut scenario = Scenario::parse(text, "test.toml").expect("a scenario");
    let told = scenario.set_stop("0.4999").expect_err("before the start").to_string();
    assert!(told.contains("not before the start, 1/2 s"), "{told}");
}

#[test]
fn bad_input_a_start_value_that_a_signal_overwrites_is_refused_beside_the_file() {
    let units = Units::new();
    let chain = [
        unit("a", "stateful.fmu", "x0 = 2"),
        unit("b", "feedthrough.fmu", "mode = 1"),
        connection("a.y1", "b.u1"),
        "[[sources]]\nto = \"b.u2\"\nkind = \"constant\"\nvalue = 5\n".to_owned(),
    ];
    let text = |parts: &[String]| format!("format = 1\nexperiment = {{ stop = 1 }}\n{}", parts.concat());
    let set = |text: &str, name: &str| {
        let mut scenario = Scenario::parse(text, "test.toml").expect("a scenario");
        scenario.set(name, "9").expect("there is such a unit");
        Simulation::new(&scenario, &units.unit_path()).map(|mut built| built.value(name).expect("known"))
    };
    for (name, line) in [("b.u1", 13), ("b.u2", 16)] {
        let told = set(&text(&chain), name).expect_err("driven").to_string();
        let why = format!("its signal at test.toml:{line} would overwrite it");
        assert_eq!(told, format!("--set {name}=9: {name} is driven: {why}"));
        let told = build(&units, &chain).expect("builds").set(name, 9.0).expect_err("driven").to_string();
        assert_eq!(told, format!("{name} = 9.0: {why}"));
    }
    // A latency leaves the start value until the first value arrives, and a loop is solved from it.
    let late = text(&chain).replace("to = \"b.u1\"\n", "to = \"b.u1\"\nlatency = 1\n");
    assert_eq!(set(&late, "b.u1").expect("it counts"), 9.0);
    let alone = [unit("a", "feedthrough.fmu", "mode = 1, k = 0.5"), connection("a.y1", "a.u1")];
    assert!(set(&text(&alone), "a.u1").expect("it is begun with").abs() < 1e-9);
    // In the file itself it is no mistake; beside a source it is told.
    let written = [unit("b", "feedthrough.fmu", "mode = 1, u2 = 9"), chain[3].clone()];
    let mut built = build(&units, &written).expect("builds");
    assert_eq!(built.value("b.u2").expect("known"), 5.0);
    assert_eq!(built.notices(), ["b.u2 = 9.0 gives way to its signal at test.toml:8"]);
    // What a run wrote down says nothing new.
    let again = Scenario::parse(&built.resolved(), "again.toml").expect("as it was written");
    let again = Simulation::new(&again, &units.unit_path()).expect("builds");
    assert_eq!(again.notices(), Vec::<String>::new());
}
