//! What can be typed.

mod called;
mod import;
mod units;

pub use called::Called;
pub use import::{Import, StampOf};
pub use units::{Check, Containing, New, Packing};

use clap::builder::{PathBufValueParser, TypedValueParser as _};
use clap::{Args, Parser, Subcommand};
use clap_complete::Shell;
use runner::cli::{Run, above_zero, zero_or_more};
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

fn part(text: &str) -> Result<(u64, u64), String> {
    let numbers = text.split_once('/').and_then(|(part, of)| Some((part.parse().ok()?, of.parse().ok()?)));
    let numbers: Option<(u64, u64)> =
        numbers.filter(|(part, of)| (1..=*of).contains(part) && *of <= 1_000_000);
    numbers
        .ok_or_else(|| "wanted is K/N with K from 1 to N: 1/16 is the first part, 16/16 the last".to_owned())
}

/// The folder of a data set, of which its own file may be named, too.
fn folder_of(path: PathBuf) -> PathBuf {
    let is_its_file = path.file_name().is_some_and(|name| name == "dataset.toml") && path.is_file();
    match path.parent() {
        Some(folder) if is_its_file && folder.as_os_str().is_empty() => ".".into(),
        Some(folder) if is_its_file => folder.to_owned(),
        _ => path,
    }
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
    /// Make a data set of a unit and measured logs, each guess marked with its evidence; or of images of a real camera.
    Import(Import),
    /// Turn finished runs into a measured data set, to rehearse a diagnosis.
    Record(Record),
    /// List what can be set in a scenario: values, units, ranges, neutral values.
    Params(Params),
    /// Run a scenario many times with varied values: writes a Parquet data set and report.html.
    Sweep(Sweep),
    /// Look at finished runs: the machine in motion, what the camera saw, the signals.
    View(View),
    /// Tell what is wrong with an FMU: rules that read it, and rules that run it.
    Check(Check),
    /// Make a scenario that runs of FMUs: connects what fits, says what it guessed.
    New(New),
    /// Make one FMI 2.0 unit of a whole scenario, which keeps its rates and delays inside.
    Container(Containing),
    /// Pack a scenario with its units as an SSP 1.0 package, for other tools.
    Ssp(Packing),
    /// Print a script that completes commands and options in a shell.
    Completions(Completions),
    /// Write manual pages, one a command.
    Man(Man),
}

/// `acroscope reproduce`
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  acroscope reproduce\n  acroscope reproduce table-3 C42")]
pub struct Reproduce {
    /// Studies, or claims that they decide: table-3, C25, ...; all if none is given.
    #[arg(value_name = "ID")]
    pub ids: Vec<String>,
    /// Run part K of N of the studies only, from 1 to N, without those that are there; other machines run the others into the
    /// same folder, and 1/1 completes it.
    #[arg(long, value_name = "K/N", value_parser = part)]
    pub partition: Option<(u64, u64)>,
    /// Folder for the results, made if it is missing; studies of earlier calls stay in it [default: out/reproduce].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// `acroscope diagnose`
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  acroscope diagnose examples/hidden-effect\n  acroscope diagnose my-data --without camera.k2 --out out/mine\n\n--isolate and --fit are for data sets of any unit (format = 2)."
)]
pub struct Diagnose {
    /// Folder of the data set: dataset.toml with a folder for each run, or with format = 2 a log file for each run.
    #[arg(value_parser = PathBufValueParser::new().map(folder_of))]
    pub dataset: PathBuf,
    /// An effect that is not to be named; may be given several times.
    #[arg(long, value_name = "UNIT.VARIABLE")]
    pub without: Vec<String>,
    /// Seconds after which searches end with what they have [default: 60 for each run].
    #[arg(long, value_name = "SECONDS", value_parser = above_zero, allow_negative_numbers = true)]
    pub budget: Option<f64>,
    /// Fit these parameters, in place of a search: values with intervals, and whether they explain the data (format = 2).
    #[arg(long, value_name = "UNIT.VARIABLE,...", value_delimiter = ',')]
    pub fit: Vec<String>,
    /// Whether units have processes of their own, and limits.
    #[command(flatten)]
    pub called: Called,
    /// Folder of an earlier diagnosis of the same machine, before an experiment: what it told apart counts, too.
    #[arg(long, value_name = "DIR")]
    pub after: Option<PathBuf>,
    /// Folder for the results, made if it is missing [default: out/diagnose-DATASET, with +without=NAME and the like for each option].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// `acroscope record`
#[derive(Debug, Args)]
#[command(
    after_help = "Example: two runs with a hidden friction become a data set\n  acroscope run visual-servo --set plant.b_joint=0.02 --out out/one\n  acroscope run visual-servo --set plant.b_joint=0.02 --set plant.q2_0=0.05 --out out/two\n  acroscope record out/one out/two --out out/rehearsal"
)]
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
    /// Replace a data set that is in that folder.
    #[arg(long)]
    pub force: bool,
    /// Folder for the data set, made if it is missing.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

/// `acroscope params`
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  acroscope params visual-servo\n  acroscope params visual-servo camera.k camera.p1\n  acroscope params my-scenario.toml --json"
)]
pub struct Params {
    /// A scenario file, or the name of a shipped one.
    pub scenario: String,
    /// Only those whose UNIT.VARIABLE begins like this; all if none is given.
    #[arg(value_name = "BEGINNING")]
    pub beginnings: Vec<String>,
    /// As JSON, for programs.
    #[arg(long)]
    pub json: bool,
    /// How the units are called when the scenario is built.
    #[command(flatten)]
    pub called: Called,
}

