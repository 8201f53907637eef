//! A scenario inside a container gives the bits that it gives outside, whatever steps the master makes. The units are the
//! packed ones.

use container::{Error, Instance, Mode, Stepped};
use orchestrator::fmu::Causality;
use orchestrator::{Cell, Column, Kind, Quiet, Recorder, Row, Scenario, Simulation, UnitPath, Value};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

fn units() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/fmus")
}

/// Three rates that are no multiples of each other, a delay, chance, a source, and a free input.
const SCENARIO: &str = r#"
format = 1
[experiment]
stop = 0.5
seed = 3
[[units]]
name = "a"
fmu = "signal_effects.fmu"
interval = "1/300"
[units.set]
lag = 0.02
[[units]]
name = "b"
fmu = "signal_effects.fmu"
interval = "1/70"
[[units]]
name = "c"
fmu = "signal_effects.fmu"
interval = "0.01"
[[connections]]
from = "a.y"
to = "b.u"
latency = "1/60"
drop = 0.2
[[connections]]
from = "b.y"
to = "c.u"
[[sources]]
to = "a.u"
kind = "smooth"
points = [[0.0, 0.0], [0.2, 0.7], [0.4, -0.2]]
[record]
variables = ["a.y", "b.u", "b.y", "c.y", "c.d", "b.u:age"]
"#;

struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let unit = units().join("signal_effects.fmu");
        std::fs::copy(unit, folder.path().join("signal_effects.fmu"))
            .expect("packed units: cargo xtask pack");
        std::fs::write(folder.path().join("scenario.toml"), SCENARIO).expect("writable");
        Self(folder)
    }

    fn instance(&self) -> Instance {
        Instance::new(self.0.path()).unwrap_or_else(|error| panic!("{error}"))
    }
}

/// The recorded numbers of each row.
#[derive(Default)]
struct Rows(Vec<(f64, Vec<u64>)>);

impl Recorder for Rows {
    fn begin(&mut self, _: &[Column]) -> Result<(), orchestrator::Error> {
        Ok(())
    }

    fn row(&mut self, time: f64, row: Row<'_>) -> Result<(), orchestrator::Error> {
        let bits = row.cells().map(|cell| match cell {
            Cell::Real(value) => value.to_bits(),
            _ => 0,
        });
        self.0.push((time, bits.collect()));
        Ok(())
    }
}

/// What a run outside records.
fn outside(scenario: &Scenario) -> Vec<(f64, Vec<u64>)> {
    let mut simulation = Simulation::new(scenario, &UnitPath::new()).expect("builds");
    let mut rows = Rows::default();
    simulation.run(&mut rows, &mut Quiet).expect("runs");
    rows.0
}

fn reference(instance: &Instance, name: &str) -> u32 {
    let place = instance.interface().variables.iter().position(|variable| variable.name == name);
    place.unwrap_or_else(|| panic!("{name}")) as u32
}

fn start(instance: &mut Instance) {
    instance.setup_experiment(0.0, Some(0.5)).expect("set up");
    instance.enter_initialization().expect("entered");
    instance.exit_initialization().expect("left");
}

/// All recorded values now.
fn values(instance: &mut Instance) -> Vec<u64> {
    let names = ["a.y", "b.u", "b.y", "c.y", "c.d", "b.u:age"];
    let bits = names.map(|name| {
        let reference = reference(instance, name);
        match instance.get(reference, Kind::Real) {
            Ok(Value::Real(value)) => value.to_bits(),
            other => panic!("{name}: {other:?}"),
        }
    });
    bits.to_vec()
}

/// The last row that is not later than a time, but for the age, which grows between the points of units, too.
fn at(rows: &[(f64, Vec<u64>)], time: f64) -> &[u64] {
    let row = rows.iter().rev().find(|(at, _)| *at <= time + 1e-12);
    &row.expect("there is a first row").1
}

#[test]
fn law_the_same_bits_inside_and_outside_for_every_step() {
    let folder = Folder::new();
    let rows = outside(&Scenario::load(folder.0.path().join("scenario.toml")).expect("a scenario"));
    // Multiples of a tick, of none, longer and shorter than all intervals, and each sum of steps with its rounding.
    for size in [1.0 / 300.0, 0.01, 1.0 / 30.0, 0.1, 0.001, 0.007] {
        let mut instance = folder.instance();
        start(&mut instance);
        let (mut time, mut steps) = (0.0, 0);
        while time + size <= 0.5 {
            assert_eq!(instance.do_step(time, size).expect("a step"), Stepped::Whole);
            time += size;
            steps += 1;
            assert_eq!(values(&mut instance), at(&rows, time), "after {steps} steps of {size} s");
        }
        assert!(steps > 3);
    }
}

