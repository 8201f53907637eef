//! Units in processes of their own: the same bits as in this one, and a clear end whatever they do.

use crate::common;

use crate::common::Units;
use orchestrator::{CsvRecorder, Error, Isolation, Kind, MemoryRecorder, Quiet, Scenario, Simulation, Value};
use std::time::Duration;

/// The units' processes are this program with only this test, which serves them and never returns.
#[test]
fn unit_host() {
    orchestrator::host_units(["--exact", "isolated::unit_host", "--nocapture", "--test-threads=1"]);
}

/// Three units at three rates with all types, a delay, a source and a last step that is shorter.
const SYSTEM: &str = r#"
    format = 1
    experiment = { stop = 0.55 }
    [[units]]
    name = "a"
    fmu = "stateful.fmu"
    interval = 0.001
    set = { k = 2.0, x0 = 0.25, s_in = "tex,t" }
    [[units]]
    name = "b"
    fmu = "feedthrough.fmu"
    interval = 0.005
    set = { mode = 1 }
    [[units]]
    name = "c"
    fmu = "stateful.fmu"
    interval = "1/30"
    [[connections]]
    from = "a.y1"
    to = "b.u1"
    [[connections]]
    from = "b.y1"
    to = "c.u1"
    [[connections]]
    from = "c.y1"
    to = "a.u2"
    delay = "1/60"
    [[connections]]
    from = "a.s_out"
    to = "b.s_in"
    [[connections]]
    from = "a.i_out"
    to = "c.i_in"
    [[connections]]
    from = "a.b_out"
    to = "b.b_in"
    [[sources]]
    to = "a.u1"
    kind = "smooth"
    points = [[0, 0], [0.5, 1]]
"#;

fn isolate(scenario: &mut Scenario, isolation: Isolation) {
    unit_host();
    scenario.units.iter_mut().for_each(|unit| unit.isolation = Some(isolation.clone()));
}

#[test]
fn every_algorithm_gives_the_same_bits_elsewhere() {
    let units = Units::new();
    for algorithm in common::every_rate() {
        let mut scenario = Scenario::parse(SYSTEM, "test.toml").expect("a scenario");
        scenario.algorithm.value = algorithm.into();
        let bytes = |scenario: &Scenario| {
            let mut simulation = Simulation::new(scenario, &units.unit_path()).expect("builds");
            let run = |simulation: &mut Simulation| {
                let mut csv = CsvRecorder::new(Vec::new());
                simulation.run(&mut csv, &mut Quiet).expect("runs");
                String::from_utf8(csv.into_inner()).expect("UTF-8")
            };
            let first = run(&mut simulation);
            assert!(run(&mut simulation) == first, "after a reset");
            first
        };
        let here = bytes(&scenario);
        isolate(&mut scenario, Isolation::default());
        assert!(bytes(&scenario) == here, "{algorithm}");
        assert!(here.lines().count() > 500);
    }
}

#[test]
fn every_status_says_the_same_elsewhere() {
    let units = Units::new();
    for fault in [1, 2, 3, 4, 5, 42, 7, 15, 16, 17, 19] {
        let text = format!(
            "{}[[connections]]\nfrom = \"a.y1\"\nto = \"c.u2\"\n",
            SYSTEM.replace("x0 = 0.25", &format!("fault = {fault}, fault_time = 0.25"))
        );
        let mut scenario = Scenario::parse(&text, "test.toml").expect("a scenario");
        let told = |scenario: &Scenario| {
            let mut simulation = Simulation::new(scenario, &units.unit_path()).expect("builds");
            let mut results = MemoryRecorder::new();
            let ended = simulation.run(&mut results, &mut Quiet).map_err(|error| error.to_string());
            (ended, simulation.notices(), results.times().len())
        };
        let here = told(&scenario);
        isolate(&mut scenario, Isolation::default());
        assert_eq!(told(&scenario), here, "fault {fault}");
    }
}

