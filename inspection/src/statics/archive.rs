//! The layout of the archive (FMI 2.0.4 section 2.3) and what its libraries export (sections 2.1 and 4.2).

use super::File;
use crate::finding::Found;
use object::Architecture;
use std::collections::BTreeSet;

/// What may stand at the root; the last two are of later additions to the standard.
const ROOT: &[&str] = &[
    "modelDescription.xml",
    "model.png",
    "documentation",
    "licenses",
    "sources",
    "binaries",
    "resources",
    "extra",
    "terminalsAndIcons",
];

pub(super) fn layout(file: &File<'_>, found: &mut Found) {
    let archive = file.archive;
    if let Err(why) = &archive.description {
        let folders =
            archive.entries.iter().filter_map(|entry| entry.name.strip_suffix("/modelDescription.xml"));
        match folders.min_by_key(|folder| folder.len()) {
            Some(folder) => {
                found.error(format!("{why}, but in the folder {folder}: pack what is in that folder"))
            }
            None => found.error(why.clone()),
        }
    }
    for entry in &archive.entries {
        if let Some(why) = &entry.unreadable {
            found.error(format!("{} can't be read: {why}", entry.name));
        }
    }
    let first = |name: &str| name.split('/').next().unwrap_or_default().to_owned();
    let tops: BTreeSet<String> = archive.entries.iter().map(|entry| first(&entry.name)).collect();
    for top in tops.iter().filter(|top| !top.is_empty() && !ROOT.contains(&top.as_str())) {
        let near = ROOT.iter().find(|known| known.eq_ignore_ascii_case(top));
        match near {
            Some(near) => found.error(format!("{top} at the root must be called {near}")),
            None => found.warning(format!(
                "{top} at the root has no meaning in FMI 2.0: what a unit needs belongs in resources/"
            )),
        }
    }
}

pub(super) fn paths(file: &File<'_>, found: &mut Found) {
    let mut seen = BTreeSet::new();
    if file.archive.twins > 0 {
        let twins = file.archive.twins;
        found.error(format!("{twins} of its entries have the very name of another one: which of them counts depends on the reader"));
    }
    for entry in &file.archive.entries {
        let name = &entry.name;
        let drive = name.as_bytes().get(1) == Some(&b':');
        if name.contains('\\') {
            found.error(format!("{name:?} has a backslash: folders are parted by /"));
        } else if name.starts_with('/') || drive || name.split('/').any(|part| part == "..") {
            found.error(format!("{name:?} leads out of the archive"));
        }
        if entry.is_link {
            found.error(format!("{name:?} is a symbolic link: pack the file that it leads to"));
        }
        if !name.is_empty() && !seen.insert(name.to_lowercase()) {
            found.error(format!(
                "{name:?} is there twice, perhaps in other letters: unpacked, one replaces the other"
            ));
        }
    }
}

pub(super) fn binaries(file: &File<'_>, found: &mut Found) {
    let archive = file.archive;
    let root = file.root();
    let kinds = ["CoSimulation", "ModelExchange"].map(|kind| root.and_then(|root| root.child(kind)));
    let wanted: Vec<&str> =
        kinds.into_iter().flatten().filter_map(|kind| kind.attribute("modelIdentifier")).collect();
    let sources = archive.entries.iter().any(|entry| entry.name.starts_with("sources/") && !entry.is_folder);
    if archive.binaries.is_empty() && !archive.encrypted_libraries {
        match sources {
            true => found.note("it holds sources and no binaries: masters that don't compile can't run it"),
            false => found.error("it holds neither binaries/PLATFORM/… nor sources: nothing can be run"),
        }
    }
    let platforms: BTreeSet<&str> = archive.binaries.iter().map(|binary| binary.platform.as_str()).collect();
    for platform in platforms {
        let held: Vec<_> = archive.binaries.iter().filter(|binary| binary.platform == platform).collect();
        let named = |identifier: &&&str| !held.iter().any(|binary| binary.stem == ***identifier);
        for identifier in wanted.iter().filter(named) {
            let names: Vec<&str> = held.iter().map(|binary| binary.name.as_str()).collect();
            found.error(format!(
                "binaries/{platform} has no library {identifier}, as modelIdentifier calls it (there: {})",
                names.join(", ")
            ));
        }
        let ending = match platform {
            "win32" | "win64" => ".dll",
            "linux32" | "linux64" => ".so",
            "darwin64" => ".dylib",
            _ => "",
        };
        for binary in held.iter().filter(|binary| !binary.name.ends_with(ending)) {
            found.error(format!("{} has another ending than {ending}, that of {platform}", binary.name));
        }
        let processor = processor(platform);
        for binary in &held {
            if let (Some(own), Some(other)) = (processor, binary.processor)
                && own != other
            {
                found.error(format!("{} is for {other:?}, and {platform} is {own:?}", binary.name));
            }
        }
    }
}

