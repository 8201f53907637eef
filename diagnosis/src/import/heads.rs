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

/// Units that stand behind a blank as words: where something flows in, the least of something, how acid it is.
const WORDS: [&str; 3] = ["in", "min", "pH"];
/// What may stand between a name and its unit without more marks: `i/mA`, `i mA`, `i, mA`, `i:mA`.
const BETWEEN: [char; 4] = ['/', ' ', ',', ':'];

/// `T [degC]`, `T (degC)`, `T / degC`, `T in degC`, `T_degC`, `tau_Nm`, `i/mA`, `i mA`, `i, mA`, `i:mA`, `T`.
pub(super) fn header(text: &str) -> Header {
    marked(text)
        .or_else(|| of_time(text))
        .or_else(|| rate(text))
        .or_else(|| joined(text))
        .or_else(|| spaced(text))
        .or_else(|| with_clock(text))
        .unwrap_or_else(|| whole(text, text, None))
}

/// The head as a unit's variables tell it, where it marks no unit: a variable's name before one of them. What is called like a variable as a whole
/// has none behind a mere blank. `is_name`: whether a text is a variable's name.
pub(super) fn beside_variables(text: &str, is_name: &dyn Fn(&str) -> bool) -> Option<Header> {
    if marked(text).is_some() || of_time(text).is_some() {
        return None;
    }
    if is_name(text) {
        return spaced(text).map(|_| whole(text, text, None));
    }
    let is_told = |(name, unit): &(&str, &str)| is_name(name) && known(unit) && !WORDS.contains(unit);
    splits(text).find(is_told).map(|(name, unit)| whole(text, name, Some(unit)))
}

/// Of the heads of one log those that are a name by themselves, though another is the same with a unit: `i` and `i mA` are two things.
pub(super) fn told_apart(heads: &mut [Header]) {
    let texts: Vec<String> = heads.iter().map(|head| head.text.clone()).collect();
    let is_loose = |head: &Header| marked(&head.text).is_none() && texts.contains(&head.name);
    for head in heads.iter_mut().filter(|head| head.name != head.text) {
        if is_loose(head) && spaced(&head.text).is_some() {
            *head = whole(&head.text, &head.text, None);
        }
    }
}

fn whole(text: &str, name: &str, unit: Option<&str>) -> Header {
    Header {
        text: text.to_owned(),
        name: name.trim().to_owned(),
        unit: unit.map(|unit| unit.trim().to_owned()),
    }
}

fn known(unit: &str) -> bool {
    measure::named(unit).is_some() && unit.trim().parse::<f64>().is_err()
}

/// A unit in brackets, behind `in`, or behind a slash with blanks around it.
fn marked(text: &str) -> Option<Header> {
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some((name, rest)) = text.split_once(open)
            && let Some(unit) = rest.trim().strip_suffix(close)
        {
            // `v / (m/s)`
            return Some(whole(text, name.trim().trim_end_matches('/'), Some(unit)));
        }
    }
    let mut parts = [" in ", " / "].into_iter().filter_map(|separator| text.split_once(separator));
    parts.find(|(_, unit)| known(unit)).map(|(name, unit)| whole(text, name, Some(unit)))
}

/// A name and what stands behind it, for each place where a unit may begin, the longest first.
fn splits(text: &str) -> impl DoubleEndedIterator<Item = (&str, &str)> {
    let parts = text.match_indices(BETWEEN).map(|(at, _)| (text[..at].trim(), text[at + 1..].trim()));
    let is_part = |part: &str| !part.is_empty() && !part.ends_with(BETWEEN) && !part.starts_with(BETWEEN);
    parts.filter(move |(name, unit)| is_part(name) && is_part(unit))
}

/// What time is called before a unit of time: `t/s`, `time ms`; `T` is a temperature there.
fn of_time(text: &str) -> Option<Header> {
    let is_called = |name: &str| {
        TIME_NAMES.iter().any(|time| *time == name || time.len() > 1 && *time == name.to_lowercase())
    };
    let is_time = |(name, unit): &(&str, &str)| is_called(name) && measure::seconds(unit).is_ok();
    splits(text).find(is_time).map(|(name, unit)| whole(text, name, Some(unit)))
}

/// `v m/s`: what stands before the slash is no name where the whole is something in a time.
fn rate(text: &str) -> Option<Header> {
    let is_rate = |(_, unit): &(&str, &str)| {
        let over = unit.rsplit_once('/').is_some_and(|(_, under)| {
            let is_time = |under: &str| measure::seconds(under).is_ok();
            is_time(under)
                || under.strip_suffix(['2', '²']).is_some_and(|under| is_time(under.trim_end_matches('^')))
        });
        over && known(unit)
    };
    splits(text).find(is_rate).map(|(name, unit)| whole(text, name, Some(unit)))
}

