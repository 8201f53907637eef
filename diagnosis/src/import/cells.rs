//! The cells of a log as people and programs write them: numbers with points or commas, marks of thousands, words for what is missing.

use crate::observe::is_date;

/// What is written where nothing was measured, in lower case: by people, by spreadsheets (`#NV` is Excel's `#N/A` in German), by
/// databases, and by programs whose reading overflowed.
const MISSING: [&str; 18] = [
    "nan",
    "-nan",
    "n/a",
    "na",
    "n.a.",
    "#n/a",
    "#nv",
    "null",
    "none",
    "nil",
    "-",
    "--",
    "---",
    "inf",
    "-inf",
    "+inf",
    "infinity",
    "-infinity",
];

/// What is written for no and yes where a cell holds no number, in lower case. What an open valve and an open contact are differs: neither is here.
const BOOLEAN: [[&str; 2]; 3] = [["off", "on"], ["no", "yes"], ["false", "true"]];

/// The numbers of cells that hold two words of a kind, for no and yes, and words of nothing else; what is missing is `NaN`.
pub(super) fn booleans<'a>(cells: impl Iterator<Item = &'a str> + Clone) -> Option<Vec<f64>> {
    BOOLEAN.iter().find_map(|[no, yes]| {
        let read = |cell: &str| match cell {
            _ if cell.eq_ignore_ascii_case(no) => Some(0.0),
            _ if cell.eq_ignore_ascii_case(yes) => Some(1.0),
            _ => is_missing(cell).then_some(f64::NAN),
        };
        cells.clone().map(read).collect()
    })
}

/// What is read so, in words.
pub(super) const BOOLEANS_READ: &str = "of words, on and off, yes and no, true and false are read as 1 and 0";

/// What points and commas in the numbers of a log are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Marks {
    /// Decimals after a point; commas, apostrophes and narrow blanks between thousands.
    Point,
    /// Decimals after a comma; points, apostrophes and narrow blanks between thousands.
    Comma,
    /// Decimals after either.
    Either,
}

impl Marks {
    /// What the cells of a log say: `0.5` has a decimal point whatever else, `1,234.5` as well; `1,234` alone may be either.
    pub(super) fn of<'a>(cells: impl Iterator<Item = &'a str>, between_commas: bool) -> Self {
        let (mut point, mut comma) = (false, false);
        for cell in cells.filter(|cell| cell.contains(['.', ','])) {
            let [pointed, by_comma] = [Self::Point, Self::Comma].map(|marks| marks.plain(cell).is_some());
            point |= pointed && (!by_comma || cell.contains('.') && !is_grouped(cell, '.'));
            comma |= by_comma && !pointed;
        }
        match (point, comma) {
            (false, true) => Self::Comma,
            (true, false) => Self::Point,
            // between commas a number that both would fit has no decimal comma, and one beside decimal points is a mistake
            _ if between_commas => Self::Point,
            _ => Self::Either,
        }
    }

    /// A number, and whether thousands were marked in it.
    pub(super) fn number(self, cell: &str) -> Option<(f64, bool)> {
        match cell {
            "true" | "True" | "TRUE" => return Some((1.0, false)),
            "false" | "False" | "FALSE" => return Some((0.0, false)),
            _ => {}
        }
        self.plain(cell)
    }

    fn plain(self, cell: &str) -> Option<(f64, bool)> {
        let (decimal, between) = match self {
            Self::Comma => (',', '.'),
            Self::Either if cell.contains(',') && !cell.contains('.') => (',', '.'),
            Self::Point | Self::Either => ('.', ','),
        };
        let read = |text: &str| {
            let point = if decimal == ',' { text.replacen(',', ".", 1) } else { text.to_owned() };
            point.parse::<f64>().ok().filter(|number| number.is_finite())
        };
        // a point where the comma is decimal and nothing is grouped: a number of a program beside those of a spreadsheet
        if let Some(number) = read(cell).filter(|_| !is_grouped(cell, between)) {
            return Some((number, false));
        }
        let mark = [between, '\'', '\u{2019}', '\u{a0}', '\u{202f}', ' ']
            .into_iter()
            .find(|mark| cell.contains(*mark))?;
        let (whole, _) = cell.split_once(decimal).unwrap_or((cell, ""));
        is_grouped(whole, mark).then(|| read(&cell.replace(mark, ""))).flatten().map(|number| (number, true))
    }
}

