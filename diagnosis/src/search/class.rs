//! What else fits as well in an effect's place: the indistinguishable set, by refitting.

use super::screen::{Screened, linearised, ranked};
use super::walk::Search;
use crate::error::Error;
use crate::infer::Fit;
use crate::watch::Watch;

/// One that could stand in an effect's place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alternative {
    /// The parameter.
    pub parameter: usize,
    /// Deviance with it in place, over the least.
    pub loss: f64,
    /// Its value there.
    pub value: f64,
    /// Standard deviation of the value there.
    pub deviation: f64,
}

/// An effect's class, the best of it first.
type Class = Vec<Alternative>;

impl Alternative {
    /// An effect as it was fitted, nothing lost.
    pub fn as_fitted(parameter: usize, fit: &Fit) -> Self {
        let deviation = fit.robust_deviation(parameter);
        Self { parameter, loss: 0.0, value: fit.at.theta[parameter], deviation }
    }
}

/// Loss (deviance) of a name that was no member of an earlier class: the truth is left out as seldom as noise goes beyond this deviance.
fn excluded(class: f64) -> f64 {
    -2.0 * libm::log(libm::erfc((class / 2.0).sqrt()))
}

/// Whether a name may stand in the place of an effect that gains `own`, by the deviance that it gains where it was screened: linear gains are
/// off by a third, and those of a weak effect by what noises take over. What may not is not fitted.
fn is_worth_a_fit(gain: f64, own: f64, class: f64) -> bool {
    gain > 0.7 * own - 3.0 * class
}

/// Whether a name that loses so much deviance is listed beside the class: the probabilities of the class leave out one in e^27.
fn is_listed(loss: f64, class: f64) -> bool {
    loss < 6.0 * class
}

impl Search<'_> {
    /// All alternatives to each effect. Where another fits better in its place it takes that place: what is named is what is fitted.
    ///
    /// # Errors
    /// A unit failed.
    pub fn alternatives(
        &mut self,
        mut effects: Vec<usize>,
        mut here: Fit,
        watch: &mut Watch<'_>,
    ) -> Result<(Vec<usize>, Fit, Vec<Class>), Error> {
        let mut all = Vec::new();
        for place in 0..effects.len() {
            // without time an effect stands for itself
            let class = if watch.is_over("what else could stand in an effect's place") {
                vec![Alternative::as_fitted(effects[place], &here)]
            } else {
                self.alternatives_to(&effects, &here, place)?
            };
            let class = self.weighed(class, effects[place]);
            if class[0].parameter != effects[place] {
                effects[place] = class[0].parameter;
                let fitted = self.visit(&effects, &here.at)?;
                here = self.with_linearised_runs(fitted)?;
            }
            all.push(class);
        }
        Ok((effects, here, all))
    }

    /// A class with what an earlier diagnosis told apart.
    fn weighed(&mut self, mut class: Class, own: usize) -> Class {
        let Some(earlier) = self.earlier else { return class };
        let parameters = &self.engine.machine.parameters;
        let named = |one: &Alternative| (parameters[one.parameter].name.as_str(), one.loss);
        let others: Vec<(&str, f64)> = class.iter().map(named).collect();
        let Some((losses, known)) = earlier.weighed(&others, self.policy.class, excluded(self.policy.class))
        else {
            return class;
        };
        class.iter_mut().zip(losses).for_each(|(one, loss)| one.loss = loss);
        class.sort_by(|a, b| a.loss.total_cmp(&b.loss));
        self.story.push(format!(
            "the earlier diagnosis left {} open where {} was found here: both count",
            known.join(" or "),
            parameters[own].name
        ));
        class
    }

    fn alternatives_to(
        &mut self,
        effects: &[usize],
        here: &Fit,
        place: usize,
    ) -> Result<Vec<Alternative>, Error> {
        let own = effects[place];
        let Some((without, less)) = self.without_effect(effects, here, place)? else {
            return Ok(vec![Alternative::as_fitted(own, here)]);
        };
        let screen = linearised(self.engine, &less, &self.others(&without))?;
        let ranked = ranked(self.engine, &less, &screen, &self.sizes, &self.policy);
        let gained = less.deviance - here.deviance;
        // a linear gain is off by a share of itself where the effect is large: its own counts for what it is worth
        let linear = ranked.iter().find(|screened| screened.chord.parameter == own);
        let gained = linear.map_or(gained, |screened| gained.min(screened.gain));
        let worth = ranked.iter().filter(|screened| {
            screened.chord.parameter != own && is_worth_a_fit(screened.gain, gained, self.policy.class)
        });
        let tried: Vec<Screened> = worth.take(2 * self.policy.fitted).copied().collect();
        let mut list = vec![Alternative { loss: here.deviance, ..Alternative::as_fitted(own, here) }];
        for screened in tried {
            if let Some((_, fit)) = self.best_fitted(&without, &less, &screen, &[screened]) {
                let other = Alternative::as_fitted(screened.chord.parameter, &fit);
                list.push(Alternative { loss: fit.deviance, ..other });
            }
        }
        for (delay, fit) in self.late_sensors(&without, &less)?.into_iter().filter(|(delay, _)| *delay != own)
        {
            list.retain(|one| one.parameter != delay);
            list.push(Alternative { loss: fit.deviance, ..Alternative::as_fitted(delay, &fit) });
        }
        let least = list.iter().map(|one| one.loss).fold(f64::INFINITY, f64::min);
        list.iter_mut().for_each(|one| one.loss -= least);
        list.retain(|one| one.parameter == own || is_listed(one.loss, self.policy.class));
        list.sort_by(|a, b| a.loss.total_cmp(&b.loss));
        Ok(list)
    }
}

#[cfg(test)]
mod tests {
    use super::{excluded, is_listed, is_worth_a_fit};

    #[test]
    fn value_what_an_earlier_class_left_out_stays_out_unless_the_new_data_are_clearly_for_it() {
        // three standard deviations: once in 370.4 sets (scipy.stats.norm.sf, twice)
        assert!((excluded(9.0) - 2.0 * libm::log(370.398)).abs() < 1e-5);
        assert!(excluded(9.0) > 9.0 + 2.0);
    }

    #[test]
    fn value_names_that_may_stand_in_an_effects_place_are_fitted() {
        // of a strong effect three quarters of its gain by the linear model may be all of it, and two thirds are not
        assert!(is_worth_a_fit(7_500.0, 10_000.0, 9.0) && !is_worth_a_fit(6_600.0, 10_000.0, 9.0));
        // beside a weak one anything is tried
        assert!(is_worth_a_fit(1.0, 36.0, 9.0) && !is_worth_a_fit(1.0, 45.0, 9.0));
        // seven deviations from the best are told by name, eight are not
        assert!(is_listed(49.0, 9.0) && !is_listed(64.0, 9.0));
    }
}
