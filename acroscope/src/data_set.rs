//! The folder of a data set: measured data are never lost in silence.

use crate::error::Error;
use std::path::{Path, PathBuf};

/// Measured data are no results: they can't be made again. Refuses a folder that holds a data set, unless it may be replaced. What it
/// holds: its `dataset.toml` and the logs of its runs.
pub fn data_set(out: &Path, force: bool) -> Result<Vec<PathBuf>, Error> {
    let mut there: Vec<PathBuf> = Vec::new();
    for entry in std::fs::read_dir(out).into_iter().flatten().flatten() {
        let (path, name) = (entry.path(), entry.file_name().to_string_lossy().into_owned());
        if name == "dataset.toml" || name.starts_with("run-") && name.ends_with(".csv") {
            there.push(path);
        } else if name.starts_with("run-") {
            there.extend(LOGS.map(|log| path.join(log)).into_iter().filter(|path| path.exists()));
        }
    }
    there.sort();
    match there.first() {
        Some(path) if !force => Err(Error::There { path: path.clone() }),
        _ => Ok(there),
    }
}

/// The files that a data set names, under whatever key: its model, its logs. One that can't be read names none; the diagnosis says why.
pub fn files_of(folder: &Path) -> Vec<PathBuf> {
    let text = orchestrator::plain::read_text(&folder.join("dataset.toml")).unwrap_or_default();
    let table: toml::Table = text.parse().unwrap_or_default();
    let mut all = Vec::new();
    texts(&toml::Value::Table(table), &mut |text| all.push(folder.join(text)));
    all
}

fn texts(value: &toml::Value, found: &mut impl FnMut(&str)) {
    match value {
        toml::Value::String(text) => found(text),
        toml::Value::Array(list) => list.iter().for_each(|value| texts(value, found)),
        toml::Value::Table(table) => table.iter().for_each(|(_, value)| texts(value, found)),
        _ => {}
    }
}

/// Logs of a run of our own rig.
const LOGS: [&str; 3] = ["camera.csv", "controller.csv", "plant.csv"];

#[cfg(test)]
mod tests {
    use super::data_set;

    #[test]
    fn law_a_data_set_is_replaced_only_when_that_is_asked_for() {
        let root = tempfile::tempdir().expect("a temporary folder");
        for (name, file) in [("a", "dataset.toml"), ("b", "run-03.csv"), ("c", "run-01/camera.csv")] {
            let out = root.path().join(name);
            data_set(&out, false).expect("nothing is there");
            let path = out.join(file);
            std::fs::create_dir_all(path.parent().expect("in a folder")).expect("made");
            std::fs::write(out.join("heater.fmu"), "").expect("written");
            data_set(&out, false).expect("a unit alone is no data set");
            std::fs::write(&path, "measured").expect("written");
            let said = data_set(&out, false).expect_err("a data set is there").to_string();
            assert!(said.contains(file) && said.contains("--force") && path.exists(), "{said}");
            assert_eq!(data_set(&out, true).expect("asked for"), [path]);
        }
    }
}
