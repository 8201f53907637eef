//! `report.html` of `acroscope check`: what was found, to be narrowed, and which rules found nothing.

use super::count;
use crate::cli::Check;
use crate::error::Error;
use inspection::{Finding, Severity};
use orchestrator::Fmu;
use report::head::shell_word;
use report::{Cell, Figure, Filtered, Marked, Origin, Page, Provenance, Standing, Verdict};
use runner::folder::Folder;
use runner::provenance;
use std::path::{Path, PathBuf};

/// Writes the page into a folder, and answers its path.
pub fn write(arguments: &Check, out: &Path, findings: &[Finding]) -> Result<PathBuf, Error> {
    let folder = Folder::make(out)?;
    let name = arguments.file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mut page = Page::new(format!("Is {name} a sound unit?"));
    let provenance = origin(arguments, &name)?;
    page.verdict(&verdict(findings)).origin_line(&provenance);
    if !findings.is_empty() {
        page.heading("What was found").filtered(&found(findings));
    }
    let silent = silent(findings);
    page.heading("Rules that found nothing");
    page.text(&format!(
        "{} of {}. `docs/check.md` has a section for each rule: what it looks at, and what to do about what it finds.",
        silent.len(),
        inspection::rules().len()
    ));
    page.names(silent);
    page.provenance(&provenance);
    folder.write("report.html", &page.to_html())?;
    Ok(folder.file("report.html"))
}

fn verdict(findings: &[Finding]) -> Verdict {
    let of = |severity| count(findings, severity);
    let (standing, words) = match (of(Severity::Error), of(Severity::Warning)) {
        (0, 0) => (Standing::Good, "Nothing speaks against this unit.".to_owned()),
        (0, _) => {
            (Standing::Plain, "No error; some masters may stumble over what the warnings say.".to_owned())
        }
        (1, _) => (Standing::Bad, "The unit breaks the standard, or its own word, in one place.".to_owned()),
        (errors, _) => {
            (Standing::Bad, format!("The unit breaks the standard, or its own word, in {errors} places."))
        }
    };
    let figure = |label: &str, severity| Figure {
        label: label.to_owned(),
        value: Some(of(severity) as f64),
        unit: String::new(),
    };
    let figures = vec![
        figure("errors", Severity::Error),
        figure("warnings", Severity::Warning),
        figure("notes", Severity::Note),
        Figure {
            label: "rules".to_owned(),
            value: Some(inspection::rules().len() as f64),
            unit: String::new(),
        },
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

/// Rules without a finding. A unit that can't be opened is not run, so that silence is no praise there.
fn silent(findings: &[Finding]) -> Vec<&'static str> {
    inspection::rules()
        .into_iter()
        .filter(|rule| findings.iter().all(|finding| finding.rule != *rule))
        .collect()
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
