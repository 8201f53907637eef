//! Integration of the plant from corner to corner of its torque, and the event of contact.
//!
//! Dormand and Prince's embedded Runge-Kutta pair of orders 5 and 4 (J. Comput. Appl. Math. 6, 1980), continued
//! with the fifth-order result. The difference of the two is kept below [`TOLERANCE`] per second of simulated time.
//!
//! Error of the result: below 1e-10 rad and rad/s after a second, whatever the communication step. Against scipy's
//! DOP853 at rtol 1e-13 (tests/value.rs) the largest seen is 5e-11, over ten full swings with each effect; the energy
//! of a free swing stays within 1e-10 of itself over 10 s.

use crate::actuator::Signal;
use crate::dynamics::Dynamics;
use crate::effects::Motion;
use fmi2_export::ModelError;

/// Largest estimated error per second, in rad and rad/s, relative to values above 1. The estimate belongs to the
/// fourth-order result; the fifth-order one that is kept is 20 times better or more.
pub const TOLERANCE: f64 = 1e-9;
/// The longest step that is ever tried, s: well below the plant's time constants.
pub const LONGEST_STEP: f64 = 0.05;
/// Steps below this are a sign that the equations can't be integrated, s.
const SHORTEST_STEP: f64 = 1e-13;
/// Steps that a stretch may take, beside [`MOST_STEPS_PER_SECOND`]: far above what any body needs, so that absurd
/// torques end with an error rather than never.
const MOST_STEPS: f64 = 2e4;
/// Steps that a second may take; Coulomb friction of 50 N·m needs fewer.
const MOST_STEPS_PER_SECOND: f64 = 1e6;
/// Halvings of a step in search of an instant: from [`LONGEST_STEP`] to below 1e-15 s.
const HALVINGS: u32 = 46;

/// Where within the step the stages after the first lie.
const NODES: [f64; 6] = [1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0];
/// What each of them takes of the stages before it; the last row is the fifth-order result.
const WEIGHTS: [[f64; 6]; 6] = [
    [1.0 / 5.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
/// The fifth-order result less the fourth-order one, over the step.
const DIFFERENCE: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0];

/// q₁, q₂, q̇₁, q̇₂.
pub type State = [f64; 4];

/// How a stretch ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum End {
    /// At its end, with the accelerations there.
    Reached([f64; 2]),
    /// The links touched after so many seconds.
    Contact(f64),
}

/// A stretch of time over which the torque is smooth.
pub struct Stretch<'a> {
    /// The equations.
    pub dynamics: &'a Dynamics<'a>,
    /// Torque between the links.
    pub torque: &'a Signal,
    /// Where the stretch begins within the communication step, s.
    pub offset: f64,
    /// Its length, s.
    pub span: f64,
    /// abs(q₂) at which the links touch, rad.
    pub contact_angle: f64,
}

