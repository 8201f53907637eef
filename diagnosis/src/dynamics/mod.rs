//! The machine under diagnosis as a function: one interval of the log, through FMI.
//!
//! (state, θ, inputs) ── units ──▶ (next state, outputs), with sensitivities by differences. A state is set through its
//! start parameter and read back through the variable that shows it; between them the units are reset and initialised.
//!
//! - `machine.rs`: which variables of which units are states, inputs, channels and parameters
//! - `port_parameters.rs`: effects at ports as parameters of the machine
//! - `worker.rs`: instances of the units, and one interval on them
//! - `grid.rs`: the rows of a run and its values
//! - `schedule.rs`: what is fed and read within each interval, after the effects at ports
//! - `linearise.rs`: differences, many rows at once on all threads
//! - `assemble.rs`: a linearised run of these differences
//! - `build.rs`: from a problem to an engine: sizes of states and inputs, noises to begin with
//! - `probe.rs`: what the units can do, tried on the first run
//! - `parameter_steps.rs`: over what steps of a parameter a difference is a derivative
//! - `refused_values.rs`: values with which a unit can't be run
//! - `linearise_for_fit.rs`: the engine as what a fit linearises
//! - `outliers.rs`: outliers
//! - `scales.rs`: sizes of what no log tells
//! - `stretch.rs`: how well the units follow stretches of the logs, from the best start state of each
//! - `read_through.rs`: states that no variable shows, read through the outputs that follow
//! - `clock.rs`: units that begin at 0 whatever start time they are told
//! - `memory.rs`: whether a unit remembers more than the states that can be set
//! - `whole_runs.rs`: units that nothing can start within a run
//! - `lag.rs`, `lag_begin.rs`: a sensor's lag, one more state, and where it begins
//! - `input_begin.rs`: what an input's lag held when the log began
//! - `at_once.rs`: outputs that follow an input without a state between them
//! - `interval.rs`: one interval about a state, with its derivatives
//! - `first_path.rs`: a path to begin with, by an extended Kalman filter
//! - `policy.rs`: the numbers that decide, with their reasons

mod assemble;
mod at_once;
pub mod build;
mod clock;
pub mod first_path;
pub mod grid;
mod growth;
mod input_begin;
mod interval;
mod lag;
mod lag_begin;
pub mod linearise;
mod linearise_for_fit;
pub mod machine;
pub mod memory;
mod outliers;
mod parameter_steps;
mod policy;
mod port_parameters;
mod probe;
mod read_through;
mod refused_values;
mod scales;
pub mod schedule;
pub mod stretch;
#[cfg(test)]
pub(crate) mod tests;
mod whole_runs;
pub mod worker;

/// What a sensor with a delay and a lag makes of values at times.
pub fn sensed(time: &[f64], values: &[f64], delay: f64, lag: f64) -> Vec<f64> {
    let late = lag::delayed(time, values, values, delay);
    lag::lagged(time, &late, &late, lag)
}

/// Whether nothing lags at a port for these parameters: then a run has the states of the units and no others.
pub fn plain(machine: &Machine, theta: &[f64]) -> bool {
    lag::active(machine, theta).is_empty() && input_begin::lagging(machine, theta).is_empty()
}

pub use linearise::Engine;
pub use machine::Machine;
