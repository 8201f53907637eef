//! `acroscope diagnose`: what a model lacks against measured data.

use crate::cli::{Called, Diagnose};
use crate::data_set::files_of;
use crate::error::Error;
use diagnosis::{Budget, Correction, Diagnosis, Doing, Earlier, Effect, Options, Unknown, Verdict};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use report::head::shell_word;
use runner::folder::{Folder, keep};
use runner::request::folder_name;
use std::io::IsTerminal as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Time for each run, s, if nobody says how much.
const MINUTE: f64 = 60.0;

/// Diagnoses the data set and writes `diagnosis.json`, `amended.toml` and `report.html`.
pub fn diagnose(arguments: &Diagnose, quiet: bool) -> Result<(), Error> {
    let out = arguments.out.clone().unwrap_or_else(|| default_folder(arguments));
    let written: Vec<PathBuf> = diagnosis::FILES.iter().map(|name| out.join(name)).collect();
    keep(&written, &files_of(&arguments.dataset))?;
    // Before the work, so that a folder that can't be made costs no minute; it vanishes again, since a unit may end the program.
    drop(Folder::make(&out)?);
    let spinner = spinner(quiet);
    let earlier = arguments.after.as_deref().map(Earlier::load).transpose()?;
    arguments.called.look_out();
    let options = Options {
        isolation: arguments.called.isolation(),
        without: arguments.without.clone(),
        earlier,
        budget: arguments.budget.map_or(Budget::EachRun(MINUTE), Budget::All),
        fit: arguments.fit.iter().map(|name| name.trim().to_owned()).collect(),
        ..Options::default()
    };
    let units = scenarios::unit_path();
    let mut tell = |doing: &Doing<'_>| spinner.set_message(told(doing));
    let diagnosis = diagnosis::diagnose(&arguments.dataset, &units, &options, &mut tell);
    spinner.finish_and_clear();
    let mut diagnosis = diagnosis?;
    diagnosis.provenance.command = command(arguments);
    let commit = runner::provenance::program().commit;
    diagnosis.provenance.version.push_str(&format!(", commit {commit}"));
    let folder = Folder::make(&out)?;
    folder.clear(&diagnosis::FILES)?;
    diagnosis.write(&out)?;
    if !quiet {
        summary(&diagnosis, &out);
    }
    Ok(())
}

/// All that was asked beside the data set: an option and its value, empty where it has none. It names the default folder, and makes the
/// command that makes the diagnosis again.
fn asked(arguments: &Diagnose) -> Vec<(&'static str, String)> {
    let Diagnose { dataset: _, without, budget, fit, called: Called { isolate, step_limit }, after, out: _ } =
        arguments;
    let mut without = without.clone();
    without.sort();
    without.dedup();
    let mut all: Vec<(&str, String)> = without.into_iter().map(|name| ("without", name)).collect();
    all.extend(budget.iter().map(|seconds| ("budget", seconds.to_string())));
    all.extend((!fit.is_empty()).then(|| ("fit", fit.join(","))));
    all.extend(isolate.then(|| ("isolate", String::new())));
    all.extend(step_limit.iter().map(|seconds| ("step-limit", seconds.to_string())));
    all.extend(after.iter().map(|folder| ("after", folder.display().to_string())));
    all
}

/// A folder for each thing that can be asked.
fn default_folder(arguments: &Diagnose) -> PathBuf {
    // `.` has a name, too.
    let dataset = arguments.dataset.canonicalize().unwrap_or_else(|_| arguments.dataset.clone());
    let name = dataset.file_name().map_or_else(|| "dataset".into(), |name| name.to_string_lossy());
    let change = |(option, value): (&str, String)| match value.as_str() {
        "" => option.to_owned(),
        value => format!("{option}={value}"),
    };
    Path::new("out").join(folder_name(&format!("diagnose-{name}"), asked(arguments).into_iter().map(change)))
}

