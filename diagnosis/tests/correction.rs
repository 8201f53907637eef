//! A rest that no listed effect gives: the residual unit hides it, and the diagnosis writes it back as a correction.

use crate::common;

use crate::common::{Folder, units};
use diagnosis::rigs::acrobot::correction::{Closing, Correction, wiring};
use diagnosis::rigs::acrobot::dataset::DataSet;
use diagnosis::rigs::acrobot::model::Model;
use diagnosis::testing::Random;
use diagnosis::{Options, Verdict, diagnose};
use orchestrator::scenario::{Shape, SignalEntry, SourceEntry};
use orchestrator::{MemoryRecorder, Quiet, Scenario, Simulation};
use std::fmt::Write as _;
use std::path::Path;

/// An arm that hangs from a pin and is shaken at its joint, with a drag that no candidate has.
const SHAKEN: &str = r#"
format = 1
[experiment]
stop = 5
[[units]]
name = "plant"
fmu = "acrobot_plant.fmu"
interval = "1/1000"
[units.set]
q1_0 = 3.1
q2_0 = 3.2
q2_max = 1e9
theta_2 = 0.0
theta_7 = 0.0
[[units]]
name = "residual"
fmu = "acrobot_residual.fmu"
interval = "1/1000"
[units.set]
drag_joint = -0.006
[[connections]]
from = "plant.q1"
to = "residual.q1"
[[connections]]
from = "plant.q2"
to = "residual.q2"
[[connections]]
from = "plant.dq1"
to = "residual.dq1"
[[connections]]
from = "plant.dq2"
to = "residual.dq2"
[[connections]]
from = "residual.tau_1"
to = "plant.tau_1"
[[connections]]
from = "residual.tau_2"
to = "plant.tau_2"
[[sources]]
to = "plant.tau"
kind = "hold"
points = []
"#;
/// The hidden coefficient, N·m·s²/rad².
const DRAG: f64 = -0.006;
const STOP: f64 = 5.0;
/// Noise of the angles, rad.
const NOISE: f64 = 2e-4;

/// Torques held for 20 ms each, a sum of two sines.
fn command(run: u64, time: f64) -> f64 {
    let first = 0.9 + 0.13 * run as f64;
    0.7 * (std::f64::consts::TAU * first * time).sin()
        + 0.5 * (std::f64::consts::TAU * 2.3 * first * time).cos()
}

/// The scenario with the torques of a run.
fn driven(run: u64) -> Scenario {
    let mut points = String::new();
    for row in 0..(STOP / 0.02) as u32 {
        let _ = write!(points, "[{}, {}], ", 0.02 * f64::from(row), command(run, 0.02 * f64::from(row)));
    }
    let text = SHAKEN.replace("points = []", &format!("points = [{points}]"));
    Scenario::parse(&text, "shaken.toml").expect("a scenario")
}

fn simulated(scenario: &Scenario) -> MemoryRecorder {
    let mut memory = MemoryRecorder::new();
    let mut simulation = Simulation::new(scenario, &units()).expect("cargo xtask pack was run");
    simulation.run(&mut memory, &mut Quiet).expect("it runs");
    memory
}

fn series(memory: &MemoryRecorder, name: &str) -> Vec<f64> {
    memory.series(name).expect("all outputs are recorded").to_vec()
}

fn shaken(name: &str, runs: u64, more: &[(&str, &str)]) -> Folder {
    recorded(name, runs, &|run| {
        let mut scenario = driven(run);
        more.iter().for_each(|(name, value)| scenario.set(name, value).expect("the name is right"));
        scenario
    })
}

/// What encoders saw of runs, and their commands.
fn recorded(name: &str, runs: u64, scenario: &dyn Fn(u64) -> Scenario) -> Folder {
    let folder = Folder::new(name);
    let mut head = format!(
        "format = 1\nscenario = \"visual-servo\"\n[set]\n\"plant.q2_max\" = 1e9\n\"plant.theta_2\" = 0.0\n\
         \"plant.theta_7\" = 0.0\n[noise]\n\"plant.q1\" = {NOISE}\n\"plant.q2\" = {NOISE}\n"
    );
    for run in 1..=runs {
        let _ = writeln!(head, "[[run]]\ndir = \"run-{run:02}\"");
        let mut controller = "time,tau\n".to_owned();
        for row in 0..(STOP / 0.02) as u32 {
            let time = 0.02 * f64::from(row);
            let _ = writeln!(controller, "{time},{}", command(run, time));
        }
        let memory = simulated(&scenario(run));
        let (q1, q2) = (series(&memory, "plant.q1"), series(&memory, "plant.q2"));
        let mut random = Random::new(run);
        let mut plant = "time,q1,q2\n".to_owned();
        for (row, time) in memory.times().iter().enumerate().filter(|(row, _)| row % 10 == 0) {
            let (a, b) = (q1[row] + NOISE * random.normal(), q2[row] + NOISE * random.normal());
            let _ = writeln!(plant, "{time},{a},{b}");
        }
        folder.put(&format!("run-{run:02}/controller.csv"), &controller);
        folder.put(&format!("run-{run:02}/plant.csv"), &plant);
    }
    folder.put("dataset.toml", &head);
    folder
}

