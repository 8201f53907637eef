//! A fixed amount of work for `scripts/instructions.sh`, which counts its instructions: `counted WORK`.
//!
//! Instructions are the same in every run on every machine with the same compiler, so that a regression shows that no
//! clock could see on a busy machine.

use benches::frame::{CASES, Rig};
use benches::ring::Ring;
use fmi2_export::{Experiment, Log, Model, Step};
use orchestrator::{NoRecorder, Quiet, Simulation};
use plant::Plant;

struct Silent;
impl Log for Silent {
    fn log(&mut self, _: &'static str, _: &dyn Fn() -> String) {}
}

fn frames(name: &str) {
    let case = CASES.iter().find(|case| case.0 == name).unwrap_or_else(|| panic!("no work `{name}`"));
    let mut rig = Rig::new(*case);
    for k in 0..50 {
        assert_eq!(rig.shoot(k, true).len(), 3);
    }
}

fn master_steps(ring: &Ring) {
    let mut simulation = ring.simulation(1000, "");
    // Ten runs, so that steps outweigh the opening.
    for _ in 0..10 {
        simulation.run(&mut NoRecorder, &mut Quiet).expect("runs");
    }
}

fn plant_steps() {
    let mut variables = plant::Variables::default();
    let mut plant = Plant::default();
    let experiment = Experiment { start: 0.0, stop: None, tolerance: None };
    plant.initialize(&mut variables, &experiment, &mut Silent).expect("start values are legal");
    for k in 0..1000 {
        let step = Step { from: f64::from(k) / 600.0, to: f64::from(k + 1) / 600.0, input_rates: &[] };
        plant.step(&mut variables, &step, &mut Silent).expect("the step is legal");
    }
}

/// Short runs of the closed loop with reused units: what a run costs beyond its steps. None of them is the opening alone, most
/// of which is the unpacking of the units' files; two of them pay for the look whether a reset brings each unit back.
fn short_runs(count: usize) {
    let scenario = benches::closed_loop::scenario("1/10", &[]);
    let mut simulation =
        Simulation::new(&scenario, &benches::closed_loop::units()).expect("cargo xtask pack made the units");
    for _ in 0..count {
        simulation.run(&mut NoRecorder, &mut Quiet).expect("runs");
    }
}

/// A description of 20 000 variables and a scenario of 1000 units and 10 000 connections, both as text: what opening a large
/// system costs before its units.
fn large_texts() {
    let mut description = "<fmiModelDescription fmiVersion=\"2.0\" modelName=\"l\" guid=\"{l}\"><CoSimulation modelIdentifier=\"l\"/>\
        <TypeDefinitions><SimpleType name=\"P\"><Real unit=\"Pa\" min=\"0\"/></SimpleType></TypeDefinitions><ModelVariables>\n"
        .to_owned();
    for number in 0..20_000 {
        description += &format!(
            "<ScalarVariable name=\"part{}.volume{number}.p\" valueReference=\"{number}\" causality=\"output\">\
             <Real declaredType=\"P\"/></ScalarVariable>\n",
            number / 100
        );
    }
    description += "</ModelVariables><ModelStructure><Outputs>";
    (1..=20_000).for_each(|index| description += &format!("<Unknown index=\"{index}\" dependencies=\"\"/>"));
    description += "</Outputs></ModelStructure></fmiModelDescription>";
    let read = orchestrator::fmu::Description::parse(&description).expect("a description");
    let found = (0..20_000).filter(|&output| read.step_dependencies(output).is_some_and(<[usize]>::is_empty));
    assert_eq!(found.count(), 20_000);
    let mut scenario = "format = 1\nexperiment = { stop = 1 }\n".to_owned();
    for unit in 0..1000 {
        scenario += &format!("[[units]]\nname = \"u{unit}\"\nfmu = \"l.fmu\"\ninterval = 0.01\n");
    }
    for number in 0..10_000 {
        let (from, to) = (number % 997, number / 10);
        scenario += &format!("[[connections]]\nfrom = \"u{from}.y{number}\"\nto = \"u{to}.u{number}\"\n");
    }
    let read = orchestrator::Scenario::parse(&scenario, "large.toml").expect("a scenario");
    assert_eq!(read.connections.len(), 10_000);
}

/// Three seconds of the closed loop at a number of frames a second: what a frame costs, by differences.
fn closed_loop(rate: &str) {
    let scenario = benches::closed_loop::scenario("3", &[("camera.omega_cam", rate)]);
    let mut simulation =
        Simulation::new(&scenario, &benches::closed_loop::units()).expect("cargo xtask pack made the units");
    simulation.run(&mut NoRecorder, &mut Quiet).expect("runs");
}

fn main() {
    match std::env::args().nth(1).as_deref() {
        Some("master") => master_steps(&Ring::new()),
        Some("mixed") => master_steps(&Ring::of_oscillators()),
        Some("texts") => master_steps(&Ring::of_feedthroughs(true)),
        Some("plant") => plant_steps(),
        Some("opening") => short_runs(0),
        Some("again") => short_runs(2),
        Some("runs") => short_runs(22),
        Some("large") => large_texts(),
        Some(name) if name.starts_with("loop") => closed_loop(&name[4..]),
        Some(name) => frames(name),
        None => {
            panic!(
                "which work? a, b16, c, d, master, mixed, texts, plant, opening, again, runs, large or loop30"
            )
        }
    }
}
