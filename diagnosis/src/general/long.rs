//! Logs too long to be searched as a whole: the search begins in stretches of them, evenly spread. Where these leave nothing unexplained it
//! goes on in all rows from what was found, for small effects need every row. Where something without a name is left, that is what limits
//! an answer, and not the number of rows: then what was found is fitted to all rows and judged there.

use super::policy::GENERAL;
use super::residual;
use super::rows_left_out::Rows;
use super::study::{Studied, fit_nominal, studied};
use crate::dynamics::Machine;
use crate::dynamics::build::{Span, build};
use crate::dynamics::first_path::Trails;
use crate::error::{Error, Notice};
use crate::infer::fit::{At, Options as FitOptions, fit};
use crate::observe::{Problem, Run};
use crate::options::Options;
use crate::search::class::Alternative;
use crate::statistics::levels::{FAR, MORE};
use crate::watch::Watch;

/// One stretch of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Stretch {
    run: usize,
    place: usize,
    span: Span,
}

/// The stretches that are searched, where the rows are too many.
///
/// # Errors
/// No state can be linked.
pub fn stretches<'a>(
    problem: &Problem,
    rows: &Rows<'a>,
    options: &Options,
) -> Result<Option<Rows<'a>>, Error> {
    let machine = Machine::new(problem)?;
    // what is simulated whole from the model's own start has no stretches, and what was asked for isn't searched
    if problem.whole || machine.states.is_empty() || !options.fit.is_empty() {
        return Ok(None);
    }
    let most = most(machine.parameters.len());
    // of each run one at least
    let wanted = |_: &[Stretch], _: usize| (most / GENERAL.stretch).max(rows.len());
    Ok(spread(&machine, rows, most, GENERAL.stretch, &wanted))
}

/// The rows that are fitted, where they are so many that neither memory nor time would do for all, and what to say of that.
///
/// # Errors
/// No state can be linked.
pub fn thinned<'a>(problem: &Problem, rows: Rows<'a>) -> Result<(Rows<'a>, Option<Notice>), Error> {
    let machine = Machine::new(problem)?;
    let most = GENERAL.fitted() / machine.parameters.len().max(1);
    // a start state of its own takes next to nothing of so long a stretch
    let wanted = |list: &[Stretch], all: usize| (most * list.len() / all).max(1);
    let taken = match problem.whole {
        true => None,
        false => spread(&machine, &rows, most, FAR as usize * GENERAL.stretch, &wanted),
    };
    let Some(taken) = taken else { return Ok((rows, None)) };
    let count = |rows: &Rows<'_>| rows.iter().map(|(run, span)| counted(&machine, run, *span)).sum::<usize>();
    let (all, kept, parts) = (count(&rows), count(&taken), taken.len());
    if kept == all {
        // a single stretch is more than that already
        return Ok((rows, None));
    }
    let message = format!(
        "of {all} rows {kept} in {parts} stretches, evenly spread, are fitted: what more would tell grows with the root of their number only"
    );
    Ok((taken, Some(Notice { file: "dataset.toml".into(), line: 0, message })))
}

/// About `most` of the rows in stretches of so many, evenly spread; nothing where they are not more than that. `wanted`: how many of all stretches,
/// of which these are the rows.
fn spread<'a>(
    machine: &Machine,
    rows: &Rows<'a>,
    most: usize,
    length: usize,
    wanted: &dyn Fn(&[Stretch], usize) -> usize,
) -> Option<Rows<'a>> {
    let counts: Vec<usize> = rows.iter().map(|(run, span)| counted(machine, run, *span)).collect();
    let all = counts.iter().sum();
    if !is_long(all, most) {
        return None;
    }
    let mut list = Vec::new();
    for (run, ((_, (from, to)), rows)) in rows.iter().zip(&counts).enumerate() {
        let parts = parts(*rows, length);
        let at = |part: usize| from + (to - from) * part as f64 / parts as f64;
        list.extend((0..parts).map(|place| Stretch { run, place, span: (at(place), at(place + 1)) }));
    }
    let joined = joined(&spread_evenly(&list, wanted(&list, all)));
    Some(joined.into_iter().map(|(run, span)| (rows[run].0, span)).collect())
}

/// Rows that are searched at once, with so many parameters.
fn most(parameters: usize) -> usize {
    GENERAL.searched / parameters.max(1)
}

