//! The course of an input over time.

use crate::observe::Hold;

/// A fed input over time, as logged.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// Times, s.
    pub time: Vec<f64>,
    /// A value for each of them, in the variable's unit.
    pub values: Vec<f64>,
    /// How it runs between them.
    pub hold: Hold,
}

impl Course {
    /// The value from a time on; before the first row its value.
    pub fn value(&self, time: f64) -> f64 {
        let after = self.time.partition_point(|t| *t <= time);
        let Some(place) = after.checked_sub(1) else { return self.values.first().copied().unwrap_or(0.0) };
        match (self.hold, self.time.get(after)) {
            (Hold::Linear, Some(next)) => {
                let share = (time - self.time[place]) / (next - self.time[place]);
                self.values[place] + share * (self.values[after] - self.values[place])
            }
            _ => self.values[place],
        }
    }
}
