//! Whether units may be used for one run after the other: whether after `fmi2Reset` they do what fresh ones do. A unit that
//! keeps something over a reset is found here, and gets fresh instances for every case.

use crate::error::Error;
use crate::plan::Plan;
use orchestrator::{Cell, Simulation};

/// Points that are compared: what a unit keeps shows soon, and this costs nothing beside a sweep.
const POINTS: u32 = 1000;

/// Asks the units by themselves, and then with what they are used for: runs the first case, then the last one with the same
/// units; the last one with fresh units must give the same bits. Which cases are compared depends on the study alone, so that
/// all parts of it are made alike.
pub(crate) fn may_reuse(plan: &Plan) -> Result<bool, Error> {
    let Some(last) = plan.cases().checked_sub(1).filter(|last| *last > 0) else { return Ok(true) };
    let units = plan.units();
    let mut used = plan.simulation(&units)?;
    if !used.restores() {
        return Ok(false);
    }
    let first = trace(plan, &mut used, 0);
    let after = trace(plan, &mut used, last);
    if first.is_err() || after.is_err() {
        // Units of a run that failed are replaced anyway.
        return Ok(true);
    }
    let fresh = trace(plan, &mut plan.simulation(&plan.units())?, last);
    Ok(after.ok() == fresh.ok())
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
