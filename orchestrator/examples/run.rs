//! Runs a scenario to a CSV file: `run SCENARIO.toml OUT.csv [--units DIR]... [--set unit.variable=value]...`.

use orchestrator::{CsvRecorder, Error, Quiet, Scenario, Simulation, UnitPath};

fn main() {
    if let Err(error) = run(std::env::args().skip(1)) {
        eprintln!("{error}");
        std::process::exit(1);
    }
}

fn run(arguments: impl Iterator<Item = String>) -> Result<(), Error> {
    let (mut files, mut path, mut sets) = (Vec::new(), UnitPath::new(), Vec::new());
    let mut arguments = arguments;
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--units" => path = path.with(arguments.next().unwrap_or_default()),
            "--set" => sets.push(arguments.next().unwrap_or_default()),
            _ => files.push(argument),
        }
    }
    let [scenario, out] = files.as_slice() else {
        eprintln!("usage: run SCENARIO.toml OUT.csv [--units DIR]... [--set unit.variable=value]...");
        std::process::exit(2);
    };
    let mut scenario = Scenario::load(scenario)?;
    for set in &sets {
        let (name, value) = set.split_once('=').unwrap_or((set, ""));
        scenario.set(name, value)?;
    }
    let began = std::time::Instant::now();
    let mut simulation = Simulation::new(&scenario, &path)?;
    println!("{} units opened in {:.1} ms", scenario.units.len(), began.elapsed().as_secs_f64() * 1e3);
    let began = std::time::Instant::now();
    let ended = simulation.run(&mut CsvRecorder::create(out)?, &mut Quiet)?;
    println!("{ended:?} at t = {} s after {:.3} s", simulation.time(), began.elapsed().as_secs_f64());
    for notice in simulation.notices() {
        println!("note: {notice}");
    }
    Ok(())
}
