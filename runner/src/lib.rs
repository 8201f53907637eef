//! `acroscope run`: one scenario from start to stop, its folder of results and its report; and what all commands share: folders, signals,
//! where a result comes from.
//!
//! A crate of its own, with a program of its own, so that a fresh machine compiles no diagnosis and no sweep before the first run.

#![forbid(unsafe_code)]

mod bar;
pub mod cli;
mod error;
pub mod folder;
pub mod provenance;
pub mod request;
mod results;
mod run;
mod run_report;
pub mod signals;
pub mod tell;

pub use error::Error;
pub use run::{CarriedOut, Formats, Ran, carry_out, run};
pub use run_report::{Layout, PictureEntry, pictures};
