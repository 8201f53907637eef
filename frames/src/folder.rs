//! The data set: `camera.csv` in the folder of each run, and a `dataset.toml` where there is none.

use crate::error::{Error, file};
use crate::{Recording, Stamp};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

const MANIFEST: &str = "dataset.toml";

/// First line of `camera.csv`. `t_mid` is known only where times are those of the shutter.
pub fn head(stamp: Stamp) -> String {
    let middle = if stamp == Stamp::Delivered { "" } else { ",t_mid" };
    format!("time,frame{middle},q1_est,q2_est,u1,v1,u2,v2,u3,v3,area1,area2,area3,valid\n")
}

/// Folders of the runs: those of a data set that is there, in its order, or new ones.
pub fn runs(out: &Path, count: usize) -> Result<Option<Vec<PathBuf>>, Error> {
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
    let dirs: Vec<PathBuf> = runs.filter_map(|run| Some(out.join(run.get("dir")?.as_str()?))).collect();
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
    runs: Option<&[PathBuf]>,
    texts: &[String],
    notices: &mut Vec<String>,
) -> Result<Vec<PathBuf>, Error> {
    let mut written = Vec::new();
    let name = |run: usize| format!("run-{:02}", run + 1);
    for (run, text) in texts.iter().enumerate() {
        let folder = runs.map_or_else(|| out.join(name(run)), |dirs| dirs[run].clone());
        std::fs::create_dir_all(&folder).map_err(file(&folder))?;
        let path = folder.join("camera.csv");
        std::fs::write(&path, text).map_err(file(&path))?;
        written.push(path);
    }
    let path = out.join(MANIFEST);
    if runs.is_some() {
        if !recording.set.is_empty() {
            notices.push(format!(
                "{} is left as it was: what --set changed must stand in its [set]",
                path.display()
            ));
        }
        return Ok(written);
    }
    let mut text = format!("format = 1\nscenario = {}\n", quoted(&scenario(recording)));
    if !recording.set.is_empty() {
        text.push_str("\n[set]\n");
        for given in &recording.set {
            let (variable, value) = given.split_once('=').unwrap_or((given, ""));
            let _ = writeln!(text, "{} = {}", quoted(variable), literal(value));
        }
    }
    for run in 0..texts.len() {
        let folder = &recording.folders[run];
        let _ = write!(
            text,
            "\n[[run]]                              # frames of {}\ndir = {}\n",
            folder.display(),
            quoted(&name(run))
        );
    }
    std::fs::write(&path, text).map_err(file(&path))?;
    notices.push(format!(
        "logs of torques (controller.csv) and encoders (plant.csv) belong beside camera.csv in {}; docs/data-set.md says what they hold",
        out.display()
    ));
    written.push(path);
    Ok(written)
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
