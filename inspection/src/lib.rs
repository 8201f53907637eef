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
mod model;
mod statics;
mod xml;

pub use dynamics::{Limits, host_rules, host_rules_by};
pub use error::Error;
pub use finding::{Finding, Severity};

use archive::Archive;
use finding::Found;
use std::path::Path;

/// The names of all rules, in the order in which they are looked at.
pub fn rules() -> Vec<&'static str> {
    [ARCHIVE].into_iter().chain(statics::names()).chain(dynamics::names()).collect()
}

/// The rule that the file is an archive at all.
const ARCHIVE: &str = "archive";

/// What all rules find, in the order of the rules. A unit that can't be opened has no findings of those that run it.
///
/// # Errors
/// If the file can't be read, or no process be started.
pub fn check(path: &Path, limits: &Limits) -> Result<Vec<Finding>, Error> {
    let archive = match Archive::read(path)? {
        Ok(archive) => archive,
        Err(why) => {
            let mut found = Found::new(ARCHIVE);
            found.error(format!("it is no zip archive that can be read: {why}"));
            return Ok(found.findings);
        }
    };
    let mut findings = statics::findings(&archive);
    findings.extend(dynamics::findings(path, &archive, limits, &findings)?);
    Ok(findings)
}

/// What one of the rules that run the unit finds, by itself.
///
/// # Errors
/// If there is no such rule, the file can't be read, or no process be started.
pub fn check_by(rule: &str, path: &Path, limits: &Limits) -> Result<Vec<Finding>, Error> {
    dynamics::findings_by(rule, path, limits)
}
