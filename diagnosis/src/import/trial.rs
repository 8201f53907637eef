//! Runs the model on a log's inputs and compares: signs, units of measurement that no header names, large offsets.

use super::policy::IMPORT;
use super::sheet::Sheet;
use super::slow::Pace;
use super::starts::{self, Start};
use super::straight_line::{Line, line};
use super::{Match, Time, instance};
use crate::check::{STRETCH, Signs};
use crate::error::Error;
use crate::observe::{Affine, measure};
use crate::statistics::levels::SEVERAL;
use ended::{Failed, Within};
use judge::{Told, judge};
use orchestrator::fmu::Description;
use orchestrator::scenario::{Shape, SignalEntry, SourceEntry};
use orchestrator::{Fmu, Isolation, MemoryRecorder, Place, Scenario, Simulation, UnitPath};
use std::time::{Duration, Instant};

/// What is known before a trial.
#[derive(Clone, Copy)]
pub(super) struct Known<'a> {
    /// The unit.
    pub fmu: &'a Fmu,
    /// Where units are found by name.
    pub units: &'a UnitPath,
    /// The longest log.
    pub sheet: &'a Sheet,
    /// Where its time stands, and in what unit.
    pub time: &'a Time,
    /// Which parameters are starts of which states.
    pub starts: &'a [Start],
    /// The signs that stretches of the logs tell, where they do.
    pub signs: Option<&'a Signs>,
    /// Limits of processes of its own, if runs are made in such.
    pub isolation: Option<&'a Isolation>,
}

