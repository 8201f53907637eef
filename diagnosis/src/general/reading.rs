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
    let (mut likelier, words, by) = if before.0 <= after.0 {
        (before.1, "before the row's inputs acted", after.0 - before.0)
    } else {
        (after.1, "with the row's own inputs", before.0 - after.0)
    };
    likelier.notices.push(Notice {
        file: "dataset.toml".into(),
        line: 0,
        message: format!("{output} follows {input} at once: rows were read {words}, which is likelier by {by:.0} of deviance"),
    });
    Ok(likelier)
}
