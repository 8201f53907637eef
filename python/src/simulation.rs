//! A scenario step by step, for controllers and experiments written in Python.

use crate::errors::{self, told};
use crate::interrupt::here;
use crate::values::{to_python, value};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A built scenario.
#[pyclass(frozen, module = "acroscope._acroscope")]
pub struct Simulation {
    inner: Mutex<orchestrator::Simulation>,
}

impl Simulation {
    fn lock(&self) -> MutexGuard<'_, orchestrator::Simulation> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A saved state of a simulation.
#[pyclass(frozen, module = "acroscope._acroscope")]
pub struct State {
    inner: orchestrator::Checkpoint,
}

#[pymethods]
impl State {
    /// Simulated time in s.
    #[getter]
    fn time(&self) -> f64 {
        self.inner.time()
    }

    fn __repr__(&self) -> String {
        format!("<State at {} s>", self.inner.time())
    }
}

#[pymethods]
impl Simulation {
    #[new]
    #[pyo3(signature = (scenario, values = None, stop = None, inputs = Vec::new(), isolate = false, step_limit = None))]
    fn new(
        py: Python<'_>,
        scenario: &str,
        values: Option<&Bound<'_, PyDict>>,
        stop: Option<&str>,
        inputs: Vec<String>,
        isolate: bool,
        step_limit: Option<f64>,
    ) -> PyResult<Self> {
        let mut scenario = crate::load(scenario, values, stop, isolate, step_limit)?;
        for input in &inputs {
            scenario.release(input).map_err(told)?;
        }
        let built = here(py, || orchestrator::Simulation::new(&scenario, &scenarios::unit_path()))?;
        Ok(Self { inner: Mutex::new(built) })
    }

    /// Simulated time in s.
    #[getter]
    fn time(&self, py: Python<'_>) -> f64 {
        py.detach(|| self.lock().time())
    }

    /// Gives `unit.variable` a value.
    fn set(&self, py: Python<'_>, name: &str, given: &Bound<'_, PyAny>) -> PyResult<()> {
        let given = value(given)?;
        here(py, || self.lock().set(name, given))
    }

    /// The value of `unit.variable` now.
    fn get<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let found = here(py, || self.lock().get(name))?;
        to_python(py, found)
    }

    /// On to the next communication point; its time, or `None` at the end.
    fn step(&self, py: Python<'_>) -> PyResult<Option<f64>> {
        py.check_signals()?;
        here(py, || self.lock().advance())
    }

    /// On to the last communication point that is not later than a time, and the time then, or `None` if it was at the end
    /// already; looks for Ctrl-C every simulated 0.1 s.
    fn advance_to(&self, py: Python<'_>, until: f64) -> PyResult<Option<f64>> {
        const LOOK: f64 = 0.1;
        let next = || here(py, || self.lock().next_point());
        let now = || py.detach(|| self.lock().time());
        if until.is_nan() || until < now() {
            let what = format!("until = {until}: a time in s that is not before the time now, {} s", now());
            return Err(errors::input(what));
        }
        if next()?.is_none() {
            return Ok(None);
        }
        while let Some(point) = next()?.filter(|point| *point <= until) {
            py.check_signals()?;
            let look = until.min(point.max(now() + LOOK));
            here(py, || self.lock().advance_to(look))?;
        }
        Ok(Some(now()))
    }

    /// The state now.
    fn save(&self, py: Python<'_>) -> PyResult<State> {
        let inner = here(py, || self.lock().save())?;
        Ok(State { inner })
    }

    /// Back to a saved state.
    fn restore(&self, py: Python<'_>, state: &Bound<'_, State>) -> PyResult<()> {
        let state = &state.get().inner;
        here(py, || self.lock().go_back(state))
    }

    /// Back to before the start; values set before the run stay.
    fn reset(&self, py: Python<'_>) {
        py.detach(|| self.lock().reset());
    }

    /// The scenario with every value that is used, as TOML.
    #[getter]
    fn resolved(&self) -> String {
        self.lock().resolved()
    }

    /// What a person should know, but what stops nothing.
    #[getter]
    fn notices(&self) -> Vec<String> {
        self.lock().notices()
    }
}
