//! Turns finished runs of `acroscope run` into a measured data set, so that a user can rehearse a diagnosis: hide an
//! effect, run, record, diagnose.
//!
//! A camera row is written for each delivered frame, a controller row whenever the torque or the reference is computed
//! anew, a plant row at the encoders' rate, with noise on the angles and, where it is asked for, the applied torque. What
//! was hidden is not written anywhere.

use crate::error::Error;
use crate::rigs::acrobot::channels::{File, Measures, columns, measuring};
use crate::rigs::acrobot::policy::POLICY;
use crate::statistics::random::Random;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// What the encoders are like, and what the model without the effect is.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// Nominal scenario: the name of a shipped one, or a path.
    pub scenario: String,
    /// Standard deviation of the encoders, rad.
    pub encoder_noise: f64,
    /// Rows of the plant per second; 0: no encoders.
    pub encoder_rate: f64,
    /// Standard deviation of `tau_applied`, which is logged beside the angles, N·m; `None`: it isn't.
    pub torque_noise: Option<f64>,
    /// Seed of all noise.
    pub seed: u64,
}

impl Default for Recording {
    /// Encoders of 2e-4 rad at 30 Hz, beside the scenario `visual-servo`.
    fn default() -> Self {
        Self {
            scenario: "visual-servo".to_owned(),
            encoder_noise: 2e-4,
            encoder_rate: 30.0,
            torque_noise: None,
            seed: 1,
        }
    }
}

impl Recording {
    fn logs_the_plant(&self) -> bool {
        self.encoder_rate > 0.0
    }

    /// What is known of the noise, as a section of the manifest.
    fn noise(&self) -> String {
        let angle = Some(self.encoder_noise);
        let all = [("q1", angle), ("q2", angle), ("tau_applied", self.torque_noise)];
        let known: String = all
            .iter()
            .filter_map(|(name, sigma)| Some((name, sigma.filter(|sigma| *sigma > 0.0)?)))
            .map(|(name, sigma)| format!("\"plant.{name}\" = {sigma:e}\n"))
            .collect();
        if known.is_empty() || !self.logs_the_plant() { String::new() } else { format!("\n[noise]\n{known}") }
    }
}

/// Writes a data set from folders of finished runs (each with a `results.csv`, and the `resolved.toml` that `acroscope run`
/// puts beside it: a frame is stamped with the time at which it was ready, not with the step after it. Without, with the step).
///
/// # Errors
/// A folder has no readable `results.csv`, or one without any column that a data set holds, its `resolved.toml` is no TOML, or the data set
/// can't be written.
pub fn record(runs: &[PathBuf], out: &Path, recording: &Recording) -> Result<(), Error> {
    recorded(runs, recording)?.write(out, &[])
}

/// As [`record`], before anything is written.
///
/// # Errors
/// A run can't be read, or holds nothing that a data set does.
pub fn recorded(runs: &[PathBuf], recording: &Recording) -> Result<Recorded, Error> {
    let mut manifest = format!("format = 1\nscenario = {:?}\n", recording.scenario);
    manifest.push_str(&recording.noise());
    let mut files = Vec::new();
    for (index, folder) in runs.iter().enumerate() {
        let name = format!("run-{:02}", index + 1);
        let results = Results::read(folder)?;
        let mut random = Random::new(recording.seed.wrapping_add(index as u64));
        let logs = [
            ("camera.csv", results.camera()),
            ("controller.csv", results.controller()),
            ("plant.csv", results.plant(recording, &mut random)),
        ];
        if logs.iter().all(|(_, text)| text.is_none()) {
            return Err(nothing_logged(&folder.join("results.csv")));
        }
        files.extend(logs.into_iter().filter_map(|(log, text)| Some((Path::new(&name).join(log), text?))));
        let _ = write!(manifest, "\n[[run]]\ndir = \"{name}\"\n");
    }
    files.push(("dataset.toml".into(), manifest));
    Ok(Recorded { files })
}

/// A data set that is not written yet.
#[derive(Debug)]
pub struct Recorded {
    /// By their places in the folder.
    files: Vec<(PathBuf, String)>,
}

