//! What the master adds at ports by itself, without a parameter of any unit: the effects of `signal_effects.fmu`, in its
//! order (delay, saturation, rate limit, lag, gain, bias), between the log and an input, or between an output and its log.
//!
//! - `kinds.rs`: what there is to know of each kind of effect
//! - `course.rs`: an input over time, as logged
//! - `input.rs`: the course of an input after its effects, in closed form
//! - `output.rs`: gain, offset, drift and delay of a measured value; a lag is one more state
//! - `policy.rs`: the numbers that decide, with their reasons

mod course;
pub mod input;
mod kinds;
pub mod output;
mod policy;

pub use course::Course;
pub use kinds::{Kind, Measure, measures};
pub(crate) use policy::PORTS;
