//! What a simulation can do besides running once: other values, other threads, its scenario and its state written down.

use crate::common;

use crate::common::{Units, build, connection, unit};
use orchestrator::{Comparison, CsvRecorder, Ended, MemoryRecorder, Quiet, Scenario, Simulation, Value};

#[test]
fn law_simulations_go_to_other_threads() {
    fn sends<T: Send>() {}
    fn shares<T: Send + Sync>() {}
    sends::<Simulation>();
    shares::<orchestrator::UnitPath>();
    shares::<Scenario>();
    let units = Units::new();
    let path = units.unit_path();
    let text = format!("format = 1\nexperiment = {{ stop = 1 }}\n{}", unit("a", "stateful.fmu", "u1 = 1"));
    let scenario = Scenario::parse(&text, "test.toml").expect("a scenario");
    let last = |k: f64| {
        let mut simulation = Simulation::new(&scenario, &path).expect("builds");
        simulation.set("a.k", k).expect("before a run");
        simulation.run(&mut orchestrator::NoRecorder, &mut Quiet).expect("runs");
        simulation.value("a.y1").expect("known")
    };
    std::thread::scope(|scope| {
        let runs = [1.0, 2.0, 3.0].map(|k| scope.spawn(move || last(k)));
        assert_eq!(runs.map(|run| run.join().expect("no panic")), [1.0, 2.0, 3.0]);
    });
}

#[test]
fn law_runs_are_repeated_with_other_values() {
    let units = Units::new();
    let parts = [unit("a", "stateful.fmu", "u1 = 1")];
    let mut simulation = build(&units, &parts).expect("builds");
    let mut results = MemoryRecorder::new();
    for k in [1.0, -2.0, 1.0] {
        simulation.set("a.k", k).expect("before a run");
        assert_eq!(simulation.run(&mut results, &mut Quiet).expect("runs"), Ended::AtStop);
        assert_eq!(results.times().len(), 9);
        assert_eq!(results.series("a.y1").expect("recorded").last(), Some(&k), "u1 = 1 over 1 s");
    }
    // Step by step, with an input and a tunable parameter changed on the way.
    simulation.reset();
    simulation.advance_to(0.5).expect("steps");
    assert_eq!((simulation.time(), simulation.value("a.y1").expect("known")), (0.5, 0.5));
    simulation.set("a.u1", 4).expect("an Integer is a Real too");
    simulation.set("a.k", 2.0).expect("tunable");
    let fixed = simulation.set("a.x0", 1.0).expect_err("fixed").to_string();
    assert!(fixed.contains("only inputs and tunable parameters change while stepping"), "{fixed}");
    simulation.advance_to(0.74).expect("steps");
    assert_eq!((simulation.time(), simulation.value("a.y1").expect("known")), (0.625, 1.5));
    simulation.advance_to(9.0).expect("steps to the end");
    assert_eq!(simulation.time(), 1.0);
    assert_eq!(simulation.advance().expect("nothing left"), None);
    // What was set on the way does not outlive the reset.
    simulation.run(&mut results, &mut Quiet).expect("runs");
    assert_eq!(results.series("a.y1").expect("recorded").last(), Some(&1.0));
    simulation.stop_when("a.y1", Comparison::AbsoluteAbove, 0.3).expect("recorded");
    let ended = simulation.run(&mut results, &mut Quiet).expect("runs");
    assert_eq!(ended, Ended::When { condition: "|a.y1| > 0.3".into(), time: 0.375 });
    // Each comparison on the negative side: u1 = 1, k = -1.
    for (comparison, limit, condition) in [
        (Comparison::AbsoluteAbove, 0.3, "|a.y1| > 0.3"),
        (Comparison::Below, -0.3, "a.y1 < -0.3"),
        (Comparison::Above, -2.0, "a.y1 > -2"),
    ] {
        let mut simulation = build(&units, &parts).expect("builds");
        simulation.set("a.k", -1.0).expect("before a run");
        simulation.stop_when("a.y1", comparison, limit).expect("recorded");
        let ended = simulation.run(&mut results, &mut Quiet).expect("runs");
        let time = if comparison == Comparison::Above { 0.0 } else { 0.375 };
        assert_eq!(ended, Ended::When { condition: condition.into(), time });
    }
    let error = simulation.value("a.y11").expect_err("unknown").to_string();
    assert_eq!(error, "variable \"a.y11\" does not exist: did you mean y1 (or y2, u1)?");
}

