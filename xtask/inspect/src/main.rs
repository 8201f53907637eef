//! `inspect PLATFORM LIBRARY...`: whether libraries of units export all of FMI 2.0 for co-simulation, and whether they
//! ask for nothing that the oldest machine of their platform lacks.
//!
//! A program of its own, called by `cargo xtask pack --platforms`: whoever packs for one machine need not build it.

mod bounds;
mod library;

use bounds::Bounds;
use library::Library;
use std::process::ExitCode;

/// The functions of FMI 2.0 that a unit for co-simulation has, and ours that gives its texts to `cargo xtask pack`.
pub const FUNCTIONS: [&str; 35] = [
    "fmi2CancelStep",
    "fmi2DeSerializeFMUstate",
    "fmi2DoStep",
    "fmi2EnterInitializationMode",
    "fmi2ExitInitializationMode",
    "fmi2FreeFMUstate",
    "fmi2FreeInstance",
    "fmi2GetBoolean",
    "fmi2GetBooleanStatus",
    "fmi2GetDirectionalDerivative",
    "fmi2GetFMUstate",
    "fmi2GetInteger",
    "fmi2GetIntegerStatus",
    "fmi2GetReal",
    "fmi2GetRealOutputDerivatives",
    "fmi2GetRealStatus",
    "fmi2GetStatus",
    "fmi2GetString",
    "fmi2GetStringStatus",
    "fmi2GetTypesPlatform",
    "fmi2GetVersion",
    "fmi2Instantiate",
    "fmi2Reset",
    "fmi2SerializeFMUstate",
    "fmi2SerializedFMUstateSize",
    "fmi2SetBoolean",
    "fmi2SetDebugLogging",
    "fmi2SetFMUstate",
    "fmi2SetInteger",
    "fmi2SetReal",
    "fmi2SetRealInputDerivatives",
    "fmi2SetString",
    "fmi2SetupExperiment",
    "fmi2Terminate",
    "fmi2_export_describe",
];

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let Some(platform) = arguments.next() else {
        eprintln!("error: usage: inspect {} LIBRARY...", bounds::names());
        return ExitCode::from(2);
    };
    let Some(bounds) = bounds::of(&platform) else {
        eprintln!("error: no platform `{platform}`: there are {}", bounds::names());
        return ExitCode::from(2);
    };
    let mut sound = true;
    for file in arguments {
        match told(&file, bounds) {
            Ok(line) => println!("{platform}: {line}"),
            Err(why) => {
                sound = false;
                eprintln!("error: {platform}: {file}: {why}");
            }
        }
    }
    if sound { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// One line about a library that is as it should be.
fn told(file: &str, bounds: &Bounds) -> Result<String, String> {
    let bytes = std::fs::read(file).map_err(|error| error.to_string())?;
    let parts = library::read(&bytes)?;
    bounds.check_machines(&parts)?;
    let mut words = Vec::new();
    for part in &parts {
        check_exports(part)?;
        bounds.check(part)?;
        words.push(format!("{} functions for {}, needs {}", FUNCTIONS.len(), part.machine, part.needs()));
    }
    let name = std::path::Path::new(file).file_name().unwrap_or_default().to_string_lossy().into_owned();
    Ok(format!("{name}: {}", words.join("; ")))
}

/// All functions of the standard, and none that the standard doesn't have.
fn check_exports(library: &Library) -> Result<(), String> {
    let found: Vec<&str> =
        library.exports.iter().map(String::as_str).filter(|name| name.starts_with("fmi2")).collect();
    let missing: Vec<&str> = FUNCTIONS.into_iter().filter(|name| !found.contains(name)).collect();
    let surplus: Vec<&str> = found.into_iter().filter(|name| !FUNCTIONS.contains(name)).collect();
    match (missing.as_slice(), surplus.as_slice()) {
        ([], []) => Ok(()),
        ([], _) => Err(format!("exports {}, which FMI 2.0 co-simulation does not have", surplus.join(", "))),
        _ => Err(format!("does not export {}", missing.join(", "))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn library() -> Library {
        Library {
            machine: "x86_64".to_owned(),
            exports: FUNCTIONS.iter().map(|name| (*name).to_owned()).collect(),
            libraries: vec!["libc.so.6".to_owned()],
            glibc: (2, 17),
            ..Library::default()
        }
    }

    #[test]
    fn law_a_missing_or_a_surplus_function_is_named() {
        assert_eq!(check_exports(&library()), Ok(()));
        let mut less = library();
        less.exports.retain(|name| name != "fmi2DoStep");
        assert_eq!(check_exports(&less), Err("does not export fmi2DoStep".to_owned()));
        let mut more = library();
        more.exports.push("fmi2NewDiscreteStates".to_owned());
        assert!(check_exports(&more).unwrap_err().contains("fmi2NewDiscreteStates"));
    }

    #[test]
    fn law_what_an_old_machine_lacks_is_named() {
        let linux = bounds::of("linux64").unwrap();
        assert_eq!(linux.check(&library()), Ok(()));
        let newer = Library { glibc: (2, 33), ..library() };
        assert!(linux.check(&newer).unwrap_err().contains("GLIBC_2.33"));
        let later = Library { unknown: vec!["memfd_create".to_owned()], ..library() };
        assert!(linux.check(&later).unwrap_err().contains("memfd_create"));
        let stranger = Library { libraries: vec!["libpng16.so.16".to_owned()], ..library() };
        assert!(linux.check(&stranger).unwrap_err().contains("libpng16.so.16"));
        assert!(linux.check_machines(&[Library { machine: "aarch64".to_owned(), ..library() }]).is_err());
    }

    #[test]
    fn value_this_program_is_read_as_what_it_is() {
        let bytes = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        let parts = library::read(&bytes).unwrap();
        assert_eq!(parts[0].machine, std::env::consts::ARCH);
        if cfg!(target_os = "linux") {
            assert!(parts[0].libraries.iter().any(|name| name.starts_with("libc.so")), "{:?}", parts[0]);
            assert!(parts[0].glibc >= (2, 2), "{:?}", parts[0]);
            assert_eq!(parts[0].unknown, [""; 0]);
        }
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn value_a_function_that_no_library_has_is_found() {
        let source = "int not_yet(void); __attribute__((weak)) int perhaps(void);
                      int fmi2DoStep(void) { return not_yet() + (perhaps ? perhaps() : 0); }";
        let folder = std::env::temp_dir().join(format!("inspect-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let (code, library) = (folder.join("unit.c"), folder.join("unit.so"));
        std::fs::write(&code, source).unwrap();
        let linked = std::process::Command::new("cc")
            .args(["-shared", "-fPIC", "-o"])
            .args([&library, &code])
            .status();
        assert!(linked.unwrap().success(), "a linker lets it pass");
        let parts = library::read(&std::fs::read(&library).unwrap()).unwrap();
        std::fs::remove_dir_all(&folder).unwrap();
        assert_eq!(parts[0].unknown, ["not_yet"]);
    }
}
