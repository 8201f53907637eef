//! Limits that are moved on: what a saturation or a rate limit cuts bends with it, so that a fit beside process noise may end next to the valley
//! in which the model needs none.

use super::Search;
use super::walk::replaces;
use crate::dynamics::Machine;
use crate::error::Error;
use crate::infer::{At, Fit};
use crate::observe::Scale;
use crate::statistics::levels::{FEW, HALF, SMALL};

impl Search<'_> {
    /// The fit of these effects with its limits moved on, where that is a better one.
    pub fn limits_moved(&mut self, effects: &[usize], fit: &Fit) -> Option<Fit> {
        let machine = &self.engine.machine;
        let moved = with_limits_moved(machine, effects, fit.clone(), |at| {
            self.visited_anew(effects, at)?.ok_or_else(|| Error::Model("it can't be fitted there".into()))
        });
        (moved.deviance < fit.deviance).then_some(moved)
    }
}

/// The best of the fits that begin with a limit a few shares lower or higher than a fit has it.
pub fn with_limits_moved(
    machine: &Machine,
    effects: &[usize],
    fit: Fit,
    mut refit: impl FnMut(&At) -> Result<Fit, Error>,
) -> Fit {
    let mut best = fit;
    for &limit in effects {
        let described = &machine.parameters[limit];
        let here = best.at.theta[limit];
        if described.scale != Scale::Saturation || here == 0.0 {
            continue;
        }
        let (least, most) = described.range;
        let from = best.at.clone();
        for by in places().map(|share| share * here).filter(|to| (least..=most).contains(to)) {
            let mut start = from.clone();
            start.theta[limit] = by;
            // what can't be fitted there is no better
            best = match refit(&start) {
                Ok(moved) if replaces(moved.deviance, best.deviance) => moved,
                _ => best,
            };
        }
    }
    best
}

/// Shares of a limit at which it is tried again: a fit from a few per cent beside the valley reaches it.
fn places() -> impl Iterator<Item = f64> {
    let step = 1.0 - HALF * SMALL;
    (1..=FEW + 1).flat_map(move |count| {
        let by = step.powi(count as i32);
        [by, 1.0 / by]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_a_limit_is_tried_in_steps_of_a_twentieth_to_a_fifth() {
        let all: Vec<f64> = places().collect();
        assert!((all[0] - 0.95).abs() < 1e-12 && (all[1] - 1.0 / 0.95).abs() < 1e-12);
        let span =
            all.iter().fold((1.0f64, 1.0f64), |(low, high), place| (low.min(*place), high.max(*place)));
        assert!(span.0 < 0.82 && span.1 > 1.22, "{span:?}");
    }
}
