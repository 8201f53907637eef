//! `[[candidate]]`: what may be missing, with the defaults that the units' descriptions give.

use super::nominal::number;
use super::raw::{self, File};
use super::resolve::variable;
use super::{Candidate, Nominal, Scale, State, VariableId};
use crate::error::{Error, Notice};
use orchestrator::fmu::{Causality, Variability, Variable};
use orchestrator::{Kind, nearest};
use toml::Spanned;

const SCALES: [(&str, Scale); 5] = [
    ("absolute", Scale::Absolute),
    ("relative", Scale::Relative),
    ("saturation", Scale::Saturation),
    ("switch", Scale::Switch),
    ("count", Scale::Count),
];

/// All candidates: those that the file lists, be it none (`candidate = []`), else every parameter of the units.
pub(super) fn resolve(
    model: &Nominal,
    states: &[State],
    file: &File,
    notices: &mut Vec<Notice>,
) -> Result<Vec<Candidate>, Error> {
    let Some(listed) = &file.raw.candidate else {
        let found = by_itself(model, states, notices);
        let names: Vec<&str> = found.iter().map(|candidate| candidate.name.as_str()).collect();
        let message = match names.as_slice() {
            [] => "no [[candidate]], and the model has no parameter to set: only effects at ports are looked for".into(),
            names => format!("no [[candidate]]: every parameter may be off ({})", names.join(", ")),
        };
        notices.push(Notice { file: "dataset.toml".into(), line: 0, message });
        return Ok(found);
    };
    if listed.is_empty() {
        let message =
            "candidate = []: no parameter may be off, and only effects at ports are looked for".into();
        notices.push(Notice { file: "dataset.toml".into(), line: 0, message });
    }
    let mut candidates: Vec<Candidate> = Vec::new();
    for entry in listed {
        let one = candidate(model, file, entry, notices)?;
        if let Some(first) = candidates.iter().find(|known| known.variable == one.variable) {
            let problem = format!("a second candidate {}, the first is at line {}", one.name, first.line);
            return Err(file.wrong(&entry.get_ref().variable.span(), problem));
        }
        candidates.push(one);
    }
    Ok(candidates)
}

/// Every tunable or fixed parameter, but those that start a state, and those whose own limits leave no range around their value.
fn by_itself(model: &Nominal, states: &[State], notices: &mut Vec<Notice>) -> Vec<Candidate> {
    let every = (0..model.fmus.len()).flat_map(|instance| {
        let places = 0..model.description(instance).variables.len();
        places.map(move |place| VariableId { instance, place })
    });
    let fits = |id: &VariableId| {
        let variable = model.variable(*id);
        let is_clear = !model.description(id.instance).is_ambiguous(&variable.name);
        is_clear && may_move(variable) && states.iter().all(|state| state.start != *id)
    };
    let mut made = |id: VariableId| {
        let variable = model.variable(id);
        let (neutral, range) = (model.number(id)?, limits(variable));
        if !holds(range, neutral) {
            let message = format!("{}, and is no candidate", outside(&model.name(id), neutral, range));
            notices.push(Notice { file: "dataset.toml".into(), line: 0, message });
            return None;
        }
        Some(Candidate {
            name: model.name(id),
            variable: id,
            neutral,
            range,
            phrase: phrase(model, id),
            scale: usual(variable, neutral),
            line: 0,
        })
    };
    every.filter(fits).filter_map(&mut made).collect()
}

/// Whether a value lies in a range; nothing lies in one whose ends are exchanged.
fn holds((low, high): (f64, f64), value: f64) -> bool {
    low <= value && value <= high
}

/// What to say of a value outside of the unit's own limits.
fn outside(name: &str, value: f64, (least, most): (f64, f64)) -> String {
    format!("{name} = {value} lies outside of its own limits, {least} to {most}")
}

fn may_move(variable: &Variable) -> bool {
    variable.causality == Causality::Parameter
        && matches!(variable.variability, Variability::Fixed | Variability::Tunable)
        && variable.kind != Kind::String
}

