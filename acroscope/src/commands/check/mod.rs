//! `acroscope check`: what is wrong with a unit.

mod page;

use crate::cli::Check;
use crate::error::Error;
use inspection::{Finding, Limits, Looked, Severity};
use std::collections::BTreeMap;
use std::time::Duration;

/// Findings of one rule that a person is shown; more of them say no more.
const SHOWN: usize = 10;

/// Prints the findings; those that are errors make it one.
pub fn check(arguments: &Check, quiet: bool) -> Result<(), Error> {
    let limits = Limits {
        call: Duration::from_secs_f64(arguments.step_limit),
        memory: arguments.memory_limit.saturating_mul(1 << 20),
    };
    let looked = inspection::look(&arguments.file, &limits)?;
    let findings = &looked.findings;
    let errors = count(findings, Severity::Error);
    let page = arguments.out.as_ref().map(|out| page::write(arguments, out, &looked)).transpose()?;
    if arguments.json {
        // Texts only: nothing can fail.
        tell!("{}", serde_json::to_string_pretty(findings).unwrap_or_default());
    } else {
        for finding in shown(findings, quiet) {
            tell!("{finding}");
        }
        if !quiet {
            tell!("{}: {}", arguments.file.display(), summary(&looked));
            if let Some(page) = page {
                tell!("the report is {}", page.display());
            }
        }
    }
    match errors {
        0 => Ok(()),
        errors => Err(Error::Faulty { path: arguments.file.clone(), errors }),
    }
}

/// How much was found by the rules that were looked at, and why the others were not.
fn summary(looked: &Looked) -> String {
    let of = |severity, word: &str| counted(count(&looked.findings, severity), word);
    let (errors, warnings) = (of(Severity::Error, "error"), of(Severity::Warning, "warning"));
    let (notes, rules) = (of(Severity::Note, "note"), counted(looked.rules().len(), "rule"));
    let left_out = looked
        .reasons()
        .into_iter()
        .map(|(why, rules)| format!("; {} not looked at, because {why}", counted(rules.len(), "rule")));
    format!("{errors}, {warnings}, {notes} of {rules}{}", left_out.collect::<String>())
}

fn counted(count: usize, word: &str) -> String {
    if count == 1 { format!("1 {word}") } else { format!("{count} {word}s") }
}

fn count(findings: &[Finding], severity: Severity) -> usize {
    findings.iter().filter(|finding| finding.severity == severity).count()
}

/// The lines for a person: of each rule the first ones, and how many more there are.
fn shown(findings: &[Finding], quiet: bool) -> Vec<String> {
    let mut seen: BTreeMap<(&str, Severity), usize> = BTreeMap::new();
    let mut lines = Vec::new();
    for finding in findings.iter().filter(|finding| !quiet || finding.severity == Severity::Error) {
        let count = seen.entry((&finding.rule, finding.severity)).or_default();
        *count += 1;
        if *count <= SHOWN {
            lines.push(finding.to_string());
        }
    }
    for ((rule, severity), count) in seen.iter().filter(|(_, count)| **count > SHOWN) {
        lines.push(format!("{severity}[{rule}] and {} more like these; --json has all", count - SHOWN));
    }
    lines
}
