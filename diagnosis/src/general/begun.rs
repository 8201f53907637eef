//! Whether rows can be begun anew: a model that remembers more than the states that can be set (a relay's position, a clock, a state that
//! nothing starts) goes another way from each row on, and what it lacks then seems to be that.
//!
//! Such a model can still be simulated through whole runs. The likelier of both ways is taken, by the nominal model alone: where a plant
//! drifts off by itself, rows begun anew are likelier in spite of what they forget.

use super::study::nominal;
use crate::dynamics::build::build;
use crate::dynamics::first_path::Trails;
use crate::error::{Error, Notice};
use crate::observe::Problem;

/// The problem with the likelier of both ways, where they differ.
///
/// # Errors
/// A unit failed.
pub(super) fn chosen(problem: &Problem) -> Result<Problem, Error> {
    let runs = &problem.whole_runs();
    let anew = build(problem, runs)?;
    let mut told = anew.engine.remembered();
    if told.is_empty() {
        return Ok(problem.clone());
    }
    let through = Problem { whole: true, ..problem.clone() };
    let deviance = |mut built| Ok::<_, Error>(nominal(&mut built, &Trails::default())?.deviance);
    let (rows, runs) = (deviance(anew)?, deviance(build(&through, runs)?)?);
    let whole = runs.is_finite() && (runs < rows || !rows.is_finite());
    let mut likelier = if whole { through } else { problem.clone() };
    let message = if whole {
        // one run is example enough of what no longer matters
        told.truncate(1);
        let by = rows - runs;
        let by = if by.is_finite() {
            format!("is likelier by {by:.0} of deviance")
        } else {
            "can be followed".into()
        };
        format!("each run is simulated whole from its start instead, which {by}")
    } else if runs.is_finite() {
        format!("whole runs from their starts are less likely by {:.0} of deviance", runs - rows)
    } else {
        "whole runs from their starts can't be followed either".to_owned()
    };
    likelier.notices.append(&mut told);
    likelier.notices.push(Notice { file: "dataset.toml".into(), line: 0, message });
    Ok(likelier)
}
