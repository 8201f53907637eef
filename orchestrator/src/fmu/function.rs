//! The calls into a unit by number: what is under way, for those who must say it when a unit takes the process down, and
//! for units in another process.

/// Numbers and names of the calls.
macro_rules! functions {
    ($( $name:ident, )*) => {
        /// A call into a unit.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[repr(u8)]
        pub(crate) enum Function {
            $( $name, )*
        }

        impl Function {
            /// As the standard calls it.
            pub(crate) fn name(self) -> &'static str {
                match self {
                    $( Self::$name => concat!("fmi2", stringify!($name)), )*
                }
            }

            /// By its number.
            pub(crate) fn of(number: u8) -> Option<Self> {
                const ALL: &[Function] = &[ $( Function::$name, )* ];
                ALL.get(usize::from(number)).copied()
            }
        }
    };
}

functions! {
    Instantiate,
    FreeInstance,
    SetDebugLogging,
    SetupExperiment,
    EnterInitializationMode,
    ExitInitializationMode,
    DoStep,
    Terminate,
    Reset,
    GetReal,
    GetInteger,
    GetBoolean,
    GetString,
    SetReal,
    SetInteger,
    SetBoolean,
    SetString,
    GetFMUstate,
    SetFMUstate,
    FreeFMUstate,
    SerializedFMUstateSize,
    SerializeFMUstate,
    DeSerializeFMUstate,
    GetDirectionalDerivative,
    SetRealInputDerivatives,
    GetRealOutputDerivatives,
    GetRealStatus,
    GetBooleanStatus,
    GetVersion,
}
