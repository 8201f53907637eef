//! Do clocks drift apart, or does one step? What that leaves resembles much else.

use super::torque_shape::nearest;
use super::{Found, Judgement};
use crate::diagnosis::Unknown;
use crate::rigs::acrobot::candidates::{Attribute, Candidate, Side, place};
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::selection::{Study, ValueStep, steadiness, value_steps};
use crate::statistics::levels::FEW;

/// Where something is left that has no name, the drift of any cut's clock stands for it; elsewhere this cut's own.
pub(super) fn doubt(found: &Found<'_>, so_far: Option<&Unknown>) -> Judgement {
    match so_far {
        Some(_) => found.drift.cloned().into(),
        None => drifting(found.study, found.list, found.runs).into(),
    }
}

/// Clocks that drift apart: by how much the log's, or the image's delay, moves along the runs of these names; or when it steps, and by how much.
pub fn drifting(study: &Study, candidates: &[Candidate], runs: &[String]) -> Option<Unknown> {
    let clock = candidates.iter().position(|candidate| candidate.side == Side::Clock);
    let delay = place(candidates, Attribute::ImageDelay);
    let stamps = [(clock, "timestamps of the plant's log"), (delay, "timestamps of the image")];
    stamps.into_iter().find_map(|(index, signal)| {
        let index = index?;
        let drift = steadiness(&study.last, index, &study.active)?.drift;
        let (rate, clear) = (drift.0, beside(drift, study.tick_drift));
        let told = || Unknown {
            signal: signal.to_owned(),
            depends_on: vec!["time".into()],
            shape: match value_steps(&study.last, index, &study.active) {
                Some(steps) => stepping(&steps, runs),
                None => format!("clocks that drift apart, by some {:.0} ms in a minute", 6e4 * rate),
            },
            nearest: nearest(study, candidates),
            ..Unknown::default()
        };
        (clear.abs() > POLICY.clear).then(told)
    })
}

/// Steps of a clock in words, the first few of them.
fn stepping(steps: &[ValueStep], runs: &[String]) -> String {
    let of = |step: &ValueStep| {
        let run = runs.get(step.run).map_or("", String::as_str);
        format!("by some {:+.0} ms at {:.1} s of {run}", 1e3 * step.by, step.time)
    };
    let told: Vec<String> = steps.iter().take(FEW).map(of).collect();
    let more = steps.len() - told.len();
    let more = if more > 0 { format!(", and in {more} more") } else { String::new() };
    format!("a clock that steps: {}{more}", told.join(", "))
}

/// By how many standard errors a drift (with those that rows give it) is one, where ticks are known to drift by no more than so much.
fn beside((rate, clear): (f64, f64), known: f64) -> f64 {
    if clear == 0.0 { 0.0 } else { rate / (rate / clear).hypot(known) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_steps_are_told_with_their_times_and_runs() {
        let steps = [0, 1, 2, 3].map(|run| ValueStep { run, time: 6.0, by: -0.03 });
        let runs = ["a", "b", "c", "d"].map(str::to_owned);
        assert_eq!(stepping(&steps[1..2], &runs), "a clock that steps: by some -30 ms at 6.0 s of b");
        assert!(stepping(&steps, &runs).ends_with("at 6.0 s of c, and in 1 more"));
    }

    #[test]
    fn law_lines_that_gave_ticks_drift_by_what_they_are_off_by() {
        // 20 standard errors by rows, of a drift of 10 us a second
        let clear = |known: f64| beside((1e-5, 20.0), known);
        assert!((clear(0.0) - 20.0).abs() < 1e-9 && (beside((-1e-5, -20.0), 0.0) + 20.0).abs() < 1e-9);
        assert!(clear(2e-6) > POLICY.clear && clear(2.4e-6) < POLICY.clear);
        assert_eq!(beside((0.0, 0.0), 0.0), 0.0);
    }
}
