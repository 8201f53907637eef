//! The order of calls (the state machine of FMI 2.0.4 section 4.2.4), and the GUID that comes with the first of them.

use super::bench::{Bench, Halt};
use super::worker::say_call;
use crate::finding::Found;
use orchestrator::fmu::Instance;

pub(super) fn order(bench: &Bench, found: &mut Found) -> Result<(), Halt> {
    // An instance may be freed wherever it stands.
    drop(bench.instance("a new instance")?);
    let mut unit = bench.instance("an instance that was set up")?;
    let start = bench.start;
    unit.call("fmi2SetupExperiment", |instance| instance.setup_experiment(start, None))?;
    drop(unit);
    drop(bench.initialising("an instance in initialisation")?);
    drop(bench.started("an initialised instance")?);
    let mut unit = bench.started("a terminated instance")?;
    unit.advance(0)?;
    unit.call("fmi2Terminate", Instance::terminate)?;
    unit.read(&bench.outputs())?;
    unit.call("fmi2Reset", Instance::reset_itself)?;
    unit.set_up()?;
    unit.exit_initialization()?;
    unit.advance(0)?;
    drop(unit);
    let mut unit = bench.instance("an instance before its initialisation")?;
    if unit.step(bench.start, bench.step).is_ok() {
        found.warning(
            "fmi2DoStep before the initialisation is answered with ok: a master that forgets it is not told",
        );
    }
    drop(unit);
    let mut unit = bench.started("a terminated instance")?;
    unit.call("fmi2Terminate", Instance::terminate)?;
    if unit.step(bench.start, bench.step).is_ok() {
        found
            .warning("fmi2DoStep after fmi2Terminate is answered with ok: a master that goes on is not told");
    }
    Ok(())
}

/// Nobody's.
const OTHER: &str = "{c0ffee00-0000-4000-8000-000000000000}";

pub(super) fn guid(bench: &Bench, found: &mut Found) -> Result<(), Halt> {
    // With its own it is made, so that nothing else is what is refused.
    drop(bench.instance("unit")?);
    say_call(&format!("fmi2Instantiate with the GUID {OTHER}"));
    if bench.fmu.with_guid(OTHER).instantiate("unit").is_ok() {
        found.warning("the library takes another GUID than that of its description: it does not tell if the two do not belong together");
    }
    Ok(())
}
