//! Simple laws that nobody lists, of a torque or of what an angle reads: what a residual is described by, and what linked states are asked for.

use super::residual::torque::LACKING;

/// A state of the arm with what it is given.
#[derive(Debug, Clone, Copy)]
pub struct Moment {
    /// q1, q2, dq1, dq2, rad and rad/s.
    pub state: [f64; 4],
    /// Time, s.
    pub time: f64,
    /// Commanded torque at the joint, N·m.
    pub tau: f64,
}

impl Moment {
    /// Joint angle, rad.
    fn bend(&self) -> f64 {
        self.state[1] - self.state[0]
    }

    /// Rate of the joint, rad/s.
    fn slip(&self) -> f64 {
        self.state[3] - self.state[2]
    }
}

/// A law: what it depends on, its form in words, and its value for a size of 1.
pub struct Law {
    /// Names of variables.
    pub depends_on: &'static [&'static str],
    /// For people.
    pub words: &'static str,
    /// In N·m for a torque, in rad for a reading.
    pub value: fn(&Moment) -> f64,
}

/// What a law acts on: the first link or the joint, by its torque or by what its angle reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum On {
    Torque(usize),
    Reading(usize),
}

impl On {
    /// The signal that is off.
    pub fn signal(self) -> &'static str {
        match self {
            Self::Torque(link) => LACKING[link],
            Self::Reading(angle) => ANGLES_OF_LOG[angle],
        }
    }
}

/// The angles that a log of encoders holds.
pub const ANGLES_OF_LOG: [&str; 2] = ["plant.q1", "plant.q2"];

const fn law(depends_on: &'static [&'static str], words: &'static str, value: fn(&Moment) -> f64) -> Law {
    Law { depends_on, words, value }
}

/// The sign of a rate, smoothed where dry friction is, over 0.05 rad/s.
fn sign(rate: f64) -> f64 {
    libm::tanh(rate / 0.05)
}

/// The square of a rate, with its sign.
fn drag(rate: f64) -> f64 {
    rate * rate.abs()
}

/// Dry friction that falls off where a rate grows beyond 0.2 rad/s.
fn slow(rate: f64) -> f64 {
    sign(rate) / (1.0 + rate * rate / 0.04)
}

/// Of the state and of time.
pub const OF_STATE: [Law; 14] = [
    law(&[], "constant", |_| 1.0),
    law(&["time"], "drifting with time", |at| at.time),
    law(&["q1"], "odd in q1, like a spring", |at| at.state[0]),
    law(&["q2"], "odd in q2, like a spring", |at| at.state[1]),
    law(&["q1", "q2"], "odd in the joint angle q2 - q1, like a spring", Moment::bend),
    law(&["q1", "q2"], "cubic in the joint angle q2 - q1, like a stiffening spring", |at| {
        at.bend() * at.bend() * at.bend()
    }),
    law(&["q2"], "even in q2", |at| at.state[1] * at.state[1]),
    law(&["dq1"], "odd in dq1, growing with speed", |at| at.state[2]),
    law(&["dq1", "dq2"], "odd in the joint's rate dq2 - dq1, growing with speed", Moment::slip),
    law(&["dq1"], "odd in dq1, of constant size: sticking", |at| sign(at.state[2])),
    law(&["dq1", "dq2"], "odd in the joint's rate dq2 - dq1, of constant size: sticking or play", |at| {
        sign(at.slip())
    }),
    law(&["dq1"], "odd in dq1, with the square of speed: drag", |at| drag(at.state[2])),
    law(&["dq1", "dq2"], "odd in the joint's rate, with the square of speed: drag", |at| drag(at.slip())),
    law(&["dq1", "dq2"], "strongest at small rates of the joint: Stribeck or sticking", |at| slow(at.slip())),
];

/// Of the commanded torque: what a motor's driver or a gear does to it.
pub const OF_COMMAND: [Law; 3] = [
    law(&["tau"], "even in the commanded torque: another gain for each sign", |at| at.tau.abs()),
    law(
        &["tau"],
        "odd in the commanded torque, growing with its square: a gain that is not constant",
        |at| at.tau * at.tau.abs(),
    ),
    law(&["tau"], "of the commanded torque's sign: play, or a dead zone", |at| sign(at.tau)),
];

/// Of what an angle reads: what encoders and shafts do to it.
pub const OF_READINGS: [[Law; 5]; 2] = [
    [
        law(&["tau"], "with the commanded torque: something bends", |at| at.tau),
        law(&["time"], "drifting with time: a coupling that slips", |at| at.time),
        law(&["q1"], "in proportion to itself, as by an encoder's scale", |at| at.state[0]),
        law(&["q1"], "once a turn, as by a disc that sits off its centre", |at| libm::sin(at.state[0])),
        law(&["q1"], "even in itself, as by a disc that sits off its centre", |at| libm::cos(at.state[0])),
    ],
    [
        law(&["tau"], "with the commanded torque: something bends", |at| at.tau),
        law(&["time"], "drifting with time: a coupling that slips", |at| at.time),
        law(&["q2"], "in proportion to itself, as by an encoder's scale", |at| at.state[1]),
        law(&["q2"], "once a turn, as by a disc that sits off its centre", |at| libm::sin(at.state[1])),
        law(&["q2"], "even in itself, as by a disc that sits off its centre", |at| libm::cos(at.state[1])),
    ],
];

/// All, each with what it acts on; those of readings only if angles were read by encoders.
pub fn all_laws(readings: bool) -> Vec<(On, &'static Law)> {
    let of_torque =
        (0..LACKING.len()).flat_map(|link| OF_STATE.iter().map(move |law| (On::Torque(link), law)));
    let of_command = OF_COMMAND.iter().map(|law| (On::Torque(LACKING.len() - 1), law));
    let of_reading = OF_READINGS.iter().enumerate().filter(|_| readings);
    let of_reading =
        of_reading.flat_map(|(angle, laws)| laws.iter().map(move |law| (On::Reading(angle), law)));
    of_torque.chain(of_command).chain(of_reading).collect()
}
