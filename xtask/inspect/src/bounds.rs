//! What a library of each platform may ask for. Anything else would fail on somebody's machine when the unit is
//! loaded, so it fails here.

use crate::library::Library;

/// What the oldest machine of a platform has.
pub struct Bounds {
    /// FMI's name of the platform.
    platform: &'static str,
    /// Processors that the file must be for, all of them.
    machines: &'static [&'static str],
    /// Libraries that are there; `*` at the end stands for any text.
    libraries: &'static [&'static str],
    /// The C library's version.
    glibc: (u32, u32),
    /// The macOS that it may ask for, at most.
    macos: (u32, u32),
}

/// Libraries of every glibc system. libgcc_s unwinds panics; all distributions install it with the C library.
const LINUX: &[&str] =
    &["libc.so.6", "libdl.so.2", "libgcc_s.so.1", "libm.so.6", "libpthread.so.0", "librt.so.1", "ld-linux-*"];
/// Parts of Windows 10 and newer; `api-ms-win-crt-*` is its C library.
const WINDOWS: &[&str] = &[
    "KERNEL32.dll",
    "ntdll.dll",
    "bcryptprimitives.dll",
    "USERENV.dll",
    "WS2_32.dll",
    "api-ms-win-core-synch-*",
    "api-ms-win-crt-*",
];
/// What macOS 11 and newer has in its shared cache. libcharset is what its libiconv is made of and exports again.
const MACOS: &[&str] = &[
    "/usr/lib/libSystem.B.dylib",
    "/usr/lib/libiconv.2.dylib",
    "/usr/lib/libcharset.1.dylib",
    "/usr/lib/libobjc.A.dylib",
];

/// GLIBC 2.17: RHEL 7, and what manylinux2014 asks for.
const OLD_GLIBC: (u32, u32) = (2, 17);
/// The first macOS for Apple's own processors.
const OLD_MACOS: (u32, u32) = (11, 0);

const ALL: &[Bounds] = &[
    Bounds {
        platform: "linux64",
        machines: &["x86_64"],
        libraries: LINUX,
        glibc: OLD_GLIBC,
        macos: OLD_MACOS,
    },
    Bounds {
        platform: "aarch64-linux",
        machines: &["aarch64"],
        libraries: LINUX,
        glibc: OLD_GLIBC,
        macos: OLD_MACOS,
    },
    Bounds {
        platform: "win64",
        machines: &["x86_64"],
        libraries: WINDOWS,
        glibc: OLD_GLIBC,
        macos: OLD_MACOS,
    },
    Bounds {
        platform: "darwin64",
        machines: &["x86_64", "aarch64"],
        libraries: MACOS,
        glibc: OLD_GLIBC,
        macos: OLD_MACOS,
    },
];

/// The bounds of a platform by FMI's name.
pub fn of(platform: &str) -> Option<&'static Bounds> {
    ALL.iter().find(|bounds| bounds.platform == platform)
}

/// The names of all platforms.
pub fn names() -> String {
    ALL.iter().map(|bounds| bounds.platform).collect::<Vec<_>>().join("|")
}

impl Bounds {
    /// Whether the file is for the platform's processors.
    pub fn check_machines(&self, parts: &[Library]) -> Result<(), String> {
        let found: Vec<&str> = parts.iter().map(|part| part.machine.as_str()).collect();
        match self.machines.iter().all(|machine| found.contains(machine))
            && found.len() == self.machines.len()
        {
            true => Ok(()),
            false => Err(format!("is for {}, not for {}", found.join(" and "), self.machines.join(" and "))),
        }
    }

    /// Whether a machine of the platform has what the library asks for.
    pub fn check(&self, library: &Library) -> Result<(), String> {
        let stranger = library.libraries.iter().find(|name| !self.has(name));
        if let Some(stranger) = stranger {
            return Err(format!("needs {stranger}, which is no part of {}", self.platform));
        }
        if library.glibc > self.glibc {
            let ((major, minor), (old_major, old_minor)) = (library.glibc, self.glibc);
            return Err(format!("needs GLIBC_{major}.{minor}; at most {old_major}.{old_minor} is allowed"));
        }
        if !library.unknown.is_empty() {
            return Err(format!(
                "needs {}, which the oldest machines of {} lack",
                library.unknown.join(", "),
                self.platform
            ));
        }
        match library.macos {
            Some((major, minor)) if (major, minor) > self.macos => Err(format!(
                "needs macOS {major}.{minor}; at most {}.{} is allowed",
                self.macos.0, self.macos.1
            )),
            _ => Ok(()),
        }
    }

    fn has(&self, name: &str) -> bool {
        self.libraries.iter().any(|known| match known.strip_suffix('*') {
            Some(start) => name.to_ascii_lowercase().starts_with(start),
            None => name.eq_ignore_ascii_case(known),
        })
    }
}
