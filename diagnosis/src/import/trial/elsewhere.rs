//! Whether a log may lie apart from the model since the machine began elsewhere than the unit: a start that no log gives, moved, then shifts the whole
//! course of an output, as an offset of its sensor would.

use super::{Trial, name};
use crate::import::starts::{self, Start};
use crate::import::{Match, policy::IMPORT};
use crate::statistics::levels::ROUNDING;

/// Starts that no column of the log gives a value, by their places; what is counted in nobody knows what gives none.
pub(super) fn free_starts(all: &[Start], unshown: &[usize], matches: &[Match]) -> Vec<usize> {
    let is_given = |one: &&Start| {
        let gives = |matched: &Match| {
            !matched.fed
                && matched.variable == one.shows
                && (matched.unit.is_some() || matched.affine.is_some())
        };
        matches.iter().any(gives)
    };
    let free = all.iter().filter(|one| !is_given(one)).map(|one| one.start);
    free.chain(unshown.iter().copied()).collect()
}

impl Trial<'_> {
    /// The first of these starts that shifts the whole course of an output, by its name; none where the unit can't be run so.
    pub(super) fn shifted_by(&self, output: &Match, free: &[usize]) -> Option<&str> {
        let output = name(self.fmu, output);
        let course = |set: &[(String, String)]| {
            let run = self.run(set, None).ok().flatten()?;
            run.series(&output).ok().map(<[f64]>::to_vec)
        };
        let own = if free.is_empty() { None } else { course(&[]) }?;
        let starts = free.iter().map(|place| &self.fmu.description().variables[*place]);
        let mut moved = starts.filter_map(|start| Some((&start.name, starts::moved(start)?)));
        let (shifting, _) = moved.find(|(start, to)| {
            let with = course(&[((*start).clone(), format!("{to:e}"))]);
            with.is_some_and(|with| is_shifted(&own, &with))
        })?;
        Some(shifting)
    }
}

/// Whether a course lies beside another from its begin on, and on the whole as well.
fn is_shifted(one: &[f64], other: &[f64]) -> bool {
    let size = one.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
    let apart: Vec<f64> = one.iter().zip(other).map(|(one, other)| other - one).collect();
    let mean = apart.iter().sum::<f64>() / apart.len().max(1) as f64;
    apart.first().is_some_and(|first| first.abs() > ROUNDING * size && mean / first >= IMPORT.lasting)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observe::Affine;

    #[test]
    fn law_what_a_start_moves_for_good_is_shifted_and_what_dies_away_is_not() {
        let course: Vec<f64> = (0..1000).map(|row| (0.01 * f64::from(row)).sin()).collect();
        let with = |by: &dyn Fn(f64) -> f64| -> Vec<f64> {
            course.iter().zip(0..).map(|(value, row)| value + by(f64::from(row))).collect()
        };
        // a position, one behind a gear the other way round, one that settles at a third of it
        for by in [0.05, -0.01] {
            assert!(is_shifted(&course, &with(&|_| by)));
            assert!(is_shifted(&course, &with(&|row| by / 3.0 * (1.0 + 2.0 * (-0.1 * row).exp()))));
            // the acceleration beside it: it rings and is gone; and a speed's start moves no position at once
            assert!(!is_shifted(&course, &with(&|row| by * (0.5 * row).cos() * (-0.05 * row).exp())));
            assert!(!is_shifted(&course, &with(&|row| by * row)));
        }
        assert!(!is_shifted(&course, &course) && !is_shifted(&[], &[]));
    }

    #[test]
    fn value_which_starts_no_log_gives() {
        let matched = |variable: usize, unit: Option<&str>, fed: bool| Match {
            variable,
            column: "y".into(),
            unit: unit.map(Into::into),
            affine: None,
            evidence: Vec::new(),
            fed,
            hold: None,
        };
        let starts = [Start { start: 7, shows: 1 }, Start { start: 2, shows: 2 }];
        let of = |matches: &[Match]| free_starts(&starts, &[9], matches);
        assert_eq!(of(&[matched(1, Some("mm"), false)]), [2, 9]);
        assert_eq!(of(&[matched(1, None, false), matched(2, Some("m"), true)]), [7, 2, 9]);
        let turned = Match { affine: Some(Affine::SAME), ..matched(2, None, false) };
        assert_eq!(of(&[turned]), [7, 9]);
    }
}
