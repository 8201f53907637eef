//! The list of studies, in the order of the paper.

use crate::Study;

/// Every study; a new one is a file and a line here.
pub const STUDIES: &[Study] = &[];
