//! The diagnosis told: shape of the residual, hypothesis, number, what remains.

use crate::diagnosis::{Effect, Gap, Unknown};
use crate::rigs::acrobot::candidates::{Candidate, Side};
use crate::rigs::acrobot::correction::Correction;
use crate::rigs::acrobot::selection::policy::SELECTION;
use crate::rigs::acrobot::selection::{Step, Study};
use crate::statistics::levels::FINE;
pub use crate::text::brief;

/// One study in sentences.
pub fn of_study(study: &Study, list: &[Candidate], gap: &Gap, left: Option<&Unknown>) -> Vec<String> {
    let mut lines = vec![format!(
        "{}: the nominal model leaves {} {} of {} (noise alone: {}).",
        study.name,
        brief(gap.before),
        gap.unit,
        gap.signal,
        brief(gap.floor)
    )];
    lines.extend(of_known(study, list));
    for step in &study.steps {
        if !step.together.is_empty() {
            let names: Vec<&str> = step.together.iter().map(|index| list[*index].name).collect();
            lines.push(format!(
                "None of these explains it alone. {} together do: in the place of all that was found before, each is needed beside the \
                 others.",
                names.join(", ")
            ));
            continue;
        }
        lines.push(of_step(step, list));
        for index in &step.dropped {
            let why = match list[*index].side {
                Side::Camera => "became superfluous, or is no larger than what right renderers differ by,",
                _ => "became superfluous",
            };
            lines.push(format!("{} {why} and was dropped.", list[*index].name));
        }
    }
    if study.is_full() {
        lines.push(format!("So many effects, {}, are as many as are searched for.", study.active.len()));
    }
    lines.push(of_end_of_search(gap, left));
    lines
}

/// What no step of this search found: it began with it, from what was compared before, and kept it.
fn of_known(study: &Study, list: &[Candidate]) -> Option<String> {
    let stepped = |index: &usize| {
        study.steps.iter().any(|step| step.accepted == Some(*index) || step.together.contains(index))
    };
    let known = study.active.iter().filter(|index| !stepped(index) && !list[**index].side.is_of_log());
    let known: Vec<String> =
        known.map(|index| format!("{} - {} -", list[*index].name, list[*index].phrase)).collect();
    let (last, others) = known.split_last()?;
    let (names, they) = match others {
        [] => (
            last.clone(),
            "was found before, when the same was compared more coarsely or with other noise, clocks or values; it is",
        ),
        _ => (
            format!("{} and {last}", others.join(", ")),
            "were found before, when the same was compared more coarsely or with other noise, clocks or values; each is",
        ),
    };
    Some(format!("{names} {they} needed still, and what follows is compared beside that."))
}

/// Effects that torques named and that windows need no more.
pub fn of_gone(coarse: &[usize], study: &Study, list: &[Candidate]) -> Option<String> {
    let gone: Vec<&str> =
        coarse.iter().filter(|index| !study.active.contains(index)).map(|index| list[*index].name).collect();
    let went = if gone.len() == 1 { "it goes" } else { "they go" };
    (!gone.is_empty()).then(|| format!("In windows nothing needs {}: {went} again.", gone.join(", ")))
}

/// An effect that no mean shows, and that no search could find so.
pub fn of_scatter(effect: &Effect, count: bool) -> String {
    let shown = if count {
        "it is counted: so many frames are missing between those that were delivered"
    } else {
        "it is measured by what circles scatter by from frame to frame, more or less than the nominal sensor makes of the same images"
    };
    format!(
        "{} = {} shows in no mean, so that no gap tells of it; {shown}.",
        effect.name,
        brief(effect.value)
    )
}

/// What a step of the search saw, and whom it accepted.
fn of_step(step: &Step, list: &[Candidate]) -> String {
    let best: Vec<String> = step
        .best
        .iter()
        .take(4)
        .map(|hit| format!("{} ({:.1})", list[hit.candidate].name, hit.statistic))
        .collect();
    let seen = if best.is_empty() { "no candidate".into() } else { best.join(", ") };
    match step.accepted {
        Some(index) => format!(
            "The residual looks most like {seen} (in standard deviations; by chance the best of all would look so \
             with probability {:.4}). Fitted through the units, {} - {} - explains it best{}, and left-out runs agree.",
            step.p_value,
            list[index].name,
            list[index].phrase,
            decrease(step.mean_square)
        ),
        None => {
            let but = if step.p_value < SELECTION.alpha {
                "That is more than chance and less than a name takes: it must be certain alone, and left-out runs must agree. An effect somewhat below \
                 what would be found looks so. "
            } else {
                ""
            };
            format!(
                "What remains resembles {seen}; the best of all candidates looks so by chance with probability {}. {but}Nothing more is named.",
                probability(step.p_value)
            )
        }
    }
}

