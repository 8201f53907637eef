//! The course of an input after the effects at its port.
//!
//! A held log is a chain of straight lines with jumps; delay, saturation and rate limit turn lines into lines; a lag
//! adds to each what fades away exponentially, and cuts it where the unit has to be stepped. Gain and bias act last.

use super::Course;
use super::policy::PORTS;
use crate::observe::Hold;

/// The effects at one input, each at a value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effects {
    /// Factor.
    pub gain: f64,
    /// Summand.
    pub bias: f64,
    /// s.
    pub delay: f64,
    /// s.
    pub lag: f64,
    /// Largest magnitude; 0: none.
    pub saturation: f64,
    /// Largest rate per s; 0: none.
    pub rate_limit: f64,
}

impl Effects {
    /// None.
    pub const OFF: Self =
        Self { gain: 1.0, bias: 0.0, delay: 0.0, lag: 0.0, saturation: 0.0, rate_limit: 0.0 };
}

/// A straight piece, and what fades away beside it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Line {
    /// Begin, s.
    from: f64,
    /// Value of the straight part there.
    first: f64,
    /// Its value at the end, where the next one begins.
    last: f64,
    /// What is to be added at the begin; it fades with the lag.
    fading: f64,
}

impl Line {
    fn straight(from: f64, first: f64, last: f64) -> Self {
        Self { from, first, last, fading: 0.0 }
    }
}

/// A chain of lines; the last one holds for ever.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Lines {
    lines: Vec<Line>,
    /// s.
    lag: f64,
}

/// What reaches the unit.
pub fn arriving(course: &Course, effects: &Effects) -> Lines {
    let mut lines = logged(course);
    if effects.delay > 0.0 {
        delay(&mut lines, effects.delay);
    }
    if effects.saturation > 0.0 {
        lines = saturated(&lines, effects.saturation);
    }
    if effects.rate_limit > 0.0 {
        lines = limited(&lines, effects.rate_limit);
    }
    if effects.lag > 0.0 {
        lines = lagged(&lines, effects.lag);
    }
    for line in &mut lines {
        line.first = effects.gain * line.first + effects.bias;
        line.last = effects.gain * line.last + effects.bias;
        line.fading *= effects.gain;
    }
    Lines { lines, lag: effects.lag }
}

fn logged(course: &Course) -> Vec<Line> {
    let count = course.time.len();
    let line = |row: usize| {
        let first = course.values[row];
        let last = match course.hold {
            Hold::Linear if row + 1 < count => course.values[row + 1],
            _ => first,
        };
        Line::straight(course.time[row], first, last)
    };
    let mut lines: Vec<Line> = (0..count).map(line).collect();
    // rows at which nothing changes are one line: each break costs a step of the unit
    lines.dedup_by(|next, known| {
        known.first == known.last && next.first == known.last && next.last == known.last
    });
    lines
}

/// Before the log the first value holds.
fn delay(lines: &mut Vec<Line>, by: f64) {
    let Some(begin) = lines.first().copied() else { return };
    lines.iter_mut().for_each(|line| line.from += by);
    lines.insert(0, Line::straight(begin.from, begin.first, begin.first));
}

/// Calls with begin, length and values of each line; the last has no end.
fn each(lines: &[Line], mut job: impl FnMut(Line, f64)) {
    for (place, line) in lines.iter().enumerate() {
        let end = lines.get(place + 1).map_or(f64::INFINITY, |next| next.from);
        job(*line, end - line.from);
    }
}

fn saturated(lines: &[Line], limit: f64) -> Vec<Line> {
    let mut cut = Vec::with_capacity(lines.len());
    each(lines, |line, span| {
        let rise = line.last - line.first;
        let mut corners: Vec<f64> = Vec::new();
        if rise != 0.0 && span.is_finite() {
            corners.extend([-limit, limit].iter().map(|level| (level - line.first) / rise));
            corners.retain(|share| *share > 0.0 && *share < 1.0);
            corners.sort_by(f64::total_cmp);
        }
        let mut share = 0.0;
        for to in corners.into_iter().chain([1.0]) {
            let value = |share: f64| (line.first + rise * share).clamp(-limit, limit);
            let from = if share == 0.0 { line.from } else { line.from + share * span };
            cut.push(Line::straight(from, value(share), value(to)));
            share = to;
        }
    });
    cut
}