/// What a variable is, in words: its description, or its name.
fn phrase(model: &Nominal, id: VariableId) -> String {
    match model.variable(id).description.as_str() {
        "" => model.name(id),
        text => text.to_owned(),
    }
}

/// Smallest and largest value by the description.
fn limits(variable: &Variable) -> (f64, f64) {
    match variable.kind {
        Kind::Boolean => (0.0, 1.0),
        _ => (variable.min.unwrap_or(f64::NEG_INFINITY), variable.max.unwrap_or(f64::INFINITY)),
    }
}

/// How a variable moves where nobody says.
fn usual(variable: &Variable, neutral: f64) -> Scale {
    match variable.kind {
        Kind::Boolean => Scale::Switch,
        Kind::Integer => Scale::Count,
        _ if neutral != 0.0 => Scale::Relative,
        _ => Scale::Absolute,
    }
}

fn candidate(
    model: &Nominal,
    file: &File,
    entry: &Spanned<raw::Candidate>,
    notices: &mut Vec<Notice>,
) -> Result<Candidate, Error> {
    let raw = entry.get_ref();
    let id = variable(model, &raw.variable, file)?;
    let (name, described) = (model.name(id), model.variable(id));
    if !may_move(described) {
        let problem =
            format!("{name} is no candidate: wanted is a tunable or fixed parameter that is a number");
        return Err(file.wrong(&raw.variable.span(), problem));
    }
    let neutral = match &raw.neutral {
        Some(value) => {
            let wrong = |problem: String| {
                file.wrong(&value.span(), format!("neutral = {}: {problem}", value.get_ref()))
            };
            let neutral = number(described.kind, value.get_ref()).filter(|value| value.is_finite());
            let neutral = neutral.ok_or_else(|| wrong(format!("{name} is of type {}", described.kind)))?;
            let is_none =
                neutral == 0.0 && raw.scale.as_ref().is_some_and(|scale| scale.get_ref() == "saturation");
            if !is_none && !lies_in((neutral, neutral), limits(described)) {
                return Err(wrong(beyond(described)));
            }
            neutral
        }
        None => model.number(id).ok_or_else(|| {
            file.wrong(&raw.variable.span(), format!("{name} has no start value: write its `neutral`"))
        })?,
    };
    let scale = match &raw.scale {
        None => match described.kind {
            Kind::Boolean => Scale::Switch,
            Kind::Integer => Scale::Count,
            _ => Scale::Absolute,
        },
        Some(given) => scale(given, described, neutral, file)?,
    };
    let range = range(raw, described, neutral, scale, file, notices)?;
    let phrase = raw.phrase.clone().unwrap_or_else(|| phrase(model, id));
    Ok(Candidate { name, variable: id, neutral, range, phrase, scale, line: file.line(&entry.span()) })
}

fn scale(given: &Spanned<String>, variable: &Variable, neutral: f64, file: &File) -> Result<Scale, Error> {
    let text = given.get_ref().as_str();
    let wrong = |problem: String| file.wrong(&given.span(), format!("scale = {text:?}: {problem}"));
    let Some((_, scale)) = SCALES.iter().find(|(name, _)| *name == text) else {
        return Err(wrong(nearest(text, SCALES.iter().map(|(name, _)| *name))));
    };
    match (scale, variable.kind) {
        (Scale::Relative, _) if neutral == 0.0 => {
            Err(wrong(format!("{} has the nominal value 0; wanted is \"absolute\"", variable.name)))
        }
        (Scale::Count, Kind::Boolean) => Err(wrong(format!("{} is a Boolean: \"switch\"", variable.name))),
        (Scale::Absolute | Scale::Relative | Scale::Saturation, Kind::Boolean) => {
            Err(wrong(format!("{} is a Boolean: \"switch\"", variable.name)))
        }
        (Scale::Absolute | Scale::Relative | Scale::Saturation, Kind::Integer) => {
            Err(wrong(format!("{} is an Integer: \"count\", or \"switch\"", variable.name)))
        }
        _ => Ok(*scale),
    }
}

