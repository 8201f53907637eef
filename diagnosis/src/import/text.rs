//! The text of a log as loggers and spreadsheets write it: its encoding, comments above it, and what stands between its cells.

use super::sheet::number;
use crate::error::Error;
use std::borrow::Cow;
use std::path::Path;

/// How comments begin.
const COMMENTS: [char; 2] = ['#', '%'];

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
    const ALL: [(Self, char); 3] = [(Self::Semicolon, ';'), (Self::Tab, '\t'), (Self::Comma, ',')];

    fn guess(line: &str) -> Option<Self> {
        let known = Self::ALL.into_iter().find(|(_, letter)| line.contains(*letter));
        let blanks = || line.split_whitespace().nth(1).map(|_| Self::Blanks);
        known.map(|(separator, _)| separator).or_else(blanks)
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

    fn cells(self, line: &str) -> Vec<&str> {
        match self {
            Self::Blanks => line.split_whitespace().collect(),
            other => line.split(char::from(other.byte())).map(str::trim).collect(),
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
}

impl Text {
    /// Finds the table in a file's bytes.
    pub(super) fn decode(bytes: &[u8], path: &Path) -> Result<Self, Error> {
        let wrong = |line: usize, problem: String| Error::Manifest { path: path.to_owned(), line, problem };
        let text = decoded(bytes).trim_start_matches('\u{feff}').replace("\r\n", "\n").replace('\r', "\n");
        let lines: Vec<&str> = text.lines().collect();
        let is_comment = |line: &str| line.trim().is_empty() || line.trim_start().starts_with(COMMENTS);
        let first = lines.iter().position(|line| !is_comment(line));
        let Some(first) = first else { return Err(wrong(1, "no table in it".into())) };
        if let Some((line, problem)) = not_text(&lines[..=first]) {
            return Err(wrong(line, problem));
        }
        let Some(separator) = Separator::guess(lines[first]) else {
            return Err(wrong(
                first + 1,
                "one column only: wanted is a line of names, separated by commas".into(),
            ));
        };
        let is_number = |cell: &&str| number(cell, separator != Separator::Comma).is_some();
        let cells = separator.cells(lines[first]);
        // the names may stand in the last comment
        let named = cells.iter().all(|cell| is_number(cell) || cell.is_empty());
        let head = if named { first.checked_sub(1) } else { Some(first) };
        let head = head.map(|at| (at, lines[at].trim_start().trim_start_matches(COMMENTS)));
        let head = head.filter(|(at, text)| *at == first || separator.cells(text).len() == cells.len());
        let Some((head, names)) = head else {
            return Err(wrong(
                first + 1,
                format!(
                    "numbers where the names of columns belong: put a line above it with a name for each of the {} columns, best those of \
                 the unit's variables, and one called time",
                    cells.len()
                ),
            ));
        };
        if separator == Separator::Blanks {
            let names = separator.cells(names).len();
            let row = |at: &usize| !is_comment(lines[*at]) && separator.cells(lines[*at]).len() != names;
            if let Some(row) = (head + 1..lines.len()).find(row) {
                let problem = format!(
                    "{} cells below {names} names: blanks don't say which is missing, and a name can have none; commas between columns would do",
                    separator.cells(lines[row]).len()
                );
                return Err(wrong(row + 1, problem));
            }
        }
        // an empty line keeps the numbers of those below
        let body = lines[head + 1..].iter().map(|line| if is_comment(line) { "" } else { line });
        let lines: Vec<Cow<'_, str>> =
            [names].into_iter().chain(body).map(|line| separator.joined(line)).collect();
        Ok(Self { separator, table: lines.join("\n"), above: head })
    }
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
