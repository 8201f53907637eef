//! Which cases there are: the values of each. A case is known by its number alone, so that any of them can be made anywhere.

mod directions;
mod sample;
mod sobol;

pub(crate) use sample::Sampler;

use orchestrator::Value;

/// More cases than this are none that anybody waits for; their numbers are exact as doubles.
pub(crate) const MOST: u64 = 1 << 48;

/// How the values of the cases come about.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Design {
    /// All combinations; the last parameter varies fastest.
    Grid(Vec<Vec<Value>>),
    /// Row by row.
    List(Vec<Vec<Value>>),
    /// Points within ranges.
    Sampled(Sampled),
}

/// Points within ranges.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sampled {
    pub(crate) method: Method,
    pub(crate) count: u64,
    pub(crate) seed: Option<u64>,
    pub(crate) ranges: Vec<Range>,
}

/// How points lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Method {
    /// Each by itself.
    Random,
    /// Each of `count` slices of every range holds one.
    LatinHypercube,
    /// Sobol's sequence, with a seed shifted by a random number for each range (modulo 2, digit by digit).
    Sobol,
}

/// The range of a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Range {
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// Even in the logarithm.
    pub(crate) log: bool,
    /// Whole numbers, both ends among them.
    pub(crate) whole: bool,
}

impl Range {
    /// The value at a share of the range, 0 to 1 (for whole numbers: below 1).
    pub(crate) fn at(&self, share: f64) -> f64 {
        let Self { from, to, .. } = *self;
        if self.whole {
            return (from + (share * (to - from + 1.0)).floor()).min(to);
        }
        let value = match self.log {
            true => libm::exp(libm::log(from) + share * (libm::log(to) - libm::log(from))),
            false => from + share * (to - from),
        };
        value.clamp(from.min(to), to.max(from))
    }
}

impl Design {
    /// How many cases there are; `None` where that can't be counted.
    pub(crate) fn cases(&self) -> Option<u64> {
        match self {
            Self::Grid(axes) => {
                axes.iter().try_fold(1_u64, |cases, axis| cases.checked_mul(u64::try_from(axis.len()).ok()?))
            }
            Self::List(rows) => u64::try_from(rows.len()).ok(),
            Self::Sampled(sampled) => Some(sampled.count),
        }
    }

    /// The different values that a parameter takes; of a range its ends.
    pub(crate) fn values(&self, parameter: usize) -> Vec<Value> {
        match self {
            Self::Grid(axes) => axes[parameter].clone(),
            Self::List(rows) => rows.iter().map(|row| row[parameter].clone()).collect(),
            Self::Sampled(sampled) => {
                let range = &sampled.ranges[parameter];
                let end = |value: f64| match range.whole {
                    true => Value::Integer(value as i32),
                    false => Value::Real(value),
                };
                vec![end(range.from), end(range.to)]
            }
        }
    }
}

impl Sampled {
    /// What is wrong, and what would be right.
    pub(crate) fn refused(&self) -> Option<(String, String)> {
        let (count, ranges) = (self.count, self.ranges.len());
        match self.method {
            Method::Sobol if ranges > sobol::DIMENSIONS => {
                Some((format!("{ranges} parameters"), format!("{} at most", sobol::DIMENSIONS)))
            }
            Method::Sobol if count > sobol::POINTS => {
                Some((format!("count = {count}"), format!("{} at most", sobol::POINTS)))
            }
            Method::LatinHypercube if count > sample::SLICES => {
                Some((format!("count = {count}"), format!("{} at most", sample::SLICES)))
            }
            _ => None,
        }
    }
}
