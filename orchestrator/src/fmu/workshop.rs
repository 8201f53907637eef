//! The one temporary folder of this process, in which units are unpacked, and what dead processes left of theirs.
//!
//! The folder is made with the first unit and vanishes with the last one. A process that is killed can't take its own
//! away; it holds a lock on a file in it, which the system lets go of with the process, so that the next process sees
//! that nobody lives there any more and removes it.

use crate::plain;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError, RwLock, RwLockReadGuard, TryLockError, Weak};
use std::time::Duration;
use tempfile::TempDir;

/// Begin of the folder's name.
const PREFIX: &str = "fmu-";
/// The file that a living process has locked.
const ALIVE: &str = ".alive";

static CURRENT: Mutex<Weak<Workshop>> = Mutex::new(Weak::new());

/// Read while a unit is unpacked; written by who takes all of it away.
static UNPACKING: RwLock<()> = RwLock::new(());

/// To be held while files are written into a [`Bench`].
pub(crate) fn unpacking() -> RwLockReadGuard<'static, ()> {
    UNPACKING.read().unwrap_or_else(PoisonError::into_inner)
}

/// The folder. Dropping the last reference deletes it.
#[derive(Debug)]
pub(crate) struct Workshop {
    folder: TempDir,
    _lock: File,
}

#[cfg(unix)]
impl Drop for Workshop {
    fn drop(&mut self) {
        crate::guard::unpacked_in(None);
    }
}

/// A folder for one unit, or for what is tried with one. Dropping it deletes it; an end of the process that a unit brings about does, too.
#[derive(Debug)]
pub struct Bench {
    // Dropped before the workshop that it lies in.
    folder: TempDir,
    _workshop: Arc<Workshop>,
}

impl Bench {
    /// An empty one.
    ///
    /// # Errors
    /// There is no room for temporary files.
    pub fn new() -> io::Result<Self> {
        let workshop = Workshop::of_this_process()?;
        Ok(Self { folder: TempDir::with_prefix_in("unit-", workshop.folder.path())?, _workshop: workshop })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }
}

impl Workshop {
    fn of_this_process() -> io::Result<Arc<Self>> {
        let mut current = CURRENT.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(workshop) = current.upgrade() {
            return Ok(workshop);
        }
        let temporary = std::env::temp_dir();
        sweep(&temporary);
        let folder = TempDir::with_prefix_in(PREFIX, &temporary)?;
        let lock = locked(folder.path())?;
        #[cfg(unix)]
        crate::guard::unpacked_in(Some(folder.path()));
        let workshop = Arc::new(Self { folder, _lock: lock });
        *current = Arc::downgrade(&workshop);
        Ok(workshop)
    }
}

/// The file gets its name only once it is locked: under that name it is never seen unlocked while we live.
fn locked(folder: &Path) -> io::Result<File> {
    let unnamed = folder.join(".being-locked");
    let file = File::create(&unnamed)?;
    file.lock()?;
    fs::rename(unnamed, folder.join(ALIVE))?;
    Ok(file)
}

/// Removes the folders of processes that are gone. What can't be removed, another user's say, is left alone.
fn sweep(temporary: &Path) {
    let entries = fs::read_dir(temporary).into_iter().flatten().flatten();
    let ours = entries.filter(|entry| entry.file_name().to_string_lossy().starts_with(PREFIX));
    for folder in ours.map(|entry| entry.path()) {
        // A folder without the file is not ours, or was made a moment ago; one with a pipe of that name is somebody's who waits for us.
        let Ok(alive) = plain::open(&folder.join(ALIVE)) else { continue };
        if alive.try_lock().is_ok() {
            let _ = fs::remove_dir_all(&folder);
        }
    }
}

/// Removes what this process has unpacked, for one that is about to end without dropping anything: after a signal, say.
/// Units that run go on, since their libraries are mapped; one that reads its resources afterwards fails. Other threads unpack
/// nothing more: those that try wait for the end.
pub fn discard_unpacked() {
    // A thread that is unpacking would make its folders anew. It takes milliseconds; a disk that hangs is not waited for.
    for _ in 0..200 {
        match UNPACKING.try_write() {
            Err(TryLockError::WouldBlock) => std::thread::sleep(Duration::from_millis(5)),
            held => {
                std::mem::forget(held);
                break;
            }
        }
    }
    let folder: Option<PathBuf> = {
        let current = CURRENT.lock().unwrap_or_else(PoisonError::into_inner);
        current.upgrade().map(|workshop| workshop.folder.path().to_owned())
    };
    if let Some(folder) = folder {
        let _ = fs::remove_dir_all(folder);
    }
}

#[cfg(test)]
mod tests {
    use super::{ALIVE, Bench, PREFIX, locked, sweep};
    use std::fs;

    /// In a process of its own: other tests unpack meanwhile.
    #[cfg(unix)]
    #[test]
    fn law_a_folder_that_has_gone_is_nobodys_to_remove() {
        if !crate::alone::is_alone() {
            return;
        }
        assert!(!crate::guard::has_unpacked());
        let (one, other) = (Bench::new().expect("a folder"), Bench::new().expect("another"));
        assert!(one.path().is_dir() && one.path().parent() == other.path().parent());
        drop(one);
        assert!(crate::guard::has_unpacked() && other.path().is_dir());
        drop(other);
        assert!(!crate::guard::has_unpacked());
    }

    #[test]
    fn law_folders_of_the_dead_are_swept_and_no_others() {
        let temporary = tempfile::tempdir().expect("a temporary folder");
        let folder = |name: &str| {
            let folder = temporary.path().join(format!("{PREFIX}{name}"));
            fs::create_dir_all(folder.join("unit-1/binaries")).expect("writable");
            folder
        };
        let (dead, living, foreign) = (folder("dead"), folder("living"), folder("foreign"));
        drop(locked(&dead).expect("locked"));
        let lock = locked(&living).expect("locked");
        sweep(temporary.path());
        assert!(!dead.exists() && living.join(ALIVE).exists() && foreign.exists());
        // to open a pipe waits for a writer, who may never come
        #[cfg(unix)]
        {
            let made = std::process::Command::new("mkfifo").arg(foreign.join(ALIVE)).status();
            assert!(made.expect("of POSIX").success());
            sweep(temporary.path());
            assert!(foreign.exists());
        }
        drop(lock);
        sweep(temporary.path());
        assert!(!living.exists(), "its process is gone now");
    }
}
