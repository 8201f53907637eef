//! A straight piece of a signal, and the two stages that break it: saturation and rate limit.
//!
//! A line carries the values at both ends, so that what no stage touches comes out with the bits that went in.

/// A straight piece of a signal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// How long it is, s.
    pub span: f64,
    /// Value where it begins.
    pub first: f64,
    /// Value where it ends.
    pub last: f64,
}

impl Line {
    /// The value at a share of the span.
    fn at(&self, share: f64) -> f64 {
        if self.first == self.last { self.last } else { self.first + (self.last - self.first) * share }
    }

    /// The piece from one time to another within it, s from its beginning. Ends that it keeps keep their bits.
    pub fn part(&self, from: f64, to: f64) -> Line {
        let first = if from <= 0.0 { self.first } else { self.at(from / self.span) };
        let last = if to >= self.span { self.last } else { self.at(to / self.span) };
        Line { span: to - from, first, last }
    }

    /// Hands the pieces of y = max(−L, min(L, u)) to `next`; L = 0 is no limit.
    pub fn saturate(self, limit: f64, mut next: impl FnMut(Line)) {
        let cut = |value: f64| if limit > 0.0 { value.clamp(-limit, limit) } else { value };
        if limit == 0.0 || (cut(self.first) == self.first && cut(self.last) == self.last) {
            return next(self);
        }
        let rise = self.last - self.first;
        let corner = |level: f64| (level - self.first) / rise;
        let (near, far) = if rise < 0.0 { (limit, -limit) } else { (-limit, limit) };
        let (mut from, mut value) = (0.0, cut(self.first));
        for level in [near, far] {
            let to = if rise == 0.0 { 1.0 } else { corner(level) };
            if to > from && to < 1.0 {
                next(Line { span: self.span * (to - from), first: value, last: level });
                (from, value) = (to, level);
            }
        }
        next(Line { span: self.span * (1.0 - from), first: value, last: cut(self.last) });
    }

    /// Hands the pieces of a signal that follows this one at no more than R per second to `next`; R = 0 is no limit.
    /// `follower` is the signal's value, kept from line to line.
    pub fn limit_rate(self, limit: f64, follower: &mut f64, mut next: impl FnMut(Line)) {
        let mut go = |from: &mut f64, span: f64, last: f64| {
            next(Line { span, first: *from, last });
            *from = last;
        };
        if limit == 0.0 {
            *follower = self.first;
            return go(follower, self.span, self.last);
        }
        let rate = (self.last - self.first) / self.span;
        let mut left = self.span;
        let gap = self.first - *follower;
        if gap != 0.0 {
            let caught = gap.abs() / (limit - rate * gap.signum()); // never, if negative
            if !(0.0..left).contains(&caught) {
                let last = *follower + limit.copysign(gap) * left;
                return go(follower, left, last);
            }
            go(follower, caught, self.at(caught / self.span));
            left -= caught;
        }
        let last = if rate.abs() <= limit { self.last } else { *follower + limit.copysign(rate) * left };
        go(follower, left, last);
    }

    /// Where a first-order lag with time constant T ends that stands at `lagged` where the line begins:
    /// T·dy/dt = u − y for a line u.
    ///
    /// y = u₀ + (y₀ − u₀)·e^(−x) + (u₁ − u₀)·(1 − φ), x = span/T, φ = (1 − e^(−x))/x.
    pub fn lag(self, time: f64, lagged: f64) -> f64 {
        if time == 0.0 {
            return self.last;
        }
        let x = self.span / time;
        let mut value = self.first;
        if lagged != self.first {
            value += (lagged - self.first) * libm::exp(-x);
        }
        if self.last != self.first && x > 0.0 {
            value += (self.last - self.first) * (1.0 + libm::expm1(-x) / x);
        }
        value
    }
}
