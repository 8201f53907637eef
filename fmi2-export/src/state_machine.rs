//! Which call is legal when: the table of FMI 2.0 section 4.2.4, for a unit whose steps are never asynchronous.

use crate::table::{Causality, Variability, Variable};
use serde::{Deserialize, Serialize};

/// State of the calling sequence. `step failed`, `step canceled` and `step in progress` of the standard follow
/// only on `fmi2Discard` and `fmi2Pending`, which no unit of this crate answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    /// After `fmi2Instantiate` or `fmi2Reset`.
    Instantiated,
    /// Between `fmi2EnterInitializationMode` and `fmi2ExitInitializationMode`.
    Initialization,
    /// At a communication point.
    Step,
    /// After `fmi2Terminate`.
    Terminated,
    /// After a step or an initialisation that failed, or after a panic.
    Error,
}

impl Mode {
    /// What the standard calls it.
    pub fn name(self) -> &'static str {
        match self {
            Mode::Instantiated => "instantiated",
            Mode::Initialization => "initialization mode",
            Mode::Step => "step complete",
            Mode::Terminated => "terminated",
            Mode::Error => "error",
        }
    }
}

/// The calls that the standard's table tells apart; those with equal rows share one entry.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Call {
    /// `fmi2SetDebugLogging`, `fmi2Reset`, and `fmi2…FMUstate`.
    Always,
    /// `fmi2SetupExperiment`, `fmi2EnterInitializationMode`.
    Setup,
    /// `fmi2ExitInitializationMode`.
    ExitInitialization,
    /// `fmi2GetReal`, … and `fmi2GetDirectionalDerivative`.
    Get,
    /// `fmi2SetReal`, …: which variable may be set is the question of [`settable`].
    Set,
    /// `fmi2SetRealInputDerivatives`.
    SetInputDerivatives,
    /// `fmi2GetRealOutputDerivatives`.
    GetOutputDerivatives,
    /// `fmi2DoStep`, `fmi2Terminate`.
    Step,
    /// `fmi2CancelStep`: legal only while a step is in progress, so never.
    CancelStep,
    /// `fmi2GetStatus`, …
    GetStatus,
}

/// Whether `call` may be made in `mode`.
pub fn legal(call: Call, mode: Mode) -> bool {
    use Mode::{Error, Initialization, Instantiated, Step, Terminated};
    match call {
        Call::Always => true,
        Call::Setup => mode == Instantiated,
        Call::ExitInitialization => mode == Initialization,
        Call::Get => matches!(mode, Initialization | Step | Terminated | Error),
        Call::Set | Call::SetInputDerivatives => matches!(mode, Instantiated | Initialization | Step),
        Call::GetOutputDerivatives => matches!(mode, Step | Terminated | Error),
        Call::Step => mode == Step,
        Call::CancelStep => false,
        Call::GetStatus => matches!(mode, Step | Terminated),
    }
}

/// Whether a variable may be set in `mode`: conditions 1, 3 and 6 of the table.
///
/// *Deviation*: an input may be set before initialisation too. Condition 1 leaves inputs out, but FMPy sets their
/// start values there, and nothing can go wrong with it.
pub fn settable(variable: &Variable, mode: Mode) -> bool {
    match (variable.causality, mode) {
        (Causality::Output | Causality::Local, _) | (_, Mode::Terminated | Mode::Error) => false,
        (Causality::Input, _) | (Causality::Parameter, Mode::Instantiated | Mode::Initialization) => true,
        (Causality::Parameter, Mode::Step) => variable.variability == Variability::Tunable,
    }
}