impl<'a> Known<'a> {
    /// The model on the inputs of the log, matched so.
    pub fn trial(&self, matches: &'a [Match]) -> Trial<'a> {
        let Self { fmu, units, sheet, time, starts, isolation, .. } = *self;
        Trial { fmu, units, sheet, time, starts, matches, isolation }
    }
}

/// Tries every match against the model and writes what it says beside it. `unshown`: starts of states that no variable shows.
pub(super) fn against_model(
    known: &Known<'_>,
    unshown: &[usize],
    matches: &mut [Match],
    notices: &mut Vec<String>,
) {
    let Known { fmu, starts, signs, .. } = *known;
    if let Some(signs) = signs {
        matches.iter_mut().for_each(|matched| with_sign(matched, signs, fmu, notices));
    }
    let fed: Vec<usize> = (0..matches.len()).filter(|place| matches[*place].fed).collect();
    let ways = if signs.is_none() { turned_ways(fed.len()) } else { 1 };
    let (turns, lines) = match likeliest_signs(known, matches, &fed, ways) {
        Ok(found) => found,
        Err(failed) => {
            let why = failed.as_ref().map_or("nothing to run", Failed::in_short);
            notices.push(format!("signs and units were not tried against the model: {why}"));
            return;
        }
    };
    let described = fmu.description();
    for (bit, place) in fed.iter().enumerate().filter(|_| ways > 1) {
        let matched = &mut matches[*place];
        if turns >> bit & 1 == 1 {
            let own = converted(matched, described);
            matched.affine = Some(Affine { scale: -own.scale, offset: -own.offset });
            matched.evidence.push("sign turned: the model follows the logs better so".into());
            notices.push(format!("column {:?}: sign turned, by trial", matched.column));
        } else {
            matched.evidence.push("sign as logged: no other follows the logs better".into());
        }
    }
    let (tried, free) = (matches.to_vec(), elsewhere::free_starts(starts, unshown, matches));
    let trial = known.trial(&tried);
    let shifted_by = |matched: &Match| trial.shifted_by(matched, &free).map(str::to_owned);
    let told = Told { description: described, starts, signs: signs.is_some(), shifted_by: &shifted_by };
    for (matched, line) in matches.iter_mut().zip(lines) {
        // a sign that is known and that the whole log contradicts: the model drifts off, and this line says nothing
        if let Some(line) = line.filter(|line| signs.is_none() || line.slope > 0.0) {
            judge(matched, line, &told, notices);
        }
    }
}

/// The way of so many with which the model follows the logs best: which signs of the `fed` it turns, a bit each, and the line of each output.
/// An error is why the last of them couldn't be run.
fn likeliest_signs(
    known: &Known<'_>,
    matches: &[Match],
    fed: &[usize],
    ways: usize,
) -> Result<(usize, Vec<Option<Line>>), Option<Failed>> {
    let mut best: Option<(f64, usize, Vec<Option<Line>>)> = None;
    let (mut failed, began) = (None, Instant::now());
    let counted = counted_starts(known.starts, matches);
    let from_the_first_row = known.trial(matches).stretch().is_ok_and(|stretch| stretch.first == 0);
    let mut begins = vec![known.starts];
    if counted.len() < known.starts.len() && from_the_first_row {
        begins.push(&counted);
    }
    for (turns, place) in (0..ways).flat_map(|turns| (0..begins.len()).map(move |place| (turns, place))) {
        let sign = |place: usize| match fed.iter().position(|other| *other == place) {
            Some(bit) if turns >> bit & 1 == 1 => -1.0,
            _ => 1.0,
        };
        let begun = Known { starts: begins[place], ..*known };
        // the best of those that were tried may not be the best
        if began.elapsed().as_secs_f64() > IMPORT.patience {
            return Err(Some(Failed::too_slow()));
        }
        let lines = match begun.trial(matches).compared(&sign) {
            Ok(lines) => lines,
            Err(why) => {
                failed = Some(why);
                continue;
            }
        };
        let told: Vec<&Line> = lines.iter().flatten().collect();
        // a sign is turned where the model then does what the log does, in size as well
        if turns > 0 && !told.iter().any(|line| line.fits()) {
            continue;
        }
        let flips =
            (turns as u32).count_ones() as usize + told.iter().filter(|line| line.slope < 0.0).count();
        let mean = told.iter().map(|line| line.correlation.powi(2)).sum::<f64>() / told.len().max(1) as f64;
        let score = score(mean, flips + place);
        if best.as_ref().is_none_or(|(before, ..)| score > *before) {
            best = Some((score, turns, lines));
        }
    }
    best.map(|(_, turns, lines)| (turns, lines)).ok_or(failed)
}

/// The starts of states whose measured values are in a known unit: what is counted in nobody knows what may not say where the model starts.
fn counted_starts(starts: &[Start], matches: &[Match]) -> Vec<Start> {
    let is_counted = |one: &&Start| {
        let without = |matched: &Match| matched.unit.is_none() && matched.affine.is_none();
        !matches.iter().any(|matched| matched.variable == one.shows && without(matched))
    };
    starts.iter().filter(is_counted).copied().collect()
}

/// Ways in which the signs of so many inputs are tried.
fn turned_ways(inputs: usize) -> usize {
    if inputs <= IMPORT.turned_inputs { 1 << inputs } else { 1 }
}

/// What a way is worth by its mean squared correlation and the signs that it turns.
fn score(mean: f64, flips: usize) -> f64 {
    mean - IMPORT.turn * flips as f64
}

/// Gives a match the sign that stretches of the logs tell.
fn with_sign(matched: &mut Match, signs: &Signs, fmu: &Fmu, notices: &mut Vec<String>) {
    let turned = signs.turned.contains(&name(fmu, matched));
    let left = format!(
        "the model follows stretches of {STRETCH} rows so, and leaves at most {:.0} % of an output's motion",
        100.0 * signs.left
    );
    if turned {
        let own = converted(matched, fmu.description());
        matched.affine = Some(Affine { scale: -own.scale, offset: -own.offset });
        notices.push(format!("column {:?}: sign turned, by trial: {left}", matched.column));
    }
    let how = if turned { "turned" } else { "as logged" };
    matched.evidence.push(format!("sign {how}: {left}"));
}

/// What the numbers of a column are by what is known.
fn converted(matched: &Match, description: &Description) -> Affine {
    let variable = &description.variables[matched.variable];
    let by_unit = || measure::conversion(matched.unit.as_deref()?, variable, description).ok();
    matched.affine.or_else(by_unit).unwrap_or(Affine::SAME)
}

/// The model on the inputs of a log.
pub(super) struct Trial<'a> {
    /// The unit.
    pub fmu: &'a Fmu,
    /// Where units are found by name.
    pub units: &'a UnitPath,
    /// The log.
    pub sheet: &'a Sheet,
    /// Where its time stands, and in what unit.
    pub time: &'a Time,
    /// Which parameters are starts of which states.
    pub starts: &'a [Start],
    /// Which column is which variable.
    pub matches: &'a [Match],
    /// In processes of its own, if that is asked for.
    pub isolation: Option<&'a Isolation>,
}

