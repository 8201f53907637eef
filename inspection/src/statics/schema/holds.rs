//! Whether an attribute's text is of its XML Schema type.

use super::tables::Holds;
use crate::model;
use orchestrator::nearest;

/// What `dependenciesKind` may hold.
const KINDS: &[&str] = &["dependent", "constant", "fixed", "tunable", "discrete"];

impl Holds {
    /// What would be right, in words, where a value is not.
    pub(super) fn wrong(&self, value: &str) -> Option<String> {
        let text = value.trim();
        let unsigned = |text: &str| text.parse::<u32>().is_ok();
        let (right, expected) = match self {
            Self::Text => return None,
            Self::Double => (model::number(text).is_some(), "a number"),
            Self::Int => (text.parse::<i32>().is_ok(), "an integer of 32 bits"),
            Self::Unsigned => (unsigned(text), "a whole number of 32 bits, 0 or more"),
            Self::Boolean => (matches!(text, "true" | "false" | "1" | "0"), "true or false"),
            Self::DateTime => (is_date_and_time(text), "a date and time such as 2026-11-24T12:00:00Z"),
            Self::Unsigneds => (text.split_whitespace().all(unsigned), "indices, parted by spaces"),
            Self::OneOf(names) => {
                let hint = || format!("there is no such value; {}", nearest(text, names.iter().copied()));
                return (!names.contains(&text)).then(hint);
            }
            Self::Kinds => {
                let wrong = text.split_whitespace().find(|word| !KINDS.contains(word))?;
                return Some(format!("wanted is one of {} ({wrong} is none)", KINDS.join(", ")));
            }
        };
        (!right).then(|| format!("wanted is {expected}"))
    }
}

/// `xs:dateTime`: 2026-11-24T12:00:00, with a fraction of the second and a zone if wanted.
fn is_date_and_time(text: &str) -> bool {
    let pattern = |text: &str, pattern: &str| {
        text.len() == pattern.len()
            && text
                .bytes()
                .zip(pattern.bytes())
                .all(|(a, b)| if b == b'0' { a.is_ascii_digit() } else { a == b })
    };
    let Some(rest) = text.get(..19).filter(|head| pattern(head, "0000-00-00T00:00:00")).and(text.get(19..))
    else {
        return false;
    };
    let rest = match rest.strip_prefix('.') {
        Some(fraction) => {
            let zone = fraction.trim_start_matches(|c: char| c.is_ascii_digit());
            if zone.len() == fraction.len() {
                return false;
            }
            zone
        }
        None => rest,
    };
    rest.is_empty() || rest == "Z" || pattern(rest, "+00:00") || pattern(rest, "-00:00")
}
