//! What a master needs that runs a scenario inside another system, and what only looks on.

use crate::common;

use crate::common::Units;
use orchestrator::{
    Column, CsvRecorder, Error, MemoryRecorder, NoRecorder, Progress, Quiet, Recorder, Row, Scenario,
    Simulation, Twice,
};
use std::ops::ControlFlow;

/// A clock from 0.5 s to 1.5 s by quarters.
fn clock(units: &Units, more: &str) -> Simulation {
    let text = format!(
        "format = 1\nexperiment = {{ start = 0.5, stop = 1.5 }}\n[[units]]\nname = \"a\"\nfmu = \"stateful.fmu\"\ninterval = 0.25\n\
         {more}\nset = {{ mode = 2 }}\n[[sources]]\nto = \"a.u1\"\nkind = \"constant\"\nvalue = 1\n"
    );
    Simulation::new(&Scenario::parse(&text, "test.toml").expect("a scenario"), &units.unit_path())
        .expect("builds")
}

/// Times and sizes of all steps.
fn steps(simulation: &mut Simulation) -> Vec<(f64, f64)> {
    let mut steps = Vec::new();
    while let Some(time) = simulation.advance().expect("steps") {
        assert_eq!(simulation.value("a.y1").expect("known"), time, "the unit's own clock");
        steps.push((time, simulation.value("a.y2").expect("known")));
        if steps.len() == 40 {
            break;
        }
    }
    steps
}

#[test]
fn law_another_master_sets_the_stop() {
    let units = Units::new();
    let mut simulation = clock(&units, "");
    assert!(simulation.is_driven("a.u1") && !simulation.is_driven("a.u2") && !simulation.is_driven("b.u1"));
    assert!(!simulation.is_running(), "not begun");
    assert_eq!(simulation.tick().to_f64(), 0.25);
    assert_eq!(steps(&mut simulation), [0.75, 1.0, 1.25, 1.5].map(|time| (time, 0.25)));
    assert!(simulation.is_running(), "at the stop, and ended by nobody");
    simulation.terminate();
    assert!(!simulation.is_running(), "ended");
    assert_eq!(simulation.advance().expect("nothing to be done"), None);
    assert!(!simulation.end_at(1.1), "no multiple of the tick");
    assert!(simulation.end_at(1.0));
    assert_eq!(steps(&mut simulation), [0.75, 1.0].map(|time| (time, 0.25)));
    assert!(simulation.end_at(2.25), "later than the scenario's");
    assert_eq!(steps(&mut simulation).last(), Some(&(2.25, 0.25)));
    simulation.open_end(None);
    assert_eq!(steps(&mut simulation).last(), Some(&(10.5, 0.25)), "for ever");
    assert!(simulation.is_running());
}

#[test]
fn law_a_unit_steps_as_far_as_such_a_stop() {
    let units = Units::new();
    // The offset makes the tick a sixteenth.
    let mut simulation = clock(&units, "offset = \"1/16\"");
    let first = 0.5 + 1.0 / 16.0;
    assert!(simulation.end_at(1.0));
    assert_eq!(steps(&mut simulation), [(first, 0.0625), (first + 0.25, 0.25), (1.0, 0.1875)]);
    assert!(simulation.end_at(first + 0.25), "at one of its points");
    assert_eq!(steps(&mut simulation), [(first, 0.0625), (first + 0.25, 0.25)]);
    assert!(simulation.end_at(first), "at its first");
    assert_eq!(steps(&mut simulation), [(first, 0.0625)]);
    // One whose steps can't differ stays at its last point before it; the tick is that of the other unit.
    let fixed =
        common::description(common::STATEFUL).replace("canHandleVariableCommunicationStepSize=\"true\"", "");
    units.pack("stateful.fmu", &fixed, &common::library());
    let other = "set = { mode = 2 }\n[[units]]\nname = \"b\"\nfmu = \"feedthrough.fmu\"\ninterval = 0.125";
    let mut simulation = clock(&units, other);
    assert!(simulation.end_at(0.875));
    while simulation.advance().expect("steps").is_some() {}
    assert_eq!((simulation.time(), simulation.value("a.y1").expect("known")), (0.875, 0.75));
}

