//! Where a result comes from: this program, the files that were read with their checksums, the units.

use crate::error::Error;
use crate::request::Request;
use orchestrator::scenario::SignalEntry;
use orchestrator::{Scenario, Simulation};
use report::{Input, Origin, Program, Provenance};
use sha2::{Digest as _, Sha256};
use std::fmt::Write as _;
use std::path::Path;

/// This program.
pub fn program() -> Program {
    Program {
        name: "acroscope".to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        commit: env!("ACROSCOPE_COMMIT").to_owned(),
    }
}

/// Bytes as hexadecimal digits.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        // Writing into a String can't fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}

/// A text that travels inside the program, as an input.
pub fn shipped(role: &str, name: &str, text: &str) -> Input {
    Input { role: role.to_owned(), name: name.to_owned(), sha256: hex(&Sha256::digest(text.as_bytes())) }
}

/// A file as an input.
pub fn input(role: &str, name: &str, path: &Path) -> Result<Input, Error> {
    let bytes = std::fs::read(path).map_err(Error::file(path))?;
    Ok(Input { role: role.to_owned(), name: name.to_owned(), sha256: hex(&Sha256::digest(&bytes)) })
}

/// Of a run; `bytes` are those that the scenario was read from.
pub fn of_run(request: &Request, bytes: &[u8], simulation: &Simulation) -> Result<Provenance, Error> {
    let scenario = simulation.scenario();
    let sha256 = hex(&Sha256::digest(bytes));
    let mut inputs = vec![Input { role: "scenario".to_owned(), name: request.scenario.clone(), sha256 }];
    inputs.extend(signals(scenario)?);
    Ok(Provenance {
        program: program(),
        inputs,
        changes: request.changes(),
        units: units(simulation)?,
        facts: Vec::new(),
        command: request.command(),
    })
}

/// The CSV files that feed inputs, each once.
fn signals(scenario: &Scenario) -> Result<Vec<Input>, Error> {
    let folder = scenario.origin.parent().unwrap_or(Path::new(""));
    let mut names: Vec<&str> = (scenario.sources.iter())
        .filter_map(|source| match &source.signal {
            SignalEntry::Csv { file, .. } => Some(file.as_str()),
            _ => None,
        })
        .collect();
    names.sort_unstable();
    names.dedup();
    names.into_iter().map(|name| input("signal", name, &folder.join(name))).collect()
}

/// The units of a built scenario.
pub fn units(simulation: &Simulation) -> Result<Vec<Origin>, Error> {
    let described = simulation.units().zip(simulation.files());
    described
        .map(|((name, description), path)| {
            let file = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            Ok(Origin {
                name: name.to_owned(),
                sha256: input("unit", &file, path)?.sha256,
                file,
                guid: description.guid.clone(),
                tool: description.generation_tool.clone(),
            })
        })
        .collect()
}