/// A probability; one that rounds to none is below what is written.
fn probability(of: f64) -> String {
    if of < FINE { format!("below {FINE}") } else { format!("{of:.3}") }
}

/// What is left in the end: something without a name, a gap, or noise.
fn of_end_of_search(gap: &Gap, left: Option<&Unknown>) -> String {
    match (gap.percent(), left) {
        (_, Some(left)) => {
            format!("But more than noise remains: {} - {}. {}.", left.signal, left.shape, left.nearest)
        }
        (Some(percent), None) => format!(
            "By cross-validation (values fitted without each run in turn) the gap goes from {} to {} {}: {:.0} % of it is closed.",
            brief(gap.before),
            brief(gap.after),
            gap.unit,
            percent
        ),
        (None, None) => "No gap stands above the noise here.".into(),
    }
}

/// How the residual decreases, where that says something: what a model lacks at large counts as noise, and is 1 before and after, or more
/// where less of it is left to count as such.
fn decrease((before, after): (f64, f64)) -> String {
    let less = after < before;
    let (before, after) = (format!("{before:.2}"), format!("{after:.2}"));
    if before == after || !less {
        return String::new();
    }
    format!(": the residual's mean square goes from {before} to {after} of the noise in use")
}

/// What torques found before the plant could follow the log.
pub fn of_coarse(found: &[usize], list: &[Candidate]) -> String {
    let names: Vec<&str> = found.iter().map(|index| list[*index].name).collect();
    format!(
        "The nominal model leaves the log within most windows. So the torques that it lacks at the measured states were \
         compared first. They name {}; with that it follows the log, and what comes now is compared in windows.",
        names.join(", ")
    )
}

/// An effect that was stopped by the range that is searched.
pub fn of_end(effect: &Effect) -> String {
    format!(
        "{} = {} stands at the end of what can be tried: it may lie beyond, and then its value and what was named beside it correct \
         the difference.",
        effect.name,
        brief(effect.value)
    )
}

/// A ceiling that the logs don't bound from above.
pub fn of_open(effect: &Effect) -> String {
    format!(
        "{} = {}: these data give it no upper bound. Its interval ends at {}, the loosest that they could tell from none.",
        effect.name,
        brief(effect.value),
        brief(effect.ci95[1])
    )
}

/// Why what was fitted isn't named.
pub fn of_widened(gap: &Gap) -> String {
    format!(
        "But with it runs that were left out lack more torque than without, {} {} instead of {}: it is withdrawn.",
        brief(gap.after),
        gap.unit,
        brief(gap.before)
    )
}

/// What is offered for a residual without a name, in a sentence.
pub fn of_correction(correction: Option<&Correction>) -> String {
    let Some(correction) = correction else {
        return "No torque that is a simple function of angles and rates takes a fair part of it away on runs left out, so \
                the amended model gets no correction for it."
            .into();
    };
    let terms: Vec<String> = correction
        .terms
        .iter()
        .map(|term| format!("{} = {}, {}", term.name, brief(term.value), term.phrase))
        .collect();
    let superseded = match correction.supersedes.as_slice() {
        [] => String::new(),
        names => format!(
            "A correction alone does as well or better with no more numbers, so {} is not named: that stood for a part of the \
             residual. ",
            names.join(", ")
        ),
    };
    format!(
        "{superseded}The amended model gets {} for it, the residual unit: {}. On runs left out the lacking torque goes from {} to \
         {} N·m with it (noise alone: {}): {:.0} % of what the model leaves without it.",
        correction.label,
        terms.join("; "),
        brief(correction.gap.before),
        brief(correction.gap.after),
        brief(correction.gap.floor),
        correction.gap.percent()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_residual_that_does_not_decrease_explains_nothing_by_that() {
        assert_eq!([(0.98, 1.10), (1.001, 0.999)].map(decrease), ["", ""].map(String::from));
        assert!(decrease((1.31, 1.02)).contains("from 1.31 to 1.02"));
    }
}
