//! A sensor's first-order lag T dℓ/dt = y - ℓ: one more state of the linearised run for each channel that has one.
//!
//! Between the times at which y is read it runs along lines, over which the lag is exact. The path holds no ℓ: it is followed
//! along the path from where it had settled at the run's begin, since all that depends on ℓ is linear in it.

use super::assemble::Assembly;
use super::linearise::RunAt;
use super::machine::{Machine, Role};
use crate::infer::{Linearised, Measured};
use crate::observe::{OutputEffect, Reading};

/// ℓ after a line from y₀ to y₁: a ℓ + b₀ y₀ + b₁ y₁.
pub(super) fn weights(span: f64, time: f64) -> (f64, f64, f64) {
    if time <= 0.0 {
        return (0.0, 0.0, 1.0);
    }
    let x = span / time;
    let a = libm::exp(-x);
    let mean = if x > 1e-8 { -libm::expm1(-x) / x } else { 1.0 - 0.5 * x };
    (a, mean - a, 1.0 - mean)
}

/// What a lag makes of values at times, settled at the first; from each time on they run along a line from where they have `begun` anew.
pub(super) fn lagged(time: &[f64], begun: &[f64], values: &[f64], lag: f64) -> Vec<f64> {
    let mut shown: Vec<f64> = Vec::with_capacity(values.len());
    for (row, value) in values.iter().enumerate() {
        shown.push(match row.checked_sub(1) {
            None => *value,
            Some(last) => {
                let (a, b0, b1) = weights(time[row] - time[last], lag);
                a * shown[last] + b0 * begun[last] + b1 * value
            }
        });
    }
    shown
}

/// What a delay makes of values at times; before the first the first. From each time on they run along a line from where they have `begun`
/// anew; at a time itself they are what they were until then.
pub(super) fn delayed(time: &[f64], begun: &[f64], values: &[f64], delay: f64) -> Vec<f64> {
    let at = |when: f64| {
        if when <= time[0] {
            return values[0];
        }
        let next = time.partition_point(|t| *t < when).clamp(1, time.len() - 1);
        let share = (when - time[next - 1]) / (time[next] - time[next - 1]);
        begun[next - 1] + share.clamp(0.0, 1.0) * (values[next] - begun[next - 1])
    };
    if time.len() < 2 { values.to_vec() } else { time.iter().map(|t| at(t - delay)).collect() }
}

/// One channel with a lag.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lag {
    /// The channel.
    pub channel: usize,
    /// The parameter.
    pub parameter: usize,
    /// s.
    pub time: f64,
}

/// The channels that lag for these parameters.
pub(super) fn active(machine: &Machine, theta: &[f64]) -> Vec<Lag> {
    let of = |(parameter, value): (usize, &f64)| {
        let Role::Output(channel, kind) = machine.parameters[parameter].role else { return None };
        let lags = match kind {
            OutputEffect::Lag => *value > 0.0,
            OutputEffect::Delay | OutputEffect::Gain | OutputEffect::Offset | OutputEffect::Drift => false,
        };
        lags.then_some(Lag { channel, parameter, time: *value })
    };
    theta.iter().enumerate().filter_map(of).collect()
}

/// How y runs within an interval: shares of its length and what is read there, each a sum of entries of this row, and the
/// next row's own value.
struct Course {
    times: Vec<f64>,
    reads: Vec<Vec<(usize, f64)>>,
}

impl Course {
    /// ℓ at the interval's end for a lag of this time, s: the share of ℓ at its begin, and of what is read.
    fn weighed(&self, time: f64) -> (f64, Vec<f64>) {
        let (mut keeps, mut shares) = (1.0, vec![0.0; self.times.len()]);
        for part in 1..self.times.len() {
            let (a, b0, b1) = weights(self.times[part] - self.times[part - 1], time);
            keeps *= a;
            shares.iter_mut().for_each(|share| *share *= a);
            shares[part - 1] += b0;
            shares[part] += b1;
        }
        (keeps, shares)
    }

    /// What is read, each with its share, of entries of this row.
    fn read(&self, of: &dyn Fn(usize) -> f64, shares: &[f64]) -> f64 {
        let each = self.reads.iter().zip(shares);
        each.map(|(sum, share)| share * sum.iter().map(|(entry, by)| by * of(*entry)).sum::<f64>()).sum()
    }
}

/// Where a lag is at a row.
struct AtRow<'a> {
    row: usize,
    /// Place among the lags.
    slot: usize,
    lag: &'a Lag,
    /// y of all rows.
    values: &'a [f64],
    /// ℓ.
    shown: f64,
}

