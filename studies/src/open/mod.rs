//! What the paper asks or leaves open, measured: each file a study whose rows are measurements of ours.

pub(crate) mod chatter;
pub(crate) mod dual_loop;
pub(crate) mod estimators;
pub(crate) mod frame_rates;
pub(crate) mod interlaced;
pub(crate) mod placement;
pub(crate) mod readings;

use crate::closed_loop::Trace;

/// Time between frames at 30 Hz, s.
const PERIOD: f64 = 1.0 / 30.0;
/// Seconds of the reference of Section 4.2 in which it rests at z = 0.5, s.
const AT_REST: (f64, f64) = (15.0, 18.0);
/// End of that reference, s.
const END: f64 = 60.0;

/// Rms step of the torque between frames over a whole run and at rest at z = 0.5, N·m.
fn chatter(trace: &Trace) -> [f64; 2] {
    [trace.chatter(PERIOD, 0.0, END), trace.chatter(PERIOD, AT_REST.0, AT_REST.1)]
}

/// A torque in N·m with as many digits as it has.
fn newton_metres(value: f64) -> String {
    if value < 1e-3 { format!("{value:.1e}") } else { format!("{value:.4}") }
}
