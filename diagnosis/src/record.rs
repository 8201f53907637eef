//! Turns finished runs of `acroscope run` into a measured data set, so that a user can rehearse a diagnosis: hide an
//! effect, run, record, diagnose.
//!
//! A camera row is written for each delivered frame, a controller row whenever the torque or the reference is computed
//! anew, a plant row at the encoders' rate, with noise on the angles. What was hidden is not written anywhere.

use crate::dataset::{CAMERA_COLUMNS, CONTROLLER_COLUMNS};
use crate::error::Error;
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
    /// Seed of the encoders' noise.
    pub seed: u64,
}

impl Default for Recording {
    /// Encoders of 2e-4 rad at 30 Hz, beside the scenario `visual-servo`.
    fn default() -> Self {
        Self { scenario: "visual-servo".to_owned(), encoder_noise: 2e-4, encoder_rate: 30.0, seed: 1 }
    }
}

/// Writes a data set from folders of finished runs (each with a `results.csv`).
///
/// # Errors
/// A folder has no readable `results.csv`, it lacks `camera.` or `controller.` and `plant.` columns, or the data set
/// can't be written.
pub fn record(runs: &[PathBuf], out: &Path, recording: &Recording) -> Result<(), Error> {
    let mut manifest = format!("format = 1\nscenario = {:?}\n", recording.scenario);
    if recording.encoder_rate > 0.0 && recording.encoder_noise > 0.0 {
        let sigma = recording.encoder_noise;
        // Writing into a String can't fail.
        let _ = write!(manifest, "\n[noise]\n\"plant.q1\" = {sigma:e}\n\"plant.q2\" = {sigma:e}\n");
    }
    for (index, folder) in runs.iter().enumerate() {
        let name = format!("run-{:02}", index + 1);
        let results = Results::read(&folder.join("results.csv"))?;
        let mut random = Random::new(recording.seed.wrapping_add(index as u64));
        let files = [
            ("camera.csv", results.camera()),
            ("controller.csv", results.controller()),
            ("plant.csv", results.plant(recording, &mut random)),
        ];
        let target = out.join(&name);
        std::fs::create_dir_all(&target).map_err(io(&target))?;
        for (file, text) in files.into_iter().filter_map(|(file, text)| Some((file, text?))) {
            let path = target.join(file);
            std::fs::write(&path, text).map_err(io(&path))?;
        }
        let _ = write!(manifest, "\n[[run]]\ndir = \"{name}\"\n");
    }
    let path = out.join("dataset.toml");
    std::fs::write(&path, manifest).map_err(io(&path))
}

fn io(path: &Path) -> impl FnOnce(std::io::Error) -> Error {
    let path = path.to_owned();
    move |source| Error::Io { path, source }
}

/// The results of one run, as they stand in the file.
struct Results {
    head: Vec<String>,
    rows: Vec<csv::StringRecord>,
}

impl Results {
    fn read(path: &Path) -> Result<Self, Error> {
        let refused = |error: csv::Error| io(path)(error.into());
        let mut reader = csv::Reader::from_path(path).map_err(refused)?;
        let head = reader.headers().map_err(refused)?.iter().map(str::to_owned).collect();
        let rows = reader.records().collect::<Result<_, _>>().map_err(refused)?;
        Ok(Self { head, rows })
    }

    fn column(&self, name: &str) -> Option<usize> {
        self.head.iter().position(|head| head == name)
    }

    /// Columns of one unit that a data set may hold: bare name, and place in the file.
    fn columns<'a>(&self, unit: &str, names: &[&'a str]) -> Vec<(&'a str, usize)> {
        let place = |name: &&'a str| Some((*name, self.column(&format!("{unit}.{name}"))?));
        names.iter().filter_map(place).collect()
    }

    /// A row at the first time and whenever one of `triggers` changes.
    fn changes(&self, columns: &[(&str, usize)], triggers: &[usize]) -> String {
        let mut text = head(columns);
        let mut last: Option<&csv::StringRecord> = None;
        for row in &self.rows {
            if last.is_none_or(|last| triggers.iter().any(|at| last.get(*at) != row.get(*at))) {
                push(&mut text, row, columns);
            }
            last = Some(row);
        }
        text
    }

    fn camera(&self) -> Option<String> {
        let frame = self.column("camera.frame")?;
        // Before the first delivery (frame 0) there is nothing to log.
        let delivered = |row: &&csv::StringRecord| row.get(frame) != Some("0");
        let rows = self.rows.iter().filter(delivered).cloned().collect();
        let columns = self.columns("camera", CAMERA_COLUMNS);
        (!columns.is_empty()).then(|| Self { head: self.head.clone(), rows }.changes(&columns, &[frame]))
    }

    fn controller(&self) -> Option<String> {
        let columns = self.columns("controller", &CONTROLLER_COLUMNS[..2]);
        let torque = self.column("controller.tau")?;
        // With a camera in the loop the torque is computed when a frame has been delivered, else when it changes.
        let triggers = [Some(torque), self.column("controller.frame")];
        Some(self.changes(&columns, &triggers.into_iter().flatten().collect::<Vec<_>>()))
    }

    fn plant(&self, recording: &Recording, random: &mut Random) -> Option<String> {
        let columns = self.columns("plant", &["q1", "q2"]);
        if columns.is_empty() || recording.encoder_rate.is_nan() || recording.encoder_rate <= 0.0 {
            return None;
        }
        let mut text = head(&columns);
        let mut next = f64::NEG_INFINITY;
        for row in &self.rows {
            let number =
                |at: usize| row.get(at).and_then(|cell| cell.parse::<f64>().ok()).unwrap_or(f64::NAN);
            let time = number(0);
            // Half a microsecond: the file's times are rounded doubles of exact points.
            if time + 5e-7 < next {
                continue;
            }
            next = if next.is_finite() { next } else { time } + 1.0 / recording.encoder_rate;
            text.push_str(row.get(0).unwrap_or_default());
            for (_, at) in &columns {
                let _ = write!(text, ",{}", number(*at) + recording.encoder_noise * random.normal());
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

fn push(text: &mut String, row: &csv::StringRecord, columns: &[(&str, usize)]) {
    text.push_str(row.get(0).unwrap_or_default());
    for (_, at) in columns {
        text.push(',');
        text.push_str(row.get(*at).unwrap_or_default());
    }
    text.push('\n');
}
