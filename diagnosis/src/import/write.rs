//! The folder of a data set: the unit, the logs as plain CSV, and `dataset.toml` with each guess beside its evidence.

use super::idle_parameters;
use super::sheet::Sheet;
use super::starts::{self, Start};
use super::trial::Known;
use super::{Match, Time, instance};
use crate::error::Error;
use crate::observe::Hold;
use orchestrator::Fmu;
use orchestrator::Kind;
use orchestrator::fmu::{Causality, Variability};
use std::fmt::Write as _;
use std::path::Path;

/// What was found of the logs and the unit.
#[derive(Clone, Copy)]
pub(super) struct Found<'a> {
    /// The logs.
    pub sheets: &'a [Sheet],
    /// Where their time stands, and in what unit.
    pub time: &'a Time,
    /// How the time was found, in words.
    pub told: &'a str,
    /// Which column is which variable.
    pub matches: &'a [Match],
    /// Which parameters are starts of which states.
    pub starts: &'a [Start],
    /// Parameters that are starts of states which no variable shows.
    pub unshown: &'a [usize],
    /// Parameters that may be off.
    pub candidates: &'a [usize],
    /// What trying them said.
    pub tried: Option<&'a idle_parameters::Found>,
}

impl<'a> Found<'a> {
    /// Before any parameter was tried.
    pub fn new(
        sheets: &'a [Sheet],
        known: &Known<'a>,
        told: &'a str,
        matches: &'a [Match],
        candidates: &'a [usize],
    ) -> Self {
        let Known { time, starts, .. } = *known;
        Self { sheets, time, told, matches, starts, unshown: &[], candidates, tried: None }
    }
}

/// Writes everything and gives a line for each guess.
pub(super) fn folder(out: &Path, file: &Path, fmu: &Fmu, found: &Found<'_>) -> Result<Vec<String>, Error> {
    let Found { sheets, time, told, matches, starts, unshown, candidates, tried } = *found;
    let put = |name: &str, text: String| {
        let path = out.join(name);
        std::fs::write(&path, text).map_err(|source| Error::Io { path, source })
    };
    std::fs::create_dir_all(out).map_err(|source| Error::Io { path: out.to_owned(), source })?;
    let unit = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let copy = out.join(&unit);
    if copy.canonicalize().ok() != file.canonicalize().ok() {
        std::fs::copy(file, &copy).map_err(|source| Error::Io { path: copy, source })?;
    }
    let mut guesses = vec![told.to_owned()];
    let mut text = format!(
        "# Written by `acroscope import`. Lines after \"guess:\" say why; look at them before you believe a diagnosis.\n\
         format = 2\nfmu = {}\n",
        quoted(&unit)
    );
    if none_acts(candidates, tried.unwrap_or(&idle_parameters::Found::default())) {
        text.push_str("candidate = []                           # none; take this line out where you add a [[candidate]]\n");
    }
    for matched in matches {
        channel(&mut text, &mut guesses, fmu, matched);
    }
    states(&mut text, &mut guesses, fmu, starts, unshown);
    let candidates: Vec<usize> =
        candidates.iter().copied().filter(|place| !unshown.contains(place)).collect();
    let none = idle_parameters::Found::default();
    put_candidates(&mut text, &mut guesses, fmu, &candidates, tried.unwrap_or(&none));
    for (number, sheet) in sheets.iter().enumerate() {
        let name = run(number);
        put(&name, plain(sheet))?;
        let _ = write!(text, "\n[[run]]                                  # {}\n", sheet.path.display());
        let _ = writeln!(text, "# guess: {told}");
        guesses.extend(sheet.told.iter().map(|told| format!("{}: {told}", sheet.path.display())));
        if let Some(dialect) = &sheet.dialect {
            let _ = writeln!(text, "# {dialect}");
            guesses.push(format!("{}: {dialect}", sheet.path.display()));
        }
        let _ = writeln!(text, "file = {}", quoted(&name));
        let first = sheet.columns.first().is_some_and(|column| column.text == "time");
        if !first || time.name != "time" || time.unit != "s" {
            let _ =
                writeln!(text, "time = {{ column = {}, unit = {} }}", quoted(&time.name), quoted(&time.unit));
        }
    }
    put("dataset.toml", text)?;
    Ok(guesses)
}

