//! From a study's text to a [`Study`]: the keys and their types. Designs have a file of their own.

use super::text::{self, Entry, Origin, Text};
use super::{Parameter, Signals, Study, Until, designs};
use crate::error::Error;
use crate::scalar::Scalar;
use orchestrator::scenario::Placed;
use orchestrator::suggest::nearest;
use orchestrator::time::Rational;
use report::tally::{Reduce, Test};
use std::path::Path;

const KEYS: [&str; 13] = [
    "format",
    "description",
    "scenario",
    "stop",
    "until",
    "set",
    "grid",
    "list",
    "random",
    "latin-hypercube",
    "sobol",
    "scalars",
    "signals",
];

pub(super) fn study(source: &str, origin: &Origin, name: String, folder: &Path) -> Result<Study, Error> {
    let at = &Text { text: source, origin };
    let parsed = at.parse()?;
    let top = parsed.get_ref();
    if top.contains_key("experiment") && top.contains_key("units") {
        let expected =
            "a study, which names its scenario; to vary values of a scenario itself, give it with --grid";
        return Err(at.wrong(&(0..0), "this is a scenario", expected));
    }
    let entries = text::known(at, top, "a study", &KEYS)?;
    let find = |key: &str| entries.iter().find(|(known, ..)| *known == key);
    let needed = |key: &str, expected: &str| {
        find(key).ok_or_else(|| at.wrong(&(0..0), format!("it has no `{key}`"), expected.to_owned()))
    };
    let format = needed("format", "format = 1")?;
    if text::digits(format.1).as_deref() != Some("1") {
        let what = at.shown(&format.2);
        return Err(at.wrong(&format.2, what, "this program reads format = 1"));
    }
    if let Some(description) = find("description") {
        text::string(at, description, "a text")?;
    }
    let named = needed("scenario", "the name of a scenario or its path")?;
    let scenario = text::string(at, named, "a text")?;
    let (parameters, design) = designs::design(at, &entries)?;
    let study = Study {
        text: source.to_owned(),
        name,
        scenario: beside(&scenario, folder),
        scenario_place: at.place(&named.2),
        stop: find("stop").map(|entry| stop(at, entry)).transpose()?,
        until: find("until").map(|entry| until(at, entry)).transpose()?,
        set: find("set").map_or(Ok(Vec::new()), |entry| set(at, entry))?,
        scalars: find("scalars").map_or(Ok(Vec::new()), |entry| scalars(at, entry))?,
        signals: find("signals").map(|entry| signals(at, entry)).transpose()?,
        parameters,
        design,
    };
    if study.scalars.is_empty() && study.signals.is_none() {
        let expected =
            "[scalars], e.g. peak = { signal = \"plant.tau_applied\", reduce = \"peak\" }, or [signals]";
        return Err(at.wrong(&(0..0), "nothing of a run would be kept", expected));
    }
    names(&study)?;
    Ok(study)
}

/// A shipped scenario keeps its name; a file lies beside the study.
fn beside(scenario: &str, folder: &Path) -> String {
    let shipped = scenarios::SHIPPED.iter().any(|(name, _)| *name == scenario);
    let path = folder.join(scenario);
    if shipped || (!path.exists() && !scenario.contains('.')) {
        return scenario.to_owned();
    }
    path.to_string_lossy().into_owned()
}

/// No two columns of the data set may have one name.
fn names(study: &Study) -> Result<(), Error> {
    let mut known = vec!["case", "status", "error"];
    let parameters = study.parameters.iter().map(|parameter| (parameter.name.as_str(), &parameter.place));
    let scalars = study.scalars.iter().map(|scalar| (scalar.name.as_str(), &scalar.place));
    for (name, place) in parameters.chain(scalars) {
        if known.contains(&name) {
            let expected = "another name: the data set has such a column already".into();
            return Err(Error::Study { place: place.clone(), what: format!("a second {name:?}"), expected });
        }
        known.push(name);
    }
    let fixed = |parameter: &&Parameter| study.parameters.iter().any(|varied| varied.name == parameter.name);
    if let Some(both) = study.set.iter().find(fixed) {
        let what = format!("{} is set, and varies too", both.name);
        return Err(Error::Study { place: both.place.clone(), what, expected: "one of both".into() });
    }
    Ok(())
}

/// Checked where it is applied to the scenario.
fn stop(at: &Text<'_>, entry: &Entry<'_>) -> Result<(String, String), Error> {
    let (_, value, span) = entry;
    let typed = text::digits(value).or_else(|| value.as_str().map(str::to_owned));
    let wrong = || at.wrong(span, at.shown(span), "a time in s, such as 30, 0.5 or \"1/3\"");
    Ok((typed.ok_or_else(wrong)?, at.place(span)))
}

