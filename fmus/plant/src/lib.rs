//! The plant unit.
