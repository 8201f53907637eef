//! The progress bar: simulated time and real-time factor, on a terminal only.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use orchestrator::Progress;
use std::io::IsTerminal as _;
use std::ops::ControlFlow;

/// Steps of the bar per simulated second.
const RESOLUTION: f64 = 1000.0;

/// Shows how far a run is.
pub struct Bar {
    bar: ProgressBar,
    start: f64,
    /// Simulated over real time of the whole run, once it has ended.
    pub real_time_factor: Option<f64>,
}

impl Bar {
    /// A bar; it stays hidden when `quiet` or when nobody looks at a terminal.
    pub fn new(quiet: bool) -> Self {
        let hidden = quiet || !std::io::stderr().is_terminal();
        let target = if hidden { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(0), target);
        // The template is a constant; were it wrong, indicatif's own style would do.
        if let Ok(style) = ProgressStyle::with_template("{bar:32} {msg} {eta}") {
            bar.set_style(style);
        }
        Self { bar, start: 0.0, real_time_factor: None }
    }
}

impl Progress for Bar {
    fn begin(&mut self, start: f64, stop: f64) {
        self.start = start;
        self.bar.set_length(((stop - start) * RESOLUTION) as u64);
    }

    fn at(&mut self, time: f64, real_time_factor: f64) -> ControlFlow<()> {
        self.bar.set_position(((time - self.start) * RESOLUTION) as u64);
        self.bar.set_message(format!("{time:.1} s simulated, {real_time_factor:.0} x real time"));
        if crate::signals::caught().is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn end(&mut self, _: f64, real_time_factor: f64) {
        self.bar.finish_and_clear();
        self.real_time_factor = Some(real_time_factor);
    }
}
