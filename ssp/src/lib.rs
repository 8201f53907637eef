//! System Structure and Parameterization (SSP): packages in versions 1.0 and 2.0 as scenarios, and scenarios as packages
//! of version 1.0.
//!
//! ```no_run
//! use orchestrator::{Simulation, UnitPath};
//!
//! # fn main() -> Result<(), ssp::Error> {
//! let scenario = ssp::read("embrace.ssp".as_ref())?;
//! let simulation = Simulation::new(&scenario, &UnitPath::new())?;
//! std::fs::write("again.ssp", ssp::write(&simulation)?).expect("writable");
//! # Ok(())
//! # }
//! ```
//!
//! `read/` goes from documents to elements (`tree`), connections between variables of units (`wires`), parameter values
//! (`values`, `bindings`) and times (`timing`); `write/` the other way. What a scenario has and SSP lacks travels in
//! annotations (`annotation`), which other tools pass over. What can't be expressed is an error that names file, line and
//! element.

#![forbid(unsafe_code)]

mod annotation;
mod delays;
mod error;
mod read;
mod write;

pub use delays::{DELAY_UNIT, with_delay_units};
pub use error::Error;
pub use read::read;
pub use write::write;
