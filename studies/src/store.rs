//! What studies leave in a folder of results, `studies/ID.json`, so that a later call for some of them joins what is there
//! in place of replacing it.

use crate::claim::{Outcome, Study};
use crate::{Error, STUDIES};
use report::{Origin, Program, Provenance};
use serde::{Deserialize, Serialize};
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// One study's file.
#[derive(Serialize, Deserialize)]
struct Stored {
    program: Program,
    units: Vec<Origin>,
    outcome: Outcome,
}

/// The file of a study.
fn file(out: &Path, study: &Study) -> PathBuf {
    out.join("studies").join(format!("{}.json", study.id))
}

/// A file or folder can't be written.
pub fn failed(path: &Path, why: &dyn std::fmt::Display) -> Error {
    Error::File { path: path.to_owned(), why: why.to_string() }
}

/// Writes a file by a rename, so that nobody ever sees half of it.
pub fn write(path: &Path, text: &str) -> Result<(), Error> {
    let named = || {
        let folder = path.parent().unwrap_or(Path::new("."));
        let mut file = tempfile::Builder::new().prefix(".part-").tempfile_in(folder)?;
        file.write_all(text.as_bytes())?;
        #[cfg(unix)]
        file.as_file().set_permissions(std::os::unix::fs::PermissionsExt::from_mode(0o644))?;
        file.persist(path).map_err(|why| why.error)
    };
    named().map(drop).map_err(|why: std::io::Error| failed(path, &why))
}

/// Keeps what came out of these for later calls.
pub fn keep(out: &Path, fresh: &[(&'static Study, Outcome)], provenance: &Provenance) -> Result<(), Error> {
    let folder = out.join("studies");
    std::fs::create_dir_all(&folder).map_err(|why| failed(&folder, &why))?;
    for (study, outcome) in fresh {
        let path = file(out, study);
        let (program, units) = (provenance.program.clone(), provenance.units.clone());
        let stored = Stored { program, units, outcome: outcome.clone() };
        let text = serde_json::to_string(&stored).map_err(|why| failed(&path, &why))?;
        write(&path, &(text + "\n"))?;
    }
    Ok(())
}

/// The studies that a folder has.
pub fn stored(out: &Path) -> Vec<&'static str> {
    STUDIES.iter().filter(|study| file(out, study).exists()).map(|study| study.id).collect()
}

/// Whether a folder has a study of this program and these units.
pub fn is_there(out: &Path, study: &Study, provenance: &Provenance) -> bool {
    read(out, study)
        .is_some_and(|stored| stored.program == provenance.program && stored.units == provenance.units)
}

/// These together with what earlier calls left, in the order of the paper. What another program or other units made
/// says so.
pub fn join(
    out: &Path,
    fresh: &[(&'static Study, Outcome)],
    provenance: &Provenance,
) -> Vec<(&'static Study, Outcome)> {
    let mut joined = Vec::new();
    for study in STUDIES {
        match fresh.iter().find(|(known, _)| known.id == study.id) {
            Some((_, outcome)) => joined.push((study, outcome.clone())),
            None => joined.extend(earlier(out, study, provenance).map(|outcome| (study, outcome))),
        }
    }
    joined
}

/// A study's file. One that can't be read any more, by an older program, counts as none.
fn read(out: &Path, study: &Study) -> Option<Stored> {
    serde_json::from_str(&std::fs::read_to_string(file(out, study)).ok()?).ok()
}

/// What an earlier call left of a study.
fn earlier(out: &Path, study: &Study, provenance: &Provenance) -> Option<Outcome> {
    let Stored { program, units, mut outcome } = read(out, study)?;
    if program != provenance.program || units != provenance.units {
        let which =
            if program == provenance.program { "with other units".to_owned() } else { program.line() };
        outcome.notes.insert(
            0,
            format!("This study was made by an earlier call ({which}), not as the head of this page says."),
        );
    }
    Some(outcome)
}
