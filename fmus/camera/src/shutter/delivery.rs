//! Results on their way: each leaves T_delay after the end of its exposure, in the order of the frames.

use super::clock::has_come;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// Something that will be delivered.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Delivery<T> {
    /// When, in s.
    pub due: f64,
    /// What.
    pub result: T,
}

/// Results on their way.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Queue<T> {
    waiting: VecDeque<Delivery<T>>,
}

impl<T> Default for Queue<T> {
    fn default() -> Self {
        Self { waiting: VecDeque::new() }
    }
}

impl<T> Queue<T> {
    /// Sends a result. It never overtakes an earlier one, even if the delay has shrunk meanwhile.
    pub fn send(&mut self, due: f64, result: T) {
        let due = self.waiting.back().map_or(due, |last| due.max(last.due));
        self.waiting.push_back(Delivery { due, result });
    }

    /// The next result that is due by `now`.
    pub fn receive(&mut self, now: f64) -> Option<T> {
        if !has_come(self.waiting.front()?.due, now) {
            return None;
        }
        self.waiting.pop_front().map(|delivery| delivery.result)
    }

    /// How many results are on their way.
    pub fn len(&self) -> usize {
        self.waiting.len()
    }

    /// Whether none is.
    pub fn is_empty(&self) -> bool {
        self.waiting.is_empty()
    }
}
