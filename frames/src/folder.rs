//! The data set: `camera.csv` in the folder of each run, and a `dataset.toml` where there is none.

use crate::error::{Error, file};
use crate::{Recording, Stamp};
use orchestrator::plain::{leaves, write_whole};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

const MANIFEST: &str = "dataset.toml";

/// First line of `camera.csv`. `t_mid` is known only where times are those of the shutter.
pub fn head(stamp: Stamp) -> String {
    let middle = if stamp == Stamp::Delivered { "" } else { ",t_mid" };
    format!("time,frame{middle},q1_est,q2_est,u1,v1,u2,v2,u3,v3,area1,area2,area3,valid\n")
}

/// The name of the log, and of one that was there before the first import: what was measured is not lost.
const LOG: &str = "camera.csv";
const BEFORE: &str = "camera.csv.before";

/// Where the runs lie.
pub struct Runs {
    /// A folder each.
    pub folders: Vec<PathBuf>,
    /// There is a manifest that names them.
    pub listed: bool,
}

/// Folders of the runs: those of a data set that is there, in its order, or new ones.
pub fn runs(out: &Path, count: usize) -> Result<Runs, Error> {
    let listed = listed(out, count)?;
    let new = || (0..count).map(|run| out.join(name(run))).collect();
    Ok(Runs { listed: listed.is_some(), folders: listed.unwrap_or_else(new) })
}

fn name(run: usize) -> String {
    format!("run-{:02}", run + 1)
}

/// The folders that a manifest names.
fn listed(out: &Path, count: usize) -> Result<Option<Vec<PathBuf>>, Error> {
    let path = out.join(MANIFEST);
    if !path.exists() {
        return Ok(None);
    }
    let wrong = |what: String| Error::DataSet { path: path.clone(), what };
    let text = std::fs::read_to_string(&path).map_err(file(&path))?;
    let table: toml::Table = text.parse().map_err(|error: toml::de::Error| wrong(error.to_string()))?;
    if table.get("format").and_then(toml::Value::as_integer) != Some(1) {
        return Err(wrong(
            "frames belong to a data set of format = 1 (docs/data-set.md); give another --out".into(),
        ));
    }
    let runs = table.get("run").and_then(toml::Value::as_array).into_iter().flatten();
    let dir = |(place, run): (usize, &toml::Value)| {
        let dir = run.get("dir").and_then(toml::Value::as_str);
        let dir = dir.ok_or_else(|| wrong(format!("[[run]] {} has no dir, a text", place + 1)))?;
        if leaves(Path::new(dir)) {
            return Err(wrong(format!(
                "dir = {dir:?} leads out of {}: nothing is written there",
                out.display()
            )));
        }
        Ok(out.join(dir))
    };
    let dirs: Vec<PathBuf> = runs.enumerate().map(dir).collect::<Result<_, _>>()?;
    if dirs.len() < count {
        return Err(wrong(format!(
            "{} runs, and {count} folders of frames; expected a [[run]] for each",
            dirs.len()
        )));
    }
    Ok(Some(dirs))
}

/// Writes the logs, and the manifest if there is none; gives the files that were written.
pub fn write(
    out: &Path,
    recording: &Recording,
    runs: &Runs,
    texts: &[String],
    notices: &mut Vec<String>,
) -> Result<Vec<PathBuf>, Error> {
    let mut written = logs(runs, texts, notices)?;
    let path = out.join(MANIFEST);
    if runs.listed {
        if !recording.set.is_empty() {
            notices.push(format!(
                "{} is left as it was: what --set changed must stand in its [set]",
                path.display()
            ));
        }
        return Ok(written);
    }
    whole(&path, &manifest(recording, texts.len()))?;
    notices.push(format!(
        "logs of torques (controller.csv) and encoders (plant.csv) belong beside camera.csv in {}; docs/data-set.md says what they hold",
        out.display()
    ));
    written.push(path);
    Ok(written)
}

