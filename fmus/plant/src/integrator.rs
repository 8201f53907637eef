//! Integration of the plant from corner to corner of its torque, and the event of contact.
//!
//! Dormand and Prince's embedded Runge-Kutta pair of orders 5 and 4 (J. Comput. Appl. Math. 6, 1980), continued
//! with the fifth-order result. The difference of the two is kept below a tolerance per second of simulated time.
//!
//! Behind a lag that is short beside the stretch, the torque has a transient b·e^(−s/T) that would take many short steps. What
//! it alone does is taken in closed form: with a = M(q₀)⁻¹b the integrator follows z = q − aT²e^(−s/T) and
//! y = q̇ + aTe^(−s/T) = ż, for which ẏ = q̈ − ae^(−s/T) has the transient only as far as M has changed since.
//!
//! Error of the result at [`TOLERANCE`]: below 1e-10 rad and rad/s after a second, whatever the communication step. Against scipy's
//! DOP853 at rtol 1e-13 (tests/value.rs) the largest seen is 5e-11, over ten full swings with each effect; the energy
//! of a free swing stays within 1e-10 of itself over 10 s.

use crate::actuator::Signal;
use crate::dynamics::Dynamics;
use crate::effects::Motion;
use fmi2_export::ModelError;
use mechanics::Equation;

/// Largest estimated error per second, in rad and rad/s, relative to values above 1. The estimate belongs to the
/// fourth-order result; the fifth-order one that is kept is 20 times better or more.
pub const TOLERANCE: f64 = 1e-9;
/// Below this, estimates are rounding.
pub const TIGHTEST: f64 = 1e-13;
/// Beyond this, errors would be seen.
pub const LOOSEST: f64 = 1e-3;
/// The longest step that is ever tried, s: well below the plant's time constants.
pub const LONGEST_STEP: f64 = 0.05;
/// Steps below this are a sign that the equations can't be integrated, s.
const SHORTEST_STEP: f64 = 1e-13;
/// Steps that a stretch may take, beside [`MOST_STEPS_PER_SECOND`]: far above what any body needs, so that absurd
/// torques end with an error rather than never.
const MOST_STEPS: f64 = 2e4;
/// Steps that a second may take; Coulomb friction of 50 N·m needs fewer.
const MOST_STEPS_PER_SECOND: f64 = 1e6;
/// A lag is short beside a stretch that is longer than so many of its time constants.
const SHORT_LAG: f64 = 1.0;
/// Halvings of a step in search of an instant: from [`LONGEST_STEP`] to below 1e-15 s.
const HALVINGS: u32 = 46;
/// Pieces of a step that are looked at for a turn of link 2: rates that change sign twice within a step, or begin at rest, don't
/// show at its ends.
const PIECES: u32 = 8;

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
    /// Largest estimated error per second.
    pub tolerance: f64,
}

impl Stretch<'_> {
    /// Integrates the state over the stretch. `next_step` carries the step size from stretch to stretch.
    pub fn integrate(&self, state: &mut State, next_step: &mut f64) -> Result<End, ModelError> {
        Course { stretch: self, transient: self.transient(state) }.run(state, next_step)
    }

    fn equation(&self, at: f64, [q1, q2, dq1, dq2]: State, torque: f64) -> Equation {
        self.dynamics.equation(&Motion { q: [q1, q2], dq: [dq1, dq2] }, torque, self.offset + at)
    }

    /// What the torque's transient does from a state on, if it is short beside the stretch.
    fn transient(&self, state: &State) -> Option<Transient> {
        let torque = self.torque;
        if torque.transient == 0.0 || torque.decay * self.span < SHORT_LAG {
            return None;
        }
        let mut alone = Equation { f1: 0.0, f2: 0.0, ..self.equation(0.0, *state, 0.0) };
        alone.add_joint_torque(torque.transient);
        Some(Transient { a: alone.accelerations(), lag: 1.0 / torque.decay })
    }
}

/// What a torque b·e^(−s/T) alone does to links that move little meanwhile.
struct Transient {
    /// M⁻¹b, rad/s²
    a: [f64; 2],
    /// T, s
    lag: f64,
}

impl Transient {
    /// A state with what it did (`sign` 1), or without it (−1); `fading` is e^(−s/T).
    fn moved(&self, state: &State, sign: f64, fading: f64) -> State {
        let [q1, q2, dq1, dq2] = *state;
        let rate = sign * self.lag * fading;
        let angle = rate * self.lag;
        let [a1, a2] = self.a;
        [q1 + angle * a1, q2 + angle * a2, dq1 - rate * a1, dq2 - rate * a2]
    }
}

/// A stretch on its way: its states are z and y where there is a transient, else q and q̇.
struct Course<'a> {
    stretch: &'a Stretch<'a>,
    transient: Option<Transient>,
}

