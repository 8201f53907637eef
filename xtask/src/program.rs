//! Which program does what was typed after `cargo acroscope`: a fresh machine builds a small one for its first runs, the whole one when
//! something else is asked for, and that one from then on.

use crate::Result;
use crate::cargo;
use std::env::consts::EXE_SUFFIX;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// All commands.
const WHOLE: &str = "acroscope";
/// `run`, without formats for other tools: a third of the work to compile.
const FIRST: &str = "acroscope-run";
/// Options of `run` that the small program doesn't have.
const MORE: [&str; 2] = ["--mcap", "--parquet"];

/// Builds it and answers where it lies.
pub fn build(root: &Path, arguments: &[OsString]) -> Result<PathBuf> {
    let whole = root.join("target").join("release").join(format!("{WHOLE}{EXE_SUFFIX}"));
    let program = if !whole.exists() && is_run(arguments) { FIRST } else { WHOLE };
    cargo::build_program(root, program)
}

fn is_run(arguments: &[OsString]) -> bool {
    let command = arguments.iter().find(|word| !word.to_string_lossy().starts_with('-'));
    command.is_some_and(|word| word == "run")
        && !arguments.iter().any(|word| MORE.iter().any(|more| word == more))
}

#[cfg(test)]
mod tests {
    use super::is_run;

    #[test]
    fn law_only_a_plain_run_is_done_by_the_small_program() {
        let typed = |line: &str| is_run(&line.split_whitespace().map(Into::into).collect::<Vec<_>>());
        assert!(typed("run visual-servo --set camera.k1=0.1"));
        assert!(typed("--quiet run visual-servo") && typed("run --help"));
        for line in
            ["", "--help", "--version", "diagnose run", "run visual-servo --mcap", "run a.toml --parquet"]
        {
            assert!(!typed(line), "{line}");
        }
    }
}
