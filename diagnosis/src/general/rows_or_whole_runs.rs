//! Whether rows can be begun anew: a model that remembers more than the states that can be set (a relay's position, a clock, a state that
//! nothing starts) goes another way from each row on, and what it lacks then seems to be that.
//!
//! Such a model can still be simulated through whole runs. The likelier of both ways is taken, by the nominal model alone: where a plant
//! drifts off by itself, rows begun anew are likelier in spite of what they forget.
//!
//! States that no variable shows are read through the outputs that follow. Where these say nothing of one (a spool within its overlap), a row
//! forgets what it did, and so does what is found. If something has no name then, but whole runs leave nothing, they are right.

use super::long;
use super::study::{Searched, Studied, fit_nominal, search_all_rows, search_without_left_out};
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
pub(super) fn choose_way(problem: &Problem) -> Result<Problem, Error> {
    let runs = &problem.whole_runs();
    let anew = build(problem, runs)?;
    let mut told = anew.engine.remembered();
    if told.is_empty() {
        return Ok(problem.clone());
    }
    let through = Problem { whole: true, ..problem.clone() };
    let deviance = |mut built| Ok::<_, Error>(fit_nominal(&mut built, &Trails::default())?.deviance);
    let rows = deviance(anew)?;
    let (runs, refused) = match build(&through, runs).and_then(deviance) {
        Ok(deviance) => (deviance, None),
        // more states than can be followed, or a unit that fails on the way: rows begun anew remain
        Err(Error::Model(why)) => (f64::INFINITY, Some(why)),
        Err(error) => return Err(error),
    };
    let whole = runs.is_finite() && (runs < rows || !rows.is_finite());
    let mut likelier = if whole { through } else { problem.clone() };
    let message = if whole {
        // one run is example enough of what no longer matters
        told.truncate(1);
        let by = rows - runs;
        let by =
            if by.is_finite() { format!("lowers the deviance by {by:.0}") } else { "can be followed".into() };
        format!("each run is simulated whole from its start instead, which {by}")
    } else if runs.is_finite() {
        format!("whole runs from their starts have a deviance that is higher by {:.0}", runs - rows)
    } else if let Some(why) = refused {
        format!("whole runs from their starts can't be followed: {why}")
    } else {
        "whole runs from their starts can't be followed either".to_owned()
    };
    likelier.notices.append(&mut told);
    likelier.notices.push(Notice { file: "dataset.toml".into(), line: 0, message });
    Ok(likelier)
}

/// Searches in rows that are begun anew, or in whole runs where these leave nothing that has no name. The problem in this case.
///
/// # Errors
/// The logs can't be followed.
pub(super) fn search(
    problem: &Problem,
    options: &Options,
    watch: &mut Watch<'_>,
) -> Result<(Option<Problem>, Searched), Error> {
    let first = search_without_left_out(problem, options, watch)?;
    let is_left = first.residual.unlisted.is_some();
    if let Some((through, again)) = explained(problem, options, &first, watch)? {
        let searched = search_all_rows(&through, options, again, watch)?;
        return Ok((Some(through), searched));
    }
    let found = search_all_rows(problem, options, first, watch)?;
    if is_left {
        return Ok((None, found));
    }
    // it may show in the rows left out only
    let Some((mut through, again)) = explained(problem, options, &found.all, watch)? else {
        return Ok((None, found));
    };
    // an answer is there: what takes longer than searches may is given up for it
    through.deadline = watch.until();
    match search_all_rows(&through, options, again, watch) {
        Ok(mut again) if again.all.residual.unlisted.is_none() => {
            again.all.built.engine.machine.deadline = problem.deadline;
            Ok((Some(Problem { deadline: problem.deadline, ..through }), again))
        }
        _ => Ok((None, found)),
    }
}

/// Whole runs, and what was found in them, where rows that are begun anew leave something that has no name and whole runs nothing. Logs that
/// are too long to be searched at once stay as they are: whole runs have no stretches.
fn explained(
    problem: &Problem,
    options: &Options,
    found: &Studied,
    watch: &mut Watch<'_>,
) -> Result<Option<(Problem, Studied)>, Error> {
    let reads_through = found.built.engine.machine.horizon > 0;
    if !reads_through || found.residual.unlisted.is_none() {
        return Ok(None);
    }
    let is_long = long::stretches(problem, &problem.whole_runs(), options)?.is_some();
    if is_long || watch.is_over("the search in whole runs") {
        return Ok(None);
    }
    let mut through = Problem { whole: true, deadline: watch.until(), ..problem.clone() };
    let Some(again) = search_without_left_out(&through, options, watch)
        .ok()
        .filter(|again| again.residual.unlisted.is_none())
    else {
        return Ok(None);
    };
    let message = "what the states that no variable shows do is lost where no output tells of it: each run is simulated whole from its \
                   start instead, which leaves nothing without a name";
    through.notices.push(Notice { file: "dataset.toml".into(), line: 0, message: message.into() });
    through.deadline = problem.deadline;
    Ok(Some((through, again)))
}

#[cfg(test)]
mod tests {
    use super::choose_way;
    use crate::dynamics::tests::{logged_again, swung};

    #[test]
    fn law_rows_begun_anew_remain_where_whole_runs_have_too_many_states() {
        // without its rates each row of the pendulum begins at rest, which is told
        let mut problem = logged_again(swung("narrow", 40), 20);
        problem.states.truncate(2);
        let chosen = choose_way(&problem).expect("rows can be followed");
        assert!(!chosen.whole);
        let told =
            chosen.notices.iter().any(|notice| notice.message.contains("whole runs from their starts can't"));
        assert!(told, "{:?}", chosen.notices);
    }
}