impl Course<'_> {
    /// Angles and rates of one of its states.
    fn seen(&self, at: f64, state: &State) -> State {
        let fading = |transient: &Transient| libm::exp(-at / transient.lag);
        self.transient.as_ref().map_or(*state, |transient| transient.moved(state, 1.0, fading(transient)))
    }

    fn derivative(&self, at: f64, state: &State) -> State {
        let torque = self.stretch.torque;
        let Some(transient) = &self.transient else {
            let [ddq1, ddq2] = self.stretch.equation(at, *state, torque.at(at)).accelerations();
            return [state[2], state[3], ddq1, ddq2];
        };
        let fading = libm::exp(-at / transient.lag);
        let torque = torque.line(at) + torque.transient * fading;
        let seen = transient.moved(state, 1.0, fading);
        let [ddq1, ddq2] = self.stretch.equation(at, seen, torque).accelerations();
        let [a1, a2] = transient.a;
        [state[2], state[3], ddq1 - a1 * fading, ddq2 - a2 * fading]
    }

    fn run(&self, seen: &mut State, next_step: &mut f64) -> Result<End, ModelError> {
        let span = self.stretch.span;
        let mut at = 0.0;
        let mut now = self.transient.as_ref().map_or(*seen, |transient| transient.moved(seen, -1.0, 1.0));
        let state = &mut now;
        let mut slope = self.derivative(at, state);
        let mut steps_left = MOST_STEPS + MOST_STEPS_PER_SECOND * span;
        while at < span {
            steps_left -= 1.0;
            let left = span - at;
            // Equal steps to the end rather than a long one and a crumb.
            let step = left / (left / next_step.max(SHORTEST_STEP)).ceil().max(1.0);
            let trial = self.trial(at, state, &slope, step);
            let is_exact = trial.error <= 1.0; // not for NaN
            if is_exact {
                if let Some(instant) = self.contact(at, state, &slope, step, &trial) {
                    let there = self.trial(at, state, &slope, instant).state;
                    *seen = self.seen(at + instant, &there);
                    return Ok(End::Contact(at + instant));
                }
                at = if step == left { span } else { at + step };
                *state = trial.state;
                slope = trial.slope;
            }
            if (!is_exact && step < SHORTEST_STEP) || steps_left < 0.0 {
                return Err(self.stuck(at, state, step));
            }
            *next_step = next(trial.error, step, *next_step);
        }
        *seen = self.seen(at, state);
        let [a1, a2] = self.transient.as_ref().map_or([0.0; 2], |transient| {
            let fading = libm::exp(-at / transient.lag);
            transient.a.map(|a| a * fading)
        });
        Ok(End::Reached([slope[2] + a1, slope[3] + a2]))
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
            let share = estimate[i].abs() / (self.stretch.tolerance * state[i].abs().max(1.0));
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
        let after = |step: f64| self.seen(at + step, &self.trial(at, state, slope, step).state);
        let beyond = |q2: f64| q2.abs() >= self.stretch.contact_angle;
        let mut high = step;
        let (begin, end) = (self.seen(at, state), self.seen(at + step, &trial.state));
        if !beyond(end[1]) {
            // There and back within one step: only if it can get there at all.
            let fastest =
                slope[3].abs() + self.transient.as_ref().map_or(0.0, |transient| transient.a[1].abs());
            let reach = begin[1].abs() + step * (begin[3].abs().max(end[3].abs()) + step * fastest);
            if reach < self.stretch.contact_angle {
                return None;
            }
            high = turns(&after, begin, end, step).find(|instant| beyond(after(*instant)[1]))?;
        }
        let mut low = 0.0;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if beyond(after(middle)[1]) { high = middle } else { low = middle }
        }
        Some(high)
    }

    /// Why no step succeeds.
    fn stuck(&self, at: f64, state: &State, step: f64) -> ModelError {
        let [q1, q2, dq1, dq2] = self.seen(at, state);
        let torque = self.stretch.torque.at(at);
        let equation = self.stretch.equation(at, [q1, q2, dq1, dq2], torque);
        ModelError::Failed(format!(
            "the state can't be integrated further than q1 = {q1} rad, q2 = {q2} rad, dq1 = {dq1} rad/s, dq2 = {dq2} \
             rad/s under tau_applied = {torque} N.m: too many steps, or too short ones, the last of {step} s. M11 = {} kg.m2 \
             and det M = {} kg2.m4 there; if they are not well above 0, theta_1, theta_2, theta_5, theta_7, theta_8 \
             belong to no body",
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

/// When q̇₂ changes sign within a step: by halving in each of its pieces at whose ends the signs differ, or which begins at
/// rest. `after` gives the state some time after the step's beginning.
fn turns(after: impl Fn(f64) -> State, begin: State, end: State, step: f64) -> impl Iterator<Item = f64> {
    let mut before = begin[3];
    (1..=PIECES).filter_map(move |piece| {
        let length = step / f64::from(PIECES);
        let mut high = if piece == PIECES { step } else { f64::from(piece) * length };
        let mut low = f64::from(piece - 1) * length;
        let rate = if piece == PIECES { end[3] } else { after(high)[3] };
        let turned = before * rate <= 0.0;
        before = rate;
        for _ in 0..if turned { HALVINGS } else { 0 } {
            let middle = 0.5 * (low + high);
            if after(middle)[3] * rate > 0.0 { high = middle } else { low = middle }
        }
        turned.then_some(high)
    })
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
