//! From a problem to a diagnosis.

use super::fit_given::{check_names, claimed, fit_given};
use super::mismatch::{HeldOut, Squares};
use super::residual::{self, Residual};
use super::rest::name_the_rest;
use super::rows_left_out::parted;
use super::{
    after_moves, amended, blame, findings, long, mismatch, misread, reading, rows_or_whole_runs, runs, sensor,
};
use crate::design::Question;
use crate::diagnosis::{Diagnosis, Effect, NextExperiment, Unknown, Verdict};
use crate::dynamics::build::{Built, Span, build};
use crate::dynamics::first_path::Trails;
use crate::error::{Error, Notice};
use crate::infer::Sizes;
use crate::infer::fit::{Fit, Options as FitOptions, Path, fit, fit_from};
use crate::observe::{Problem, Run};
use crate::options::Options;
use crate::search::class::Alternative;
use crate::search::screen::Last;
use crate::search::walk::Visited;
use crate::search::{Policy, Search};
use crate::statistics::levels::HALF;
use crate::watch::{Listener, Watch};
use orchestrator::UnitPath;
use std::time::Instant;

/// What a search over some rows found.
pub struct Studied {
    /// Engine, sizes, scatter.
    pub built: Built,
    /// Parameters off their neutral values.
    pub effects: Vec<usize>,
    /// Their fit.
    pub fit: Fit,
    /// The path of every run with the nominal model.
    pub nominal: Vec<Path>,
    /// What process noise says.
    pub residual: Residual,
    /// Numbers of the search.
    pub policy: Policy,
    /// Its last screening.
    pub last: Option<Last>,
    /// How it was found, in words.
    pub story: Vec<String>,
    /// Classes, if they were asked for.
    pub classes: Vec<Vec<Alternative>>,
}

/// Diagnoses.
///
/// # Errors
/// The model can't be followed, or a unit failed.
pub fn diagnosed(
    problem: &Problem,
    units: &UnitPath,
    options: &Options,
    listener: Listener<'_>,
) -> Result<Diagnosis, Error> {
    amended::within_reach(problem, units)?;
    let runs = problem.runs.len();
    let deadline = options.budget.deadline(Instant::now(), runs);
    let watch = &mut Watch::by(options.now, listener, options.budget.end((options.now)(), runs));
    let problem = &Problem { deadline, ..problem.clone() };
    let found = diagnosed_in_time(problem, units, options, watch);
    // what was found after it stands on steps that were not made
    let is_late = deadline.is_some_and(|deadline| Instant::now() >= deadline);
    let found = if is_late { Err(Error::TooSlow) } else { found };
    found.map_err(|error| blame::blamed(problem, error))
}

/// The diagnosis, with what time allows.
fn diagnosed_in_time(
    problem: &Problem,
    units: &UnitPath,
    options: &Options,
    watch: &mut Watch<'_>,
) -> Result<Diagnosis, Error> {
    watch.stage("looking at the logs");
    crate::check::plausible(problem)?;
    let problem = &crate::check::hinted(problem);
    let problem = &rows_or_whole_runs::choose_way(&reading::read(problem)?)?;
    let (through, Searched { trained, held, all }) = rows_or_whole_runs::search(problem, options, watch)?;
    let is_cut_short = !watch.ended().is_empty();
    let problem = through.as_ref().unwrap_or(problem);
    let unknown = unnamed(problem, &all)
        .or_else(|| held.squares.unlike().filter(|_| is_judged(&trained, &all) && options.fit.is_empty()))
        .or_else(|| held.lost.clone().filter(|_| all.effects.is_empty()));
    let (misread, is_misread) =
        misread::misread(problem, (&trained, &all), unknown.is_some(), options, watch);
    let unknown = runs::shaped(problem, &all, options, unknown, watch)
        .map(|unknown| misread::with_reading(unknown, &misread))
        .map(|unknown| residual::as_far_as_searched(unknown, is_cut_short));
    let in_doubt =
        is_misread || unknown.is_some() || is_judged(&trained, &all) && held.squares.close_little();
    let effects = findings::effects(problem, &all, in_doubt);
    let verdict = verdict(unknown.is_some(), &effects);
    let (next_experiment, experiment) = next_experiment(problem, &all, units, watch);
    watch.stage("writing the amended scenario");
    let amended = amended::amended(problem, &all, units)?;
    let gaps = claimed(held.gaps, &all, options);
    let notices = all_notices(problem, &all, held.notice.into_iter().chain(misread));
    let story = [findings::story(&all), all.story.clone(), amended.told.into_iter().collect()].concat();
    Ok(Diagnosis {
        provenance: findings::provenance(problem),
        units: findings::units(problem),
        verdict,
        effects,
        place: mismatch::places(&all),
        gap: gaps[0].clone(),
        unknown,
        correction: None,
        next_experiment,
        minimum_detectable: findings::detectable(&all)?,
        gaps,
        cross_validation: Vec::new(),
        ended_early: watch.ended().to_vec(),
        notices,
        story,
        amended: amended.text,
        attachments: amended.attachments,
        experiment,
        traces: Vec::new(),
        channels: held.channels,
    })
}

