//! `acroscope diagnose`: what a model lacks against measured data.

use crate::cli::Diagnose;
use crate::error::Error;
use diagnosis::{Diagnosis, Earlier, Options, Verdict};
use indicatif::{ProgressBar, ProgressDrawTarget};
use std::io::IsTerminal as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Diagnoses the data set and writes `diagnosis.json`, `amended.toml` and `report.html`.
pub fn diagnose(arguments: &Diagnose, quiet: bool) -> Result<(), Error> {
    let out = arguments.out.clone().unwrap_or_else(|| default_folder(&arguments.dataset));
    // Before the work, so that a folder that can't be made costs no minute.
    std::fs::create_dir_all(&out).map_err(Error::file(&out))?;
    let spinner = spinner(quiet);
    let earlier = arguments.after.as_deref().map(Earlier::load).transpose()?;
    let options = Options { without: arguments.without.clone(), earlier, ..Options::default() };
    let units = scenarios::unit_path();
    let mut tell = |stage: &str| spinner.set_message(stage.to_owned());
    let diagnosis = diagnosis::diagnose(&arguments.dataset, &units, &options, &mut tell);
    spinner.finish_and_clear();
    let diagnosis = diagnosis?;
    diagnosis.write(&out)?;
    if !quiet {
        summary(&diagnosis, &out);
    }
    Ok(())
}

fn default_folder(dataset: &Path) -> PathBuf {
    let name = dataset.file_name().map_or_else(|| "dataset".into(), |name| name.to_string_lossy());
    Path::new("out").join(format!("diagnose-{name}"))
}

/// Names the stage of the work; hidden if `quiet` or if nobody looks at a terminal.
fn spinner(quiet: bool) -> ProgressBar {
    let hidden = quiet || !std::io::stderr().is_terminal();
    let target = if hidden { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let spinner = ProgressBar::with_draw_target(None, target);
    spinner.enable_steady_tick(Duration::from_millis(120));
    spinner
}

/// The verdict in a few lines.
fn summary(diagnosis: &Diagnosis, out: &Path) {
    for notice in &diagnosis.notices {
        eprintln!("note: {notice}");
    }
    tell!(
        "{}",
        match diagnosis.verdict {
            Verdict::None => "nothing is missing that these data could show",
            Verdict::Named => "the model lacks:",
            Verdict::Ambiguous => "the model lacks (more than one name fits):",
            Verdict::Unknown => "the model lacks something that no listed effect gives",
        }
    );
    for effect in &diagnosis.effects {
        let [low, high] = effect.ci95;
        let digits = effect.digits();
        tell!(
            "  {} = {:.digits$} ({low:.digits$} to {high:.digits$}): {}",
            effect.class.join(" or "),
            effect.value,
            effect.phrase
        );
    }
    if let Some(unknown) = &diagnosis.unknown {
        tell!(
            "  unknown: {}, depends on {}: {}",
            unknown.signal,
            unknown.depends_on.join(", "),
            unknown.shape
        );
    }
    if let Some(correction) = &diagnosis.correction {
        for term in &correction.terms {
            tell!("  {} = {}: {}", term.name, term.short(), term.phrase);
        }
        tell!(
            "  that is {}; it takes away {:.0} % of what is left",
            correction.label,
            100.0 * correction.gap.closed
        );
    }
    let better = !diagnosis.effects.is_empty() || diagnosis.correction.is_some();
    if let Some(closed) = diagnosis.gap.closed.filter(|_| better) {
        tell!("the gap closes by {:.0} % on runs that were left out", 100.0 * closed);
    }
    if let Some(next) = &diagnosis.next_experiment {
        match next.separates.as_slice() {
            [] => tell!("next experiment: {}", next.what),
            names => tell!("to tell {} apart: {}", names.join(" and "), next.what),
        }
        tell!("and then: acroscope diagnose NEW-DATA --after {}", out.display());
    }
    tell!("the report is {}", out.join("report.html").display());
}
