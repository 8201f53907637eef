//! The controller unit.
