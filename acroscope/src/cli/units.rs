//! Commands about units and packages: what makes them, and what looks at them.

use super::Called;
use clap::Args;
use runner::cli::above_zero;
use std::path::PathBuf;

/// `acroscope check`
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  acroscope check my-unit.fmu\n  acroscope check my-unit.fmu --json\n  acroscope check my-unit.fmu --out out/check\n\nExit status: 1 if anything found is an error. docs/check.md explains each rule."
)]
pub struct Check {
    /// The unit.
    #[arg(value_name = "FILE.fmu")]
    pub file: PathBuf,
    /// As JSON, for programs: a list of {rule, severity, variable, text}.
    #[arg(long)]
    pub json: bool,
    /// Folder for a page with the findings, `report.html`; without it they are only printed.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Seconds that a call into the unit may take.
    #[arg(long, value_name = "S", value_parser = above_zero, default_value_t = 10.0)]
    pub step_limit: f64,
    /// Memory that a process of the unit may have, in MiB.
    #[arg(long, value_name = "MIB", value_parser = clap::value_parser!(u64).range(1..1 << 40), default_value_t = 4096)]
    pub memory_limit: u64,
}

/// `acroscope new`
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  acroscope new plant.fmu controller.fmu -o loop.toml\n  acroscope new my-unit.fmu > alone.toml\n  acroscope new slow.fmu --isolate --step-limit 120 -o slow.toml"
)]
pub struct New {
    /// The units, in the order in which they are to be stepped.
    #[arg(required = true, value_name = "FILE.fmu")]
    pub files: Vec<PathBuf>,
    /// The scenario's file; without it the scenario is printed, for a file in this folder.
    #[arg(long, short, value_name = "SCENARIO.toml")]
    pub output: Option<PathBuf>,
    /// Replace a file that is there.
    #[arg(long)]
    pub force: bool,
    /// How the units are called when the scenario is tried.
    #[command(flatten)]
    pub called: Called,
}

/// `acroscope container`
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  acroscope container visual-servo -o visual_servo.fmu\n  acroscope container my-scenario.toml --set plant.q1_0=0.1 -o mine.fmu"
)]
pub struct Containing {
    /// A scenario file, a package (.ssp), or the name of a shipped scenario.
    pub scenario: String,
    /// Set a parameter or start value; may be given several times.
    #[arg(long = "set", value_name = "UNIT.VARIABLE=VALUE")]
    pub set: Vec<String>,
    /// The unit to write; its name is the unit's, too.
    #[arg(long, short, value_name = "FILE.fmu")]
    pub output: PathBuf,
}

/// `acroscope ssp`
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  acroscope ssp visual-servo -o visual-servo.ssp\n  acroscope ssp my-scenario.toml --set plant.q1_0=0.1 -o mine.ssp\n  acroscope run mine.ssp"
)]
pub struct Packing {
    /// A scenario file, a package, or the name of a shipped scenario.
    pub scenario: String,
    /// Set a parameter or start value; may be given several times.
    #[arg(long = "set", value_name = "UNIT.VARIABLE=VALUE")]
    pub set: Vec<String>,
    /// The package to write.
    #[arg(long, short, value_name = "FILE.ssp")]
    pub output: PathBuf,
    /// Have latencies made by units (signal_effects), for masters that know none.
    #[arg(long)]
    pub delay_units: bool,
}
