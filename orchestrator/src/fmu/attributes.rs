//! What the attributes of a description's elements say, with FMI 2.0's defaults; what is wrong is said with its line.

use crate::fmu::description::{Causality, Initial, Variability};
use crate::value::Kind;
use crate::xml::Element;

/// Line, what is wrong.
pub(super) type Fault = (usize, String);

pub(super) fn required<'a>(element: &'a Element, name: &str) -> Result<&'a str, Fault> {
    element
        .attribute(name)
        .ok_or_else(|| (element.line, format!("<{}> lacks the attribute {name}", element.name)))
}

pub(super) fn parsed<T: std::str::FromStr>(
    element: &Element,
    name: &str,
    what: &str,
) -> Result<Option<T>, Fault> {
    let Some(text) = element.attribute(name) else { return Ok(None) };
    let wrong = || (element.line, format!("{name}=\"{text}\" in <{}> is not {what}", element.name));
    text.trim().parse().map(Some).map_err(|_| wrong())
}

pub(super) fn flag(element: &Element, name: &str) -> Result<Option<bool>, Fault> {
    match element.attribute(name).map(str::trim) {
        None => Ok(None),
        Some("true" | "1") => Ok(Some(true)),
        Some("false" | "0") => Ok(Some(false)),
        Some(text) => {
            Err((element.line, format!("{name}=\"{text}\" in <{}> is neither true nor false", element.name)))
        }
    }
}

pub(super) const NUMBER: &str = "a number";
pub(super) const INTEGER: &str = "an integer";

pub(super) fn kind_of(element: &str) -> Option<Kind> {
    match element {
        "Real" => Some(Kind::Real),
        "Integer" | "Enumeration" => Some(Kind::Integer),
        "Boolean" => Some(Kind::Boolean),
        "String" => Some(Kind::String),
        _ => None,
    }
}

pub(super) fn causality(element: &Element) -> Result<Causality, Fault> {
    Ok(match element.attribute("causality").unwrap_or("local") {
        "parameter" => Causality::Parameter,
        "calculatedParameter" => Causality::CalculatedParameter,
        "input" => Causality::Input,
        "output" => Causality::Output,
        "local" => Causality::Local,
        "independent" => Causality::Independent,
        other => return Err((element.line, format!("causality=\"{other}\" does not exist in FMI 2.0"))),
    })
}

pub(super) fn variability(element: &Element, kind: Kind) -> Result<Variability, Fault> {
    Ok(match element.attribute("variability") {
        Some("constant") => Variability::Constant,
        Some("fixed") => Variability::Fixed,
        Some("tunable") => Variability::Tunable,
        Some("discrete") => Variability::Discrete,
        Some("continuous") => Variability::Continuous,
        None if kind == Kind::Real => Variability::Continuous,
        None => Variability::Discrete,
        Some(other) => {
            return Err((element.line, format!("variability=\"{other}\" does not exist in FMI 2.0")));
        }
    })
}

/// `initial` with the defaults of the table in FMI 2.0 section 2.2.7.
pub(super) fn initial(
    element: &Element,
    causality: Causality,
    variability: Variability,
) -> Result<Option<Initial>, Fault> {
    Ok(match (element.attribute("initial"), causality, variability) {
        (Some("exact"), ..) => Some(Initial::Exact),
        (Some("approx"), ..) => Some(Initial::Approx),
        (Some("calculated"), ..) => Some(Initial::Calculated),
        (Some(other), ..) => {
            return Err((element.line, format!("initial=\"{other}\" does not exist in FMI 2.0")));
        }
        (None, Causality::Input | Causality::Independent, _) => None,
        (None, Causality::Parameter, _) | (None, _, Variability::Constant) => Some(Initial::Exact),
        (None, ..) => Some(Initial::Calculated),
    })
}