#[test]
fn law_the_resolved_scenario_names_every_value_and_gives_the_same_run() {
    let units = Units::new();
    let folder = tempfile::TempDir::new().expect("a temporary folder");
    std::fs::write(folder.path().join("z.csv"), "time,z\n0,0\n0.3,1\n\n1,\n1,-1\n").expect("writable");
    let text = [
        "format = 1\ndescription = \"a \\\"test\\\"\"\nexperiment = { start = 0.5, stop = \"3/2\", algorithm = \"jacobi\" }\n".into(),
        unit("a", "stateful.fmu", "s_in = \"x\""),
        unit("b", "feedthrough.fmu", "mode = 1"),
        connection("a.y1", "b.u1"),
        "delay = \"1/3\"\n".into(),
        "[[sources]]\nto = \"a.u1\"\nkind = \"csv\"\nfile = \"z.csv\"\ncolumn = \"z\"\n".into(),
        "[[sources]]\nto = \"b.u2\"\nkind = \"smooth\"\npoints = [[0, 0], [1.0, 0.1]]\n".into(),
        "[[sources]]\nto = \"b.i_in\"\nkind = \"hold\"\npoints = [[0, 1], [1.0, 2]]\n".into(),
        "[record]\nvariables = [\"*\"]\n[report]\ntitle = \"t\"\nnested = { a = [1, 2] }\n".into(),
    ]
    .concat();
    let mut scenario = Scenario::parse(&text, folder.path().join("test.toml")).expect("a scenario");
    scenario.set("a.k", "0.1").expect("a unit");
    let bytes = |scenario: &Scenario| {
        let mut simulation = Simulation::new(scenario, &units.unit_path()).expect("builds");
        let mut csv = CsvRecorder::new(Vec::new());
        simulation.run(&mut csv, &mut Quiet).expect("runs");
        (String::from_utf8(csv.into_inner()).expect("UTF-8"), simulation.resolved())
    };
    // A unit beside the scenario is not found by its name elsewhere.
    let beside = folder.path().join("beside.fmu");
    std::fs::copy(units.path().join("stateful.fmu"), &beside).expect("copied");
    let mut other = scenario.clone();
    other.units[0].fmu.value = "beside.fmu".into();
    let full = format!("fmu = \"{}\"", beside.canonicalize().expect("there").display());
    assert!(bytes(&other).1.lines().any(|line| line == full), "{full}");
    let (first, resolved) = bytes(&scenario);
    let again = Scenario::parse(&resolved, "elsewhere/resolved.toml").expect("loads");
    assert_eq!(again.report, scenario.report);
    assert_eq!(again.description, "a \"test\"");
    assert_eq!(bytes(&again), (first, resolved.clone()));
    for line in [
        "fmu = \"stateful.fmu\"",
        "fmu = \"feedthrough.fmu\"",
        "start = \"1/2\"",
        "interval = \"1/8\"",
        "latency = \"1/3\"",
        "k = 0.1",
        "fault_time = 1e+300",
        "mode = 1",
        "s_in = \"x\"",
    ] {
        assert!(resolved.lines().any(|l| l == line), "{line} in\n{resolved}");
    }
}

