//! What happens to a value between the output and the log: y = gain · h(t - delay) + offset + drift · (t - t₀).

use crate::observe::OutputEffect;

/// The effects at one output, each at a value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effects {
    /// Factor.
    pub gain: f64,
    /// Summand.
    pub offset: f64,
    /// s.
    pub delay: f64,
    /// s.
    pub lag: f64,
    /// Per s.
    pub drift: f64,
}

impl Effects {
    /// None.
    pub const OFF: Self = Self { gain: 1.0, offset: 0.0, delay: 0.0, lag: 0.0, drift: 0.0 };

    /// What the log shows more of a value (in the variable's own unit, so long after the run's begin, s) for each unit of one effect. Of a
    /// delay or lag it is `late`, what the value itself changes by with it.
    pub fn sensitivity(&self, effect: OutputEffect, value: f64, since: f64, late: f64) -> f64 {
        match effect {
            OutputEffect::Gain => value,
            OutputEffect::Offset => 1.0,
            OutputEffect::Drift => since,
            OutputEffect::Delay | OutputEffect::Lag => self.gain * late,
        }
    }

    /// What the log shows of a value, so long after the run's begin.
    pub fn shown(&self, value: f64, since: f64) -> f64 {
        self.gain * value + self.offset + self.drift * since
    }
}

#[cfg(test)]
mod tests {
    use super::Effects;
    use crate::observe::OutputEffect;

    #[test]
    fn law_a_sensitivity_is_what_a_small_change_does() {
        let at = Effects { gain: 1.5, offset: 0.25, drift: 0.125, ..Effects::OFF };
        // a delay of 1 s takes 4 away from a value that climbs by 4 a second
        let (value, since, late, step) = (3.0, 2.0, -4.0, 0.5);
        let shown = |effects: Effects, value: f64| effects.shown(value, since);
        for effect in OutputEffect::ALL {
            let there = match effect {
                OutputEffect::Gain => shown(Effects { gain: at.gain + step, ..at }, value),
                OutputEffect::Offset => shown(Effects { offset: at.offset + step, ..at }, value),
                OutputEffect::Drift => shown(Effects { drift: at.drift + step, ..at }, value),
                OutputEffect::Delay | OutputEffect::Lag => shown(at, value + late * step),
            };
            // all are linear, and these doubles exact
            let by = (there - shown(at, value)) / step;
            assert_eq!(at.sensitivity(*effect, value, since, late), by, "{effect:?}");
        }
    }
}