/// What runs the libraries of a platform; Apple's may hold parts for several.
fn processor(platform: &str) -> Option<Architecture> {
    match platform {
        "win32" | "linux32" => Some(Architecture::I386),
        "win64" | "linux64" => Some(Architecture::X86_64),
        platform if platform.starts_with("aarch64-") => Some(Architecture::Aarch64),
        platform if platform.starts_with("x86_64-") => Some(Architecture::X86_64),
        _ => None,
    }
}

/// Every unit has these.
const NEEDED: &[&str] = &[
    "GetTypesPlatform",
    "GetVersion",
    "SetDebugLogging",
    "Instantiate",
    "FreeInstance",
    "SetupExperiment",
    "EnterInitializationMode",
    "ExitInitializationMode",
    "Terminate",
    "Reset",
    "GetReal",
    "GetInteger",
    "GetBoolean",
    "GetString",
    "SetReal",
    "SetInteger",
    "SetBoolean",
    "SetString",
];
const CO_SIMULATION: &[&str] = &["DoStep"];
const MODEL_EXCHANGE: &[&str] = &[
    "EnterEventMode",
    "NewDiscreteStates",
    "EnterContinuousTimeMode",
    "CompletedIntegratorStep",
    "SetTime",
    "SetContinuousStates",
    "GetDerivatives",
    "GetEventIndicators",
    "GetContinuousStates",
    "GetNominalsOfContinuousStates",
];
/// A unit that declares a capability has its functions; masters look all of them up, some give up at one that is missing.
const BY_CAPABILITY: &[(&str, &[&str])] = &[
    ("canGetAndSetFMUstate", &["GetFMUstate", "SetFMUstate", "FreeFMUstate"]),
    ("canSerializeFMUstate", &["SerializedFMUstateSize", "SerializeFMUstate", "DeSerializeFMUstate"]),
    ("providesDirectionalDerivative", &["GetDirectionalDerivative"]),
];
const OPTIONAL_CO_SIMULATION: &[(&str, &[&str])] = &[
    ("canInterpolateInputs", &["SetRealInputDerivatives"]),
    ("maxOutputDerivativeOrder", &["GetRealOutputDerivatives"]),
    (
        "canRunAsynchronuously",
        &[
            "CancelStep",
            "GetStatus",
            "GetRealStatus",
            "GetIntegerStatus",
            "GetBooleanStatus",
            "GetStringStatus",
        ],
    ),
];

pub(super) fn functions(file: &File<'_>, found: &mut Found) {
    // What both kinds of a unit lack is told once.
    let mut told = BTreeSet::new();
    for binary in &file.archive.binaries {
        let exports = match &binary.exports {
            Ok(exports) => exports,
            Err(why) => {
                found.error(format!("{} is no shared library: {why}", binary.name));
                continue;
            }
        };
        let Some(root) = file.root() else { continue };
        for (kind, own, optional) in [
            ("CoSimulation", CO_SIMULATION, OPTIONAL_CO_SIMULATION),
            ("ModelExchange", MODEL_EXCHANGE, &[][..]),
        ] {
            let Some(element) = root.child(kind) else { continue };
            if element.attribute("modelIdentifier") != Some(binary.stem.as_str()) {
                continue;
            }
            let missing = |names: &[&str]| -> Vec<String> {
                let names = names.iter().map(|name| format!("fmi2{name}"));
                names.filter(|name| !exports.contains(name)).collect()
            };
            let needed = [NEEDED, own].concat();
            let lacking = missing(&needed);
            if !lacking.is_empty() && told.insert((&binary.name, lacking.clone())) {
                found.error(format!("{} does not export {}", binary.name, lacking.join(", ")));
            }
            for (capability, names) in BY_CAPABILITY.iter().chain(optional) {
                let lacking = missing(names);
                if lacking.is_empty() || !told.insert((&binary.name, lacking.clone())) {
                    continue;
                }
                let declared =
                    element.flag(capability) || element.number::<u32>(capability).is_some_and(|n| n > 0);
                let what = format!("{} does not export {}", binary.name, lacking.join(", "));
                match declared {
                    true => found.error(format!("{what}, though it declares {capability}")),
                    false => found.warning(format!("{what}: masters that look up all functions refuse it")),
                }
            }
        }
    }
}

pub(super) fn sources(file: &File<'_>, found: &mut Found) {
    let Some(root) = file.root() else { return };
    for kind in ["CoSimulation", "ModelExchange"].iter().filter_map(|kind| root.child(kind)) {
        for listed in kind.list("SourceFiles", "File") {
            let Some(name) = listed.attribute("name") else { continue };
            let path = format!("sources/{name}");
            if !file.archive.entries.iter().any(|entry| entry.name == path) {
                found.warning_at(listed.line, format!("{path} is listed, but the archive does not hold it"));
            }
        }
    }
}