#[test]
fn every_warning_of_one_exchange_counts_elsewhere() {
    let units = Units::new();
    let set = "((Unit *)c)->FIELD[refs[i]] = values[i];";
    let warns = common::library_with(&[(set, &format!("{set} return 1;"))]);
    units.pack("stateful.fmu", &common::description(common::STATEFUL), &warns);
    let text = SYSTEM.replace("x0 = 0.25", "fault = 1, fault_time = 0.25");
    let mut scenario = Scenario::parse(&text, "test.toml").expect("a scenario");
    let told = |scenario: &Scenario| {
        let mut simulation = Simulation::new(scenario, &units.unit_path()).expect("builds");
        simulation.run(&mut MemoryRecorder::new(), &mut Quiet).expect("runs");
        simulation.notices()
    };
    let here = told(&scenario);
    // The setting of a real in each of 550 steps, and the steps from 0.25 s on.
    assert!(here.iter().any(|notice| notice.starts_with("unit a answered ")), "{here:#?}");
    isolate(&mut scenario, Isolation::default());
    assert_eq!(told(&scenario), here);
}

#[test]
fn every_refused_value_of_one_exchange_is_named_elsewhere() {
    let set = "((Unit *)c)->FIELD[refs[i]] = values[i];";
    // An error, and a value that is discarded, which no smaller step would help.
    for status in [3, 2] {
        let units = Units::new();
        let refuses = format!("{{ if (((Unit *)c)->x > 0.3) return {status}; {set} }}");
        let refuses = common::library_with(&[(set, &refuses)]);
        units.pack("stateful.fmu", &common::description(common::STATEFUL), &refuses);
        let mut scenario = Scenario::parse(SYSTEM, "test.toml").expect("a scenario");
        let told = |scenario: &Scenario| {
            let mut simulation = Simulation::new(scenario, &units.unit_path()).expect("builds");
            let mut results = MemoryRecorder::new();
            let error = simulation.run(&mut results, &mut Quiet).expect_err("refused");
            (error.to_string(), results.times().len())
        };
        let here = told(&scenario);
        assert!(here.0.starts_with("unit a: fmi2SetReal of u1, u2 at t = "), "{}", here.0);
        isolate(&mut scenario, Isolation::default());
        assert_eq!(told(&scenario), here);
    }
}

#[test]
fn every_end_in_a_call_that_was_sent_along_has_its_name() {
    let set = "((Unit *)c)->FIELD[refs[i]] = values[i];";
    let get = "values[i] = ((Unit *)c)->FIELD[refs[i]];";
    for (line, function) in [(set, "fmi2SetReal"), (get, "fmi2GetReal")] {
        let units = Units::new();
        let ends =
            common::library_with(&[(line, &format!("{{ if (((Unit *)c)->x > 0.3) abort(); {line} }}"))]);
        units.pack("stateful.fmu", &common::description(common::STATEFUL), &ends);
        let mut scenario = Scenario::parse(SYSTEM, "test.toml").expect("a scenario");
        isolate(&mut scenario, Isolation::default());
        let mut simulation = Simulation::new(&scenario, &units.unit_path()).expect("builds");
        let error = simulation.run(&mut MemoryRecorder::new(), &mut Quiet).expect_err("ends");
        let text = error.to_string();
        let head = format!("unit a: in {function} at t = 0.");
        assert!(text.starts_with(&head) && text.contains("signal 6 (SIGABRT"), "{text}");
        let Error::Died { post_mortem, .. } = error else { panic!("{text}") };
        let last = post_mortem.calls.last().map(String::as_str).unwrap_or_default();
        assert!(last.starts_with(function), "{:?}", post_mortem.calls);
    }
}