fn limited(lines: &[Line], limit: f64) -> Vec<Line> {
    let mut slow = Vec::with_capacity(lines.len());
    let mut value = lines.first().map_or(0.0, |line| line.first);
    each(lines, |line, span| {
        let rate = if span.is_finite() && span > 0.0 { (line.last - line.first) / span } else { 0.0 };
        let gap = line.first - value;
        let mut from = 0.0;
        if gap != 0.0 {
            let closing = limit - rate * gap.signum();
            let caught = if closing > 0.0 { gap.abs() / closing } else { f64::INFINITY };
            let until = caught.min(span);
            let to =
                if caught <= span { line.first + rate * caught } else { value + limit.copysign(gap) * span };
            slow.push(Line::straight(line.from, value, to));
            value = to;
            from = until;
        }
        if from < span {
            let to = match (span.is_finite(), rate.abs() <= limit) {
                (true, true) => line.last,
                (true, false) => value + limit.copysign(rate) * (span - from),
                (false, _) => value,
            };
            slow.push(Line::straight(line.from + from, value, to));
            value = to;
        }
    });
    slow
}

/// y = u₀ + rate (t - T) + (y₀ - u₀ + rate T) exp(-t / T). The unit holds the mean over each of its steps: its rates are exact at the
/// cuts then, and its states are off by the first moment of what is left, which graded cuts make the same in each.
fn lagged(lines: &[Line], time: f64) -> Vec<Line> {
    let mut slow = Vec::with_capacity(2 * lines.len());
    let mut value = lines.first().map_or(0.0, |line| line.first);
    each(lines, |line, span| {
        let rate = if span.is_finite() && span > 0.0 { (line.last - line.first) / span } else { 0.0 };
        let behind = |t: f64| line.first + rate * (t - time);
        let fading = |t: f64| (value - behind(0.0)) * libm::exp(-t / time);
        if fading(0.0) == 0.0 {
            slow.push(Line::straight(line.from, behind(0.0), line.last - rate * time));
            value = line.last - rate * time;
            return;
        }
        let mut ends = cuts(time).skip(1).take_while(|end| *end < span).chain([span]);
        let mut from = 0.0;
        for end in &mut ends {
            let last = if end.is_finite() { behind(end) } else { line.first };
            slow.push(Line { from: line.from + from, first: behind(from), last, fading: fading(from) });
            from = end;
        }
        // what is over must not cut the next line, too
        let left = if span < f64::from(PORTS.cuts) * time { fading(span) } else { 0.0 };
        value = if span.is_finite() { behind(span) + left } else { line.first };
    });
    slow
}

/// Begins of pieces of a decay of one time constant, which is over after the last: its height times the cube of a piece's length is
/// the same in each.
fn cuts(time: f64) -> impl Iterator<Item = f64> {
    let all = f64::from(PORTS.cuts);
    let last = libm::cbrt(libm::exp(-all));
    let root = move |cut: u32| 1.0 - (1.0 - last) * f64::from(cut) / all;
    (0..=PORTS.cuts).map(move |cut| -time * libm::log(root(cut) * root(cut) * root(cut)))
}

impl Lines {
    /// Place of the line that holds just after a time; `near` is where it was last.
    fn place(&self, time: f64, near: usize) -> usize {
        let mut place = near.min(self.lines.len() - 1);
        while place > 0 && self.lines[place].from > time {
            place -= 1;
        }
        while place + 1 < self.lines.len() && self.lines[place + 1].from <= time {
            place += 1;
        }
        place
    }

