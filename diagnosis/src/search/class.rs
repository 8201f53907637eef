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
}

impl Search<'_> {
    /// All alternatives to each effect, the effect itself first unless another fits better by chance.
    ///
    /// # Errors
    /// A unit failed.
    pub fn alternatives(
        &mut self,
        effects: &[usize],
        here: &Fit,
        watch: &mut Watch<'_>,
    ) -> Result<Vec<Vec<Alternative>>, Error> {
        let mut all = Vec::new();
        for (place, own) in effects.iter().enumerate() {
            // without time an effect stands for itself
            all.push(if watch.is_over("what else could stand in an effect's place") {
                vec![Alternative { parameter: *own, loss: 0.0, value: here.at.theta[*own] }]
            } else {
                self.alternatives_to(effects, here, place)?
            });
        }
        Ok(all)
    }

    fn alternatives_to(
        &mut self,
        effects: &[usize],
        here: &Fit,
        place: usize,
    ) -> Result<Vec<Alternative>, Error> {
        let mut without = effects.to_vec();
        let own = without.remove(place);
        let mut start = here.at.clone();
        start.theta[own] = self.engine.machine.parameters[own].neutral;
        let less = self.visit(&without, &start)?;
        let screen = linearised(self.engine, &less, &self.others(&without))?;
        let ranked = ranked(self.engine, &less, &screen, self.sizes, &self.policy);
        let gained = less.deviance - here.deviance;
        // a linear gain is off by a share of itself where the effect is large
        let worth = ranked.iter().filter(|screened| {
            screened.chord.parameter != own && screened.gain > 0.7 * gained - 3.0 * self.policy.class
        });
        let tried: Vec<Screened> = worth.take(2 * self.policy.fitted).copied().collect();
        let mut list = vec![Alternative { parameter: own, loss: here.deviance, value: here.at.theta[own] }];
        for screened in tried {
            if let Some((_, fit)) = self.best(&without, &less, &screen, &[screened]) {
                let parameter = screened.chord.parameter;
                list.push(Alternative { parameter, loss: fit.deviance, value: fit.at.theta[parameter] });
            }
        }
        let least = list.iter().map(|one| one.loss).fold(f64::INFINITY, f64::min);
        list.iter_mut().for_each(|one| one.loss -= least);
        list.retain(|one| one.parameter == own || one.loss < 6.0 * self.policy.class);
        list.sort_by(|a, b| a.loss.total_cmp(&b.loss));
        Ok(list)
    }
}
