//! What can be typed.

use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

/// Co-simulation bench for visual servoing: an acrobot balanced by what a camera sees.
#[derive(Debug, Parser)]
#[command(name = "acroscope", version, propagate_version = true)]
pub struct Arguments {
    /// Print errors only.
    #[arg(long, short, global = true)]
    pub quiet: bool,
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

fn zero_or_more(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|number| number.is_finite() && *number >= 0.0);
    number.ok_or_else(|| "wanted is a finite number, 0 or more".to_owned())
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a scenario: writes results.csv, resolved.toml and report.html.
    Run(Run),
    /// Reproduce the paper's tables, figures and claims: writes claims.json and index.html.
    Reproduce(Reproduce),
    /// Find what a model lacks against measured data: writes diagnosis.json, amended.toml and report.html.
    Diagnose(Diagnose),
    /// Turn finished runs into a measured data set, to rehearse a diagnosis.
    Record(Record),
}

/// `acroscope run`
#[derive(Debug, Args)]
pub struct Run {
    /// A scenario file, or the name of a shipped one: visual-servo, full-state.
    pub scenario: String,
    /// Set a parameter or start value; may be given several times.
    #[arg(long = "set", value_name = "UNIT.VARIABLE=VALUE")]
    pub set: Vec<String>,
    /// Simulated time at which to stop, in s (a number or a fraction such as 1/3); the scenario's own if not given.
    #[arg(long, value_name = "T")]
    pub stop: Option<String>,
    /// Also say which start values gave way to connected outputs.
    #[arg(long, short)]
    pub verbose: bool,
    /// Folder for the results, made if it is missing [default: out/SCENARIO].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// `acroscope reproduce`
#[derive(Debug, Args)]
pub struct Reproduce {
    /// Studies, or claims that they decide: table-3, C25, ...; all if none is given.
    #[arg(value_name = "ID")]
    pub ids: Vec<String>,
    /// Folder for the results, made if it is missing [default: out/reproduce].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// `acroscope diagnose`
#[derive(Debug, Args)]
pub struct Diagnose {
    /// Folder of the data set: dataset.toml and a folder for each run.
    pub dataset: PathBuf,
    /// An effect that is not to be named; may be given several times.
    #[arg(long, value_name = "UNIT.VARIABLE")]
    pub without: Vec<String>,
    /// Folder of an earlier diagnosis of the same machine, before an experiment: what it told apart counts, too.
    #[arg(long, value_name = "DIR")]
    pub after: Option<PathBuf>,
    /// Folder for the results, made if it is missing [default: out/diagnose-DATASET].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// `acroscope record`
#[derive(Debug, Args)]
pub struct Record {
    /// Folders of finished runs, each with a results.csv.
    #[arg(required = true, value_name = "RUN")]
    pub runs: Vec<PathBuf>,
    /// The nominal scenario, without the hidden effect: the name of a shipped one, or a path.
    #[arg(long, default_value = "visual-servo")]
    pub scenario: String,
    /// Standard deviation of the encoders in rad.
    #[arg(long, value_name = "RAD", value_parser = zero_or_more, allow_negative_numbers = true, default_value_t = 2e-4)]
    pub encoder_noise: f64,
    /// Encoder readings per second; 0: no encoders.
    #[arg(long, value_name = "HZ", value_parser = zero_or_more, allow_negative_numbers = true, default_value_t = 30.0)]
    pub encoder_rate: f64,
    /// Log the applied torque beside the angles, with this standard deviation in N·m; not logged if not given.
    #[arg(long, value_name = "N.M", value_parser = zero_or_more, allow_negative_numbers = true)]
    pub torque_noise: Option<f64>,
    /// Seed of all noise.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Folder for the data set, made if it is missing.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}
