//! `[[connections]]`: what goes where, and what happens to it on the way.

use super::raw::Text;
use crate::error::{Error, Place};
use crate::suggest::nearest;
use crate::time::Rational;
use serde::Deserialize;
use toml::Spanned;

/// `[[connections]]`
#[derive(Debug, Clone)]
pub struct ConnectionEntry {
    /// `unit.variable` of an output.
    pub from: String,
    /// `unit.variable` of an input.
    pub to: String,
    /// Latency in s.
    pub delay: Rational,
    /// What else happens on the way.
    pub channel: Channel,
    /// What becomes of the value.
    pub transform: Transform,
    /// For Integers, Booleans and enumerations: what becomes of single values, as pairs; others pass as they are.
    pub map: Vec<(toml::Value, toml::Value)>,
    /// Where the entry begins.
    pub place: Place,
}

/// What happens to values on their way, beside the latency.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Standard deviation of the latency in s.
    pub jitter: Rational,
    /// Share of samples that are lost.
    pub drop: f64,
    /// What the input is between samples.
    pub hold: Hold,
    /// Of jitter and loss; the scenario's own if none.
    pub seed: Option<u64>,
}

impl Default for Channel {
    fn default() -> Self {
        Self { jitter: Rational::ZERO, drop: 0.0, hold: Hold::Zero, seed: None }
    }
}

/// What becomes of a connected value: input = gain · value + bias, where the value is first converted to the input's
/// physical unit, unless `convert_units` is false.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transform {
    /// Times the value.
    pub gain: f64,
    /// Added then.
    pub bias: f64,
    /// By the units that both descriptions give.
    pub convert_units: bool,
}

impl Default for Transform {
    fn default() -> Self {
        Self { gain: 1.0, bias: 0.0, convert_units: true }
    }
}

impl Channel {
    /// Chance plays a part.
    pub fn is_random(&self) -> bool {
        self.jitter.is_positive() || self.drop > 0.0
    }
}

impl ConnectionEntry {
    /// A value is there as soon as it was sent, so that both ends are equal at the start, too.
    pub fn is_direct(&self) -> bool {
        !self.delay.is_positive() && !self.channel.is_random()
    }
}

/// What an input is between the samples that arrive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hold {
    /// The newest one.
    Zero,
    /// On the line through the newest two.
    Linear,
}

const HOLDS: [(&str, Hold); 2] = [("zero", Hold::Zero), ("linear", Hold::Linear)];

impl Hold {
    /// As the file has it.
    pub fn name(self) -> &'static str {
        HOLDS.iter().find(|(_, hold)| *hold == self).map_or("zero", |(name, _)| name)
    }
}

/// As it stands in the file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Connection {
    from: String,
    to: String,
    latency: Option<Spanned<toml::Value>>,
    delay: Option<Spanned<toml::Value>>,
    jitter: Option<Spanned<toml::Value>>,
    drop: Option<Spanned<toml::Value>>,
    hold: Option<Spanned<String>>,
    seed: Option<Spanned<i64>>,
    gain: Option<Spanned<f64>>,
    bias: Option<Spanned<f64>>,
    convert_units: Option<bool>,
    map: Option<Spanned<Vec<Vec<toml::Value>>>>,
}

pub(super) fn read(at: &Text, entry: Spanned<Connection>) -> Result<ConnectionEntry, Error> {
    let place = at.place(entry.span());
    let Connection { from, to, latency, delay, jitter, drop, hold, seed, gain, bias, convert_units, map } =
        entry.into_inner();
    if let (Some(_), Some(delay)) = (&latency, &delay) {
        let expected = "it is the old name of latency; keep one of them";
        return Err(at.wrong(delay.span(), "delay beside latency", expected));
    }
    let time = |key: &str, value: Option<&Spanned<toml::Value>>| {
        value.map_or(Ok(Rational::ZERO), |value| at.positive(key, value, true))
    };
    let channel = Channel {
        jitter: time("jitter", jitter.as_ref())?,
        drop: drop.as_ref().map_or(Ok(0.0), |drop| share(at, drop))?,
        hold: hold.as_ref().map_or(Ok(Hold::Zero), |name| of_name(at, name))?,
        seed: seed.as_ref().map(|seed| at.seed(seed)).transpose()?,
    };
    if let (Some(seed), false) = (&seed, channel.is_random()) {
        return Err(at.wrong(seed.span(), "seed", "it goes with jitter or drop"));
    }
    let delay = match &latency {
        Some(_) => time("latency", latency.as_ref()),
        None => time("delay", delay.as_ref()),
    };
    let transform = Transform {
        gain: gain.as_ref().map_or(Ok(1.0), |gain| finite(at, "gain", gain))?,
        bias: bias.as_ref().map_or(Ok(0.0), |bias| finite(at, "bias", bias))?,
        convert_units: convert_units.unwrap_or(true),
    };
    let map = map.as_ref().map_or(Ok(Vec::new()), |map| pairs(at, map))?;
    Ok(ConnectionEntry { from, to, delay: delay?, channel, transform, map, place })
}

fn pairs(at: &Text, map: &Spanned<Vec<Vec<toml::Value>>>) -> Result<Vec<(toml::Value, toml::Value)>, Error> {
    let wrong = |what: String| at.wrong(map.span(), what, "pairs, [[value, what it becomes], ...]");
    if map.get_ref().is_empty() {
        return Err(wrong("map without values".into()));
    }
    let pair = |pair: &Vec<toml::Value>| match pair.as_slice() {
        [from, to] => Ok((from.clone(), to.clone())),
        other => Err(wrong(format!("map: {} values in {}", other.len(), toml::Value::Array(other.to_vec())))),
    };
    map.get_ref().iter().map(pair).collect()
}

fn finite(at: &Text, key: &str, given: &Spanned<f64>) -> Result<f64, Error> {
    let number = *given.get_ref();
    let wrong = || at.wrong(given.span(), format!("{key} = {number}"), "a finite number");
    number.is_finite().then_some(number).ok_or_else(wrong)
}

fn share(at: &Text, drop: &Spanned<toml::Value>) -> Result<f64, Error> {
    let share = match drop.get_ref() {
        toml::Value::Integer(number) => Some(*number as f64),
        toml::Value::Float(number) => Some(*number),
        _ => None,
    };
    share.filter(|share| (0.0..=1.0).contains(share)).ok_or_else(|| {
        let expected = "the share of values that are lost, a number from 0 to 1";
        at.wrong(drop.span(), format!("drop = {}", drop.get_ref()), expected)
    })
}

fn of_name(at: &Text, name: &Spanned<String>) -> Result<Hold, Error> {
    let known = HOLDS.iter().find(|(known, _)| known == name.get_ref());
    known.map(|(_, hold)| *hold).ok_or_else(|| {
        let likely = nearest(name.get_ref(), HOLDS.iter().map(|(name, _)| *name));
        at.wrong(name.span(), format!("hold = {:?}", name.get_ref()), format!("zero or linear; {likely}"))
    })
}
