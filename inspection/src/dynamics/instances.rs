//! Instances know nothing of each other, and an instance that was reset is a new one (FMI 2.0.4 sections 2.1.5 and 4.2.4).

use super::bench::{Bench, Halt, STEPS, Subject, difference, moved};
use super::start;
use crate::Severity;
use crate::finding::Found;
use orchestrator::Value;
use orchestrator::fmu::{Causality, Instance, Variability};

type Rows = Vec<Vec<Value>>;

/// The outputs of an instance that is alone.
fn alone(bench: &Bench, name: &str, amplitude: f64) -> Result<Rows, Halt> {
    let mut unit = bench.started(name)?;
    unit.amplitude = amplitude;
    unit.trace(0..STEPS)
}

/// Says where two runs differ.
fn compare(bench: &Bench, one: &Rows, other: &Rows, what: &str, found: &mut Found) -> bool {
    let Some((step, output, a, b)) = difference(&bench.outputs(), one, other) else { return false };
    found.say(
        Severity::Error,
        Some(&output.name),
        format!("{what}: in step {} it is {b}, not {a}", step + 1),
    );
    true
}

pub(super) fn reset(bench: &Bench, found: &mut Found) -> Result<(), Halt> {
    let fresh = alone(bench, "fresh", 1.0)?;
    let mut unit = bench.instance("used")?;
    unit.amplitude = 2.0;
    // What follows may refuse these values; the reset must work anyway.
    let _ = disturbed(bench, &mut unit);
    unit.call("fmi2Reset", Instance::reset_itself)?;
    unit.amplitude = 1.0;
    unit.set_up()?;
    start::compare(bench, &mut unit, " after fmi2Reset", found)?;
    unit.exit_initialization()?;
    let again = unit.trace(0..STEPS)?;
    compare(bench, &fresh, &again, "after fmi2Reset it does not run as a new instance", found);
    Ok(())
}

/// A run with other parameters.
fn disturbed(bench: &Bench, unit: &mut Subject<'_>) -> Result<(), Halt> {
    for variable in bench.variables(Causality::Parameter) {
        let Some(start) = variable.start.as_ref().filter(|_| variable.variability != Variability::Constant)
        else {
            continue;
        };
        if let Some(value) = moved(variable, start) {
            unit.set(variable, &value)?;
        }
    }
    unit.set_up()?;
    unit.exit_initialization()?;
    unit.trace(0..STEPS / 2).map(|_| ())
}

pub(super) fn several(bench: &Bench, found: &mut Found) -> Result<(), Halt> {
    if bench.description().co_simulation.only_one_instance {
        return Ok(());
    }
    let first = alone(bench, "first", 1.0)?;
    let second = alone(bench, "second", 1.0)?;
    if compare(bench, &first, &second, "a second instance, after the first was freed, runs otherwise", found)
    {
        return Ok(());
    }
    let other = alone(bench, "third", 2.0)?;
    let mut units = [bench.started("left")?, bench.started("right")?];
    units[1].amplitude = 2.0;
    let outputs = bench.outputs();
    let mut rows = [Vec::new(), Vec::new()];
    for k in 0..STEPS {
        for unit in &mut units {
            unit.advance(k)?;
        }
        for (unit, rows) in units.iter_mut().zip(&mut rows) {
            rows.push(unit.read(&outputs)?);
        }
    }
    let what = "two instances, stepped in turn, disturb each other";
    let _ = compare(bench, &first, &rows[0], what, found) || compare(bench, &other, &rows[1], what, found);
    // Freed in the order in which they were made, the second goes on without the first.
    let [left, mut right] = units;
    drop(left);
    right.advance(STEPS)?;
    right.read(&outputs)?;
    Ok(())
}

/// So many threads, each with its own instances.
const THREADS: u32 = 4;
/// Runs of each thread: what two threads do to each other shows only sometimes.
const RUNS: usize = 5;

pub(super) fn threads(bench: &Bench, found: &mut Found) -> Result<(), Halt> {
    if bench.description().co_simulation.only_one_instance {
        return Ok(());
    }
    let amplitudes: Vec<f64> = (1..=THREADS).map(f64::from).collect();
    let alone: Vec<Rows> =
        amplitudes.iter().map(|amplitude| alone(bench, "alone", *amplitude)).collect::<Result<_, _>>()?;
    super::worker::say_call(&format!("calls from {THREADS} threads, each with its own instance,"));
    let run = |amplitude: f64| -> Result<Rows, Halt> {
        let mut unit = bench.started("threaded")?;
        (unit.loud, unit.amplitude) = (false, amplitude);
        unit.trace(0..STEPS)
    };
    let together: Vec<Result<Vec<Rows>, Halt>> = std::thread::scope(|scope| {
        let threads: Vec<_> = amplitudes
            .iter()
            .map(|amplitude| scope.spawn(|| (0..RUNS).map(|_| run(*amplitude)).collect()))
            .collect();
        threads.into_iter().map(|thread| thread.join().unwrap_or(Err(Halt::Ended))).collect()
    });
    for (alone, together) in alone.iter().zip(together) {
        for rows in together? {
            let what =
                format!("{THREADS} instances, stepped by {THREADS} threads at once, disturb each other");
            if compare(bench, alone, &rows, &what, found) {
                return Ok(());
            }
        }
    }
    Ok(())
}
