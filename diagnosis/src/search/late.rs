//! Delays of sensors, screened along the model's own path. Beside a large delay the smoothed path follows what the late sensor says, by
//! process noise, and along it no delay seems to gain anything; along what the model does by itself, each shows as what it is.

use super::Search;
use super::screen::{Screen, ranked};
use super::trials::interval;
use crate::dynamics::linearise::Chord;
use crate::dynamics::machine::Role;
use crate::error::Error;
use crate::infer::Fit;
use crate::infer::fit::{At, Linearise, fit_from};
use crate::infer::likelihood::reduced;
use crate::observe::OutputEffect;
use crate::statistics::levels::{HALF, SAMPLE};

impl Search<'_> {
    /// Delays of sensors that explain what a model leaves to process noise, each fitted beside its `effects` from where it explains most
    /// along the model's own path. Nothing where process noise takes over too little to matter, or units can't be run without it.
    pub(super) fn late_sensors(&mut self, effects: &[usize], from: &Fit) -> Result<Vec<(usize, Fit)>, Error> {
        let tried = self.sensors_delays(effects);
        let along = if tried.is_empty() { None } else { self.along_the_model(from)? };
        let Some(along) = along.filter(|along| along.deviance - from.deviance > self.policy.unknown) else {
            return Ok(Vec::new());
        };
        let (engine, policy) = (self.engine, self.policy);
        let row = interval(engine);
        // between rows: at a row an output may jump
        let delays = (0..SAMPLE).map(|rows| (rows as f64 + HALF) * row);
        let chord = |(parameter, to): (usize, f64)| Chord { parameter, to, per: 1.0 };
        let fits = |chord: &Chord| chord.to <= engine.machine.parameters[chord.parameter].range.1;
        let chords: Vec<Chord> = (tried.iter())
            .flat_map(|parameter| delays.clone().map(|delay| (*parameter, delay)))
            .map(chord)
            .filter(fits)
            .collect();
        let runs = engine.chords(&along.at.theta, &along.at.paths, &chords)?;
        let all: Vec<usize> = (0..chords.len()).collect();
        let whole = reduced(&runs, &along.at.noise, &all);
        let screen = Screen { runs, chords, whole };
        let best = ranked(engine, &along, &screen, &self.without_process(), &policy);
        let mut found = Vec::new();
        for screened in best.iter().take(policy.fitted).filter(|one| one.gain > policy.gain) {
            let delay = screened.chord.parameter;
            let mut start = At { paths: along.at.paths.clone(), ..from.at.clone() };
            start.theta[delay] = screened.chord.to;
            let with: Vec<usize> = effects.iter().copied().chain([delay]).collect();
            found.extend(self.visited_anew(&with, &start)?.map(|fit| (delay, fit)));
        }
        Ok(found)
    }

    /// Candidates that delay a sensor and are none of these effects.
    fn sensors_delays(&self, effects: &[usize]) -> Vec<usize> {
        let is_delay = |one: &usize| {
            matches!(self.engine.machine.parameters[*one].role, Role::Output(_, OutputEffect::Delay))
        };
        self.others(effects).into_iter().filter(is_delay).collect()
    }

    /// A fit's parameters along the path that the model takes without process noise; `None` where units can't be run so.
    fn along_the_model(&self, from: &Fit) -> Result<Option<Fit>, Error> {
        if self.engine.machine.whole || from.at.noise.disturbance.is_some() {
            return Ok(None);
        }
        let exact = self.without_process();
        let noise = exact.quieted(from.at.noise.clone());
        let theta = &from.at.theta;
        let followed = self.engine.first_paths(theta, &noise).and_then(|paths| {
            let runs = self.engine.linearise(theta, &paths, &[])?;
            let start = At { theta: theta.clone(), paths, noise };
            fit_from(self.engine, &start, runs, &[], Some(&exact), &self.options)
        });
        match followed {
            Ok(fit) => Ok(Some(fit)),
            Err(Error::Model(_)) => Ok(None),
            Err(error) => Err(error),
        }
    }
}
