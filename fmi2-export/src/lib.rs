//! Export of FMI 2.0 co-simulation units from Rust.
//!
//! A unit is a [`Model`] whose variables are declared once, with [`variables!`] and [`table!`]. From that
//! declaration come the struct that the physics reads and writes, the value references, getters and setters,
//! `modelDescription.xml`, the GUID and the notation tables. A shell crate of one line, [`export!`], makes the
//! shared library.
//!
//! From the model outwards: `table` and `model` are what a unit is written against; `instance`, `access` and
//! `saved` are an instance in safe Rust, held to the standard's calling sequence by `state_machine`;
//! `description` writes what the unit says of itself; [`abi`] is the C boundary, the only place with unsafe code
//! (besides the call of the log callback).

pub mod abi;
mod access;
pub mod description;
mod error;
mod instance;
mod logger;
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
