//! The data set as far as columns and names tell it, tried as a diagnosis would read it: with which signs stretches of the logs are followed,
//! and whether the model remembers states that no variable shows.
//!
//! It lies in a folder of its own within the one that was asked for, and goes when it was tried: what a failed or killed import leaves is
//! no data set.

use super::{starts, write};
use crate::check::{self, Signs};
use crate::dynamics::build::build;
use crate::observe::{self, Problem};
use orchestrator::{Fmu, UnitPath};
use std::path::{Path, PathBuf};

/// Name of its folder.
const FOLDER: &str = ".import";

/// What a draft tells.
#[derive(Debug, Default)]
pub(super) struct Tried {
    /// The signs with which stretches of the logs are followed, where they tell.
    pub signs: Option<Signs>,
    /// Parameters that are starts of states which no variable shows.
    pub unshown: Vec<usize>,
}

/// The folder, with what there was of the one that holds it.
struct Draft {
    path: PathBuf,
}

impl Drop for Draft {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.path);
        // only one that is empty goes
        let _ = self.path.parent().map(std::fs::remove_dir);
    }
}

/// Tries what was found so far. What can't be read is told by the data set itself.
pub(super) fn of(out: &Path, file: &Path, fmu: &Fmu, units: &UnitPath, found: &write::Found<'_>) -> Tried {
    let draft = Draft { path: out.join(FOLDER) };
    // of an import that was killed
    let _ = std::fs::remove_dir_all(&draft.path);
    let read = |found: &write::Found<'_>| {
        write::folder(&draft.path, file, fmu, found).ok()?;
        observe::load(&draft.path, units, None).ok()
    };
    let Some(problem) = read(found) else { return Tried::default() };
    let suffices = |unshown: &[usize]| {
        read(&write::Found { unshown, ..*found }).is_some_and(|with| {
            build(&with, &with.whole_runs())
                .is_ok_and(|built| !built.engine.machine.whole && built.engine.begins_by_its_states())
        })
    };
    let mut unshown = starts::unshown(fmu, found.candidates);
    if unshown.is_empty() || !remembers(&problem) || !suffices(&unshown) {
        unshown.clear();
    }
    // a constant that is called like a start is none
    for one in unshown.clone() {
        let others: Vec<usize> = unshown.iter().copied().filter(|other| *other != one).collect();
        if !others.is_empty() && suffices(&others) {
            unshown = others;
        }
    }
    Tried { signs: check::signs(&problem), unshown }
}

/// Whether the model remembers more than the states that it can be begun from; it may have none.
fn remembers(problem: &Problem) -> bool {
    build(problem, &problem.whole_runs())
        .is_ok_and(|built| built.engine.machine.whole || !built.engine.remembered().is_empty())
}
