//! Units with `isolate = true` in the process of a master that is not ours: they are served by the library of the container itself.
//! It has a beginning like a program (`container/fmu`), and the system's loader, which maps libraries anyway, can start it as one:
//! no second file has to be packed, found, made executable and kept at the same version.
#![allow(unsafe_code)] // asks the loader where things lie

use orchestrator::{Host, Scenario};

/// Has the units that are to be isolated served by this library. Where that is impossible they are not isolated: a word about it.
pub(crate) fn by_this_library(scenario: &mut Scenario) -> Option<String> {
    let mut isolated: Vec<_> = scenario.units.iter_mut().filter(|unit| unit.isolation.is_some()).collect();
    if isolated.is_empty() {
        return None;
    }
    match this_library() {
        Some(host) => {
            let isolations = isolated.iter_mut().filter_map(|unit| unit.isolation.as_mut());
            isolations.for_each(|isolation| isolation.host = Some(host.clone()));
            None
        }
        None => {
            isolated.into_iter().for_each(|unit| unit.isolation = None);
            Some(
                "isolate is left out: units in processes of their own need Linux with glibc on x86-64 or ARM64"
                    .to_owned(),
            )
        }
    }
}

/// What the beginning of the library as a program calls: serves a unit. Anything else is a mistake of a person.
pub fn serve() -> ! {
    orchestrator::serve_units();
    eprintln!("this is a unit for FMI 2.0 co-simulation, not a program");
    std::process::exit(2)
}

#[cfg(all(target_os = "linux", target_env = "gnu", any(target_arch = "x86_64", target_arch = "aarch64")))]
fn this_library() -> Option<Host> {
    // SAFETY: asks what the system told this process at its start: where its loader lies.
    let loader = file_of(unsafe { libc::getauxval(libc::AT_BASE) } as *const _)?;
    let library = file_of(serve as *const _)?;
    Some(Host { program: loader.into(), arguments: vec![library] })
}

#[cfg(not(all(
    target_os = "linux",
    target_env = "gnu",
    any(target_arch = "x86_64", target_arch = "aarch64")
)))]
fn this_library() -> Option<Host> {
    None
}

/// The file that an address belongs to.
#[cfg(all(target_os = "linux", target_env = "gnu", any(target_arch = "x86_64", target_arch = "aarch64")))]
fn file_of(address: *const std::ffi::c_void) -> Option<std::ffi::OsString> {
    use std::os::unix::ffi::OsStringExt as _;
    // SAFETY: plain data that the call fills; any address may be asked for. The name is a string of the loader's.
    let name = unsafe {
        let mut found: libc::Dl_info = std::mem::zeroed();
        if address.is_null() || libc::dladdr(address, &mut found) == 0 || found.dli_fname.is_null() {
            return None;
        }
        std::ffi::CStr::from_ptr(found.dli_fname).to_bytes().to_vec()
    };
    // A library is named as it was asked for, perhaps from another folder.
    let path = std::path::PathBuf::from(std::ffi::OsString::from_vec(name));
    path.canonicalize().ok().map(Into::into)
}
