//! Export of FMI 2.0 co-simulation units from Rust.
//!
//! A unit is a [`Model`] whose variables are declared once, with [`variables!`] and [`table!`]. From that
//! declaration come the struct that the physics reads and writes, the value references, getters and setters,
//! `modelDescription.xml`, the GUID and the notation tables.

pub mod model;
pub mod table;
pub mod unit;

pub use model::{Dependencies, Description, Experiment, Log, LogCategory, Model, ModelError, Step};
pub use table::{Causality, Kind, Slot, SlotMut, Table, Variability, Variable};
pub use unit::Unit;

#[doc(hidden)]
pub use serde;
