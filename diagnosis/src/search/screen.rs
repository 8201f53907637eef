//! What each effect would gain beside a model, on one linearisation of it.

use super::Policy;
use super::policy::SEARCHING;
use super::trials::trials;
use crate::dynamics::linearise::{Chord, Engine};
use crate::error::Error;
use crate::infer::fit::At;
use crate::infer::likelihood::{maximise_within, reduced};
use crate::infer::{Fit, Linearised, Sizes};
use crate::statistics::linear::{Reduced, solve, submatrix, subvector};
use nalgebra::DMatrix;
use rayon::prelude::*;

/// An effect that was screened.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Screened {
    /// From where to where.
    pub chord: Chord,
    /// Deviance it gains.
    pub gain: f64,
    /// How much of the chord.
    pub amount: f64,
}

/// The linearisation with columns for all that is tried: those of the model's own parameters come first.
pub struct Screen {
    /// Runs.
    pub runs: Vec<Linearised>,
    /// Columns.
    pub chords: Vec<Chord>,
    /// Gram matrix and score of all columns, states eliminated, with the noises of the fit.
    pub whole: Reduced,
}

/// What a screening that found nothing knows of the model that it was about.
#[derive(Debug, Clone)]
pub struct Last {
    at: At,
    chords: Vec<Chord>,
    whole: Reduced,
}

impl Last {
    /// Gram matrix of the derivatives by these parameters about a fit, if it was this one and they were among its columns.
    pub fn gram(&self, engine: &Engine, at: &At, parameters: &[usize]) -> Option<DMatrix<f64>> {
        let place = |parameter: &usize| {
            let local = engine.local(&at.theta, *parameter);
            self.chords.iter().position(|chord| *chord == local)
        };
        let places: Vec<usize> = parameters.iter().map(place).collect::<Option<_>>()?;
        (self.at == *at).then(|| submatrix(&self.whole.gram, &places))
    }
}

impl Screen {
    /// What stays known of it about this fit.
    pub fn last(self, fit: &Fit) -> Last {
        Last { at: fit.at.clone(), chords: self.chords, whole: self.whole }
    }

    /// The runs with the derivatives by these parameters as columns, where the linearisation has them all.
    pub fn about(&self, engine: &Engine, theta: &[f64], free: &[usize]) -> Option<Vec<Linearised>> {
        let place = |parameter: &usize| {
            let local = engine.local(theta, *parameter);
            self.chords.iter().position(|chord| *chord == local)
        };
        let columns: Vec<usize> = free.iter().map(place).collect::<Option<_>>()?;
        Some(self.runs.iter().map(|run| run.with_columns(&columns)).collect())
    }
}

/// Linearises about a fit, with a column for each trial of each of these parameters.
///
/// # Errors
/// A unit failed.
pub fn linearised(engine: &Engine, fit: &Fit, others: &[usize]) -> Result<Screen, Error> {
    let mut chords: Vec<Chord> = fit.free.iter().map(|own| engine.local(&fit.at.theta, *own)).collect();
    for other in others {
        chords.extend(trials(engine, &fit.at.theta, *other));
    }
    let runs = engine.chords(&fit.at.theta, &fit.at.paths, &chords)?;
    let all: Vec<usize> = (0..chords.len()).collect();
    let whole = reduced(&runs, &fit.at.noise, &all);
    Ok(Screen { runs, chords, whole })
}

/// What the column gains beside the model's own, within its range.
fn gain(
    engine: &Engine,
    fit: &Fit,
    reduced: &Reduced,
    own: usize,
    chord: &Chord,
    column: usize,
) -> (f64, f64) {
    let beside: Vec<usize> = (0..own).collect();
    let gained = |places: &[usize]| {
        let (gram, score) = (submatrix(&reduced.gram, places), subvector(&reduced.score, places));
        let shift = solve(&gram, &score)?;
        Some((shift.dot(&score), shift))
    };
    let mut with = beside.clone();
    with.push(column);
    let before = gained(&beside).map_or(0.0, |(gain, _)| gain);
    let Some((after, shift)) = gained(&with) else { return (0.0, 0.0) };
    let amount = shift[own];
    let gain = if is_allowed(engine, &fit.at.theta, chord, amount) { after - before } else { 0.0 };
    (gain, amount)
}

/// Whether so much of a chord leaves its parameter within its range.
pub(super) fn is_allowed(engine: &Engine, theta: &[f64], chord: &Chord, amount: f64) -> bool {
    let theta = theta[chord.parameter];
    if chord.per == 1.0 && (chord.to - theta) != 1.0 {
        return amount > 0.0;
    }
    let (least, most) = engine.machine.parameters[chord.parameter].range;
    (theta <= least && amount > 0.0) || (theta >= most && amount < 0.0) || (theta > least && theta < most)
}

/// The best trial of each parameter, the best first; the first of them with the noises taken anew.
pub fn ranked(engine: &Engine, fit: &Fit, screen: &Screen, sizes: &Sizes, policy: &Policy) -> Vec<Screened> {
    let own = fit.free.len();
    let all: Vec<usize> = (0..screen.chords.len()).collect();
    let mut list: Vec<(usize, Screened)> = (own..screen.chords.len())
        .map(|column| {
            let chord = screen.chords[column];
            let (gain, amount) = gain(engine, fit, &screen.whole, own, &chord, column);
            (column, Screened { chord, gain, amount })
        })
        .filter(|(_, screened)| screened.gain > 0.0)
        .collect();
    list.sort_by(|a, b| b.1.gain.total_cmp(&a.1.gain));
    let before = maximise_within(&screen.runs, &all[..own], &fit.at.noise, sizes, SEARCHING.look_rounds).1;
    let looked: Vec<Screened> = list
        .par_iter()
        .take(policy.looked)
        .map(|(column, screened)| {
            let mut columns = all[..own].to_vec();
            columns.push(*column);
            let after =
                maximise_within(&screen.runs, &columns, &fit.at.noise, sizes, SEARCHING.look_rounds).1;
            Screened { gain: before - after, ..*screened }
        })
        .collect();
    let mut ranked: Vec<Screened> = Vec::new();
    for screened in looked.into_iter().chain(list.iter().skip(policy.looked).map(|(_, screened)| *screened)) {
        match ranked.iter_mut().find(|known| known.chord.parameter == screened.chord.parameter) {
            Some(known) if known.gain < screened.gain => *known = screened,
            Some(_) => {}
            None => ranked.push(screened),
        }
    }
    ranked.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    ranked
}
