//! The shared library of a unit: its `fmi2…` functions by name, looked up once.

mod lasting;

use crate::error::Error;
use crate::fmu::Function;
use crate::fmu::control_word;
use crate::guard::{self, Label};
use lasting::Before;
use std::ffi::{c_char, c_int, c_uint, c_void};
use std::mem::ManuallyDrop;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// Libraries find their own symbols before those of this program.
static OWN_FIRST: AtomicBool = AtomicBool::new(false);

/// From now on libraries find their own symbols before those of this program, which has some of the same names.
pub(crate) fn prefer_own_symbols() {
    OWN_FIRST.store(true, Ordering::Relaxed);
}

pub(crate) type Component = *mut c_void;
pub(crate) type State = *mut c_void;

/// `fmi2CallbackFunctions`. The standard has the unit copy the pointer, so it lives as long as the instance.
#[repr(C)]
pub(crate) struct Callbacks {
    pub(crate) logger:
        unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char, ...),
    pub(crate) allocate: unsafe extern "C" fn(usize, usize) -> *mut c_void,
    pub(crate) free: unsafe extern "C" fn(*mut c_void),
    pub(crate) step_finished: Option<unsafe extern "C" fn(*mut c_void, c_int)>,
    pub(crate) environment: *mut c_void,
}

type Plain = unsafe extern "C" fn(Component) -> c_int;
pub(crate) type Get<T> = unsafe extern "C" fn(Component, *const c_uint, usize, *mut T) -> c_int;
pub(crate) type Set<T> = unsafe extern "C" fn(Component, *const c_uint, usize, *const T) -> c_int;

macro_rules! functions {
    (needed { $( $need:ident = $need_symbol:literal : $need_type:ty ; )* }
     optional { $( $opt:ident = $opt_symbol:literal : $opt_type:ty ; )* }) => {
        /// The functions of a unit. Copied into each instance, so that a call costs one load.
        #[derive(Clone, Copy)]
        pub(crate) struct Functions {
            $( pub(crate) $need: $need_type, )*
            $( pub(crate) $opt: Option<$opt_type>, )*
        }

        impl Functions {
            /// Looks all of them up.
            ///
            /// # Safety
            /// The library must outlive the result and define the symbols with the types of `fmi2FunctionTypes.h`.
            unsafe fn find(library: &libloading::Library) -> Result<Self, &'static str> {
                Ok(Self {
                    // SAFETY: the types are those of the standard's header.
                    $( $need: *unsafe { library.get::<$need_type>($need_symbol) }.map_err(|_| $need_symbol)?, )*
                    // SAFETY: as above.
                    $( $opt: unsafe { library.get::<$opt_type>($opt_symbol) }.ok().map(|symbol| *symbol), )*
                })
            }
        }
    };
}

