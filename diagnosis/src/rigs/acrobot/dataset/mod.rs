//! A measured data set (docs/data-set.md) as the residuals want it: per run three ordered tables.
//!
//! Loading never judges the model. Bad rows, files and runs are excluded with a [`Notice`]; only a manifest that
//! can't be read, or nothing usable at all, is an error.

mod angles;
mod check;
mod clock_ticks;
mod held_over;
mod images;
mod impossible_cells;
pub(crate) mod lines;
mod lost_rows;
mod manifest;
pub mod nominal;
pub(crate) mod policy;
mod quantised;
mod rates;
mod rounded;
pub(crate) mod row_times;
pub mod stated_log;
mod still;
mod table;
mod timestamps;
mod uncovered;

pub use angles::in_degrees;
pub use images::angle_in_degrees;
pub use manifest::Manifest;
pub use nominal::Nominal;
pub use quantised::quantum;
pub use row_times::typical_gap;
pub use table::Table;
pub use timestamps::directions;

use crate::error::{Error, Notice};
use crate::rigs::acrobot::channels::{CHANNELS, File, columns};
use crate::rigs::acrobot::dataset::policy::LOGS;
use crate::rigs::acrobot::policy::POLICY;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use timestamps::Moved;

/// One run: the logs that were measured. The start state is not given.
#[derive(Debug, Clone)]
pub struct Run {
    /// Folder inside the data set.
    pub name: String,
    /// A row per delivered frame; rows with `valid` = 0 hold no centroids.
    pub camera: Option<Table>,
    /// Commanded torque, held from its row to the next.
    pub controller: Option<Table>,
    /// Encoders or motion capture.
    pub plant: Option<Table>,
}

impl Run {
    /// What a motor at the joint was told is known, be it nothing but 0; a single 0 is what a free swing without a log is given.
    pub fn logs_the_torque(&self) -> bool {
        self.controller.as_ref().is_some_and(|log| log.len() > 1 && log.column("tau").is_some())
    }

    /// Marks where all logs pause, and where the torque's does, as times of which nothing is known.
    fn tear(&mut self) {
        let (pauses, holes) = (row_times::pauses_of(self), row_times::torque_holes_of(self));
        let Self { camera, controller, plant, .. } = self;
        for log in [camera.as_mut(), plant.as_mut()].into_iter().flatten() {
            pauses.iter().for_each(|(from, to)| log.tear(*from, *to));
        }
        let both = pauses.iter().copied().chain(holes.iter().map(|(_, from, to)| (*from, *to)));
        controller.iter_mut().for_each(|log| both.clone().for_each(|(from, to)| log.tear(from, to)));
    }

    /// First and last time of any row, in s.
    pub fn span(&self) -> (f64, f64) {
        let tables = [&self.camera, &self.controller, &self.plant];
        let rows = || tables.iter().filter_map(|table| table.as_ref());
        let from = rows().filter_map(|table| table.time.first()).fold(f64::INFINITY, |a, b| a.min(*b));
        let to = rows().filter_map(|table| table.time.last()).fold(f64::NEG_INFINITY, |a, b| a.max(*b));
        (from, to)
    }
}

/// From when to when, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span(pub f64, pub f64);

impl Run {
    /// A stretch of it, if it has rows there. The torque goes on from the row before.
    fn within(&self, Span(from, to): Span) -> Option<Self> {
        let part = |log: &Option<Table>, before: usize| {
            let log = log.as_ref()?;
            let first = log.time.partition_point(|time| *time < from).saturating_sub(before);
            let last = log.time.partition_point(|time| *time < to);
            (first < last).then(|| log.rows(first..last))
        };
        let Self { name, camera, controller, plant } = self;
        let (camera, plant) = (part(camera, 0), part(plant, 0));
        let some = camera.is_some() || plant.is_some();
        some.then(|| Self { name: name.clone(), camera, controller: part(controller, 1), plant })
    }

    /// From when to when the torque is known, s: from the first row of its log to when one should have followed the last. A few rows are
    /// held as long as it takes, and no torque was before them.
    pub fn driven(&self) -> (f64, f64) {
        let log = self.controller.as_ref().filter(|log| log.len() >= POLICY.rows);
        let Some((log, typical)) = log.and_then(|log| Some((log, typical_gap(log)?))) else {
            return (f64::NEG_INFINITY, f64::INFINITY);
        };
        (log.time[0], log.time[log.len() - 1] + POLICY.steps * typical)
    }

    /// How well encoders and torque are known to be of one time, s, standard deviation: each has a line through timestamps of its own.
    pub fn tick_error(&self) -> f64 {
        let logs = [&self.controller, &self.plant].into_iter().flatten();
        logs.map(|log| log.tick_error * log.tick_error).sum::<f64>().sqrt()
    }

    /// The speed of an angle of `plant.csv` that is exceeded in a twentieth of its rows, rad/s.
    pub fn speed(&self) -> f64 {
        let Some(log) = &self.plant else { return 0.0 };
        let speeds = ["q1", "q2"].iter().filter_map(|name| log.column(name));
        speeds.map(|values| angles::speed(&log.time, values)).fold(0.0, f64::max)
    }

