//! Fits of what was screened: where its parameters begin, and which of several fits best.

use super::Search;
use super::screen::{Screen, Screened};
use super::walk::replaces;
use crate::infer::Fit;
use crate::observe::Scale;
use crate::statistics::levels::FEW;

/// The whole number that lies nearest to a count moved `by` so much, another than the count itself and within its range. It goes no farther
/// than by its own size, or by a few: what a straight line says far off may be any number, and a unit makes as many cells of it.
fn counted(here: f64, by: f64, (least, most): (f64, f64)) -> f64 {
    let reach = here.abs().max(FEW as f64);
    let whole = if by.round() == 0.0 { by.signum() } else { by.round().clamp(-reach, reach) };
    let there = (here + whole).clamp(least, most);
    if there == here { here - whole } else { there }
}

impl Search<'_> {
    /// Tries the best of a screening about `from` beside `effects`; the best that was fitted.
    pub(super) fn best_fitted(
        &mut self,
        effects: &[usize],
        from: &Fit,
        screen: &Screen,
        tried: &[Screened],
    ) -> Option<(Vec<usize>, Fit)> {
        let one_by_one: Vec<&[Screened]> = tried.iter().map(std::slice::from_ref).collect();
        self.best_of(effects, from, screen, &one_by_one)
    }

    /// The same for several together, as many as are tried at a time.
    pub(super) fn best_of(
        &mut self,
        effects: &[usize],
        from: &Fit,
        screen: &Screen,
        tried: &[&[Screened]],
    ) -> Option<(Vec<usize>, Fit)> {
        let mut best: Option<(Vec<usize>, Fit)> = None;
        for together in tried {
            let mut with = effects.to_vec();
            let mut start = from.at.clone();
            for screened in *together {
                with.push(screened.chord.parameter);
                start.theta[screened.chord.parameter] = self.begin(&start.theta, screened);
            }
            // a chord begins elsewhere than the screening was made
            let same = Some(screen).filter(|_| start.theta == from.at.theta);
            let fitted = self.visit_from(&with, &start, same).map(|fit| self.with_counts_moved(&with, fit));
            match fitted {
                Ok(fit) if best.as_ref().is_none_or(|(_, known)| fit.deviance < known.deviance) => {
                    best = Some((with, fit));
                }
                Ok(_) => {}
                Err(error) => {
                    let names: Vec<&str> =
                        together.iter().map(|screened| self.name(screened.chord.parameter)).collect();
                    self.story.push(format!("{} can't be fitted: {error}", names.join(", ")));
                }
            }
        }
        best
    }

    /// Where the parameter of a screened effect begins: where it is, or along a chord.
    fn begin(&self, theta: &[f64], screened: &Screened) -> f64 {
        let Screened { chord, amount, .. } = *screened;
        let parameter = &self.engine.machine.parameters[chord.parameter];
        let here = theta[chord.parameter];
        let whole = chord.to - here;
        if chord.per != 1.0 {
            return here;
        }
        match parameter.scale {
            // what works by its size begins at the share of the chord that the data ask for
            Scale::Absolute | Scale::Relative => here + amount.clamp(0.0, 1.0) * whole,
            // a count goes on to the whole number that they ask for
            Scale::Count => counted(here, amount * whole, parameter.range),
            // a limit is one or isn't
            Scale::Switch | Scale::Saturation => chord.to,
        }
    }

    /// The fit with each count moved on by one, a few times, as long as that fits better: what a screening asks for is off by a share.
    fn with_counts_moved(&mut self, effects: &[usize], mut fit: Fit) -> Fit {
        let parameters = &self.engine.machine.parameters;
        let is_count = |effect: &&usize| parameters[**effect].scale == Scale::Count;
        let counts: Vec<usize> = effects.iter().filter(is_count).copied().collect();
        let mut key = effects.to_vec();
        key.sort_unstable();
        for count in counts {
            let (least, most) = self.engine.machine.parameters[count].range;
            for by in [-1.0, 1.0] {
                for _ in 0..FEW {
                    let mut start = fit.at.clone();
                    start.theta[count] += by;
                    // a unit is asked for nothing that its description forbids
                    if !(least..=most).contains(&start.theta[count]) {
                        break;
                    }
                    self.visited.remove(&key);
                    match self.visit(effects, &start) {
                        Ok(moved) if replaces(moved.deviance, fit.deviance) => fit = moved,
                        _ => break,
                    }
                }
                self.visited.insert(key.clone(), fit.clone());
            }
        }
        fit
    }
}

#[cfg(test)]
mod tests {
    use super::counted;

    #[test]
    fn value_a_count_begins_at_the_whole_number_that_the_data_ask_for() {
        let any = (f64::NEG_INFINITY, f64::INFINITY);
        assert_eq!(
            [counted(20.0, 2.8, any), counted(20.0, 9.7, any), counted(20.0, -2.8, any)],
            [23.0, 30.0, 17.0]
        );
        // no farther than by its own size, or by a few
        assert_eq!(
            [counted(20.0, 900.0, any), counted(20.0, -900.0, any), counted(1.0, 900.0, any)],
            [40.0, 0.0, 4.0]
        );
        // one that hardly moves is tried one off, and none goes beyond its range
        assert_eq!([counted(20.0, 0.2, any), counted(20.0, -0.2, any)], [21.0, 19.0]);
        assert_eq!([counted(20.0, 9.7, (1.0, 25.0)), counted(20.0, 0.2, (1.0, 20.0))], [25.0, 19.0]);
    }
}