#[test]
fn law_what_follows_from_a_tunable_parameter_follows_it_while_stepping() {
    let units = Units::new();
    let follows = (
        "causality=\"parameter\" variability=\"fixed\"><Real start=\"0\"/>",
        "causality=\"calculatedParameter\" variability=\"tunable\"><Real/>",
    );
    let text = common::description(common::STATEFUL);
    assert!(text.contains(follows.0), "x0");
    let set = "((Unit *)c)->FIELD[refs[i]] = values[i];";
    let doubles =
        common::library_with(&[(set, &format!("{{ {set} ((Unit *)c)->r[X0] = 2 * ((Unit *)c)->r[K]; }}"))]);
    units.pack("stateful.fmu", &text.replace(follows.0, follows.1), &doubles);
    let parts = [unit("a", "stateful.fmu", "k = 3"), "[record]\nvariables = [\"a.x0\"]\n".into()];
    let mut simulation = build(&units, &parts).expect("builds");
    assert_eq!(simulation.value("a.x0").expect("recorded"), 6.0);
    simulation.advance().expect("steps");
    simulation.set("a.k", 5.0).expect("tunable");
    assert_eq!(simulation.value("a.x0").expect("recorded"), 10.0);
    simulation.advance().expect("steps");
    assert_eq!(simulation.value("a.x0").expect("recorded"), 10.0);
}

#[test]
fn every_option_and_limit_comes_back_from_the_resolved_scenario() {
    let units = Units::new();
    let resolved = |experiment: &str| {
        let text =
            format!("format = 1\nexperiment = {{ stop = 1{experiment} }}\n{}", unit("a", "stateful.fmu", ""));
        let scenario = Scenario::parse(&text, "test.toml").expect("a scenario");
        Simulation::new(&scenario, &units.unit_path()).expect("builds").resolved()
    };
    let plain = resolved("");
    assert!(!plain.contains("options") && !plain.contains("seed"), "{plain}");
    let text =
        resolved(", seed = 5, algorithm = \"iterated\", options = { tolerance = 0.001, iterations = 7 }");
    let again = Scenario::parse(&text, "resolved.toml").expect("loads");
    let options: Vec<(&str, f64)> =
        again.options.iter().map(|(name, value)| (name.as_str(), value.value)).collect();
    assert_eq!((again.seed, options), (5, vec![("iterations", 7.0), ("tolerance", 0.001)]), "{text}");
}

#[test]
fn law_a_resolved_scenario_sets_what_the_unit_starts_with_by_itself_only_where_somebody_did() {
    let units = Units::new();
    let parameter = "name=\"k\" valueReference=\"4\" causality=\"parameter\" variability=\"tunable\"";
    for (variability, initial) in [("continuous", "exact"), ("continuous", "approx"), ("tunable", "exact")] {
        let local = format!(
            "name=\"k\" valueReference=\"4\" causality=\"local\" variability=\"{variability}\" initial=\"{initial}\""
        );
        let text = common::description(common::STATEFUL).replace(parameter, &local);
        units.pack("local.fmu", &text, &common::library());
        let resolved = |set: &str| build(&units, &[unit("a", "local.fmu", set)]).expect("builds").resolved();
        let (plain, set) = (resolved(""), resolved("k = 2.0"));
        assert!(plain.contains("\nx0 = 0.0\n") && !plain.contains("\nk = "), "{local}: {plain}");
        assert!(set.contains("\nk = 2.0\n"), "{local}: {set}");
    }
}

