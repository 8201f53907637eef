//! A whole scenario as one FMI 2.0 co-simulation unit, for masters that know one rate and no delays.
//!
//! [`pack`] takes the blank unit (`acroscope_container.fmu`: the shared library of `container/fmu` and nothing else), and
//! puts a scenario with its units into its `resources/`. The library reads them there (`instance`), and steps the units
//! by the same orchestrator as `acroscope run`, so to the same bits. What the outside sees (`interface`) is derived from the
//! scenario alone, by the packer and by the library alike; the GUID is its checksum.
//!
//! `abi` is the C boundary; its functions get their C names in the shell.

pub mod abi;
mod error;
mod host;
mod instance;
mod interface;
mod pack;
mod saving;
mod state;
mod xml;

pub use error::Error;
pub use host::serve;
pub use instance::{Instance, Mode, Stepped};
pub use interface::{Interface, Variable};
pub use pack::{BLANK, pack};
