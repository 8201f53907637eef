//! What the tests of this crate look into. No part of its face: it may change at any time.

pub use crate::infer::fit::{Linearise, Options as FitOptions, Path};
pub use crate::infer::gradient::gradient;
pub use crate::infer::likelihood::{profile, reduced};
pub use crate::infer::robust::sandwich;
pub use crate::infer::sweep::{sweep, sweep_columns};
pub use crate::infer::{At, Disturbance, Linearised, Measured, Noise, Sizes, fit, maximise, smooth};
pub use crate::observe::{Hold, InputEffect, Ports, Problem, Role, Scale, load as load_problem};
pub use crate::search::Policy;
pub use crate::statistics::bootstrap::{Null, Scores};
pub use crate::statistics::linear::{Cell, Sized, nuisances, reduce};
pub use crate::statistics::random::Random;
