//! Names of platforms and libraries as FMI 2.0 section 2.3 has them, and how to know a library's platform.

use clap::ValueEnum;

/// A platform that a binary in an `.fmu` can be for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Platform {
    /// Linux on x86-64.
    Linux64,
    /// Windows on x86-64.
    Win64,
    /// macOS (x86-64, or universal).
    Darwin64,
}

impl Platform {
    /// The one that this program runs on.
    pub fn own() -> Self {
        if cfg!(windows) {
            Platform::Win64
        } else if cfg!(target_os = "macos") {
            Platform::Darwin64
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
        }
    }

    /// Where the library of a unit lies in its `.fmu`.
    pub fn entry(self, identifier: &str) -> String {
        let extension = match self {
            Platform::Linux64 => "so",
            Platform::Win64 => "dll",
            Platform::Darwin64 => "dylib",
        };
        format!("binaries/{}/{identifier}.{extension}", self.folder())
    }

    /// Whether the first bytes of a library are those of this platform.
    pub fn matches(self, library: &[u8]) -> bool {
        let starts: &[&[u8]] = match self {
            Platform::Linux64 => &[b"\x7fELF\x02"],
            Platform::Win64 => &[b"MZ"],
            // 64-bit Mach-O, and universal
            Platform::Darwin64 => &[b"\xcf\xfa\xed\xfe", b"\xca\xfe\xba\xbe"],
        };
        starts.iter().any(|start| library.starts_with(start))
    }
}