    /// The first row of `plant.csv` at which the links touch: from there on the arm is at its mechanical limit.
    pub fn touches(&self, contact: f64) -> Option<usize> {
        let q2 = self.plant.as_ref()?.column("q2")?;
        q2.iter().position(|angle| angle.abs() >= contact - LOGS.near)
    }

    /// Until when the machine is seen to move, s: up to where the links touch, or it leaves what the encoders log and images show.
    pub fn moves_until(&self, contact: f64) -> f64 {
        if let Some(plant) = &self.plant {
            let row = self.touches(contact).unwrap_or(plant.len().saturating_sub(1));
            return plant.time.get(row).copied().unwrap_or(f64::INFINITY);
        }
        let seen = self.camera.as_ref().map(timestamps::directions).unwrap_or_default();
        let touches = |(_, [_, link]): &&(f64, [f64; 2])| link.abs() >= contact - LOGS.seen;
        seen.iter().find(touches).or(seen.last()).map_or(f64::INFINITY, |(time, _)| *time)
    }

    /// Times between which the torque isn't known, s: where its rows were ignored, or a few hold no number. Where many don't,
    /// other columns are logged more often.
    pub fn undriven(&self) -> Vec<(f64, f64)> {
        let Some(log) = self.controller.as_ref().filter(|log| log.len() >= POLICY.rows) else {
            return Vec::new();
        };
        let torques: Vec<&[f64]> = ["tau", "tau_1"].iter().filter_map(|name| log.column(name)).collect();
        let bare = |row: &usize| torques.iter().any(|torque| torque[*row].is_nan());
        let rows: Vec<usize> = (0..log.len()).filter(bare).collect();
        let few = rows.len() * LOGS.few_bare <= log.len();
        let until = |row: &usize| log.time.get(row + 1).copied().unwrap_or(f64::INFINITY);
        let spans = rows.iter().filter(|_| few).map(|row| (log.time[*row], until(row)));
        spans.chain(log.broken()).collect()
    }
}

/// A data set, checked.
#[derive(Debug, Clone)]
pub struct DataSet {
    /// The folder.
    pub path: PathBuf,
    /// `dataset.toml`.
    pub manifest: Manifest,
    /// Usable runs, in the manifest's order.
    pub runs: Vec<Run>,
    /// What was excluded.
    pub notices: Vec<Notice>,
    /// The clocks of plant logs were found to be off, by more than any actuator lags or each by a time of its own.
    pub clocks_apart: bool,
    /// Rows of plant logs may be stamped late by this much, s: as far as their timestamps scatter.
    pub late_by_hand: f64,
    /// Nothing but the motion tells how late images are in some run: a delay of theirs can't be told from their clock.
    pub frames_apart: bool,
    /// Times of the frames of runs, by name, whose camera found its circles in none of them.
    pub blind: BTreeMap<String, Vec<f64>>,
}

/// A data set as it was read, before its logs are checked.
pub(crate) struct Reading {
    path: PathBuf,
    manifest: Manifest,
    /// Sizes that the nominal model has.
    pub(crate) nominal: Nominal,
    /// The logs, turned into ours as `[log]` says, without cells that are no measurement.
    pub(crate) runs: Vec<Run>,
    notices: Vec<Notice>,
}

impl Reading {
    /// Reads a folder.
    ///
    /// # Errors
    /// The manifest, the scenario or a log can't be read.
    pub(crate) fn new(path: &Path) -> Result<Self, Error> {
        let manifest = Manifest::load(&path.join("dataset.toml"))?;
        let nominal = Nominal::of(path, &manifest)?;
        let (mut notices, mut runs) = (Vec::new(), Vec::new());
        for name in &manifest.runs {
            let mut run = Run { name: name.clone(), camera: None, controller: None, plant: None };
            run.camera = table::load(path, name, "camera.csv", &columns(File::Camera), &mut notices)?;
            run.controller =
                table::load(path, name, "controller.csv", &columns(File::Controller), &mut notices)?;
            run.plant = table::load(path, name, "plant.csv", &columns(File::Plant), &mut notices)?;
            manifest.stated.apply(&mut run, nominal.image);
            check::clean(&mut run, &nominal, &mut notices);
            runs.push(run);
        }
        Ok(Self { path: path.to_owned(), manifest, nominal, runs, notices })
    }

    /// `[log]` says what is known of gaps.
    pub(crate) fn gaps_stated(&self) -> bool {
        self.manifest.stated.gaps_known.is_some()
    }

