//! The camera unit.
