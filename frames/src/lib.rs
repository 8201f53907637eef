//! Recorded images of a real camera go through the camera unit's own vision and become `camera.csv` of a data set
//! (`acroscope import --frames`).
//!
//! - `settings.rs`: the camera of a scenario as values: threshold, areas, estimator, scene
//! - `sequence.rs`: the files of a folder in their order
//! - `times.rs`: when each frame was taken
//! - `picture.rs`: a file as grey levels
//! - `folder.rs`: the data set that is written

#![forbid(unsafe_code)]

mod error;
mod folder;
mod picture;
mod sequence;
mod settings;
mod times;

pub use error::Error;
pub use times::{Stamp, Times};

use camera::recorded::Recorded;
use camera::shutter::FrameClock;
use camera::vision::Estimate;
use picture::Grey;
use rayon::prelude::*;
use sequence::Frame;
use std::path::{Path, PathBuf};

/// Frames that are decoded side by side. Memory holds so many, whatever the length of a recording.
const BATCH: usize = 32;

/// What is to be read, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// A folder of images a run.
    pub folders: Vec<PathBuf>,
    /// When the frames of each run were taken: one for all runs, or one a run.
    pub times: Vec<Times>,
    /// What the times are times of.
    pub stamp: Stamp,
    /// The nominal scenario: the name of a shipped one, or a path.
    pub scenario: String,
    /// Values that differ from it: `unit.variable=value`.
    pub set: Vec<String>,
    /// Value of a pixel that is as bright as can be, for images of 16 bit; `None`: 65535.
    pub white: Option<u16>,
}

/// What was written.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Imported {
    /// The files, in the order of the runs.
    pub written: Vec<PathBuf>,
    /// Frames of each run, and how many of them show all three circles.
    pub counts: Vec<(usize, usize)>,
    /// What a user should look at.
    pub notices: Vec<String>,
}

/// Looks at every frame of every folder and writes a data set.
///
/// # Errors
/// The scenario has no camera of ours, a folder has no images, an image can't be read or has another size than the camera, a time
/// is missing, or the data set can't be written.
pub fn import(recording: &Recording, out: &Path) -> Result<Imported, Error> {
    let settings = settings::read(&recording.scenario, &recording.set)?;
    let (folders, times) = (recording.folders.len(), recording.times.len());
    if times != 1 && times != folders {
        return Err(Error::Times { folders, times });
    }
    let runs = folder::runs(out, folders)?;
    let mut imported = Imported::default();
    let mut texts = Vec::new();
    for (run, images) in recording.folders.iter().enumerate() {
        let times = if times == 1 { &recording.times[0] } else { &recording.times[run] };
        let frames = sequence::list(images, &mut imported.notices)?;
        let times = times.of(&frames, images, &mut imported.notices)?;
        let rows = look(recording, &settings, &frames, &times, images, &mut imported)?;
        texts.push(rows);
    }
    imported.written = folder::write(out, recording, &runs, &texts, &mut imported.notices)?;
    Ok(imported)
}

/// The lines of one run.
fn look(
    recording: &Recording,
    settings: &settings::Settings,
    frames: &[Frame],
    times: &[f64],
    images: &Path,
    imported: &mut Imported,
) -> Result<String, Error> {
    let refused = |source| settings.refused(source);
    let mut vision = Recorded::new(settings.variables.clone()).map_err(refused)?;
    let sensor = &settings.variables.sensor;
    let clock = FrameClock::new(sensor);
    let mut text = folder::head(recording.stamp);
    let mut depth = picture::Depth::default();
    let (mut found, mut first_lost) = (0, None);
    for (batch, times) in frames.chunks(BATCH).zip(times.chunks(BATCH)) {
        let read = |frame: &Frame| {
            let fits = |size| settings.fits(&frame.path, size, vision.size(frame.number));
            picture::read(&frame.path, recording.white, fits)
        };
        let decoded: Vec<Result<Grey, Error>> = batch.par_iter().map(read).collect();
        for ((frame, grey), time) in batch.iter().zip(decoded).zip(times) {
            let grey = grey?;
            depth.seen(&grey);
            let moments = recording.stamp.moments(*time, &clock, sensor.delay);
            let estimate = vision.look(frame.number, moments.middle, &grey.pixels);
            found += usize::from(estimate.valid);
            if !estimate.valid && first_lost.is_none() {
                first_lost = Some((frame.path.clone(), vision.areas()));
            }
            text.push_str(&line(recording.stamp, &moments, frame.place, &estimate));
        }
    }
    imported.notices.extend(depth.told(images, recording.white));
    if let Some((path, areas)) = first_lost {
        imported.notices.push(settings.lost(&path, &areas, frames.len() - found, frames.len()));
    }
    imported.counts.push((frames.len(), found));
    Ok(text)
}

/// A row of `camera.csv`: a frame without circles has empty cells.
fn line(stamp: Stamp, moments: &times::Moments, place: usize, estimate: &Estimate) -> String {
    let mut cells = vec![moments.delivered.to_string(), place.to_string()];
    if stamp != Stamp::Delivered {
        cells.push(moments.middle.to_string());
    }
    let circles = estimate.circles.iter();
    let seen = |value: f64| if estimate.valid { value.to_string() } else { String::new() };
    cells.extend([estimate.angles.0, estimate.angles.1].map(seen));
    cells.extend(circles.clone().flat_map(|circle| [circle.centre_px.0, circle.centre_px.1]).map(seen));
    cells.extend(circles.map(|circle| circle.area_px).map(seen));
    cells.push(u8::from(estimate.valid).to_string());
    cells.join(",") + "\n"
}
