//! The data set as far as columns and names tell it, tried as a diagnosis would read it: with which signs stretches of the logs are followed,
//! and whether the model remembers states that no variable shows.
//!
//! It lies in a temporary folder: what an import leaves that failed, or that a unit ended, is nothing.

use super::{starts, write};
use crate::check::{self, Signs};
use crate::dynamics::build::build;
use crate::observe::{self, Problem};
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
    /// Parameters that are starts of states which no variable shows.
    pub unshown: Vec<usize>,
}

/// Tries what was found so far. What can't be read is told by the data set itself.
pub(super) fn try_draft(
    file: &Path,
    fmu: &Fmu,
    units: &UnitPath,
    isolation: Option<&Isolation>,
    found: &write::Found<'_>,
) -> Tried {
    let Ok(draft) = Bench::new() else { return Tried::default() };
    let read = |found: &write::Found<'_>| {
        write::folder(draft.path(), file, fmu, found).ok()?;
        observe::load(draft.path(), units, isolation).ok()
    };
    let Some(problem) = read(found) else { return Tried::default() };
    if let Some(told) = check::too_long_times(&problem) {
        return Tried { too_long: Some(told), ..Tried::default() };
    }
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
    Tried { too_long: None, signs: check::signs(&problem), unshown }
}

/// Whether the model remembers more than the states that it can be begun from; it may have none.
fn remembers(problem: &Problem) -> bool {
    build(problem, &problem.whole_runs())
        .is_ok_and(|built| built.engine.machine.whole || !built.engine.remembered().is_empty())
}