/// Whether a mark stands where thousands are marked: after one to three digits, the first no 0, and before three each time.
fn is_grouped(whole: &str, mark: char) -> bool {
    let mut groups = whole.trim_start_matches(['-', '+']).split(mark);
    let is_digits = |group: &str| group.bytes().all(|byte| byte.is_ascii_digit());
    let first = groups.next().unwrap_or_default();
    let begins = matches!(first.as_bytes(), [b'1'..=b'9'] | [b'1'..=b'9', _] | [b'1'..=b'9', _, _]);
    let mut rest = groups.peekable();
    let follows = |group: &str| matches!(group.as_bytes(), [_, _, _]) && is_digits(group);
    begins && is_digits(first) && rest.peek().is_some() && rest.all(follows)
}

/// Whether nothing was measured.
pub(super) fn is_missing(cell: &str) -> bool {
    cell.is_empty() || MISSING.contains(&cell.to_lowercase().as_str())
}

/// Whether a cell is a value, in whatever way it is written: a number or a time.
pub(super) fn is_value(cell: &str) -> bool {
    let number =
        || [Marks::Either, Marks::Point, Marks::Comma].iter().any(|marks| marks.number(cell).is_some());
    !is_missing(cell) && (number() || is_date(cell))
}

/// Whether a cell is a name or another word.
pub(super) fn is_word(cell: &str) -> bool {
    !is_missing(cell) && !is_value(cell)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(cells: &[&str], between_commas: bool) -> Vec<Option<f64>> {
        let marks = Marks::of(cells.iter().copied(), between_commas);
        cells.iter().map(|cell| marks.number(cell).map(|(number, _)| number)).collect()
    }

    #[test]
    fn value_numbers_of_spreadsheets() {
        for (cells, between_commas, numbers) in [
            (["1,5", "-2.5e3", "7"], false, [Some(1.5), Some(-2500.0), Some(7.0)]),
            (["0.5", "13,513.9", "24,854"], true, [Some(0.5), Some(13_513.9), Some(24_854.0)]),
            (["0.5", "-24,854", "1,234,567"], false, [Some(0.5), Some(-24_854.0), Some(1_234_567.0)]),
            (["0,5", "1.234,5", "24.854"], false, [Some(0.5), Some(1234.5), Some(24_854.0)]),
            (["0,5", "24,854", "12"], true, [Some(0.5), Some(24.854), Some(12.0)]),
            (["24,854", "1", "2"], true, [Some(24_854.0), Some(1.0), Some(2.0)]),
            (["24,854", "1", "2"], false, [Some(24.854), Some(1.0), Some(2.0)]),
            (["0.5", "13'513.9", "1\u{202f}234"], true, [Some(0.5), Some(13_513.9), Some(1234.0)]),
            // no thousands: a comma too early, a group too short; a decimal comma beside points
            (["0.5", "1,23", "1234,567.0"], true, [Some(0.5), None, None]),
            (["0.5", "0,5", "1.2.3"], true, [Some(0.5), None, None]),
        ] {
            assert_eq!(read(&cells, between_commas), numbers, "{cells:?}");
        }
    }

    #[test]
    fn value_words_for_yes_and_no() {
        let read = |cells: &[&str]| booleans(cells.iter().copied()).map(|all| format!("{all:?}"));
        for cells in [["on", "off", ""], ["ON", "Off", "N/A"], ["Yes", "no", "-"], ["true", "FALSE", "nan"]] {
            assert_eq!(read(&cells).as_deref(), Some("[1.0, 0.0, NaN]"), "{cells:?}");
        }
        // of two kinds, of another, and what means one thing at a valve and another at a switch
        for cells in
            [["on", "no", "off"], ["on", "off", "standby"], ["open", "closed", "open"], ["1", "off", ""]]
        {
            assert_eq!(read(&cells), None, "{cells:?}");
        }
        for word in BOOLEAN.concat() {
            assert!(BOOLEANS_READ.contains(word), "{word}");
        }
    }

    #[test]
    fn value_words_for_what_is_missing() {
        for cell in ["", "NaN", "N/A", "NA", "---", "null", "Inf", "-inf", "#N/A", "None"] {
            assert!(is_missing(cell) && !is_value(cell) && !is_word(cell), "{cell}");
        }
        for cell in ["off", "x", "Overload", "v2"] {
            assert!(is_word(cell) && !is_missing(cell), "{cell}");
        }
        for cell in ["0", "1e3", "0,5", "13,513.9", "10:00:00", "2026-03-28", "true"] {
            assert!(is_value(cell), "{cell}");
        }
    }
}
