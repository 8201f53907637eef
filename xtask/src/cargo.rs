//! Calls of cargo: silent when there is nothing to build.

use crate::{Result, at};
use std::env::consts::{DLL_PREFIX, DLL_SUFFIX, EXE_SUFFIX};
use std::ffi::OsString;
use std::io::{BufRead, BufReader, IsTerminal};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};

/// Builds the shells under `build` with the profile `fmu` and answers where their libraries lie, in order.
///
/// No path of this machine gets into them, and no flag of its owner, so that the same source gives the same
/// bytes everywhere.
pub fn build_units(root: &Path, shells: &[String], build: &Path) -> Result<Vec<PathBuf>> {
    let mut cargo = cargo(root);
    cargo.args(["build", "--profile", "fmu", "--target-dir"]).arg(build);
    for shell in shells {
        cargo.args(["--package", shell]);
    }
    cargo.env("CARGO_ENCODED_RUSTFLAGS", remapped_paths(root)?.join("\x1f"));
    cargo.env("CARGO_INCREMENTAL", "0");
    run_quietly(cargo)?;
    let library = |shell: &String| {
        let stem = shell.replace('-', "_");
        build.join("fmu").join(format!("{DLL_PREFIX}{stem}{DLL_SUFFIX}"))
    };
    Ok(shells.iter().map(library).collect())
}

/// Builds a program with the release profile and answers where it lies.
pub fn build_program(root: &Path, package: &str) -> Result<PathBuf> {
    let target = root.join("target");
    let mut cargo = cargo(root);
    cargo.args(["build", "--release", "--package", package, "--target-dir"]).arg(&target);
    run_quietly(cargo)?;
    Ok(target.join("release").join(format!("{package}{EXE_SUFFIX}")))
}

/// Goes on as another program, with its exit status.
pub fn become_program(program: &Path, arguments: &[OsString]) -> Result<ExitCode> {
    let mut command = Command::new(program);
    command.args(arguments);
    #[cfg(unix)]
    {
        use std::os::unix::process::CommandExt;
        at(program, Err(command.exec()))
    }
    #[cfg(not(unix))]
    {
        let status = at(program, command.status())?;
        Ok(ExitCode::from(status.code().and_then(|code| u8::try_from(code).ok()).unwrap_or(1)))
    }
}

fn cargo(root: &Path) -> Command {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.current_dir(root);
    cargo
}

fn remapped_paths(root: &Path) -> Result<Vec<String>> {
    let home = std::env::home_dir().unwrap_or_default();
    let cargo_home = std::env::var_os("CARGO_HOME").map_or_else(|| home.join(".cargo"), PathBuf::from);
    let sysroot = rustc(root, &["--print", "sysroot"])?;
    let version = rustc(root, &["--version", "--verbose"])?;
    let commit = version.lines().find_map(|line| line.strip_prefix("commit-hash: ")).unwrap_or("unknown");
    let library = Path::new(sysroot.trim()).join("lib").join("rustlib").join("src").join("rust");
    // The last one that matches wins, so the more general ones come first.
    Ok([(cargo_home.as_path(), "/cargo"), (root, "/acroscope"), (&library, &format!("/rustc/{commit}"))]
        .iter()
        .map(|(path, name)| format!("--remap-path-prefix={}={name}", path.display()))
        .collect())
}

fn rustc(root: &Path, arguments: &[&str]) -> Result<String> {
    let output = Command::new("rustc").current_dir(root).args(arguments).output();
    let output = output.map_err(|error| format!("rustc: {error}"))?;
    Ok(String::from_utf8(output.stdout)?)
}

/// Runs cargo and passes on what it says, except that all is up to date.
fn run_quietly(mut cargo: Command) -> Result<()> {
    cargo.args(["--color", if std::io::stderr().is_terminal() { "always" } else { "never" }]);
    let spawned = cargo.stderr(Stdio::piped()).stdout(Stdio::null()).spawn();
    let mut child = spawned.map_err(|error| format!("cargo: {error}"))?;
    if let Some(stderr) = child.stderr.take() {
        for line in BufReader::new(stderr).lines() {
            let line = line?;
            if !line.contains("Finished") && !line.contains("Blocking waiting") {
                eprintln!("{line}");
            }
        }
    }
    let status = child.wait()?;
    if status.success() { Ok(()) } else { Err(format!("cargo build failed ({status})").into()) }
}