impl Stretch<'_> {
    fn derivative(&self, at: f64, state: &State) -> State {
        let [q1, q2, dq1, dq2] = *state;
        let motion = Motion { q: [q1, q2], dq: [dq1, dq2] };
        let equation = self.dynamics.equation(&motion, self.torque.at(at), self.offset + at);
        let [ddq1, ddq2] = equation.accelerations();
        [dq1, dq2, ddq1, ddq2]
    }

    /// Integrates the state over the stretch. `next_step` carries the step size from stretch to stretch.
    pub fn integrate(&self, state: &mut State, next_step: &mut f64) -> Result<End, ModelError> {
        let mut at = 0.0;
        let mut slope = self.derivative(at, state);
        let mut steps_left = MOST_STEPS + MOST_STEPS_PER_SECOND * self.span;
        while at < self.span {
            steps_left -= 1.0;
            let left = self.span - at;
            // Equal steps to the end rather than a long one and a crumb.
            let step = left / (left / next_step.max(SHORTEST_STEP)).ceil().max(1.0);
            let trial = self.trial(at, state, &slope, step);
            let is_exact = trial.error <= 1.0; // not for NaN
            if is_exact {
                if let Some(instant) = self.contact(at, state, &slope, step, &trial) {
                    *state = self.trial(at, state, &slope, instant).state;
                    return Ok(End::Contact(at + instant));
                }
                at = if step == left { self.span } else { at + step };
                *state = trial.state;
                slope = trial.slope;
            }
            if (!is_exact && step < SHORTEST_STEP) || steps_left < 0.0 {
                return Err(self.stuck(at, state, step));
            }
            *next_step = next(trial.error, step, *next_step);
        }
        Ok(End::Reached([slope[2], slope[3]]))
    }

    /// One step of the pair. The last stage lies at the fifth-order result and begins the next step.
    fn trial(&self, at: f64, state: &State, first: &State, step: f64) -> Trial {
        let mut k = [*first; 7];
        let mut moved = *state;
        for stage in 0..6 {
            let slope = combined(&WEIGHTS[stage][..=stage], &k);
            moved = std::array::from_fn(|i| state[i] + step * slope[i]);
            k[stage + 1] = self.derivative(at + NODES[stage] * step, &moved);
        }
        let estimate = combined(&DIFFERENCE, &k);
        let mut error: f64 = 0.0;
        for i in 0..4 {
            let share = estimate[i].abs() / (TOLERANCE * state[i].abs().max(1.0));
            // f64::max would lose a NaN.
            if share > error || share.is_nan() {
                error = share;
            }
        }
        Trial { state: moved, slope: k[6], error }
    }

    /// When the links touch within a step, s after its beginning: the root of abs(q₂) − q₂max on the integrator's
    /// own solution, by halving the step.
    fn contact(&self, at: f64, state: &State, slope: &State, step: f64, trial: &Trial) -> Option<f64> {
        let q2_after = |step: f64| self.trial(at, state, slope, step).state[1];
        let beyond = |q2: f64| q2.abs() >= self.contact_angle;
        let mut high = step;
        if !beyond(trial.state[1]) {
            // There and back within one step: only where q₂ turns, and only if it can get there at all.
            let turns = state[3] * trial.state[3] < 0.0;
            let reach =
                state[1].abs() + step * (state[3].abs().max(trial.state[3].abs()) + step * slope[3].abs());
            if !turns || reach < self.contact_angle {
                return None;
            }
            high = self.turning(at, state, slope, step);
            if !beyond(q2_after(high)) {
                return None;
            }
        }
        let mut low = 0.0;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if beyond(q2_after(middle)) { high = middle } else { low = middle }
        }
        Some(high)
    }

    /// When q̇₂ changes sign within a step.
    fn turning(&self, at: f64, state: &State, slope: &State, step: f64) -> f64 {
        let (mut low, mut high) = (0.0, step);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            let turned = self.trial(at, state, slope, middle).state[3] * state[3] <= 0.0;
            if turned { high = middle } else { low = middle }
        }
        high
    }

    /// Why no step succeeds.
    fn stuck(&self, at: f64, state: &State, step: f64) -> ModelError {
        let [q1, q2, dq1, dq2] = *state;
        let motion = Motion { q: [q1, q2], dq: [dq1, dq2] };
        let equation = self.dynamics.equation(&motion, self.torque.at(at), self.offset + at);
        ModelError::Failed(format!(
            "the state can't be integrated further than q1 = {q1} rad, q2 = {q2} rad, dq1 = {dq1} rad/s, dq2 = {dq2} \
             rad/s under tau_applied = {} N.m: too many steps, or too short ones, the last of {step} s. M11 = {} kg.m2 \
             and det M = {} kg2.m4 there; if they are not well above 0, theta_1, theta_2, theta_5, theta_7, theta_8 \
             belong to no body",
            self.torque.at(at),
            equation.m11,
            equation.determinant()
        ))
    }
}

/// A weighted sum of slopes, all four components at once.
#[inline(always)]
fn combined(weights: &[f64], slopes: &[State; 7]) -> State {
    let mut sum = [0.0; 4];
    for (weight, slope) in weights.iter().zip(slopes) {
        for i in 0..4 {
            sum[i] += weight * slope[i];
        }
    }
    sum
}

struct Trial {
    state: State,
    /// The derivative at the end: the first of the next step.
    slope: State,
    /// Estimated error over the tolerated one.
    error: f64,
}

/// The step size to try next.
fn next(error: f64, step: f64, last_wanted: f64) -> f64 {
    if !error.is_finite() {
        return 0.2 * step;
    }
    let factor = (0.9 / error.sqrt().sqrt()).clamp(0.2, 5.0);
    // A step that was cut to fit says nothing against a longer one.
    let wanted = if factor < 1.0 { factor * step } else { (factor * step).max(last_wanted) };
    wanted.min(LONGEST_STEP)
}
