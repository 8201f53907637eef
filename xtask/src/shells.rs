//! Which units there are: the folders `fmus/*/fmu` with a Cargo.toml, and the blank unit that containers are made of.

use crate::{Result, at};
use std::fs;
use std::path::{Path, PathBuf};

/// The package names of shells by their folders, in order, a list for each call of cargo: a call chooses one set of features for what its
/// packages share, so the blank unit of containers has its own, and the others are the same bytes with it and without.
pub fn calls(root: &Path, folders: &[PathBuf]) -> Result<Vec<Vec<String>>> {
    let apart = folders.chunk_by(|_, next| *next != blank(root));
    let packages = |folders: &[PathBuf]| {
        folders.iter().map(|folder| package(&folder.join("Cargo.toml"))).collect::<Result<Vec<_>>>()
    };
    apart.map(packages).collect()
}

/// The folder of the blank unit that containers are made of: it holds the whole master, and is asked for seldom.
pub fn blank(root: &Path) -> PathBuf {
    root.join("container").join("fmu")
}

/// The folders of all shells, sorted; the container's comes last.
pub fn folders(root: &Path) -> Result<Vec<PathBuf>> {
    let folder = root.join("fmus");
    let mut shells = Vec::new();
    for entry in at(&folder, fs::read_dir(&folder))? {
        let shell = at(&folder, entry)?.path().join("fmu");
        if shell.join("Cargo.toml").is_file() {
            shells.push(shell);
        }
    }
    shells.sort();
    if !shells.is_empty() {
        shells.push(blank(root));
    }
    Ok(shells)
}

fn package(manifest: &Path) -> Result<String> {
    let text = at(manifest, fs::read_to_string(manifest))?;
    let table: toml::Table = text.parse().map_err(|error| format!("{}: {error}", manifest.display()))?;
    let name = table.get("package").and_then(|package| package.get("name")).and_then(|name| name.as_str());
    name.map(str::to_owned).ok_or_else(|| format!("{}: package.name is missing", manifest.display()).into())
}
