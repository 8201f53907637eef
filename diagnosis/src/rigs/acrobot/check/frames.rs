//! Frames in the order of time: single ones that show something else, or a value that swings.

use super::policy::CHECK;
use crate::rigs::acrobot::candidates::{Attribute, Candidate, Side};
use crate::rigs::acrobot::selection::Evaluation;
use crate::statistics::levels::{HALF, PART, ROUNDING};
use crate::statistics::linear::{Cell, Projected, projected};
use crate::statistics::squares;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Frames in the order of time, each with its run, its time, and what is left of it.
pub(super) struct Frames {
    all: Vec<(usize, f64, Left)>,
    /// Squares that noise doesn't leave.
    more: f64,
}

/// What nuisances leave of a frame: the squares, and how many noise leaves, and of each column its score and its squared length.
struct Left {
    square: f64,
    freedom: f64,
    columns: Vec<(f64, f64)>,
}

impl Left {
    fn of(cell: &Cell, discrepancy_sd: f64) -> Self {
        let Projected { residual, columns, freedom, .. } = projected(cell, discrepancy_sd);
        let columns = columns.column_iter().map(|own| (own.dot(&residual), own.norm_squared()));
        Self { square: residual.norm_squared(), freedom, columns: columns.collect() }
    }
}

/// An effect of the camera that swings with time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Swing {
    pub(super) candidate: usize,
    pub(super) hertz: f64,
    /// Decrease of the squares, in units of noise.
    pub(super) gain: f64,
    /// Its mean over all frequencies: more than noise's where times scatter.
    pub(super) usual: f64,
    /// Runs, each of which has a size and a phase of its own.
    pub(super) runs: usize,
}

impl Swing {
    /// In words.
    pub(super) fn words(&self, list: &[Candidate]) -> String {
        let Candidate { name, phrase, .. } = &list[self.candidate];
        format!("swinging {:.2} times a second, as if {name} ({phrase}) did", self.hertz)
    }

    /// The normal deviate that is as rare as such a gain of noise, of which a size and a phase a run have a χ².
    pub(super) fn deviations(&self) -> f64 {
        let freedom = 2.0 * self.runs as f64;
        squares::deviate(freedom * (self.gain / self.usual.max(freedom)), freedom)
    }
}

impl Frames {
    pub(super) fn of(at: &Evaluation) -> Self {
        let cells: Vec<(usize, &Cell)> = at
            .blocks
            .iter()
            .flat_map(|block| block.cells.iter().map(move |cell| (block.run, cell)))
            .collect();
        let reduced = |(run, cell): &(usize, &Cell)| {
            (*run, cell.time.first().copied().unwrap_or(0.0), Left::of(cell, at.discrepancy_sd))
        };
        let all: Vec<_> = cells.par_iter().map(reduced).collect();
        let more = all.iter().map(|(_, _, left)| left.square - left.freedom).sum();
        Self { all, more }
    }

    /// In words, if single frames hold nearly all of what is left.
    pub(super) fn single(&self, at: &Evaluation, list: &[Candidate]) -> Option<String> {
        let far = |place: usize| {
            self.all
                .get(place)
                .is_some_and(|(_, _, left)| left.square > CHECK.far_frame * left.freedom.max(1.0))
        };
        let those: Vec<usize> = (0..self.all.len()).filter(|place| far(*place)).collect();
        let groups = those.iter().filter(|place| !far(place.wrapping_sub(1))).count();
        let squares: f64 = those.iter().map(|place| self.all[*place].2.square).sum();
        // two that were exchanged stand side by side
        if squares < HALF * self.more
            || those.len() > 2 * groups
            || those.len() as f64 > HALF * self.all.len() as f64
        {
            return None;
        }
        let (count, of) = (those.len(), self.all.len());
        let first = self.all[*those.first()?].1;
        let delay = list.iter().position(|candidate| candidate.is(Attribute::ImageDelay));
        let column = delay.and_then(|delay| at.places(&[delay]).first().copied());
        let moved: f64 = column.map_or(0.0, |column| {
            let gain = |place: &usize| gain(&self.all[*place].2, column);
            those.iter().map(gain).sum::<f64>() / squares
        });
        let how = if moved > 1.0 - PART {
            "they show another moment than their timestamp says: repeated, exchanged or held up"
        } else {
            "they don't show what the others do"
        };
        Some(format!("single frames, {count} of {of}, the first at {first:.2} s: {how}"))
    }

