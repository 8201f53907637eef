//! Which output an input is connected to: by name, and only where type and unit fit. Where several would do, or the names
//! are merely alike, the choice is left to the reader.

use super::Unit;
use orchestrator::fmu::{Causality, Variable};

/// An output: place of its unit, the variable.
type Output<'u> = (usize, &'u Variable);

/// What is to be done with an input.
pub(super) enum Choice<'u> {
    /// It is connected; others that would have fitted by a name that is alike.
    Connect { from: Output<'u>, comment: String, others: Vec<Output<'u>> },
    /// It gets a source; what would fit as well as another, and why nothing was chosen.
    Free { comment: String, others: Vec<Output<'u>> },
}

/// How well the name of an output fits that of an input.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Likeness {
    /// The same.
    Same,
    /// The same but for capitals and underscores, or with the name of the unit before it.
    Alike,
    /// One begins with the other: `q1` and `q1_est`.
    Related,
}

/// Looks for the output for an input of a unit.
pub(super) fn choose<'u>(units: &'u [Unit], to: usize, input: &Variable) -> Choice<'u> {
    let mut by_likeness: [Vec<Output<'u>>; 3] = [Vec::new(), Vec::new(), Vec::new()];
    let mut misfits = Vec::new();
    for (place, unit) in units.iter().enumerate().filter(|(place, _)| *place != to) {
        for output in unit.variables(Causality::Output) {
            let Some(likeness) = likeness(unit, output, &input.name) else { continue };
            match misfit((unit, output), (&units[to], input)) {
                None => by_likeness[likeness as usize].push((place, output)),
                Some(why) if likeness == Likeness::Same => {
                    misfits.push(format!("{}.{} has its name, but {why}", unit.name, output.name));
                }
                Some(_) => {}
            }
        }
    }
    let [same, alike, related] = by_likeness;
    let free = |mut comment: String, others: Vec<Output<'u>>| {
        for misfit in &misfits {
            comment.push_str("; ");
            comment.push_str(misfit);
        }
        Choice::Free { comment, others }
    };
    match (same.as_slice(), alike.as_slice()) {
        ([from], _) => {
            let others = [alike, related].concat();
            // the same name settles it only where nothing else would do
            let guess = if others.is_empty() { "" } else { "guess: " };
            let comment = format!("{guess}same name{}", unit_words(from.1, input));
            Choice::Connect { from: *from, comment, others }
        }
        ([], [from]) => {
            let comment = format!("guess: the names are alike{}", unit_words(from.1, input));
            Choice::Connect { from: *from, comment, others: related }
        }
        ([], []) if related.is_empty() => free("no output fits".into(), Vec::new()),
        ([], []) => {
            let why =
                "guess: a constant; no output has its name, these are related, and fit in type and unit";
            free(why.into(), related)
        }
        _ => free("guess: a constant; several outputs fit, choose one".into(), [same, alike].concat()),
    }
}

fn likeness(unit: &Unit, output: &Variable, input: &str) -> Option<Likeness> {
    let plain = |text: &str| text.to_lowercase().replace(['_', '.'], "");
    let (name, wanted) = (plain(&output.name), plain(input));
    let whole = plain(&format!("{}{}", unit.name, output.name));
    if output.name == input {
        Some(Likeness::Same)
    } else if name == wanted || whole == wanted {
        Some(Likeness::Alike)
    } else if begins(&output.name, input) || begins(input, &output.name) {
        Some(Likeness::Related)
    } else {
        None
    }
}

/// Whether one name is the other and more words behind it.
fn begins(long: &str, short: &str) -> bool {
    !short.is_empty() && long.strip_prefix(short).is_some_and(|rest| rest.starts_with(['_', '.']))
}

/// Why a value can't pass from an output to an input.
fn misfit((from, output): (&Unit, &Variable), (to, input): (&Unit, &Variable)) -> Option<String> {
    if output.kind != input.kind {
        return Some(format!("is of type {}, not {}", output.kind, input.kind));
    }
    let (Some(a), Some(b)) = (&output.unit, &input.unit) else { return None };
    let base = |unit: &Unit, name: &str| unit.fmu.description().unit(name)?.base;
    match (base(from, a), base(to, b)) {
        (Some(one), Some(other)) if one.exponents == other.exponents => None,
        (Some(_), Some(_)) => Some(format!("is in {a}, not in {b}")),
        _ if a == b => None,
        _ => Some(format!("is in {a}, which can't be converted to {b}")),
    }
}

/// What is to be known of the units of a connection.
fn unit_words(output: &Variable, input: &Variable) -> String {
    match (&output.unit, &input.unit) {
        (Some(a), Some(b)) if a == b => format!(", both in {a}"),
        (Some(a), Some(b)) => format!(", {a} is converted to {b}"),
        (None, None) => String::new(),
        (Some(unit), None) | (None, Some(unit)) => format!("; only one of them says its unit, {unit}"),
    }
}
