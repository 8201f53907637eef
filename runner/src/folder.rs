//! A folder for results: nothing of an earlier call stands beside what a new one writes, and a call that writes nothing
//! leaves nothing.

use crate::error::Error;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Folders that this process made, in the order in which they were made.
static MADE: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// A folder that is there. Dropped, it takes away again what was made of it and is still empty.
pub struct Folder {
    path: PathBuf,
}

impl Folder {
    /// Makes it, and those above it, where they are missing.
    pub fn make(path: &Path) -> Result<Self, Error> {
        let missing: Vec<PathBuf> =
            path.ancestors().take_while(|part| !part.exists()).map(Path::to_owned).collect();
        // Noted first: what is made of them vanishes also if the last one can't be made.
        let mut made = MADE.lock().unwrap_or_else(PoisonError::into_inner);
        made.extend(missing.into_iter().rev().filter(|part| !part.as_os_str().is_empty()));
        drop(made);
        let folder = Self { path: path.to_owned() };
        std::fs::create_dir_all(path).map_err(|why| match path.ancestors().find(|part| part.exists()) {
            Some(file) if !file.is_dir() => Error::File {
                path: path.to_owned(),
                why: format!(
                    "{} is a file; expected a folder, which is made where it is missing",
                    file.display()
                ),
            },
            _ => Error::File { path: path.to_owned(), why: format!("the folder can't be made: {why}") },
        })?;
        Ok(folder)
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The path of a file in it.
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Removes files of an earlier call.
    pub fn clear(&self, names: &[&str]) -> Result<(), Error> {
        for name in names {
            let path = self.file(name);
            match std::fs::remove_file(&path) {
                Err(why) if why.kind() != std::io::ErrorKind::NotFound => {
                    return Err(Error::file(&path)(why));
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Writes a file; where that fails, on a full disk for example, no half of it is left.
    pub fn write(&self, name: &str, text: &str) -> Result<(), Error> {
        let path = self.file(name);
        std::fs::write(&path, text).map_err(|why| {
            if path.is_file() {
                // What can't be taken away stays.
                let _ = std::fs::remove_file(&path);
            }
            Error::file(&path)(why)
        })
    }
}

/// Refuses to write over a file that is read for it.
///
/// # Errors
/// Names it.
pub fn keep(written: &[PathBuf], read: &[PathBuf]) -> Result<(), Error> {
    // what isn't there is no file that is read
    let found = |path: &PathBuf| std::fs::canonicalize(path).ok();
    let read: Vec<PathBuf> = read.iter().filter_map(found).collect();
    match written.iter().find(|path| found(path).is_some_and(|place| read.contains(&place))) {
        None => Ok(()),
        Some(path) => {
            let why =
                "it is read for this, and would be written over: name another place for what is written";
            Err(Error::File { path: path.clone(), why: why.into() })
        }
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        remove_empty();
    }
}

/// Removes the folders that this process made and that hold nothing.
pub fn remove_empty() {
    let mut made = MADE.lock().unwrap_or_else(PoisonError::into_inner);
    for folder in made.drain(..).rev() {
        // Refused where it holds something, which is the point.
        let _ = std::fs::remove_dir(folder);
    }
}

#[cfg(test)]
mod tests {
    use super::Folder;

    #[test]
    fn law_an_empty_folder_vanishes_with_those_above_it_and_a_full_one_stays() {
        let root = tempfile::tempdir().expect("a temporary folder");
        let at = |path: &str| root.path().join(path);
        drop(Folder::make(&at("a/b/c")).expect("made"));
        assert!(!at("a").exists() && root.path().exists(), "only what was made is taken away");
        let folder = Folder::make(&at("d/e")).expect("made");
        folder.write("file", "text").expect("written");
        drop(folder);
        assert!(at("d/e/file").exists());
        let folder = Folder::make(&at("d/e")).expect("it is there");
        folder.clear(&["file", "never was"]).expect("cleared");
        drop(folder);
        assert!(at("d/e").exists(), "it was there before");
        std::fs::write(at("in the way"), "").expect("written");
        for path in ["in the way", "in the way/below"] {
            let told = Folder::make(&at(path)).map(drop).expect_err("a file is there").to_string();
            assert!(told.contains("in the way is a file; expected a folder"), "{told}");
        }
    }
}
