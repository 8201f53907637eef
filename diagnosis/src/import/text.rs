//! The text of a log as loggers and spreadsheets write it: its encoding, comments above it, and what stands between its cells.

use super::cells::is_value;
use super::table::{self, Table, cells, is_comment};
use crate::error::Error;
use std::borrow::Cow;
use std::path::Path;

/// How comments begin.
pub(super) const COMMENTS: [char; 2] = ['#', '%'];

/// What separates cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Separator {
    Comma,
    Semicolon,
    Tab,
    /// One or several.
    Blanks,
}

impl Separator {
    /// The likelier before others that leave as many values.
    pub(super) const ALL: [Self; 4] = [Self::Semicolon, Self::Tab, Self::Comma, Self::Blanks];

    /// Of names alone.
    fn of_names(line: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|separator| cells(line, *separator).len() > 1)
    }

    /// What Excel writes above a table: `sep=;`.
    fn stated(line: &str) -> Option<Self> {
        let stated = line.trim().trim_matches('"').strip_prefix("sep=")?;
        Self::ALL.into_iter().find(|separator| stated.bytes().eq([separator.byte()]))
    }

    /// In words; commas need none.
    pub(super) fn in_words(self) -> Option<&'static str> {
        match self {
            Self::Comma => None,
            Self::Semicolon => Some("semicolons"),
            Self::Tab => Some("tabs"),
            Self::Blanks => Some("blanks"),
        }
    }

    /// Byte between cells of [`Text::table`].
    pub(super) fn byte(self) -> u8 {
        match self {
            Self::Comma => b',',
            Self::Semicolon => b';',
            Self::Tab | Self::Blanks => b'\t',
        }
    }

    /// A line with one byte between its cells.
    fn joined(self, line: &str) -> Cow<'_, str> {
        match self {
            Self::Blanks => Cow::Owned(line.split_whitespace().collect::<Vec<_>>().join("\t")),
            _ => Cow::Borrowed(line),
        }
    }
}

/// A table in a text.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Text {
    pub(super) separator: Separator,
    /// From the line of names on.
    pub(super) table: String,
    /// Lines above the table.
    pub(super) above: usize,
    /// What was left out above and below, told.
    pub(super) left_out: Vec<String>,
}

impl Text {
    /// Finds the table in a file's bytes.
    pub(super) fn decode(bytes: &[u8], path: &Path) -> Result<Self, Error> {
        let wrong = |line: usize, problem: String| Error::Manifest { path: path.to_owned(), line, problem };
        let text = decoded(bytes).trim_start_matches('\u{feff}').replace("\r\n", "\n").replace('\r', "\n");
        let mut lines: Vec<&str> = text.lines().collect();
        let stated = lines.first().and_then(|line| Separator::stated(line));
        if stated.is_some() {
            lines[0] = "";
        }
        let first = lines.iter().position(|line| !is_comment(line));
        let Some(first) = first else { return Err(wrong(1, "no table in it".into())) };
        if let Some((line, problem)) = not_text(&lines[..=first]) {
            return Err(wrong(line, problem));
        }
        let guessed = || table::separator(&lines).or_else(|| Separator::of_names(lines[first]));
        let Some(separator) = stated.or_else(guessed) else {
            return Err(wrong(
                first + 1,
                "one column only: wanted is a line of names, separated by commas".into(),
            ));
        };
        let found = table::find(&table::cut(&lines, separator)).map_err(|line| {
            let problem = "a table seems to begin here, and no line of as many names stands above it: put one there, with a name for each column, and \
                 take out what else stands above";
            wrong(line + 1, problem.into())
        })?;
        let (head, names) =
            names(&lines, &found, separator).map_err(|problem| wrong(found.head + 1, problem))?;
        if separator == Separator::Blanks {
            check_blanks(&lines[head..found.end], names)
                .map_err(|(line, problem)| wrong(head + line, problem))?;
        }
        let left_out = left_out(&lines, first, &found);
        // an empty line keeps the numbers of those below
        let body = lines[head + 1..found.end].iter().map(|line| if is_comment(line) { "" } else { line });
        let lines: Vec<Cow<'_, str>> =
            [names].into_iter().chain(body).map(|line| separator.joined(line)).collect();
        Ok(Self { separator, table: lines.join("\n"), above: head, left_out })
    }
}

