//! The head of a column: a name and, in one of the ways that people write it, a unit of measurement.

use crate::observe::measure;

/// The head of a column.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Header {
    /// As written.
    pub(super) text: String,
    /// Without the unit.
    pub(super) name: String,
    /// Unit of measurement in brackets, after an underscore, or in the line below.
    pub(super) unit: Option<String>,
}

impl Header {
    /// Takes the unit of measurement from the cell below the name, if it holds one.
    pub(super) fn measured_in(&mut self, cell: &str) {
        if !cell.is_empty() {
            self.unit = Some(cell.trim_matches(['[', ']', '(', ')']).to_owned());
        }
    }
}

/// `T [degC]`, `T (degC)`, `T_degC`, `tau_Nm`, `T`.
pub(super) fn header(text: &str) -> Header {
    let whole = |name: &str, unit: Option<&str>| Header {
        text: text.to_owned(),
        name: name.trim().to_owned(),
        unit: unit.map(|unit| unit.trim().to_owned()),
    };
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some((name, rest)) = text.split_once(open)
            && let Some(unit) = rest.trim().strip_suffix(close)
        {
            return whole(name, Some(unit));
        }
    }
    for separator in [" in ", "/", "_"] {
        if let Some((name, unit)) = text.rsplit_once(separator)
            && name.len() > 1 - usize::from(separator == "_")
            // a letter or two after an underscore is more often an index than a metre
            && (separator != "_" || unit.chars().count() > 1 || "VAKNWs".contains(unit))
            && measure::named(unit).is_some()
            && unit.parse::<f64>().is_err()
        {
            return whole(name, Some(unit));
        }
    }
    whole(text, None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_heads_with_units() {
        for (text, name, unit) in [
            ("T [degC]", "T", Some("degC")),
            ("speed (rpm)", "speed", Some("rpm")),
            ("tau_Nm", "tau", Some("Nm")),
            ("motor current in mA", "motor current", Some("mA")),
            ("u_V", "u", Some("V")),
            ("theta_1", "theta_1", None),
            ("x_m", "x_m", None),
            ("T_out", "T_out", None),
            ("phi", "phi", None),
        ] {
            let head = header(text);
            assert_eq!((head.name.as_str(), head.unit.as_deref()), (name, unit), "{text}");
        }
    }
}