functions! {
    needed {
        instantiate = "fmi2Instantiate": unsafe extern "C" fn(
            *const c_char, c_int, *const c_char, *const c_char, *const Callbacks, c_int, c_int) -> Component;
        free_instance = "fmi2FreeInstance": unsafe extern "C" fn(Component);
        setup_experiment = "fmi2SetupExperiment":
            unsafe extern "C" fn(Component, c_int, f64, f64, c_int, f64) -> c_int;
        enter_initialization = "fmi2EnterInitializationMode": Plain;
        exit_initialization = "fmi2ExitInitializationMode": Plain;
        terminate = "fmi2Terminate": Plain;
        get_real = "fmi2GetReal": Get<f64>;
        set_real = "fmi2SetReal": Set<f64>;
        do_step = "fmi2DoStep": unsafe extern "C" fn(Component, f64, f64, c_int) -> c_int;
    }
    optional {
        get_version = "fmi2GetVersion": unsafe extern "C" fn() -> *const c_char;
        set_debug_logging = "fmi2SetDebugLogging":
            unsafe extern "C" fn(Component, c_int, usize, *const *const c_char) -> c_int;
        reset = "fmi2Reset": Plain;
        get_integer = "fmi2GetInteger": Get<c_int>;
        set_integer = "fmi2SetInteger": Set<c_int>;
        get_boolean = "fmi2GetBoolean": Get<c_int>;
        set_boolean = "fmi2SetBoolean": Set<c_int>;
        get_string = "fmi2GetString": Get<*const c_char>;
        set_string = "fmi2SetString": Set<*const c_char>;
        get_state = "fmi2GetFMUstate": unsafe extern "C" fn(Component, *mut State) -> c_int;
        set_state = "fmi2SetFMUstate": unsafe extern "C" fn(Component, State) -> c_int;
        free_state = "fmi2FreeFMUstate": unsafe extern "C" fn(Component, *mut State) -> c_int;
        state_size = "fmi2SerializedFMUstateSize": unsafe extern "C" fn(Component, State, *mut usize) -> c_int;
        serialize_state = "fmi2SerializeFMUstate":
            unsafe extern "C" fn(Component, State, *mut c_char, usize) -> c_int;
        deserialize_state = "fmi2DeSerializeFMUstate":
            unsafe extern "C" fn(Component, *const c_char, usize, *mut State) -> c_int;
        directional_derivative = "fmi2GetDirectionalDerivative": unsafe extern "C" fn(
            Component, *const c_uint, usize, *const c_uint, usize, *const f64, *mut f64) -> c_int;
        set_input_derivatives = "fmi2SetRealInputDerivatives":
            unsafe extern "C" fn(Component, *const c_uint, usize, *const c_int, *const f64) -> c_int;
        get_output_derivatives = "fmi2GetRealOutputDerivatives":
            unsafe extern "C" fn(Component, *const c_uint, usize, *const c_int, *mut f64) -> c_int;
        get_boolean_status = "fmi2GetBooleanStatus": unsafe extern "C" fn(Component, c_int, *mut c_int) -> c_int;
        get_real_status = "fmi2GetRealStatus": unsafe extern "C" fn(Component, c_int, *mut f64) -> c_int;
    }
}

/// A loaded library with its functions.
pub(crate) struct Library {
    pub(crate) functions: Functions,
    /// The instance that it was loaded for.
    label: &'static Label,
    before: Before,
    // Unloaded on drop, after the last instance is gone (each holds the unit).
    library: ManuallyDrop<libloading::Library>,
}

impl Library {
    pub(crate) fn load(path: &Path, unit: &Path, label: &'static Label) -> Result<Self, Error> {
        let failed = |reason: String| Error::Library { path: unit.into(), reason };
        let before = Before::now();
        // A library's initialisers may set how reals are rounded; that is for the unit's own functions to do.
        let opened = guard::loading(label, || control_word::kept(|| open(path)));
        let library = opened.map_err(|error| {
            // The bare text of the loader says which symbol or library is missing.
            let mut reason = std::error::Error::source(&error).map_or_else(|| error.to_string(), ToString::to_string);
            if reason.contains("undefined symbol: _Py") || reason.contains("undefined symbol: Py") {
                // Units that bring Python code expect the master to be Python.
                reason.push_str(
                    " (the unit needs a Python interpreter in this process: start with \
                     LD_PRELOAD=$(python3 -c \"import sysconfig as s; print(s.get_config_var('LIBDIR') + '/' + s.get_config_var('INSTSONAME'))\") \
                     and PYTHONHOME or PYTHONPATH set to an installation that has its packages)",
                );
            }
            if let Some(processor) = of_another_processor(path) {
                reason = format!("the library is for {processor}, this program for {}", std::env::consts::ARCH);
            }
            if forbids_programs(path) {
                reason.push_str(" (units are unpacked on a file system that forbids programs, noexec: TMPDIR names another folder)");
            }
            failed(reason)
        })?;
        // SAFETY: the functions are kept beside the library.
        let functions = unsafe { Functions::find(&library) }
            .map_err(|symbol| failed(format!("the library lacks the function {symbol}")))?;
        if let Some(get_version) = functions.get_version {
            // SAFETY: fmi2GetVersion takes nothing and returns a static string.
            let call = || unsafe { get_version() };
            let version = crate::fmu::logger::owned(guard::around(label, Function::GetVersion, call));
            if !version.starts_with("2.") {
                return Err(failed(format!("the library is of FMI version {version}; needed is 2.0")));
            }
        }
        Ok(Self { functions, label, before, library: ManuallyDrop::new(library) })
    }
}