#[test]
fn law_such_a_stop_counts_from_the_start_and_whole_seconds_go_on_for_ever() {
    let units = Units::new();
    let simulation = |start: f64, interval: f64| {
        let text = format!(
            "format = 1\nexperiment = {{ start = {start}, stop = 20 }}\n[[units]]\nname = \"a\"\nfmu = \"stateful.fmu\"\n\
             interval = {interval}\nset = {{ mode = 2 }}\n"
        );
        Simulation::new(&Scenario::parse(&text, "test.toml").expect("a scenario"), &units.unit_path())
            .expect("builds")
    };
    // The start is no multiple of the interval: what is left of the last step is counted from there.
    let mut from_there = simulation(0.0625, 0.25);
    assert!(from_there.end_at(0.375));
    assert_eq!(steps(&mut from_there), [(0.3125, 0.25), (0.375, 0.0625)]);
    for interval in [2.0, 3.0] {
        let mut open = simulation(0.0, interval);
        open.open_end(None);
        assert_eq!(steps(&mut open).last(), Some(&(40.0 * interval, interval)), "well beyond its own stop");
    }
}

/// What it was told.
#[derive(Default)]
struct Told {
    wants: bool,
    fails: bool,
    calls: Vec<&'static str>,
}

impl Recorder for Told {
    fn begin(&mut self, _: &[Column]) -> Result<(), Error> {
        self.calls.push("begin");
        Ok(())
    }
    fn go_on(&mut self) -> Result<(), Error> {
        self.calls.push("go on");
        Ok(())
    }
    fn records(&self) -> bool {
        self.wants
    }
    fn row(&mut self, _: f64, _: Row<'_>) -> Result<(), Error> {
        self.calls.push("row");
        Ok(())
    }
    fn end(&mut self) -> Result<(), Error> {
        self.calls.push("end");
        match self.fails {
            true => Err(Error::Value { name: "x".into(), value: "z".into(), expected: "y".into() }),
            false => Ok(()),
        }
    }
}

#[test]
fn law_two_recorders_are_told_the_same() {
    let units = Units::new();
    for (wants, fails) in [(false, false), (true, false), (false, true), (true, true)] {
        let (mut one, mut other) = (Told { wants, ..Told::default() }, Told { fails, ..Told::default() });
        let run = clock(&units, "").run(&mut Twice(&mut one, &mut other), &mut Quiet);
        assert_eq!(run.is_err(), fails);
        let mut expected = vec!["begin"];
        // Without one that wants rows there is the start's only.
        expected.extend(std::iter::repeat_n("row", if wants { 5 } else { 1 }));
        expected.push("end");
        assert_eq!((&one.calls, &other.calls), (&expected, &expected), "{wants} {fails}");
        let (run, mut none) =
            (clock(&units, "").run(&mut Twice(&mut other, &mut one), &mut Quiet), NoRecorder);
        assert_eq!(run.is_err(), fails, "the first one's");
        assert!(!Twice(&mut none, &mut NoRecorder).records());
        Twice(&mut one, &mut other).go_on().expect("nothing against it");
        assert_eq!((one.calls.last(), other.calls.last()), (Some(&"go on"), Some(&"go on")));
    }
}

#[test]
fn law_a_paced_run_gives_the_same_rows_and_says_how_late_it_was() {
    let units = Units::new();
    let bytes = |factor: Option<f64>, paced: bool| {
        let mut simulation = clock(&units, "");
        simulation.pace(factor);
        let mut csv = CsvRecorder::new(Vec::new());
        simulation.run(&mut csv, &mut Quiet).expect("runs");
        assert_eq!(simulation.lateness().is_some(), paced, "{factor:?}");
        csv.into_inner()
    };
    let free = bytes(None, false);
    assert!(
        bytes(Some(1e6), true) == free && bytes(Some(0.0), false) == free && bytes(Some(-1.0), false) == free
    );
}

#[test]
fn law_progress_is_counted_from_the_start() {
    // Simulated by real time since the run began: at most 1 s over the clock's least of 1 ns.
    struct Watch(Vec<f64>);
    impl Progress for Watch {
        fn at(&mut self, _: f64, factor: f64) -> ControlFlow<()> {
            self.0.push(factor);
            ControlFlow::Continue(())
        }
    }
    let text = "format = 1\nexperiment = { start = 1000000000000, stop = 1000000000001 }\n[[units]]\nname = \"a\"\n\
                fmu = \"stateful.fmu\"\ninterval = 0.25\n";
    let scenario = Scenario::parse(text, "test.toml").expect("a scenario");
    let mut simulation = Simulation::new(&scenario, &Units::new().unit_path()).expect("builds");
    let mut watch = Watch(Vec::new());
    simulation.run(&mut MemoryRecorder::new(), &mut watch).expect("runs");
    assert!(
        !watch.0.is_empty() && watch.0.iter().all(|factor| *factor > 0.0 && *factor <= 1e9 && *factor != 1.0),
        "{:?}",
        watch.0
    );
}
