//! What there is to know of each kind of effect at a port: a row of a kind. What it does to a value stands in `input.rs` and `output.rs`.

use super::PORTS;
use crate::observe::{InputEffect, OutputEffect, Scale};

/// What the value of an effect is measured in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// A number without a unit.
    Number,
    /// The unit of the variable at the port.
    Variable,
    /// That unit per second.
    VariablePerSecond,
    /// Seconds.
    Seconds,
}

impl Measure {
    /// Its unit in words where the variable has this one; nothing where neither has any.
    pub fn unit(self, variable: Option<&str>) -> Option<String> {
        match self {
            Self::Number => None,
            Self::Variable => variable.map(str::to_owned),
            Self::VariablePerSecond => variable.map(|unit| format!("{unit}/s")),
            Self::Seconds => Some("s".to_owned()),
        }
    }
}

/// A kind of effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kind {
    /// What a person would call it.
    pub words: &'static str,
    /// Value at which it does nothing.
    pub neutral: f64,
    /// Values that are tried; of what is late up to a share of the shortest run.
    range: (f64, f64),
    /// How it moves.
    pub scale: Scale,
    /// What its value is measured in.
    pub measure: Measure,
    /// What it gives hangs on what came before: where in a row a value moves then matters, and a mean over the row doesn't tell it.
    pub over_time: bool,
}

impl Kind {
    const fn gain() -> Self {
        let (words, neutral, range) = ("gain", 1.0, PORTS.gain);
        Self { words, neutral, range, scale: Scale::Relative, measure: Measure::Number, over_time: false }
    }

    const fn added(words: &'static str, measure: Measure) -> Self {
        let range = (f64::NEG_INFINITY, f64::INFINITY);
        Self { words, neutral: 0.0, range, scale: Scale::Absolute, measure, over_time: false }
    }

    const fn late(words: &'static str) -> Self {
        let (range, measure) = ((0.0, f64::INFINITY), Measure::Seconds);
        Self { words, neutral: 0.0, range, scale: Scale::Absolute, measure, over_time: true }
    }

    const fn limit(words: &'static str, measure: Measure, over_time: bool) -> Self {
        let range = (0.0, f64::INFINITY);
        Self { words, neutral: 0.0, range, scale: Scale::Saturation, measure, over_time }
    }

    /// At an input.
    pub const fn of_input(effect: InputEffect) -> Self {
        match effect {
            InputEffect::Gain => Self::gain(),
            InputEffect::Bias => Self::added("bias", Measure::Variable),
            InputEffect::Delay => Self::late("delay"),
            InputEffect::Lag => Self::late("first-order lag"),
            InputEffect::Saturation => Self::limit("saturation", Measure::Variable, false),
            InputEffect::RateLimit => Self::limit("rate limit", Measure::VariablePerSecond, true),
        }
    }

    /// At an output.
    pub const fn of_output(effect: OutputEffect) -> Self {
        match effect {
            OutputEffect::Gain => Self::gain(),
            OutputEffect::Offset => Self::added("offset", Measure::Variable),
            OutputEffect::Delay => Self::late("delay"),
            OutputEffect::Lag => Self::late("first-order lag"),
            OutputEffect::Drift => Self::added("drift", Measure::VariablePerSecond),
        }
    }

    /// It shifts a value in time: the sensitivity where it is neutral says little of it a row later.
    pub fn is_late(&self) -> bool {
        self.measure == Measure::Seconds
    }

    /// Values that are tried, where nothing may come later than this, s.
    pub fn range(&self, latest: f64) -> (f64, f64) {
        (self.range.0, if self.is_late() { self.range.1.min(latest) } else { self.range.1 })
    }
}

/// Each kind by the name that it has behind the colon, with what it is measured in. The same names mean the same at both sides.
pub fn measures() -> impl Iterator<Item = (&'static str, Measure)> {
    let inputs = InputEffect::ALL.iter().map(|effect| (effect.name(), Kind::of_input(*effect).measure));
    inputs.chain(OutputEffect::ALL.iter().map(|effect| (effect.name(), Kind::of_output(*effect).measure)))
}

#[cfg(test)]
mod tests {
    use super::{Kind, Measure, measures};
    use crate::observe::{InputEffect, OutputEffect};

    #[test]
    fn every_kind_of_effect_has_its_unit() {
        let unit = |name: &str| -> Vec<Option<String>> {
            measures().filter(|(kind, _)| *kind == name).map(|(_, measure)| measure.unit(Some("V"))).collect()
        };
        assert_eq!(unit("gain"), [None, None]);
        assert_eq!(unit("drift"), [Some("V/s".to_owned())]);
        assert_eq!(unit("rate_limit"), [Some("V/s".to_owned())]);
        assert_eq!(unit("saturation"), [Some("V".to_owned())]);
        assert_eq!(unit("delay"), vec![Some("s".to_owned()); 2]);
        assert_eq!(
            Measure::Seconds.unit(None).as_deref(),
            Some("s"),
            "a delay of a number is a time as well"
        );
        assert_eq!(Measure::VariablePerSecond.unit(None), None);
    }

    #[test]
    fn law_what_hangs_on_the_past_is_late_or_limits_a_rate() {
        let over_time = |kind: &Kind| kind.is_late() || kind.words == "rate limit";
        let kinds = InputEffect::ALL.iter().map(|effect| Kind::of_input(*effect));
        for kind in kinds.chain(OutputEffect::ALL.iter().map(|effect| Kind::of_output(*effect))) {
            assert_eq!(kind.over_time, over_time(&kind), "{kind:?}");
        }
    }

    #[test]
    fn every_kind_is_neutral_within_its_range() {
        let kinds = InputEffect::ALL.iter().map(|effect| Kind::of_input(*effect));
        for kind in kinds.chain(OutputEffect::ALL.iter().map(|effect| Kind::of_output(*effect))) {
            let (least, most) = kind.range(0.5);
            assert!((least..=most).contains(&kind.neutral), "{kind:?}");
            assert_eq!(most == 0.5, kind.is_late(), "{kind:?}");
        }
    }
}
