//! Simple laws that nobody lists, of a torque or of what an angle reads: what a residual is described by, and what linked states are asked for.

use super::residual::torque::LACKING;
use crate::statistics::levels::{CERTAIN, HALF};
use std::borrow::Cow;

/// A state of the arm with what it is given.
#[derive(Debug, Clone, Copy)]
pub struct Moment {
    /// Place of the run.
    pub run: usize,
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

/// A function of a moment.
type Function = fn(&Moment) -> f64;

/// A law: what it depends on, its form in words, and its value for a size of 1.
#[derive(Debug, Clone)]
pub struct Law {
    /// Names of variables.
    pub depends_on: &'static [&'static str],
    /// For people.
    pub words: Cow<'static, str>,
    value: Function,
    /// That of a law that goes to and fro along an angle.
    wave: Option<Wave>,
}

/// Waves along an angle, or in time: how many a turn or a second, and how high they are.
#[derive(Debug, Clone)]
pub struct Wave {
    times: f64,
    /// Height of cosine and sine, in each run by itself, or in all alike.
    height: Vec<[f64; 2]>,
    /// How many others were tried.
    of: usize,
    along: Function,
}

impl Wave {
    fn at(&self, at: &Moment) -> f64 {
        let along = self.times * (self.along)(at);
        let [cos, sin] = self.height.get(at.run).or(self.height.last()).copied().unwrap_or_default();
        cos * libm::cos(along) + sin * libm::sin(along)
    }
}

impl Law {
    /// Its value: N·m for a torque, rad for a reading.
    pub fn value(&self, at: &Moment) -> f64 {
        self.wave.as_ref().map_or(1.0, |wave| wave.at(at)) * (self.value)(at)
    }

    /// Deviance beyond which the best of as many laws as were tried for it is as unlikely as one law is beyond none, of noise alone: the largest
    /// of many sums of squares (Laurent, Massart, Ann. Statist. 28 (2000) 1302, lemma 1).
    pub fn by_choice(&self) -> f64 {
        self.wave.as_ref().map_or(0.0, |wave| {
            let (sure, squares) = (CERTAIN * CERTAIN, 2.0 * wave.height.len() as f64);
            let unlikely = libm::log(wave.of.max(1) as f64) + HALF * sure;
            squares + 2.0 * (squares * unlikely).sqrt() + 2.0 * unlikely - sure
        })
    }
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

const fn law(depends_on: &'static [&'static str], words: &'static str, value: Function) -> Law {
    Law { depends_on, words: Cow::Borrowed(words), value, wave: None }
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
pub static OF_STATE: [Law; 14] = [
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
pub static OF_COMMAND: [Law; 3] = [
    law(&["tau"], "even in the commanded torque: another gain for each sign", |at| at.tau.abs()),
    law(
        &["tau"],
        "odd in the commanded torque, growing with its square: a gain that is not constant",
        |at| at.tau * at.tau.abs(),
    ),
    law(&["tau"], "of the commanded torque's sign: play, or a dead zone", |at| sign(at.tau)),
];

/// Of what an angle reads: what encoders and shafts do to it.
pub static OF_READINGS: [[Law; 5]; 2] = [
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

/// Laws that go to and fro, how often nobody knows beforehand.
pub struct Periodic {
    /// What they act on.
    pub on: On,
    depends_on: &'static [&'static str],
    /// Along an angle, rad, or time, s.
    pub along: Function,
    /// In time, where each run begins anew.
    pub in_time: bool,
    /// How high waves are.
    pub height: Function,
    /// Along what, for people.
    of: &'static str,
    /// What does so.
    cause: &'static str,
}

impl Periodic {
    /// The law with so many waves a turn or a second and their heights, the best of `of`; `once` is where along an angle the only one is that was seen.
    pub fn law(&self, times: f64, height: Vec<[f64; 2]>, of: usize, once: Option<f64>) -> Law {
        let (words, times) = match (self.in_time, once) {
            (true, _) => {
                (format!("{times:.1} times a second: {}", self.cause), std::f64::consts::TAU * times)
            }
            (false, None) => (format!("{times:.0} times a turn of {}: {}", self.of, self.cause), times),
            (false, Some(place)) => (
                format!("to and fro at one place of {}, about {place:.1} rad, and at no other", self.of),
                times,
            ),
        };
        Law {
            depends_on: self.depends_on,
            words: Cow::Owned(words),
            value: self.height,
            wave: Some(Wave { times, height, of, along: self.along }),
        }
    }
}

/// Along q1, along q2, and along the angle between the links.
const Q1: (&[&str], Function, &str) = (&["q1"], |at| at.state[0], "q1");
const Q2: (&[&str], Function, &str) = (&["q2"], |at| at.state[1], "q2");
const JOINT: (&[&str], Function, &str) = (&["q1", "q2"], Moment::bend, "the joint angle q2 - q1");

const fn along_angle(
    on: On,
    (depends_on, along, of): (&'static [&'static str], Function, &'static str),
    cause: &'static str,
) -> Periodic {
    Periodic { on, depends_on, along, in_time: false, height: |_| 1.0, of, cause }
}

/// What an angle reads, by an encoder that turns with another one, or with itself.
const fn uneven(angle: usize, along: (&'static [&'static str], Function, &'static str)) -> Periodic {
    along_angle(On::Reading(angle), along, "an encoder that is uneven within its lines, or has uneven codes")
}

/// Hum in what an angle reads.
const fn hum(angle: usize) -> Periodic {
    let along: (&[&str], Function, &str) = (&["time"], |at| at.time, "time");
    let cause = "hum of the mains, as it looks in rows so far apart, or a mount that shakes";
    Periodic { in_time: true, ..along_angle(On::Reading(angle), along, cause) }
}

/// Motors, gears, wheels and encoders.
pub static PERIODIC: [Periodic; 8] = [
    along_angle(On::Torque(0), Q1, "a floor or a wheel that isn't even"),
    along_angle(On::Torque(1), JOINT, "cogging, or the teeth of a gear"),
    Periodic {
        depends_on: &["q1", "q2", "tau"],
        height: |at| at.tau,
        ..along_angle(On::Torque(1), JOINT, "in proportion to the commanded torque, a motor's torque ripple")
    },
    uneven(0, Q1),
    uneven(1, JOINT),
    uneven(1, Q2),
    hum(0),
    hum(1),
];

/// All that are written down, each with what it acts on; those of readings only if angles were read by encoders.
pub fn all_laws(readings: bool) -> Vec<(On, Law)> {
    let of_torque =
        (0..LACKING.len()).flat_map(|link| OF_STATE.iter().map(move |law| (On::Torque(link), law)));
    let of_command = OF_COMMAND.iter().map(|law| (On::Torque(LACKING.len() - 1), law));
    let of_reading = OF_READINGS.iter().enumerate().filter(|_| readings);
    let of_reading =
        of_reading.flat_map(|(angle, laws)| laws.iter().map(move |law| (On::Reading(angle), law)));
    of_torque.chain(of_command).chain(of_reading).map(|(on, law)| (on, law.clone())).collect()
}
