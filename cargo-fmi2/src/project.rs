//! A crate with a unit in it: built with cargo, its library found.

use crate::{Result, at};
use cargo_metadata::{CrateType, Message, MetadataCommand};
use std::fs;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Which crate: cargo's own arguments.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct Project {
    /// Path of the crate's Cargo.toml
    #[arg(long, value_name = "PATH")]
    pub manifest_path: Option<PathBuf>,
    /// The crate, where the workspace has several
    #[arg(long, short, value_name = "NAME")]
    pub package: Option<String>,
}

impl Project {
    fn cargo(&self, subcommand: &str) -> Command {
        let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        cargo.arg(subcommand);
        if let Some(path) = &self.manifest_path {
            cargo.arg("--manifest-path").arg(path);
        }
        if let Some(name) = &self.package {
            cargo.args(["--package", name]);
        }
        cargo
    }

    /// Builds the crate in release and answers where its shared library lies.
    ///
    /// # Errors
    /// The crate doesn't build, or there is not exactly one shared library in it.
    pub fn build(&self) -> Result<PathBuf> {
        let mut cargo = self.cargo("build");
        cargo.args(["--release", "--message-format", "json-render-diagnostics"]).stdout(Stdio::piped());
        let mut child = cargo.spawn().map_err(|error| format!("cargo: {error}"))?;
        let mut libraries = Vec::new();
        if let Some(stdout) = child.stdout.take() {
            for message in Message::parse_stream(BufReader::new(stdout)) {
                let Message::CompilerArtifact(artifact) = message? else { continue };
                if artifact.target.crate_types.contains(&CrateType::CDyLib) {
                    let is_shared = |path: &&cargo_metadata::camino::Utf8PathBuf| {
                        path.extension().is_some_and(|extension| ["so", "dll", "dylib"].contains(&extension))
                    };
                    libraries.extend(
                        artifact
                            .filenames
                            .iter()
                            .filter(is_shared)
                            .map(|path| path.clone().into_std_path_buf()),
                    );
                }
            }
        }
        let status = child.wait()?;
        if !status.success() {
            return Err(format!("cargo build failed ({status})").into());
        }
        match libraries.as_slice() {
            [library] => Ok(library.clone()),
            [] => Err("no shared library was built: Cargo.toml needs [lib] crate-type = [\"cdylib\"], and the crate \
                       fmi2_export::export!(...)"
                .into()),
            several => Err(format!("{} shared libraries were built: choose a crate with --package", several.len()).into()),
        }
    }

    /// Where cargo puts what it builds.
    ///
    /// # Errors
    /// There is no crate.
    pub fn target(&self) -> Result<PathBuf> {
        let mut command = MetadataCommand::new();
        command.no_deps();
        if let Some(path) = &self.manifest_path {
            command.manifest_path(path);
        }
        Ok(command.exec()?.target_directory.into_std_path_buf())
    }

    /// Where the crate's Cargo.toml lies.
    pub fn folder(&self) -> PathBuf {
        let manifest = self.manifest_path.clone().unwrap_or_else(|| "Cargo.toml".into());
        let folder = manifest.parent().filter(|folder| !folder.as_os_str().is_empty());
        folder.unwrap_or(Path::new(".")).to_owned()
    }

    /// Licences that lie beside the crate's Cargo.toml, by the names of their files.
    ///
    /// # Errors
    /// One can't be read.
    pub fn licences(&self) -> Result<Vec<(String, Vec<u8>)>> {
        let folder = self.folder();
        let mut found = Vec::new();
        for entry in at(&folder, fs::read_dir(&folder))? {
            let path = at(&folder, entry)?.path();
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            if name.starts_with("LICENSE") && path.is_file() {
                found.push((name, at(&path, fs::read(&path))?));
            }
        }
        found.sort();
        Ok(found)
    }
}
