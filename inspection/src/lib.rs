//! Looks at an FMU from outside. [`check`] tells what is wrong with it: rules that read the archive and the description,
//! and rules that run the unit, each in a process of its own, so that whatever the unit does is a finding. [`draft`] makes
//! a first scenario of descriptions alone.
//!
//! A rule is a function and a row in the table of `statics/mod.rs` or `dynamics/mod.rs`, with a section in `docs/check.md`.
//!
//! A program that checks units begins its `main` with [`host_rules`]:
//!
//! ```no_run
//! use inspection::{Limits, Severity};
//!
//! inspection::host_rules(["(the process of a check)"]);
//! let findings = inspection::check("target/fmus/acrobot_plant.fmu".as_ref(), &Limits::default())?;
//! assert!(findings.iter().all(|finding| finding.severity != Severity::Error));
//! # Ok::<(), inspection::Error>(())
//! ```

mod archive;
pub mod draft;
mod dynamics;
mod error;
mod finding;
mod looked;
mod model;
mod statics;
mod xml;

pub use dynamics::{Limits, host_rules, host_rules_by};
pub use error::Error;
pub use finding::{Finding, Severity};
pub use looked::{LeftOut, Looked};

use archive::Archive;
use finding::Found;
use std::path::Path;

/// The names of all rules, in the order in which they are looked at.
pub fn rules() -> Vec<&'static str> {
    [ARCHIVE].into_iter().chain(statics::names()).chain(dynamics::names()).collect()
}

/// The rule that the file is an archive at all.
const ARCHIVE: &str = "archive";

/// What all rules find, in the order of the rules. A unit that can't be opened has no findings of those that run it:
/// [`look`] says which were left out.
///
/// # Errors
/// If the file can't be read, or no process be started.
pub fn check(path: &Path, limits: &Limits) -> Result<Vec<Finding>, Error> {
    Ok(look(path, limits)?.findings)
}

/// What all rules find, and which of them were not looked at.
///
/// # Errors
/// If the file can't be read, or no process be started.
pub fn look(path: &Path, limits: &Limits) -> Result<Looked, Error> {
    let archive = match Archive::read(path)? {
        Ok(archive) => archive,
        Err(why) => {
            let mut found = Found::new(ARCHIVE);
            found.error(format!("it is no zip archive that can be read: {why}"));
            let others = rules().into_iter().filter(|rule| *rule != ARCHIVE);
            let why = "the file is no zip archive";
            let left_out = others.map(|rule| LeftOut { rule, why: why.into() }).collect();
            return Ok(Looked { findings: found.findings, left_out });
        }
    };
    let (mut findings, mut left_out) = statics::findings(&archive);
    let run = dynamics::findings(path, &archive, limits, &findings)?;
    findings.extend(run.findings);
    left_out.extend(run.left_out);
    Ok(Looked { findings, left_out })
}

/// What one of the rules that run the unit finds, by itself.
///
/// # Errors
/// If there is no such rule, the file can't be read, or no process be started.
pub fn check_by(rule: &str, path: &Path, limits: &Limits) -> Result<Vec<Finding>, Error> {
    dynamics::findings_by(rule, path, limits)
}
