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
    encode().map_err(|error| {
        // No picture rather than the begin of one. What stood in the way may stand in the way of this, too.
        let _ = std::fs::remove_file(&path);
        failure(&path, &error)
    })
}

fn failure(path: &Path, error: &dyn std::fmt::Display) -> ModelError {
    ModelError::Value {
        name: "frames_dir",
        value: path.display().to_string(),
        expected: format!("a place that frames can be written to ({error})"),
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::{Plane, Sensor, write};

    /// A device on which nothing has room stands for the disk.
    #[test]
    fn law_a_full_disk_is_told_and_leaves_no_half_picture() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let frame = folder.path().join("frame_000002.png");
        std::os::unix::fs::symlink("/dev/full", &frame).expect("writable");
        let sensor = Sensor { frames_dir: folder.path().display().to_string(), ..Sensor::default() };
        let error = write(&sensor, 2, &Plane::filled(8, 8, 0, 0)).expect_err("no room").to_string();
        let told = format!("frames_dir = {}", frame.display());
        assert!(error.contains(&told) && error.contains("No space left on device"), "{error}");
        assert!(frame.symlink_metadata().is_err(), "the name is free");
        // The next one may have room again.
        write(&sensor, 2, &Plane::filled(8, 8, 0, 0)).expect("written");
    }
}
