//! Connections on which values take time, get lost, are held along a line, or have an age that is recorded.
//!
//! A sample is sent at the start and at each communication point of the sending unit. The n-th one (the start's has number
//! 0) is lost with the probability `drop`; else it arrives after the latency plus `jitter` times a normal number, but not
//! before it was sent. Of what has arrived the newest by the time of sending counts: a sample that was overtaken changes
//! nothing any more. Numbers are drawn by seed, connection and n, so that nothing else moves them.

use crate::link::Link;
use crate::noise::Draw;
use crate::system::Values;
use crate::value::Value;
use std::collections::VecDeque;

/// Samples on the way from which on those are thrown out that were overtaken.
const MANY: usize = 64;

/// A connection with its samples; times in ticks.
#[derive(Debug, Clone)]
pub(crate) struct Line {
    pub(crate) link: Link,
    /// The unit that gets the values.
    pub(crate) to: usize,
    pub(crate) delay: i64,
    /// When the value in use was sent; a start value, at the start.
    pub(crate) sent: i64,
    /// What is on the way, by arrival.
    pub(crate) queue: VecDeque<Sample>,
    pub(crate) chance: Option<Chance>,
    /// With linear hold: the newest two that arrived.
    pub(crate) slope: Option<Slope>,
    /// Where overtaken samples are looked for.
    full: usize,
}

/// A value on its way.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Sample {
    arrives: i64,
    sent: i64,
    value: Value,
}

/// What is left to chance.
#[derive(Debug, Clone)]
pub(crate) struct Chance {
    pub(crate) draw: Draw,
    /// Standard deviation of the latency in ticks.
    pub(crate) jitter: f64,
    pub(crate) drop: f64,
    /// How many samples were sent.
    pub(crate) count: u64,
}

/// The newest two samples that arrived, newest last: time of sending and value.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Slope {
    before: Option<(i64, f64)>,
    newest: Option<(i64, f64)>,
}

/// What changes while running, for a checkpoint.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(crate) struct LineState {
    sent: i64,
    queue: Vec<Sample>,
    count: u64,
    slope: Option<Slope>,
}

impl Line {
    pub(crate) fn new(link: Link, to: usize, delay: i64, waiting: usize) -> Self {
        let queue = VecDeque::with_capacity(waiting);
        Self { link, to, delay, sent: 0, queue, chance: None, slope: None, full: MANY }
    }

    /// Nothing happens to values on their way.
    pub(crate) fn is_direct(&self) -> bool {
        self.delay == 0 && self.chance.is_none() && self.slope.is_none()
    }

    /// Nothing was sent yet.
    pub(crate) fn clear(&mut self, start: i64) {
        self.queue.clear();
        (self.sent, self.full) = (start, MANY);
        if let Some(chance) = &mut self.chance {
            chance.count = 0;
        }
        if let Some(slope) = &mut self.slope {
            *slope = Slope::default();
        }
    }

    /// Sends what its output is at a point of the sending unit. `ends`: where the next steps of the units end.
    #[inline(never)]
    pub(crate) fn push(&mut self, values: &Values, ends: &[i64], ticks: i64) {
        if ends[self.to] == i64::MAX {
            // It steps no more; the queue would only grow.
            return;
        }
        let Some(arrives) = (match &mut self.chance {
            None => Some(ticks + self.delay),
            Some(chance) => chance.arrival(ticks, self.delay),
        }) else {
            return;
        };
        let value = self.link.convert(values.get(self.link.from));
        let sample = Sample { arrives, sent: ticks, value };
        if self.queue.back().is_none_or(|last| last.arrives <= arrives) {
            self.queue.push_back(sample);
        } else {
            let at = self.queue.partition_point(|other| other.arrives <= arrives);
            self.queue.insert(at, sample);
        }
        if self.queue.len() >= self.full {
            self.tidy();
        }
    }

    /// Throws out what was overtaken.
    #[cold]
    fn tidy(&mut self) {
        let counts = self.slope.as_ref().and_then(|slope| slope.before).map_or(self.sent, |(sent, _)| sent);
        self.queue.retain(|sample| sample.sent >= counts);
        self.full = (2 * self.queue.len()).max(MANY);
    }

    /// Hands over what has arrived by now.
    pub(crate) fn deliver(&mut self, values: &mut Values, now: i64) {
        while self.queue.front().is_some_and(|sample| sample.arrives <= now) {
            let Some(sample) = self.queue.pop_front() else { break };
            if let Some(slope) = &mut self.slope {
                slope.take(&sample);
            }
            if sample.sent < self.sent {
                continue;
            }
            self.sent = sample.sent;
            if self.slope.is_none() {
                values.put(self.link.to, &sample.value);
            }
        }
        if let Some(value) = self.slope.as_ref().and_then(|slope| slope.at(now - self.delay)) {
            values.put(self.link.to, &Value::Real(value));
        }
    }

    pub(crate) fn save(&self) -> LineState {
        LineState {
            sent: self.sent,
            queue: self.queue.iter().cloned().collect(),
            count: self.chance.as_ref().map_or(0, |chance| chance.count),
            slope: self.slope.clone(),
        }
    }

    pub(crate) fn restore(&mut self, state: &LineState) {
        self.sent = state.sent;
        self.queue = state.queue.iter().cloned().collect();
        self.slope.clone_from(&state.slope);
        if let Some(chance) = &mut self.chance {
            chance.count = state.count;
        }
    }
}