    /// The effect of the camera that explains most of what is left if it swings with time.
    pub(super) fn swing(&self, at: &Evaluation, list: &[Candidate]) -> Option<Swing> {
        let runs: Vec<&[(usize, f64, Left)]> = self.all.chunk_by(|a, b| a.0 == b.0).collect();
        let length = |run: &&[(usize, f64, Left)]| run[run.len() - 1].1 - run[0].1;
        let longest = runs.iter().max_by(|a, b| length(a).total_cmp(&length(b)))?;
        let (span, count) = (length(longest), longest.len());
        // by half the resolution of the longest run, as fast as frames tell
        let swings = count.checked_sub(2).filter(|_| span > 0.0)?;
        let still = |candidate: &Candidate| {
            candidate.side == Side::Camera && !candidate.is_discrete() && !candidate.is(Attribute::ImageDelay)
        };
        let told = |column: usize| runs.iter().map(|run| Told::by(run, column)).collect();
        let columns: Vec<(usize, Vec<Told>)> = (0..list.len())
            .filter(|index| still(&list[*index]))
            .filter_map(|index| Some((index, told(*at.places(&[index]).first()?))))
            .collect();
        let gains: Vec<Vec<f64>> = (2..swings)
            .into_par_iter()
            .map(|half| {
                let hertz = HALF * half as f64 / span;
                let phases: Vec<Vec<(f64, f64)>> = (runs.iter())
                    .map(|run| run.iter().map(|(_, time, _)| libm::sincos(TAU * hertz * time)).collect())
                    .collect();
                let gain =
                    |told: &[Told]| told.iter().zip(&phases).map(|(run, phases)| run.swung(phases)).sum();
                columns.iter().map(|(_, told)| gain(told)).collect()
            })
            .collect();
        let best = |(place, (candidate, _)): (usize, &(usize, Vec<Told>))| {
            let own = gains.iter().map(|gains| gains[place]);
            let (half, gain) = own.clone().enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
            let usual = own.sum::<f64>() / gains.len() as f64;
            let hertz = HALF * (half + 2) as f64 / span;
            Some(Swing { candidate: *candidate, hertz, gain, usual, runs: runs.len() })
        };
        columns.iter().enumerate().filter_map(best).max_by(|a, b| a.deviations().total_cmp(&b.deviations()))
    }

    /// The share of what noise doesn't leave that a swing explains.
    pub(super) fn share(&self, swing: &Swing) -> f64 {
        if self.more > 0.0 { swing.gain / self.more } else { 0.0 }
    }
}

/// Decrease of the squares that a value of its own brings.
fn gain(left: &Left, column: usize) -> f64 {
    let (score, length) = left.columns[column];
    if length > 0.0 { score * score / length } else { 0.0 }
}

/// What a run's frames tell of one value: for each the score and the squared length of its column.
struct Told(Vec<(f64, f64)>);

impl Told {
    fn by(run: &[(usize, f64, Left)], column: usize) -> Self {
        Self(run.iter().map(|(_, _, left)| left.columns[column]).collect())
    }

    /// Decrease of the squares by a value that swings, of the best size and phase.
    fn swung(&self, phases: &[(f64, f64)]) -> f64 {
        let (mut score, mut gram) = ([0.0; 2], [0.0; 3]);
        for ((own, length), (sin, cos)) in self.0.iter().zip(phases) {
            score[0] += cos * own;
            score[1] += sin * own;
            gram[0] += cos * cos * length;
            gram[1] += cos * sin * length;
            gram[2] += sin * sin * length;
        }
        let determinant = gram[0] * gram[2] - gram[1] * gram[1];
        // a phase that no frame shows
        if determinant <= ROUNDING * gram[0] * gram[2] {
            return 0.0;
        }
        (gram[2] * score[0] * score[0] - 2.0 * gram[1] * score[0] * score[1] + gram[0] * score[1] * score[1])
            / determinant
    }
}
