//! Tells the program which commit it is built from: `ACROSCOPE_COMMIT`, `unknown` outside its own repository, with
//! `+changes` where files differ from the commit.

use std::path::{Path, PathBuf};
use std::process::Command;

fn main() {
    // Asked when it runs: with a copied `target/` it may have been built in another clone.
    let root = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default()).join("..");
    // A change of any source may turn a clean tree into a changed one, or back.
    for folder in std::fs::read_dir(&root).into_iter().flatten().flatten().map(|entry| entry.path()) {
        let sources = folder.join("src");
        if sources.is_dir() {
            println!("cargo::rerun-if-changed={}", sources.display());
        }
    }
    for file in ["HEAD", "logs/HEAD"] {
        let path = git(&root, &["rev-parse", "--git-path", file]).map(|path| root.join(path));
        if let Some(path) = path.filter(|path| path.exists()) {
            println!("cargo::rerun-if-changed={}", path.display());
        }
    }
    println!("cargo::rustc-env=ACROSCOPE_COMMIT={}", commit(&root).unwrap_or_else(|| "unknown".to_owned()));
}

fn commit(root: &Path) -> Option<String> {
    // Sources that lie unversioned inside another repository are not of its commit.
    let top = PathBuf::from(git(root, &["rev-parse", "--show-toplevel"])?);
    if top.canonicalize().ok()? != root.canonicalize().ok()? {
        return None;
    }
    let commit = git(root, &["rev-parse", "--short=12", "HEAD"])?;
    let changed = !git(root, &["status", "--porcelain", "--untracked-files=no"])?.is_empty();
    Some(if changed { format!("{commit}+changes") } else { commit })
}

fn git(root: &Path, arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").current_dir(root).args(arguments).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}
