//! All tests of the crate in one program: each file linked on its own takes seconds.

mod book;
#[path = "../../orchestrator/tests/common/mod.rs"]
mod common;
mod formats;
mod help;
mod misbehave;
mod named_files;
mod noticed;
mod readme;
mod refused;
mod reproduce;
mod run;
mod signals;
mod tried;
