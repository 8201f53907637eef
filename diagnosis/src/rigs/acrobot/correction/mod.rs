//! A residual that no listed effect takes away, as labelled torques of the residual unit: the last step of a diagnosis
//! whose verdict is `unknown`.
//!
//! The residual of the plant's cut is a torque. What simple functions of angle and rate would give along the measured
//! motion is asked of the residual unit, pushed through the plant unit in the same windows, and fitted by least squares
//! with the windows' nuisances projected out. Terms are taken in one by one, each only if runs that were left out
//! support it. `amended.toml` gets the residual unit with what was found. It is a correction, no explanation: the verdict
//! stays `unknown`.
//! Kennedy and O'Hagan, J. R. Stat. Soc. B 63 (2001) 425; Kaheman, Kaiser, Strom, Kutz and Brunton, arXiv:1909.08574
//! (a sparse library for the discrepancy of a model).

mod dictionary;
mod fit;
mod policy;
pub mod wiring;

pub use crate::diagnosis::{Closing, Correction, Term};
use crate::diagnosis::{Gap, Trace, Unknown};
use crate::error::Error;
use crate::rigs::acrobot::correction::policy::CORRECTION;
use crate::rigs::acrobot::residual::Tracked;
use crate::rigs::acrobot::residual::forced_torques::Forced;
use crate::rigs::acrobot::residual::torque::{LACKING, Torque, torques};
use crate::rigs::acrobot::selection::Evaluation;
use crate::statistics::levels::WITHIN;
use dictionary::Follows;
use nalgebra::DVector;
use orchestrator::UnitPath;

impl Correction {
    /// The gap of the amended model: effects and correction together.
    pub fn closes(&self, gap: &Gap) -> Gap {
        let square = |x: f64| x * x;
        let over = square(gap.before) - square(gap.floor);
        let closed = gap.closed.map(|_| 1.0 - (square(self.usual) - square(gap.floor)) / over);
        Gap { after: self.usual, closed, ..gap.clone() }
    }

    /// The residual in words: where effects were withdrawn, what they had left says little of it.
    pub fn name_in(&self, unknown: Unknown) -> Unknown {
        let Some(first) = self.terms.first().filter(|_| !self.supersedes.is_empty()) else { return unknown };
        let entries = dictionary::entries();
        let entry =
            |term: &Term| entries.iter().find(|own| term.name.ends_with(&format!(".{}", own.coefficient)));
        let joint = entry(first).is_some_and(|own| own.joint);
        let mut depends_on = Vec::new();
        for (follows, names) in [
            (&[Follows::Angle][..], ["q1", "q2"]),
            (&[Follows::Rate, Follows::SmallRate][..], ["dq1", "dq2"]),
        ] {
            if self.terms.iter().filter_map(entry).any(|own| follows.contains(&own.follows)) {
                depends_on.extend(names[..if joint { 2 } else { 1 }].iter().map(|name| (*name).to_owned()));
            }
        }
        let phrases: Vec<&str> = self.terms.iter().map(|term| term.phrase.as_str()).collect();
        let shape = format!("{} ({:.0} % of it)", phrases.join("; "), self.gap.percent());
        let signal = LACKING[usize::from(joint)];
        Unknown { signal: signal.into(), depends_on, shape, ..unknown }
    }

    /// A graph of the residual, with the amended model.
    pub fn drawn(&self, trace: Trace) -> Trace {
        let (mut base, mut run, mut begin, mut end) = (0.0, usize::MAX, 0.0, 0.0);
        let points = self.left.iter().map(|(of, from, to, torque)| {
            if *of != run {
                base += end - begin;
                (run, begin) = (*of, *from);
            }
            end = to + 1.0;
            (base - begin + 0.5 * (from + to), torque[trace.link])
        });
        Trace { after: points.collect(), ..trace }
    }
}

/// What [`offer`] found.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Offer {
    /// The best correction that runs left out support, if any does.
    pub correction: Option<Correction>,
    /// What is left on runs left out, with it if there is one, N·m.
    pub left: f64,
}

