//! Where things stand in a description: variables by name, entries of `ModelStructure` by variable. Small beside what they
//! find: places only, no names of their own.

use crate::fmu::description::{Unknown, Variable};
use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};

/// The places of variables in a table by the hash of their names, each as near behind its own cell as there was room.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Names {
    /// One more than a place; 0 is an empty cell. At least half of the cells are, so that walks are short.
    cells: Vec<u32>,
}

impl Names {
    /// The table, and the names that several variables have: of these the last one is found.
    pub(super) fn of(variables: &[Variable]) -> (Self, HashSet<String>) {
        let mut names = Self { cells: vec![0; (2 * variables.len()).next_power_of_two().max(2)] };
        let mut repeated = HashSet::new();
        for (place, variable) in variables.iter().enumerate() {
            let cell = names.cell(&variable.name, variables);
            if names.cells[cell] != 0 {
                repeated.insert(variable.name.clone());
            }
            names.cells[cell] = place as u32 + 1; // 2³² variables don't fit the memory
        }
        (names, repeated)
    }

    pub(super) fn find(&self, name: &str, variables: &[Variable]) -> Option<usize> {
        (self.cells[self.cell(name, variables)] as usize).checked_sub(1)
    }

    /// Where a name stands, or the empty cell that it would get.
    fn cell(&self, name: &str, variables: &[Variable]) -> usize {
        let mut hasher = DefaultHasher::new();
        name.hash(&mut hasher);
        let last = self.cells.len() - 1;
        let mut at = hasher.finish() as usize & last;
        while self.cells[at] != 0 && variables[self.cells[at] as usize - 1].name != name {
            at = (at + 1) & last;
        }
        at
    }
}

/// The order of entries of `ModelStructure` by variable; those of one variable as they stand.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Places(Vec<u32>);

impl Places {
    pub(super) fn of(unknowns: &[Unknown]) -> Self {
        let mut order: Vec<u32> = (0..unknowns.len() as u32).collect();
        order.sort_by_key(|&at| unknowns[at as usize].variable);
        Self(order)
    }

    /// The first entry of a variable.
    pub(super) fn find<'a>(&self, variable: usize, unknowns: &'a [Unknown]) -> Option<&'a Unknown> {
        let at = self.0.partition_point(|&at| unknowns[at as usize].variable < variable);
        self.0.get(at).map(|&at| &unknowns[at as usize]).filter(|unknown| unknown.variable == variable)
    }
}