    /// What `[log]` says: keys and values.
    pub(crate) fn stated_lines(&self) -> &[(&'static str, String)] {
        &self.manifest.stated.given
    }

    /// Excludes what can't be used.
    ///
    /// # Errors
    /// No run is usable.
    pub(crate) fn checked(self) -> Result<DataSet, Error> {
        let Self { path, manifest, nominal, runs: read, mut notices } = self;
        check::tell_constant_torques(&read, &mut notices);
        let (mut clocks_apart, mut frames_apart) = (false, false);
        let (mut runs, mut blind) = (Vec::new(), BTreeMap::new());
        for mut run in read {
            if manifest.stated.gaps_known == Some(false) {
                run.tear();
            }
            let nothing_to_compare = run.camera.is_none() && run.plant.is_none();
            let none = images::sees_nothing(&run);
            let commanded = run.controller.is_some();
            let moved = check::exclude(&mut run, nominal.falling, &mut notices);
            if manifest.stated.gaps_known != Some(true) {
                let file = if commanded { "controller.csv" } else { "plant.csv" };
                lost_rows::mark_lost_rows(&mut run, file, &mut notices);
            }
            if run.camera.is_none() {
                blind.extend(none.map(|times| (run.name.clone(), times)));
            }
            if nothing_to_compare {
                notices.push(empty(&path, &run.name));
            }
            clocks_apart |= moved == Some(Moved::Angles);
            frames_apart |= moved == Some(Moved::Frames);
            if run.camera.is_some() || run.plant.is_some() {
                runs.push(run);
            }
        }
        if runs.is_empty() {
            return Err(Error::NothingUsable { path, notices });
        }
        let late_by_hand = 0.0;
        Ok(DataSet { path, manifest, runs, notices, clocks_apart, late_by_hand, frames_apart, blind })
    }
}

/// What is told of a run without anything measured.
fn empty(path: &Path, run: &str) -> Notice {
    let entries = std::fs::read_dir(path.join(run)).into_iter().flatten().flatten();
    let mut names: Vec<String> =
        entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    let held = if names.is_empty() { "nothing".to_owned() } else { names.join(", ") };
    let message = format!(
        "excluded: neither camera.csv nor plant.csv with rows to compare lies in the folder, which holds {held}"
    );
    Notice { file: run.to_owned(), line: 0, message }
}

impl DataSet {
    /// Where the links touch in these logs: at the model's `q2_max`, unless an arm went on beyond it.
    pub fn contact(&self, q2_max: f64) -> f64 {
        let beyond = |run: &Run| {
            let q2 = run.plant.as_ref().and_then(|log| log.column("q2")).unwrap_or(&[]);
            let rows = q2.iter().filter(|angle| angle.abs() > q2_max + LOGS.touching).count();
            rows * 20 > q2.len()
        };
        if self.runs.iter().any(beyond) { f64::INFINITY } else { q2_max }
    }

    /// Some of the runs.
    pub fn only(&self, kept: &dyn Fn(usize) -> bool) -> Self {
        let runs = self.runs.iter().enumerate().filter(|(place, _)| kept(*place));
        Self { runs: runs.map(|(_, run)| run.clone()).collect(), ..self.clone() }
    }

    /// Stretches of the runs, each as a run of its own.
    pub fn within(&self, spans: &[Span]) -> Self {
        let stretches = self.runs.iter().flat_map(|run| spans.iter().filter_map(|span| run.within(*span)));
        Self { runs: stretches.collect(), ..self.clone() }
    }

    /// Puts the plant's log of a run right, whose clock is `late`, s.
    pub fn set_back(&mut self, run: usize, late: f64) {
        let log = self.runs.get_mut(run).and_then(|run| run.plant.as_mut());
        log.into_iter().flat_map(|log| &mut log.time).for_each(|time| *time -= late);
    }

    /// Turns the angles of the plant's logs back whose zeros are off by so much, rad.
    pub fn turn_back(&mut self, off: [f64; 2]) {
        for log in self.runs.iter_mut().filter_map(|run| run.plant.as_mut()) {
            for (name, off) in ["q1", "q2"].iter().zip(off) {
                log.column_mut(name).into_iter().flatten().for_each(|angle| *angle -= off);
            }
        }
    }

    /// Puts all images aside, and with them the runs that hold nothing else.
    ///
    /// # Errors
    /// Nothing is left.
    pub fn without_images(&mut self, why: &str) -> Result<(), Error> {
        for run in &mut self.runs {
            if run.camera.take().is_some() {
                let file = format!("{}/camera.csv", run.name);
                self.notices.push(Notice { file, line: 0, message: format!("excluded: {why}") });
            }
        }
        self.runs.retain(|run| run.plant.is_some());
        self.frames_apart = false;
        let notices = self.notices.clone();
        if self.runs.is_empty() {
            Err(Error::NothingUsable { path: self.path.clone(), notices })
        } else {
            Ok(())
        }
    }

    /// A known standard deviation from `[noise]`, not less than the least that is believed of such a column.
    pub fn known_noise(&self, variable: &str) -> Option<f64> {
        let stated = *self.manifest.noise.get(variable)?;
        let (unit, column) = variable.split_once('.')?;
        let own = CHANNELS.iter().find(|channel| channel.file.unit() == unit && channel.column == column);
        let least = own.and_then(|channel| channel.noise).map_or(0.0, |noise| noise.least);
        Some(if stated > 0.0 { stated.max(least) } else { stated })
    }
}