impl Chance {
    /// When the next sample arrives, if it does. Whole ticks, upwards: nobody looks between them.
    fn arrival(&mut self, sent: i64, delay: i64) -> Option<i64> {
        let number = self.count;
        self.count += 1;
        if self.drop > 0.0 && self.draw.uniform(number) < self.drop {
            return None;
        }
        if self.jitter == 0.0 {
            return Some(sent + delay);
        }
        let off = (self.jitter * self.draw.normal(number)).ceil();
        // The cast saturates, and so does the sum: what is that late never arrives.
        Some(sent.saturating_add(delay.saturating_add(off as i64).max(0)))
    }
}

impl Slope {
    fn take(&mut self, sample: &Sample) {
        let Value::Real(value) = sample.value else { return };
        let sample = (sample.sent, value);
        match (self.before, self.newest) {
            (_, Some(newest)) if sample.0 > newest.0 => {
                (self.before, self.newest) = (Some(newest), Some(sample))
            }
            (_, None) => self.newest = Some(sample),
            (Some(before), _) if sample.0 > before.0 => self.before = Some(sample),
            (None, _) => self.before = Some(sample),
            _ => {}
        }
    }

    /// The line through both at a time of sending; the one value, if there is but one.
    fn at(&self, time: i64) -> Option<f64> {
        let (newest, value) = self.newest?;
        let Some((before, earlier)) = self.before else { return Some(value) };
        let share = (time - newest) as f64 / (newest - before) as f64;
        Some(if share == 0.0 { value } else { value + share * (value - earlier) })
    }
}

#[cfg(test)]
mod tests {
    use super::{Chance, Line, MANY};
    use crate::link::{Conversion, Link};
    use crate::noise::Draw;
    use crate::recorder::Slot;
    use crate::system::Values;

    /// From the first real to the second.
    fn line(delay: i64) -> (Line, Values) {
        let link = Link { from: Slot::Real(0), to: Slot::Real(1), conversion: Conversion::Same };
        (Line::new(link, 0, delay, 4), Values { reals: vec![0.0, 0.0], ..Values::default() })
    }

    #[test]
    fn law_what_was_overtaken_does_not_pile_up() {
        let (mut line, mut values) = line(0);
        // The newest arrived long ago; all that was sent before it is still on its way.
        (line.sent, line.delay) = (1_000_000, 2_000_000);
        for sent in 0..10 * MANY as i64 {
            line.push(&values, &[0], sent);
            assert!(line.queue.len() < MANY, "{} of {sent}", line.queue.len());
        }
        line.deliver(&mut values, 1_500_000);
        // What is not overtaken stays, and the next look at it comes when there is twice as much.
        let mut looks = 0;
        for sent in 0..10 * MANY as i64 {
            let before = line.full;
            line.push(&values, &[0], 1_000_000 + sent);
            looks += usize::from(line.full != before);
        }
        assert!(line.queue.len() >= 10 * MANY && line.full > line.queue.len(), "{}", line.full);
        assert_eq!(looks, 4, "at 64, 128, 256 and 512 samples");
    }

    #[test]
    fn law_samples_arrive_in_the_order_of_their_arrival_and_the_newest_counts() {
        let (mut line, mut values) = line(3);
        for (sent, value) in [(0, 1.0), (1, 2.0)] {
            values.reals[0] = value;
            line.push(&values, &[0], sent);
        }
        // It overtakes both.
        (line.delay, values.reals[0]) = (0, 3.0);
        line.push(&values, &[0], 2);
        let arrivals: Vec<i64> = line.queue.iter().map(|sample| sample.arrives).collect();
        assert_eq!(arrivals, [2, 3, 4]);
        line.deliver(&mut values, 2);
        assert_eq!((values.reals[1], line.sent, line.queue.len()), (3.0, 2, 2));
        line.deliver(&mut values, 4);
        assert_eq!(
            (values.reals[1], line.sent, line.queue.len()),
            (3.0, 2, 0),
            "the older ones change nothing"
        );
        // A unit that steps no more is sent nothing.
        line.push(&values, &[i64::MAX], 5);
        assert!(line.queue.is_empty());
    }

    #[test]
    fn law_the_nth_sample_has_the_nth_numbers() {
        let draw = Draw::new(3, "b.u1");
        let mut chance = Chance { draw, jitter: 10.0, drop: 0.0, count: 0 };
        for number in 0..20 {
            let late = (100.0 + (10.0 * draw.normal(number)).ceil()) as i64;
            assert_eq!(chance.arrival(7, 100), Some(7 + late), "{number}");
        }
        assert_eq!(chance.count, 20);
        chance = Chance { draw, jitter: 0.0, drop: 0.45, count: 0 };
        let found: Vec<bool> = (0..20).map(|_| chance.arrival(7, 100).is_none()).collect();
        let expected: Vec<bool> = (0..20).map(|number| draw.uniform(number) < 0.45).collect();
        assert_eq!(found, expected);
        assert!((0..20).filter_map(|_| chance.arrival(7, 100)).all(|arrives| arrives == 107));
        // Never before it was sent.
        chance = Chance { draw, jitter: 1e6, drop: 0.0, count: 0 };
        assert!((0..20).filter_map(|_| chance.arrival(7, 0)).all(|arrives| arrives >= 7));
    }
}