impl Drop for Library {
    fn drop(&mut self) {
        if self.before.left_something(self.functions.instantiate as *const c_void) {
            // What runs, or is called, later finds its code.
            return;
        }
        // SAFETY: not used afterwards.
        guard::loading(self.label, || unsafe { ManuallyDrop::drop(&mut self.library) });
    }
}

/// The processor of an ELF library that is for another one, for which the loader has no good word: "No such file or directory".
fn of_another_processor(path: &Path) -> Option<String> {
    use std::io::Read as _;
    /// Machines by their numbers in an ELF head (System V ABI, `e_machine`).
    const MACHINES: [(u16, &str); 6] =
        [(3, "x86"), (40, "arm"), (62, "x86_64"), (183, "aarch64"), (21, "powerpc64"), (243, "riscv64")];
    let mut head = [0; 20];
    std::fs::File::open(path).ok()?.read_exact(&mut head).ok()?;
    let machine = match (&head[..4], head[5]) {
        (b"\x7fELF", 1) => u16::from_le_bytes([head[18], head[19]]),
        (b"\x7fELF", 2) => u16::from_be_bytes([head[18], head[19]]),
        _ => return None,
    };
    let name = MACHINES.iter().find(|(number, _)| *number == machine).map(|(_, name)| *name);
    let name = name.map_or_else(|| format!("processor {machine} of ELF's list"), str::to_owned);
    (name != std::env::consts::ARCH).then_some(name)
}

/// Whether nothing that lies there may be run, and no library loaded.
#[cfg(target_os = "linux")]
fn forbids_programs(path: &Path) -> bool {
    use std::os::unix::ffi::OsStrExt as _;
    let Ok(path) = std::ffi::CString::new(path.as_os_str().as_bytes()) else { return false };
    // SAFETY: a path that ends in zero, and a structure of plain data that the call fills.
    unsafe {
        let mut of: libc::statvfs = std::mem::zeroed();
        libc::statvfs(path.as_ptr(), &mut of) == 0 && of.f_flag & libc::ST_NOEXEC != 0
    }
}

/// Others say it by themselves.
#[cfg(not(target_os = "linux"))]
fn forbids_programs(_: &Path) -> bool {
    false
}

fn open(path: &Path) -> Result<libloading::Library, libloading::Error> {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    if OWN_FIRST.load(Ordering::Relaxed) {
        use libloading::os::unix::{Library, RTLD_LAZY, RTLD_LOCAL};
        // SAFETY: as below.
        let library = unsafe { Library::open(Some(path), RTLD_LAZY | RTLD_LOCAL | libc::RTLD_DEEPBIND) };
        return library.map(Into::into);
    }
    // SAFETY: loading runs the library's initialisers; running the unit is what the user asked for.
    unsafe { libloading::Library::new(path) }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::{OWN_FIRST, Ordering, forbids_programs, open, prefer_own_symbols};
    use std::path::Path;

    #[test]
    fn law_a_library_opens_with_its_own_symbols_first_as_well() {
        for own_first in [false, true] {
            if own_first {
                prefer_own_symbols();
            }
            assert_eq!(OWN_FIRST.load(Ordering::Relaxed), own_first);
            open(Path::new("libm.so.6")).expect("every program for Linux with this C library has it");
            assert!(open(Path::new("/not/there.so")).is_err());
        }
        OWN_FIRST.store(false, Ordering::Relaxed);
    }

    #[test]
    fn law_a_file_system_forbids_programs_where_it_is_mounted_so() {
        let mounts = std::fs::read_to_string("/proc/mounts").expect("Linux has it");
        let mounted = mounts.lines().filter_map(|line| {
            let mut fields = line.split(' ').skip(1);
            Some((fields.next()?, fields.nth(1)?.split(',').any(|option| option == "noexec")))
        });
        // The last one that is mounted somewhere is the one that is there; names with a blank are spelt otherwise.
        let all: std::collections::BTreeMap<&str, bool> = mounted.collect();
        for (folder, noexec) in all.into_iter().filter(|(folder, _)| Path::new(folder).is_dir()) {
            assert_eq!(forbids_programs(Path::new(folder)), noexec, "{folder}");
        }
        let program = std::env::current_exe().expect("a program");
        assert!(!forbids_programs(&program), "it runs");
        assert!(!forbids_programs(Path::new("/not/there")));
    }
}
