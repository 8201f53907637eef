//! When each frame was taken: from a table, or from a rate and a start; and what such a time is the time of.

use crate::error::Error;
use crate::sequence::Frame;
use camera::shutter::FrameClock;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Where times come from.
#[derive(Debug, Clone, PartialEq)]
pub enum Times {
    /// Frames per second, and the time of the first frame in s.
    Rate {
        /// Hz.
        rate: f64,
        /// s.
        start: f64,
    },
    /// A CSV file with a column `time` in s and, if its rows are not in the order of the files, a column `file`.
    Table(PathBuf),
}

/// What a time is the time of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Stamp {
    /// When the result of the frame was there: what a row of `camera.csv` is stamped with.
    #[default]
    Delivered,
    /// When the shutter opened.
    ExposureStart,
    /// Half-way between.
    MidExposure,
    /// When the shutter closed.
    ExposureEnd,
}

/// The moments of a frame, in s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moments {
    /// Mid-exposure.
    pub middle: f64,
    /// Delivery of the result.
    pub delivered: f64,
}

impl Stamp {
    /// Both moments of a frame with this stamp, by the exposure and the delay of the scenario.
    pub fn moments(self, time: f64, clock: &FrameClock, delay: f64) -> Moments {
        let exposure = clock.exposure();
        let end = match self {
            Self::Delivered => time - delay,
            Self::ExposureStart => time + exposure,
            Self::MidExposure => time + exposure / 2.0,
            Self::ExposureEnd => time,
        };
        let middle = if self == Self::MidExposure { time } else { end - exposure / 2.0 };
        let delivered = if self == Self::Delivered { time } else { end + delay };
        Moments { middle, delivered }
    }
}

impl Times {
    /// The time of each frame, in s.
    pub fn of(&self, frames: &[Frame], folder: &Path, notices: &mut Vec<String>) -> Result<Vec<f64>, Error> {
        match self {
            Self::Rate { rate, start } => by_rate(*rate, *start, frames, folder, notices),
            Self::Table(path) => by_table(path, frames, folder),
        }
    }
}

fn by_rate(
    rate: f64,
    start: f64,
    frames: &[Frame],
    folder: &Path,
    notices: &mut Vec<String>,
) -> Result<Vec<f64>, Error> {
    if !(rate > 0.0 && rate.is_finite()) {
        return Err(Error::Rate { rate });
    }
    if !start.is_finite() {
        return Err(Error::Start { start });
    }
    let first = frames.first().map_or(0, |frame| frame.number);
    let times: Vec<f64> = frames.iter().map(|frame| start + (frame.number - first) as f64 / rate).collect();
    let expected =
        "with --rate the last number in a name counts the frames; rename the files, or give --times";
    ordered(&times, frames, folder, expected)?;
    let missing: i64 = frames.windows(2).map(|pair| (pair[1].number - pair[0].number - 1).max(0)).sum();
    if missing > 0 {
        notices.push(format!(
            "{}: {missing} numbers between the first and the last frame have no file; these frames count as lost, and the next ones \
             keep their times",
            folder.display()
        ));
    }
    Ok(times)
}

fn by_table(path: &Path, frames: &[Frame], folder: &Path) -> Result<Vec<f64>, Error> {
    let wrong = |line: u64, what: String| Error::Table { path: path.to_owned(), line, what };
    let unreadable = |error: csv::Error| {
        let line = error.position().map_or(1, csv::Position::line);
        wrong(line, error.to_string())
    };
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_path(path).map_err(unreadable)?;
    let head = reader.headers().map_err(unreadable)?.clone();
    let column = |name: &str| head.iter().position(|cell| cell.trim_start_matches('\u{feff}') == name);
    let Some(at) = column("time") else {
        let have = head.iter().collect::<Vec<_>>().join(", ");
        return Err(wrong(1, format!("no column `time` (in s) among {have}")));
    };
    let names = column("file");
    let mut rows: Vec<(u64, String, f64)> = Vec::new();
    for record in reader.records() {
        let record = record.map_err(unreadable)?;
        let line = record.position().map_or(0, csv::Position::line);
        let cell = record.get(at).unwrap_or_default();
        let time: f64 = cell
            .parse()
            .ok()
            .filter(|time: &f64| time.is_finite())
            .ok_or_else(|| wrong(line, format!("time = {cell:?}: expected a number of seconds")))?;
        rows.push((line, names.and_then(|at| record.get(at)).unwrap_or_default().to_owned(), time));
    }
    let times = if names.is_some() {
        named(&rows, frames, folder, wrong)?
    } else {
        counted(&rows, frames, folder, wrong)?
    };
    ordered(
        &times,
        frames,
        path,
        "frames are taken in the order of the numbers in their names, and times go up with them",
    )?;
    Ok(times)
}

/// One row a file, in the same order.
fn counted(
    rows: &[(u64, String, f64)],
    frames: &[Frame],
    folder: &Path,
    wrong: impl Fn(u64, String) -> Error,
) -> Result<Vec<f64>, Error> {
    if rows.len() != frames.len() {
        let line = rows.last().map_or(1, |(line, ..)| *line);
        let what = format!(
            "{} times for {} frames in {}; expected one a frame, or a column `file` with their names",
            rows.len(),
            frames.len(),
            folder.display()
        );
        return Err(wrong(line, what));
    }
    Ok(rows.iter().map(|(.., time)| *time).collect())
}

/// Rows that name their file; a row whose file is not there is a frame that was lost.
fn named(
    rows: &[(u64, String, f64)],
    frames: &[Frame],
    folder: &Path,
    wrong: impl Fn(u64, String) -> Error,
) -> Result<Vec<f64>, Error> {
    let bare = |name: &str| Path::new(name).file_name().map(|name| name.to_string_lossy().into_owned());
    let mut known = HashMap::new();
    for (line, name, time) in rows {
        if known.insert(bare(name), *time).is_some() {
            return Err(wrong(*line, format!("file = {name:?} stands in two rows; expected one a frame")));
        }
    }
    let time = |frame: &Frame| {
        known.get(&Some(frame.name.clone())).copied().ok_or_else(|| {
            wrong(
                1,
                format!("no row for {}; expected one for each image in {}", frame.name, folder.display()),
            )
        })
    };
    frames.iter().map(time).collect()
}

fn ordered(times: &[f64], frames: &[Frame], path: &Path, expected: &'static str) -> Result<(), Error> {
    match (1..times.len()).find(|at| !(times[*at] > times[*at - 1] && times[*at].is_finite())) {
        Some(at) => Err(Error::Order {
            path: path.to_owned(),
            frame: frames[at].name.clone(),
            time: times[at],
            before: times[at - 1],
            expected,
        }),
        None => Ok(()),
    }
}
