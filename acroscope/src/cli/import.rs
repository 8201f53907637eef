//! What can be typed after `acroscope import`.

use super::Called;
use clap::Args;
use std::path::PathBuf;

/// `acroscope import`
#[derive(Debug, Args)]
#[command(
    override_usage = "acroscope import LOG.csv... --fmu FILE.fmu [--rate HZ] --out DATASET\n       acroscope import --frames DIR... (--times FILE.csv | --rate HZ) --out DATASET",
    after_help = "Examples:\n  acroscope import log-1.csv log-2.csv --fmu heater.fmu --out out/heater\n  acroscope import daq.txt --fmu motor.fmu --rate 1000 --out out/motor\n  acroscope import --frames camera/run-1 --rate 30 --out out/rig\n  acroscope import --frames camera/run-1 --times stamps.csv --stamp exposure-start --set camera.width=640 --set camera.height=480 --out out/rig"
)]
pub struct Import {
    /// Logs, one file a run: cells separated by commas, semicolons, tabs or blanks, below a line of names.
    #[arg(required_unless_present = "frames", value_name = "LOG.csv")]
    pub logs: Vec<PathBuf>,
    /// The unit that models what was measured.
    #[arg(long, required_unless_present = "frames", value_name = "FILE.fmu")]
    pub fmu: Option<PathBuf>,
    /// Folder of images of our rig (PNG, TIFF or JPEG, 8 or 16 bit), one a run: the camera unit's vision makes camera.csv of it.
    #[arg(long, value_name = "DIR", conflicts_with_all = ["logs", "fmu"])]
    pub frames: Vec<PathBuf>,
    /// When the frames were taken: a CSV file with a column time in s, and a column file where rows are in another order; one for each --frames.
    #[arg(long, value_name = "FILE.csv", requires = "frames", conflicts_with = "rate")]
    pub times: Vec<PathBuf>,
    /// Frames per second, which the last number in a file's name counts; or rows per second of logs without a column of time.
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub rate: Option<f64>,
    /// Time of the first frame or row in s, with --rate.
    #[arg(long, value_name = "S", requires = "rate", allow_negative_numbers = true, default_value_t = 0.0)]
    pub start: f64,
    /// What the times are times of; those of the shutter are turned into times of delivery by E_t, omega_cam and T_delay of the scenario.
    #[arg(long, value_enum, requires = "frames", default_value_t = StampOf::Delivered)]
    pub stamp: StampOf,
    /// The nominal scenario whose camera looks at the frames: the name of a shipped one, or a path.
    #[arg(long, requires = "frames", default_value = "visual-servo")]
    pub scenario: String,
    /// Set a value of the scenario that differs at this rig; may be given several times.
    #[arg(long = "set", requires = "frames", value_name = "UNIT.VARIABLE=VALUE")]
    pub set: Vec<String>,
    /// Value of the brightest pixel of images of 16 bit [default: 65535].
    #[arg(long, requires = "frames", value_name = "LEVEL", value_parser = clap::value_parser!(u16).range(1..))]
    pub white: Option<u16>,
    /// How the unit is called.
    #[command(flatten)]
    pub called: Called,
    /// Replace a data set that is in that folder.
    #[arg(long, conflicts_with = "frames")]
    pub force: bool,
    /// Folder for the data set, made if it is missing.
    #[arg(long, value_name = "DATASET")]
    pub out: PathBuf,
}

/// What the times of frames are times of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum StampOf {
    /// When the result was there, as camera.csv has it.
    Delivered,
    /// When the shutter opened.
    ExposureStart,
    /// Half-way between.
    MidExposure,
    /// When the shutter closed.
    ExposureEnd,
}
