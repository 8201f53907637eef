//! What is left of an output that follows moves of an input in the rows before: a resonance, a second path. Residuals of a model that lacks nothing
//! are independent of past inputs (Ljung, *System Identification*, 2nd ed., Prentice Hall 1999, section 16.6).
//!
//! An output whose noise is estimated takes such a rest up as noise, and no process noise is left to tell of it. A sensor's own memory follows
//! no input: against as much of it by chance stand the same residuals moved along the log.

use super::policy::GENERAL;
use super::sensor::{Residuals, residuals, told};
use super::study::Studied;
use crate::diagnosis::Unknown;
use crate::dynamics::grid::Grid;
use crate::observe::Problem;
use crate::statistics::levels::{HALF, ROUNDING, SAMPLE, SLIGHT, SMALL};
use crate::statistics::linear::solve;
use nalgebra::{DMatrix, DVector};

/// The output of which most follows an input, if one does.
pub fn unknown(problem: &Problem, studied: &Studied) -> Option<Unknown> {
    let engine = &studied.built.engine;
    let machine = &engine.machine;
    let moves = |input: usize| engine.grids.iter().map(|grid| moves(grid, input)).collect();
    let inputs: Vec<Explained> =
        (0..machine.inputs.len()).map(|input| Explained::new(moves(input))).collect();
    let judged = (0..machine.channels.len()).filter_map(|channel| {
        let left = residuals(studied, channel);
        let motion = studied.built.scatter[channel].size;
        let each = inputs.iter().enumerate();
        let found = each.filter_map(|(input, explained)| Some((followed(&left, explained, motion)?, input)));
        let (share, input) = found.max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some((share, channel, input))
    });
    let (share, channel, input) = judged.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let (output, input) = (&machine.channels[channel], &machine.inputs[input]);
    let left = residuals(studied, channel);
    Some(Unknown {
        shape: format!(
            "{:.0} % of it follow moves of {} in the {} rows before",
            100.0 * share,
            input.name,
            GENERAL.apart
        ),
        depends_on: vec![input.name.clone()],
        nearest: "no listed effect follows such a move".into(),
        ..told(problem, studied, output, &left)
    })
}

/// By how much an input moves to each row from the one before.
fn moves(grid: &Grid, input: usize) -> Vec<f64> {
    let values: Vec<f64> = grid.time.iter().map(|time| grid.inputs[input].value(*time)).collect();
    std::iter::once(0.0).chain(values.windows(2).map(|pair| pair[1] - pair[0])).collect()
}

/// The share of residuals that follows an input's moves, if it is one that chance doesn't give, of an output that moves by so much.
fn followed(left: &Residuals, explained: &Explained, motion: f64) -> Option<f64> {
    let runs: Vec<Vec<f64>> =
        left.iter().map(|run| run.iter().map(|(_, value)| value.unwrap_or(0.0)).collect()).collect();
    let count = left.iter().flatten().filter(|(_, value)| value.is_some()).count();
    let square: f64 = runs.iter().flatten().map(|value| value * value).sum();
    let own = explained.of(&runs, 0.0)?;
    let share = own / square;
    let size = (own / count.max(1) as f64).sqrt();
    // less of either is what a model that is right leaves of steps within a row, in logs without noise above all
    if !(share >= SMALL && size >= SLIGHT * motion) {
        return None;
    }
    let along = (1..SAMPLE).map(|part| part as f64 / SAMPLE as f64).filter(|part| {
        // nearer by than moves are asked for, what follows them is among it still
        let rows = runs.iter().map(Vec::len).max().unwrap_or(0) as f64;
        part.min(1.0 - part) * rows >= GENERAL.apart as f64
    });
    let by_chance = along.filter_map(|part| explained.of(&runs, part)).max_by(f64::total_cmp)?;
    // an input that comes again explains as much a period later: then nothing is told
    (by_chance <= HALF * own).then_some(share)
}

/// What moves of an input explain of residuals: by least squares, each row by those of the rows up to it.
struct Explained {
    moves: Vec<Vec<f64>>,
    gram: DMatrix<f64>,
}

impl Explained {
    fn new(moves: Vec<Vec<f64>>) -> Self {
        let lags = GENERAL.apart;
        let mut gram = DMatrix::zeros(lags, lags);
        for run in &moves {
            for row in 0..run.len() {
                let past = |lag: usize| row.checked_sub(lag).map_or(0.0, |row| run[row]);
                for i in 0..lags {
                    (0..lags).for_each(|j| gram[(i, j)] += past(i) * past(j));
                }
            }
        }
        let ridge = ROUNDING * gram.trace();
        (0..lags).for_each(|lag| gram[(lag, lag)] += ridge);
        Self { moves, gram }
    }

    /// Of the residuals of each run moved along it, round its end, by this part of it.
    fn of(&self, runs: &[Vec<f64>], part: f64) -> Option<f64> {
        let mut score = DVector::zeros(self.gram.nrows());
        for (run, moves) in runs.iter().zip(&self.moves) {
            let by = (part * run.len() as f64) as usize;
            for (row, value) in run.iter().cycle().skip(by).take(run.len()).enumerate() {
                let lags = score.len().min(row + 1);
                (0..lags).for_each(|lag| score[lag] += value * moves[row - lag]);
            }
        }
        Some(solve(&self.gram, &score)?.dot(&score))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::random::Random;

    /// The share that follows of so many rows: moves of an input now and then, and what rings after them beside noise of one, so many times as
    /// large; the noise may have a memory, and the output moves by so much.
    fn found(rows: usize, times: f64, memory: f64, motion: f64) -> Option<f64> {
        let mut random = Random::new(11);
        let moves: Vec<f64> =
            (0..rows).map(|row| if row % 17 == 0 { random.normal() } else { 0.0 }).collect();
        let mut noise = 0.0;
        let left = (0..rows).map(|row| {
            noise = memory * noise + (1.0 - memory * memory).sqrt() * random.normal();
            let rings = (0..12.min(row + 1)).map(|lag| moves[row - lag] * libm::cos(1.2 * lag as f64));
            (row as f64, Some(noise + times * rings.sum::<f64>()))
        });
        followed(&vec![left.collect()], &Explained::new(vec![moves]), motion)
    }

    #[test]
    fn law_what_rings_after_moves_is_found_and_a_sensors_memory_is_not() {
        assert!(found(600, 2.0, 0.0, 10.0).is_some_and(|share| share > 0.2));
        assert!(found(600, 2.0, 0.9, 10.0).is_some());
        for memory in [0.0, 0.5, 0.9, 0.98] {
            assert_eq!(found(600, 0.0, memory, 10.0), None, "{memory}");
        }
        // of an output that moves a thousand times as far it is nothing
        assert_eq!(found(600, 2.0, 0.0, 1000.0), None);
    }

    #[test]
    fn every_log_that_is_too_short_to_tell_chance_says_nothing() {
        assert_eq!(found(23, 10.0, 0.0, 10.0), None);
        assert!(
            found(150, 10.0, 0.0, 10.0).is_some(),
            "moved by less than twelve rows it would be its own chance"
        );
    }

    #[test]
    fn bad_data_an_input_that_stays_or_is_no_number_explains_nothing() {
        let left = vec![(0..100).map(|row| (f64::from(row), Some(f64::from(row % 7)))).collect()];
        for value in [0.0, f64::NAN, f64::INFINITY] {
            assert_eq!(followed(&left, &Explained::new(vec![vec![value; 100]]), 1.0), None, "{value}");
        }
        assert_eq!(followed(&vec![vec![]], &Explained::new(vec![vec![]]), 1.0), None);
    }
}
