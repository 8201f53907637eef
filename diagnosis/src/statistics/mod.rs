//! Statistics that know nothing of robots: projection, tests, random signs.

mod basis;
pub mod bootstrap;
pub mod levels;
pub mod linear;
pub mod median;
pub mod normal;
pub mod products;
pub mod random;
pub mod squares;
