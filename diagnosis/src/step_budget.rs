//! How many steps of units a search may make: what ends it in the same place on a busy computer as on a quiet one, where the clock would not.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Steps that are left, counted by all threads together.
#[derive(Debug, Clone)]
pub(crate) struct StepBudget(Arc<Count>);

#[derive(Debug)]
struct Count {
    made: AtomicU64,
    most: u64,
}

impl StepBudget {
    /// So many steps.
    pub(crate) fn new(most: u64) -> Self {
        Self(Arc::new(Count { made: AtomicU64::new(0), most }))
    }

    /// Takes one step; false where none was left. Whoever hears that gives up all he did, so that it doesn't matter which thread it is.
    pub(crate) fn take(&self) -> bool {
        self.0.made.fetch_add(1, Ordering::Relaxed) < self.0.most
    }

    /// Whether more was asked for than there was.
    pub(crate) fn is_spent(&self) -> bool {
        self.0.made.load(Ordering::Relaxed) > self.0.most
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_the_last_step_is_made_and_the_one_after_it_is_not() {
        let budget = StepBudget::new(2);
        let taken = [budget.take(), budget.clone().take()];
        assert_eq!((taken, budget.is_spent()), ([true, true], false));
        assert!(!budget.take() && budget.is_spent());
    }
}
