//! The files of runs: each in the data set's folder, there, and each once.

use super::Run;
use orchestrator::nearest;
use orchestrator::plain::leaves;
use std::path::{Path, PathBuf};

/// Where a run's file lies. An error is what is wrong with its name.
pub(super) fn find(folder: &Path, name: &str) -> Result<PathBuf, String> {
    if leaves(Path::new(name)) {
        return Err(format!(
            "file = {name:?} leads out of the data set's folder, {}: copy the log there, or put a link to it there",
            folder.display()
        ));
    }
    let path = folder.join(name);
    match path.is_file() {
        true => Ok(path),
        false => {
            Err(format!("file = {name:?}: there is no such file in {}: {}", folder.display(), files(&path)))
        }
    }
}

/// What is wrong with a run that holds the same rows as one before.
pub(super) fn again(known: &[Run], run: &Run) -> Option<String> {
    let first = known.iter().find(|known| known.series == run.series)?;
    Some(format!(
        "file = {:?} holds the same rows as {:?} of line {}: counted twice they would tell more than they do. Take one of both out",
        run.name, first.name, first.line
    ))
}

/// CSV files that could be meant.
fn files(path: &Path) -> String {
    let listed = path.parent().and_then(|folder| std::fs::read_dir(folder).ok());
    let mut names: Vec<String> =
        listed.into_iter().flatten().flatten().map(|e| e.file_name().to_string_lossy().into()).collect();
    names.sort();
    let wanted = path.file_name().unwrap_or_default().to_string_lossy();
    match path.parent().filter(|folder| !folder.is_dir()) {
        Some(folder) => format!("there is no folder {}", folder.display()),
        None => nearest(&wanted, names.iter().map(String::as_str)),
    }
}

#[cfg(test)]
mod tests {
    use super::leaves;
    use std::path::Path;

    #[test]
    fn value_which_names_lead_out_of_the_folder() {
        for name in ["../a.csv", "/etc/passwd", "runs/../../a.csv", "..", "a/../../b/a.csv"] {
            assert!(leaves(Path::new(name)), "{name}");
        }
        for name in ["a.csv", "./a.csv", "runs/a.csv", "runs/../a.csv", "..a.csv"] {
            assert!(!leaves(Path::new(name)), "{name}");
        }
    }
}
