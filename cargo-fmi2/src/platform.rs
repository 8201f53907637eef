//! Names of platforms and libraries as FMI 2.0 section 2.3 has them, how to know a library's platform, and for which
//! target it is built.

use clap::ValueEnum;
use std::fmt;
use std::str::FromStr;

/// A platform that a binary in an `.fmu` can be for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Platform {
    /// Linux on x86-64.
    Linux64,
    /// Windows on x86-64.
    Win64,
    /// macOS (x86-64, or universal).
    Darwin64,
    /// Linux on 64-bit ARM. FMI 2.0.5 has platforms without a name of their own use FMI 3.0's tuples.
    #[value(name = "aarch64-linux")]
    Aarch64Linux,
}

/// Platforms that are packed, as `--platforms` has them: names with commas between, or `all`.
#[derive(Debug, Clone, Default)]
pub struct Platforms(pub Vec<Platform>);

impl FromStr for Platforms {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let all = Platform::value_variants();
        if text.is_empty() {
            return Ok(Self::default());
        }
        if text == "all" {
            return Ok(Self(all.to_vec()));
        }
        let names = || all.iter().map(|platform| platform.folder()).collect::<Vec<_>>().join(", ");
        let one = |name: &str| {
            let known = all.iter().find(|platform| platform.folder() == name.trim());
            known.copied().ok_or_else(|| format!("no platform `{name}`: there are {}, or all", names()))
        };
        text.split(',').map(one).collect::<Result<_, _>>().map(Self)
    }
}

impl fmt::Display for Platform {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.folder())
    }
}

impl Platform {
    /// The one that this program runs on.
    pub fn own() -> Self {
        if cfg!(windows) {
            Platform::Win64
        } else if cfg!(target_os = "macos") {
            Platform::Darwin64
        } else if cfg!(target_arch = "aarch64") {
            Platform::Aarch64Linux
        } else {
            Platform::Linux64
        }
    }

    /// Folder under `binaries/`.
    pub fn folder(self) -> &'static str {
        match self {
            Platform::Linux64 => "linux64",
            Platform::Win64 => "win64",
            Platform::Darwin64 => "darwin64",
            Platform::Aarch64Linux => "aarch64-linux",
        }
    }

    /// The target for `cargo zigbuild`: Linux with the oldest C library that manylinux2014 allows, macOS for both of its
    /// processors in one file.
    pub fn target(self) -> &'static str {
        match self {
            Platform::Linux64 => "x86_64-unknown-linux-gnu.2.17",
            Platform::Win64 => "x86_64-pc-windows-gnu",
            Platform::Darwin64 => "universal2-apple-darwin",
            Platform::Aarch64Linux => "aarch64-unknown-linux-gnu.2.17",
        }
    }

    /// The targets of rustup behind it.
    pub fn rust_targets(self) -> &'static [&'static str] {
        match self {
            Platform::Linux64 => &["x86_64-unknown-linux-gnu"],
            Platform::Win64 => &["x86_64-pc-windows-gnu"],
            Platform::Darwin64 => &["x86_64-apple-darwin", "aarch64-apple-darwin"],
            Platform::Aarch64Linux => &["aarch64-unknown-linux-gnu"],
        }
    }

    /// What cargo calls a shared library of which the crate has this name.
    pub fn library(self, stem: &str) -> String {
        match self {
            Platform::Win64 => format!("{stem}.dll"),
            Platform::Darwin64 => format!("lib{stem}.dylib"),
            Platform::Linux64 | Platform::Aarch64Linux => format!("lib{stem}.so"),
        }
    }

    /// Where the library of a unit lies in its `.fmu`.
    pub fn entry(self, identifier: &str) -> String {
        let extension = match self {
            Platform::Linux64 | Platform::Aarch64Linux => "so",
            Platform::Win64 => "dll",
            Platform::Darwin64 => "dylib",
        };
        format!("binaries/{}/{identifier}.{extension}", self.folder())
    }

    /// Whether the first bytes of a library are those of this platform.
    pub fn matches(self, library: &[u8]) -> bool {
        let starts: &[&[u8]] = match self {
            Platform::Linux64 | Platform::Aarch64Linux => &[b"\x7fELF\x02"],
            Platform::Win64 => &[b"MZ"],
            // 64-bit Mach-O, and universal
            Platform::Darwin64 => &[b"\xcf\xfa\xed\xfe", b"\xca\xfe\xba\xbe"],
        };
        starts.iter().any(|start| library.starts_with(start))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_platforms_are_named_as_the_folders_are() {
        let all: Platforms = "all".parse().unwrap();
        assert_eq!(all.0.len(), 4);
        let two: Platforms = "win64, aarch64-linux".parse().unwrap();
        assert_eq!(two.0, [Platform::Win64, Platform::Aarch64Linux]);
        let refused = "win32".parse::<Platforms>().unwrap_err();
        assert!(
            refused.contains("win32") && refused.contains("linux64, win64, darwin64, aarch64-linux"),
            "{refused}"
        );
        for platform in all.0 {
            let value = platform.to_possible_value().unwrap();
            assert_eq!(value.get_name(), platform.folder(), "cargo xtask merge takes the same names");
        }
    }
}
