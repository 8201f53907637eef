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
    let names =
        csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(head.as_bytes()).headers().cloned();
    match names.ok().and_then(|names| named_twice(names.iter())) {
        Some(problem) => Err(wrong(1, problem)),
        None => Ok(text),
    }
}

/// What is wrong with the names of a log's columns where two have one name: nobody knows which is meant. Columns without a name are nobody's.
pub(crate) fn named_twice<'a>(names: impl Iterator<Item = &'a str>) -> Option<String> {
    let mut known: Vec<&str> = Vec::new();
    for name in names {
        if let Some(first) = known.iter().position(|known| !name.is_empty() && *known == name) {
            return Some(format!(
                "columns {} and {} are both called {name:?}, and nobody knows which is meant: one of that name. Call the other something \
                 else, or take it out",
                first + 1,
                known.len() + 1
            ));
        }
        known.push(name);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::named_twice;

    #[test]
    fn value_which_columns_have_one_name() {
        let told = named_twice(["t", "i [mA]", "", "u", "i [mA]", ""].into_iter()).expect("two of them");
        assert!(told.starts_with("columns 2 and 5 are both called \"i [mA]\""), "{told}");
        assert_eq!(named_twice(["t", "i", "I", "", ""].into_iter()), None);
    }
}