#[test]
fn law_inputs_parameters_and_the_start_are_the_scenarios() {
    let folder = Folder::new();
    let mut scenario = Scenario::load(folder.0.path().join("scenario.toml")).expect("a scenario");
    scenario.set("c.d", "0.125").expect("free");
    scenario.set("b.gain", "-2").expect("a parameter");
    let rows = outside(&scenario);
    let mut instance = folder.instance();
    for (name, value) in [("c.d", 0.125), ("b.gain", -2.0)] {
        let reference = reference(&instance, name);
        instance.set(reference, Value::Real(value)).expect("set");
    }
    start(&mut instance);
    assert_eq!(values(&mut instance), at(&rows, 0.0));
    instance.do_step(0.0, 0.5).expect("a step");
    assert_eq!(values(&mut instance), at(&rows, 0.5));
    // Set in initialisation mode, after outputs were read there, it counts as well.
    instance.reset().expect("reset");
    instance.setup_experiment(0.0, None).expect("set up");
    instance.enter_initialization().expect("entered");
    let before = values(&mut instance);
    for (name, value) in [("c.d", 0.125), ("b.gain", -2.0)] {
        let reference = reference(&instance, name);
        instance.set(reference, Value::Real(value)).expect("set");
    }
    assert_ne!(values(&mut instance), before);
    instance.exit_initialization().expect("left");
    instance.do_step(0.0, 0.5).expect("a step");
    assert_eq!(values(&mut instance), at(&rows, 0.5));
    // Without a stop time it goes on past the scenario's own.
    instance.do_step(0.5, 10.0).expect("a step");
    assert_eq!(instance.time(), 10.5);
}

#[test]
fn law_a_state_leads_back_to_the_same_bits_in_another_instance_too() {
    let folder = Folder::new();
    let mut instance = folder.instance();
    let d = reference(&instance, "c.d");
    start(&mut instance);
    instance.do_step(0.0, 0.1).expect("a step");
    instance.set(d, Value::Real(3.0)).expect("an input");
    let handle = instance.get_state(0).expect("saved");
    let bytes = instance.serialize(handle).expect("bytes");
    let go_on = |instance: &mut Instance| {
        instance.do_step(0.1, 0.25).expect("a step");
        values(instance)
    };
    let first = go_on(&mut instance);
    instance.set_state(handle).expect("restored");
    assert_eq!(go_on(&mut instance), first);
    // In another folder, as each importer has its own.
    let elsewhere = Folder::new();
    let mut other = elsewhere.instance();
    let handle_there = other.deserialize(&bytes).expect("a state");
    other.set_state(handle_there).expect("restored");
    assert_eq!((other.mode(), go_on(&mut other)), (Mode::Step, first));
    instance.free_state(handle).expect("freed");
    assert!(matches!(instance.set_state(handle), Err(Error::UnknownState(_))));
    for damaged in [&bytes[..20], &bytes[..bytes.len() - 1], &b"nonsense"[..]] {
        assert!(matches!(other.deserialize(damaged), Err(Error::Bytes(_))));
    }
    let mut flipped = bytes.clone();
    flipped[60] ^= 1;
    assert!(matches!(other.deserialize(&flipped), Err(Error::Bytes(_))));
}

#[test]
fn every_variable_is_what_it_is_inside() {
    let folder = Folder::new();
    let instance = folder.instance();
    let of = |name: &str| &instance.interface().variables[reference(&instance, name) as usize];
    assert_eq!(of("c.d").causality, Causality::Input);
    assert_eq!(of("a.lag").start, Some(Value::Real(0.02)), "the scenario's value");
    assert_eq!((of("a.y").causality, of("b.u").causality), (Causality::Output, Causality::Local));
    assert_eq!(of("b.u:age").causality, Causality::Output);
    assert!(
        instance.interface().variables.iter().all(|variable| variable.name != "a.u"),
        "a source drives it"
    );
    assert_eq!(instance.guid(), folder.instance().guid());
    let text = SCENARIO.replace("0.02", "0.03");
    std::fs::write(folder.0.path().join("scenario.toml"), text).expect("writable");
    assert_ne!(instance.guid(), folder.instance().guid(), "another scenario is another unit");
}

