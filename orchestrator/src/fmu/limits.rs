//! How much of a `.fmu` file is taken: a small archive may unpack to any size. Each limit can be moved by an environment
//! variable, and whoever meets one is told which.

use crate::error::Error;

/// Limits of one archive.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    /// Bytes that are unpacked, all files together.
    pub(crate) unpacked: u64,
    /// Entries of the archive.
    pub(crate) entries: u64,
    /// Bytes of `modelDescription.xml`.
    pub(crate) description: u64,
}

/// Moves [`Limits::unpacked`].
pub(crate) const UNPACKED: &str = "ACROSCOPE_MAX_UNPACKED";
/// Moves [`Limits::entries`].
pub(crate) const ENTRIES: &str = "ACROSCOPE_MAX_ENTRIES";
/// Moves [`Limits::description`].
pub(crate) const DESCRIPTION: &str = "ACROSCOPE_MAX_DESCRIPTION";

impl Limits {
    /// The defaults, or what the environment says. A unit that brings a Python installation unpacks 0.5 GB in 20 000
    /// files; the description of a million variables has 150 MB.
    pub(crate) fn from_environment() -> Result<Self, Error> {
        let limit = |name: &str, default: u64| match std::env::var(name) {
            Err(_) => Ok(default),
            Ok(text) => size(&text).ok_or_else(|| Error::Value {
                name: name.into(),
                value: text,
                expected: "a whole number, with K, M or G for 2¹⁰, 2²⁰ or 2³⁰ of them".into(),
            }),
        };
        Ok(Self {
            unpacked: limit(UNPACKED, 2 << 30)?,
            entries: limit(ENTRIES, 100_000)?,
            description: limit(DESCRIPTION, 256 << 20)?,
        })
    }
}

/// Why an archive is refused, and what would let it in.
pub(crate) fn exceeded(what: &str, limit: u64, variable: &str) -> String {
    let twice = shown(limit.saturating_mul(2));
    format!("{what} exceeds the limit of {}; if it is to be trusted, set {variable}={twice}", shown(limit))
}

fn size(text: &str) -> Option<u64> {
    let text = text.trim();
    let (digits, shift) = match text.as_bytes().last()?.to_ascii_uppercase() {
        b'K' => (&text[..text.len() - 1], 10),
        b'M' => (&text[..text.len() - 1], 20),
        b'G' => (&text[..text.len() - 1], 30),
        _ => (text, 0),
    };
    digits.trim().parse::<u64>().ok()?.checked_mul(1 << shift)
}

fn shown(size: u64) -> String {
    for (shift, unit) in [(30, "G"), (20, "M"), (10, "K")] {
        if size >= 1 << shift && size.is_multiple_of(1 << shift) {
            return format!("{}{unit}", size >> shift);
        }
    }
    size.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_sizes_are_read_and_shown() {
        for (text, bytes) in [("17", 17), ("3K", 3072), ("2m", 2 << 20), (" 4 G ", 4 << 30)] {
            assert_eq!(size(text), Some(bytes), "{text}");
            assert_eq!(size(&shown(bytes)), Some(bytes));
        }
        for (bytes, text) in
            [(0, "0"), (1, "1"), (1023, "1023"), (1024, "1K"), (3000, "3000"), (3 << 29, "1536M")]
        {
            assert_eq!(shown(bytes), text);
        }
        for wrong in ["", "G", "-1", "1.5G", "2T", "99999999999999999999", "99999999999G"] {
            assert_eq!(size(wrong), None, "{wrong}");
        }
        assert_eq!(
            exceeded("x", 2 << 30, UNPACKED),
            "x exceeds the limit of 2G; if it is to be trusted, set ACROSCOPE_MAX_UNPACKED=4G"
        );
    }
}
