//! `cargo xtask` and the program share the crates that both need: a fresh machine compiles each of them once.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

/// Crates with the sets of features that they are compiled with.
fn features(packages: &[&str]) -> BTreeMap<String, BTreeSet<String>> {
    let output = Command::new(env!("CARGO"))
        .args(["tree", "--locked", "--edges", "normal,build", "--prefix", "none", "--no-dedupe"])
        .args(["--format", "{p};{f}"])
        .args(packages)
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
        .output()
        .expect("cargo starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mut found: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for line in String::from_utf8_lossy(&output.stdout).lines() {
        if let Some((package, features)) = line.split_once(';') {
            found.entry(package.to_owned()).or_default().insert(features.to_owned());
        }
    }
    found
}

#[test]
fn law_no_crate_is_compiled_twice_for_the_first_command() {
    let all = features(&["--workspace"]);
    let own = features(&["--package", "xtask"]);
    assert!(own.len() > 30, "found {} crates", own.len());
    let twice: Vec<_> = own.iter().filter(|(package, sets)| !sets.is_subset(&all[*package])).collect();
    assert!(
        twice.is_empty(),
        "other features than in the workspace, which xtask/Cargo.toml has to name: {twice:?}"
    );
}
