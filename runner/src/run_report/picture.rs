//! The picture on the page: of those that a unit wrote, with the places that it found in them.

use super::layout::{Mark, PictureEntry};
use super::series::At;
use crate::error::Error;
use report::head::short;
use report::{Page, Picture};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

impl PictureEntry {
    /// `unit.variable` of the parameter that takes the folder.
    pub fn directory_parameter(&self) -> String {
        format!("{}.{}", self.unit, self.directory)
    }

    /// Puts onto the page one of the pictures whose marks came, `places` by number: of a run that failed the last one before that.
    pub fn show(
        &self,
        shots: &[(PathBuf, u64)],
        places: &BTreeMap<u64, At>,
        failed: Option<f64>,
        page: &mut Page,
    ) -> Result<(), Error> {
        let delivered = shots.iter().filter_map(|(path, number)| Some((path, *number, places.get(number)?)));
        let delivered: Vec<(&PathBuf, u64, &At)> = delivered.collect();
        let times: Vec<f64> = delivered.iter().map(|(_, _, at)| at.time).collect();
        if let Some((path, number, at)) = delivered.get(chosen(&times, failed)) {
            let svg = self.marked(path, &at.values)?.to_svg();
            let before = match failed {
                Some(failed) if at.time <= failed => {
                    format!(", the last one kept before the failure at {} s", short(failed))
                }
                _ => String::new(),
            };
            let caption =
                format!("{}: frame {number}, delivered at t = {} s{before}", self.caption, short(at.time));
            page.heading("Picture").figure(&svg, &caption);
        }
        Ok(())
    }

    /// The picture with its marks; `places` holds u and v of each in turn, in pixels from the centre, v up.
    fn marked(&self, path: &Path, places: &[f64]) -> Result<Picture, Error> {
        let png = std::fs::read(path).map_err(Error::file(path))?;
        let decoder = png::Decoder::new(std::io::Cursor::new(png.as_slice()));
        let reader =
            decoder.read_info().map_err(|why| Error::File { path: path.to_owned(), why: why.to_string() })?;
        let size = (reader.info().width, reader.info().height);
        let centre = (f64::from(size.0) / 2.0, f64::from(size.1) / 2.0);
        let names = self.marks.iter().map(|Mark(u, v)| format!("{u}, {v}"));
        let marks = names
            .zip(places.chunks_exact(2))
            .map(|(name, place)| (name, centre.0 + place[0], centre.1 - place[1]));
        Ok(Picture { png, size, marks: marks.collect() })
    }
}

/// The place of the picture that is shown: the last one up to a failure, else the middle one, where the arm is at its farthest.
fn chosen(times: &[f64], failed: Option<f64>) -> usize {
    match failed {
        Some(failed) => times.iter().filter(|time| **time <= failed).count().saturating_sub(1),
        None => times.len() / 2,
    }
}

/// Pictures with the times at which they were written.
pub type Dated = Vec<(PathBuf, SystemTime)>;

/// Those of a folder, by now.
pub fn dated(folder: &Path) -> Result<Dated, Error> {
    let dated = |(path, _): (PathBuf, u64)| {
        let written = path.metadata().and_then(|metadata| metadata.modified()).map_err(Error::file(&path))?;
        Ok((path, written))
    };
    pictures(folder)?.into_iter().map(dated).collect()
}

/// Removes pictures, but not those that were written anew since.
pub fn clear(older: &Dated) -> Result<(), Error> {
    for (path, written) in older {
        if path.metadata().and_then(|metadata| metadata.modified()).is_ok_and(|now| now == *written) {
            std::fs::remove_file(path).map_err(Error::file(path))?;
        }
    }
    Ok(())
}

/// The numbered pictures of a folder, in order; none if there is no folder.
pub fn pictures(folder: &Path) -> Result<Vec<(PathBuf, u64)>, Error> {
    let mut found = Vec::new();
    if !folder.is_dir() {
        return Ok(found);
    }
    for entry in std::fs::read_dir(folder).map_err(Error::file(folder))? {
        let path = entry.map_err(Error::file(folder))?.path();
        let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        let number = stem.strip_prefix("frame_").and_then(|digits| digits.parse().ok());
        if let (Some(number), Some("png")) =
            (number, path.extension().and_then(|extension| extension.to_str()))
        {
            found.push((path, number));
        }
    }
    found.sort_by_key(|(_, number)| *number);
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::chosen;

    #[test]
    fn value_a_run_that_failed_shows_what_was_seen_before() {
        let times = [0.05, 5.05, 10.05, 15.05];
        assert_eq!(chosen(&times, None), 2);
        assert_eq!(chosen(&times, Some(1.887)), 0);
        assert_eq!(chosen(&times, Some(12.0)), 2);
        assert_eq!(chosen(&times, Some(0.01)), 0, "none before: the first one after");
        assert_eq!((chosen(&[], None), chosen(&[], Some(1.0))), (0, 0));
    }
}