/// One lag over one interval.
struct LagStep {
    /// ∂ℓ(k+1)/∂x(k).
    by_states: Vec<f64>,
    /// ∂ℓ(k+1)/∂ℓ(k).
    keeps: f64,
    /// ∂ℓ(k+1)/∂θ, a number a column.
    drive: Vec<f64>,
    /// What the path's defect changes of ℓ(k+1).
    defect: f64,
    /// ℓ(k+1) along the path.
    shown: f64,
}

impl Assembly<'_> {
    /// How the output of a lag's channel runs within the interval after a row.
    fn course(&self, row: usize, slot: usize, lag: &Lag) -> Course {
        let RunAt { engine, grid, schedule, .. } = self.about;
        let machine = &engine.machine;
        let (n, channels) = (machine.order(), machine.channels.len());
        let span = grid.time[row + 1] - grid.time[row];
        let inner = schedule.inner.get(row).and_then(|lags| lags.get(slot));
        let inner: &[(f64, usize)] = inner.map_or(&[], Vec::as_slice);
        let at_row = vec![(n + lag.channel, 1.0)];
        let entry = |read: usize| n + channels + read;
        // where an output jumps with an input at the row, the line from the first reads goes back to it
        let first = match (machine.reading, inner) {
            (Reading::Before, [(t1, one), (t2, two), ..]) => {
                let back = t1 / (t2 - t1);
                vec![(entry(*one), 1.0 + back), (entry(*two), -back)]
            }
            _ => at_row,
        };
        let mut course = Course { times: vec![0.0], reads: vec![first] };
        for (at, read) in inner {
            course.times.push(*at);
            course.reads.push(vec![(entry(*read), 1.0)]);
        }
        course.times.push(span);
        course
    }

    /// A lag over the interval after a row of the run without lags.
    fn lag_step(&self, plain: &Linearised, at: &AtRow<'_>) -> LagStep {
        let AtRow { row, lag, values, shown, .. } = *at;
        let (n, here) = (plain.states, &self.parts[row]);
        let a = &plain.transition[row * n * n..(row + 1) * n * n];
        let course = self.course(row, at.slot, lag);
        let (keeps, shares) = course.weighed(lag.time);
        let last = shares[shares.len() - 1];
        let next: Vec<f64> =
            self.parts[row + 1].states.iter().map(|column| column[n + lag.channel]).collect();
        let through = |by: &[f64]| by.iter().zip(&next).map(|(d, h)| d * h).sum::<f64>();
        let by_state = |(j, column): (usize, &Vec<f64>)| {
            let through: f64 = (0..n).map(|i| next[i] * a[i * n + j]).sum();
            course.read(&|entry| column[entry], &shares) + last * through
        };
        let by_column = |place: usize| {
            let at_end = self.column(row + 1, place, n + lag.channel);
            let mut drive = course.read(&|entry| self.column(row, place, entry), &shares)
                + last * (at_end + through(plain.column(row, place)));
            if let Some(chord) = self.about.chords.get(place).filter(|chord| chord.parameter == lag.parameter)
            {
                let (keeps_there, there) = course.weighed(chord.to);
                let by: Vec<f64> = there.iter().zip(&shares).map(|(to, from)| to - from).collect();
                let end = by[by.len() - 1] * values[row + 1];
                let moved = (keeps_there - keeps) * shown + course.read(&|entry| here.base[entry], &by) + end;
                drive += moved / chord.per;
            }
            drive
        };
        LagStep {
            by_states: here.states.iter().enumerate().map(by_state).collect(),
            keeps,
            drive: (0..self.columns()).map(by_column).collect(),
            defect: last * through(&plain.defect[row * n..(row + 1) * n]),
            shown: keeps * shown + course.read(&|entry| here.base[entry], &shares) + last * values[row + 1],
        }
    }

    /// The run with a state more for each lag.
    pub(super) fn augmented(&self, plain: Linearised, lags: &[Lag]) -> Linearised {
        let (n, wide) = (plain.states, plain.states + lags.len());
        let (p, rows) = (plain.parameters, plain.rows());
        let mut out = Linearised {
            states: wide,
            transition: Vec::with_capacity((rows - 1) * wide * wide),
            drive: Vec::with_capacity((rows - 1) * wide * p),
            defect: Vec::with_capacity((rows - 1) * wide),
            observe: Vec::with_capacity(plain.measured.len() * wide),
            ..plain.clone()
        };
        let values: Vec<Vec<f64>> = (lags.iter())
            .map(|lag| self.parts.iter().map(|part| part.base[n + lag.channel]).collect())
            .collect();
        let mut shown: Vec<Vec<f64>> = values.iter().map(|values| vec![values[0]]).collect();
        for row in 0..rows - 1 {
            let at = |(slot, lag)| AtRow { row, slot, lag, values: &values[slot], shown: shown[slot][row] };
            let steps: Vec<LagStep> =
                lags.iter().enumerate().map(|one| self.lag_step(&plain, &at(one))).collect();
            add_interval(&mut out, &plain, row, &steps);
            shown.iter_mut().zip(&steps).for_each(|(shown, step)| shown.push(step.shown));
        }
        for (value, measured) in plain.measured.iter().enumerate() {
            out.observe.extend_from_slice(&plain.observe[value * n..(value + 1) * n]);
            out.observe.extend(lags.iter().map(|_| 0.0));
            let Some(slot) = lags.iter().position(|lag| lag.channel == measured.channel) else { continue };
            self.read_off_lag(value, slot, &shown[slot], &mut out);
        }
        for (lag, values) in lags.iter().zip(&values) {
            self.add_start(lag, values, &mut out);
        }
        out
    }

    /// Where a lag begins, as one more state of the first row.
    fn add_start(&self, lag: &Lag, values: &[f64], out: &mut Linearised) {
        let (by, sd) = self.begins(out, lag, values);
        if by.is_none() {
            // its first value tells where it began and nothing else: as good as left out, as the first one of a delayed sensor is
            let own = sd / self.about.engine.sensors[lag.channel];
            out.left_out += 1.0 - libm::log(1.0 + own * own);
        }
        out.start.0.push(0.0);
        out.start.1.push(sd);
        out.follows.extend(by);
    }

    /// A value that is read off a lag's state, where it is delayed along a line to the next row.
    fn read_off_lag(&self, value: usize, slot: usize, shown: &[f64], out: &mut Linearised) {
        let RunAt { engine, grid, schedule, .. } = self.about;
        let (wide, p, own) = (out.states, out.parameters, engine.machine.order() + slot);
        let (row, sample) = (schedule.placed[value].row, grid.samples[schedule.placed[value].sample]);
        let effect = self.effects[sample.channel];
        let last = shown.len() - 1;
        let into = sample.time - effect.delay - grid.time[row];
        let share =
            if row < last { (into / (grid.time[row + 1] - grid.time[row])).clamp(0.0, 1.0) } else { 0.0 };
        let next = (row + 1).min(last);
        // seen from this row the next one is where the model leads, off the path by the defect
        let leads = if share > 0.0 { out.defect[row * wide + own] } else { 0.0 };
        let level = shown[row] + share * (shown[next] + leads - shown[row]);
        let around = (row.saturating_sub(1), next);
        let slope =
            (shown[around.1] - shown[around.0]) / (grid.time[around.1] - grid.time[around.0]).max(1e-300);
        let since = sample.time - grid.origin;
        out.measured[value] = Measured {
            residual: sample.value - effect.shown(level, since),
            slope: effect.gain * slope,
            ..out.measured[value]
        };
        for j in 0..wide {
            let here = if j == own { 1.0 - share } else { 0.0 };
            let there = if share > 0.0 { share * out.transition[(row * wide + own) * wide + j] } else { 0.0 };
            out.observe[value * wide + j] = effect.gain * (here + there);
        }
        for place in 0..p {
            let drive = if share > 0.0 { share * out.drive[(row * p + place) * wide + own] } else { 0.0 };
            // a lag changes the state that stands for it
            let late = |kind| if kind == OutputEffect::Lag { 0.0 } else { -slope };
            let at_port = self.at_port(place, sample.channel, level, since, late);
            out.direct[value * p + place] = effect.gain * drive + at_port;
        }
    }
}