/// Writes the log of each run; one that was there before the first import is kept.
fn logs(runs: &Runs, texts: &[String], notices: &mut Vec<String>) -> Result<Vec<PathBuf>, Error> {
    let mut written = Vec::new();
    for (folder, text) in runs.folders.iter().zip(texts) {
        std::fs::create_dir_all(folder).map_err(file(folder))?;
        let (path, before) = (folder.join(LOG), folder.join(BEFORE));
        if path.exists() && !before.exists() {
            // a copy, for the log must not be gone where the new one can't be written
            let kept = std::fs::read(&path).and_then(|log| write_whole(&before, |to| to.write_all(&log)));
            kept.map_err(file(&before))?;
            notices.push(format!("{} was there before; it is {BEFORE} now", path.display()));
        }
        whole(&path, text)?;
        written.push(path);
    }
    Ok(written)
}

/// The text of a new manifest for so many runs.
fn manifest(recording: &Recording, runs: usize) -> String {
    let mut text = format!("format = 1\nscenario = {}\n", quoted(&scenario(recording)));
    if !recording.set.is_empty() {
        text.push_str("\n[set]\n");
        for given in &recording.set {
            let (variable, value) = given.split_once('=').unwrap_or((given, ""));
            let _ = writeln!(text, "{} = {}", quoted(variable), literal(value));
        }
    }
    for run in 0..runs {
        // with its odd characters escaped: a name may hold the end of a line
        let folder = &recording.folders[run];
        let _ = write!(
            text,
            "\n[[run]]                              # frames of {folder:?}\ndir = {}\n",
            quoted(&name(run))
        );
    }
    text
}

/// Writes a file that is either not there or whole, even if this ends in the middle.
fn whole(path: &Path, text: &str) -> Result<(), Error> {
    write_whole(path, |to| to.write_all(text.as_bytes())).map_err(file(path))
}

/// The scenario as the manifest names it: a path is kept whole, for the manifest lies elsewhere.
fn scenario(recording: &Recording) -> String {
    let path = Path::new(&recording.scenario);
    match std::path::absolute(path) {
        Ok(absolute) if path.is_file() => absolute.display().to_string(),
        _ => recording.scenario.clone(),
    }
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// A value as TOML has it: a number or a truth as it is, anything else as a text.
fn literal(value: &str) -> String {
    let is_plain = value.parse::<f64>().is_ok_and(f64::is_finite) || value.parse::<bool>().is_ok();
    match format!("x = {value}").parse::<toml::Table>() {
        Ok(_) if is_plain => value.to_owned(),
        _ => quoted(value),
    }
}

#[cfg(test)]
mod tests {
    use super::{BEFORE, LOG, MANIFEST, Runs, logs, runs};

    #[test]
    fn bad_folders_of_runs_are_refused_before_anything_is_written() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        for dir in ["../other", "/tmp"] {
            let text = format!("format = 1\n[[run]]\ndir = {dir:?}\n");
            std::fs::write(folder.path().join(MANIFEST), text).expect("writable");
            let error = runs(folder.path(), 1).map(drop).expect_err("it leads out").to_string();
            assert!(error.contains(&format!("dir = {dir:?} leads out of")), "{error}");
        }
    }

    #[test]
    fn law_the_log_that_was_there_is_kept_once() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let runs = Runs { folders: vec![folder.path().to_owned()], listed: true };
        let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).ok();
        std::fs::write(folder.path().join(LOG), "measured").expect("writable");
        for text in ["first", "second"] {
            logs(&runs, &[text.to_owned()], &mut Vec::new()).expect("written");
            assert_eq!((read(LOG).as_deref(), read(BEFORE).as_deref()), (Some(text), Some("measured")));
        }
        assert_eq!(std::fs::read_dir(folder.path()).expect("there").count(), 2, "nothing else is left");
    }
}
