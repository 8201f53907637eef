//! Where the keys of a `dataset.toml` stand, for errors that are found after the file was read.

use std::path::Path;
use toml::de::{DeTable, DeValue};

/// Line of a key, by the names of its tables and its own, joined by dots as `[set]` joins them: `set.plant.q1_0`. Of what isn't
/// there the line of its table, or the first.
pub(crate) fn line_of(path: &Path, name: &str) -> usize {
    let text = orchestrator::plain::read_text(path).unwrap_or_default();
    line_in(&text, name)
}

fn line_in(text: &str, name: &str) -> usize {
    let Ok(root) = DeTable::parse(text) else { return 1 };
    let at = place(root.get_ref(), name).or_else(|| table_of(root.get_ref(), name)).unwrap_or(0);
    line(text, at)
}

/// Where a key begins.
fn place(table: &DeTable<'_>, name: &str) -> Option<usize> {
    table.iter().find_map(|(key, value)| {
        let rest = name.strip_prefix(key.get_ref().as_ref())?;
        match (rest.strip_prefix('.'), value.get_ref()) {
            (None, _) => rest.is_empty().then(|| key.span().start),
            (Some(rest), DeValue::Table(inner)) => place(inner, rest),
            (Some(_), _) => None,
        }
    })
}

/// Where the table begins that would hold a key.
fn table_of(table: &DeTable<'_>, name: &str) -> Option<usize> {
    table.iter().find_map(|(key, value)| {
        let rest = name.strip_prefix(key.get_ref().as_ref())?.strip_prefix('.')?;
        let DeValue::Table(inner) = value.get_ref() else { return None };
        table_of(inner, rest).or(Some(key.span().start))
    })
}

/// The keys of `[[run]]`s that are none of some, each with its line.
pub(super) fn strange_keys(text: &str, known: &[&str]) -> Vec<(usize, String)> {
    let Ok(root) = DeTable::parse(text) else { return Vec::new() };
    let runs = root.get_ref().get("run").and_then(|runs| runs.get_ref().as_array());
    let runs = runs.into_iter().flat_map(|runs| runs.iter());
    let keys = runs.filter_map(|run| run.get_ref().as_table()).flat_map(|run| run.iter());
    let strange = keys.map(|(key, _)| key).filter(|key| !known.contains(&key.get_ref().as_ref()));
    strange.map(|key| (line(text, key.span().start), key.get_ref().to_string())).collect()
}

fn line(text: &str, at: usize) -> usize {
    1 + text.as_bytes()[..at.min(text.len())].iter().filter(|byte| **byte == b'\n').count()
}

#[cfg(test)]
mod tests {
    use super::{line_in, strange_keys};

    #[test]
    fn value_every_way_to_write_a_name_has_its_line() {
        let text =
            "format = 1\nscenario = \"a\"\n[set]\n\"plant.q1\" = 1\nplant.q2 = 2\n[set.camera]\nk1 = 3\n";
        let lines =
            ["scenario", "set.plant.q1", "set.plant.q2", "set.camera.k1", "set.controller.c", "nothing"];
        assert_eq!(lines.map(|name| line_in(text, name)), [2, 4, 5, 7, 3, 1]);
    }

    #[test]
    fn value_keys_of_runs_that_are_none() {
        let text = "format = 1\n[[run]]\ndir = \"a\"\n[[run]]\ndir = \"b\"\nstrat = 3\n";
        assert_eq!(strange_keys(text, &["dir"]), [(6, "strat".to_owned())]);
        assert_eq!(strange_keys(text, &["dir", "strat"]), []);
    }
}
