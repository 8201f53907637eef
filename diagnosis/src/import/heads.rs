//! The head of a column: a name and, in one of the ways that people write it, a unit of measurement.

use super::times::TIME_NAMES;
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

/// `T [degC]`, `T (degC)`, `T / degC`, `T in degC`, `T_degC`, `tau_Nm`, `T`.
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
            // `v / (m/s)`
            return whole(name.trim().trim_end_matches('/'), Some(unit));
        }
    }
    let known = |unit: &str| measure::named(unit).is_some() && unit.trim().parse::<f64>().is_err();
    for separator in [" in ", " / "] {
        if let Some((name, unit)) = text.split_once(separator)
            && known(unit)
        {
            return whole(name, Some(unit));
        }
    }
    for separator in ["/", "_"] {
        if let Some((name, unit)) = text.rsplit_once(separator)
            && name.len() > 1 - usize::from(separator == "_")
            // a letter or two after an underscore is more often an index than a metre, and `in` is more often where something flows in
            && (separator != "_" || unit.chars().count() > 1 || "VAKNWs".contains(unit))
            && unit != "in"
            && known(unit)
        {
            return whole(name, Some(unit));
        }
    }
    // `TimeUS` of a flight controller, `timestampMs`
    let lower = text.to_lowercase();
    let clock = TIME_NAMES.iter().filter(|name| name.len() > 1).find_map(|name| {
        let unit = lower.strip_prefix(name)?;
        (unit.len() > 1 && measure::seconds(unit).is_ok()).then_some((*name, unit))
    });
    clock.map_or_else(|| whole(text, None), |(name, unit)| whole(name, Some(unit)))
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
            // a letter is a name, and what divides may stand in the unit
            ("v / m/s", "v", Some("m/s")),
            ("v / (m/s)", "v", Some("m/s")),
            ("v in m/s", "v", Some("m/s")),
            ("x in mm", "x", Some("mm")),
            ("x / mm", "x", Some("mm")),
            ("x [in]", "x", Some("in")),
            ("x / in", "x", Some("in")),
            ("Supply/V", "Supply", Some("V")),
            ("m/s", "m/s", None),
            ("T_in", "T_in", None),
            ("flow in", "flow in", None),
            ("TimeUS", "time", Some("us")),
            ("timestampMs", "timestamp", Some("ms")),
            ("timestamp", "timestamp", None),
            ("times", "times", None),
        ] {
            let head = header(text);
            assert_eq!((head.name.as_str(), head.unit.as_deref()), (name, unit), "{text}");
        }
        assert_eq!(measure::named("in"), measure::named("inch"));
    }
}