/// What a search left without a name: in the machine, or in what a sensor shows.
pub(super) fn unnamed(problem: &Problem, studied: &Studied) -> Option<Unknown> {
    residual::unknown(problem, studied)
        .or_else(|| sensor::unknown(problem, studied))
        .or_else(|| after_moves::unknown(problem, studied))
}

/// What a user should know of the data set and of the search in it, and more that was seen.
fn all_notices(problem: &Problem, all: &Studied, more: impl Iterator<Item = Notice>) -> Vec<Notice> {
    let mut notices: Vec<Notice> = problem.notices.clone();
    notices.extend(all.built.notices.clone());
    notices.extend(all.built.engine.refusal_notices());
    notices.extend(more);
    notices
}

/// The verdict, by whether something has no name and by the effects that were named.
fn verdict(is_unknown: bool, effects: &[Effect]) -> Verdict {
    if is_unknown {
        Verdict::Unknown
    } else if effects.iter().any(|effect| effect.class.len() > 1) {
        Verdict::Ambiguous
    } else if effects.is_empty() {
        Verdict::None
    } else {
        Verdict::Named
    }
}

/// The experiment that tells the first open class apart, and its scenario, while there is time.
fn next_experiment(
    problem: &Problem,
    all: &Studied,
    units: &UnitPath,
    watch: &mut Watch<'_>,
) -> (Option<NextExperiment>, Option<String>) {
    let question = open_class(all).filter(|_| !watch.is_over("the search for a next experiment"));
    let proposal = question.and_then(|question| {
        watch.stage("simulating experiments");
        crate::design::next(problem, &question, units)
    });
    proposal.map_or((None, None), |(next, text)| (Some(next), text))
}

/// Takes the effects away with which a model is farther from the rows left out than the nominal one, where something has no name: they stand
/// for a part of that. What a user asked for stays.
fn unfit(problem: &Problem, trained: &mut Studied, squares: Squares, options: &Options) -> Vec<usize> {
    let takes = options.fit.is_empty() && squares.are_widened() && unnamed(problem, trained).is_some();
    if takes { std::mem::take(&mut trained.effects) } else { Vec::new() }
}

/// Whether the rows left out judged what was found in all rows.
fn is_judged(trained: &Studied, all: &Studied) -> bool {
    !all.effects.is_empty() && all.effects.iter().all(|effect| trained.effects.contains(effect))
}

