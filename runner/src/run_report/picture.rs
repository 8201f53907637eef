//! The picture on the page: of those that a unit wrote, with the places that it found in them.

use super::layout::{Mark, PictureEntry};
use crate::error::Error;
use report::{Page, Picture};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

impl PictureEntry {
    /// `unit.variable` of the parameter that takes the folder.
    pub fn directory_parameter(&self) -> String {
        format!("{}.{}", self.unit, self.directory)
    }

    /// Puts onto the page the middle one of the pictures whose marks came, `places` by number: the arm is at its farthest
    /// there.
    pub fn show(
        &self,
        shots: &[(PathBuf, u64)],
        places: &BTreeMap<u64, Vec<f64>>,
        page: &mut Page,
    ) -> Result<(), Error> {
        let delivered: Vec<_> = shots.iter().filter(|(_, number)| places.contains_key(number)).collect();
        if let Some((path, number)) = delivered.get(delivered.len() / 2) {
            let svg = self.marked(path, &places[number])?.to_svg();
            page.heading("Picture").figure(&svg, &format!("{}: frame {number}", self.caption));
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
