//! The master: runs FMI 2.0 co-simulation units that a scenario connects, each with its own communication interval
//! on exact rational time. It knows no model by name.
//!
//! ```no_run
//! use orchestrator::{CsvRecorder, MemoryRecorder, Quiet, Scenario, Simulation, UnitPath};
//!
//! # fn main() -> Result<(), orchestrator::Error> {
//! let units = UnitPath::new().with("target/fmus");
//! let mut scenario = Scenario::load("scenarios/visual-servo.toml")?;
//! scenario.set("camera.k1", "0.1")?;
//! let mut simulation = Simulation::new(&scenario, &units)?;
//!
//! // To a file, streaming.
//! simulation.run(&mut CsvRecorder::create("results.csv")?, &mut Quiet)?;
//! std::fs::write("resolved.toml", simulation.resolved()).expect("writable");
//!
//! // Again with another value, to memory; the units are reused.
//! let mut results = MemoryRecorder::new();
//! simulation.set("camera.k1", 0.2)?;
//! simulation.run(&mut results, &mut Quiet)?;
//! let q1 = results.series("plant.q1")?;
//! println!("{} rows, last q1 = {:?}", results.times().len(), q1.last());
//!
//! // Step by step.
//! simulation.reset();
//! simulation.advance_to(0.5)?;
//! println!("q1 = {} at {} s", simulation.value("plant.q1")?, simulation.time());
//! # Ok(())
//! # }
//! ```
//!
//! One unit by itself, and what it says of itself:
//!
//! ```no_run
//! use orchestrator::fmu::{Causality, Fmu};
//!
//! # fn main() -> Result<(), orchestrator::Error> {
//! let fmu = Fmu::open("target/fmus/acrobot_plant.fmu")?;
//! for variable in fmu.description().variables.iter().filter(|v| v.causality == Causality::Output) {
//!     println!("{} in {:?}: {}", variable.name, variable.unit, variable.description);
//! }
//! let mut instance = fmu.instantiate("plant")?;
//! instance.setup_experiment(0.0, None)?;
//! instance.enter_initialization()?;
//! instance.exit_initialization()?;
//! assert_eq!(instance.do_step(0.0, 1e-3, true), orchestrator::fmu::Status::Ok);
//! # Ok(())
//! # }
//! ```
//!
//! # What a run does
//!
//! All times are whole multiples of one exact tick ([`time`]). A unit with interval h steps from start + k·h to
//! start + (k+1)·h; it gets the doubles nearest to the exact begin and interval, as `float(Fraction)` gives them in
//! Python. A unit whose interval doesn't divide the run takes a shorter last step to the stop, if its description says
//! that its steps may differ; else it ends at its last point before the stop. Either is among the notices.
//! At each point the master algorithm ([`scenario::Scenario::algorithm`]) steps the units that are due. With
//! Gauss-Seidel, inputs and sources are those at the end of the step; with Jacobi those at its begin. In neither does
//! a unit get a value that is later than the point, or that does not exist yet. A delayed connection delivers, exactly
//! its delay later, what its output was; until the first value has come, the input keeps its start value.
//!
//! A row is recorded at each point of any unit. An input's value in a row is the one that the unit used for its last
//! step (with Jacobi, between the points of a slow unit, the one it uses for the step under way).
//!
//! A warning is counted and the run goes on ([`Simulation::notices`]); a discarded step, an error, an unknown status,
//! or a NaN or infinity for another unit ends it with an error that names unit, variable and time.

#![allow(unsafe_code)] // calls C functions of units, shares memory with their processes

//!
//! A unit can have a process of its own ([`Isolation`]); a program that allows it begins its `main` with [`host_units`]. For
//! one that runs units in its own process, [`Guard`] says which unit took it down, and saves its rows.

mod algorithm;
#[cfg(test)]
mod alone;
mod blocks;
mod bundle;
mod checkpoint;
mod differences;
mod error;
pub mod fmu;
mod graph;
mod guard;
mod initialise;
mod inside;
mod isolation;
mod line;
mod link;
pub mod machine;
mod newton;
mod noise;
mod notices;
mod pacing;
pub mod package;
pub mod plain;
mod progress;
mod recorder;
mod resolved;
mod rollback;
mod run;
pub mod scenario;
mod simulation;
mod source;
pub mod suggest;
mod system;
mod text;
pub mod time;
pub mod timing;
mod unit_path;
mod unread;
mod value;
mod wiring;
mod words;
pub mod xml;

pub use algorithm::{Needs, Sees, along, names as algorithms, needs, sees};
pub use bundle::Bundle;
pub use checkpoint::{Checkpoint, Checkpoints};
pub use error::{Error, Place, PostMortem};
pub use fmu::Fmu;
pub use guard::{FileMask, Guard, all_done, beat, beats, give_up, look_out, not_back};
#[cfg(unix)]
pub use guard::{exit_at_once, own_output};
pub use isolation::{Host, Isolation, end_units_when, host_units, host_units_by, limit_of, serve_units};
pub use pacing::Lateness;
pub use progress::{Progress, Quiet};
#[doc(hidden)]
pub use recorder::Waiting;
pub use recorder::{Cell, Column, CsvRecorder, MemoryRecorder, NoRecorder, Position, Recorder, Row, Twice};
pub use run::{Comparison, Ended};
pub use scenario::Scenario;
pub use simulation::Simulation;
pub use source::smooth_step;
pub use suggest::nearest;
pub use unit_path::UnitPath;
pub use value::{Kind, Value};

/// The README's program is compiled.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
