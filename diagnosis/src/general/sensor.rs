//! What a sensor shows that neither the model nor noise gives: a scale that bends, a limit, an encoder that runs out of round. Where the noise
//! of a channel is estimated, it takes up what the model misses there, and no process noise is left to tell of it.
//!
//! Two things give it away: the noise is larger than what neighbouring rows of the log scatter by, without any model; and residuals resemble
//! each other, as noise's don't: neighbours, or those that are as far apart as a wave is long which nobody lists.

use super::policy::GENERAL;
use super::residual::follows;
use super::study::Studied;
use crate::diagnosis::{RunTrace, Unknown};
use crate::dynamics::machine::Output;
use crate::infer::smooth;
use crate::observe::Problem;

/// Residuals of a channel, row by row: time, and value where the row has one.
pub(super) type Residuals = Vec<Vec<(f64, Option<f64>)>>;

/// The channel that is explained least, if one isn't.
pub fn unknown(problem: &Problem, studied: &Studied) -> Option<Unknown> {
    let machine = &studied.built.engine.machine;
    let judged = (0..machine.channels.len()).filter_map(|channel| {
        let residuals = residuals(studied, channel);
        let (apart, size) = systematic(&residuals)?;
        let (noise, scatter) = (studied.fit.at.noise.channels[channel], studied.built.scatter[channel]);
        // a stated noise takes up nothing; else what is left counts as noise, and of a wave of some rows neighbours scatter by as much
        let (size, least) = match studied.built.sizes.channels[channel] {
            None => (size, noise),
            Some(_) if apart == 1 => (noise, scatter.noise),
            Some(_) => (noise, scatter.quantum),
        };
        let times = size / least.max(scatter.quantum);
        is_larger(times).then_some((channel, times, residuals, apart))
    });
    let (channel, times, residuals, apart) = judged.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let course: Vec<f64> = residuals.iter().flatten().map(|(_, value)| value.unwrap_or(0.0)).collect();
    let (depends_on, shape) = follows(&studied.built.engine, studied, &course);
    Some(Unknown {
        depends_on,
        shape,
        nearest: format!("no listed effect: {}", sharing(apart, times)),
        ..told(problem, studied, &machine.channels[channel], &residuals)
    })
}

/// Something without a name in what an output shows, with its course.
pub(super) fn told(problem: &Problem, studied: &Studied, output: &Output, residuals: &Residuals) -> Unknown {
    let course = |residuals: &Vec<(f64, Option<f64>)>| -> Vec<[f64; 2]> {
        residuals.iter().filter_map(|(time, value)| Some([*time, (*value)?])).collect()
    };
    let along = studied.built.engine.grids.iter().zip(residuals);
    let shown = problem.channels.iter().find(|shown| shown.name == output.name);
    Unknown {
        signal: format!("what {} shows", output.name),
        trace: residuals.first().map_or_else(Vec::new, course),
        traces: along.map(|(grid, own)| RunTrace { run: grid.name.clone(), trace: course(own) }).collect(),
        unit: shown
            .and_then(|shown| problem.model.variable(shown.variable).unit.clone())
            .unwrap_or_else(|| "1".into()),
        ..Unknown::default()
    }
}

/// Whether so many times what neighbours scatter by is more than sensors show.
fn is_larger(times: f64) -> bool {
    times > GENERAL.larger
}

/// What is left of a channel beside the path.
pub(super) fn residuals(studied: &Studied, channel: usize) -> Residuals {
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

/// What gives it away, in words.
fn sharing(apart: usize, times: f64) -> String {
    match apart {
        1 => format!(
            "as noise it would be {times:.1} times what neighbouring rows of the log scatter by, and neighbouring rows share it"
        ),
        _ => format!("it comes back every {apart} rows, as noise doesn't"),
    }
}

/// How many rows those residuals are apart that resemble each other most, and how large all are, if any do more than noise (von Neumann's
/// ratio, Ann. Math. Stat. 12 (1941) 367, of neighbours and of rows farther apart: of a wave of some rows the neighbours differ as noise's do).
fn systematic(residuals: &Residuals) -> Option<(usize, f64)> {
    let runs: Vec<Vec<f64>> =
        residuals.iter().map(|run| run.iter().filter_map(|(_, value)| *value).collect()).collect();
    let squares = |values: &mut dyn Iterator<Item = f64>| {
        let (count, sum) = values.fold((0.0, 0.0), |(count, sum), value| (count + 1.0, sum + value * value));
        (count, sum / f64::max(count, 1.0))
    };
    let (count, variance) = squares(&mut runs.iter().flatten().copied());
    let share = |apart: usize| {
        let pairs = |run: &'_ Vec<f64>| -> Vec<f64> {
            run.iter().zip(run.iter().skip(apart)).map(|(one, other)| other - one).collect()
        };
        let (pairs, square) = squares(&mut runs.iter().flat_map(pairs));
        (pairs > 0.0).then(|| (0.5 * square / variance, apart))
    };
    let (share, apart) =
        (1..=GENERAL.apart).filter_map(share).min_by(|one, other| one.0.total_cmp(&other.0))?;
    // of white noise the share is 1, with a variance of 1/count
    let is =
        variance > 0.0 && is_larger(share.sqrt().recip()) && (1.0 - share) * count.sqrt() > GENERAL.resembles;
    is.then(|| (apart, variance.sqrt()))
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
        assert_eq!(systematic(&run(|_, noise| noise)), None);
        assert_eq!(
            systematic(&run(|row, noise| if row % 20.0 == 0.0 { 30.0 * noise } else { noise })),
            None,
            "rows that stand alone"
        );
        let apart = |residuals: &Residuals| systematic(residuals).map(|(apart, _)| apart);
        assert_eq!(apart(&run(|row, noise| noise + 3.0 * libm::sin(0.1 * row))), Some(1));
        // a wave of half the noise leaves the ratio near one
        assert_eq!(systematic(&run(|row, noise| noise + 0.5 * libm::sin(0.1 * row))), None);
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
            systematic(&vec![(0..6283).map(value).map(|value| (0.0, Some(value))).collect()]).is_some()
        };
        assert!(!all(1.4) && all(1.6));
    }

    #[test]
    fn value_how_many_residuals_tell_that_neighbours_resemble_each_other() {
        // one wave without noise: white noise of n values is as smooth by chance at √n standard deviations, 4.5 of which are doubted no more
        let wave = |rows: u32| {
            let value = |row: u32| libm::sin(std::f64::consts::TAU * f64::from(row) / f64::from(rows));
            systematic(&vec![(0..rows).map(|row| (f64::from(row), Some(value(row)))).collect()]).is_some()
        };
        assert!(!wave(18) && wave(26));
    }

    #[test]
    fn value_waves_of_three_to_twelve_rows_are_no_noise() {
        let wave = |rows: f64| {
            systematic(&run(|row, noise| noise + 3.0 * libm::sin(std::f64::consts::TAU * row / rows)))
        };
        for rows in [3.0, 4.0, 5.5, 6.0, 8.0, 12.0] {
            let (apart, size) = wave(rows).expect("three times the noise");
            // whole waves apart; of a long one neighbours are nearer to each other than rows a wave apart
            let turns = apart as f64 / rows;
            assert!((turns - turns.round()).abs() < 0.15 || apart == 1, "{rows} rows: {apart} apart");
            // √(1 + 9/2)
            assert!((size - 2.35).abs() < 0.3, "{size}");
        }
        // of 14 rows, neighbours
        assert_eq!(wave(14.0).map(|(apart, _)| apart), Some(1));
    }
}