/// A search's result without these effects, and without those that can't be told from them.
fn withdraw(problem: &Problem, all: &mut Studied, unfit: &[usize]) -> Result<(), Error> {
    let alike = |list: &[Alternative]| {
        list.iter().any(|one| one.loss < all.policy.class && unfit.contains(&one.parameter))
    };
    let is_gone = |(effect, class): (&usize, &Vec<Alternative>)| unfit.contains(effect) || alike(class);
    let gone: Vec<bool> = all.effects.iter().zip(&all.classes).map(is_gone).collect();
    if !gone.contains(&true) || unnamed(problem, all).is_none() {
        return Ok(());
    }
    let engine = &all.built.engine;
    let mut start = all.fit.at.clone();
    let both = std::mem::take(&mut all.effects).into_iter().zip(std::mem::take(&mut all.classes));
    for ((effect, class), gone) in both.zip(gone) {
        if !gone {
            all.effects.push(effect);
            all.classes.push(class);
            continue;
        }
        let parameter = &engine.machine.parameters[effect];
        start.theta[effect] = parameter.neutral;
        all.story.push(format!(
            "{} is withdrawn: a search without the rows left out found it, and with it they are followed worse than by the nominal model",
            parameter.name
        ));
    }
    let free: Vec<usize> = all.fit.free.iter().copied().filter(|free| all.effects.contains(free)).collect();
    all.fit = fit(engine, &start, &free, Some(&all.residual.sizes), &FitOptions::default())?;
    all.residual = residual::judge_residual(engine, &all.fit, &all.residual.sizes, &all.policy);
    all.last = None;
    Ok(())
}

/// What a search found without the rows left out, in all rows, and how far either is from those.
pub(super) struct Searched {
    trained: Studied,
    held: HeldOut,
    /// In all rows.
    pub all: Studied,
}

/// What is found without the rows left out, or in stretches of the others, in half of the time.
pub(super) fn search_without_left_out(
    problem: &Problem,
    options: &Options,
    watch: &mut Watch<'_>,
) -> Result<Studied, Error> {
    watch.stage("searching without the rows left out");
    let (kept, _) = long::thinned(problem, parted(problem).0)?;
    let part = long::stretches(problem, &kept, options)?.unwrap_or(kept);
    let end = watch.share(HALF);
    let trained = studied(problem, &part, options, None, false, watch);
    watch.end_at(end);
    trained
}

/// Goes on from there: the gap on the rows left out, and a search in all rows.
pub(super) fn search_all_rows(
    problem: &Problem,
    options: &Options,
    mut trained: Studied,
    watch: &mut Watch<'_>,
) -> Result<Searched, Error> {
    let (_, left) = parted(problem);
    watch.stage("measuring the gap on the rows left out");
    let mut known = Trails::default();
    known.add(&trained.built.engine, &trained.nominal);
    let mut held = mismatch::held_out(problem, &left, &trained, &mut known)?;
    let unfit = unfit(problem, &mut trained, held.squares, options);
    if !unfit.is_empty() {
        held = mismatch::held_out(problem, &left, &trained, &mut known)?;
    }
    watch.stage("searching in all rows");
    let mut all = long::search(problem, options, (&trained, &known), watch)?;
    withdraw(problem, &mut all, &unfit)?;
    Ok(Searched { trained, held, all })
}

/// The first effect whose class is open.
fn open_class(studied: &Studied) -> Option<Question<'_>> {
    let policy = studied.policy;
    let near = |list: &[Alternative]| -> Vec<_> {
        list.iter().filter(|one| one.loss < policy.class).copied().collect()
    };
    let mut classes = studied.effects.iter().zip(&studied.classes).map(|(own, list)| (*own, near(list)));
    let (own, class) = classes.find(|(_, class)| class.len() > 1)?;
    Some(Question {
        engine: &studied.built.engine,
        theta: &studied.fit.at.theta,
        noise: &studied.fit.at.noise,
        own,
        effects: &studied.effects,
        class,
    })
}

/// Names that may not be given.
fn candidates(built: &Built, options: &Options) -> Vec<usize> {
    let listed = |name: &str| options.without.iter().any(|without| without == name);
    let parameters = &built.engine.machine.parameters;
    (0..parameters.len()).filter(|place| !listed(&parameters[*place].name)).collect()
}

