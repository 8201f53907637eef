//! Reads the signals that the page needs back from `results.csv`, thinned to what a screen can show, so that the
//! memory of a report does not grow with the length of the run.

use crate::error::Error;
use report::thin::Thinner;
use std::collections::BTreeMap;
use std::path::Path;

/// A line: a signal, and what is taken off it.
pub type Key = (String, Option<String>);

/// Lines over time, by name, and the rows at which an index changed.
pub struct Series {
    /// Thinned points of each signal or difference.
    pub lines: BTreeMap<Key, Vec<(f64, f64)>>,
    /// For each wanted index: the values of the watched signals in the first row that has it.
    pub at_index: BTreeMap<u64, Vec<f64>>,
}

/// What to read.
pub struct Wanted {
    /// Signals, or differences of two.
    pub lines: Vec<Key>,
    /// The index column, the wanted indices, and the signals to keep at those.
    pub watch: Option<(String, Vec<u64>, Vec<String>)>,
}

/// Reads the file once.
pub fn read(path: &Path, wanted: &Wanted) -> Result<Series, Error> {
    let refused = |why: String| Error::File { path: path.to_owned(), why };
    let mut reader = csv::Reader::from_path(path).map_err(|why| refused(why.to_string()))?;
    let head = reader.headers().map_err(|why| refused(why.to_string()))?.clone();
    let column = |name: &str| {
        let found = head.iter().position(|entry| entry == name);
        found.ok_or_else(|| refused(format!("no column `{name}`, which [report] shows; is it recorded?")))
    };
    let mut lines = Vec::new();
    for (signal, minus) in &wanted.lines {
        let minus_column = minus.as_deref().map(column).transpose()?;
        lines.push((column(signal)?, minus_column, Thinner::default()));
    }
    let watch = match &wanted.watch {
        Some((index, indices, signals)) => {
            let columns = signals.iter().map(|name| column(name)).collect::<Result<Vec<_>, _>>()?;
            Some((column(index)?, indices, columns))
        }
        None => None,
    };
    let mut at_index = BTreeMap::new();
    let mut record = csv::StringRecord::new();
    while reader.read_record(&mut record).map_err(|why| refused(why.to_string()))? {
        let value = |column: usize| number(record.get(column).unwrap_or_default());
        let time = value(0);
        for (signal, minus, thinner) in &mut lines {
            thinner.push(time, value(*signal) - minus.map_or(0.0, value));
        }
        if let Some((index, indices, columns)) = &watch {
            let index = value(*index);
            if index >= 0.0 && indices.contains(&(index as u64)) {
                at_index.entry(index as u64).or_insert_with(|| columns.iter().map(|c| value(*c)).collect());
            }
        }
    }
    let points = lines.into_iter().map(|(_, _, thinner)| thinner.finish());
    Ok(Series { lines: wanted.lines.iter().cloned().zip(points).collect(), at_index })
}

/// A cell as a number; Booleans count as 0 and 1, text not at all.
fn number(cell: &str) -> f64 {
    match cell {
        "true" => 1.0,
        "false" => 0.0,
        text => text.parse().unwrap_or(f64::NAN),
    }
}
