//! The course of an input after the effects at its port.
//!
//! A held log is a chain of straight lines with jumps; delay, saturation and rate limit turn lines into lines; a lag
//! turns each into an exponential, which is cut into lines short against its time constant. Gain and bias act last.

use super::policy::PORTS;
use crate::dynamics::grid::Course;
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

/// A straight piece.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Begin, s.
    pub from: f64,
    /// Value there.
    pub first: f64,
    /// Value at its end, where the next one begins.
    pub last: f64,
}

/// A chain of lines; the last one holds for ever.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Lines(pub Vec<Line>);

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
    for line in &mut lines.0 {
        line.first = effects.gain * line.first + effects.bias;
        line.last = effects.gain * line.last + effects.bias;
    }
    lines
}

fn logged(course: &Course) -> Lines {
    let count = course.time.len();
    let line = |row: usize| {
        let first = course.values[row];
        let last = match course.hold {
            Hold::Linear if row + 1 < count => course.values[row + 1],
            _ => first,
        };
        Line { from: course.time[row], first, last }
    };
    let mut lines: Vec<Line> = (0..count).map(line).collect();
    // rows at which nothing changes are one line: each break costs a step of the unit
    lines.dedup_by(|next, known| {
        known.first == known.last && next.first == known.last && next.last == known.last
    });
    Lines(lines)
}

/// Before the log the first value holds.
fn delay(lines: &mut Lines, by: f64) {
    let Some(begin) = lines.0.first().copied() else { return };
    lines.0.iter_mut().for_each(|line| line.from += by);
    lines.0.insert(0, Line { from: begin.from, first: begin.first, last: begin.first });
}

/// Calls with begin, length and values of each line; the last has no end.
fn each(lines: &Lines, mut job: impl FnMut(Line, f64)) {
    for (place, line) in lines.0.iter().enumerate() {
        let end = lines.0.get(place + 1).map_or(f64::INFINITY, |next| next.from);
        job(*line, end - line.from);
    }
}

fn saturated(lines: &Lines, limit: f64) -> Lines {
    let mut cut = Vec::with_capacity(lines.0.len());
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
            cut.push(Line { from, first: value(share), last: value(to) });
            share = to;
        }
    });
    Lines(cut)
}

fn limited(lines: &Lines, limit: f64) -> Lines {
    let mut slow = Vec::with_capacity(lines.0.len());
    let mut value = lines.0.first().map_or(0.0, |line| line.first);
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
            slow.push(Line { from: line.from, first: value, last: to });
            value = to;
            from = until;
        }
        if from < span {
            let to = match (span.is_finite(), rate.abs() <= limit) {
                (true, true) => line.last,
                (true, false) => value + limit.copysign(rate) * (span - from),
                (false, _) => value,
            };
            slow.push(Line { from: line.from + from, first: value, last: to });
            value = to;
        }
    });
    Lines(slow)
}

fn lagged(lines: &Lines, time: f64) -> Lines {
    let mut slow = Vec::with_capacity(2 * lines.0.len());
    let mut value = lines.0.first().map_or(0.0, |line| line.first);
    // after so many time constants it is off by 1e-7
    let settled = 2.0 * PORTS.cuts;
    each(lines, |line, span| {
        let whole = span.min(settled * time);
        let rate = if span.is_finite() && span > 0.0 { (line.last - line.first) / span } else { 0.0 };
        if rate == 0.0 && value == line.first {
            slow.push(Line { from: line.from, first: value, last: value });
            return;
        }
        // y = u₀ + rate (t - T) + (y₀ - u₀ + rate T) exp(-t / T)
        let at = |t: f64, y0: f64| {
            line.first + rate * (t - time) + (y0 - line.first + rate * time) * libm::exp(-t / time)
        };
        let parts = (PORTS.cuts * whole / time).ceil().clamp(1.0, PORTS.cuts * settled) as usize;
        let begin = value;
        for part in 0..parts {
            let (from, to) = (part as f64 / parts as f64 * whole, (part + 1) as f64 / parts as f64 * whole);
            let last = at(to, begin);
            slow.push(Line { from: line.from + from, first: value, last });
            value = last;
        }
        if whole < span {
            let last = if span.is_finite() { at(span, begin) } else { line.first };
            slow.push(Line { from: line.from + whole, first: value, last });
            value = last;
        }
    });
    Lines(slow)
}

impl Lines {
    /// Place of the line that holds just after a time; `near` is where it was last.
    fn place(&self, time: f64, near: usize) -> usize {
        let mut place = near.min(self.0.len() - 1);
        while place > 0 && self.0[place].from > time {
            place -= 1;
        }
        while place + 1 < self.0.len() && self.0[place + 1].from <= time {
            place += 1;
        }
        place
    }

    fn end(&self, place: usize) -> f64 {
        self.0.get(place + 1).map_or(f64::INFINITY, |next| next.from)
    }

    fn value(&self, place: usize, time: f64) -> f64 {
        let line = self.0[place];
        let end = self.end(place);
        if !end.is_finite() || line.first == line.last || time <= line.from {
            return line.first;
        }
        line.first + (line.last - line.first) * ((time - line.from) / (end - line.from)).min(1.0)
    }

    /// The value just after a time.
    pub fn after(&self, time: f64, near: &mut usize) -> f64 {
        *near = self.place(time, *near);
        self.value(*near, time)
    }

    /// The value just before a time; before the first line its first value.
    pub fn before(&self, time: f64, near: &mut usize) -> f64 {
        *near = self.place(time, *near);
        let line = self.0[*near];
        match near.checked_sub(1) {
            Some(last) if time - line.from <= PORTS.same_time * time.abs() => self.0[last].last,
            _ => self.value(*near, time),
        }
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
                let line = self.0[place];
                let (first, last) = if line.first == line.last {
                    (line.first, line.first)
                } else {
                    (self.value(place, begin), if end < to { line.last } else { self.value(place, end) })
                };
                sum += 0.5 * (first + last) * (end - begin);
                begin = end;
            }
            place += 1;
            if place >= self.0.len() && begin < to {
                sum += self.0[self.0.len() - 1].last * (to - begin);
                begin = to;
            }
        }
        sum / (to - from)
    }

    /// Times of jumps and corners strictly between two times.
    pub fn breaks(&self, from: f64, to: f64, near: &mut usize, into: &mut Vec<f64>) {
        *near = self.place(from, *near);
        let after = self.0[*near + 1..].iter().map(|line| line.from);
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
    fn law_a_lag_after_a_jump_settles_once() {
        let slow = arriving(&step(), &Effects { lag: 0.02, ..Effects::OFF });
        // 3 - 2 exp(-t / T); lines over an eighth of T are off by (1/8)²/8 of the height at most
        for t in [0.0, 0.013, 0.05, 0.2, 0.31] {
            let exact = 3.0 - 2.0 * libm::exp(-t / 0.02);
            assert!((slow.after(0.4 + t, &mut 0) - exact).abs() < 2.0 / 512.0, "{t}");
        }
        let mut breaks = Vec::new();
        slow.breaks(0.0, 0.99, &mut 0, &mut breaks);
        // eight lines over each of sixteen time constants, and what is settled; before the jump nothing moves
        assert_eq!(breaks.len(), 129);
    }
}