/// Name of a matched variable in a scenario of the unit alone.
pub(super) fn name(fmu: &Fmu, matched: &Match) -> String {
    format!("{}.{}", instance(fmu), fmu.description().variables[matched.variable].name)
}

/// A log's longest stretch without a gap.
struct Stretch {
    /// Times of its rows from its begin on, s.
    times: Vec<f64>,
    /// Its first row in the log.
    first: usize,
    /// Usual distance of rows, s.
    gap: f64,
}

impl Trial<'_> {
    fn stretch(&self) -> Result<Stretch, Failed> {
        let place = self.sheet.place(&self.time.name).ok_or_else(|| Failed::other("no time"))?;
        let (all, usual) = (self.sheet.column(place), self.sheet.usual_gap(place));
        let stretch = whole_stretch(&all, usual);
        let timestamps = &all[stretch.clone()];
        let times = timestamps.iter().map(|time| (time - timestamps[0]) * self.time.seconds).collect();
        Ok(Stretch { times, first: stretch.start, gap: usual * self.time.seconds })
    }

    /// Times and values of a column as the variable has them.
    fn values(&self, stretch: &Stretch, matched: &Match, sign: f64) -> Vec<(f64, f64)> {
        let affine = converted(matched, self.fmu.description());
        let column =
            self.sheet.place(&matched.column).map(|column| self.sheet.column(column)).unwrap_or_default();
        let rows = stretch.times.iter().zip(column.into_iter().skip(stretch.first));
        let known = rows.filter(|(time, value)| time.is_finite() && value.is_finite());
        known.map(|(time, value)| (*time, sign * affine.apply(value))).collect()
    }

    /// Runs it as the data set has it so far, in a process of its own whatever was asked for: nobody here has run this unit before, and that
    /// process tells the most of how it ended. What else a run may be refused for is told by what follows.
    ///
    /// Gives what to say where it takes too long.
    ///
    /// # Errors
    /// The unit crashed, ended its process, or did not come back from a call.
    pub(super) fn rehearse(&self, limits: &Isolation, pace: &Pace) -> Result<Option<String>, Error> {
        let mut within = Within::new(Some(pace.patience()));
        let run = self
            .stretch()
            .and_then(|stretch| self.simulated(&stretch, &|_| 1.0, &[], Some(limits), &mut within));
        let Err(Failed { why, died: true }) = run else {
            return Ok(within.over.then(|| pace.too_slow()));
        };
        let (log, file) = (self.sheet.path.display(), self.fmu.path().display());
        let times = pace.question().map(|question| format!("; {question}")).unwrap_or_default();
        Err(Error::Model(format!(
            "{file} can't be run on {log}, and nothing was written: {why}\n`acroscope check {file}` tells what is wrong with a unit; one that is \
             only slow has more time with --step-limit{times}"
        )))
    }

    /// Runs it with some parameters set in a process of its own, `None` beyond a limit of real time; an error is why it didn't run.
    pub(super) fn run(
        &self,
        set: &[(String, String)],
        limit: Option<Duration>,
    ) -> Result<Option<MemoryRecorder>, Failed> {
        let own = self.isolation.cloned().unwrap_or_default();
        let call = limit.map(|limit| limit.mul_f64(SEVERAL)).unwrap_or(own.step_limit);
        let isolation = Isolation { step_limit: call.min(own.step_limit), ..own };
        let mut within = Within::new(limit);
        let results = self.simulated(&self.stretch()?, &|_| 1.0, set, Some(&isolation), &mut within)?;
        Ok((!within.over).then_some(results))
    }

    fn simulated(
        &self,
        stretch: &Stretch,
        sign: &dyn Fn(usize) -> f64,
        set: &[(String, String)],
        isolation: Option<&Isolation>,
        within: &mut Within,
    ) -> Result<MemoryRecorder, Failed> {
        let mut scenario = scenario(self.fmu, &stretch.times, stretch.gap)?;
        scenario.units.iter_mut().for_each(|unit| unit.isolation = isolation.cloned());
        let own = |parameter: &str| format!("{}.{parameter}", instance(self.fmu));
        for (at, matched) in self.matches.iter().enumerate() {
            let points = self.values(stretch, matched, sign(at));
            let Some((_, first)) = points.first() else { continue };
            if matched.fed {
                let place = Place::Override(matched.column.clone());
                let signal = SignalEntry::Table { shape: Shape::Hold, points };
                scenario.sources.push(SourceEntry { to: name(self.fmu, matched), signal, place });
            } else if let Some(start) = starts::find(self.starts, matched.variable) {
                let start = &self.fmu.description().variables[start.start].name;
                let _ = scenario.set(&own(start), &first.to_string());
            }
        }
        for (parameter, value) in set {
            scenario.set(&own(parameter), value)?;
        }
        let mut results = MemoryRecorder::new();
        Simulation::new(&scenario, self.units)?.run(&mut results, within)?;
        Ok(results)
    }

    /// Runs it and gives each output its line.
    fn compared(&self, sign: &dyn Fn(usize) -> f64) -> Result<Vec<Option<Line>>, Failed> {
        let stretch = self.stretch()?;
        let mut within = Within::new(Some(Duration::from_secs_f64(IMPORT.patience)));
        let results = self.simulated(&stretch, sign, &[], self.isolation, &mut within)?;
        if within.over {
            return Err(Failed::too_slow());
        }
        let outputs = || self.matches.iter().filter(|matched| !matched.fed);
        let begun = stretch.first == 0
            || outputs().all(|matched| starts::find(self.starts, matched.variable).is_some());
        let line_of = |(at, matched): (usize, &Match)| {
            let series = results.series(&name(self.fmu, matched)).ok().filter(|_| !matched.fed)?;
            let found = line(&self.values(&stretch, matched, sign(at)), results.times(), series)?;
            Some(Line { begun, ..found })
        };
        Ok(self.matches.iter().enumerate().map(line_of).collect())
    }
}