/// The nominal model fitted: path and noises only.
pub(super) fn fit_nominal(built: &mut Built, known: &Trails) -> Result<Fit, Error> {
    let (at, runs) = built.begin_fit(&built.engine.machine.neutral(), known, &[])?;
    let mut fitted = fit_from(&built.engine, &at, runs, &[], Some(&built.sizes), &FitOptions::default())?;
    if built.engine.readmit(&fitted.at.theta, &fitted.runs, &fitted.at.noise) {
        fitted = fit(&built.engine, &fitted.at, &[], Some(&built.sizes), &FitOptions::default())?;
    }
    built.notices.extend(built.engine.outlier_notices());
    Ok(fitted)
}

/// Searches in these rows; from what was found in others and where their runs were followed, if that is given.
///
/// # Errors
/// As [`diagnosed`].
pub fn studied(
    problem: &Problem,
    runs: &[(&Run, Span)],
    options: &Options,
    before: Option<(&Studied, &Trails)>,
    classes: bool,
    watch: &mut Watch<'_>,
) -> Result<Studied, Error> {
    let mut built = build(problem, runs)?;
    check_names(&built.engine.machine, options)?;
    let candidates = candidates(&built, options);
    let none = Trails::default();
    let nominal = fit_nominal(&mut built, before.map_or(&none, |(_, known)| known))?;
    let sizes: Sizes = built.sizes.clone();
    let mut search = new_search(problem, &built, candidates, options);
    let policy = search.policy;
    search.visited.insert(Vec::new(), nominal.clone());
    let (effects, begun) = first_model(&mut search, before.map(|known| known.0), &nominal)?;
    if !options.fit.is_empty() {
        return fit_given(built, &sizes, options, &nominal.at, policy);
    }
    let end = watch.share(HALF);
    let (effects, here) = search.walk(effects, begun, watch)?;
    let here = search.with_linearised_runs(here)?;
    let (mut effects, mut here) = search.moved_across(effects, here, watch)?;
    watch.end_at(end);
    here = search.with_linearised_runs(here)?;
    let mut residual = residual::judge_residual(&built.engine, &here, &sizes, &search.policy);
    if residual.unlisted.is_some() && problem.ports.unknown_inputs {
        (effects, here, residual) = name_the_rest(&mut search, residual, effects, here, watch)?;
    }
    let mut alternatives = Vec::new();
    if classes {
        let found = effects.clone();
        (effects, here, alternatives) = search.alternatives(effects, here, watch)?;
        if effects != found {
            residual = residual::judge_residual(&built.engine, &here, &search.sizes, &search.policy);
        }
    }
    let (story, last, nominal) = (search.story, search.last, nominal.at.paths);
    let notice = |message| Notice { file: "dataset.toml".into(), line: 0, message };
    built.notices.extend(search.doubts.into_iter().map(notice));
    Ok(Studied { built, effects, fit: here, nominal, residual, story, classes: alternatives, policy, last })
}

/// A search among these candidates that has visited no model.
fn new_search<'a>(
    problem: &Problem,
    built: &'a Built,
    candidates: Vec<usize>,
    options: &'a Options,
) -> Search<'a> {
    Search {
        engine: &built.engine,
        sizes: built.sizes.clone(),
        policy: Policy::of(candidates.len(), built.engine.machine.order()),
        options: FitOptions::default(),
        candidates,
        yields: problem.ports.unknown_inputs,
        earlier: options.earlier.as_ref(),
        visited: Visited::new(),
        story: Vec::new(),
        doubts: Vec::new(),
        last: None,
    }
}

/// Where the search begins: with what was found in other rows, as far as these need it, else with the nominal model.
fn first_model(
    search: &mut Search<'_>,
    before: Option<&Studied>,
    nominal: &Fit,
) -> Result<(Vec<usize>, Fit), Error> {
    let (effects, begun) = match before.filter(|before| !before.effects.is_empty()) {
        Some(before) => {
            let mut start = nominal.at.clone();
            start.theta.clone_from(&before.fit.at.theta);
            let fitted = search.visit(&before.effects, &start)?;
            search.pruned(before.effects.clone(), fitted, "all rows together need")?
        }
        None => (Vec::new(), nominal.clone()),
    };
    Ok((effects, search.with_linearised_runs(begun)?))
}
