//! The smallest master: `run_csv SCENARIO.toml FOLDER-WITH-UNITS RESULTS.csv [STOP]`.
//!
//! `scripts/platforms.sh` runs it under Wine, too, and compares the results of Windows' units with those of Linux.

use orchestrator::{CsvRecorder, Error, Quiet, Scenario, Simulation, UnitPath};

fn main() -> Result<(), Error> {
    let words: Vec<String> = std::env::args().collect();
    let [_, scenario, units, results, rest @ ..] = words.as_slice() else {
        eprintln!("usage: run_csv SCENARIO.toml FOLDER-WITH-UNITS RESULTS.csv [STOP]");
        std::process::exit(2);
    };
    let mut scenario = Scenario::load(scenario)?;
    if let [stop] = rest {
        scenario.set_stop(stop)?;
    }
    let mut simulation = Simulation::new(&scenario, &UnitPath::new().with(units))?;
    simulation.run(&mut CsvRecorder::create(results)?, &mut Quiet)?;
    println!("{results}: ran to {} s", simulation.time());
    Ok(())
}
