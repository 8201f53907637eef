//! From a frame to the state (Section 3.2): threshold, label, select by area, centroid, correspondence, state.

pub mod centroid;
pub mod correspondence;
pub mod label;
pub mod select;
pub mod state;

pub use centroid::Feature;
pub use label::{Component, Labeller};
pub use state::{Estimate, Tracker};
