//! Puts the packed units in `units/`, where there are any, into the program. A clone has none there: its program finds
//! those in `target/fmus`. `scripts/crates.sh` lays them there for the published crate, whose users have no clone.

use std::fmt::Write as _;
use std::path::Path;
use std::{env, fs, io};

fn main() -> io::Result<()> {
    // The whole folder: a path that isn't there would make this, and all that depends on it, stale at every build.
    println!("cargo::rerun-if-changed=.");
    let here = env::var("CARGO_MANIFEST_DIR").map_err(io::Error::other)?;
    let mut files: Vec<_> = match fs::read_dir(Path::new(&here).join("units")) {
        Ok(entries) => entries.map(|entry| entry.map(|entry| entry.path())).collect::<Result<_, _>>()?,
        Err(_) => Vec::new(),
    };
    files.retain(|path| path.extension().is_some_and(|extension| extension == "fmu"));
    files.sort();
    let mut sum = 0xcbf2_9ce4_8422_2325_u64; // FNV-1a: names the folder that they are unpacked into
    let mut list = String::new();
    for path in &files {
        for byte in fs::read(path)? {
            sum = (sum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let _ = write!(list, "({name:?}, include_bytes!({:?}) as &[u8]),", path.display().to_string());
    }
    let text = format!(
        "/// Names and bytes of the units inside.\nconst UNITS: &[(&str, &[u8])] = &[{list}];\n\
         /// Checksum of all of them.\nconst SUM: &str = \"{sum:016x}\";\n"
    );
    let out = env::var("OUT_DIR").map_err(io::Error::other)?;
    fs::write(Path::new(&out).join("units.rs"), text)
}
