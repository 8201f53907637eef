//! Export of FMI 2.0 co-simulation units from Rust.
//!
//! A unit is a [`Model`] whose variables are declared once, with [`variables!`] and [`table!`]. From that
//! declaration come the struct that the physics reads and writes, the value references, getters and setters,
//! `modelDescription.xml`, the GUID and the notation tables. A shell crate of one line, [`export!`], makes the
//! shared library.
//!
//! ```
//! use fmi2_export::{Dependencies, Description, Experiment, Log, Model, ModelError, Step, unit, variables};
//! use serde::{Deserialize, Serialize};
//!
//! variables! {
//!     /// A mass that is pushed along a line.
//!     pub struct Variables {
//!         input force: f64 = 0.0, "F", "F", unit::ONE, "Force.";
//!         output speed: f64 = 0.0, "v", "v", unit::ONE, "Speed.";
//!         effect drag: f64 = 0.0, "b", "b", unit::ONE, "Viscous drag.", min = 0.0;
//!     }
//! }
//!
//! /// What it remembers from step to step, beside its variables.
//! #[derive(Clone, Default, Serialize, Deserialize)]
//! pub struct Mass;
//!
//! impl Model for Mass {
//!     type Variables = Variables;
//!
//!     fn description() -> Description {
//!         Description {
//!             identifier: "mass",
//!             description: "A mass of 1.",
//!             version: "1.0",
//!             stop_time: 10.0,
//!             step_size: 0.01,
//!             provides_derivatives: false,
//!             log_categories: &[],
//!         }
//!     }
//!
//!     fn dependencies(_output: &str) -> Dependencies {
//!         Dependencies { while_stepping: &[], at_start: Some(&[]) }
//!     }
//!
//!     fn initialize(&mut self, v: &mut Variables, _: &Experiment, _: &mut dyn Log) -> Result<(), ModelError> {
//!         v.speed = 0.0;
//!         Ok(())
//!     }
//!
//!     fn step(&mut self, v: &mut Variables, step: &Step<'_>, _: &mut dyn Log) -> Result<(), ModelError> {
//!         v.speed += (v.force - v.drag * v.speed) * step.size();
//!         Ok(())
//!     }
//! }
//!
//! // In the shell crate, a cdylib:
//! fmi2_export::export!(Mass);
//! # fn main() {
//! assert!(fmi2_export::description::Unit::of::<Mass>().mistakes().is_empty());
//! # }
//! ```
//!
//! From the model outwards: `table` and `model` are what a unit is written against; `instance`, `access` and
//! `saved` are an instance in safe Rust, held to the standard's calling sequence by `state_machine`;
//! `description` writes what the unit says of itself; [`abi`] is the C boundary, the only place with unsafe code
//! (besides the call of the log callback).

#![allow(unsafe_code)] // is called through the C functions of FMI

pub mod abi;
mod access;
pub mod description;
pub mod error;
mod instance;
pub mod logger;
pub mod model;
mod saved;
mod state_machine;
pub mod table;
pub mod unit;

pub use model::{Dependencies, Description, Experiment, Log, LogCategory, Model, ModelError, Step};
pub use table::{Causality, Kind, Slot, SlotMut, Table, Variability, Variable};
pub use unit::Unit;

#[doc(hidden)]
pub use serde;
