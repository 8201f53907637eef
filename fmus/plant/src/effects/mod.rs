//! Effects that the paper's plant lacks: friction, the motor's inertia, the ground, the actuator.
//!
//! One file an effect: its parameters with their neutral values, its equation and where that comes from. One line in
//! the list below brings it into the variables, the checks and the equations. An effect at its neutral value is not
//! computed at all, so that the bits are those of a plant without it.

mod bias;
mod coulomb;
mod delay;
mod gain;
mod lag;
mod rate_limit;
mod rotor;
mod saturation;
mod slope;
mod viscous;

use crate::actuator::{Command, Ended, Memory, Signal, Stage};
use fmi2_export::ModelError;
use mechanics::{Equation, Incline};

/// Where the plant is, as forces see it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Angles, rad.
    pub q: [f64; 2],
    /// Rates, rad/s.
    pub dq: [f64; 2],
}

impl Motion {
    /// Rate of the joint: q̇₂ − q̇₁, rad/s.
    pub fn joint_rate(&self) -> f64 {
        self.dq[1] - self.dq[0]
    }
}

/// An effect on the bodies.
pub trait Mechanical {
    /// Refuses parameters that can't be used.
    fn check(&self) -> Result<(), ModelError>;

    /// Adds to M and f of M·q̈ = f.
    fn act(&self, motion: &Motion, equation: &mut Equation) {
        let _ = (motion, equation);
    }

    /// Kinetic energy that it adds, J.
    fn kinetic_energy(&self, motion: &Motion) -> f64 {
        let _ = motion;
        0.0
    }

    /// The ground and what the rig stands on, if this effect tilts one.
    fn incline(&self) -> Option<Incline> {
        None
    }
}

macro_rules! effects {
    (mechanical { $( $force:ident: $Force:ty, )* } actuator { $( $stage:ident: $Stage:ty, )* }) => {
        fmi2_export::table! {
            /// The parameters of all effects.
            pub struct Effects {
                $( #[doc = concat!("Parameters of the effect `", stringify!($force), "`.")] pub $force: $Force, )*
                $( #[doc = concat!("Parameters of the stage `", stringify!($stage), "`.")] pub $stage: $Stage, )*
            }
        }

        /// How many stages the actuator has.
        const STAGES: usize = 0 $( + { let _ = stringify!($stage); 1 } )*;

        impl Effects {
            /// Refuses parameters that can't be used.
            pub fn check(&self) -> Result<(), ModelError> {
                $( self.$force.check()?; )*
                $( self.$stage.check()?; )*
                Ok(())
            }

            /// Adds all effects on the bodies.
            pub fn act(&self, motion: &Motion, equation: &mut Equation) {
                $( self.$force.act(motion, equation); )*
            }

            /// Kinetic energy that the effects add, J.
            pub fn kinetic_energy(&self, motion: &Motion) -> f64 {
                0.0 $( + self.$force.kinetic_energy(motion) )*
            }

            /// The ground and what the rig stands on; `None` if both are level.
            pub fn incline(&self) -> Option<Incline> {
                let mut ground = None;
                $( ground = ground.or(self.$force.incline()); )*
                ground
            }

            /// What the actuator remembers where a command (N·m) has gone in for ever.
            pub fn settled(&self, command: f64) -> Memory {
                let (mut memory, mut torque) = (Memory::default(), command);
                $( torque = self.$stage.settle(&mut memory, torque); )*
                let _ = torque;
                memory
            }

            /// Lets the stages know of a command from now on.
            pub fn accept(&self, memory: &mut Memory, command: Command) {
                $( self.$stage.accept(memory, command); )*
            }

            /// ∂torque/∂command at once, where a command (N·m) goes in at `now` s.
            pub fn feedthrough(&self, memory: &Memory, now: f64, command: f64) -> f64 {
                let (mut signal, mut by, mut span) = (Signal::constant(command), 1.0, f64::INFINITY);
                $(
                    by *= self.$stage.feedthrough(signal.at(0.0));
                    self.$stage.shape(memory, now, &mut signal, &mut span);
                )*
                let _ = signal;
                // no zero with a sign
                by + 0.0
            }

            /// Sends a torque through the actuator, in the order of the list, from `now` on for at most `span` s.
            pub fn pass(&self, memory: &Memory, now: f64, input: Signal, span: f64) -> Passage {
                let mut passage = Passage { outputs: [input; STAGES], span };
                let mut signal = input;
                let mut place = 0;
                $(
                    self.$stage.shape(memory, now, &mut signal, &mut passage.span);
                    passage.outputs[place] = signal;
                    place += 1;
                )*
                let _ = (signal, place);
                passage
            }

            /// Lets the stages remember where a passage ended; `end` is the time there.
            pub fn remember(&self, memory: &mut Memory, passage: &Passage, end: f64) {
                let mut place = 0;
                $(
                    let ended = Ended { output: &passage.outputs[place], span: passage.span, end };
                    self.$stage.remember(memory, &ended);
                    place += 1;
                )*
                let _ = place;
            }
        }
    };
}

effects! {
    mechanical {
        viscous: viscous::Viscous,
        coulomb: coulomb::Coulomb,
        rotor: rotor::Rotor,
        slope: slope::Slope,
    }
    actuator { // in the order in which the torque passes them
        delay: delay::Delay,
        saturation: saturation::Saturation,
        rate_limit: rate_limit::RateLimit,
        lag: lag::Lag,
        gain: gain::Gain,
        bias: bias::Bias,
    }
}

/// A torque on its way through the actuator, as long as it stays smooth.
#[derive(Debug, Clone, Copy)]
pub struct Passage {
    outputs: [Signal; STAGES],
    /// How long the signals hold, s.
    pub span: f64,
}

impl Passage {
    /// What comes out: the torque on the joint.
    pub fn torque(&self) -> &Signal {
        &self.outputs[STAGES - 1]
    }
}

/// Refuses a value that is negative or not finite.
#[inline]
pub fn non_negative(name: &'static str, value: f64) -> Result<(), ModelError> {
    if value >= 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(refused(name, value, "must be finite and >= 0"))
    }
}

/// Refuses a value that is not finite.
#[inline]
pub fn finite(name: &'static str, value: f64) -> Result<(), ModelError> {
    if value.is_finite() { Ok(()) } else { Err(refused(name, value, "must be finite")) }
}

/// Refuses a value that is not above zero or not finite.
#[inline]
pub fn positive(name: &'static str, value: f64) -> Result<(), ModelError> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(refused(name, value, "must be finite and > 0"))
    }
}

/// Apart, so that looking at all parameters before each step costs next to nothing.
#[cold]
fn refused(name: &'static str, value: f64, expected: &str) -> ModelError {
    ModelError::Value { name, value: value.to_string(), expected: expected.into() }
}