impl Recorded {
    /// Writes it to a folder, in place of these files of an earlier one: they go when all that comes in their place is there.
    ///
    /// # Errors
    /// A file can't be written.
    pub fn write(&self, out: &Path, replaced: &[PathBuf]) -> Result<(), Error> {
        let fresh = |path: &Path| path.with_added_extension("new");
        let paths: Vec<PathBuf> = self.files.iter().map(|(file, _)| out.join(file)).collect();
        let write = |(path, (_, text)): (&PathBuf, &(PathBuf, String))| {
            let folder = path.parent().unwrap_or(out);
            std::fs::create_dir_all(folder).map_err(io(folder))?;
            std::fs::write(fresh(path), text).map_err(io(path))
        };
        if let Err(error) = paths.iter().zip(&self.files).try_for_each(write) {
            // what is half there is of no use
            paths.iter().for_each(|path| drop(std::fs::remove_file(fresh(path))));
            return Err(error);
        }
        replaced.iter().try_for_each(|path| std::fs::remove_file(path).map_err(io(path)))?;
        paths.iter().try_for_each(|path| std::fs::rename(fresh(path), path).map_err(io(path)))
    }
}

fn nothing_logged(path: &Path) -> Error {
    let problem = "no column that a data set holds; wanted are those of units named camera (frame, u1, ...), controller (tau) \
                   or plant (q1, q2, tau)";
    Error::Manifest { path: path.to_owned(), line: 1, problem: problem.to_owned() }
}

fn io(path: &Path) -> impl FnOnce(std::io::Error) -> Error {
    let path = path.to_owned();
    move |source| Error::Io { path, source }
}

/// When frames were ready: frame k at k/omega_cam + T_delay.
#[derive(Debug, Clone, Copy)]
struct FrameClock {
    rate: f64,
    delay: f64,
}

impl FrameClock {
    /// As the run's `resolved.toml` has it; `None` where there is none, or no camera in it.
    fn read(path: &Path) -> Result<Option<Self>, Error> {
        if !path.exists() {
            return Ok(None);
        }
        let text = orchestrator::plain::read_text(path).map_err(io(path))?;
        let wrong = |error: toml::de::Error| io(path)(std::io::Error::other(error.message().to_owned()));
        let table: toml::Table = text.parse().map_err(wrong)?;
        let units = table.get("units").and_then(toml::Value::as_array);
        let camera = units.into_iter().flatten().find(|unit| unit.get("name").is_some_and(is_camera));
        let value = |name: &str| {
            let value = camera?.get("set")?.get(name)?;
            value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))
        };
        Ok(value("omega_cam").zip(value("T_delay")).map(|(rate, delay)| Self { rate, delay }))
    }

    fn ready(self, frame: f64) -> f64 {
        frame / self.rate + self.delay
    }
}

fn is_camera(name: &toml::Value) -> bool {
    name.as_str() == Some("camera")
}

/// The results of one run, as they stand in the file.
struct Results {
    head: Vec<String>,
    rows: Vec<csv::StringRecord>,
    clock: Option<FrameClock>,
}

impl Results {
    fn read(folder: &Path) -> Result<Self, Error> {
        let path = folder.join("results.csv");
        let refused = |error: csv::Error| io(&path)(error.into());
        let mut reader = csv::Reader::from_path(&path).map_err(refused)?;
        let head = reader.headers().map_err(refused)?.iter().map(str::to_owned).collect();
        let rows = reader.records().collect::<Result<_, _>>().map_err(refused)?;
        Ok(Self { head, rows, clock: FrameClock::read(&folder.join("resolved.toml"))? })
    }

    fn column(&self, name: &str) -> Option<usize> {
        self.head.iter().position(|head| head == name)
    }