    fn end(&self, place: usize) -> f64 {
        self.lines.get(place + 1).map_or(f64::INFINITY, |next| next.from)
    }

    fn value(&self, place: usize, time: f64) -> f64 {
        let line = self.lines[place];
        self.straight(place, time) + self.fading(&line, time)
    }

    fn straight(&self, place: usize, time: f64) -> f64 {
        let line = self.lines[place];
        let end = self.end(place);
        if !end.is_finite() || line.first == line.last || time <= line.from {
            return line.first;
        }
        line.first + (line.last - line.first) * ((time - line.from) / (end - line.from)).min(1.0)
    }

    /// What is left of what fades.
    fn fading(&self, line: &Line, time: f64) -> f64 {
        if line.fading == 0.0 {
            return 0.0;
        }
        line.fading * libm::exp(-(time - line.from).max(0.0) / self.lag)
    }

    /// The value just after a time.
    pub fn after(&self, time: f64, near: &mut usize) -> f64 {
        *near = self.place(time, *near);
        self.value(*near, time)
    }

    /// The value just before a time; before the first line its first value.
    pub fn before(&self, time: f64, near: &mut usize) -> f64 {
        *near = self.place(time, *near);
        let line = self.lines[*near];
        match near.checked_sub(1) {
            Some(last) if time - line.from <= PORTS.same_time * time.abs() => {
                self.lines[last].last + self.fading(&self.lines[last], line.from)
            }
            _ => self.value(*near, time),
        }
    }

    /// Whether the value changes within the line that holds just after a time.
    pub fn moves(&self, from: f64, near: &mut usize) -> bool {
        *near = self.place(from, *near);
        let line = self.lines[*near];
        line.fading != 0.0 || line.first != line.last && self.end(*near).is_finite()
    }

    /// The mean from one time to another.
    pub fn mean(&self, from: f64, to: f64, near: &mut usize) -> f64 {
        *near = self.place(from, *near);
        if to <= from {
            return self.value(*near, from);
        }
        let (mut place, mut begin, mut sum) = (*near, from, 0.0);
        while begin < to {
            let end = self.end(place).min(to);
            if end > begin {
                let line = self.lines[place];
                let (first, last) = if line.first == line.last {
                    (line.first, line.first)
                } else {
                    (
                        self.straight(place, begin),
                        if end < to { line.last } else { self.straight(place, end) },
                    )
                };
                sum += 0.5 * (first + last) * (end - begin);
                sum += self.lag * (self.fading(&line, begin) - self.fading(&line, end));
                begin = end;
            }
            place += 1;
            if place >= self.lines.len() && begin < to {
                sum += self.lines[self.lines.len() - 1].last * (to - begin);
                begin = to;
            }
        }
        sum / (to - from)
    }