/// What a study may be, with the names of the shipped ones.
fn help_of_study() -> String {
    let shipped: Vec<&str> = sweep::SHIPPED.iter().map(|(name, _)| *name).collect();
    format!("A study: a file, or the name of a shipped one: {}. With --grid a scenario", shipped.join(", "))
}

/// `acroscope sweep`
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  acroscope sweep delay-and-rate\n  acroscope sweep my-study.toml --out out/mine --jobs 8\n  acroscope sweep visual-servo --grid camera.T_delay=0:0.06:0.005 --until plant.contact\n  acroscope sweep my-study.toml --partition 3/16 --out /shared/mine"
)]
pub struct Sweep {
    /// A study: a file, or the name of a shipped one. With --grid a scenario.
    #[arg(value_name = "STUDY", help = help_of_study())]
    pub study: String,
    /// Vary a parameter from FROM to TO, both among the values; several make all combinations.
    #[arg(long, value_name = "UNIT.VARIABLE=FROM:TO:STEP|VALUE,...")]
    pub grid: Vec<String>,
    /// End each run when this is true, or passes a limit: plant.contact, "plant.q2 > 2" (with --grid).
    #[arg(long, value_name = "SIGNAL", requires = "grid")]
    pub until: Option<String>,
    /// Keep a number of each run: last, min, max, mean, rms, peak or first_true of a signal or a difference (with --grid).
    #[arg(long = "scalar", value_name = "NAME=SIGNAL[-OTHER]:REDUCE", requires = "grid")]
    pub scalars: Vec<String>,
    /// Set a parameter or start value of all runs; may be given several times.
    #[arg(long = "set", value_name = "UNIT.VARIABLE=VALUE")]
    pub set: Vec<String>,
    /// Simulated time at which runs stop, in s; the study's own if not given.
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub stop: Option<String>,
    /// Threads [default: all cores].
    #[arg(long, short, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub jobs: Option<u16>,
    /// Make one part of N only, K from 1 to N; other machines make the others into the same folder.
    #[arg(long, value_name = "K/N", value_parser = part)]
    pub partition: Option<(u64, u64)>,
    /// Run every unit in a process of its own: one that crashes or hangs costs its case only.
    #[arg(long)]
    pub isolate: bool,
    /// Seconds that a call into an isolated unit may take [default: 30].
    #[arg(long, value_name = "S", value_parser = above_zero)]
    pub step_limit: Option<f64>,
    /// Memory that the process of an isolated unit may have, in MiB [default: no limit].
    #[arg(long, value_name = "MIB", value_parser = clap::value_parser!(u64).range(1..1 << 40))]
    pub memory_limit: Option<u64>,
    /// Folder for the data set, made if it is missing; parts that are there are not made again [default: out/sweep-STUDY].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// `acroscope view`
#[derive(Debug, Args)]
#[command(
    override_usage = "acroscope view [OPTIONS] RESULT [RESULT]",
    after_help = "Examples:\n  acroscope view out/visual-servo\n  acroscope view out/visual-servo out/full-state -o both.html"
)]
pub struct View {
    /// Folder of a finished run; of two for a look at both side by side.
    #[arg(required = true, num_args = 1.., value_name = "RESULT")]
    pub results: Vec<PathBuf>,
    /// Write the page to this file; without it, it is served at an address of this machine until Ctrl-C.
    #[arg(short, long, value_name = "FILE.html")]
    pub output: Option<PathBuf>,
}

/// `acroscope completions`
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  acroscope completions bash > ~/.local/share/bash-completion/completions/acroscope"
)]
pub struct Completions {
    /// The shell.
    pub shell: Shell,
}

/// `acroscope man`
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  acroscope man --out ~/.local/share/man/man1")]
pub struct Man {
    /// Folder for the pages, made if it is missing.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

#[cfg(test)]
mod tests {
    use super::Arguments;
    use clap::{CommandFactory as _, Parser as _};
    use std::path::{Path, PathBuf};

    #[test]
    fn every_command_has_an_example_that_can_be_typed() {
        let commands = Arguments::command();
        commands.clone().debug_assert();
        for command in commands.get_subcommands() {
            let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            let typed = format!("  acroscope {} ", command.get_name());
            assert!(
                help.lines().any(|line| format!("{line} ").starts_with(&typed)),
                "{} has none",
                command.get_name()
            );
            for line in help.lines().filter(|line| line.starts_with("  acroscope ")) {
                let words = line.split(" > ").next().unwrap_or_default().split_whitespace();
                assert!(Arguments::try_parse_from(words).is_ok(), "{line}");
            }
        }
    }
    fn pages(folder: &Path, found: &mut Vec<PathBuf>) {
        for entry in std::fs::read_dir(folder).expect("a folder of the repository").flatten() {
            let path = entry.path();
            if path.is_dir() {
                pages(&path, found);
            } else if path.extension().is_some_and(|ending| ending == "md") {
                found.push(path);
            }
        }
    }

    #[test]
    fn every_command_on_a_page_is_one_that_the_program_takes() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let mut found = vec![root.join("README.md")];
        pages(&root.join("docs"), &mut found);
        pages(&root.join("examples"), &mut found);
        let mut seen = 0;
        for page in found {
            let text = std::fs::read_to_string(&page).expect("a page is text");
            let lines = text.lines().map(|line| line.strip_prefix("$ ").unwrap_or(line));
            for typed in lines.filter_map(|line| line.strip_prefix("cargo acroscope ")) {
                let words = typed.split(" # ").next().unwrap_or_default().split_whitespace();
                let parsed = Arguments::try_parse_from(std::iter::once("acroscope").chain(words));
                assert!(parsed.is_ok(), "{}: {typed}", page.display());
                seen += 1;
            }
        }
        assert!(seen > 25, "found {seen} commands");
    }
}
