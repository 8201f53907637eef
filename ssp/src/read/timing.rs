//! When units step and how long a run lasts. SSP says little of it: what it leaves open comes from annotations of ours, of
//! OMSimulator and of libcosim, then from the units, and is told.

use super::document::{Document, find, ours};
use super::tree::{Component, Tree};
use crate::{Error, annotation};
use orchestrator::scenario::{Channel, Hold, Placed};
use orchestrator::time::Rational;
use orchestrator::xml::Element;
use orchestrator::{Isolation, limit_of};

/// A run of which nobody says how long it lasts, in s.
const LASTS: i128 = 1;
/// Steps of a run of which nobody says how long they are.
const STEPS: i128 = 1000;

/// From when to when.
pub(super) struct Span {
    pub(super) start: Rational,
    pub(super) stop: Rational,
}

/// A time in s that an attribute gives, with a note if it was read otherwise than it was written.
fn time(
    document: &Document,
    element: &Element,
    name: &str,
    notes: &mut Vec<String>,
) -> Result<Option<Rational>, Error> {
    let Some(text) = element.attribute(name) else { return Ok(None) };
    let (time, recovered) = Rational::recover(text.trim()).ok_or_else(|| {
        let expected = "a time in s that fits 64-bit fractions, such as 0.001, 5e-3 or 1/30";
        document.wrong(element, format!("{name}=\"{text}\" of <{}>", element.name), expected)
    })?;
    if recovered {
        notes.push(format!("{}: {name} = {text} is read as {time}", document.place(element)));
    }
    Ok(Some(time))
}

fn step(
    document: &Document,
    element: &Element,
    name: &str,
    notes: &mut Vec<String>,
) -> Result<Option<Rational>, Error> {
    let given = time(document, element, name, notes)?;
    match given.filter(|step| !step.is_positive()) {
        None => Ok(given),
        Some(step) => {
            let what = format!("{name}=\"{step}\" of <{}>", element.name);
            Err(document.wrong(element, what, "greater than zero"))
        }
    }
}

pub(super) fn span(tree: &Tree, notes: &mut Vec<String>) -> Result<Span, Error> {
    let document = &tree.nodes[0].parts[0].document;
    let standard = document.root.child("DefaultExperiment");
    let own = ours(&document.root, annotation::EXPERIMENT);
    let mut given = |own_name, name| -> Result<Option<Rational>, Error> {
        // The exact text counts while it is the same double: another tool may have changed the standard's attribute.
        let exact = own.map_or(Ok(None), |own| time(document, own, own_name, notes))?;
        let double = standard.map_or(Ok(None), |element| document.number(element, name))?;
        match (exact, double, standard) {
            (Some(exact), None, _) => Ok(Some(exact)),
            (Some(exact), Some(double), _) if exact.to_f64() == double => Ok(Some(exact)),
            (_, _, Some(element)) => time(document, element, name, notes),
            (_, _, None) => Ok(None),
        }
    };
    let start = given("start", "startTime")?.unwrap_or(Rational::ZERO);
    let stop = given("stop", "stopTime")?;
    if let Some(stop) = stop.filter(|stop| stop.to_f64() < start.to_f64()) {
        let at = standard.unwrap_or(&document.root);
        let expected = format!("not before startTime = {start}");
        return Err(document.wrong(at, format!("stopTime=\"{stop}\""), expected));
    }
    let stop = match stop {
        Some(stop) => stop,
        None => {
            let of_units = tree.components.iter().filter_map(|c| c.description.default_experiment.stop);
            let longest =
                of_units.filter(|stop| *stop > start.to_f64()).fold(None, |longest: Option<f64>, stop| {
                    Some(longest.map_or(stop, |longest| longest.max(stop)))
                });
            let (stop, whose) = match longest.and_then(Rational::from_f64) {
                Some(stop) => (stop, "the latest of its units'"),
                None => {
                    (plus(start, Rational::new(LASTS, 1)).unwrap_or(start), "since its units say none either")
                }
            };
            let file = &document.file;
            notes
                .push(format!("{file} says no stopTime: it is {stop} s, {whose}; --stop T sets another one"));
            stop
        }
    };
    Ok(Span { start, stop })
}

fn plus(a: Rational, b: Option<Rational>) -> Option<Rational> {
    let b = b?;
    let over = i128::from(a.numerator()) * i128::from(b.denominator())
        + i128::from(b.numerator()) * i128::from(a.denominator());
    Rational::new(over, i128::from(a.denominator()) * i128::from(b.denominator()))
}

/// Sums of delays.
pub(super) fn sum(a: Rational, b: Rational) -> Option<Rational> {
    plus(a, Some(b))
}

/// The communication interval of each component.
pub(super) fn intervals(tree: &Tree, span: &Span, notes: &mut Vec<String>) -> Result<Vec<Rational>, Error> {
    let document = &tree.nodes[0].parts[0].document;
    let base = base_step(document, notes)?;
    let mut guessed: Vec<String> = Vec::new();
    let mut all = Vec::with_capacity(tree.components.len());
    for component in &tree.components {
        let element = &component.part.element;
        let own = ours(element, annotation::UNIT);
        let own = own.map_or(Ok(None), |own| step(&component.part.document, own, "interval", notes))?;
        let hint = find(element, "StepSizeHint");
        let hint = hint.map_or(Ok(None), |hint| step(&component.part.document, hint, "value", notes))?;
        let path = &tree.nodes[component.node].path;
        let interval = match own.or(hint).or(base) {
            Some(interval) => interval,
            None => {
                let (interval, whose) = by_unit(component, span);
                guessed.push(format!("{path} {interval} s{whose}"));
                interval
            }
        };
        all.push(interval);
    }
    if !guessed.is_empty() {
        let shown = guessed.join(", ");
        notes.push(format!(
            "{}: it says no communication intervals, so these are taken: {shown}",
            document.file
        ));
    }
    Ok(all)
}

