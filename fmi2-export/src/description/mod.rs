//! What a unit says of itself, read off its declaration: description, GUID, pages, and the mistakes in it.

mod check;
mod html;
mod notation;
mod xml;

use crate::model::{Dependencies, Description, Model};
use crate::table::{Causality, Kind, Table, Variable};
use sha2::{Digest, Sha256};

/// A unit's declaration as a whole.
pub struct Unit {
    /// What concerns no single variable.
    pub head: Description,
    /// All variables; the place is the value reference.
    pub variables: Vec<Variable>,
    dependencies: fn(&str) -> Dependencies,
}

impl Unit {
    /// The declaration of a model.
    pub fn of<M: Model>() -> Self {
        Self { head: M::description(), variables: M::Variables::variables(), dependencies: M::dependencies }
    }

    /// A fingerprint of the description (with the place of the GUID empty), in the usual form.
    pub fn guid(&self) -> String {
        let digest = Sha256::digest(self.xml_with("").as_bytes());
        let hex: String = digest.iter().take(16).map(|byte| format!("{byte:02x}")).collect();
        let (a, b, c, d, e) = (&hex[..8], &hex[8..12], &hex[12..16], &hex[16..20], &hex[20..]);
        format!("{{{a}-{b}-{c}-{d}-{e}}}")
    }

    /// `modelDescription.xml`.
    pub fn xml(&self) -> String {
        self.xml_with(&self.guid())
    }

    /// The highest derivative of an output that another variable gives.
    fn output_derivative_order(&self) -> usize {
        let outputs = self.variables.iter().filter(|variable| variable.causality == Causality::Output);
        let order = |variable: &Variable| {
            let orders = 1..=self.variables.len();
            orders.take_while(|&order| derivative(&self.variables, variable.name, order).is_some()).count()
        };
        outputs.map(order).max().unwrap_or(0)
    }

    fn place(&self, name: &str) -> Option<usize> {
        self.variables.iter().position(|variable| variable.name == name)
    }
}

/// The place of the variable that is the derivative of this order of another one.
pub(crate) fn derivative(variables: &[Variable], of: &str, order: usize) -> Option<usize> {
    let mut found = variables.iter().position(|variable| variable.name == of);
    // More orders than there are variables would be a circle.
    for _ in 0..order.min(variables.len() + 1) {
        let of = variables[found?].name;
        found = variables.iter().position(|variable| variable.derivative_of == Some(of));
    }
    found.filter(|_| order <= variables.len())
}

impl Variable {
    /// A Real that is the time derivative of another one.
    fn is_derivative(&self) -> bool {
        self.derivative_of.is_some()
    }

    /// The start value as text, for people.
    fn start(&self) -> String {
        match &self.kind {
            Kind::Real(value) => number(*value),
            Kind::Integer(value) => value.to_string(),
            Kind::Boolean(value) => value.to_string(),
            Kind::String(value) => format!("\"{value}\""),
        }
    }

    /// The legal range as text, or nothing.
    fn range(&self) -> String {
        match (self.min, self.max) {
            (None, None) => String::new(),
            (Some(min), None) => format!("≥ {}", number(min)),
            (None, Some(max)) => format!("≤ {}", number(max)),
            (Some(min), Some(max)) => format!("{} … {}", number(min), number(max)),
        }
    }
}

/// The shortest text that reads back as the same number.
fn number(value: f64) -> String {
    let text = format!("{value:?}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

/// Headings of the pages, in their order.
const GROUPS: [(Causality, &str); 4] = [
    (Causality::Input, "Inputs"),
    (Causality::Output, "Outputs"),
    (Causality::Parameter, "Parameters"),
    (Causality::Local, "Local variables"),
];

/// Escapes text for XML and HTML, in attributes too.
fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\n' => escaped.push_str("&#10;"),
            other => escaped.push(other),
        }
    }
    escaped
}