/// The line of names of a table and its place: its first, or the comment above numbers.
fn names<'a>(lines: &[&'a str], found: &Table, separator: Separator) -> Result<(usize, &'a str), String> {
    let first = cells(lines[found.head], separator);
    let named = !first.iter().all(|cell| is_value(cell) || cell.is_empty());
    let head = if named { Some(found.head) } else { found.head.checked_sub(1) };
    let head = head.map(|at| (at, lines[at].trim_start().trim_start_matches(COMMENTS)));
    head.filter(|(at, text)| *at == found.head || cells(text, separator).len() == first.len()).ok_or_else(|| {
        format!(
            "numbers where the names of columns belong: put a line above it with a name for each of the {} columns, best those of \
             the unit's variables, and one called time",
            first.len()
        )
    })
}

/// Whether all rows of a table with blanks between cells have as many as there are names; an error has the place of one, counted from 1.
fn check_blanks(lines: &[&str], names: &str) -> Result<(), (usize, String)> {
    let count = |line: &str| line.split_whitespace().count();
    let names = count(names);
    let is_ragged = |line: &&&str| !is_comment(line) && count(line) != names;
    let Some(at) = lines.iter().skip(1).position(|line| is_ragged(&line)) else { return Ok(()) };
    let problem = format!(
        "{} cells below {names} names: blanks don't say which is missing, and a name can have none; commas between columns would do",
        count(lines[at + 1])
    );
    Err((at + 2, problem))
}

/// What stands above a table and below it that is no comment, told.
fn left_out(lines: &[&str], first: usize, found: &Table) -> Vec<String> {
    let above = found.is_below.then(|| match (first + 1, found.head) {
        (one, last) if one == last => format!("line {one} stands above the table and is left out"),
        (one, last) => format!("lines {one} to {last} stand above the table and are left out"),
    });
    let below = lines.iter().enumerate().skip(found.end).find(|(_, line)| !is_comment(line));
    let below = below.map(|(at, line)| {
        format!("from line {} on ({:?}) no rows stand below the table: left out", at + 1, line.trim())
    });
    above.into_iter().chain(below).collect()
}

/// Line of the first character that no text holds, and what is wrong: those that control a terminal, but for tabs and new pages.
fn not_text(lines: &[&str]) -> Option<(usize, String)> {
    let is_foreign = |letter: &char| letter.is_ascii_control() && !['\t', '\u{c}'].contains(letter);
    let (line, code) = lines
        .iter()
        .enumerate()
        .find_map(|(line, text)| Some((line + 1, u32::from(text.chars().find(is_foreign)?))))?;
    let problem = format!(
        "no text: there is a character {code:#04x} in it. Wanted is a table as CSV, with a line of names and commas between columns"
    );
    Some((line, problem))
}

