//! From a frame to the state (Section 3.2): label the thresholded frame, select regions by area, find their centres
//! (the binary centroid, or one of the other estimators), say which is which circle, and read the state off them.

pub mod centroid;
pub mod correspondence;
pub mod estimator;
pub mod finder;
pub mod grey;
pub mod label;
pub mod likelihood;
pub mod select;
pub mod state;

pub use centroid::Feature;
pub use estimator::{Estimators, View};
pub use finder::Finder;
pub use label::{Component, Labeller};
pub use state::{Estimate, Tracker};
