//! How far a run is.

use std::ops::ControlFlow;

/// What a run tells while it goes on.
pub trait Progress {
    /// The run begins; times in s.
    fn begin(&mut self, start: f64, stop: f64) {
        let _ = (start, stop);
    }

    /// Some ten to hundred times a second: simulated time in s and simulated over real time since the run began.
    /// `Break` ends the run there; what has been recorded stays.
    fn at(&mut self, time: f64, real_time_factor: f64) -> ControlFlow<()>;

    /// The run has ended, at this simulated time.
    fn end(&mut self, time: f64, real_time_factor: f64) {
        let _ = (time, real_time_factor);
    }
}

/// Nobody looks.
#[derive(Debug, Clone, Copy, Default)]
pub struct Quiet;

impl Progress for Quiet {
    fn at(&mut self, _: f64, _: f64) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}
