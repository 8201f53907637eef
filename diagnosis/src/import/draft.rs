//! The data set as far as columns and names tell it, tried as a diagnosis would read it: with which signs stretches of the logs are followed,
//! and which parameters start states that no name tells of, or no variable shows.
//!
//! It lies in a temporary folder: what an import leaves that failed, or that a unit ended, is nothing.

use super::slow::{Pace, WRITE_IT};
use super::starts::{self, Start};
use super::{unshown, write};
use crate::check::{self, Signs};
use crate::observe::{self, Problem};
use orchestrator::fmu::Bench;
use orchestrator::{Fmu, Isolation, UnitPath};
use std::path::Path;
use std::time::Instant;

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

/// What a draft is made with.
pub(super) struct Draft<'a> {
    /// The unit's file.
    pub file: &'a Path,
    /// Where units lie.
    pub units: &'a UnitPath,
    /// Limits of processes of its own, if runs are made in such.
    pub isolation: Option<&'a Isolation>,
    /// How far apart the rows of the longest log are.
    pub pace: &'a Pace,
}

/// Tries what was found so far, within the time that there is: what was found after it stands on steps that were not made. `maybe`: which
/// parameters may start what a variable shows. What can't be read is told by the data set itself.
pub(super) fn try_draft(with: &Draft<'_>, fmu: &Fmu, found: &write::Found<'_>, maybe: &[Start]) -> Tried {
    let Draft { file, units, isolation, pace } = *with;
    let Ok(draft) = Bench::new() else { return Tried::default() };
    let written = write::folder(draft.path(), file, fmu, found);
    let read = written.and_then(|_| observe::load(draft.path(), units, isolation));
    let Ok(problem) = read.map(|problem| problem.as_it_is()) else { return Tried::default() };
    let deadline = Instant::now() + pace.patience();
    let problem = Problem { deadline: Some(deadline), ..problem };
    if let Some(told) = check::too_long_times(&problem) {
        return Tried { too_long: Some(format!("{told}. {WRITE_IT}")), ..Tried::default() };
    }
    let likely = starts::likely(fmu, found.candidates, maybe);
    let begins = unshown::among(&problem, &likely, &starts::numbers(fmu, found.candidates));
    let is_shown = |one: &unshown::Likely| Some(Start { start: one.start, shows: one.shows? });
    let unshown = begins.iter().filter(|one| one.shows.is_none()).map(|one| one.start).collect();
    let shown = begins.iter().filter_map(is_shown).collect();
    let signs = check::signs(&problem);
    if Instant::now() >= deadline {
        return Tried { too_long: Some(pace.too_slow()), ..Tried::default() };
    }
    Tried { too_long: None, signs, shown, unshown }
}
