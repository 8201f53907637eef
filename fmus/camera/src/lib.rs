//! The camera unit of Sections 2 and 3.2: it renders frames of the acrobot and estimates its state from them.
//!
//! Rooms along the path of the light: [`scene`] (where the circles are), [`geometry`] (world to picture),
//! [`effects`] (one file per lens or sensor effect), [`photometry`] (coverage to grey levels), [`shutter`] (which
//! poses a frame sees, and when its result is delivered) and [`vision`] (from a frame to the state). [`Camera`] is
//! the unit, [`variables`] its FMI variables, [`recorded`] the vision alone, for frames of a real camera.
//!
//! # Picture coordinates
//! Image plane: u to the right, v up, −1..1 across the picture. Pixels: `u_px = width/2 · u`, `v_px = height/2 · v`,
//! the origin at the centre of the picture. Pixel (column 0, row 0) is the upper left one: its area is
//! −width/2 ≤ u_px ≤ −width/2 + 1, height/2 − 1 ≤ v_px ≤ height/2, its centre half a pixel inside.

pub mod effects;
pub mod geometry;
pub mod photometry;
pub mod recorded;
mod recording;
pub mod scene;
pub mod shutter;
mod unit;
pub mod variables;
pub mod vision;

pub use unit::Camera;
pub use variables::Variables;
