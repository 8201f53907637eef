//! The list of studies, in the order of the paper.

use crate::Study;

/// Every study; a new one is a file and a line here.
pub const STUDIES: &[Study] = &[
    crate::tracking::STUDY,
    crate::delay::STUDY,
    crate::lens_loop::STUDY,
    crate::torque_rate::STUDY,
    crate::compensation::STUDY,
    crate::tuning::STUDY,
    crate::stability_map::STUDY,
];
