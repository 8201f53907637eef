//! Calls of cargo: silent when there is nothing to build.

use crate::platform::Platform;
use crate::{Result, at};
use std::env::consts::EXE_SUFFIX;
use std::ffi::{OsStr, OsString};
use std::io::{BufRead, BufReader, IsTerminal};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};

/// Builds the shells under `build` with the profile `fmu` and answers where their libraries lie, in order.
///
/// No path of this machine gets into them, and no flag of its owner, so that the same source gives the same
/// bytes everywhere.
pub fn build_units(root: &Path, shells: &[String], build: &Path) -> Result<Vec<PathBuf>> {
    let mut cargo = cargo(root);
    cargo.arg("build");
    build_shells(cargo, shells, build, remapped_paths(root)?)?;
    Ok(libraries(shells, &build.join("fmu"), Platform::own()))
}

/// As [`build_units`], for another platform or for old machines of this one, with zig as the linker.
pub fn build_units_for(
    platform: Platform,
    root: &Path,
    shells: &[String],
    build: &Path,
) -> Result<Vec<PathBuf>> {
    let mut cargo = zigbuild(root, platform)?;
    cargo.args(["--target", platform.target()]);
    let mut flags = remapped_paths(root)?;
    // zig writes the time of day into a DLL unless it is told to optimise; then it is a checksum of the content.
    flags.push("-Clink-arg=-O2".to_owned());
    // The first macOS for Apple's own processors; zig's own choice is the newest but one.
    cargo.env("MACOSX_DEPLOYMENT_TARGET", "11.0");
    build_shells(cargo, shells, build, flags)?;
    let (folder, _) = platform.target().split_once(".2").unwrap_or((platform.target(), ""));
    Ok(libraries(shells, &build.join(folder).join("fmu"), platform))
}

fn build_shells(mut cargo: Command, shells: &[String], build: &Path, flags: Vec<String>) -> Result<()> {
    cargo.args(["--profile", "fmu", "--target-dir"]).arg(build);
    for shell in shells {
        cargo.args(["--package", shell]);
    }
    cargo.env("CARGO_ENCODED_RUSTFLAGS", flags.join("\x1f"));
    cargo.env("CARGO_INCREMENTAL", "0");
    run_quietly(cargo)
}

fn libraries(shells: &[String], folder: &Path, platform: Platform) -> Vec<PathBuf> {
    shells.iter().map(|shell| folder.join(platform.library(&shell.replace('-', "_")))).collect()
}

/// `cargo zigbuild`, from the repository's Python environment or from the PATH.
fn zigbuild(root: &Path, platform: Platform) -> Result<Command> {
    let beside = root.join(".venv").join(if cfg!(windows) { "Scripts" } else { "bin" });
    let path = std::env::var_os("PATH").unwrap_or_default();
    let folders: Vec<PathBuf> = std::iter::once(beside).chain(std::env::split_paths(&path)).collect();
    let program = format!("cargo-zigbuild{EXE_SUFFIX}");
    let Some(program) = folders.iter().map(|folder| folder.join(&program)).find(|path| path.is_file()) else {
        let targets = platform.rust_targets().join(" ");
        return Err(format!(
            "{platform} is built by cargo-zigbuild, which is not there: type `.venv/bin/python -m pip install \
             -r python/requirements.txt` and `rustup target add {targets}`"
        )
        .into());
    };
    let mut command = Command::new(program);
    command.arg("zigbuild").current_dir(root).env("PATH", std::env::join_paths(folders)?);
    Ok(command)
}

/// Runs a program of the workspace; what it prints is for the person.
pub fn run_program(program: &Path, arguments: &[&OsStr]) -> Result<()> {
    let status = at(program, Command::new(program).args(arguments).status())?;
    if status.success() { Ok(()) } else { Err(format!("{} failed ({status})", program.display()).into()) }
}

/// Builds a program with the release profile and answers where it lies. As one of the workspace, not as a package by itself: that
/// would choose other features of four libraries, and the tests would compile half of the workspace again.
pub fn build_program(root: &Path, program: &str) -> Result<PathBuf> {
    let target = root.join("target");
    let mut cargo = cargo(root);
    cargo.args(["build", "--release", "--workspace", "--bin", program, "--target-dir"]).arg(&target);
    run_quietly(cargo)?;
    Ok(target.join("release").join(format!("{program}{EXE_SUFFIX}")))
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