/// Largest distance of two runs' angles over their first second and a half, rad.
fn apart(a: &MemoryRecorder, b: &MemoryRecorder) -> f64 {
    let rows = a.times().partition_point(|time| *time <= 1.5);
    let angles = ["plant.q1", "plant.q2"].map(|name| (series(a, name), series(b, name)));
    let far = |(a, b): &(Vec<f64>, Vec<f64>)| {
        a.iter().zip(b).take(rows).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    angles.iter().map(far).fold(0.0, f64::max)
}

#[test]
fn recovers_a_drag_as_a_labelled_correction() {
    let data = shaken("shaken", 3, &[]);
    let found = diagnose(data.path(), &units(), &common::options(), &mut |_| {}).expect("the data is good");
    assert_eq!(found.verdict, Verdict::Unknown, "{:?}", found.effects);
    let correction = found.correction.as_ref().expect("a correction is offered");
    assert!(correction.gap.closed > 0.97, "{correction:?}");
    // each half of the runs by what the other half says: of three runs, one is by itself there
    assert!(found.gap.closed.is_some_and(|closed| closed > 0.95), "{:?}", found.gap);
    let [term] = correction.terms.as_slice() else { panic!("one term was hidden: {:?}", correction.terms) };
    assert_eq!(term.name, "residual.drag_joint");
    // a tenth of a millisecond's delay of the hidden torque, held over steps, and pieces of 6 ms: about a per cent
    assert!((term.value / DRAG - 1.0).abs() < 0.02, "{term:?}");
    // an effect that stood for a part of it is not named any more
    assert!(found.effects.is_empty(), "{:?}", found.effects);

    let mut amended = Scenario::parse(&found.amended, "amended.toml").expect("a scenario that loads");
    amended.set_stop("0.5").expect("a time");
    let run = simulated(&amended);
    assert!(series(&run, "residual.joint").iter().any(|torque| *torque != 0.0), "the unit is at work");

    // the correction in the machine that was hidden, beside the truth and beside the nominal model
    let entry = amended.units.iter().find(|unit| unit.name == "residual").expect("it is in the scenario");
    let (truth, mut corrected, mut nominal) = (driven(4), driven(4), driven(4));
    let place = corrected.units.iter().position(|unit| unit.name == "residual").expect("SHAKEN has one");
    corrected.units[place].set.clone_from(&entry.set);
    nominal.set("residual.drag_joint", "0.0").expect("the name is right");
    let truth = simulated(&truth);
    let (with, without) = (apart(&truth, &simulated(&corrected)), apart(&truth, &simulated(&nominal)));
    assert!(with < 0.1 * without, "{with} rad with the correction, {without} without");
}

#[test]
fn law_the_page_says_that_a_correction_is_not_in_its_curves() {
    // the friction that was hidden there, with nothing listed that gives it
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/hidden-effect");
    let without = ["plant.b_joint", "plant.fc_joint"].map(String::from).to_vec();
    let options = Options { without, ..common::options() };
    let found = diagnose(&data, &units(), &options, &mut |_| {}).expect("the data is good");
    assert!(found.correction.is_some());
    let folder = Folder::new("curves");
    found.write(folder.path()).expect("a folder of ours");
    let page = std::fs::read_to_string(folder.path().join("report.html")).expect("it was written");
    assert!(page.contains("The labelled correction is not in these curves"));
}

#[test]
fn recovers_a_listed_effect_beside_a_correction() {
    let data = shaken("beside", 3, &[("plant.I_rotor", "0.01")]);
    let found = diagnose(data.path(), &units(), &common::options(), &mut |_| {}).expect("the data is good");
    assert_eq!(found.verdict, Verdict::Unknown, "{:?}", found.effects);
    let rotor = found.effects.iter().find(|effect| effect.name == "plant.I_rotor");
    let rotor = rotor.unwrap_or_else(|| panic!("{:?} {:#?}", found.effects, found.correction));
    // fitted before the correction was there, with half the torque of the drag unexplained
    assert!((rotor.value - 0.01).abs() < 2e-3, "{rotor:?}");
    let correction = found.correction.as_ref().expect("a correction is offered");
    assert!(correction.terms.iter().any(|term| term.name == "residual.drag_joint"), "{:?}", correction.terms);
    assert!(correction.gap.closed > 0.8, "{correction:?}");
}

#[test]
fn every_rest_without_a_law_stays_unknown_and_uncorrected() {
    // a push of a tenth of a second, once a run: no function of angles and rates
    let pushed = |run: u64| {
        let mut scenario = driven(run);
        scenario.set("residual.drag_joint", "0.0").expect("the name is right");
        let at = 1.5 + 0.7 * run as f64;
        let points = vec![(0.0, 0.0), (at, 0.6), (at + 0.1, 0.0)];
        let place = scenario.sources[0].place.clone();
        let signal = SignalEntry::Table { shape: Shape::Hold, points };
        scenario.sources.push(SourceEntry { to: "residual.tau_1_in".into(), signal, place });
        scenario
    };
    let data = recorded("pushed", 3, &pushed);
    let found = diagnose(data.path(), &units(), &common::options(), &mut |_| {}).expect("the data is good");
    assert_eq!(found.verdict, Verdict::Unknown, "{:?}", found.effects);
    assert!(found.unknown.is_some());
    assert_eq!(found.correction, None);
    assert!(!found.amended.contains("acrobot_residual"));
}

/// Bits of all that the plant and the others say.
fn bits(memory: &MemoryRecorder) -> Vec<u64> {
    let names = [
        "plant.q1",
        "plant.q2",
        "plant.dq1",
        "plant.dq2",
        "plant.tau_applied",
        "controller.tau",
        "plant.tau_1",
    ];
    names.iter().flat_map(|name| series(memory, name)).map(f64::to_bits).collect()
}

fn still(name: &str) -> Correction {
    let gap = Closing { before: 1.0, after: 0.5, floor: 0.1, closed: 0.75, held_out_runs: Vec::new() };
    Correction {
        label: String::new(),
        unit: name.into(),
        terms: Vec::new(),
        gap,
        supersedes: Vec::new(),
        parameters: vec![("reach_joint".into(), 1.0)],
        usual: 0.5,
        left: Vec::new(),
    }
}

#[test]
fn law_a_residual_unit_without_coefficients_changes_no_bit() {
    let mut plain = scenarios::load("full-state").expect("it is shipped");
    plain.set_stop("3").expect("a time");
    // a rig whose first link is driven from outside
    let mut pushed = plain.clone();
    let signal = SignalEntry::Constant(toml::Value::Float(0.01));
    let place = pushed.sources[0].place.clone();
    pushed.sources.push(SourceEntry { to: "plant.tau_1".into(), signal, place });
    for scenario in [plain, pushed] {
        let mut with = scenario.clone();
        let name = wiring::free_name(&with);
        wiring::insert(&mut with, &still(&name));
        assert_eq!(bits(&simulated(&with)), bits(&simulated(&scenario)));
        // and out again
        assert_eq!(wiring::strip(&mut with), [name]);
        assert_eq!(with.units.len(), scenario.units.len());
        let wires =
            |of: &Scenario| of.connections.iter().map(|c| (c.from.clone(), c.to.clone())).collect::<Vec<_>>();
        assert_eq!(wires(&with), wires(&scenario));
        let fed = |of: &Scenario| of.sources.iter().map(|source| source.to.clone()).collect::<Vec<_>>();
        assert_eq!(fed(&with), fed(&scenario));
        assert_eq!(with.report.to_string(), scenario.report.to_string());
    }
}

#[test]
fn law_an_earlier_correction_is_left_out_and_said() {
    let data = shaken("earlier", 1, &[]);
    let mut scenario = scenarios::load("visual-servo").expect("it is shipped");
    wiring::insert(&mut scenario, &still("residual"));
    let text = Simulation::new(&scenario, &units()).expect("it can be built").resolved();
    data.put("earlier.toml", &text);
    let head = std::fs::read_to_string(data.path().join("dataset.toml")).expect("written");
    data.put("dataset.toml", &head.replace("\"visual-servo\"", "\"earlier.toml\""));
    let set = DataSet::load(data.path()).expect("good");
    let model = Model::load(&set, &units()).expect("it loads");
    assert!(model.scenario.units.iter().all(|unit| unit.name != "residual"));
    assert!(model.notices(&set).iter().any(|notice| notice.message.contains("residual")));
}
