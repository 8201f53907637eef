//! Which units there are: the folders `fmus/*/fmu` with a Cargo.toml, and the blank unit that containers are made of.

use crate::{Result, at};
use std::fs;
use std::path::Path;

/// The package names of all shells, sorted by folder; the container's comes last.
pub fn find(root: &Path) -> Result<Vec<String>> {
    let folder = root.join("fmus");
    let mut manifests = Vec::new();
    for entry in at(&folder, fs::read_dir(&folder))? {
        let manifest = at(&folder, entry)?.path().join("fmu").join("Cargo.toml");
        if manifest.is_file() {
            manifests.push(manifest);
        }
    }
    manifests.sort();
    if !manifests.is_empty() {
        manifests.push(root.join("container").join("fmu").join("Cargo.toml"));
    }
    manifests.iter().map(|manifest| package(manifest)).collect()
}

fn package(manifest: &Path) -> Result<String> {
    let text = at(manifest, fs::read_to_string(manifest))?;
    let table: toml::Table = text.parse().map_err(|error| format!("{}: {error}", manifest.display()))?;
    let name = table.get("package").and_then(|package| package.get("name")).and_then(|name| name.as_str());
    name.map(str::to_owned).ok_or_else(|| format!("{}: package.name is missing", manifest.display()).into())
}
