//! Where the table of a log begins and ends: below what a device writes of itself, above what a program sums up.

use super::cells::{is_value, is_word};
use super::text::{COMMENTS, Separator};
use super::times::TIME_NAMES;
use crate::observe::measure;

/// A line of a log, cut into cells.
pub(super) struct Line {
    /// Its number in the file, counted from 0.
    at: usize,
    /// Cells up to the last that is not empty.
    cells: usize,
    /// With those behind it.
    width: usize,
    values: usize,
    words: usize,
    /// The first cell is a word.
    begins_with_a_word: bool,
    /// Units of measurement may stand in it: one that is known or in brackets, and no name of a column of time.
    may_be_units: bool,
}

impl Line {
    fn is_names(&self) -> bool {
        self.values == 0 && self.words > 0 && self.cells > 1
    }

    fn is_row(&self) -> bool {
        self.values > 0 && self.cells > 1
    }

    /// More values than words.
    fn is_plain_row(&self) -> bool {
        self.is_row() && self.values > self.words
    }
}

/// Where a table stands among the lines of a file, counted from 0.
#[derive(Debug, PartialEq)]
pub(super) struct Table {
    /// The line of names.
    pub(super) head: usize,
    /// The line after its last.
    pub(super) end: usize,
    /// Lines that are no comments stand above it.
    pub(super) is_below: bool,
}

/// Whether nothing of the table stands in a line.
pub(super) fn is_comment(line: &str) -> bool {
    line.trim().is_empty() || line.trim_start().starts_with(COMMENTS)
}

/// The cells of a line without the quotes around them; a separator within quotes is none.
pub(super) fn cells(line: &str, separator: Separator) -> Vec<&str> {
    if separator == Separator::Blanks {
        return line.split_whitespace().collect();
    }
    let mut quoted = false;
    let byte = char::from(separator.byte());
    let parts = line.split(|letter: char| {
        quoted ^= letter == '"';
        letter == byte && !quoted
    });
    parts.map(|cell| cell.trim().trim_matches('"').trim()).collect()
}

/// What most likely stands between the cells of these lines: what leaves the most values.
pub(super) fn separator(lines: &[&str]) -> Option<Separator> {
    let share = |line: &&&str, separator: Separator| {
        let cells = cells(line, separator);
        let values = cells.iter().filter(|cell| is_value(cell)).count();
        let all = cells.iter().filter(|cell| !cell.is_empty()).count();
        if cells.len() > 1 { values as f64 / all.max(1) as f64 } else { 0.0 }
    };
    let worth = |separator: Separator| -> f64 {
        lines.iter().filter(|line| !is_comment(line)).map(|line| share(&line, separator)).sum()
    };
    let mut best = (0.0, None);
    for separator in Separator::ALL {
        let worth = worth(separator);
        if worth > best.0 {
            best = (worth, Some(separator));
        }
    }
    best.1
}

/// Whether a line may be one of units of measurement, by its cells.
fn may_be_units(cells: &[&str]) -> bool {
    let is_unit =
        |cell: &&str| cell.starts_with(['[', '(']) || is_word(cell) && measure::named(cell).is_some();
    cells.iter().any(is_unit) && !cells.iter().any(|cell| TIME_NAMES.contains(&cell.to_lowercase().as_str()))
}

/// The lines that are no comments.
pub(super) fn cut(lines: &[&str], separator: Separator) -> Vec<Line> {
    let line = |(at, text): (usize, &&str)| {
        let all = cells(text, separator);
        Line {
            at,
            cells: all.iter().rposition(|cell| !cell.is_empty()).map_or(0, |last| last + 1),
            width: all.len(),
            values: all.iter().filter(|cell| is_value(cell)).count(),
            words: all.iter().filter(|cell| is_word(cell)).count(),
            begins_with_a_word: all.first().is_some_and(|cell| is_word(cell)),
            may_be_units: may_be_units(&all),
        }
    };
    lines.iter().enumerate().filter(|(_, text)| !is_comment(text)).map(line).collect()
}

/// How many cells most rows have, and most of these with the empty ones behind them.
fn usual(lines: &[Line]) -> (usize, usize) {
    let most = |counted: &mut dyn Iterator<Item = usize>| {
        let mut counts = std::collections::BTreeMap::<usize, usize>::new();
        counted.for_each(|cells| *counts.entry(cells).or_default() += 1);
        counts.into_iter().max_by_key(|(_, count)| *count).map_or(0, |(cells, _)| cells)
    };
    let rows = || lines.iter().filter(|line| line.is_row());
    let cells = most(&mut rows().map(|line| line.cells));
    (cells, most(&mut rows().filter(|line| line.cells == cells).map(|line| line.width)))
}

