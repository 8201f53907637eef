//! What can be typed after `run`, and numbers that options take.

use clap::Args;
use orchestrator::limit_of;
use std::path::PathBuf;

/// `acroscope run`
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  acroscope run visual-servo\n  acroscope run visual-servo --set camera.k1=0.1 --stop 20\n  acroscope run my-scenario.toml --out out/mine\n  acroscope run my-scenario.toml --real-time"
)]
pub struct Run {
    /// A scenario file, a package (.ssp), or the name of a shipped scenario: visual-servo, full-state, dual-loop.
    pub scenario: String,
    /// Set a parameter or start value; may be given several times.
    #[arg(long = "set", value_name = "UNIT.VARIABLE=VALUE")]
    pub set: Vec<String>,
    /// Simulated time at which to stop, in s (a number or a fraction such as 1/3); the scenario's own if not given.
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub stop: Option<String>,
    /// Run every unit in a process of its own: whatever it does, the run comes to a clear end.
    #[arg(long)]
    pub isolate: bool,
    /// Seconds that a call into an isolated unit may take [default: 30].
    #[arg(long, value_name = "S", value_parser = above_zero)]
    pub step_limit: Option<f64>,
    /// Memory that the process of an isolated unit may have, in MiB [default: no limit].
    #[arg(long, value_name = "MIB", value_parser = clap::value_parser!(u64).range(1..1 << 40))]
    pub memory_limit: Option<u64>,
    /// Keep a checkpoint beside the results, a new one each S simulated seconds.
    #[arg(long, value_name = "S", value_parser = above_zero, allow_negative_numbers = true)]
    pub checkpoint: Option<f64>,
    /// Go on from the checkpoint of an earlier call with the same arguments, or begin if there is none.
    #[arg(long)]
    pub resume: bool,
    /// Write `results.mcap`, too: signals and frames for Foxglove, Rerun, PlotJuggler.
    #[arg(long)]
    pub mcap: bool,
    /// Write `results.parquet`, too: the table, with units and where it comes from in its metadata.
    #[arg(long)]
    pub parquet: bool,
    /// Keep to the real clock: FACTOR simulated seconds a second [1 if no FACTOR is given].
    #[arg(long, value_name = "FACTOR", num_args = 0..=1, default_missing_value = "1", value_parser = factor, allow_negative_numbers = true)]
    pub real_time: Option<f64>,
    /// Also say which start values gave way to connected outputs.
    #[arg(long, short)]
    pub verbose: bool,
    /// Folder for the results, made if it is missing [default: out/SCENARIO, with +NAME=VALUE for each change].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// A finite number, 0 or more.
///
/// # Errors
/// The text is none, in words.
pub fn zero_or_more(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|number| number.is_finite() && *number >= 0.0);
    number.ok_or_else(|| "wanted is a finite number, 0 or more".to_owned())
}

/// A number of seconds above 0 that a limit may have.
///
/// # Errors
/// The text is none, in words.
pub fn above_zero(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|seconds| limit_of(*seconds).is_some());
    number.ok_or_else(|| "wanted is a number of seconds above 0 and below 1e9".to_owned())
}

fn factor(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|number| *number > 0.0 && *number < 1e9);
    number.ok_or_else(|| {
        "wanted is a number above 0 and below 1e9: simulated seconds a second; without --real-time a run is as fast as it can be".to_owned()
    })
}
