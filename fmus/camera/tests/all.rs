//! All tests of the crate in one program: each file linked on its own takes seconds.

mod boxes;
mod common;
mod correspondence;
mod coverage;
mod effects;
mod estimators;
mod exposure;
mod geometry;
mod identified;
mod likelihood;
mod limits;
mod noise;
mod outline;
mod paper;
mod parts;
mod polygons;
mod quantise;
mod recorded;
mod regions;
mod shutter;
mod tails;
mod unit;
