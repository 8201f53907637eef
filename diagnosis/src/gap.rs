//! How far a gap between model and data is closed: of the model with its effects, and of a labelled correction beside them.

use serde::Serialize;

/// How far the gap closes.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(Default))]
pub struct Gap {
    /// Root mean square of the nominal model's residual; not a number (null where it is written) where no row could be followed.
    pub before: f64,
    /// Of the amended model's residual; likewise.
    pub after: f64,
    /// Of what noise alone leaves.
    pub floor: f64,
    /// 1 - (after² - floor²)/(before² - floor²); nothing where no gap stands above the floor.
    pub closed: Option<f64>,
    /// Runs (or stretches of the only one) that the model which is judged on them never saw: for each the search was repeated without it.
    pub held_out_runs: Vec<String>,
    /// Where no search was repeated: runs that values were not fitted to, each in turn, while effects were chosen with all of them.
    pub cross_validated: Vec<String>,
    /// What was compared.
    pub signal: String,
    /// Unit of the three.
    pub unit: String,
}

impl Gap {
    /// Whether any row tells of it.
    pub fn is_told(&self) -> bool {
        self.before.is_finite()
    }

    /// The share that is closed in percent, as people are told it: what is left below noise is as good as noise.
    pub fn percent(&self) -> Option<f64> {
        self.closed.map(|closed| 100.0 * closed.min(1.0))
    }
}

/// How far it closes the gap that the effects leave, on runs left out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Closing {
    /// Root mean square of the lacking torque without it, N·m.
    pub before: f64,
    /// With it.
    pub after: f64,
    /// What noise alone gives.
    pub floor: f64,
    /// 1 - (after² - floor²)/(before² - floor²).
    pub closed: f64,
    /// What was left out, each in turn.
    pub held_out_runs: Vec<String>,
}

impl Closing {
    /// The share that is closed in percent, as people are told it: what is left below noise is as good as noise.
    pub fn percent(&self) -> f64 {
        100.0 * self.closed.min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_people_are_told_no_more_than_all_of_it() {
        let gap = |closed| Gap { closed, ..Gap::default() }.percent();
        // the file has what the formula gives: noise scatters
        assert_eq!([None, Some(0.25), Some(1.008)].map(gap), [None, Some(25.0), Some(100.0)]);
        let (before, after, floor) = (1.0, 0.1, 0.2);
        let all = Closing { before, after, floor, closed: 1.03, held_out_runs: Vec::new() };
        assert_eq!(all.percent(), 100.0);
    }
}
