//! Delays of sensors, screened along the model's own path. Beside a large delay the smoothed path follows what the late sensor says, by
//! process noise, and along it no delay seems to gain anything; along what the model does by itself, each shows as what it is.

use super::Search;
use super::screen::{Screen, Screened, ranked};
use super::trials::interval;
use crate::dynamics::linearise::Chord;
use crate::dynamics::machine::Role;
use crate::error::Error;
use crate::infer::Fit;
use crate::infer::fit::{At, Linearise, Path, fit_from};
use crate::infer::likelihood::reduced;
use crate::observe::OutputEffect;
use crate::statistics::levels::{HALF, SAMPLE};

/// What was screened along the model's own path: the best, and the path of each run.
struct Along {
    best: Vec<Screened>,
    paths: Vec<Path>,
}

impl Search<'_> {
    /// Delays of sensors that explain what a model leaves to process noise, each fitted beside its `effects` from where it explains most
    /// along the model's own path. Nothing where process noise takes over too little to matter, or units can't be run without it.
    ///
    /// # Errors
    /// Units are too slow.
    pub(super) fn late_sensors(&mut self, effects: &[usize], from: &Fit) -> Result<Vec<(usize, Fit)>, Error> {
        let tried = self.delays(effects);
        if tried.is_empty() || self.engine.machine.whole || from.at.noise.disturbance.is_some() {
            return Ok(Vec::new());
        }
        let screened = match self.screened_along_the_model(from, tried) {
            Ok(screened) => screened,
            Err(Error::Model(_)) => None,
            Err(error) => return Err(error),
        };
        let Some(Along { best, paths }) = screened else { return Ok(Vec::new()) };
        let mut found = Vec::new();
        for Screened { chord, .. } in best {
            let mut start = At { paths: paths.clone(), ..from.at.clone() };
            start.theta[chord.parameter] = chord.to;
            let with: Vec<usize> = effects.iter().copied().chain([chord.parameter]).collect();
            found.extend(self.visited_anew(&with, &start)?.map(|fit| (chord.parameter, fit)));
        }
        Ok(found)
    }

    /// The best of these chords along the path that a fit's parameters make without process noise; nothing where that leaves hardly more.
    fn screened_along_the_model(&self, from: &Fit, chords: Vec<Chord>) -> Result<Option<Along>, Error> {
        let (engine, exact, theta) = (self.engine, self.without_process(), &from.at.theta);
        let noise = exact.quieted(from.at.noise.clone());
        let paths = engine.first_paths(theta, &noise)?;
        let runs = engine.linearise(theta, &paths, &[])?;
        let start = At { theta: theta.clone(), paths, noise };
        let along = fit_from(engine, &start, runs, &[], Some(&exact), &self.options)?;
        if along.deviance - from.deviance <= self.policy.unknown {
            return Ok(None);
        }
        let runs = engine.chords(theta, &along.at.paths, &chords)?;
        let all: Vec<usize> = (0..chords.len()).collect();
        let whole = reduced(&runs, &along.at.noise, &all);
        let mut best = ranked(engine, &along, &Screen { runs, chords, whole }, &exact, &self.policy);
        best.truncate(self.policy.fitted);
        best.retain(|one| one.gain > self.policy.gain);
        Ok(Some(Along { best, paths: along.at.paths }))
    }

    /// A delay of each sensor that none of these effects delays, by every number of rows that there may be: between rows, since at a row an
    /// output may jump.
    fn delays(&self, effects: &[usize]) -> Vec<Chord> {
        let (parameters, row) = (&self.engine.machine.parameters, interval(self.engine));
        let is_delay = |one: &usize| matches!(parameters[*one].role, Role::Output(_, OutputEffect::Delay));
        let chord =
            |parameter: usize, rows: usize| Chord { parameter, to: (rows as f64 + HALF) * row, per: 1.0 };
        let fits = |chord: &Chord| chord.to <= parameters[chord.parameter].range.1;
        let others = self.others(effects).into_iter().filter(is_delay);
        others.flat_map(|one| (0..SAMPLE).map(move |rows| chord(one, rows))).filter(fits).collect()
    }
}
