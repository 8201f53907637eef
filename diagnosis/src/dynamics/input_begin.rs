//! Where an input's lag T begins: what of the courses before the log it still held when the log began. Nobody knows, and it fades with
//! exp(-t / T): a number more for each run, with a prior, and a state of the linearised run that stays what it is. Of a machine that stands
//! still until an input first moves it held nothing.

use super::grid::{Grid, jumps};
use super::machine::{Machine, Parameter, Role};
use super::schedule::{Schedule, input_effects};
use crate::infer::Linearised;
use crate::observe::InputEffect;
use crate::statistics::levels::{FEW, MORE};

/// What one lagging input held at a run's begin: a column of what a unit of it does, and its prior.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Begin {
    /// The input.
    pub input: usize,
    /// Share that is left in the mean of each interval, as wide as [`Schedule::mean`] is for one input.
    pub mean: Vec<f64>,
    /// And at each row.
    pub at_row: Vec<f64>,
    /// As far as it is behind in this log, rms, in the input's unit.
    pub sd: f64,
}

/// The inputs that lag with these parameters.
pub(super) fn lagging(machine: &Machine, theta: &[f64]) -> Vec<usize> {
    let of = |(parameter, value): (&Parameter, &f64)| {
        let Role::Input(input, kind) = parameter.role else { return None };
        let lags = match kind {
            InputEffect::Lag => *value > 0.0,
            InputEffect::Delay
            | InputEffect::Saturation
            | InputEffect::RateLimit
            | InputEffect::Gain
            | InputEffect::Bias => false,
        };
        lags.then_some(input)
    };
    machine.parameters.iter().zip(theta).filter_map(of).collect()
}

/// Of each input that lags with these parameters; `sensors` are the channels' standard deviations.
pub(super) fn begins(
    machine: &Machine,
    grid: &Grid,
    schedule: &Schedule,
    theta: &[f64],
    sensors: &[f64],
) -> Vec<Begin> {
    let lagging = lagging(machine, theta);
    if lagging.is_empty() || rests(grid, sensors) {
        return Vec::new();
    }
    let effects = input_effects(machine, theta);
    let of = |input: usize| {
        let (lag, delay) = (effects[input].lag, effects[input].delay);
        // what acts before a delay is over is unknown as a whole
        let from = grid.inputs[input].time[0] + delay;
        let left = |time: f64| libm::exp(-(time - from).max(0.0) / lag);
        let pairs = grid.time.windows(2);
        let mean = |pair: &[f64]| {
            let (begin, end) = (pair[0].max(from), pair[1].max(from));
            let fades = if end > begin { lag * (left(begin) - left(end)) } else { 0.0 };
            (begin.min(pair[1]) - pair[0] + fades) / (pair[1] - pair[0])
        };
        Begin {
            input,
            mean: pairs.map(mean).collect(),
            at_row: grid.time.iter().map(|time| left(*time)).collect(),
            sd: behind(machine, grid, schedule, theta, input),
        }
    };
    lagging.into_iter().map(of).collect()
}

/// Whether all channels stand still, within noise, until an input first moves. Nothing is said by a log of which that is the first row.
fn rests(grid: &Grid, sensors: &[f64]) -> bool {
    let moves = grid.inputs.iter().filter_map(|course| jumps(course).first().copied());
    let until = moves.fold(f64::INFINITY, f64::min);
    let still = |(channel, noise): (usize, &f64)| {
        let own = grid.samples.iter().filter(|sample| sample.channel == channel && sample.time < until);
        let values: Vec<f64> = own.map(|sample| sample.value).collect();
        let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        values.len() >= FEW && squares <= values.len() as f64 * (MORE * noise).powi(2)
    };
    sensors.iter().enumerate().all(still)
}

/// By how much what an input's lag makes of the log is off what it would be without, rms of the intervals' means.
fn behind(machine: &Machine, grid: &Grid, schedule: &Schedule, theta: &[f64], input: usize) -> f64 {
    let mut prompt = theta.to_vec();
    for (value, parameter) in prompt.iter_mut().zip(&machine.parameters) {
        if parameter.role == Role::Input(input, InputEffect::Lag) {
            *value = parameter.neutral;
        }
    }
    let there = Schedule::new(machine, grid, &prompt);
    let own = |schedule: &Schedule| -> Vec<f64> {
        schedule.mean.iter().skip(input).step_by(schedule.width).copied().collect()
    };
    let (slow, prompt) = (own(schedule), own(&there));
    let squares: f64 = slow.iter().zip(&prompt).map(|(slow, prompt)| (slow - prompt).powi(2)).sum();
    (squares / slow.len().max(1) as f64).sqrt()
}