/// The step that OMSimulator or libcosim would make.
fn base_step(document: &Document, notes: &mut Vec<String>) -> Result<Option<Rational>, Error> {
    let attributes = [
        ("FixedStepMaster", "stepSize"),
        ("FixedStepAlgorithm", "baseStepSize"),
        ("VariableStepMaster", "maximumStepSize"),
    ];
    for (name, attribute) in attributes {
        if let Some(element) = find(&document.root, name)
            && let Some(step) = step(document, element, attribute, notes)?
        {
            return Ok(Some(step));
        }
    }
    Ok(None)
}

fn by_unit(component: &Component, span: &Span) -> (Rational, &'static str) {
    let printed = component.description.default_experiment.step_size.filter(|step| *step > 0.0);
    let of_unit = printed.and_then(|step| Rational::recover(zmij::Buffer::new().format(step)));
    if let Some((step, _)) = of_unit.filter(|(step, _)| step.is_positive()) {
        return (step, "");
    }
    let lasts = i128::from(span.stop.numerator()) * i128::from(span.start.denominator())
        - i128::from(span.start.numerator()) * i128::from(span.stop.denominator());
    let under = i128::from(span.stop.denominator()) * i128::from(span.start.denominator()) * STEPS;
    let share = Rational::new(lasts, under).filter(|share| share.is_positive());
    let thousandth = Rational::new(LASTS, STEPS).unwrap_or(Rational::ZERO);
    (share.unwrap_or(thousandth), " (a thousandth of the run: its unit says none)")
}

/// A process of its own, as our annotation says.
pub(super) fn isolation(component: &Component) -> Result<Option<Isolation>, Error> {
    let Some(own) = ours(&component.part.element, annotation::UNIT) else { return Ok(None) };
    let document = &component.part.document;
    if !document.flag(own, "isolate")? {
        return Ok(None);
    }
    let mut isolation = Isolation::default();
    if let Some(seconds) = document.number(own, "step_limit")? {
        let wrong =
            || document.wrong(own, format!("step_limit=\"{seconds}\""), "seconds, above zero and below 1e9");
        isolation.step_limit = limit_of(seconds).ok_or_else(wrong)?;
    }
    if let Some(text) = own.attribute("memory_limit") {
        let bytes =
            text.parse::<u64>().ok().and_then(|limit| limit.checked_mul(1 << 20)).filter(|limit| *limit > 0);
        let wrong = || document.wrong(own, format!("memory_limit=\"{text}\""), "MiB, above zero");
        isolation.memory_limit = Some(bytes.ok_or_else(wrong)?);
    }
    Ok(Some(isolation))
}

fn not_negative(document: &Document, own: &Element, name: &str) -> Result<Rational, Error> {
    let time = time(document, own, name, &mut Vec::new())?.unwrap_or(Rational::ZERO);
    match time.is_negative() {
        false => Ok(time),
        true => Err(document.wrong(own, format!("{name}=\"{time}\""), "not less than zero")),
    }
}

/// How much later than the start a component's points begin.
pub(super) fn offset(component: &Component) -> Result<Option<Placed<Rational>>, Error> {
    let document = &component.part.document;
    let Some(own) = ours(&component.part.element, annotation::UNIT) else { return Ok(None) };
    let value = not_negative(document, own, "offset")?;
    Ok(value.is_positive().then(|| Placed { value, place: document.place(own) }))
}

/// Whether a discarded step is made again in shorter ones.
pub(super) fn retry(component: &Component) -> Result<bool, Error> {
    let own = ours(&component.part.element, annotation::UNIT);
    own.map_or(Ok(false), |own| component.part.document.flag(own, "retry"))
}

/// A seed of random numbers.
pub(super) fn seed(document: &Document, own: &Element) -> Result<Option<u64>, Error> {
    let Some(text) = own.attribute("seed") else { return Ok(None) };
    let wrong = || document.wrong(own, format!("seed=\"{text}\""), "a whole number, 0 or more");
    text.parse().map(Some).map_err(|_| wrong())
}

/// The latency that our annotation gives a connection, and what else happens on the way.
pub(super) fn channel(document: &Document, own: &Element) -> Result<(Rational, Channel), Error> {
    let drop = document.number(own, "drop")?.unwrap_or(0.0);
    if !(0.0..=1.0).contains(&drop) {
        return Err(document.wrong(own, format!("drop=\"{drop}\""), "a share from 0 to 1"));
    }
    let hold = match own.attribute("hold") {
        None | Some("zero") => Hold::Zero,
        Some("linear") => Hold::Linear,
        Some(other) => return Err(document.wrong(own, format!("hold=\"{other}\""), "zero or linear")),
    };
    let channel =
        Channel { jitter: not_negative(document, own, "jitter")?, drop, hold, seed: seed(document, own)? };
    Ok((not_negative(document, own, "latency")?, channel))
}