/// Whether so many rows are worth a search in stretches first, where so many are searched at once.
fn is_long(rows: usize, most: usize) -> bool {
    rows as f64 > MORE * most as f64
}

/// Stretches of a run of so many rows, each of so many.
fn parts(rows: usize, length: usize) -> usize {
    (rows / length).max(1)
}

/// Rows of a run between two times.
fn counted(machine: &Machine, run: &Run, (from, to): Span) -> usize {
    let of = |output: &crate::dynamics::machine::Output| {
        run.series[output.channel].time.iter().filter(|time| (from..=to).contains(*time)).count()
    };
    machine.channels.iter().map(of).max().unwrap_or(0)
}

/// So many of them, evenly spread.
fn spread_evenly(list: &[Stretch], wanted: usize) -> Vec<Stretch> {
    let wanted = wanted.min(list.len());
    (0..wanted).map(|part| list[part * list.len() / wanted]).collect()
}

/// Neighbours become one: run and span.
fn joined(taken: &[Stretch]) -> Vec<(usize, Span)> {
    let mut joined: Vec<(usize, Span)> = Vec::new();
    for (place, one) in taken.iter().enumerate() {
        let follows = place > 0 && taken[place - 1].run == one.run && taken[place - 1].place + 1 == one.place;
        match joined.last_mut() {
            Some((_, span)) if follows => span.1 = one.span.1,
            _ => joined.push((one.run, one.span)),
        }
    }
    joined
}

/// Searches in all rows, after stretches of them where they are many.
///
/// # Errors
/// As [`studied`].
pub fn search(
    problem: &Problem,
    options: &Options,
    before: (&Studied, &Trails),
    watch: &mut Watch<'_>,
) -> Result<Studied, Error> {
    let (all, notice) = thinned(problem, problem.whole_runs())?;
    let mut found = search_first_in_stretches(problem, &all, options, before, watch)?;
    found.built.notices.extend(notice);
    Ok(found)
}

/// Searches in these rows, after stretches of them where they are many.
fn search_first_in_stretches(
    problem: &Problem,
    all: &Rows<'_>,
    options: &Options,
    before: (&Studied, &Trails),
    watch: &mut Watch<'_>,
) -> Result<Studied, Error> {
    let Some(part) = stretches(problem, all, options)? else {
        return studied(problem, all, options, Some(before), true, watch);
    };
    watch.stage("searching in stretches of the logs");
    let found = studied(problem, &part, options, Some(before), true, watch)?;
    let goes_on = found.residual.unlisted.is_none() && !watch.is_over("the search in all rows");
    let mut over = if goes_on {
        watch.stage("searching in all rows from what was found");
        studied(problem, all, options, Some((&found, before.1)), true, watch)?
    } else {
        watch.stage("fitting what was found to all rows");
        over(problem, all, found, before.1)?
    };
    over.built.notices.push(describe_stretches(&over, &part, goes_on));
    Ok(over)
}

/// What was found in stretches, fitted to all rows and judged there.
fn over(problem: &Problem, rows: &Rows<'_>, found: Studied, known: &Trails) -> Result<Studied, Error> {
    let mut built = build(problem, rows)?;
    let begun = fit_nominal(&mut built, known)?;
    let sizes = match found.residual.unlisted {
        Some(_) => built.sizes.with_pinned(found.residual.sizes.pinned.clone()),
        None => built.sizes.clone(),
    };
    let mut start = At { noise: found.fit.at.noise.clone(), ..begun.at.clone() };
    start.theta.clone_from(&found.fit.at.theta);
    let fit = fit(&built.engine, &start, &found.fit.free, Some(&sizes), &FitOptions::default())?;
    let residual = residual::judge_residual(&built.engine, &fit, &sizes, &found.policy);
    let classes = found.classes.into_iter().map(|class| refitted(class, &found.effects, &fit)).collect();
    let told: Vec<String> = built.notices.iter().map(|notice| notice.message.clone()).collect();
    built.notices.extend(found.built.notices.into_iter().filter(|one| !told.contains(&one.message)));
    let (effects, policy, story) = (found.effects, found.policy, found.story);
    Ok(Studied { built, effects, fit, nominal: begun.at.paths, residual, policy, last: None, story, classes })
}

