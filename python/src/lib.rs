//! Python's module `acroscope._acroscope`: a thin face, no physics and no algorithm. The package in `python/acroscope`
//! puts words, pictures and NumPy around it.
//!
//! Long work lets other threads of Python run, and looks for Ctrl-C (`interrupt.rs`).

mod errors;
mod interrupt;
mod recorder;
mod simulation;
mod table;
mod values;

use errors::told;
use orchestrator::Scenario;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use recorder::Columns;
use simulation::{Simulation, State};
use std::path::PathBuf;
use table::Table;

/// The command line: arguments without the program's name; answers the exit status.
#[pyfunction]
fn main(py: Python<'_>, arguments: Vec<String>) -> u8 {
    let arguments = std::iter::once("acroscope".to_owned()).chain(arguments).map(Into::into);
    let _guard = orchestrator::Guard::begin();
    py.detach(|| acroscope::command_line(arguments))
}

/// Serves a unit, or looks at a rule for units, and never returns, if this process was started for that; else says how such a process is started.
#[pyfunction]
fn host_units(py: Python<'_>, program: PathBuf, arguments: Vec<String>) {
    py.detach(|| {
        orchestrator::end_units_when(interrupt::came);
        acroscope::host_rules_by(program.clone(), arguments.clone());
        orchestrator::host_units_by(program, arguments);
    });
}

/// Names the folder in which the packed units lie.
#[pyfunction]
fn add_units(folder: PathBuf) {
    scenarios::add_units(folder);
}

/// Names of the shipped scenarios.
#[pyfunction]
fn shipped() -> Vec<&'static str> {
    scenarios::SHIPPED.iter().map(|(name, _)| *name).collect()
}

/// A scenario with values and a stop time, where given, and its units in processes of their own, if wanted, with a limit for each call.
fn load(
    name: &str,
    values: Option<&Bound<'_, PyDict>>,
    stop: Option<&str>,
    isolate: bool,
    step_limit: Option<f64>,
) -> PyResult<Scenario> {
    let mut scenario = scenarios::load(name).map_err(errors::input)?;
    for (variable, value) in values.into_iter().flatten() {
        scenario.set(&variable.extract::<String>()?, &values::text(&value)?).map_err(told)?;
    }
    if let Some(stop) = stop {
        scenario.set_stop(stop).map_err(told)?;
    }
    let limit = step_limit.map(|seconds| {
        let wrong = || format!("step_limit = {seconds}: wanted is a number of seconds above 0 and below 1e9");
        orchestrator::limit_of(seconds).ok_or_else(|| errors::input(wrong()))
    });
    let limit = limit.transpose()?;
    for unit in &mut scenario.units {
        if isolate {
            unit.isolation.get_or_insert_default();
        }
        if let (Some(isolation), Some(limit)) = (&mut unit.isolation, limit) {
            isolation.step_limit = limit;
        }
    }
    Ok(scenario)
}

/// Does `acroscope run` with these words, until Ctrl-C, and answers what it recorded and the graphs of its page as JSON.
#[pyfunction]
fn run(py: Python<'_>, words: Vec<String>) -> PyResult<(Table, String)> {
    let (ran, columns) = interrupt::apart(py, |watch| {
        let mut columns = Columns::default();
        let ran = acroscope::run(words.into_iter().map(Into::into), &mut columns, watch);
        (ran, columns)
    })?;
    let graphs = ran.map_err(|error| match error.exit_status() {
        2 => errors::input(error),
        _ => errors::other(error),
    })?;
    Ok((Table::new(columns)?, graphs))
}

/// The module.
#[pymodule]
fn _acroscope(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("Error", module.py().get_type::<errors::Error>())?;
    module.add("InputError", module.py().get_type::<errors::InputError>())?;
    module.add_class::<Table>()?;
    module.add_class::<Simulation>()?;
    module.add_class::<State>()?;
    module.add_function(wrap_pyfunction!(main, module)?)?;
    module.add_function(wrap_pyfunction!(host_units, module)?)?;
    module.add_function(wrap_pyfunction!(add_units, module)?)?;
    module.add_function(wrap_pyfunction!(shipped, module)?)?;
    module.add_function(wrap_pyfunction!(table::grey, module)?)?;
    module.add_function(wrap_pyfunction!(run, module)?)
}
