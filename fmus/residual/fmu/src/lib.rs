//! The residual unit as a shared library: nothing but the FMI 2.0 functions.

fmi2_export::export!(residual::Residual);