/// An interval of the run without lags, with a row more for each of them.
fn add_interval(out: &mut Linearised, plain: &Linearised, row: usize, steps: &[LagStep]) {
    let n = plain.states;
    for states in plain.transition[row * n * n..(row + 1) * n * n].chunks(n.max(1)) {
        out.transition.extend_from_slice(states);
        out.transition.extend(steps.iter().map(|_| 0.0));
    }
    for (slot, step) in steps.iter().enumerate() {
        out.transition.extend_from_slice(&step.by_states);
        out.transition.extend((0..steps.len()).map(|other| if other == slot { step.keeps } else { 0.0 }));
    }
    for place in 0..plain.parameters {
        out.drive.extend_from_slice(plain.column(row, place));
        out.drive.extend(steps.iter().map(|step| step.drive[place]));
    }
    out.defect.extend_from_slice(&plain.defect[row * n..(row + 1) * n]);
    out.defect.extend(steps.iter().map(|step| step.defect));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::tests::pendulum;

    #[test]
    fn value_a_lag_of_a_ramp_is_the_closed_form() {
        let time: Vec<f64> = (0..50).map(|row| 0.1 * f64::from(row)).collect();
        let shown = lagged(&time, &time, &time, 0.7);
        for (t, shown) in time.iter().zip(shown) {
            // y = t - T + T exp(-t/T); fifty products of doubles
            assert!((shown - (t - 0.7 + 0.7 * libm::exp(-t / 0.7))).abs() < 1e-13, "{t}");
        }
        assert_eq!(lagged(&time, &time, &time, 0.0), time);
    }

    #[test]
    fn law_what_a_late_sensor_saw_does_not_hang_on_the_path_about_which_it_is_read() {
        let problem = pendulum("late", 60);
        let runs = problem.whole_runs();
        let built = crate::dynamics::build::build(&problem, &runs).expect("it can be followed");
        let engine = &built.engine;
        let mut theta = engine.machine.neutral();
        for (name, value) in [("acrobot_plant.q1:delay", 0.013), ("acrobot_plant.q1:lag", 0.002)] {
            let place = engine.machine.parameters.iter().position(|parameter| parameter.name == name);
            theta[place.expect("an effect at an output")] = value;
        }
        let about = |path: &Vec<f64>| {
            let run =
                engine.chords(&theta, std::slice::from_ref(path), &[]).expect("it can be followed").remove(0);
            let told = crate::infer::sweep::sweep(&run, &built.noise, &[]);
            (told.square + told.log_det, crate::infer::smooth(&run, &built.noise).state)
        };
        let filtered = engine.first_paths(&theta, &built.noise).expect("it can be followed").remove(0);
        let (here, moves) = about(&filtered);
        let states = engine.machine.order();
        let by = moves.chunks(states + 1).flat_map(|row| &row[..states]);
        let smoothed = filtered.iter().zip(by).map(|(state, by)| state + by).collect();
        let (there, _) = about(&smoothed);
        // the filtered path jumps at each value, the smoothed one doesn't; a pendulum bends little over these
        // jumps: 0.13, and 2.3 if the jumps were forgotten
        assert!((here - there).abs() < 0.5, "{here} {there}");
    }

    #[test]
    fn law_a_lag_that_forgets_within_a_row_is_as_likely_as_none() {
        let problem = pendulum("forgets", 60);
        let built =
            crate::dynamics::build::build(&problem, &problem.whole_runs()).expect("it can be followed");
        let engine = &built.engine;
        let lag = engine.machine.parameters.iter().position(|one| one.name == "acrobot_plant.q1:lag");
        let deviance = |time: f64| {
            let mut theta = engine.machine.neutral();
            theta[lag.expect("an effect at an output")] = time;
            let paths = engine.first_paths(&theta, &built.noise).expect("it can be followed");
            let run = engine.chords(&theta, &paths, &[]).expect("it can be followed").remove(0);
            // process noise of the last interval is in the state, and not yet in what lags behind it
            let process = built.noise.process.iter().map(|size| 1e-3 * size).collect();
            let told = crate::infer::sweep::sweep(
                &run,
                &crate::infer::Noise { process, ..built.noise.clone() },
                &[],
            );
            told.square + told.log_det
        };
        // equal but for the path's own rounding; 4.3 apart if a lag could begin anywhere
        let (none, short) = (deviance(0.0), deviance(1e-7));
        assert!((none - short).abs() < 0.1, "{none} {short}");
    }

    #[test]
    fn value_a_delay_reads_between_rows() {
        let time = [0.0, 1.0, 2.0, 4.0];
        let values = [0.0, 10.0, 20.0, 0.0];
        assert_eq!(delayed(&time, &values, &values, 0.5), [0.0, 5.0, 15.0, 5.0]);
        // an output that jumps by 8 at the second row, just after it was read: half a row later half of the line from there
        let begun = [0.0, 18.0, 20.0, 0.0];
        assert_eq!(delayed(&time, &begun, &values, 0.5), [0.0, 5.0, 19.0, 5.0]);
        assert_eq!(
            delayed(&time, &begun, &values, 1.0),
            [0.0, 0.0, 10.0, 10.0],
            "at a row as it was read there"
        );
    }
}
