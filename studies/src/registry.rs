//! The list of studies, in the order of the paper.

use crate::Study;

/// Every study; a new one is a file and a line here.
pub const STUDIES: &[Study] = &[
    crate::open::dual_loop::STUDY,
    crate::diagrams::STUDY,
    crate::fields::STUDY,
    crate::defocus_mask::STUDY,
    crate::open::interlaced::STUDY,
    crate::open::frame_rates::STUDY,
    crate::dynamics::STUDY,
    crate::manifold::STUDY,
    crate::setup::STUDY,
    crate::quantisation::STUDY,
    crate::blur::STUDY,
    crate::photometry::STUDY,
    crate::lens_errors::STUDY,
    crate::table3::STUDY,
    crate::open::readings::STUDY,
    crate::composite::STUDY,
    crate::loop_values::STUDY,
    crate::tracking::STUDY,
    crate::open::chatter::STUDY,
    crate::delay::STUDY,
    crate::lens_loop::STUDY,
    crate::open::placement::STUDY,
    crate::torque_rate::STUDY,
    crate::open::estimators::STUDY,
    crate::compensation::STUDY,
    crate::compensated_loop::STUDY,
    crate::tuning::STUDY,
    crate::stability_map::STUDY,
];
