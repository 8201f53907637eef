//! What a sensor shows that neither the model nor noise gives: a scale that bends, a limit, an encoder that runs out of round. Where the noise
//! of a channel is estimated, it takes up what the model misses there, and no process noise is left to tell of it.
//!
//! Two things give it away: the noise is larger than what neighbouring rows of the log scatter by, without any model; and neighbouring
//! residuals resemble each other, as noise's don't.

use super::policy::GENERAL;
use super::residual::follows;
use super::study::Studied;
use crate::diagnosis::{RunTrace, Unknown};
use crate::infer::smooth;
use crate::observe::Problem;

/// Residuals of a channel, row by row: time, and value where the row has one.
type Residuals = Vec<Vec<(f64, Option<f64>)>>;

/// The channel that is explained least, if one isn't.
pub fn unknown(problem: &Problem, studied: &Studied) -> Option<Unknown> {
    let machine = &studied.built.engine.machine;
    let judged = (0..machine.channels.len()).filter_map(|channel| {
        let scatter = studied.built.scatter[channel];
        let least = scatter.noise.max(scatter.quantum);
        let times = studied.fit.at.noise.channels[channel] / least;
        // a stated noise takes up nothing
        let free = studied.built.sizes.channels[channel].is_some() && least > 0.0 && is_larger(times);
        let residuals = free.then(|| residuals(studied, channel))?;
        systematic(&residuals).then_some((channel, times, residuals))
    });
    let (channel, times, residuals) = judged.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let course: Vec<f64> = residuals.iter().flatten().map(|(_, value)| value.unwrap_or(0.0)).collect();
    let (depends_on, shape) = follows(&studied.built.engine, studied, &course);
    let output = &machine.channels[channel];
    let told = |residuals: &Vec<(f64, Option<f64>)>| -> Vec<[f64; 2]> {
        residuals.iter().filter_map(|(time, value)| Some([*time, (*value)?])).collect()
    };
    let along = studied.built.engine.grids.iter().zip(&residuals);
    let shown = problem.channels.iter().find(|shown| shown.name == output.name);
    Some(Unknown {
        signal: format!("what {} shows", output.name),
        depends_on,
        shape,
        nearest: format!(
            "no listed effect: as noise it would be {times:.1} times what neighbouring rows of the log scatter by, and neighbouring rows share it"
        ),
        trace: told(&residuals[0]),
        traces: along.map(|(grid, own)| RunTrace { run: grid.name.clone(), trace: told(own) }).collect(),
        unit: shown
            .and_then(|shown| problem.model.variable(shown.variable).unit.clone())
            .unwrap_or_else(|| "1".into()),
    })
}

/// Whether so many times what neighbours scatter by is more than sensors show.
fn is_larger(times: f64) -> bool {
    times > GENERAL.larger
}

fn residuals(studied: &Studied, channel: usize) -> Residuals {
    let noise = studied.residual.unlisted.as_ref().unwrap_or(&studied.fit.at.noise);
    let of = |run: &crate::infer::Linearised| -> Vec<(f64, Option<f64>)> {
        let (state, n) = (smooth(run, noise).state, run.states);
        let row = |row: usize| {
            let own = run
                .values(row)
                .find(|value| run.measured[*value].channel == channel && run.measured[*value].weight > 0.0);
            let left = |value: usize| {
                let by: f64 = (0..n).map(|i| run.observe[value * n + i] * state[row * n + i]).sum();
                run.measured[value].residual - by
            };
            (run.time[row], own.map(left))
        };
        (0..run.rows()).map(row).collect()
    };
    studied.fit.runs.iter().map(of).collect()
}

/// Whether neighbouring residuals resemble each other (von Neumann's ratio, Ann. Math. Stat. 12 (1941) 367).
fn systematic(residuals: &Residuals) -> bool {
    let runs: Vec<Vec<f64>> =
        residuals.iter().map(|run| run.iter().filter_map(|(_, value)| *value).collect()).collect();
    let squares = |values: &mut dyn Iterator<Item = f64>| {
        let (count, sum) = values.fold((0.0, 0.0), |(count, sum), value| (count + 1.0, sum + value * value));
        (count, sum / f64::max(count, 1.0))
    };
    let (count, variance) = squares(&mut runs.iter().flatten().copied());
    let (_, apart) = squares(&mut runs.iter().flat_map(|run| run.windows(2).map(|pair| pair[1] - pair[0])));
    let share = 0.5 * apart / variance;
    // of white noise the share is 1, with a variance of 1/count
    variance > 0.0 && is_larger(share.sqrt().recip()) && (1.0 - share) * count.sqrt() > GENERAL.resembles
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::random::Random;

    fn run(of: impl Fn(f64, f64) -> f64) -> Residuals {
        let mut random = Random::new(9);
        vec![(0..200).map(|row| (f64::from(row), Some(of(f64::from(row), random.normal())))).collect()]
    }

    #[test]
    fn law_what_neighbours_share_is_no_noise() {
        assert!(!systematic(&run(|_, noise| noise)));
        assert!(
            !systematic(&run(|row, noise| if row % 20.0 == 0.0 { 30.0 * noise } else { noise })),
            "rows that stand alone"
        );
        assert!(systematic(&run(|row, noise| noise + 3.0 * libm::sin(0.1 * row))));
        // a wave of half the noise leaves the ratio near one
        assert!(!systematic(&run(|row, noise| noise + 0.5 * libm::sin(0.1 * row))));
    }

    #[test]
    fn value_how_much_neighbours_share() {
        // a channel of a listed sensor had 1.2 at most: 1.4 is none, 1.6 is
        assert!(!is_larger(1.4) && is_larger(1.6));
        // a slow wave beside noise of one: in all so many times what neighbours differ by
        let all = |times: f64| {
            let mut random = Random::new(9);
            let height = (2.0 * (times * times - 1.0)).sqrt();
            let value = |row: u32| random.normal() + height * libm::sin(0.01 * f64::from(row));
            systematic(&vec![(0..6283).map(value).map(|value| (0.0, Some(value))).collect()])
        };
        assert!(!all(1.4) && all(1.6));
    }

    #[test]
    fn value_how_many_residuals_tell_that_neighbours_resemble_each_other() {
        // one wave without noise: white noise of n values is as smooth by chance at √n standard deviations, 4.5 of which are doubted no more
        let wave = |rows: u32| {
            let value = |row: u32| libm::sin(std::f64::consts::TAU * f64::from(row) / f64::from(rows));
            systematic(&vec![(0..rows).map(|row| (f64::from(row), Some(value(row)))).collect()])
        };
        assert!(!wave(18) && wave(26));
    }
}
