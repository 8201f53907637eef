//! What timestamps that are off leave of a window that no model follows better: its path has no process noise, so that a held input which steps
//! at such a row acts so much too early or too late from there on, whatever the start state. The filter of a fit knows it as a
//! covariance of the process (`infer/sweep.rs`).

use crate::infer::Linearised;
use crate::statistics::linear::solve;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Expected squares of each channel's residuals, in its unit squared, where timestamps scatter by `jitter`, s: of what the sensors read at such
/// times, and of what the inputs do to the states until the window ends, less what the start state takes. Channels have this `noise`, each in
/// its unit.
pub fn squares(run: &Linearised, noise: &[f64], jitter: f64) -> Vec<f64> {
    let mut sums = vec![0.0; noise.len()];
    if jitter > 0.0 {
        pieces(run).for_each(|piece| Piece::new(run, noise, piece).add(run, &mut sums));
    }
    sums.iter().map(|sum| sum * jitter * jitter).collect()
}

/// The rows between those behind which nobody knows the state.
fn pieces(run: &Linearised) -> impl Iterator<Item = Range<usize>> {
    let ends: Vec<usize> = (1..run.rows()).filter(|row| run.is_torn(row - 1)).chain([run.rows()]).collect();
    let begins: Vec<usize> = [0].into_iter().chain(ends.iter().copied()).collect();
    begins.into_iter().zip(ends).map(|(begin, end)| begin..end)
}

/// Rows that one start state leads through.
struct Piece {
    /// From the first to behind the last.
    rows: Range<usize>,
    /// The values that count, with their row.
    values: Vec<(usize, usize)>,
    /// What each of these values is of the start state, a row each, in units of its noise.
    by_start: DMatrix<f64>,
    /// What is known of the start state, inverse variances.
    normal: DMatrix<f64>,
    /// The size of each value's noise, in the channel's unit.
    sizes: Vec<f64>,
}

impl Piece {
    fn new(run: &Linearised, noise: &[f64], rows: Range<usize>) -> Self {
        let n = run.states;
        let counts = |value: &usize| run.measured[*value].weight > 0.0;
        let values: Vec<(usize, usize)> = rows
            .clone()
            .flat_map(|row| run.values(row).filter(counts).map(move |value| (row, value)))
            .collect();
        let sizes = values.iter().map(|(_, value)| noise[run.measured[*value].channel]).collect();
        let mut piece =
            Self { rows, values, by_start: DMatrix::zeros(0, n), normal: DMatrix::zeros(n, n), sizes };
        let columns: Vec<DVector<f64>> =
            (0..n).map(|state| piece.course(run, piece.rows.start, unit(n, state))).collect();
        piece.by_start = DMatrix::from_fn(piece.values.len(), n, |place, state| columns[state][place]);
        piece.normal = piece.by_start.tr_mul(&piece.by_start);
        let prior = run.start.1.iter().enumerate().filter(|(_, sd)| **sd > 0.0);
        prior.for_each(|(state, sd)| piece.normal[(state, state)] += 1.0 / (sd * sd));
        piece
    }

    /// What a deviation of a row's state does to the values from there on, in units of their noise.
    fn course(&self, run: &Linearised, from: usize, mut state: Vec<f64>) -> DVector<f64> {
        let (n, mut at) = (run.states, from);
        let mut course = DVector::zeros(self.values.len());
        let begin = self.values.partition_point(|(row, _)| *row < from);
        for (place, (row, value)) in self.values.iter().enumerate().skip(begin) {
            while at < *row {
                let a = &run.transition[at * n * n..(at + 1) * n * n];
                state = a.chunks(n).map(|row| dot(row, &state)).collect();
                at += 1;
            }
            course[place] = dot(&run.observe[value * n..(value + 1) * n], &state) / self.sizes[place];
        }
        course
    }

