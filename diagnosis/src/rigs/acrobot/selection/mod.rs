//! Forward selection on one cut: screen linearly, refit the best few through the units, accept what survives the
//! bootstrap and the runs left out, drop what became superfluous, linearise again.

mod classes;
mod column_loss;
mod evaluation;
mod evidence;
#[cfg(test)]
pub(crate) mod examples;
mod folds;
pub(crate) mod policy;
mod refit;
mod replace_effect;
mod restarted_fit;
mod screen;
mod search;
mod settle;
mod shortlist;
mod start_points;
mod steadiness;
mod subsets;
mod switches;
mod tolerance;
mod trials;
mod value_steps;
mod without_effect;

pub use classes::{Alternative, CLASS, HOPELESS, Questioned, alternatives};
pub use column_loss::allowed_loss;
pub use evaluation::{Evaluation, all_perturbations, discrepancies};
pub use evidence::{discrepancy, lacking};
pub use folds::Folds;
pub use refit::refit;
pub use replace_effect::replace_effect;
pub use screen::{Hit, Screen, screen};
pub use search::{linearise, study, study_until};
pub use steadiness::{Steadiness, steadiness};
pub use value_steps::{ValueStep, value_steps};

use crate::rigs::acrobot::candidates::{Candidate, continuous};
use policy::SELECTION;

/// One step of the search, as the story tells it.
#[derive(Debug, Clone)]
pub struct Step {
    /// Best candidates of the screen with their gains.
    pub best: Vec<Hit>,
    /// Probability that the best is chance.
    pub p_value: f64,
    /// Who was accepted, if anyone.
    pub accepted: Option<usize>,
    /// Effects that took the place of all others, since they explain only together what is left.
    pub together: Vec<usize>,
    /// Who was dropped afterwards.
    pub dropped: Vec<usize>,
    /// Deviance before and after.
    pub deviance: (f64, f64),
    /// Mean square of the whitened residual before and after.
    pub mean_square: (f64, f64),
    /// Held-out squares before and after.
    pub held_out: (f64, f64),
}

/// The result on one cut.
pub struct Study {
    /// What was compared.
    pub name: &'static str,
    /// Accepted candidates in the order found.
    pub active: Vec<usize>,
    /// The nominal model.
    pub nominal: Evaluation,
    /// The final model with the columns of all candidates.
    pub last: Evaluation,
    /// All that could stand in the place of the effect that was accepted last, where they were asked for at the final model.
    pub class: Option<(usize, Vec<Alternative>)>,
    /// The last screen: its null distribution and the standard errors of everything.
    pub screen: Screen,
    /// The story.
    pub steps: Vec<Step>,
    /// Blocks left out together.
    pub folds: Folds,
    /// Which candidates the cut sees.
    pub seen: Vec<usize>,
    /// Size of the discrepancy that scattering timestamps explain.
    pub explained: f64,
    /// How well clocks of the log are known to go alike, s a second.
    pub tick_drift: f64,
    /// What the model lacks outweighs noise.
    pub discrepancy_dominated: bool,
    /// Standard deviation that noise alone gives a row of each signal, whatever the model.
    pub noise: Vec<f64>,
}

impl Study {
    /// The active candidates whose coordinate is continuous.
    pub fn continuous(&self, list: &[Candidate]) -> Vec<usize> {
        continuous(list, &self.active)
    }

    /// Whether the search ended since as many effects are on as it goes to, and not since nothing more was found.
    pub fn is_full(&self) -> bool {
        is_full(self.active.len(), self.steps.last())
    }
}

/// Whether a search of so many effects that ended with this step may have gone on.
fn is_full(active: usize, last: Option<&Step>) -> bool {
    let found = |step: &Step| step.accepted.is_some() || !step.together.is_empty();
    active >= SELECTION.search_most && last.is_some_and(found)
}

#[cfg(test)]
mod tests {
    use super::{Step, is_full};

    #[test]
    fn value_a_search_that_ends_with_six_effects_may_have_gone_on() {
        let step = |accepted, together| Step {
            best: Vec::new(),
            p_value: 0.0,
            accepted,
            together,
            dropped: Vec::new(),
            deviance: (0.0, 0.0),
            mean_square: (0.0, 0.0),
            held_out: (0.0, 0.0),
        };
        let one = step(Some(3), Vec::new());
        assert!(is_full(6, Some(&one)) && !is_full(5, Some(&one)));
        assert!(is_full(7, Some(&step(None, vec![1, 2]))));
        // it looked for more and found nothing, or began with all and looked for none
        assert!(!is_full(6, Some(&step(None, Vec::new()))) && !is_full(6, None));
    }
}