/// What the log of a run is called, counted from 0.
pub(super) fn run(number: usize) -> String {
    format!("run-{:02}.csv", number + 1)
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

fn channel(text: &mut String, guesses: &mut Vec<String>, fmu: &Fmu, matched: &Match) {
    let variable = &fmu.description().variables[matched.variable];
    let name = format!("{}.{}", instance(fmu), variable.name);
    let _ = writeln!(text, "\n[[channel]]");
    for line in &matched.evidence {
        let _ = writeln!(text, "# guess: {line}");
        guesses.push(format!("{name}: {line}"));
    }
    let _ = writeln!(text, "variable = {}\ncolumn = {}", quoted(&name), quoted(&matched.column));
    match (&matched.affine, &matched.unit) {
        (Some(affine), unit) => {
            if let Some(unit) = unit {
                let _ = writeln!(text, "# the log is in {unit}");
            }
            let _ = writeln!(text, "scale = {:?}\noffset = {:?}", affine.scale, affine.offset + 0.0);
        }
        (None, Some(unit)) if variable.unit.is_some() => {
            let _ = writeln!(text, "unit = {}", quoted(unit));
        }
        (None, Some(unit)) => {
            let _ = writeln!(
                text,
                "# the log is in {unit}; the description gives this variable no unit, so numbers are taken as they are"
            );
        }
        (None, None) => {}
    }
    if let Some(hold) = matched.hold {
        let hold = if hold == Hold::Linear { "linear" } else { "zero" };
        let _ = writeln!(text, "hold = \"{hold}\"");
    }
}

/// States that can be started; where each is a variable of initial "exact", that is the default and nothing is written.
fn states(text: &mut String, guesses: &mut Vec<String>, fmu: &Fmu, starts: &[Start], unshown: &[usize]) {
    let name = |place: usize| fmu.description().variables[place].name.as_str();
    if unshown.is_empty() && starts.iter().all(|one| one.start == one.shows) {
        return;
    }
    for one in starts {
        let (start, shown) = (name(one.start), name(one.shows));
        let _ = writeln!(text, "\n[[state]]");
        if one.start != one.shows {
            let named =
                if starts::is_told_by_name(fmu.description(), *one) { "by its name and " } else { "" };
            let why = format!("{start} is where {shown} starts, {named}by trial");
            let _ = writeln!(text, "# guess: {why}");
            guesses.push(why);
        }
        let _ = writeln!(text, "start = {}", quoted(&format!("{}.{start}", instance(fmu))));
        let _ = writeln!(text, "shows = {}", quoted(&format!("{}.{shown}", instance(fmu))));
    }
    for place in unshown {
        let start = name(*place);
        let why = format!(
            "{start} is a start by trial, though no variable shows it: with it as a state the model goes on as it did where it begins anew, and not \
             without"
        );
        let _ = writeln!(text, "\n[[state]]\n# guess: {why}");
        let _ = writeln!(text, "start = {}", quoted(&format!("{}.{start}", instance(fmu))));
        guesses.push(why);
    }
}

/// Parameters that are numbers and start no state that shows, by their places.
pub(super) fn parameters(fmu: &Fmu, starts: &[Start]) -> Vec<usize> {
    let all = fmu.description().variables.iter().enumerate().filter(|(place, variable)| {
        variable.causality == Causality::Parameter
            && matches!(variable.variability, Variability::Fixed | Variability::Tunable)
            && variable.kind != Kind::String
            && variable.start.is_some()
            && !fmu.description().is_ambiguous(&variable.name)
            && starts.iter().all(|one| one.start != *place)
    });
    all.map(|(place, _)| place).collect()
}

/// Whether there are parameters, and each of them was seen to change nothing.
fn none_acts(all: &[usize], tried: &idle_parameters::Found) -> bool {
    !all.is_empty() && all.iter().all(|place| tried.idle.contains(place))
}

/// Every parameter, for the user to strike out what can't be off; what changes nothing is struck out already.
fn put_candidates(
    text: &mut String,
    guesses: &mut Vec<String>,
    fmu: &Fmu,
    all: &[usize],
    tried: &idle_parameters::Found,
) {
    let entry = |place: usize, mark: &str| {
        let variable = &fmu.description().variables[place];
        let neutral = variable.start.as_ref().and_then(orchestrator::Value::as_f64).unwrap_or(0.0);
        let about = match variable.description.as_str() {
            "" => String::new(),
            // TOML allows no control character in a comment
            words => format!("                            # {}", words.replace(char::is_control, " ")),
        };
        let name = quoted(&format!("{}.{}", instance(fmu), variable.name));
        let relative = variable.kind == Kind::Real && neutral != 0.0;
        let scale = if relative { format!("{mark}scale = \"relative\"\n") } else { String::new() };
        format!("{mark}[[candidate]]{about}\n{mark}variable = {name}\n{scale}")
    };
    let (struck, kept): (Vec<usize>, Vec<usize>) = all.iter().partition(|place| tried.idle.contains(place));
    if !kept.is_empty() {
        text.push_str("\n# guess: every parameter may be off; strike out what you are sure of. Of all: write candidate = [] below `fmu`\n");
    }
    kept.iter().for_each(|place| text.push_str(&entry(*place, "")));
    guesses.push(match kept.len() {
        0 if none_acts(all, tried) => "no parameter may be off: candidate = []".to_owned(),
        count => format!("{count} parameters may be off"),
    });
    if tried.untried > 0 {
        guesses.push(format!(
            "the last {} were not tried, since the unit takes long or can't be run in a process of its own: some may change nothing",
            tried.untried
        ));
    }
    if tried.unfinished > 0 {
        guesses.push(format!(
            "{} of those that change nothing were not tried to the ends of their ranges and beside all that is off, since the unit takes long",
            tried.unfinished
        ));
    }
    if !struck.is_empty() {
        text.push_str("\n# guess: moved far, these change nothing that the longest log shows, or the unit can't be run with them\n");
        struck.iter().for_each(|place| text.push_str(&entry(*place, "# ")));
        guesses.extend(struck_out(fmu, &struck, tried));
    }
}

/// What is said of parameters that are struck out: that they change nothing, and which may do so only since the unit can't be run with them.
fn struck_out(fmu: &Fmu, struck: &[usize], tried: &idle_parameters::Found) -> Vec<String> {
    let fails = |place: &usize| {
        let (_, why) = tried.failing.iter().find(|(failing, _)| failing == place)?;
        let name = &fmu.description().variables[*place].name;
        Some(format!(
            "{name} is struck out, too: moved off its start value, the unit can't always be run ({why})"
        ))
    };
    let failing: Vec<String> = struck.iter().filter_map(fails).collect();
    let silent = struck.len() - failing.len();
    let silent = (silent > 0).then(|| format!("{silent} more change nothing that the longest log shows"));
    silent.into_iter().chain(failing).collect()
}

/// A log with commas and points.
fn plain(sheet: &Sheet) -> String {
    let cell = |text: &str| {
        if text.contains([',', '"']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
    };
    let mut text = sheet.columns.iter().map(|column| cell(&column.text)).collect::<Vec<_>>().join(",");
    text.push('\n');
    for row in &sheet.rows {
        let cells: Vec<String> =
            row.iter().map(|value| if value.is_nan() { String::new() } else { value.to_string() }).collect();
        text.push_str(&cells.join(","));
        text.push('\n');
    }
    text
}
