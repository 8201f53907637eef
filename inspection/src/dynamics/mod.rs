//! Rules that run the unit. A rule is a function and a row here; each runs in a process of its own (`worker.rs`).
//!
//! The process is not that of [`orchestrator::Isolation`]: rules need several instances in one process, and want to know
//! what the last calls of an instance do, which a master passes over.

mod bench;
mod calls;
mod categories;
mod dependencies;
mod derivatives;
mod instances;
mod leak;
mod references;
mod start;
mod state;
mod steps;
mod worker;

pub use worker::{host_rules, host_rules_by};

use crate::archive::Archive;
use crate::error::Error;
use crate::finding::{Finding, Found};
use crate::looked::{LeftOut, Looked};
use bench::{Bench, Halt};
use orchestrator::Fmu;
use std::path::Path;
use std::time::Duration;
use worker::Ended;

/// A rule that runs the unit.
struct Rule {
    id: &'static str,
    find: fn(&Bench, &mut Found) -> Result<(), Halt>,
    /// It compares runs with each other, which says nothing of a unit whose runs differ anyway.
    compares: bool,
}

const fn rule(id: &'static str, find: fn(&Bench, &mut Found) -> Result<(), Halt>) -> Rule {
    Rule { id, find, compares: false }
}

const fn comparing(id: &'static str, find: fn(&Bench, &mut Found) -> Result<(), Halt>) -> Rule {
    Rule { id, find, compares: true }
}

/// The first rule decides whether the others make sense, the second one whether those that compare do.
const RULES: &[Rule] = &[
    rule("runs", steps::runs),
    rule("repeatable", steps::repeatable),
    rule("start-values", start::values),
    rule("values-before-setup", start::early),
    comparing("values-in-initialization", start::late),
    comparing("start-time", start::time),
    rule("guid-checked", calls::guid),
    rule("output-range", steps::output_range),
    comparing("reset", instances::reset),
    comparing("several-instances", instances::several),
    comparing("threads", instances::threads),
    comparing("state-restore", state::restore),
    comparing("state-serialize", state::serialize),
    comparing("step-splitting", steps::splitting),
    comparing("dependencies", dependencies::dependencies),
    rule("directional-derivatives", derivatives::directional),
    rule("interpolation", derivatives::interpolation),
    rule("call-order", calls::order),
    rule("null-arguments", references::null),
    rule("unknown-references", references::unknown),
    rule("not-a-number", references::not_a_number),
    rule("log-categories", categories::categories),
    rule("leak", leak::leak),
];

/// Names of ends that a unit brings upon its process, in place of the rule that was looked at.
const ENDS: [&str; 3] = ["crash", "exit", "endless-loop"];

/// The names of these rules.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    RULES.iter().map(|rule| rule.id).chain(ENDS)
}

/// How a unit is kept within limits while it runs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Limits {
    /// Real time that a call may take.
    pub call: Duration,
    /// Bytes of memory that a process of the unit may have.
    pub memory: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { call: Duration::from_secs(10), memory: 4 << 30 }
    }
}

/// What all of them find in a unit that can be opened.
pub(crate) fn findings(
    path: &Path,
    archive: &Archive,
    limits: &Limits,
    before: &[Finding],
) -> Result<Looked, Error> {
    let mut found = Found::new(RULES[0].id);
    let why = if let Err(error) = Fmu::open(path) {
        // Most often the rules that read have said so in their words.
        if !before.iter().any(|finding| finding.severity == crate::Severity::Error) {
            found.error(format!("it can't be opened: {error}"));
        }
        "the unit can't be opened"
    } else if let Some(held) = elsewhere(archive) {
        if !held.is_empty() {
            let here = orchestrator::fmu::platforms()[0];
            found.note(format!(
                "it has libraries for {held} and none for this machine, {here}: it was not run"
            ));
        }
        "the unit has no library for this machine"
    } else if !worker::is_hosted() {
        found.note(
            "it was not run: this program can't start itself again as the process for that; `acroscope` can",
        );
        "this program can't run a unit in a process of its own"
    } else {
        return run_all(path, limits);
    };
    let left_out = names().map(|rule| LeftOut { rule, why: why.into() }).collect();
    Ok(Looked { findings: found.findings, left_out })
}

/// The platforms of its libraries, where none is for this machine.
fn elsewhere(archive: &Archive) -> Option<String> {
    let here = orchestrator::fmu::platforms();
    let platforms: Vec<&str> = archive.binaries.iter().map(|binary| binary.platform.as_str()).collect();
    (!platforms.iter().any(|platform| here.contains(platform))).then(|| platforms.join(", "))
}

/// What one of them finds.
pub(crate) fn findings_by(rule: &str, path: &Path, limits: &Limits) -> Result<Vec<Finding>, Error> {
    let Some(rule) = RULES.iter().find(|known| known.id == rule) else {
        let known = orchestrator::nearest(rule, RULES.iter().map(|rule| rule.id));
        return Err(Error::Rule { rule: rule.to_owned(), known });
    };
    Ok(run_one(rule, path, limits)?.0)
}

fn run_all(path: &Path, limits: &Limits) -> Result<Looked, Error> {
    let (mut all, mut left_out) = (Vec::new(), Vec::new());
    let (mut steady, mut broken) = (true, false);
    for rule in RULES.iter() {
        let mut leave_out = |why: &str| left_out.push(LeftOut { rule: rule.id, why: why.into() });
        if broken {
            leave_out("the unit does not get through its first plain run");
            continue;
        }
        if rule.compares && !steady {
            leave_out("two runs of the unit differ");
            continue;
        }
        let (mut findings, is_steady) = run_one(rule, path, limits)?;
        if findings.iter().any(|finding| ENDS.contains(&finding.rule.as_str())) {
            leave_out("its process came to an end before it was through");
        }
        steady &= is_steady;
        broken = rule.id == RULES[0].id && findings.iter().any(|f| f.severity == crate::Severity::Error);
        all.append(&mut findings);
    }
    Ok(Looked { findings: all, left_out })
}

/// What a rule found, and whether two runs of the unit are alike as far as it shows.
fn run_one(rule: &Rule, path: &Path, limits: &Limits) -> Result<(Vec<Finding>, bool), Error> {
    let Ended { findings, trace } = worker::run(rule.id, path, limits)?;
    if rule.id != "repeatable" || !findings.is_empty() {
        return Ok((findings, true));
    }
    // Two processes: what differs there is no matter of instances that share something.
    let again = worker::run(rule.id, path, limits)?;
    let mut found = Found::new(rule.id);
    found.findings = again.findings;
    let is_steady = trace == again.trace;
    if !is_steady {
        found.warning(
            "two runs from the same start with the same inputs differ: time, randomness or memory that was not set; what \
             compares runs is not looked at",
        );
    }
    Ok((found.findings, is_steady))
}

/// Looks at one rule, in the process for it.
fn look(id: &str, bench: &Bench) -> Vec<Finding> {
    let Some(rule) = RULES.iter().find(|rule| rule.id == id) else { return Vec::new() };
    let mut found = Found::new(rule.id);
    match (rule.find)(bench, &mut found) {
        Ok(()) | Err(Halt::Ended) => {}
        Err(Halt::Call(error)) => found.error(error.to_string()),
        Err(Halt::Of(name, error)) => found.say(crate::Severity::Error, Some(&name), error.to_string()),
    }
    // an error begins with the name of its unit, and that of the one that is looked at is "unit"
    for finding in &mut found.findings {
        finding.text = finding.text.replace("unit unit", "the unit");
    }
    found.findings
}
