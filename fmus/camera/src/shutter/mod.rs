//! When a frame is exposed, which poses it sees, and when its result is delivered.

pub mod clock;
pub mod delivery;
pub mod exposure;
pub mod history;

pub use clock::FrameClock;
pub use delivery::{Delivery, Queue};
pub use history::{History, Segment};