#[test]
fn law_a_bundle_has_each_file_once_and_by_a_name_of_its_own() {
    let (units, folder) = (Units::new(), tempfile::TempDir::new().expect("a temporary folder"));
    let other = folder.path().join("stateful.fmu");
    std::fs::copy(units.path().join("feedthrough.fmu"), &other).expect("copied");
    std::fs::create_dir(folder.path().join("more")).expect("a folder");
    let tables = ["z.csv", "more/z.csv"];
    for name in tables {
        std::fs::write(folder.path().join(name), "time,z\n0,0\n1,1\n").expect("writable");
    }
    let source = |to: &str, file: &str| {
        format!("[[sources]]\nto = \"{to}\"\nkind = \"csv\"\nfile = \"{file}\"\ncolumn = \"z\"\n")
    };
    let text = [
        "format = 1\nexperiment = { stop = 1 }\n".into(),
        unit("a", "stateful.fmu", "k = 3"),
        unit("b", &other.display().to_string(), "mode = 1"),
        unit("c", &units.path().join("stateful.fmu").display().to_string(), "x0 = 1"),
        source("a.u1", tables[0]),
        source("b.u1", tables[1]),
        source("c.u1", tables[0]),
    ]
    .concat();
    let scenario = Scenario::parse(&text, folder.path().join("test.toml")).expect("a scenario");
    let time = source("a.u1", tables[0]).replace("\"z\"\n", "\"time\"\n");
    let of_time = ["format = 1\nexperiment = { stop = 1 }\n", &unit("a", "stateful.fmu", ""), &time].concat();
    let of_time = Scenario::parse(&of_time, folder.path().join("test.toml")).expect("a scenario");
    let error = Simulation::new(&of_time, &units.unit_path())
        .err()
        .expect("the first column is the time")
        .to_string();
    assert!(error.contains("has no column \"time\" after the time"), "{error}");
    let mut simulation = Simulation::new(&scenario, &units.unit_path()).expect("builds");
    simulation.set("c.x0", 2.0).expect("before a run");
    let bundle = simulation.bundle();
    let named: Vec<&str> = bundle.scenario.units.iter().map(|unit| unit.fmu.value.as_str()).collect();
    let files: Vec<&str> = bundle.files.iter().map(|(name, _)| name.as_str()).collect();
    // What lies beside the scenario comes before what the unit path has.
    assert_eq!(named, ["stateful.fmu", "stateful.fmu", "stateful-2.fmu"]);
    assert_eq!(files, ["stateful.fmu", "stateful-2.fmu", "z.csv", "z-2.csv"]);
    // Unpacked side by side it is the same run.
    let unpacked = tempfile::TempDir::new().expect("a temporary folder");
    for (name, path) in &bundle.files {
        std::fs::copy(path, unpacked.path().join(name)).expect("copied");
    }
    let again =
        Scenario::parse(&simulation.bundled(&bundle), unpacked.path().join("test.toml")).expect("loads");
    let path = orchestrator::UnitPath::new().with(unpacked.path());
    let mut again = Simulation::new(&again, &path).expect("builds");
    let bytes = |simulation: &mut Simulation| {
        let mut csv = CsvRecorder::new(Vec::new());
        simulation.run(&mut csv, &mut Quiet).expect("runs");
        csv.into_inner()
    };
    assert_eq!(bytes(&mut again), bytes(&mut simulation));
    assert_eq!(simulation.given()[2], [("x0", &Value::Real(2.0))]);
    let used = simulation.used();
    assert!(!used[0].iter().any(|(name, _)| name == "u1" || name == "y1"), "driven or computed: {used:?}");
    for (name, value) in [("k", 3.0), ("x0", 0.0), ("u2", 0.0)] {
        assert!(used[0].contains(&(name.into(), Value::Real(value))), "{name}");
    }
}

#[test]
fn every_state_comes_back_in_its_own_and_in_another_instance() {
    let units = Units::new();
    let fmu = orchestrator::Fmu::open(units.path().join("stateful.fmu")).expect("opens");
    let start = |name: &str| {
        let mut instance = fmu.instantiate(name).expect("instantiates");
        instance.set_real(&[0], &[3.0]).expect("an input");
        instance.setup_experiment(0.0, None).expect("set up");
        instance.enter_initialization().expect("enters");
        instance.exit_initialization().expect("exits");
        instance
    };
    let step = |instance: &mut orchestrator::fmu::Instance| {
        assert_eq!(instance.do_step(0.0, 0.5, false), orchestrator::fmu::Status::Ok);
        instance.get(orchestrator::Kind::Real, 2).expect("y1")
    };
    let (mut first, mut second) = (start("first"), start("second"));
    assert_eq!(step(&mut first), Value::Real(1.5));
    let saved = first.save_state().expect("saved");
    let bytes = first.serialize_state(&saved).expect("bytes");
    assert_eq!(step(&mut first), Value::Real(3.0));
    first.restore_state(&saved).expect("restored");
    assert_eq!(step(&mut first), Value::Real(3.0), "again from 1.5");
    first.free_state(saved).expect("freed");
    let moved = second.deserialize_state(&bytes).expect("a state");
    second.restore_state(&moved).expect("restored");
    assert_eq!(step(&mut second), Value::Real(3.0), "from the other's 1.5");
    second.free_state(moved).expect("freed");
}
