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

/// Short runs of the closed loop with reused units: what a run costs beyond its steps.
fn short_runs() {
    let scenario = benches::closed_loop::scenario("1/10", &[]);
    let mut simulation =
        Simulation::new(&scenario, &benches::closed_loop::units()).expect("cargo xtask pack made the units");
    for _ in 0..20 {
        simulation.run(&mut NoRecorder, &mut Quiet).expect("runs");
    }
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
        Some("runs") => short_runs(),
        Some(name) if name.starts_with("loop") => closed_loop(&name[4..]),
        Some(name) => frames(name),
        None => panic!("which work? a, b16, c, d, master, mixed, texts, plant, runs or loop30"),
    }
}
