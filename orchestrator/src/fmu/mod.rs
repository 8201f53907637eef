//! The importer: opens any FMI 2.0 co-simulation unit and calls it safely.
//!
//! [`Fmu::open`] unpacks and reads the description; the library is loaded at the first [`Fmu::instantiate`]. The
//! unpacked folder and the library live as long as any instance.

mod anew;
mod archive;
mod attributes;
mod begin;
mod call;
pub(crate) mod control_word;
mod description;
mod doubts;
mod failure;
mod function;
mod instance;
pub(crate) mod library;
pub(crate) mod limits;
pub(crate) mod logger;
mod places;
mod probe;
mod read;
mod state;
pub(crate) mod workshop;

pub use begin::Begin;
pub use description::{
    BaseUnit, Causality, CoSimulation, DefaultExperiment, Description, Initial, Traits, UnitDefinition,
    Unknown, Variability, Variable,
};
pub(crate) use function::Function;
pub use instance::Instance;
pub use logger::LogLine;
pub use probe::platforms;
pub use state::SavedState;
pub use workshop::{Bench, discard_unpacked};

use crate::error::Error;
use crate::guard::Label;
use crate::isolation::Isolation;
use archive::Archive;
use library::Library;
use std::ffi::c_int;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

/// What a call answered (`fmi2Status`). A unit may return any integer, so this is no bare C enum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// All well.
    Ok,
    /// Not quite right, but the run can go on.
    Warning,
    /// The call had no effect; for a step: it ended early.
    Discard,
    /// This instance can't go on.
    Error,
    /// No instance of the unit can go on.
    Fatal,
    /// The answer comes later.
    Pending,
    /// Not a status of the standard.
    Unknown(c_int),
}

impl From<c_int> for Status {
    fn from(status: c_int) -> Self {
        match status {
            0 => Self::Ok,
            1 => Self::Warning,
            2 => Self::Discard,
            3 => Self::Error,
            4 => Self::Fatal,
            5 => Self::Pending,
            other => Self::Unknown(other),
        }
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Ok => f.write_str("ok"),
            Self::Warning => f.write_str("warning"),
            Self::Discard => f.write_str("discard"),
            Self::Error => f.write_str("error"),
            Self::Fatal => f.write_str("fatal"),
            Self::Pending => f.write_str("pending"),
            Self::Unknown(status) => write!(f, "unknown status {status}"),
        }
    }
}

/// A unit that can be instantiated. Clones share everything.
#[derive(Clone)]
pub struct Fmu {
    inner: Arc<Inner>,
    isolation: Option<Arc<Isolation>>,
    /// What is told to the library in place of its own GUID.
    guid: Option<Arc<str>>,
}

pub(crate) struct Inner {
    path: PathBuf,
    description: Description,
    /// What a person should know of the library.
    note: OnceLock<String>,
    // Dropped before the archive that holds its file.
    library: OnceLock<Library>,
    /// Whether a reset brings an instance back to where it began; copies know it of each other.
    restores: Arc<OnceLock<bool>>,
    /// How it takes values in initialization mode.
    late: Arc<begin::Late>,
    /// Whether the library had an instance already.
    used: AtomicBool,
    archive: Archive,
}

impl fmt::Debug for Fmu {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Fmu").field("path", &self.inner.path).finish_non_exhaustive()
    }
}

impl Fmu {
    /// Unpacks a `.fmu` file and reads its description.
    ///
    /// # Errors
    /// If the file can't be read, is no archive, or its description is not one of FMI 2.0 co-simulation.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, Error> {
        let path = path.as_ref();
        let (archive, description) = Archive::unpack(path)?;
        Ok(Self {
            inner: Arc::new(Inner {
                path: path.into(),
                description,
                note: OnceLock::new(),
                library: OnceLock::new(),
                restores: Arc::default(),
                late: Arc::default(),
                used: AtomicBool::new(false),
                archive,
            }),
            isolation: None,
            guid: None,
        })
    }

    /// The same unit, whose instances run in processes of their own.
    #[must_use]
    pub fn isolated(&self, isolation: Isolation) -> Self {
        Self { isolation: Some(Arc::new(isolation)), ..self.clone() }
    }

    /// Whether instances run in processes of their own, and how.
    pub(crate) fn isolation(&self) -> Option<&Isolation> {
        self.isolation.as_deref()
    }

    /// The GUID that the library is told.
    pub(crate) fn guid(&self) -> &str {
        self.guid.as_deref().unwrap_or(&self.inner.description.guid)
    }

    /// The `fmuResourceLocation` of `fmi2Instantiate`.
    pub(crate) fn resource_uri(&self) -> String {
        self.inner.archive.resource_uri()
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.inner.path
    }

    /// What the unit says of itself.
    pub fn description(&self) -> &Description {
        &self.inner.description
    }

    /// What is odd but stops nothing: in the description, and in the library once it was loaded.
    pub fn doubts(&self) -> Vec<String> {
        self.inner.note.get().cloned().into_iter().chain(doubts::of(self.description())).collect()
    }

    /// Makes an instance. Errors and warnings that the unit logs are collected. A unit that can be instantiated only once in a process
    /// gets a copy of its library for each further instance, also for one after another: what the first left behind in static memory,
    /// some free twice.
    ///
    /// # Errors
    /// If there are no binaries for this platform, the library can't be loaded, or the unit refuses.
    pub fn instantiate(&self, name: &str) -> Result<Instance, Error> {
        Instance::new(self.unused()?, name)
    }

    /// Itself, or a copy where the library had its only instance.
    fn unused(&self) -> Result<Self, Error> {
        let only_once = self.description().co_simulation.only_one_instance && self.isolation.is_none();
        if !only_once || !self.inner.used.swap(true, Ordering::Relaxed) {
            return Ok(self.clone());
        }
        let (archive, description) = Archive::unpack(self.path())?;
        let inner = Inner {
            path: self.inner.path.clone(),
            description,
            note: OnceLock::new(),
            library: OnceLock::new(),
            restores: self.inner.restores.clone(),
            late: self.inner.late.clone(),
            used: AtomicBool::new(true),
            archive,
        };
        Ok(Self { inner: Arc::new(inner), ..self.clone() })
    }

    /// The library, loaded if it was not; `label` is the instance that asks.
    fn library(&self, label: &'static Label) -> Result<&Library, Error> {
        let inner = &*self.inner;
        if let Some(library) = inner.library.get() {
            return Ok(library);
        }
        let library = Library::load(&self.library_file()?, &inner.path, label)?;
        Ok(inner.library.get_or_init(|| library))
    }

    /// The unpacked library.
    pub(crate) fn library_file(&self) -> Result<PathBuf, Error> {
        let inner = &*self.inner;
        let (path, note) = inner.archive.library(&inner.description.co_simulation.model_identifier);
        if !path.exists() {
            let reason = format!(
                "it holds no binaries/{}/{} (platforms inside: {})",
                archive::PLATFORMS[0],
                path.file_name().unwrap_or_default().to_string_lossy(),
                if inner.archive.platforms.is_empty() {
                    "none".into()
                } else {
                    inner.archive.platforms.join(", ")
                },
            );
            return Err(Error::Library { path: inner.path.clone(), reason });
        }
        if let Some(note) = note {
            // Set before, it is the same.
            let _ = inner.note.set(note);
        }
        Ok(path)
    }
}
