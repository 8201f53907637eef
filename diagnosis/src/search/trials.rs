//! The values of a parameter at which its effect is screened.

use super::policy::SEARCHING;
use crate::dynamics::linearise::{Chord, Engine};
use crate::dynamics::machine::Role;
use crate::observe::Scale;
use crate::ports::{Kind, Measure};
use crate::statistics::levels::SEVERAL;
use crate::statistics::median::median;

/// Chords of one parameter at its present value.
pub fn trials(engine: &Engine, theta: &[f64], parameter: usize) -> Vec<Chord> {
    let described = &engine.machine.parameters[parameter];
    let here = theta[parameter];
    let (least, most) = described.range;
    let whole = |to: f64| Chord { parameter, to, per: 1.0 };
    let fits = |to: &f64| *to >= least && *to <= most && *to != here;
    match described.scale {
        Scale::Switch => vec![whole(if here > 0.5 { 0.0 } else { 1.0 })],
        Scale::Count => [-1.0, 1.0, 2.0, 3.0].iter().map(|by| here + by).filter(fits).map(whole).collect(),
        Scale::Saturation if here == 0.0 => {
            limits(engine, parameter).into_iter().filter(fits).map(whole).collect()
        }
        _ => {
            let local = engine.local(theta, parameter);
            let late = match described.role {
                Role::Input(_, effect) => Kind::of_input(effect).is_late(),
                Role::Output(_, effect) => Kind::of_output(effect).is_late(),
                _ => false,
            };
            let rows = if late && here == 0.0 { &SEARCHING.late[..] } else { &[] };
            let chords = rows.iter().map(|rows| rows * interval(engine)).filter(fits).map(whole);
            std::iter::once(local).chain(chords).collect()
        }
    }
}

/// Usual distance of rows, s.
pub fn interval(engine: &Engine) -> f64 {
    let (span, rows) =
        engine.grids.iter().fold((0.0, 0), |(s, r), grid| (s + grid.span(), r + grid.time.len() - 1));
    span / rows.max(1) as f64
}

/// Limits of an input's rate that spread its largest jump over rows, down to what it moves by in half of the rows in which it moves: a
/// command that moves in every row is cut far below its largest jump.
fn ramps(engine: &Engine, input: usize, jump: f64) -> Vec<f64> {
    let row = interval(engine);
    let mut ramps: Vec<f64> = SEARCHING.ramps.iter().map(|rows| jump / (rows * row)).collect();
    let steps = engine.grids.iter().flat_map(|grid| grid.inputs[input].values.windows(2));
    let moves: Vec<f64> = steps.map(|pair| (pair[1] - pair[0]).abs()).filter(|by| *by > 0.0).collect();
    let (Some(usual), Some(&last)) = (median(moves.iter().copied()), ramps.last()) else { return ramps };
    let lower = std::iter::successors(Some(last / SEVERAL), |rate| Some(rate / SEVERAL));
    ramps.extend(lower.take_while(|rate| *rate * row > usual));
    ramps
}

fn limits(engine: &Engine, parameter: usize) -> Vec<f64> {
    let described = &engine.machine.parameters[parameter];
    let largest = |input: usize| {
        let all = engine.grids.iter().flat_map(|grid| grid.inputs[input].values.iter());
        all.fold(0.0, |most: f64, value| most.max(value.abs()))
    };
    let jump = |input: usize| {
        let pairs = engine.grids.iter().flat_map(|grid| grid.inputs[input].values.windows(2));
        pairs.fold(0.0, |most: f64, pair| most.max((pair[1] - pair[0]).abs()))
    };
    match described.role {
        Role::Input(input, effect) => match Kind::of_input(effect).measure {
            Measure::VariablePerSecond => ramps(engine, input, jump(input)),
            Measure::Number | Measure::Variable | Measure::Seconds => {
                SEARCHING.limits.iter().map(|share| share * largest(input)).collect()
            }
        },
        _ => {
            let (least, most) = described.range;
            if most.is_finite() && most > 0.0 {
                return SEARCHING
                    .limits
                    .iter()
                    .map(|share| least.max(0.0) + share * (most - least.max(0.0)))
                    .collect();
            }
            let inputs = 0..engine.machine.inputs.len();
            inputs
                .flat_map(|input| SEARCHING.limits.iter().step_by(2).map(move |share| share * largest(input)))
                .collect()
        }
    }
    .into_iter()
    .filter(|limit| *limit > 0.0)
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::tests::{ROW, built, pendulum, place};

    /// Whether from each of these places one that is tried is within a factor.
    fn reach(tried: &[f64], wanted: &[f64], factor: f64) -> bool {
        let near = |wanted: &f64| tried.iter().any(|one| (one / wanted).max(wanted / one) < factor);
        wanted.iter().all(near)
    }

    #[test]
    fn law_an_effect_is_tried_near_to_wherever_it_may_be() {
        let problem = pendulum("tried", 600);
        let built = built(&problem);
        let (engine, theta) = (&built.engine, built.engine.machine.neutral());
        // without the one that is a derivative
        let tried = |name: &str| -> Vec<f64> {
            let all = trials(engine, &theta, place(&built, name));
            all.iter().filter(|chord| chord.per == 1.0).map(|chord| chord.to).collect()
        };
        // a delay of one row to one of thirty, a chord to less than twice or more than half of it: steeper than half the slope
        for late in ["tau:delay", "tau:lag", "q1:delay", "q1:lag"] {
            let rows: Vec<f64> = tried(late).iter().map(|to| to / ROW).collect();
            assert!(reach(&rows, &[1.2, 2.0, 3.0, 5.0, 8.0, 12.0, 20.0, 28.0], 2.01), "{late}: {rows:?}");
            assert!(
                rows.iter().all(|rows| (1.0..30.0).contains(rows)),
                "less follows from the derivative: {rows:?}"
            );
        }
        let tau = &engine.grids[0].inputs[0].values;
        let largest = tau.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        let limits: Vec<f64> = tried("tau:saturation").iter().map(|limit| limit / largest).collect();
        // a limit that is reached seldom cuts little: those near the top are nearest to each other
        assert!(reach(&limits, &[0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95], 1.35), "{limits:?}");
        assert!(limits.iter().all(|limit| *limit < 0.99), "one that is not reached says nothing: {limits:?}");
        let jump = tau.windows(2).fold(0.0, |most: f64, pair| most.max((pair[1] - pair[0]).abs()));
        let ramps: Vec<f64> = tried("tau:rate_limit").iter().map(|rate| jump / (rate * ROW)).collect();
        // rows over which the largest jump is spread
        assert!(reach(&ramps, &[1.2, 2.0, 3.0, 5.0, 8.0, 12.0, 20.0, 36.0], 2.01), "{ramps:?}");
        assert!(ramps.iter().all(|rows| (1.0..40.0).contains(rows)), "{ramps:?}");
    }
}
