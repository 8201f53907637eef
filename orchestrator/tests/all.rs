//! All tests of the crate in one program: each file linked on its own takes seconds.

mod again;
mod algorithms;
mod anew;
mod budget;
mod calls;
mod checkpoint;
mod common;
mod connections;
mod couplings;
mod ended;
mod errors;
mod exchanges;
mod failing;
mod hostile;
mod inside;
mod isolated;
mod killed;
mod large;
mod loops;
mod mapped;
mod orders;
mod readme;
mod scaled;
mod start;
mod tables;
mod types;
