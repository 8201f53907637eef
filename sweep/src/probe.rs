//! Whether units may be used for one run after the other: whether after `fmi2Reset` they do what fresh ones do. A unit that
//! keeps something over a reset is found here, and gets fresh instances for every case;
//! one whose library keeps something for the next instance is refused, since only a process for each case helps there.

use crate::error::Error;
use crate::plan::Plan;
use orchestrator::{Cell, Simulation};

/// Points that are compared: what a unit keeps shows soon, and this costs nothing beside a sweep.
const POINTS: u32 = 1000;

/// What came of it.
pub(crate) struct Probed {
    /// Whether units may be used again after a run.
    pub(crate) reuse: bool,
    /// What a person should know.
    pub(crate) note: Option<&'static str>,
}

const FRESH: &str = "a unit keeps something over fmi2Reset: every case gets fresh instances";
const APART: &str =
    "a unit keeps something over fmi2Reset: every case gets fresh instances, in processes of their own";
const UNSTEADY: &str = "two runs of the first case differ, even with units in processes of their own: a unit goes by the time, by chance or by \
    memory that was not set, and these rows can't be made again";

/// Asks the units by themselves, and then with what they are used for: runs the first case, then the last one with the same
/// units; the last one with fresh units must give the same bits, and so must the first one. Which cases are compared depends on
/// the study alone, so that all parts of it are made alike.
///
/// # Errors
/// If even fresh units give other values than at first: rows would depend on what ran before them in this process.
pub(crate) fn probe(plan: &Plan) -> Result<Probed, Error> {
    let Some(last) = plan.cases().checked_sub(1).filter(|last| *last > 0) else {
        return Ok(Probed { reuse: true, note: None });
    };
    let units = plan.units();
    let mut used = plan.simulation(&units)?;
    let restores = used.restores();
    let first = trace(plan, &mut used, 0);
    let after = if restores { trace(plan, &mut used, last) } else { Ok(Vec::new()) };
    if first.is_err() || after.is_err() {
        // Units of a run that failed are replaced anyway.
        return Ok(note(plan, restores));
    }
    // Before others are made: some units can live only once in a process.
    drop(used);
    // What is loaded stays so meanwhile: a library that remembers shows it.
    let fresh = |case: u64| trace(plan, &mut plan.simulation(&units)?, case).map_err(Error::from);
    let reuse = restores && after.ok() == fresh(last).ok();
    match fresh(0) {
        Ok(again) if first.is_ok_and(|first| first != again) => match plan.is_isolated() {
            true => Ok(Probed { reuse: false, note: Some(UNSTEADY) }),
            false => Err(Error::Kept),
        },
        _ => Ok(note(plan, reuse)),
    }
}

fn note(plan: &Plan, reuse: bool) -> Probed {
    let words = if plan.is_isolated() { APART } else { FRESH };
    Probed { reuse, note: (!reuse).then_some(words) }
}

/// The bits of all recorded values.
fn trace(plan: &Plan, simulation: &mut Simulation, case: u64) -> Result<Vec<u64>, orchestrator::Error> {
    simulation.reset();
    plan.set(simulation, case)?;
    simulation.initialize()?;
    let mut bits = Vec::new();
    for _ in 0..POINTS {
        bits.push(simulation.time().to_bits());
        for cell in simulation.row().cells() {
            match cell {
                Cell::Real(value) => bits.push(value.to_bits()),
                Cell::Integer(value) => bits.push(value as u64),
                Cell::Boolean(value) => bits.push(u64::from(value)),
                Cell::String(text) => bits.extend(text.bytes().map(u64::from).chain([u64::MAX])),
            }
        }
        if simulation.advance()?.is_none() {
            break;
        }
    }
    Ok(bits)
}