/// The longest stretch of rows without a gap: what acted within one is not known.
fn whole_stretch(timestamps: &[f64], usual: f64) -> std::ops::Range<usize> {
    let torn = |row: &usize| timestamps[*row] - timestamps[row - 1] > IMPORT.gap * usual;
    let edges: Vec<usize> =
        [0].into_iter().chain((1..timestamps.len()).filter(torn)).chain([timestamps.len()]).collect();
    let longest = edges.windows(2).map(|pair| pair[0]..pair[1]).max_by_key(|stretch| stretch.len());
    let longest = longest.unwrap_or(0..timestamps.len());
    longest.start..longest.end.min(longest.start + IMPORT.rows)
}

/// The unit alone, for the span of a log.
fn scenario(fmu: &Fmu, times: &[f64], gap: f64) -> Result<Scenario, Failed> {
    let own = fmu.description().default_experiment.step_size.filter(|step| *step > 0.0).unwrap_or(gap);
    // no finer than a tenth of a row: this is a trial
    let interval = format!("{:.3e}", gap.min(own).max(0.1 * gap));
    let stop = format!("{:.6e}", times.last().copied().unwrap_or(0.0));
    let quoted = |text: &str| toml::Value::String(text.to_owned()).to_string();
    let path = fmu.path().canonicalize().map_err(Failed::other)?;
    let text = format!(
        "format = 1\n[experiment]\nstop = {stop}\n[[units]]\nname = {}\nfmu = {}\ninterval = {interval}\n",
        quoted(&instance(fmu)),
        quoted(&path.to_string_lossy()),
    );
    Ok(Scenario::parse(&text, "import.toml")?)
}

mod elsewhere;
mod ended;
mod judge;
#[cfg(test)]
mod tests;
