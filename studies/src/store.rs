//! What studies leave in a folder of results, `studies/ID.json`, so that a later call for some of them joins what is there
//! in place of replacing it.

use crate::claim::{Outcome, Study};
use crate::{Error, STUDIES};
use report::{Origin, Program, Provenance};
use serde::{Deserialize, Serialize};
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

/// Writes what came out of these, and answers it together with what earlier calls left, in the order of the paper. What
/// another program or other units made says so.
pub fn join(
    out: &Path,
    fresh: &[(&'static Study, Outcome)],
    provenance: &Provenance,
) -> Result<Vec<(&'static Study, Outcome)>, Error> {
    let failed = |path: &Path, why: &dyn std::fmt::Display| Error::File {
        path: path.to_owned(),
        why: why.to_string(),
    };
    let folder = out.join("studies");
    std::fs::create_dir_all(&folder).map_err(|why| failed(&folder, &why))?;
    for (study, outcome) in fresh {
        let path = file(out, study);
        let (program, units) = (provenance.program.clone(), provenance.units.clone());
        let stored = Stored { program, units, outcome: outcome.clone() };
        let text = serde_json::to_string(&stored).map_err(|why| failed(&path, &why))?;
        std::fs::write(&path, text + "\n").map_err(|why| failed(&path, &why))?;
    }
    let mut joined = Vec::new();
    for study in STUDIES {
        match fresh.iter().find(|(known, _)| known.id == study.id) {
            Some((_, outcome)) => joined.push((study, outcome.clone())),
            None => joined.extend(earlier(out, study, provenance).map(|outcome| (study, outcome))),
        }
    }
    Ok(joined)
}

/// What an earlier call left of a study. A file that can't be read any more, by an older program, counts as none.
fn earlier(out: &Path, study: &Study, provenance: &Provenance) -> Option<Outcome> {
    let text = std::fs::read_to_string(file(out, study)).ok()?;
    let Stored { program, units, mut outcome } = serde_json::from_str(&text).ok()?;
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