/// A unit splits its process, and both come back from the call: one answers, the other goes.
#[cfg(target_os = "linux")]
#[test]
fn every_copy_of_a_process_goes() {
    unit_host();
    let line = "u->i[I_OUT] = u->i[I_IN] + 1;";
    let splits =
        format!("{line} static int copy; if (size > 0) u->i[I_OUT] = copy ? copy : (copy = fork());");
    let units = Units::new();
    let library = common::library_with(&[(line, &splits)]);
    let path = units.pack("splits.fmu", &common::description(common::STATEFUL), &library);
    let fmu = orchestrator::Fmu::open(path).expect("opens").isolated(Isolation::default());
    let mut instance = fmu.instantiate("a").expect("instantiates");
    instance.setup_experiment(0.0, None).expect("set up");
    instance.enter_initialization().expect("enters");
    instance.exit_initialization().expect("exits");
    assert_eq!(instance.do_step(0.0, 0.5, true), orchestrator::fmu::Status::Ok);
    let Ok(Value::Integer(copy)) = instance.get(Kind::Integer, 1) else { panic!("a number of a process") };
    assert_eq!(instance.do_step(0.5, 0.5, true), orchestrator::fmu::Status::Ok);
    drop(instance);
    let there = || std::path::Path::new(&format!("/proc/{copy}")).exists();
    // Both are processes of their own, and the system takes as long as it likes.
    let begun = std::time::Instant::now();
    while there() && begun.elapsed() < Duration::from_secs(20) {
        std::thread::sleep(Duration::from_millis(10));
    }
    assert!(copy > 0 && !there(), "{copy}");
}

#[test]
fn bad_input_too_little_memory_to_begin_is_told_at_once() {
    let units = Units::new();
    let mut scenario = Scenario::parse(SYSTEM, "test.toml").expect("a scenario");
    isolate(&mut scenario, Isolation { memory_limit: Some(1 << 20), ..Isolation::default() });
    let begun = std::time::Instant::now();
    let built = Simulation::new(&scenario, &units.unit_path()).map(|_| ());
    let ended = built.and_then(|()| {
        Simulation::new(&scenario, &units.unit_path())?
            .run(&mut MemoryRecorder::new(), &mut Quiet)
            .map(|_| ())
    });
    // Some systems do with so little; where it is not enough, the limit is what is told, and not the time.
    if let Err(error) = ended {
        let text = error.to_string();
        assert!(text.contains("memory") && !text.contains("step_limit"), "{text}");
    }
    assert!(begun.elapsed() < Duration::from_secs(20), "less than the limit of a step");
}

/// Values are sent along with a step's answer as they were asked for after the last one; whoever asks otherwise gets what he asks.
#[test]
fn every_order_of_questions_gets_its_answers() {
    unit_host();
    let units = Units::new();
    let fmu = orchestrator::Fmu::open(units.path().join("stateful.fmu")).expect("opens");
    let answers = |fmu: &orchestrator::Fmu| {
        let mut instance = fmu.instantiate("a").expect("instantiates");
        instance.set_real(&[0, 4], &[2.0, 3.0]).expect("u1 and k");
        instance.set_integer(&[0], &[40]).expect("i_in");
        instance.setup_experiment(0.0, None).expect("set up");
        instance.enter_initialization().expect("enters");
        let mut all =
            vec![instance.get(Kind::Real, 2).expect("y1"), instance.get(Kind::Integer, 1).expect("i_out")];
        instance.exit_initialization().expect("exits");
        let rounds: [&[(Kind, u32)]; 12] = [
            &[(Kind::Real, 2)],
            &[(Kind::Real, 2)],
            &[(Kind::Real, 3)],
            &[(Kind::Real, 3), (Kind::Integer, 1)],
            &[(Kind::Integer, 1), (Kind::Real, 3)],
            &[(Kind::Integer, 1), (Kind::Real, 1), (Kind::Real, 2)],
            &[(Kind::Real, 1), (Kind::Real, 2), (Kind::Real, 2)],
            &[],
            &[(Kind::Real, 1)],
            &[(Kind::Boolean, 1), (Kind::Real, 4), (Kind::Real, 2), (Kind::Real, 3)],
            &[(Kind::Real, 1), (Kind::Real, 4)],
            &[(Kind::Real, 1), (Kind::Real, 4), (Kind::Real, 2), (Kind::String, 1)],
        ];
        for (round, questions) in rounds.into_iter().enumerate() {
            let size = 0.125 * (1.0 + (round % 3) as f64);
            let status = instance.do_step(all.len() as f64, size, true);
            assert_eq!(status, orchestrator::fmu::Status::Ok);
            for (kind, reference) in questions {
                all.push(instance.get(*kind, *reference).expect("known"));
            }
            // A state is asked for, and what is set is there at once.
            if round % 4 == 3 {
                let state = instance.save_state().expect("saved");
                instance.set_real(&[1], &[round as f64]).expect("u2");
                all.push(instance.get(Kind::Real, 1).expect("u2"));
                all.push(instance.get(Kind::Real, 2).expect("y1"));
                instance.restore_state(&state).expect("restored");
                all.push(instance.get(Kind::Real, 1).expect("u2 of before"));
                instance.free_state(state).expect("freed");
            }
        }
        all
    };
    assert_eq!(answers(&fmu.isolated(Isolation::default())), answers(&fmu));
}