/// Finds the table: below the first line of as many names as most rows have cells that a row follows, a line of units between them or not; else
/// below the first such of a name more for each cell that is empty at their ends (a column of remarks that nobody made); else
/// below the first line, if that may be one of names. An error is the line in which it seems to begin.
pub(super) fn find(lines: &[Line]) -> Result<Table, usize> {
    let (usual, width) = usual(lines);
    let is_followed = |place: usize| {
        let is_row = |at: usize| lines.get(at).is_some_and(Line::is_row);
        is_row(place + 1)
            || lines.get(place + 1).is_some_and(|line| line.is_names() && line.may_be_units)
                && is_row(place + 2)
    };
    let head_of = |cells: usize| {
        let is_head = |line: &Line| line.is_names() && line.cells == cells;
        (0..lines.len()).find(|place| is_head(&lines[*place]) && is_followed(*place))
    };
    // a row of the same table above it: words among rows
    let is_clear =
        |place: &usize| !lines[..*place].iter().any(|line| line.is_plain_row() && line.cells == usual);
    let found = match (head_of(usual), head_of(width)) {
        // units of all but the last
        (Some(units), Some(head)) if head + 1 == units && lines[units].may_be_units => Some(head),
        (head, longer) => head.or(longer),
    };
    let found = found.filter(is_clear);
    let first_row = || lines.iter().find(|line| line.is_plain_row() && line.cells == usual);
    let place = match found {
        Some(place) => place,
        None if lines.iter().any(Line::is_row) && !lines[0].is_row() && !is_followed(0) => {
            return Err(first_row().map_or(0, |line| line.at));
        }
        None => 0,
    };
    let rows = &lines[place..];
    // what begins with a word below rows that begin with none
    let below = rows.iter().rev().take_while(|line| line.begins_with_a_word).count();
    let body = &rows[..rows.len() - below];
    let mut numbers = body.iter().filter(|line| line.is_row()).peekable();
    let is_summed_up = numbers.peek().is_some() && numbers.all(|line| !line.begins_with_a_word);
    let last = if is_summed_up { body.last() } else { rows.last() };
    Ok(Table {
        head: lines[place].at,
        end: last.map_or(lines[place].at, |line| line.at) + 1,
        is_below: place > 0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str) -> (Option<Separator>, Result<Table, usize>) {
        let lines: Vec<&str> = text.lines().collect();
        let separator = separator(&lines);
        (separator, find(&cut(&lines, separator.unwrap_or(Separator::Comma))))
    }

    #[test]
    fn value_what_stands_between_cells() {
        for (text, separator) in [
            ("Device: DAQ-7; serial 12\nt,u\n0.1,2.0\n0.2,3.0", Some(Separator::Comma)),
            ("t;u\n0,1;2,0\n0,2;3,0", Some(Separator::Semicolon)),
            ("t u w\n0,1   2,5  1\n0,2 2 3", Some(Separator::Blanks)),
            ("t,u,note\n0.1,2.0,\"a; b\"\n", Some(Separator::Comma)),
            ("time,x\n2026-03-28 23:59:55,1.0\n", Some(Separator::Comma)),
            ("t\tu\n0.1\t2\n", Some(Separator::Tab)),
            ("u\n1\n2", None),
        ] {
            assert_eq!(found(text).0, separator, "{text}");
        }
    }

    #[test]
    fn value_where_a_table_begins_and_ends() {
        let table = |head, end, is_below| Ok(Table { head, end, is_below });
        for (text, wanted) in [
            ("t,u\n0,1\n1,2", table(0, 3, false)),
            ("Operator,\"Smith, J.\"\nRate,100,Hz\n\nt,u,w\n0,1,2\n1,2,3\n\nEnd of file", table(3, 6, true)),
            ("Rate,100\nGain,2\nt,u\n0,1\n1,2\nMean,1.5", table(2, 5, true)),
            ("Rig 7,bench\nt,u\n0,1\n1,2", table(1, 4, true)),
            ("time,F,x\ns,lbs,furlongs\n0,1,2\n1,2,3", table(0, 4, false)),
            ("Rig 7,,\nt,u,w\ns,V,-\n0,1,2\n1,2,3\n", table(1, 5, true)),
            // a name with nothing below it, under a device's own line
            ("Device 7\nt,u,Comment\n0,1,\n1,2,", table(1, 4, true)),
            ("LabVIEW\nVersion\t2\n\nt,u,x,y\ns,V,,\n0,1,,\n1,2,,\n2,1,,late", table(3, 8, true)),
            ("Rate,Hz,x\nGain,2,x\nt,u\n0,1,\n1,2,", table(2, 5, true)),
            // a name with nothing below, rows with a cell too many, names that are numbers: the first line, as always
            ("t,u,w\n0,1,\n1,2,", table(0, 3, false)),
            ("t,u\n0,1,\n1,2,7", table(0, 3, false)),
            ("t,1,2\n0,1,2\n1,2,3", table(0, 3, false)),
            // words among rows, and rows that begin with words
            ("t,u\n0,1\noff,on\n1,2", table(0, 4, false)),
            ("mode,t\nrest,0\nrest,1\nrun,2", table(0, 4, false)),
        ] {
            assert_eq!(found(text).1, wanted, "{text}");
        }
        assert_eq!(found("Rig 7,bench\nDate,today\nof,him\n0,1\n1,2").1, table(2, 5, true));
        assert_eq!(found("Rig 7,bench,a\nDate,today,b\nof,him,c\n0,1\n1,2").1, Err(3));
    }
}