    /// Adds what a second of scatter leaves of each channel.
    fn add(&self, run: &Linearised, sums: &mut [f64]) {
        let each = |place: usize| (run.measured[self.values[place].1].channel, self.sizes[place]);
        for (place, (_, value)) in self.values.iter().enumerate() {
            sums[each(place).0] += run.measured[*value].slope.powi(2);
        }
        // a state that is reached behind the last row is seen by none
        for row in self.rows.start..self.rows.end - 1 {
            let mut moved = run.late(row).to_vec();
            if moved.iter().all(|by| *by == 0.0) {
                continue;
            }
            moved.resize(run.states, 0.0);
            let course = self.course(run, row + 1, moved);
            let Some(taken) = solve(&self.normal, &self.by_start.tr_mul(&course)) else { continue };
            let left = course - &self.by_start * taken;
            left.iter().enumerate().for_each(|(place, left)| {
                let (channel, size) = each(place);
                sums[channel] += (left * size).powi(2);
            });
        }
    }
}

fn unit(n: usize, place: usize) -> Vec<f64> {
    (0..n).map(|i| f64::from(u8::from(i == place))).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::squares;
    use crate::infer::Linearised;
    use crate::infer::linearised::Measured;
    use crate::statistics::random::Random;

    const ROWS: usize = 40;
    /// s.
    const DT: f64 = 0.1;

    /// A mass that a force moves, seen by its place: the force steps after these rows, by one.
    fn mass(steps: &[usize], slope: f64) -> Linearised {
        let late = (0..ROWS - 1).flat_map(|row| [0.0, if steps.contains(&row) { 1.0 } else { 0.0 }]);
        let value =
            |row: usize| Measured { channel: 0, time: DT * row as f64, residual: 0.0, slope, weight: 1.0 };
        Linearised {
            states: 2,
            time: (0..ROWS).map(|row| DT * row as f64).collect(),
            transition: (1..ROWS).flat_map(|_| [1.0, DT, 0.0, 1.0]).collect(),
            defect: vec![0.0; 2 * (ROWS - 1)],
            late: late.collect(),
            first: (0..=ROWS).collect(),
            measured: (0..ROWS).map(value).collect(),
            observe: (0..ROWS).flat_map(|_| [1.0, 0.0]).collect(),
            start: (vec![0.0; 2], vec![1e6; 2]),
            ..Linearised::default()
        }
    }

    /// Squares about the line through values at rows of the same distance.
    fn about_a_line(values: &[f64]) -> f64 {
        let middle = (values.len() - 1) as f64 / 2.0;
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let at = |row: usize| row as f64 - middle;
        let along: f64 = values.iter().enumerate().map(|(row, value)| at(row) * value).sum();
        let slope = along / (0..values.len()).map(|row| at(row).powi(2)).sum::<f64>();
        values.iter().enumerate().map(|(row, value)| (value - mean - slope * at(row)).powi(2)).sum()
    }

    #[test]
    fn law_what_scatter_leaves_is_what_many_logs_leave_on_average() {
        let (steps, jitter) = ([5, 17, 30], 0.02);
        let mut random = Random::new(11);
        let mut log = || {
            let off = steps.map(|_| jitter * random.normal());
            let place = |row: usize| {
                let since = |step: usize| DT * row.saturating_sub(step + 1) as f64;
                steps.iter().zip(off).map(|(step, off)| off * since(*step)).sum()
            };
            about_a_line(&(0..ROWS).map(place).collect::<Vec<f64>>())
        };
        let mean = (0..4000).map(|_| log()).sum::<f64>() / 4000.0;
        let told = squares(&mass(&steps, 0.0), &[1e-3], jitter)[0];
        // squares of three normal numbers: a mean of 4000 is known to two per cent
        assert!((told / mean - 1.0).abs() < 0.06, "{told} against {mean}");
    }

    #[test]
    fn value_exact_times_leave_nothing_and_a_moving_sensor_its_slope() {
        assert_eq!(squares(&mass(&[5], 1.0), &[1e-3], 0.0), [0.0]);
        let told = squares(&mass(&[], 3.0), &[1e-3], 0.5)[0];
        assert!((told - ROWS as f64 * 2.25).abs() < 1e-9, "{told}");
        // behind a tear nothing is known of what was before it, and what the step did is gone
        let torn = Linearised { torn: (0..ROWS - 1).map(|row| row == 6).collect(), ..mass(&[5], 0.0) };
        assert!(squares(&torn, &[1e-3], 0.02)[0] < 1e-9 * squares(&mass(&[5], 0.0), &[1e-3], 0.02)[0]);
    }
}
