//! Whether rows can be begun anew: a model that remembers more than the states that can be set (a relay's position, a clock, a state that
//! nothing starts) goes another way from each row on, and what it lacks then seems to be that.
//!
//! Such a model can still be simulated through whole runs. The likelier of both ways is taken, by the nominal model alone: where a plant
//! drifts off by itself, rows begun anew are likelier in spite of what they forget.

use super::study::nominal;
use crate::dynamics::build::{Span, build};
use crate::dynamics::first_path::Trails;
use crate::error::{Error, Notice};
use crate::observe::{Problem, Run};

/// The problem with the likelier of both ways, where they differ.
///
/// # Errors
/// A unit failed.
pub(super) fn chosen(problem: &Problem) -> Result<Problem, Error> {
    let runs: &[(&Run, Span)] = &problem.runs.iter().map(|run| (run, run.span())).collect::<Vec<_>>();
    let anew = build(problem, runs)?;
    let mut told = anew.engine.remembered();
    if told.is_empty() {
        return Ok(problem.clone());
    }
    let through = Problem { whole: true, ..problem.clone() };
    let deviance = |mut built| Ok::<_, Error>(nominal(&mut built, &Trails::default())?.deviance);
    let by = deviance(anew)? - deviance(build(&through, runs)?)?;
    let mut likelier = if by > 0.0 { through } else { problem.clone() };
    let message = if by > 0.0 {
        // one run is example enough of what no longer matters
        told.truncate(1);
        format!(
            "each run is simulated whole from its start instead, which is likelier by {by:.0} of deviance"
        )
    } else {
        format!("whole runs from their starts are less likely by {:.0} of deviance", -by)
    };
    likelier.notices.append(&mut told);
    likelier.notices.push(Notice { file: "dataset.toml".into(), line: 0, message });
    Ok(likelier)
}
