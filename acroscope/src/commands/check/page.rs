//! `report.html` of `acroscope check`: what was found, to be narrowed, and which rules found nothing, and
//! which were not looked at.

use super::{count, counted};
use crate::cli::Check;
use crate::error::Error;
use inspection::{Finding, Looked, Severity};
use orchestrator::Fmu;
use report::head::shell_word;
use report::{Cell, Figure, Filtered, Marked, Origin, Page, Provenance, Standing, Verdict};
use runner::folder::Folder;
use runner::provenance;
use std::path::{Path, PathBuf};

/// Writes the page into a folder, and answers its path.
pub fn write(arguments: &Check, out: &Path, looked: &Looked) -> Result<PathBuf, Error> {
    let findings = &looked.findings;
    let folder = Folder::make(out)?;
    let name = arguments.file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mut page = Page::new(format!("Is {name} a sound unit?"));
    let provenance = origin(arguments, &name)?;
    page.verdict(&verdict(looked)).origin_line(&provenance);
    if !findings.is_empty() {
        page.heading("What was found").filtered(&found(findings));
    }
    let silent = silent(looked);
    page.heading("Rules that found nothing");
    page.text(&format!(
        "{} of {} that could be looked at. `docs/check.md` has a section for each rule: what it looks at, and what to do about what it finds.",
        silent.len(),
        counted(looked.rules().len(), "rule")
    ));
    page.names(silent);
    left_out(&mut page, looked);
    page.provenance(&provenance);
    folder.write("report.html", &page.to_html())?;
    Ok(folder.file("report.html"))
}

/// The rules of which silence says nothing, with the reasons.
fn left_out(page: &mut Page, looked: &Looked) {
    if looked.left_out.is_empty() {
        return;
    }
    page.heading("Rules that were not looked at");
    page.text("What they would find is not known.");
    for (why, rules) in looked.reasons() {
        page.text(&format!("{} not looked at, because {why}:", counted(rules.len(), "rule")));
        page.names(rules);
    }
}

fn verdict(looked: &Looked) -> Verdict {
    let of = |severity| count(&looked.findings, severity);
    let left_out = looked.left_out.len();
    let (standing, words) = match (of(Severity::Error), of(Severity::Warning)) {
        (0, 0) if left_out > 0 => (
            Standing::Plain,
            format!("Nothing was found, but {} could not be looked at.", counted(left_out, "rule")),
        ),
        (0, 0) => (Standing::Good, "Nothing speaks against this unit.".to_owned()),
        (0, _) => {
            (Standing::Plain, "No error; some masters may stumble over what the warnings say.".to_owned())
        }
        (1, _) => (Standing::Bad, "The unit breaks the standard, or its own word, in one place.".to_owned()),
        (errors, _) => {
            (Standing::Bad, format!("The unit breaks the standard, or its own word, in {errors} places."))
        }
    };
    let figure = |label: &str, severity| Figure::new(label, Some(of(severity) as f64), "");
    let figures = vec![
        figure("errors", Severity::Error),
        figure("warnings", Severity::Warning),
        figure("notes", Severity::Note),
        Figure::new("rules looked at", Some(looked.rules().len() as f64), ""),
        Figure::new("rules not looked at", Some(left_out as f64), ""),
    ];
    Verdict { standing, words, figures, notes: Vec::new() }
}

fn found(findings: &[Finding]) -> Filtered {
    let row = |finding: &Finding| Marked {
        id: String::new(),
        marks: vec![finding.severity.to_string(), finding.rule.clone()],
        cells: vec![
            severity(finding.severity),
            finding.rule.as_str().into(),
            finding.variable.as_deref().unwrap_or_default().into(),
            finding.text.as_str().into(),
        ],
    };
    // Stable: of one severity the order of the rules stays.
    let mut ordered: Vec<&Finding> = findings.iter().collect();
    ordered.sort_by_key(|finding| finding.severity);
    Filtered {
        what: "findings".to_owned(),
        head: ["severity", "rule", "variable", "what was found, and what would be right"]
            .map(str::to_owned)
            .to_vec(),
        rows: ordered.into_iter().map(row).collect(),
    }
}

fn severity(of: Severity) -> Cell {
    match of {
        Severity::Error => Cell::Holds(false, of.to_string()),
        Severity::Warning | Severity::Note => of.to_string().into(),
    }
}

/// Rules that were looked at and have no finding.
fn silent(looked: &Looked) -> Vec<&'static str> {
    let is_silent = |rule: &&str| looked.findings.iter().all(|finding| finding.rule != **rule);
    looked.rules().into_iter().filter(is_silent).collect()
}

fn origin(arguments: &Check, name: &str) -> Result<Provenance, Error> {
    let input = provenance::input("unit", name, &arguments.file)?;
    // A unit that is too broken to be opened has a page, too.
    let units = Fmu::open(&arguments.file).ok().map(|fmu| Origin {
        name: fmu.description().model_name.clone(),
        file: name.to_owned(),
        guid: fmu.description().guid.clone(),
        tool: fmu.description().generation_tool.clone(),
        sha256: input.sha256.clone(),
    });
    Ok(Provenance {
        program: provenance::program(),
        inputs: vec![input],
        units: units.into_iter().collect(),
        command: format!(
            "acroscope check {} --out {}",
            shell_word(&arguments.file.to_string_lossy()),
            shell_word(&arguments.out.as_deref().unwrap_or(Path::new(".")).to_string_lossy())
        ),
        ..Provenance::default()
    })
}
