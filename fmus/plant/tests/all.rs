//! All tests of the crate in one program: each file linked on its own takes seconds.

mod alone;
mod commands;
mod common;
mod derivatives;
mod free;
mod law;
mod unit;
mod value;
