//! Pictures that the camera kept: `frame_000150.png` and so on.

use crate::Error;
use base64::Engine as _;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// A picture.
#[derive(Debug, Serialize)]
pub struct Frame {
    /// Its number, that of the camera's `frame_index`.
    pub number: u64,
    /// The file in base64.
    png: String,
}

/// Pictures of a page take this many bytes at most; of more, every second, third, ... is shown.
const ROOM: u64 = 12 << 20;

/// The pictures of a folder in order; none if there is no such folder.
pub fn read(folder: &Path) -> Result<Vec<Frame>, Error> {
    if !folder.is_dir() {
        return Ok(Vec::new());
    }
    let mut found: Vec<(u64, PathBuf, u64)> = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(refused(folder))? {
        let entry = entry.map_err(refused(folder))?;
        if let Some(number) = number(&entry.path()) {
            let size = entry.metadata().map_err(refused(&entry.path()))?.len();
            found.push((number, entry.path(), size));
        }
    }
    found.sort_unstable();
    let all: u64 = found.iter().map(|(.., size)| size).sum();
    let every = usize::try_from(all.div_ceil(ROOM).max(1)).unwrap_or(usize::MAX);
    let kept = found.iter().step_by(every).map(|(number, path, _)| {
        let png = std::fs::read(path).map_err(refused(path))?;
        Ok(Frame { number: *number, png: base64::engine::general_purpose::STANDARD.encode(png) })
    });
    kept.collect()
}

fn number(path: &Path) -> Option<u64> {
    let name = path.file_name()?.to_str()?;
    name.strip_prefix("frame_")?.strip_suffix(".png")?.parse().ok()
}

fn refused(path: &Path) -> impl Fn(std::io::Error) -> Error + '_ {
    |why| Error::File { path: path.to_owned(), why: why.to_string() }
}
