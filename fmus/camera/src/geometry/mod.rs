//! From the world to the picture: pinhole behind its mounting, lens, sensor placement, and a circle's outline.

pub mod fold;
pub mod outline;
pub mod projection;

pub use outline::{Outline, STRIPS, UnitCircle};
pub use projection::Projection;
