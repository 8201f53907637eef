//! The text of a log: CSV in UTF-8, with commas.

use crate::error::Error;
use std::path::Path;

/// The text of a file of plain CSV, without the mark of its encoding.
///
/// # Errors
/// It can't be read, or is written otherwise; `otherwise` says what helps.
pub fn read(path: &Path, otherwise: &str) -> Result<String, Error> {
    let bytes =
        orchestrator::plain::read(path).map_err(|source| Error::Io { path: path.to_owned(), source })?;
    let wrong = |line: usize, problem: String| Error::Manifest { path: path.to_owned(), line, problem };
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err(wrong(1, "the file is in UTF-16; save it as CSV in UTF-8".into()));
    }
    let text = String::from_utf8(bytes).map_err(|error| {
        let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = 1 + valid.iter().filter(|b| **b == b'\n').count();
        wrong(line, "not UTF-8; save the file as CSV in UTF-8".into())
    })?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text).replace("\r\n", "\n");
    let head = text.lines().next().unwrap_or("");
    let separator = [(';', "semicolons"), ('\t', "tabs")].into_iter().find(|(sign, _)| head.contains(*sign));
    if let Some((_, separators)) = separator.filter(|_| !head.contains(',')) {
        let wanted = "wanted are commas between columns and points in numbers";
        return Err(wrong(1, format!("columns are separated by {separators}; {wanted}{otherwise}")));
    }
    Ok(text)
}
