//! Frames as PNG files for people and for other programs.

use crate::photometry::Plane;
use crate::variables::Sensor;
use fmi2_export::ModelError;
use std::path::{Path, PathBuf};

/// Whether frame `k` is to be written.
pub fn wants(sensor: &Sensor, k: i64) -> bool {
    !sensor.frames_dir.is_empty() && k.rem_euclid(i64::from(sensor.frames_every.max(1))) == 0
}

/// Makes the folder if frames are to be written.
///
/// # Errors
/// The folder can't be made.
pub fn prepare(sensor: &Sensor) -> Result<(), ModelError> {
    if sensor.frames_dir.is_empty() {
        return Ok(());
    }
    let folder = Path::new(&sensor.frames_dir);
    std::fs::create_dir_all(folder).map_err(|error| failure(folder, &error))
}

/// Writes frame `k` as 8-bit grey; of an interlaced frame the rows of its field only.
///
/// # Errors
/// The file can't be written.
pub fn write(sensor: &Sensor, k: i64, picture: &Plane<u8>) -> Result<(), ModelError> {
    let path: PathBuf = Path::new(&sensor.frames_dir).join(format!("frame_{k:06}.png"));
    let (first, step) = if sensor.interlaced { (k.rem_euclid(2) as usize, 2) } else { (0, 1) };
    let rows: Vec<&[u8]> = (first..picture.height).step_by(step).map(|y| picture.row(y)).collect();
    let encode = || -> Result<(), png::EncodingError> {
        let file = std::io::BufWriter::new(std::fs::File::create(&path)?);
        let mut encoder = png::Encoder::new(file, picture.width as u32, rows.len() as u32);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&rows.concat())?;
        writer.finish()
    };
    encode().map_err(|error| failure(&path, &error))
}

fn failure(path: &Path, error: &dyn std::fmt::Display) -> ModelError {
    ModelError::Value {
        name: "frames_dir",
        value: path.display().to_string(),
        expected: format!("a place that frames can be written to ({error})"),
    }
}
