//! Whether rows can be begun anew: a model that remembers more than the states that can be set (a relay's position, a clock, a state that
//! nothing starts) goes another way from each row on, and what it lacks then seems to be that.
//!
//! Such a model can still be simulated through whole runs. The likelier of both ways is taken, by the nominal model alone: where a plant
//! drifts off by itself, rows begun anew are likelier in spite of what they forget.
//!
//! States that no variable shows are read through the outputs that follow. Where these say nothing of one (a spool within its overlap), a row
//! forgets what it did, and so does what is found. If something has no name then, but whole runs leave nothing, they are right.

use super::study::{Searched, is_explained, nominal, searched};
use crate::dynamics::build::build;
use crate::dynamics::first_path::Trails;
use crate::error::{Error, Notice};
use crate::observe::Problem;
use crate::options::Options;
use crate::watch::Watch;

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

/// What was found, or whole runs and what was found in them, where they leave nothing that has no name.
///
/// # Errors
/// Time is up.
pub(super) fn explained(
    problem: &Problem,
    options: &Options,
    found: Searched,
    watch: &mut Watch<'_>,
) -> Result<(Option<Problem>, Searched), Error> {
    let reads_through = found.all.built.engine.machine.horizon > 0;
    if !reads_through || found.all.residual.unlisted.is_none() || watch.is_over("the search in whole runs") {
        return Ok((None, found));
    }
    let mut through = Problem { whole: true, ..problem.clone() };
    let again = match is_explained(&through, options, watch) {
        Ok(true) => searched(&through, options, watch),
        Ok(false) => return Ok((None, found)),
        Err(error) => Err(error),
    };
    match again {
        Ok(again) if again.all.residual.unlisted.is_none() => {
            let message = "what the states that no variable shows do is lost where no output tells of it: each run is simulated whole \
                           from its start instead, which leaves nothing without a name";
            through.notices.push(Notice { file: "dataset.toml".into(), line: 0, message: message.into() });
            Ok((Some(through), again))
        }
        Err(Error::TooSlow) => Err(Error::TooSlow),
        _ => Ok((None, found)),
    }
}