/// The command that makes this diagnosis again.
fn command(arguments: &Diagnose) -> String {
    let folder = shell_word(&arguments.dataset.to_string_lossy());
    let mut words = vec!["acroscope diagnose".to_owned(), folder];
    let option = |(option, value): (&str, String)| match value.as_str() {
        "" => format!("--{option}"),
        value => format!("--{option} {}", shell_word(value)),
    };
    words.extend(asked(arguments).into_iter().map(option));
    words.join(" ")
}

/// A stage, and what is being tried in it.
fn told(doing: &Doing<'_>) -> String {
    match doing.count {
        (0, 0) => doing.stage.to_owned(),
        (done, of) => format!("{}: {} ({done} of {of})", doing.stage, doing.trying),
    }
}

/// Names the stage of the work; hidden if `quiet` or if nobody looks at a terminal.
fn spinner(quiet: bool) -> ProgressBar {
    let hidden = quiet || !std::io::stderr().is_terminal();
    let target = if hidden { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let spinner = ProgressBar::with_draw_target(None, target);
    // The template is a constant; were it wrong, indicatif's own style would do.
    if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {wide_msg}") {
        spinner.set_style(style);
    }
    spinner.enable_steady_tick(Duration::from_millis(120));
    spinner
}

/// A name is told without a word from this probability on: of twenty such, one is wrong.
const SURE: f64 = 0.95;

fn effect(effect: &Effect) {
    let [low, high] = effect.ci95;
    // the unit of what has none is 1
    let unit =
        if matches!(effect.unit.as_str(), "" | "1") { String::new() } else { format!(" {}", effect.unit) };
    tell!(
        "  {} = {}{unit} ({} to {}): {}{}{}",
        effect.class.join(" or "),
        effect.written(effect.value),
        effect.written(low),
        effect.written(high),
        effect.phrase,
        match (effect.at_end, effect.unbounded) {
            (true, _) => ", at the end of what can be tried: it may lie beyond",
            (_, true) => ", of which these data give no upper bound",
            _ => "",
        },
        worth(effect.probability),
    );
}

/// What is said of a name that is not sure.
fn worth(probability: f64) -> String {
    if probability < SURE {
        format!("; in doubt, with a probability of {probability:.2}")
    } else {
        String::new()
    }
}

fn unknown(unknown: &Unknown) {
    let depends = match unknown.depends_on.as_slice() {
        [] => String::new(),
        names => format!(", depends on {}", names.join(", ")),
    };
    tell!("  unknown: {}{depends}: {}", unknown.signal, unknown.shape);
}

/// How far the gap closes, in percent, and on what.
fn closes(percent: f64, judged_on: &str) -> String {
    let share = if percent < 0.5 {
        "nothing of the gap closes".into()
    } else {
        format!("the gap closes by {percent:.0} %")
    };
    format!("{share} {judged_on}")
}

fn correction(correction: &Correction) {
    for term in &correction.terms {
        tell!("  {} = {} {}: {}", term.name, term.short(), term.measure, term.phrase);
    }
    tell!("  that is {}; it takes away {:.0} % of what is left", correction.label, correction.gap.percent());
}

/// What a lab should do next, and the command that comes then.
fn next_experiment(diagnosis: &Diagnosis, out: &Path) {
    let Some(next) = &diagnosis.next_experiment else { return };
    match next.separates.as_slice() {
        [] => tell!("next experiment: {}", next.what),
        names => tell!("to tell {} apart: {}", names.join(" and "), next.what),
    }
    // where nothing is proposed nothing comes then
    if diagnosis.counts_later() && (next.planned.is_some() || !next.separates.is_empty()) {
        tell!("and then: acroscope diagnose NEW-DATA --after {}", out.display());
    }
}