/// Whether a range lies in another one, but for rounding: one of factors was multiplied.
fn lies_in((low, high): (f64, f64), (least, most): (f64, f64)) -> bool {
    let rounding = |limit: f64| 2.0 * f64::EPSILON * limit.abs();
    low >= least - rounding(least) && high <= most + rounding(most)
}

/// What to say of a value that the unit does not take.
fn beyond(variable: &Variable) -> String {
    let (least, most) = limits(variable);
    let unit =
        variable.unit.as_deref().filter(|unit| *unit != "1").map_or_else(String::new, |u| format!(" {u}"));
    let within = match (least.is_finite(), most.is_finite()) {
        (true, false) => format!("{least}{unit} or more"),
        (false, true) => format!("{most}{unit} or less"),
        _ => format!("{least} to {most}{unit}"),
    };
    format!("the unit takes {within} for {}", variable.name)
}

/// A range as factors or shares of the neutral value, and as which of them; nothing where it can be neither, or both.
fn relative((low, high): (f64, f64), neutral: f64) -> Option<((f64, f64), &'static str)> {
    let ordered = |one: f64, other: f64| (one.min(other), one.max(other));
    match (low <= 1.0 && 1.0 <= high, low <= 0.0 && 0.0 <= high) {
        (true, false) => Some((ordered(low * neutral, high * neutral), "factors")),
        (_, true) if low < 0.0 || high < 1.0 => {
            Some((ordered((1.0 + low) * neutral, (1.0 + high) * neutral), "shares"))
        }
        _ => None,
    }
}

/// The range in the variable's own unit. A relative candidate may be given it as factors of its neutral value (around 1) or
/// as shares of it (around 0); one that holds both 0 and 1 and nothing below may be meant either way.
fn range(
    raw: &raw::Candidate,
    variable: &Variable,
    neutral: f64,
    scale: Scale,
    file: &File,
    notices: &mut Vec<Notice>,
) -> Result<(f64, f64), Error> {
    let described = limits(variable);
    // 0 of a saturation is none, wherever its values begin
    let is_unlimited = neutral == 0.0 && scale == Scale::Saturation && described.0 <= described.1;
    if !holds(described, neutral) && !is_unlimited {
        let problem = outside(&variable.name, neutral, described);
        return Err(file.wrong(&raw.variable.span(), format!("{problem}: [set] it, or mend its description")));
    }
    let Some(given) = &raw.range else { return Ok(described) };
    let (low, high) = *given.get_ref();
    let wrong = |problem: String| file.wrong(&given.span(), format!("range = [{low}, {high}]: {problem}"));
    if low.is_nan() || high.is_nan() || low >= high {
        return Err(wrong("the smaller value first".into()));
    }
    let line = file.line(&given.span());
    let mut tell = |message: String| notices.push(Notice { file: "dataset.toml".into(), line, message });
    let is_none = |low: f64| scale == Scale::Saturation && low == 0.0;
    let mut within = |(low, high): (f64, f64)| {
        if lies_in((if is_none(low) { described.0 } else { low }, high), described) {
            return Ok((low, high));
        }
        let cut = (if is_none(low) { low } else { low.max(described.0) }, high.min(described.1));
        if cut.0 >= cut.1 || scale != Scale::Saturation && !holds(cut, neutral) {
            return Err(wrong(beyond(variable)));
        }
        tell(format!(
            "range = [{low}, {high}] of {}: {}, and values are looked for in [{}, {}]",
            variable.name,
            beyond(variable),
            cut.0,
            cut.1
        ));
        Ok(cut)
    };
    if holds((low, high), neutral) || scale == Scale::Saturation {
        return within((low, high));
    }
    let Some((range, how)) = relative((low, high), neutral).filter(|_| scale == Scale::Relative) else {
        return Err(wrong(format!("the neutral value {neutral} of {} lies outside", variable.name)));
    };
    let cut = within(range)?;
    tell(format!(
        "range = [{low}, {high}] doesn't hold the neutral value {neutral} of {}: read as {how} of it, [{}, {}]",
        variable.name, range.0, range.1
    ));
    Ok(cut)
}