#[test]
fn law_a_unit_elsewhere_is_asked_for_errors_and_warnings_only() {
    unit_host();
    let tells = (
        "    (void)c; (void)on; (void)n; (void)names;\n",
        "    Unit *u = c;\n    u->callbacks->logger(u->callbacks->environment, \"u\", 1, \"events\", \"%d: %d %s\", on, (int)n, names[0]);\n",
    );
    let units = Units::new();
    let path =
        units.pack("tells.fmu", &common::description(common::STATEFUL), &common::library_with(&[tells]));
    let fmu = orchestrator::Fmu::open(path).expect("opens").isolated(Isolation::default());
    let log = fmu.instantiate("a").expect("instantiates").log();
    let log: Vec<String> = log.iter().map(ToString::to_string).collect();
    assert_eq!(log, ["[warning, events] 1: 1 logStatusError"]);
}

#[test]
fn every_end_of_a_process_is_told_and_the_rows_are_kept() {
    let units = Units::new();
    let short = Isolation { step_limit: Duration::from_millis(500), ..Isolation::default() };
    // Long enough to fill the memory on any machine.
    let small = Isolation { step_limit: Duration::from_secs(60), memory_limit: Some(256 << 20), host: None };
    for (fault, expected) in [
        (9, "its process ended by exit with status 0"),
        (10, "its process was ended by signal 11 (SIGSEGV, a segmentation fault)"),
        (11, "its process was ended by signal 6 (SIGABRT, it gave up)"),
        (12, "its process ended by exit with status 0"),
        (13, "its process was ended by signal 15 (SIGTERM)"),
        (14, "its process was ended, since it did not come back within 0.5 s (step_limit)"),
        (20, "perhaps for want of memory: it may have 256 MiB (memory_limit)"),
        (21, "its process was ended by signal"),
    ] {
        let text = SYSTEM.replace("x0 = 0.25", &format!("fault = {fault}, fault_time = 0.25"));
        let mut scenario = Scenario::parse(&text, "test.toml").expect("a scenario");
        isolate(&mut scenario, if fault == 20 { small.clone() } else { short.clone() });
        let mut simulation = Simulation::new(&scenario, &units.unit_path()).expect("builds");
        for _ in 0..2 {
            // The second time in a fresh process.
            let mut results = MemoryRecorder::new();
            let error = simulation.run(&mut results, &mut Quiet).expect_err("ends");
            assert!(!error.is_input());
            let text = error.to_string();
            let head = "unit a: in fmi2DoStep at t = 0.249 s its process ";
            assert!(text.starts_with(head) && text.contains(expected), "fault {fault}: {text}");
            let Error::Died { post_mortem, .. } = error else { panic!("{text}") };
            let orchestrator::PostMortem { inputs, calls, .. } = *post_mortem;
            assert_eq!(calls.last().map(String::as_str), Some("fmi2DoStep from 0.249 s by 0.001 s"));
            assert!(inputs.iter().any(|input| input.starts_with("u1 = 0.")), "{inputs:?}");
            let names: Vec<&str> = inputs.iter().filter_map(|input| input.split(' ').next()).collect();
            assert_eq!(names, ["u1", "u2"]);
            assert_eq!(results.times().last(), Some(&0.249));
            assert_eq!(calls.len(), 12, "{calls:?}");
            assert!(
                text.contains("\n  last inputs: u1 = 0.") && text.contains("\n  last calls: fmi2"),
                "{text}"
            );
        }
    }
}