/// The verdict in a few lines, and where it comes from.
fn summary(diagnosis: &Diagnosis, out: &Path) {
    for notice in &diagnosis.notices {
        complain!("note: {notice}");
    }
    if !diagnosis.ended_early.is_empty() {
        let ended = diagnosis.ended_early.join("; ");
        tell!("time was up (--budget gives it more); it ended with what was there: {ended}");
    }
    tell!(
        "{}",
        match diagnosis.verdict {
            Verdict::None => "nothing is missing that these data could show".to_owned(),
            Verdict::Named => "the model lacks:".to_owned(),
            Verdict::Ambiguous => "the model lacks (more than one name fits):".to_owned(),
            Verdict::Unknown => format!("the model lacks something {}", diagnosis.nameless()),
        }
    );
    diagnosis.effects.iter().for_each(effect);
    diagnosis.unknown.iter().for_each(unknown);
    diagnosis.correction.iter().for_each(correction);
    let better = !diagnosis.effects.is_empty() || diagnosis.correction.is_some();
    if let Some(percent) = diagnosis.gap.percent().filter(|_| better) {
        tell!("{}", closes(percent, &diagnosis.judged_on()));
    }
    if let Some(open) = diagnosis.unknown.as_ref().and_then(Unknown::left_open) {
        tell!("{open}.");
    }
    next_experiment(diagnosis, out);
    for (what, value) in diagnosis.provenance.lines() {
        tell!("{what}: {value}");
    }
    tell!("the report is {}", out.join("report.html").display());
}

#[cfg(test)]
mod tests {
    use super::{command, default_folder, worth};
    use crate::cli::Diagnose;
    use clap::{Args as _, Command, FromArgMatches as _};

    #[test]
    fn value_a_name_in_doubt_is_told_as_such() {
        assert_eq!(worth(0.3), "; in doubt, with a probability of 0.30");
        assert_eq!((worth(0.949).is_empty(), worth(0.95).is_empty()), (false, true));
    }

    /// What is typed after `acroscope`, as it is understood.
    fn parsed(words: &str) -> Diagnose {
        let matches = Diagnose::augment_args(Command::new("diagnose")).try_get_matches_from(words.split(' '));
        Diagnose::from_arg_matches(&matches.expect("it can be asked")).expect("all is given")
    }

    /// Every option with a value that it takes.
    const OPTIONS: [&str; 6] = [
        "--without plant.b_joint",
        "--budget 5",
        "--fit a.b,a.c",
        "--isolate",
        "--step-limit 2.5",
        "--after out/first",
    ];

    #[test]
    fn bad_input_a_budget_of_nothing_is_refused_with_its_value() {
        for given in ["0", "-1", "nan"] {
            let known = Diagnose::augment_args(Command::new("diagnose"));
            let refused = known.try_get_matches_from(["diagnose", "data", "--budget", given]);
            let text = refused.expect_err("no time for a search").to_string();
            assert!(text.contains(&format!("'{given}'")) && text.contains("seconds above 0"), "{text}");
        }
    }

    #[test]
    fn every_option_is_in_the_command_that_makes_it_again_and_has_a_folder_of_its_own() {
        let known = Diagnose::augment_args(Command::new("diagnose"));
        let mut options: Vec<String> =
            known.get_arguments().filter_map(|one| Some(format!("--{}", one.get_long()?))).collect();
        options.retain(|option| option != "--out");
        let tried: Vec<&str> = OPTIONS.iter().filter_map(|option| option.split(' ').next()).collect();
        assert_eq!(
            options,
            tried.iter().map(|one| (*one).to_owned()).collect::<Vec<_>>(),
            "an option that isn't tried here"
        );
        let mut folders = vec![default_folder(&parsed("diagnose data"))];
        for option in OPTIONS {
            let asked = parsed(&format!("diagnose data {option}"));
            let told = command(&asked);
            assert_eq!(told, format!("acroscope diagnose data {option}"));
            // and it says the same again
            assert_eq!(command(&parsed(told.strip_prefix("acroscope ").expect("our program"))), told);
            let folder = default_folder(&asked);
            assert!(!folders.contains(&folder), "{} is another's, too", folder.display());
            folders.push(folder);
        }
        let mut spaced = parsed("diagnose data --after first");
        (spaced.dataset, spaced.after) = ("my logs".into(), Some("the first".into()));
        assert_eq!(command(&spaced), "acroscope diagnose 'my logs' --after 'the first'");
        let twice = parsed("diagnose data --without b.c --without a.b --without b.c");
        assert_eq!(
            default_folder(&twice),
            default_folder(&parsed("diagnose data --without a.b --without b.c"))
        );
    }
}