#[test]
fn every_illegal_call_is_refused_with_its_reason() {
    let folder = Folder::new();
    let mut instance = folder.instance();
    let (input, output) = (reference(&instance, "c.d"), reference(&instance, "a.y"));
    let fixed = reference(&instance, "a.delay");
    let told = |result: Result<(), Error>| result.expect_err("refused").to_string();
    assert!(told(instance.do_step(0.0, 0.1).map(drop)).contains("\"instantiated\""));
    assert!(told(instance.enter_initialization()).contains("fmi2SetupExperiment"));
    assert!(told(instance.setup_experiment(f64::NAN, None)).contains("startTime = NaN"));
    start(&mut instance);
    for (from, size, expected) in [
        (0.1, 0.1, "the instance is at t = 0 s"),
        (0.0, 0.0, "a positive number"),
        (0.0, f64::INFINITY, "a positive number"),
        (0.0, 0.6, "past stopTime = 0.5 s"),
    ] {
        assert!(told(instance.do_step(from, size).map(drop)).contains(expected), "{from} {size}");
    }
    instance.do_step(0.0, 0.1).expect("what was refused changed nothing");
    assert!(told(instance.set(output, Value::Real(1.0))).contains("a.y is an output"));
    assert!(told(instance.set(fixed, Value::Real(1.0))).contains("a.delay is a fixed parameter"));
    assert!(told(instance.set(input, Value::Real(f64::NAN))).contains("c.d"));
    assert!(told(instance.set(input, Value::Integer(1))).contains("is of type Real"));
    assert!(told(instance.get(99_999, Kind::Real).map(drop)).contains("99999 does not exist"));
    instance.terminate().expect("terminated");
    assert!(told(instance.do_step(0.1, 0.1).map(drop)).contains("\"terminated\""));
}

#[test]
fn law_units_inside_take_the_shorter_last_step_that_they_take_outside() {
    let folder = Folder::new();
    let text = SCENARIO.replace("drop = 0.2\n", "");
    std::fs::write(folder.0.path().join("scenario.toml"), &text).expect("writable");
    // A tick of the scenario that is a point of no unit, and a time between ticks.
    for stop in [0.37, 0.3704] {
        let mut scenario = Scenario::load(folder.0.path().join("scenario.toml")).expect("a scenario");
        scenario.set_stop(&stop.to_string()).expect("a time");
        let rows = outside(&scenario);
        assert_eq!(rows.last().expect("rows").0, stop);
        for steps in [1, 10, 37] {
            let mut instance = folder.instance();
            // Twice: the end is that of the experiment, not of the instance.
            for stop in [stop / 2.0, stop] {
                instance.reset().expect("reset");
                instance.setup_experiment(0.0, Some(stop)).expect("set up");
                instance.enter_initialization().expect("entered");
                instance.exit_initialization().expect("left");
                for step in 0..steps {
                    let at = |step: i32| stop * f64::from(step) / f64::from(steps);
                    instance.do_step(at(step), at(step + 1) - at(step)).expect("stepped");
                }
            }
            assert_eq!(values(&mut instance), rows.last().expect("rows").1, "{stop} in {steps} steps");
        }
    }
}

#[test]
fn law_a_state_of_another_experiment_brings_its_end_along() {
    let folder = Folder::new();
    // A stop at a tick of the scenario, and one between ticks, for which the scenario is built anew.
    for stop in [0.37, 0.3704] {
        let begin = |instance: &mut container::Instance, stop| {
            instance.setup_experiment(0.0, stop).expect("set up");
            instance.enter_initialization().expect("entered");
            instance.exit_initialization().expect("left");
        };
        let mut instance = folder.instance();
        begin(&mut instance, Some(stop));
        instance.do_step(0.0, 0.2).expect("stepped");
        let state = instance.get_state(0).expect("saved");
        instance.do_step(0.2, stop - 0.2).expect("stepped");
        let expected = values(&mut instance);
        for other in [None, Some(1.0), Some(0.3301)] {
            instance.reset().expect("reset");
            begin(&mut instance, other);
            instance.set_state(state).expect("set again");
            instance.do_step(0.2, stop - 0.2).expect("stepped");
            assert_eq!(values(&mut instance), expected, "{stop} after {other:?}");
        }
    }
}