/// UTF-16 where it says so, else UTF-8, else Latin-1: spreadsheets still write it, and a degree sign is one byte there.
fn decoded(bytes: &[u8]) -> Cow<'_, str> {
    let wide = |read: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = bytes.as_chunks().0.iter().map(|pair| read(*pair)).collect();
        Cow::Owned(String::from_utf16_lossy(&units))
    };
    match bytes {
        [0xff, 0xfe, ..] => wide(u16::from_le_bytes),
        [0xfe, 0xff, ..] => wide(u16::from_be_bytes),
        _ => match std::str::from_utf8(bytes) {
            Ok(text) => Cow::Borrowed(text),
            Err(_) => Cow::Owned(bytes.iter().map(|byte| char::from(*byte)).collect()),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<(Separator, String, usize), String> {
        let found = Text::decode(text.as_bytes(), Path::new("log.txt")).map_err(|error| error.to_string())?;
        Ok((found.separator, found.table, found.above))
    }

    #[test]
    fn value_blanks_separate_cells() {
        let table = "t\tu\tphi\n0.0\t1\t2\n0.1\t1\t-2e-3".to_owned();
        assert_eq!(read("t   u  phi\n 0.0 1  2\n0.1    1 -2e-3\n"), Ok((Separator::Blanks, table, 0)));
        let told = read("t motor speed\n0.0 1\n0.1 2\n").unwrap_err();
        assert!(told.contains("line 2") || told.contains(":2"), "{told}");
        assert!(told.contains("2 cells below 3 names"), "{told}");
        let ragged = read("t u w\n0.0 1 2\n\n0.1 1\n0.2 1 2\n").unwrap_err();
        assert!(ragged.contains(":4: 2 cells below 3 names"), "{ragged}");
        let line = read("t u w\n\n0.0 1 2\n0.1 1 2 3\n0.2 1 2\n").unwrap_err();
        assert!(line.contains(":4: 4 cells below 3 names"), "{line}");
    }

    #[test]
    fn value_names_may_stand_in_the_last_comment() {
        let table = "t,u\n0,1\n\n1,2".to_owned();
        assert_eq!(
            read("% rig 7\n\n# t,u\n0,1\n# paused\n1,2\n"),
            Ok((Separator::Comma, table.replacen("t,u", " t,u", 1), 2))
        );
        assert_eq!(read("# rig 7\nt,u\n0,1\n\n1,2\n"), Ok((Separator::Comma, table, 1)));
    }

    #[test]
    fn value_a_table_below_what_a_device_writes_and_above_a_summary() {
        let text = "Device: DAQ-7; serial 12\nOperator,\"Smith, J.\"\nRate,100,Hz\n\nt,u,w\n0,1,2\n1,2,3\nMean,1.5,2.5\n";
        assert_eq!(read(text), Ok((Separator::Comma, "t,u,w\n0,1,2\n1,2,3".into(), 4)));
        let found = Text::decode(text.as_bytes(), Path::new("log.csv")).expect("a table");
        let told = found.left_out.join("; ");
        assert!(
            told.contains("lines 1 to 4 stand above") && told.contains("from line 8 on (\"Mean,1.5,2.5\")"),
            "{told}"
        );
        let labview = "Device 7\nX_Value,u,Comment\n0,1,\n1,2,\n";
        assert_eq!(read(labview), Ok((Separator::Comma, "X_Value,u,Comment\n0,1,\n1,2,".into(), 1)));
        let found = Text::decode(labview.as_bytes(), Path::new("log.csv")).expect("a table");
        assert_eq!(found.left_out, ["line 1 stands above the table and is left out"]);
        assert_eq!(read("sep=;\nt;u\n0,5;1\n1;2\n"), Ok((Separator::Semicolon, "t;u\n0,5;1\n1;2".into(), 1)));
        let unclear = read("Rig 7,bench,a\n\nof,him,c\n0,1\n1,2\n").unwrap_err();
        assert!(unclear.contains("log.txt:4: a table seems to begin here"), "{unclear}");
    }

    #[test]
    fn error_without_names() {
        for text in ["0,1\n1,2\n", "# rig 7\n0,1\n1,2\n", "0;1,5\n1;2,5\n", "0 1\n1 2"] {
            let told = read(text).unwrap_err();
            assert!(told.contains("numbers where the names of columns belong"), "{told}");
            assert!(told.contains("each of the 2 columns"), "{told}");
        }
        assert!(read("# nothing\n\n").unwrap_err().contains("no table"));
        assert!(read("u\n1\n2\n").unwrap_err().contains("one column only"));
    }

    #[test]
    fn error_of_bytes_that_are_no_text() {
        // the first 16 of a file of random ones, and a page of a program
        for bytes in
            [&b"\x12\xe7\x1b\xe0\x39\xb3\xfc\x6e\xb8\x17\xd1\x8c\x19\xf5\x61\xe3"[..], b"\x7fELF,1\0"]
        {
            let told = Text::decode(bytes, Path::new("log.csv")).expect_err("no text").to_string();
            assert!(
                told.contains(":1: no text: there is a character 0x") && told.contains("as CSV"),
                "{told}"
            );
        }
        assert!(read("\u{c}t\tT\n0\t1\n").is_ok());
    }

    #[test]
    fn value_encodings() {
        let text = "t,T [\u{b0}C]\n0,1\n";
        let latin: Vec<u8> = text.chars().map(|letter| letter as u8).collect();
        let wide: Vec<u8> =
            "\u{feff}".encode_utf16().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect();
        for bytes in [text.as_bytes().to_vec(), latin, wide] {
            let found = Text::decode(&bytes, Path::new("log.csv")).expect("a table");
            assert_eq!(found.table.lines().next(), Some("t,T [\u{b0}C]"));
        }
    }
}
