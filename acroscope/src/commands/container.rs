//! `acroscope container`: a whole scenario as one unit.

use crate::cli::Containing;
use crate::commands::ssp::{keep_inputs, named, write};
use crate::error::Error;
use orchestrator::Simulation;
use orchestrator::fmu::Causality;
use runner::request::sets;

/// Writes the unit.
pub fn container(arguments: &Containing, quiet: bool) -> Result<(), Error> {
    let output = &arguments.output;
    named(output, "fmu")?;
    let blank = scenarios::packed(container::BLANK)?;
    let mut scenario = scenarios::load(&arguments.scenario)?;
    for (name, value) in sets(&arguments.set)? {
        scenario.set(&name, &value)?;
    }
    let simulation = Simulation::new(&scenario, &scenarios::unit_path())?;
    keep_inputs(output, &arguments.scenario, &simulation)?;
    let interface = container::Interface::of(&simulation);
    write(output, &container::pack(&simulation, &blank, output)?)?;
    if quiet {
        return Ok(());
    }
    simulation.notices().iter().for_each(|notice| complain!("note: {notice}"));
    let count =
        |causality| interface.variables.iter().filter(|variable| variable.causality == causality).count();
    tell!(
        "{}: {} units inside; {} inputs, {} outputs, {} parameters",
        output.display(),
        scenario.units.len(),
        count(Causality::Input),
        count(Causality::Output),
        count(Causality::Parameter)
    );
    Ok(())
}
