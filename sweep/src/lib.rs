//! Many runs of one scenario: a study says which values, and which numbers of each run are kept; the answer is a Parquet
//! data set with a row for each case, whose parts can be made on any number of machines.
//!
//! Read [`sweep`] first: it looks which parts are there (`parts`), hands the cases of the others to threads
//! (`pool`), each with units of its own that are used again (`worker`), and writes their rows in order (`data`).
//!
//! ```no_run
//! use sweep::{Limits, Options, Plan, Silent, Study};
//!
//! # fn main() -> Result<(), sweep::Error> {
//! let study = Study::load("delay-and-rate")?;
//! let plan = Plan::new(&study, &scenarios::unit_path(), &Limits::default())?;
//! let done = sweep::sweep(&plan, &Options::new("out/map"), &Silent)?;
//! println!("{} cases, {} of them failed", done.cases, done.failed);
//! # Ok(())
//! # }
//! ```
//!
//! The same study and the same units give the same rows, whatever the number of threads and of parts.

#![forbid(unsafe_code)]

mod data;
mod design;
mod error;
mod page;
mod parts;
mod plan;
mod pool;
mod probe;
mod record;
mod scalar;
mod study;
mod sweep;
mod worker;

pub use error::Error;
pub use plan::Plan;
pub use report::tally::{Reduce, Tally, Test};
pub use scalar::Scalar;
pub use study::{SHIPPED, Study, Words};
pub use sweep::{Done, Limits, Options, Silent, Watch, sweep};
