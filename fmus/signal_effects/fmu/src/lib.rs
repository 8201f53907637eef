//! The signal unit as a shared library: nothing but the FMI 2.0 functions.

fmi2_export::export!(signal_effects::SignalEffects);
