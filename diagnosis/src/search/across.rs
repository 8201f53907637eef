//! Effects of one kind moved to the other side of the machine: a sensor that is late does what all inputs that are late by as much do, and
//! takes one name in the place of several. No screening sees it: with the first of these inputs found, the sensor is late by half as much.

use super::Search;
use crate::dynamics::machine::Role;
use crate::error::Error;
use crate::infer::Fit;
use crate::watch::Watch;
use std::collections::BTreeMap;

/// What ends early where time is up.
const ACROSS: &str = "the search for one sensor in the place of several inputs";

/// The sides of a machine that effects at ports stand on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Side {
    Inputs,
    Outputs,
}

/// Effects of one kind on one side, and all of that kind on the other side, which are fewer.
#[derive(Debug, Clone, PartialEq)]
struct Crossing {
    gone: Vec<usize>,
    instead: Vec<usize>,
}

/// Whether a model with so many names fewer explains as much: each name must gain `least`.
fn explains_as_much(fewer: usize, least: f64, (other, own): (f64, f64)) -> bool {
    other < own + least * fewer as f64
}

/// Which of the effects may be moved across, given side and kind of each parameter that stands at a port.
fn crossings(effects: &[usize], all: &BTreeMap<usize, (Side, &str)>) -> Vec<Crossing> {
    let at = |side: Side, kind: &str, of: &mut dyn Iterator<Item = usize>| -> Vec<usize> {
        of.filter(|index| all.get(index) == Some(&(side, kind))).collect()
    };
    let mut kinds: Vec<(Side, &str)> = effects.iter().filter_map(|effect| all.get(effect).copied()).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let crossing = |(side, kind): (Side, &str)| {
        let other = if side == Side::Inputs { Side::Outputs } else { Side::Inputs };
        let gone = at(side, kind, &mut effects.iter().copied());
        let instead = at(other, kind, &mut all.keys().copied().filter(|index| !effects.contains(index)));
        Crossing { gone, instead }
    };
    let fewer = |crossing: &Crossing| (1..crossing.gone.len()).contains(&crossing.instead.len());
    kinds.into_iter().map(crossing).filter(fewer).collect()
}

impl Search<'_> {
    /// The model with effects moved across where that takes fewer names and explains as much, and the search from there on.
    ///
    /// # Errors
    /// A unit failed at a place where it had worked.
    pub fn moved_across(
        &mut self,
        effects: Vec<usize>,
        here: Fit,
        watch: &mut Watch<'_>,
    ) -> Result<(Vec<usize>, Fit), Error> {
        let open: Vec<usize> = self.candidates.iter().copied().filter(|one| self.is_fitted(*one)).collect();
        let at_ports = || open.iter().filter_map(|index| Some((*index, self.port(*index)?))).collect();
        let crossings = crossings(&effects, &at_ports());
        for Crossing { gone, instead } in crossings {
            if watch.is_over(ACROSS) {
                break;
            }
            let mut start = here.at.clone();
            let mean = gone.iter().map(|index| start.theta[*index]).sum::<f64>() / gone.len() as f64;
            gone.iter()
                .for_each(|index| start.theta[*index] = self.engine.machine.parameters[*index].neutral);
            instead.iter().for_each(|index| start.theta[*index] = mean);
            let mut with: Vec<usize> =
                effects.iter().copied().filter(|index| !gone.contains(index)).collect();
            with.extend(&instead);
            let Some(fit) = self.visited_anew(&with, &start)? else { continue };
            let fewer = gone.len() - instead.len();
            if explains_as_much(fewer, self.policy.gain, (fit.deviance, here.deviance)) {
                let names =
                    |of: &[usize]| of.iter().map(|one| self.name(*one)).collect::<Vec<_>>().join(", ");
                let told =
                    format!("{} explains as much as {} with fewer names", names(&instead), names(&gone));
                self.story.push(told);
                let fit = self.with_linearised_runs(fit)?;
                return self.walk(with, fit, watch);
            }
        }
        Ok((effects, here))
    }

    /// The side and kind of a parameter that stands at a port. What has one name on both sides does the same there.
    fn port(&self, index: usize) -> Option<(Side, &'static str)> {
        match self.engine.machine.parameters[index].role {
            Role::Unit(_) => None,
            Role::Input(_, effect) => Some((Side::Inputs, effect.name())),
            Role::Output(_, effect) => Some((Side::Outputs, effect.name())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_several_inputs_give_way_to_fewer_sensors_of_their_kind() {
        let (input, output) = (Side::Inputs, Side::Outputs);
        let ports =
            [(0, (input, "delay")), (1, (input, "delay")), (2, (input, "gain")), (3, (output, "delay"))];
        let found = |effects: &[usize]| crossings(effects, &ports.into_iter().collect());
        assert_eq!(found(&[0, 1, 2]), [Crossing { gone: vec![0, 1], instead: vec![3] }]);
        // one for one is what a swap is for; two kinds are no kind; who is there already takes nobody's place
        assert!([vec![0], vec![0, 2], vec![0, 1, 3]].iter().all(|effects| found(effects).is_empty()));
        // two sensors for two inputs are no fewer
        let two: BTreeMap<usize, (Side, &str)> = ports.into_iter().chain([(4, (output, "delay"))]).collect();
        assert!(crossings(&[0, 1], &two).is_empty());
        assert_eq!(
            crossings(&[3, 4], &[ports[0], ports[3], (4, (output, "delay"))].into_iter().collect()).len(),
            1
        );
    }

    #[test]
    fn value_a_name_that_goes_may_take_what_a_name_must_gain() {
        let takes = |other: f64| explains_as_much(1, 20.0, (other, 100.0));
        assert_eq!([99.0, 119.0, 121.0].map(takes), [true, true, false]);
    }
}
