//! Finds where simulation and measured data disagree, and names the effect that the model lacks.

pub mod bench;
pub mod candidates;
pub mod dataset;
mod error;
pub mod model;
pub mod residual;
pub mod selection;
pub mod statistics;

pub use error::{Error, Notice};
