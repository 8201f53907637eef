//! How commands call units that nobody may have run before.

use clap::Args;
use orchestrator::Isolation;
use runner::cli::above_zero;
use std::time::Duration;

/// Options of commands that call units many times over.
#[derive(Debug, Args)]
pub struct Called {
    /// Run every unit in a process of its own: one that crashes or hangs ends the command with what it did; several times slower.
    #[arg(long)]
    pub isolate: bool,
    /// Seconds that a call into a unit may take, with --isolate or without [default: 30].
    #[arg(long, value_name = "S", value_parser = above_zero)]
    pub step_limit: Option<f64>,
}

impl Called {
    /// Processes of their own, if that was asked for.
    pub fn isolation(&self) -> Option<Isolation> {
        self.isolate.then(|| self.limited())
    }

    /// The limits of a unit that has one.
    pub fn limited(&self) -> Isolation {
        let usual = Isolation::default();
        let step_limit = self.step_limit.map_or(usual.step_limit, Duration::from_secs_f64);
        Isolation { step_limit, ..usual }
    }

    /// From now on the program ends with an error where a unit in its own process doesn't come back from a call.
    pub fn look_out(&self) {
        let limit = self.limited().step_limit;
        orchestrator::look_out(limit, move |unit, function| {
            runner::signals::end_with_error(&format!(
                "unit {unit}: it does not come back from {function} within {} s; --step-limit gives a slow unit more time, and in a process of its \
                 own (--isolate) it would tell more",
                limit.as_secs_f64()
            ));
        });
    }
}
