//! The closed loop of Figure 19 from images: time, how it grows with time and frames, and memory.

use crate::samples::{seconds, short};
use crate::{Peer, Row, Samples, ring::Ring};
use orchestrator::{CsvRecorder, Quiet, Scenario, Simulation, UnitPath};
use std::path::PathBuf;
use std::process::Command;

const ROUNDS: usize = 9;

/// Where the packed units are.
pub fn units() -> UnitPath {
    scenarios::unit_path()
}

/// The file of one of them: `plant`, `camera` or `controller`.
pub fn unit(name: &str) -> PathBuf {
    let file = format!("acrobot_{name}.fmu");
    let found = units().folders().iter().map(|folder| folder.join(&file)).find(|path| path.exists());
    found.unwrap_or_else(|| panic!("no {file}; cargo xtask pack makes it"))
}

/// The folder that they lie in.
pub fn folder() -> String {
    unit("plant").parent().expect("a file lies in a folder").display().to_string()
}

/// Figure 19 for a time in s, with changed values.
pub fn scenario(stop: &str, set: &[(&str, &str)]) -> Scenario {
    let mut scenario = scenarios::load("visual-servo").expect("a shipped scenario");
    scenario.set_stop(stop).expect("a time");
    for (name, value) in set {
        scenario.set(name, value).expect("a variable of the scenario");
    }
    scenario
}

fn simulation(stop: &str, set: &[(&str, &str)]) -> Simulation {
    Simulation::new(&scenario(stop, set), &units()).expect("cargo xtask pack has made the units")
}

fn to_csv(simulation: &mut Simulation, path: &std::path::Path) -> f64 {
    seconds(|| {
        let mut csv = CsvRecorder::create(path).expect("writable");
        simulation.run(&mut csv, &mut Quiet).expect("runs");
    })
}

/// Runs once and prints the largest memory this process ever had, in KiB; called in a process of its own.
pub fn memory(stop: &str) {
    let folder = tempfile::TempDir::new().expect("a temporary folder");
    to_csv(&mut simulation(stop, &[]), &folder.path().join("results.csv"));
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM:")).unwrap_or_default();
    println!("{}", line.split_whitespace().nth(1).unwrap_or("0"));
}

fn peak_mib(stop: &str) -> f64 {
    let program = std::env::current_exe().expect("this program");
    let output = Command::new(program).args(["--memory", stop]).output().expect("starts itself");
    let text = String::from_utf8_lossy(&output.stdout);
    text.trim().parse::<f64>().unwrap_or_else(|error| panic!("`{text}`: {error}")) / 1024.0
}

/// All measurements of the closed loop. `program` is [`crate`]'s `counted`.
pub fn rows(program: &str) -> Vec<Row> {
    let results = tempfile::TempDir::new().expect("a temporary folder");
    let file = results.path().join("results.csv");
    let ring = Ring::new();
    let mut peer = Peer::start("masters.py", &[&ring.fmu().display().to_string(), &folder()]);
    let noise = [("camera.sigma", "15"), ("camera.N", "2")];
    let mut long = simulation("30", &[]);
    let mut ten = simulation("300", &[]);
    let mut noisy = simulation("30", &noise);
    let mut frames = [("30", 900.0), ("120", 3600.0), ("600", 18_000.0)]
        .map(|(rate, count)| (simulation("30", &[("camera.omega_cam", rate)]), count, Samples::default()));
    let [mut once, mut tenfold, mut whole, mut fmpy]: [Samples; 4] = Default::default();
    for round in 0..ROUNDS {
        once.0.push(to_csv(&mut long, &file));
        whole.0.push(to_csv(&mut noisy, &file));
        for (simulation, _, times) in &mut frames {
            times.0.push(to_csv(simulation, &file));
        }
        if round % 3 == 0 {
            tenfold.0.push(to_csv(&mut ten, &file) / 10.0);
            let mut times = Samples::default();
            peer.measure("loop 3", &mut times);
            fmpy.0.extend(times.0.iter().map(|time| time * 1e-6 * 10.0));
        }
    }
    let [few, middle, many] = &frames;
    let (small, large) = (peak_mib("30"), peak_mib("300"));
    vec![
        Row::faster("loop", "30 s of Figure 19 from images, with CSV".into(), "s", &once)
            .at_most(0.25)
            .note(format!("{} times real time", short(30.0 / once.quiet()))),
        Row::faster("loop", "the same".into(), "s", &once)
            .than("FMPy, the same Gauss-Seidel loop", &fmpy)
            .note("FMPy: 3 s times 10".into()),
        Row::faster("loop", "with σ = 15, N = 2".into(), "s", &whole).at_most(0.25),
        Row::faster("loop", "300 s, a tenth of it".into(), "s", &tenfold)
            .than("30 s", &once)
            .note("linear in time: ratio 1".into()),
        Row::faster("loop", "30 s at 120 frames/s".into(), "s", &middle.2),
        Row::faster("loop", "a frame more, from 30 to 600/s".into(), "µs", &per_frame(few, many))
            .note("difference of 10th percentiles".into()),
        Row::faster("loop", "peak memory, 300 s".into(), "MiB", &Samples(vec![large]))
            .than("30 s", &Samples(vec![small]))
            .at_most_times(1.05),
    ]
    .into_iter()
    .chain(counted(program))
    .collect()
}

/// What a frame costs in instructions, which no other program on the machine changes; nothing without valgrind.
fn counted(program: &str) -> Option<Row> {
    let counts: Option<Vec<f64>> =
        ["15", "30", "120", "600"].iter().map(|rate| instructions(program, rate)).collect();
    let [few, normal, many, most] = counts?[..] else { return None };
    let seconds = 3.0;
    let samples = |from: f64, to: f64, frames: f64| Samples(vec![(to - from) / (frames * seconds) / 1e3]);
    let row = Row::faster(
        "loop",
        "a frame more, from 120 to 600/s".into(),
        "1000 instructions",
        &samples(many, most, 480.0),
    );
    Some(
        row.than("from 15 to 30/s", &samples(few, normal, 15.0))
            .note(format!("from 30 to 120/s {}; counted, not timed", samples(normal, many, 90.0).text())),
    )
}

fn instructions(program: &str, rate: &str) -> Option<f64> {
    let output = Command::new("valgrind")
        .args([
            "--tool=callgrind",
            "--callgrind-out-file=/dev/null",
            "--toggle-collect=orchestrator::run::run*",
        ])
        .args([program, &format!("loop{rate}")])
        .output()
        .ok()?;
    let text = String::from_utf8_lossy(&output.stderr);
    text.lines().find_map(|line| line.split_once("Collected : ")?.1.trim().parse().ok())
}

type Rated = (Simulation, f64, Samples);

/// µs a frame, from what runs at two rates cost when nothing else is on the machine.
fn per_frame(few: &Rated, many: &Rated) -> Samples {
    Samples(vec![(many.2.quiet() - few.2.quiet()) / (many.1 - few.1) * 1e6])
}
