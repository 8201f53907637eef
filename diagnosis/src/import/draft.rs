//! The data set as far as columns and names tell it, tried as a diagnosis would read it: with which signs stretches of the logs are followed,
//! and which parameters start states that no name tells of, or no variable shows.
//!
//! It lies in a temporary folder: what an import leaves that failed, or that a unit ended, is nothing.

use super::starts::{self, Start};
use super::{unshown, write};
use crate::check::{self, Signs};
use crate::observe;
use orchestrator::fmu::Bench;
use orchestrator::{Fmu, Isolation, UnitPath};
use std::path::Path;

/// What a draft tells.
#[derive(Debug, Default)]
pub(super) struct Tried {
    /// In what unit of time the model follows the logs, where that is a shorter one; nothing else is tried then, for in these times the unit
    /// takes a thousand times as long, and follows nothing.
    pub too_long: Option<String>,
    /// The signs with which stretches of the logs are followed, where they tell.
    pub signs: Option<Signs>,
    /// Parameters that start what a variable shows, though no name says so.
    pub shown: Vec<Start>,
    /// Parameters that are starts of states which no variable shows.
    pub unshown: Vec<usize>,
}

/// Tries what was found so far; `maybe`: which parameters may start what a variable shows. What can't be read is told by the data set itself.
pub(super) fn try_draft(
    file: &Path,
    fmu: &Fmu,
    units: &UnitPath,
    isolation: Option<&Isolation>,
    found: &write::Found<'_>,
    maybe: &[Start],
) -> Tried {
    let Ok(draft) = Bench::new() else { return Tried::default() };
    let written = write::folder(draft.path(), file, fmu, found);
    let read = written.and_then(|_| observe::load(draft.path(), units, isolation));
    let Ok(problem) = read.map(|problem| problem.as_it_is()) else { return Tried::default() };
    if let Some(told) = check::too_long_times(&problem) {
        return Tried { too_long: Some(told), ..Tried::default() };
    }
    let likely = starts::likely(fmu, found.candidates, maybe);
    let begins = unshown::among(&problem, &likely, &starts::numbers(fmu, found.candidates));
    let is_shown = |one: &unshown::Likely| Some(Start { start: one.start, shows: one.shows? });
    let unshown = begins.iter().filter(|one| one.shows.is_none()).map(|one| one.start).collect();
    let shown = begins.iter().filter_map(is_shown).collect();
    Tried { too_long: None, signs: check::signs(&problem), shown, unshown }
}
