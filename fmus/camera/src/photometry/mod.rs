//! From outlines to grey levels: coverage, sensitivity, defocus, noise, quantisation.
//!
//! A frame is made in two layers. The *base* is what falls on the sensor, in 1/64 grey level as `i16`: a cached
//! background and, over it, the boxes around the circles, worked out in `f32`. The *picture* is the base plus noise,
//! rounded to whole grey levels. Every operator up to the base is local (the defocus reaches N pixels), so boxes
//! that are N pixels wider than the circles make the very frame that whole-frame processing would make.

pub mod coverage;
pub mod defocus;
pub mod edges;
pub mod frame;
pub mod noise;
pub mod plane;
pub mod quantise;
mod recent;
pub mod simd;
pub mod tails;

pub use coverage::{Area, Coverage};
pub use frame::{FrameMaker, Shot};
pub use plane::{Mask, Plane};

/// Parts of a grey level in the base.
pub const PARTS: f32 = 64.0;

/// A grey level in parts, rounded, within what the base can hold.
#[inline]
pub fn parts(grey: f32) -> i16 {
    let raised = grey * PARTS + 0.5;
    let most = f32::from(i16::MAX);
    // What is not a number is none of both, and becomes 0.
    let positive = if raised > 0.0 { raised } else { 0.0 };
    // All greys are nonnegative; a cast that saturates would not become vector code.
    edges::whole(edges::below(if positive < most { positive } else { most })) as i16
}