/// A run whose last columns are states that stay what they are, with a prior about none of this standard deviation each.
pub(super) fn as_states(plain: &Linearised, sds: &[f64]) -> Linearised {
    let (n, more) = (plain.states, sds.len());
    let columns: Vec<usize> = (0..plain.parameters - more).collect();
    let mut out = Linearised { states: n + more, ..plain.with_columns(&columns) };
    out.transition.clear();
    out.drive.clear();
    out.defect.clear();
    out.observe.clear();
    for row in 0..plain.rows().saturating_sub(1) {
        for i in 0..n {
            out.transition.extend_from_slice(&plain.transition[(row * n + i) * n..(row * n + i + 1) * n]);
            out.transition.extend((0..more).map(|own| plain.column(row, columns.len() + own)[i]));
        }
        for own in 0..more {
            out.transition.extend((0..n + more).map(|j| if j == n + own { 1.0 } else { 0.0 }));
        }
        for column in &columns {
            out.drive.extend_from_slice(plain.column(row, *column));
            out.drive.extend(sds.iter().map(|_| 0.0));
        }
        out.defect.extend_from_slice(&plain.defect[row * n..(row + 1) * n]);
        out.defect.extend(sds.iter().map(|_| 0.0));
    }
    for value in 0..plain.measured.len() {
        out.observe.extend_from_slice(&plain.observe[value * n..(value + 1) * n]);
        out.observe.extend((0..more).map(|own| plain.direct[value * plain.parameters + columns.len() + own]));
    }
    out.start.0.extend(sds.iter().map(|_| 0.0));
    out.start.1.extend_from_slice(sds);
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::grid::Sample;
    use crate::dynamics::tests::{built, pendulum, place};
    use crate::infer::fit::Linearise;
    use crate::observe::Hold;
    use crate::ports::Course;

    #[test]
    fn law_what_a_lag_held_fades_from_where_the_log_begins() {
        let problem = pendulum("held", 101);
        let built = built(&problem);
        let (engine, mut theta) = (&built.engine, built.engine.machine.neutral());
        let of = |theta: &[f64]| {
            let schedule = Schedule::new(&engine.machine, &engine.grids[0], theta);
            begins(&engine.machine, &engine.grids[0], &schedule, theta, &engine.sensors)
        };
        assert!(of(&theta).is_empty(), "nothing lags");
        theta[place(&built, "tau:lag")] = 0.1;
        let [begin] = &of(&theta)[..] else { panic!("one input lags") };
        let (time, span) = (&engine.grids[0].time, engine.grids[0].time[1] - engine.grids[0].time[0]);
        let left = |row: usize| libm::exp(-(time[row] - time[0]) / 0.1);
        for row in [0, 1, 7, 99] {
            assert!((begin.at_row[row] - left(row)).abs() < 1e-14);
            let mean = 0.1 * (left(row) - left(row + 1)) / span;
            assert!((begin.mean[row] - mean).abs() < 1e-13, "{row}");
        }
        // what a delay carries in is whole until it is over
        theta[place(&built, "tau:delay")] = 3.5 * span;
        let late = &of(&theta)[0];
        assert_eq!((late.at_row[3], late.mean[2]), (1.0, 1.0));
        assert!((late.at_row[4] - libm::exp(-0.5 * span / 0.1)).abs() < 1e-12);
        assert!((0.5..1.0).contains(&late.mean[3]));
    }

    #[test]
    fn law_a_machine_that_stands_still_until_an_input_moves_held_nothing() {
        let course = |values: &[f64]| Course {
            time: (0..20).map(f64::from).collect(),
            values: (0..20).map(|row| values[row.min(values.len() - 1)]).collect(),
            hold: Hold::Zero,
        };
        let log = |course: &Course, of: &dyn Fn(f64) -> f64| Grid {
            samples: (course.time.iter())
                .map(|time| Sample { channel: 0, time: *time, value: of(*time) })
                .collect(),
            inputs: vec![course.clone()],
            ..Grid::default()
        };
        let step = course(&[0.0, 0.0, 0.0, 0.0, 5.0]);
        let quiet = |time: f64| if time < 4.0 { 0.1 * libm::cos(9.0 * time) } else { 3.0 * time };
        assert!(rests(&log(&step, &quiet), &[0.1]));
        assert!(!rests(&log(&step, &quiet), &[0.01]), "more than noise");
        assert!(!rests(&log(&step, &|time| time), &[0.1]), "it moves though no input has");
        assert!(!rests(&log(&course(&[0.0, 0.0, 5.0]), &|_| 0.0), &[0.1]), "two rows tell nothing");
        assert!(!rests(&log(&step, &quiet), &[0.1, 0.1]), "nor does a channel that has none");
    }

    #[test]
    fn law_a_begin_is_a_state_that_stays_and_drives_as_a_bias_does_that_fades() {
        let problem = pendulum("begun", 101);
        let built = built(&problem);
        let (engine, mut theta) = (&built.engine, built.engine.machine.neutral());
        let bias = place(&built, "tau:bias");
        theta[place(&built, "tau:lag")] = 0.1;
        let noise = crate::infer::Noise {
            process: vec![0.0; engine.machine.order()],
            channels: engine.sensors.clone(),
            jitter: 0.0,
            disturbance: None,
        };
        let paths = engine.first_paths(&theta, &noise).expect("it can be followed");
        let run = &engine.linearise(&theta, &paths, &[bias]).expect("it can be linearised")[0];
        let (n, order) = (run.states, engine.machine.order());
        assert_eq!((n, run.start.1.len()), (order + 1, order + 1));
        assert!(run.start.1[order] > 0.0, "a prior of its own");
        let schedule = Schedule::new(&engine.machine, &engine.grids[0], &theta);
        let begin = &begins(&engine.machine, &engine.grids[0], &schedule, &theta, &engine.sensors)[0];
        for row in [0, 5, 50] {
            let entry = |i: usize, j: usize| run.transition[(row * n + i) * n + j];
            assert_eq!((entry(order, order), entry(order, 0)), (1.0, 0.0));
            for i in 0..order {
                let wanted = run.column(row, 0)[i] * begin.mean[row];
                assert!((entry(i, order) - wanted).abs() <= 1e-9 * wanted.abs(), "{row}, {i}");
            }
        }
    }
}