/// A unit behind a slash or an underscore.
fn joined(text: &str) -> Option<Header> {
    let slash =
        || text.rsplit_once('/').filter(|(name, _)| !name.is_empty() && (name.len() > 1 || !known(text)));
    // a letter or two after an underscore is more often an index than a metre
    let is_long = |unit: &str| unit.chars().count() > 1 || "VAKNWs".contains(unit);
    let underscore = || text.rsplit_once('_').filter(|(name, unit)| !name.is_empty() && is_long(unit));
    // and `in` is more often where something flows in
    let is_unit = |(_, unit): &(&str, &str)| *unit != "in" && known(unit);
    let (name, unit) = slash().filter(is_unit).or_else(|| underscore().filter(is_unit))?;
    Some(whole(text, name, Some(unit)))
}

/// A unit behind a mere blank, comma or colon: the shortest, and no letter alone, which is rather an index or a part of the name, as are words that
/// are units by chance.
fn spaced(text: &str) -> Option<Header> {
    let is_word = |unit: &str| unit.chars().count() < 2 || WORDS.contains(&unit);
    let (name, unit) = splits(text).rfind(|(_, unit)| known(unit))?;
    (!is_word(unit)).then(|| whole(text, name, Some(unit)))
}

/// `TimeUS` of a flight controller, `timestampMs`.
fn with_clock(text: &str) -> Option<Header> {
    let lower = text.to_lowercase();
    TIME_NAMES.iter().filter(|name| name.len() > 1).find_map(|name| {
        let unit = lower.strip_prefix(name)?;
        (unit.len() > 1 && measure::seconds(unit).is_ok()).then(|| whole(text, name, Some(unit)))
    })
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
            ("i/mA", "i", Some("mA")),
            ("i mA", "i", Some("mA")),
            ("i, mA", "i", Some("mA")),
            ("i:mA", "i", Some("mA")),
            ("motor current: mA", "motor current", Some("mA")),
            ("Seil/°C", "Seil", Some("°C")),
            ("tau kNm", "tau", Some("kNm")),
            ("v m/s", "v", Some("m/s")),
            ("a, m/s^2", "a", Some("m/s^2")),
            ("box T/K", "box T", Some("K")),
            ("t/ms", "t", Some("ms")),
            ("t s", "t", Some("s")),
            // what is a unit as a whole, an index, a word, a number
            ("T/K", "T/K", None),
            ("motor A", "motor A", None),
            ("box T", "box T", None),
            ("T min", "T min", None),
            ("tank pH", "tank pH", None),
            ("Set Point 1", "Set Point 1", None),
            ("x:y", "x:y", None),
            ("mA", "mA", None),
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

    #[test]
    fn value_heads_beside_the_variables_of_a_unit() {
        let names = ["i", "T", "box T", "F", "q", "tank mV", "tau"];
        let of = |text: &str| {
            let head = beside_variables(text, &|name| names.contains(&name));
            head.map(|head| (head.name, head.unit))
        };
        let read = |name: &str, unit: &str| Some((name.to_owned(), Some(unit.to_owned())));
        for (text, name, unit) in [
            ("i mA", "i", "mA"),
            // ratios, letters and several units behind a variable's name are its unit
            ("T/K", "T", "K"),
            ("F/kN", "F", "kN"),
            ("i A", "i", "A"),
            ("T: K", "T", "K"),
            ("box T/K", "box T", "K"),
            ("tau N m", "tau", "N m"),
            ("q l/min", "q", "l/min"),
        ] {
            assert_eq!(of(text), read(name, unit), "{text}");
        }
        // what is a variable as a whole, and what says its unit by itself
        assert_eq!(of("tank mV"), Some(("tank mV".into(), None)));
        for text in ["box T", "i [mA]", "i / mA", "i in mA", "u mA", "i blorps", "T min", "q in"] {
            assert_eq!(of(text), None, "{text}");
        }
    }

    #[test]
    fn value_of_two_columns_one_is_the_others_name_and_a_unit() {
        let mut heads = ["i", "i mA", "u mV", "w [rpm]", "w"].map(header);
        told_apart(&mut heads);
        let names = heads.map(|head| (head.name, head.unit.is_some()));
        let wanted = [("i", false), ("i mA", false), ("u", true), ("w", true), ("w", false)];
        assert_eq!(names, wanted.map(|(name, unit)| (name.to_owned(), unit)));
    }
}