#[test]
fn law_states_go_to_another_process_and_back() {
    unit_host();
    let units = Units::new();
    let fmu = orchestrator::Fmu::open(units.path().join("stateful.fmu")).expect("opens");
    let start = |fmu: &orchestrator::Fmu, name: &str| {
        let mut instance = fmu.instantiate(name).expect("instantiates");
        instance.set_real(&[0], &[3.0]).expect("an input");
        instance.setup_experiment(0.0, None).expect("set up");
        instance.enter_initialization().expect("enters");
        instance.exit_initialization().expect("exits");
        instance
    };
    let step = |instance: &mut orchestrator::fmu::Instance| {
        assert_eq!(instance.do_step(0.0, 0.5, false), orchestrator::fmu::Status::Ok);
        instance.get(Kind::Real, 2).expect("y1")
    };
    let (mut here, mut there) = (start(&fmu, "here"), start(&fmu.isolated(Isolation::default()), "there"));
    assert_eq!(step(&mut there), Value::Real(1.5));
    let saved = there.save_state().expect("saved");
    let bytes = there.serialize_state(&saved).expect("bytes");
    assert_eq!((step(&mut there), step(&mut there)), (Value::Real(3.0), Value::Real(4.5)));
    there.restore_state(&saved).expect("restored");
    assert_eq!(step(&mut there), Value::Real(3.0), "again from 1.5");
    there.free_state(saved).expect("freed");
    let moved = here.deserialize_state(&bytes).expect("a state");
    here.restore_state(&moved).expect("restored");
    assert_eq!(step(&mut here), Value::Real(3.0), "from the other's 1.5");
    here.free_state(moved).expect("freed");
    assert_eq!(there.last_successful_time(), Some(0.5));
    // What is set between a step and a read is seen by the read, and a failed call has its own name.
    there.set_integer(&[3], &[1]).expect("mode");
    assert!(matches!(
        there.directional_derivative(&[2], &[0], &[1.0], &mut [0.0]),
        Err(Error::Missing { .. })
    ));
    let error = there.get_real(&[2, 3], &mut [0.0]).expect_err("too short").to_string();
    assert_eq!(error, "unit there: fmi2GetReal called with 2 references and 1 values");
}

#[test]
fn law_scenarios_say_what_is_isolated() {
    let keys = "isolate = true\n    step_limit = 2.5\n    memory_limit = 512\n    set = { k";
    let scenario = Scenario::parse(&SYSTEM.replace("set = { k", keys), "test.toml").expect("a scenario");
    let isolation =
        Isolation { step_limit: Duration::from_millis(2500), memory_limit: Some(512 << 20), host: None };
    let found: Vec<Option<Isolation>> = scenario.units.iter().map(|unit| unit.isolation.clone()).collect();
    assert_eq!(found, [Some(isolation.clone()), None, None]);
    unit_host();
    let resolved = Simulation::new(&scenario, &Units::new().unit_path()).expect("builds").resolved();
    let again = Scenario::parse(&resolved, "resolved.toml").expect("loads");
    assert_eq!(again.units[0].isolation, Some(isolation));
    for (key, expected) in [
        ("step_limit = 1", "test.toml:8: step_limit: it goes with isolate = true"),
        (
            "isolate = true\n    step_limit = 0",
            "test.toml:9: step_limit = 0: seconds, above zero and below 1e9",
        ),
        ("isolate = true\n    memory_limit = 0", "test.toml:9: memory_limit = 0: MiB, above zero"),
    ] {
        let text = SYSTEM.replacen("set = { k", &format!("{key}\n    set = {{ k"), 1);
        let error = Scenario::parse(&text, "test.toml").expect_err("wrong").to_string();
        assert_eq!(error, expected);
    }
}