    /// Times of jumps and corners strictly between two times.
    pub fn breaks(&self, from: f64, to: f64, near: &mut usize, into: &mut Vec<f64>) {
        *near = self.place(from, *near);
        let after = self.lines[*near + 1..].iter().map(|line| line.from);
        into.extend(after.take_while(|time| *time < to).filter(|time| *time > from));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A command that jumps once in 100 rows.
    fn step() -> Course {
        let time = (0..100).map(|row| 0.01 * f64::from(row)).collect();
        let values = (0..100).map(|row| if row < 40 { 1.0 } else { 3.0 }).collect();
        Course { time, values, hold: Hold::Zero }
    }

    #[test]
    fn law_a_held_command_breaks_only_where_it_changes() {
        let late = arriving(&step(), &Effects { delay: 0.004, ..Effects::OFF });
        let mut breaks = Vec::new();
        late.breaks(0.0, 0.99, &mut 0, &mut breaks);
        // where the log begins, and the jump
        assert_eq!(breaks, [0.004, 0.4 + 0.004]);
        let near = &mut 0;
        assert_eq!(
            [late.after(0.403, near), late.after(0.405, near), late.after(5.0, near)],
            [1.0, 3.0, 3.0]
        );
    }

    #[test]
    fn law_a_lag_is_exact_at_all_times_and_in_the_mean() {
        let slow = arriving(&step(), &Effects { lag: 0.02, gain: 0.5, bias: 1.0, ..Effects::OFF });
        let exact = |t: f64| 1.0 + 0.5 * (3.0 - 2.0 * libm::exp(-t / 0.02));
        for t in [0.0, 0.013, 0.05, 0.2, 0.31] {
            assert!((slow.after(0.4 + t, &mut 0) - exact(t)).abs() < 1e-14, "{t}");
        }
        let integral = |t: f64| 2.5 * t + 0.02 * libm::exp(-t / 0.02);
        for (from, to) in [(0.0, 0.001), (0.0005, 0.013), (0.013, 0.5), (0.4, 0.45)] {
            let mean = (integral(to) - integral(from)) / (to - from);
            assert!((slow.mean(0.4 + from, 0.4 + to, &mut 0) - mean).abs() < 1e-13, "{from} to {to}");
        }
    }

    #[test]
    fn law_a_lag_of_a_ramp_runs_behind_it() {
        let course = Course { time: vec![0.0, 1.0, 2.0], values: vec![0.0, 2.0, 2.0], hold: Hold::Linear };
        let slow = arriving(&course, &Effects { lag: 0.1, ..Effects::OFF });
        let ramp = |t: f64| 2.0 * (t - 0.1 + 0.1 * libm::exp(-t / 0.1));
        for t in [0.05, 0.3, 0.99] {
            assert!((slow.after(t, &mut 0) - ramp(t)).abs() < 1e-14, "{t}");
        }
        // what it is behind when the ramp ends fades
        let after = 2.0 - (2.0 - ramp(1.0)) * libm::exp(-0.2 / 0.1);
        assert!((slow.after(1.2, &mut 0) - after).abs() < 1e-14);
        assert!((slow.before(1.0, &mut 0) - ramp(1.0)).abs() < 1e-14);
    }

    #[test]
    fn law_an_input_moves_on_ramps_and_where_something_fades() {
        let moves = |effects: Effects, hold: Hold, at: f64| {
            arriving(&Course { hold, ..step() }, &effects).moves(at, &mut 0)
        };
        let lag = Effects { lag: 0.02, ..Effects::OFF };
        assert!(
            !moves(Effects::OFF, Hold::Zero, 0.405) && !moves(lag, Hold::Zero, 0.2),
            "held, and before the jump"
        );
        assert!(moves(lag, Hold::Zero, 0.405) && moves(Effects::OFF, Hold::Linear, 0.395));
        assert!(moves(Effects { rate_limit: 10.0, ..Effects::OFF }, Hold::Zero, 0.45));
        assert!(!moves(Effects { rate_limit: 10.0, ..Effects::OFF }, Hold::Zero, 0.95), "there at last");
    }

    #[test]
    fn value_a_lag_after_a_jump_settles_once() {
        let slow = arriving(&step(), &Effects { lag: 0.02, ..Effects::OFF });
        let mut breaks = Vec::new();
        slow.breaks(0.0, 0.99, &mut 0, &mut breaks);
        // sixteen pieces, and what is settled; before the jump nothing moves
        assert_eq!(breaks.len(), 17);
        // the unit integrates the mean of each twice: what that is off by, of a jump of 2
        let moment: f64 = breaks
            .windows(2)
            .map(|ends| {
                let (mean, count) = (slow.mean(ends[0], ends[1], &mut 0), 2000);
                let step = (ends[1] - ends[0]) / f64::from(count);
                let at = |place: i32| ends[0] + (f64::from(place) + 0.5) * step;
                (0..count)
                    .map(|place| (slow.after(at(place), &mut 0) - mean) * (ends[1] - at(place)) * step)
                    .sum::<f64>()
            })
            .sum();
        assert!(moment.abs() < 2.0 * 0.0095 * 0.02 * 0.02, "{moment}");
    }
}