/// A class with the value that its own effect has in all rows.
fn refitted(class: Vec<Alternative>, effects: &[usize], fit: &crate::infer::Fit) -> Vec<Alternative> {
    let of = |one: Alternative| match fit.free.contains(&one.parameter) && effects.contains(&one.parameter) {
        true => Alternative { loss: one.loss, ..Alternative::as_fitted(one.parameter, fit) },
        false => one,
    };
    class.into_iter().map(of).collect()
}

fn describe_stretches(over: &Studied, part: &Rows<'_>, goes_on: bool) -> Notice {
    let rows: usize = over.built.engine.grids.iter().map(|grid| grid.time.len()).sum();
    let (most, parts) = (most(over.built.engine.machine.parameters.len()), part.len());
    let then = if goes_on { "went on from what it found in all" } else { "what it found was fitted to all" };
    let message =
        format!("of {rows} rows some {most} in {parts} stretches of the logs were searched first; {then}");
    Notice { file: "dataset.toml".into(), line: 0, message }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::tests::pendulum;

    fn list(count: usize) -> Vec<Stretch> {
        let one = |place: usize| Stretch { run: 0, place, span: (place as f64, place as f64 + 1.0) };
        (0..count).map(one).collect()
    }

    #[test]
    fn law_stretches_are_spread_evenly() {
        let places = |count, wanted| -> Vec<usize> {
            spread_evenly(&list(count), wanted).iter().map(|one| one.place).collect()
        };
        assert_eq!(places(8, 4), [0, 2, 4, 6]);
        assert_eq!(places(7, 3), [0, 2, 4]);
        assert_eq!(places(3, 9), [0, 1, 2], "no more than there are");
    }

    #[test]
    fn law_neighbours_are_one_stretch_but_not_across_runs() {
        let mut all = list(4);
        all[3].run = 1;
        assert_eq!(joined(&[all[0], all[1]]), [(0, (0.0, 2.0))]);
        assert_eq!(joined(&[all[0], all[2]]), [(0, (0.0, 1.0)), (0, (2.0, 3.0))]);
        assert_eq!(joined(&[all[2], all[3]]), [(0, (2.0, 3.0)), (1, (3.0, 4.0))]);
    }

    #[test]
    fn value_which_logs_are_searched_in_stretches() {
        // fifty candidates and effects at ports, in half a minute: a motor's minute at 100 Hz as a whole, two minutes not
        let is_long = |rows: usize| is_long(rows, most(50));
        assert!(!is_long(5_500) && is_long(6_500) && is_long(12_000));
        // a start state takes a thirtieth of a stretch: twelve rows' worth
        assert_eq!([300, 650, 790, 3_800].map(|rows| parts(rows, GENERAL.stretch)), [1, 1, 2, 10]);
    }

    #[test]
    fn value_which_logs_are_fitted_as_a_whole() {
        // with fifty parameters: a minute at a kilohertz is fitted, and of four as much as that
        let mut problem = pendulum("thinned", 20);
        let parameters = Machine::new(&problem).expect("it is linked").parameters.len();
        let mut rows = |rows: usize| {
            let times = || (0..rows).map(|row| row as f64 * 0.01);
            for series in &mut problem.runs[0].series {
                series.time = times().collect();
                series.values = vec![0.0; rows];
            }
            let (taken, notice) = thinned(&problem, problem.whole_runs()).expect("it is linked");
            let counted =
                taken.iter().map(|(_, (from, to))| ((to - from) / 0.01).round() as usize).sum::<usize>();
            (counted * parameters / 1_000_000, taken.len(), notice.is_some())
        };
        let most = GENERAL.fitted() / parameters;
        // in millions of rows times parameters
        assert_eq!(rows(most * 14 / 10), (2, 1, false));
        let (fitted, stretches, is_told) = rows(most * 4);
        assert!((1..=2).contains(&fitted) && stretches > 5 && is_told, "{fitted} in {stretches}");
        // and of many short runs some whole ones
        rows(most / 100);
        problem.runs = vec![problem.runs[0].clone(); 400];
        let (taken, _) = thinned(&problem, problem.whole_runs()).expect("it is linked");
        assert_eq!(taken.len(), 100);
    }

    #[test]
    fn value_of_a_single_run_less_than_half_is_left_out() {
        // what is left out must tell whether the rest was understood: a tenth would not, and half would miss in the search
        assert!((13.5..14.5).contains(&super::super::rows_left_out::cut(10.0, 16.0)));
    }
}
