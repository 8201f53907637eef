//! Logs that count otherwise than `dataset.toml` says, of a machine that lacks something as well.
//!
//! No reading is beyond doubt before a fit then: the nominal model follows the logs in none. As they are read something is left that has no name,
//! or a gain is named that is the ratio of two units. In the right reading what the machine lacks has its name, and nothing is left.

use super::held_or_lines::likelier_lines;
use super::mismatch::held_out;
use super::rows_left_out::parted;
use super::study::{Studied, search_without_left_out, unnamed};
use crate::check::{Reading, lines, nearer, unit_of_ratio};
use crate::diagnosis::Unknown;
use crate::dynamics::first_path::Trails;
use crate::dynamics::machine::Role;
use crate::error::Notice;
use crate::observe::{InputEffect, OutputEffect, Problem};
use crate::options::Options;
use crate::statistics::levels::{CERTAIN, PART, STEP};
use crate::text::brief;
use crate::watch::Watch;

/// What ends early where time is up.
const TRIED: &str = "the search in other readings of the logs";

/// Notices of readings in which nothing is left without a name, or no value lies at the end of its range, while it does as the logs are read; and
/// whether names are in doubt for that.
pub(super) fn misread(
    problem: &Problem,
    (trained, all): (&Studied, &Studied),
    is_unknown: bool,
    options: &Options,
    watch: &mut Watch<'_>,
) -> (Vec<Notice>, bool) {
    let told = ratios(problem, all);
    let others = readings(problem, all, (is_unknown || ends_at_a_range(all)) && told.is_empty());
    if others.is_empty() || !options.fit.is_empty() || watch.is_over(TRIED) {
        return (told, false);
    }
    watch.stage("reading the logs otherwise");
    let (end, ended) = (watch.share(PART), watch.ended().len());
    let found = explained(others, (trained, is_unknown || ends_at_a_range(all)), options, watch);
    watch.end_at(end);
    // the search in the logs as they are read came to its own end
    watch.tell_as_one(ended, TRIED);
    let in_doubt = found.is_some();
    (found.into_iter().collect(), in_doubt)
}

/// What has no name, with the reading in which nothing is left of it.
pub(super) fn with_reading(unknown: Unknown, misread: &[Notice]) -> Unknown {
    let Some(notice) = misread.first() else { return unknown };
    Unknown { nearest: format!("{}; but {}", unknown.nearest, notice.message), ..unknown }
}

/// Whether an effect lies at the end of its range: nothing between explains the logs as they are read.
fn ends_at_a_range(found: &Studied) -> bool {
    let ends = |effect: &usize| {
        let parameter = &found.built.engine.machine.parameters[*effect];
        let (least, most) = parameter.range;
        let value = found.fit.at.theta[*effect];
        value != parameter.neutral && !(least < value && value < most)
    };
    found.effects.iter().any(ends)
}

/// Readings that are worth a search.
fn readings(problem: &Problem, all: &Studied, is_doubted: bool) -> Vec<Reading> {
    // an input that acts half a row late is made up for by whatever makes a machine quicker, and by a shorter delay; where a few rows say that
    // it was held, a search in all of them says no other
    let asks_lines = is_doubted || !all.effects.is_empty() && likelier_lines(problem) != Some(false);
    let lines = if asks_lines { lines(problem) } else { None };
    lines.into_iter().chain(if is_doubted { nearer(problem) } else { Vec::new() }).collect()
}

/// The first of these readings in which nothing is left without a name, and that is likelier than the logs as they are read, or leaves less there.
fn explained(
    others: Vec<Reading>,
    (trained, is_unknown): (&Studied, bool),
    options: &Options,
    watch: &mut Watch<'_>,
) -> Option<Notice> {
    for reading in others {
        let read = Problem { deadline: watch.until(), ..reading.problem };
        let Ok(again) = search_without_left_out(&read, options, watch) else { continue };
        let is_likelier = again.fit.deviance + CERTAIN * CERTAIN < trained.fit.deviance;
        let is_better = is_unknown || is_likelier;
        if unnamed(&read, &again).is_some() || ends_at_a_range(&again) || !is_better || is_lost(&read, &again)
        {
            continue;
        }
        let values = again.effects.iter().map(|effect| {
            format!(
                "{} = {}",
                again.built.engine.machine.parameters[*effect].name,
                brief(again.fit.at.theta[*effect])
            )
        });
        let names = values.collect::<Vec<_>>().join(" and ");
        let beside = if names.is_empty() { String::new() } else { format!(" beside {names}") };
        let as_read = if is_unknown { "and not as they are read" } else { "better than as they are read" };
        let message = format!(
            "with {}{beside} the model follows the logs{} {as_read}: look at what is said of it. {}",
            reading.what,
            if is_unknown { "," } else { "" },
            reading.add
        );
        return Some(Notice { file: "dataset.toml".into(), line: reading.line, message });
    }
    None
}

/// Whether the model runs away from the rows left out in this reading, too.
fn is_lost(problem: &Problem, found: &Studied) -> bool {
    let (_, left) = parted(problem);
    held_out(problem, &left, found, &mut Trails::default()).map_or(true, |held| held.lost.is_some())
}

/// Gains that were named and are the ratio of two units in which a column may be written.
fn ratios(problem: &Problem, all: &Studied) -> Vec<Notice> {
    let engine = &all.built.engine;
    let told = |effect: &usize| {
        let parameter = &engine.machine.parameters[*effect];
        let gain = all.fit.at.theta[*effect];
        let (place, ratio) = match parameter.role {
            Role::Input(input, InputEffect::Gain) => (engine.machine.inputs[input].channel?, gain),
            Role::Output(output, OutputEffect::Gain) => {
                (engine.machine.channels[output].channel, gain.recip())
            }
            _ => return None,
        };
        let reading = unit_of_ratio(problem, place, ratio, STEP)?;
        let message = format!(
            "{} is {gain:.4}, as of {}: if the log has that unit, no gain is missing. {}",
            parameter.name, reading.what, reading.add
        );
        Some(Notice { file: "dataset.toml".into(), line: reading.line, message })
    };
    all.effects.iter().filter_map(told).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_what_has_no_name_is_told_with_the_reading_that_leaves_none() {
        let unknown = Unknown { nearest: "no candidate takes it away".into(), ..Unknown::default() };
        assert_eq!(with_reading(unknown.clone(), &[]), unknown);
        let notice = Notice { file: "dataset.toml".into(), line: 3, message: "with the sign turned".into() };
        assert_eq!(
            with_reading(unknown, &[notice]).nearest,
            "no candidate takes it away; but with the sign turned"
        );
    }
}