/// What is left of the torques with a correction as it is: none of its values is fitted. `there` is the model without it.
///
/// # Errors
/// A unit failed or isn't there.
pub fn left(
    cut: &mut Tracked<dyn Forced>,
    point: &[f64],
    there: &Evaluation,
    correction: &Correction,
    units: &UnitPath,
) -> Result<Vec<Torque>, Error> {
    let given =
        |name: &str| correction.parameters.iter().find(|(known, _)| known == name).map(|(_, value)| *value);
    let entries = dictionary::entries();
    let taken = |entry: &&dictionary::Entry| {
        let slow = entry.slow.as_ref().is_none_or(|(name, slow)| given(name) == Some(*slow));
        given(&entry.coefficient).is_some() && slow
    };
    let chosen: Vec<dictionary::Entry> = entries.iter().filter(taken).cloned().collect();
    let values = chosen.iter().filter_map(|entry| given(&entry.coefficient));
    let values = DVector::from_iterator(chosen.len(), values);
    let terms = |name: &str| entries.iter().any(|entry| entry.coefficient == name);
    let covered: Vec<(String, f64)> =
        correction.parameters.iter().filter(|(name, _)| !terms(name)).cloned().collect();
    let states = cut.states(point)?;
    let columns = cut.pushed(point, &dictionary::along(&chosen, &covered, &states, units)?)?;
    let mut blocks = there.blocks.clone();
    for (cell, columns) in blocks.iter_mut().flat_map(|block| &mut block.cells).zip(columns) {
        cell.columns = columns;
    }
    let places: Vec<usize> = (0..chosen.len()).collect();
    Ok(torques(&blocks, &places, &[values], &vec![0; blocks.len()]))
}

/// Finds the best correction that runs left out support.
///
/// # Errors
/// A unit failed or isn't there.
pub fn offer(
    cut: &mut Tracked<dyn Forced>,
    point: &[f64],
    runs: &[String],
    units: &UnitPath,
    name: &str,
) -> Result<Offer, Error> {
    let mut blocks = cut.linearise(point, &[])?;
    let states = cut.states(point)?;
    let entries = dictionary::entries();
    let covered = dictionary::covered(&states);
    let torques = dictionary::along(&entries, &covered, &states, units)?;
    let columns = cut.pushed(point, &torques)?;
    for (cell, columns) in blocks.iter_mut().flat_map(|block| &mut block.cells).zip(columns) {
        cell.columns = columns;
    }
    let fitted = fit::fit(blocks, cut.signals(), &entries);
    let (before, after, floor) = fitted.gap;
    let Some(closed) = supported(fitted.gap).filter(|_| !fitted.terms.is_empty()) else {
        return Ok(Offer { correction: None, left: before });
    };
    let mut parameters = covered;
    let mut terms = Vec::new();
    for (entry, value, error) in fitted.terms {
        let entry = &entries[entry];
        parameters.extend(entry.slow.clone());
        parameters.push((entry.coefficient.clone(), value));
        terms.push(Term {
            name: format!("{name}.{}", entry.coefficient),
            value,
            ci95: [value - WITHIN * error, value + WITHIN * error],
            measure: entry.measure.clone(),
            phrase: entry.phrase.clone(),
        });
    }
    let held_out_runs = fitted.folds.names(runs);
    let correction = Some(Correction {
        label: "a labelled correction, not an explanation".into(),
        unit: name.into(),
        terms,
        gap: Closing { before, after, floor, closed, held_out_runs },
        supersedes: Vec::new(),
        parameters,
        usual: fitted.usual,
        left: fitted.left,
    });
    Ok(Offer { correction, left: after })
}

/// Share of a gap (before, after, floor) that a correction closes, where that is enough to offer it.
fn supported((before, after, floor): (f64, f64, f64)) -> Option<f64> {
    let over = before * before - floor * floor;
    let closed = 1.0 - (after * after - floor * floor) / over;
    (before > floor && closed >= CORRECTION.together).then_some(closed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_a_correction_closes_a_tenth_of_the_gap_or_more() {
        let after = |closed: f64| (1.0 - closed * 0.99).sqrt();
        let offered = |closed: f64| supported((1.0, after(closed), 0.1)).is_some();
        assert_eq!([0.09, 0.11].map(offered), [false, true]);
        // no gap, nothing to close
        assert_eq!(supported((0.1, 0.05, 0.1)), None);
    }
}