    /// Columns of one unit that a data set may hold: bare name, and place in the file.
    fn columns<'a>(&self, unit: &str, names: &[&'a str]) -> Vec<(&'a str, usize)> {
        let place = |name: &&'a str| Some((*name, self.column(&format!("{unit}.{name}"))?));
        names.iter().filter_map(place).collect()
    }

    /// Rows at which one of some columns is not what it was; the first row too.
    fn changes(&self, triggers: &[usize]) -> Vec<usize> {
        let cells = |row: usize| triggers.iter().map(move |at| self.rows[row].get(*at));
        (0..self.rows.len()).filter(|row| *row == 0 || cells(*row).ne(cells(row - 1))).collect()
    }

    fn time(&self, row: usize) -> &str {
        self.rows[row].get(0).unwrap_or_default()
    }

    fn number(&self, row: usize, at: usize) -> f64 {
        self.rows[row].get(at).and_then(|cell| cell.parse().ok()).unwrap_or(f64::NAN)
    }

    fn line(&self, row: usize, time: &str, columns: &[(&str, usize)]) -> String {
        let cells = columns.iter().map(|(_, at)| self.rows[row].get(*at).unwrap_or_default());
        std::iter::once(time).chain(cells).collect::<Vec<_>>().join(",") + "\n"
    }

    /// The text of `camera.csv`: a row for each frame that was delivered.
    fn camera(&self) -> Option<String> {
        let frame = self.column("camera.frame")?;
        let columns = self.columns("camera", &columns(File::Camera));
        // Before the first delivery (frame 0) there is nothing to log.
        let delivered = |row: &usize| self.rows[*row].get(frame) != Some("0");
        let rows = self.changes(&[frame]).into_iter().filter(delivered);
        let lines: String = rows.map(|row| self.line(row, &self.ready(row), &columns)).collect();
        (!columns.is_empty()).then(|| head(&columns) + &lines)
    }

    /// When a row's frame was ready: within the step that ends at the row.
    fn ready(&self, row: usize) -> String {
        let now = self.number(row, 0);
        let before = row.checked_sub(1).map_or(now, |before| self.number(before, 0));
        let clock = self.clock.zip(self.column("camera.frame_index"));
        match clock.map(|(clock, at)| clock.ready(self.number(row, at))) {
            Some(ready) if ready > before && ready < now - POLICY.same_time => ready.to_string(),
            _ => self.time(row).to_owned(),
        }
    }

    /// The text of `controller.csv`: a row for each torque that was commanded.
    fn controller(&self) -> Option<String> {
        let Some(torque) = self.column("controller.tau") else {
            return self.driven();
        };
        let columns = self.columns("controller", &["tau", "z_desired"]);
        // With a camera in the loop the torque is computed when a frame has been delivered, else when it changes.
        let triggers = [Some(torque), self.column("controller.frame")];
        let rows = self.changes(&triggers.into_iter().flatten().collect::<Vec<_>>()).into_iter();
        let lines: String = rows.map(|row| self.line(row, self.time(row), &columns)).collect();
        Some(head(&columns) + &lines)
    }

    /// What a plant without a controller was driven with. A row has the input of the step that it ends, which began a row before.
    fn driven(&self) -> Option<String> {
        let columns = self.columns("plant", &measuring(File::Controller, Measures::Command));
        let mut rows = self.changes(&columns.iter().map(|(_, at)| *at).collect::<Vec<_>>());
        if rows.get(1) == Some(&1) {
            rows.remove(0); // no step was driven with what it has
        }
        let line = |row: usize| self.line(row, self.time(row.saturating_sub(1)), &columns);
        let lines: String = rows.into_iter().map(line).collect();
        (!columns.is_empty()).then(|| head(&columns) + &lines)
    }

    /// The text of `plant.csv`: encoders with their noise, and the applied torque if it is recorded.
    fn plant(&self, recording: &Recording, random: &mut Random) -> Option<String> {
        let mut columns = self.columns("plant", &measuring(File::Plant, Measures::Angle));
        if columns.is_empty() || !recording.logs_the_plant() {
            return None;
        }
        let angles = columns.len();
        let torque = recording.torque_noise.and_then(|_| self.column("plant.tau_applied"));
        columns.extend(torque.map(|place| ("tau_applied", place)));
        let mut text = head(&columns);
        let mut next = f64::NEG_INFINITY;
        for row in 0..self.rows.len() {
            let time = self.number(row, 0);
            if time + POLICY.same_time < next {
                continue;
            }
            next = if next.is_finite() { next } else { time } + 1.0 / recording.encoder_rate;
            text.push_str(self.time(row));
            for (place, (_, at)) in columns.iter().enumerate() {
                let torque = recording.torque_noise.filter(|_| place >= angles);
                let sigma = torque.unwrap_or(recording.encoder_noise);
                // Writing into a String can't fail.
                let _ = write!(text, ",{}", self.number(row, *at) + sigma * random.normal());
            }
            text.push('\n');
        }
        Some(text)
    }
}

fn head(columns: &[(&str, usize)]) -> String {
    let names = columns.iter().map(|(name, _)| *name);
    std::iter::once("time").chain(names).collect::<Vec<_>>().join(",") + "\n"
}
