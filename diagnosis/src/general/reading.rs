//! Whether a row's outputs were read before or after its inputs began to act, where an output follows an input at once, or where the
//! unit computes it within a step only.
//!
//! A master that steps a unit and reads it sees the inputs of the interval that ends; a logger that writes an input and then
//! reads sees the row's own. The data tell, since each jump of the input shows in the output: the likelier one is taken. All rows
//! are asked, as for units and signs: it is a fact of the logger, and in a part of them no input may jump.

use super::study::fit_nominal;
use crate::dynamics::build::{Span, build};
use crate::dynamics::first_path::Trails;
use crate::error::{Error, Notice};
use crate::observe::{Problem, Reading, Run};
use crate::statistics::levels::CERTAIN;

/// The problem with the likelier of both ways.
///
/// # Errors
/// A unit failed.
pub(super) fn read(problem: &Problem) -> Result<Problem, Error> {
    let runs: &[(&Run, Span)] = &problem.runs.iter().map(|run| (run, run.span())).collect::<Vec<_>>();
    let late = build(problem, runs)?.engine.computed_late()?;
    let mut problem = Problem { late: late.is_some(), ..problem.clone() };
    problem.notices.extend(late.map(|output| Notice {
        file: "dataset.toml".into(),
        line: 0,
        message: format!("{output} is computed in a step only: where the unit is begun it makes a short one before it is read"),
    }));
    let Some((output, input)) = build(&problem, runs)?.engine.at_once()? else { return Ok(problem) };
    let deviance = |reading: Reading| {
        let other = Problem { reading, ..problem.clone() };
        let mut built = build(&other, runs)?;
        Ok::<_, Error>((fit_nominal(&mut built, &Trails::default())?.deviance, other))
    };
    let (before, after) = (deviance(Reading::Before)?, deviance(Reading::After)?);
    let by = after.0 - before.0;
    let (mut likelier, words) = match told(by) {
        Told::Before => (
            before.1,
            format!("rows were read before the row's inputs acted, which lowers the deviance by {by:.0}"),
        ),
        Told::After => (
            after.1,
            format!("rows were read with the row's own inputs, which lowers the deviance by {:.0}", -by),
        ),
        Told::Neither => (
            after.1,
            format!(
                "the logs don't tell whether rows were read before or after that (the deviances differ by {:.0}): taken as after",
                by.abs()
            ),
        ),
    };
    let message = format!("{output} follows {input} at once: {words}");
    likelier.notices.push(Notice { file: "dataset.toml".into(), line: 0, message });
    Ok(likelier)
}

/// What the logs tell.
#[derive(Debug, PartialEq)]
enum Told {
    Before,
    After,
    Neither,
}

/// By how much less the deviance is with rows that were read before. A model that lacks something prefers one or the other by chance; reading
/// after the inputs acted is what masters do.
fn told(by: f64) -> Told {
    match by {
        by if by > CERTAIN * CERTAIN => Told::Before,
        by if by < -CERTAIN * CERTAIN => Told::After,
        _ => Told::Neither,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_how_rows_were_read_is_told_from_four_and_a_half_deviations() {
        assert_eq!(
            [-22.0, -19.0, 0.0, 19.0, 22.0].map(told),
            [Told::After, Told::Neither, Told::Neither, Told::Neither, Told::Before]
        );
    }
}