/// `plant.contact`, `plant.q2 > 2` or `plant.q2 < -2`.
fn until(at: &Text<'_>, entry: &Entry<'_>) -> Result<Until, Error> {
    let expected = "a Boolean such as \"plant.contact\", or \"plant.q2 > 2\", or \"plant.q2 < -2\"";
    let typed = text::string(at, entry, expected)?;
    let place = at.place(&entry.2);
    let Some(sign) = typed.find(['<', '>']) else {
        return Ok(Until { signal: typed.trim().to_owned(), test: Test::True, place });
    };
    let (signal, limit) = (typed[..sign].trim().to_owned(), typed[sign + 1..].trim());
    let limit: Option<f64> = limit.parse().ok().filter(|limit: &f64| limit.is_finite());
    let limit = limit.ok_or_else(|| at.wrong(&entry.2, format!("until = {typed:?}"), expected))?;
    let test = if typed[sign..].starts_with('>') { Test::Above(limit) } else { Test::Below(limit) };
    Ok(Until { signal, test, place })
}

fn set(at: &Text<'_>, entry: &Entry<'_>) -> Result<Vec<Parameter>, Error> {
    let table = text::table(at, entry, "a table: [set] and lines such as \"camera.sigma\" = 5")?;
    let one = |entry: &Entry<'_>| {
        let value = Some(text::value(at, entry)?);
        Ok(Parameter { name: designs::parameter(at, entry)?, place: at.place(&entry.2), value })
    };
    text::entries(table).iter().map(one).collect()
}

fn scalars(at: &Text<'_>, entry: &Entry<'_>) -> Result<Vec<Scalar>, Error> {
    let table = text::table(at, entry, "a table: [scalars] and a line for each")?;
    text::entries(table).iter().map(|entry| scalar(at, entry)).collect()
}

fn scalar(at: &Text<'_>, entry: &Entry<'_>) -> Result<Scalar, Error> {
    let (name, _, span) = entry;
    let table = text::table(at, entry, "{ signal = \"unit.variable\", reduce = \"last\" }")?;
    let keys = ["signal", "minus", "reduce", "above", "below"];
    let entries = text::known(at, table, &format!("the scalar {name}"), &keys)?;
    let find = |key: &str| entries.iter().find(|(known, ..)| *known == key);
    let lacks = |key: &str, expected: &str| at.wrong(span, format!("{name} has no {key}"), expected);
    let signal = find("signal").ok_or_else(|| lacks("signal", "signal = \"unit.variable\""))?;
    let reduce =
        find("reduce").ok_or_else(|| lacks("reduce", &format!("one of {}", Reduce::NAMES.join(", "))))?;
    let typed = text::string(at, reduce, "a text")?;
    let limit = |key: &str| find(key).map(|entry| text::number(at, entry)).transpose();
    let test = match (limit("above")?, limit("below")?) {
        (None, None) => Test::True,
        (Some(limit), None) => Test::Above(limit),
        (None, Some(limit)) => Test::Below(limit),
        (Some(_), Some(_)) => {
            return Err(at.wrong(span, format!("{name} has above and below"), "one of both"));
        }
    };
    let known = Reduce::named(&typed, test);
    let unknown =
        || at.wrong(&reduce.2, format!("reduce = {typed:?}"), nearest(&typed, Reduce::NAMES.into_iter()));
    let reduce = known.ok_or_else(unknown)?;
    if test != Test::True && !matches!(reduce, Reduce::FirstTrue(_)) {
        return Err(at.wrong(
            span,
            format!("{name}: above or below"),
            "they go with reduce = \"first_true\"",
        ));
    }
    Ok(Scalar {
        name: name.to_string(),
        signal: text::string(at, signal, "unit.variable")?,
        minus: find("minus").map(|entry| text::string(at, entry, "unit.variable")).transpose()?,
        reduce,
        place: at.place(span),
    })
}

fn signals(at: &Text<'_>, entry: &Entry<'_>) -> Result<Signals, Error> {
    let table = text::table(at, entry, "a table: [signals] and variables = [...]")?;
    let entries = text::known(at, table, "[signals]", &["variables", "every"])?;
    let find = |key: &str| entries.iter().find(|(known, ..)| *known == key);
    let expected = "variables = [\"plant.*\", \"camera.q1_est\"]";
    let (_, list, span) =
        find("variables").ok_or_else(|| at.wrong(&entry.2, "[signals] names none", expected))?;
    let list = list.as_array().ok_or_else(|| at.wrong(span, at.shown(span), expected))?;
    let mut variables = Vec::new();
    for one in list.iter() {
        let value =
            one.get_ref().as_str().ok_or_else(|| at.wrong(&one.span(), at.shown(&one.span()), expected))?;
        variables.push(Placed { value: value.to_owned(), place: at.scenario_place(&one.span()) });
    }
    if variables.is_empty() {
        return Err(at.wrong(span, "variables = []", expected));
    }
    let every = find("every").map(|(_, value, span)| {
        let typed = text::digits(value).or_else(|| value.as_str().map(str::to_owned));
        let time = typed.and_then(|typed| Rational::recover(&typed)).filter(|(time, _)| time.is_positive());
        let wrong = || at.wrong(span, at.shown(span), "a time in s above 0, such as 0.01");
        Ok::<_, Error>(time.ok_or_else(wrong)?.0)
    });
    Ok(Signals { variables, every: every.transpose()? })
}
