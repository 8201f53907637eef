//! Speed beside what a user would pick instead: our side and the peers run in turns, so that a busy machine slows both
//! alike, and only ratios are concluded from. `scripts/bench.sh` runs all of it and writes `docs/speed.md`.
//!
//! Nothing here is product code: what can't be measured panics and says why.

pub mod closed_loop;
pub mod diagnosis;
pub mod estimator;
pub mod feedthrough;
pub mod frame;
pub mod isolated;
pub mod master;
pub mod page;
pub mod peer;
pub mod real;
pub mod ring;
pub mod samples;
pub mod sweep;

pub use page::Row;
pub use peer::Peer;
pub use samples::Samples;
