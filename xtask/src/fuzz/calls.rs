//! One sequence of random calls on one instance.

use super::api::{self, Api};
use super::random::Random;
use super::values::GET_RATES;
use fmi2_export::abi::types::{Component, FmuState, Status, Text};
use std::ffi::{CStr, CString};
use std::ptr;

pub(super) const OK: Status = 0;
const DISCARD: Status = 2;
const ERROR: Status = 3;

/// What the description says that the calls need.
pub struct Unit {
    /// Model identifier.
    pub identifier: String,
    guid: CString,
    /// Type, start value (0 if none is given), for each value reference from 0 on.
    pub(super) variables: Vec<(char, f64)>,
}

impl Unit {
    /// Reads a description as `fmi2-export` writes it: the place of a variable is its value reference.
    pub fn read(xml: &str) -> Option<Self> {
        let attribute = |text: &str, name: &str| {
            let (_, rest) = text.split_once(&format!(" {name}=\""))?;
            Some(rest.split_once('"')?.0.to_owned())
        };
        let mut variables = Vec::new();
        for part in xml.split("<ScalarVariable").skip(1) {
            let (_, element) = part.split_once('>')?;
            let element = element.split_once('<')?.1.split_once('>')?.0;
            let start = attribute(element, "start").and_then(|start| start.parse().ok()).unwrap_or(0.0);
            variables.push((element.chars().next()?, start));
        }
        Some(Self {
            identifier: attribute(xml, "modelIdentifier")?,
            guid: CString::new(attribute(xml, "guid")?).ok()?,
            variables,
        })
    }
}

/// A sequence under way.
pub struct Sequence<'a> {
    pub(super) api: &'a Api,
    pub(super) unit: &'a Unit,
    pub(super) random: Random,
    pub(super) c: Component,
    pub(super) states: Vec<FmuState>,
    /// Where the instance should be.
    pub(super) time: f64,
    /// No step or initialisation failed since the last reset: every value must be a number.
    pub(super) sound: bool,
    trace: bool,
    made: u64,
    refused: u64,
}

impl<'a> Sequence<'a> {
    /// A new instance; one in fifty attempts is a wrong one first.
    pub fn new(api: &'a Api, unit: &'a Unit, mut random: Random, trace: bool) -> Self {
        let callbacks = api::callbacks();
        let name = c"fuzz".as_ptr();
        let guid = unit.guid.as_ptr();
        // SAFETY: null pointers and strings as the standard has them; wrong values are what is tried.
        let c = unsafe {
            if random.per_cent(2) {
                let wrong =
                    [(ptr::null(), 1, guid), (name, 0, guid), (name, 1, ptr::null()), (name, 1, name)];
                let (name, kind, guid) = random.pick(&wrong);
                let none = (api.instantiate)(name, kind, guid, ptr::null(), &callbacks, 0, 1);
                (api.free)(none);
            }
            (api.instantiate)(name, 1, guid, ptr::null(), &callbacks, 0, 1)
        };
        Self { api, unit, random, c, states: Vec::new(), time: 0.0, sound: true, trace, made: 0, refused: 0 }
    }

    /// Makes up to `calls` calls and frees the instance; answers how many were made and refused.
    pub fn run(mut self, calls: u64) -> Result<(u64, u64), String> {
        if self.c.is_null() {
            return Err("fmi2Instantiate failed".to_owned());
        }
        // Half of the sequences get a proper start, since few would find it by chance.
        if self.random.per_cent(50) {
            self.start()?;
        }
        let length = 1 + self.random.next() % calls.max(1);
        for _ in 0..length {
            self.one()?;
            if let Some(message) = api::panic_in_log() {
                return Err(message);
            }
        }
        // Half of them leave states behind, which the instance must free.
        if self.random.per_cent(50) {
            while let Some(mut state) = self.states.pop() {
                // SAFETY: a state of this instance.
                self.note("fmi2FreeFMUstate", unsafe { (self.api.free_state)(self.c, &mut state) })?;
            }
        }
        // SAFETY: not used afterwards.
        unsafe { (self.api.free)(self.c) };
        Ok((self.made, self.refused))
    }

    pub(super) fn note(&mut self, function: &str, status: Status) -> Result<bool, String> {
        self.made += 1;
        if self.trace {
            eprintln!("{function} answered {status}");
        }
        self.refused += u64::from(status != OK);
        let may_discard = function.ends_with("Status") || function == GET_RATES;
        if status == OK || status == ERROR || (status == DISCARD && may_discard) {
            Ok(status == OK)
        } else {
            Err(format!("{function} answered {status}"))
        }
    }

    fn start(&mut self) -> Result<(), String> {
        self.setup(0.0, -1.0)?;
        for _ in 0..self.random.below(3) {
            self.set()?;
        }
        self.enter()?;
        for _ in 0..self.random.below(3) {
            self.set()?;
            self.get()?;
        }
        self.exit()
    }

    fn one(&mut self) -> Result<(), String> {
        match self.random.below(100) {
            0..24 => self.step(),
            24..42 => self.set(),
            42..60 => self.get(),
            60..66 => self.rates(),
            66..70 => self.derivative(),
            70..78 => self.state(),
            78..82 => self.bytes(),
            82..86 => self.replay(),
            86..89 => self.questions(),
            89..91 => self.logging(),
            91 => {
                let (start, stop) = (self.number(0.0), self.number(1.0));
                self.setup(start, stop)
            }
            92 => self.start(),
            93 => self.enter(),
            94 => self.exit(),
            95 => {
                // SAFETY: a living instance.
                let status = unsafe { (self.api.terminate)(self.c) };
                self.note("fmi2Terminate", status).map(drop)
            }
            _ => {
                // SAFETY: a living instance.
                let status = unsafe { (self.api.reset)(self.c) };
                self.sound = self.note("fmi2Reset", status)?;
                self.time = 0.0;
                if self.random.per_cent(70) { self.start() } else { Ok(()) }
            }
        }
    }

    /// A negative stop time stands for none.
    fn setup(&mut self, start: f64, stop: f64) -> Result<(), String> {
        let stop_defined = i32::from(stop >= 0.0 || stop.is_nan());
        let tolerance = self.number(1e-6);
        let tolerance_defined = i32::from(self.random.per_cent(20));
        // SAFETY: a living instance.
        let status =
            unsafe { (self.api.setup)(self.c, tolerance_defined, tolerance, start, stop_defined, stop) };
        if self.note("fmi2SetupExperiment", status)? {
            self.time = start;
        }
        Ok(())
    }

    fn enter(&mut self) -> Result<(), String> {
        // SAFETY: a living instance.
        let status = unsafe { (self.api.enter)(self.c) };
        self.note("fmi2EnterInitializationMode", status).map(drop)
    }

    fn exit(&mut self) -> Result<(), String> {
        // SAFETY: a living instance.
        let status = unsafe { (self.api.exit)(self.c) };
        self.sound &= self.note("fmi2ExitInitializationMode", status)?;
        Ok(())
    }

    /// Tells what is about to be called.
    pub(super) fn tell(&self, what: impl FnOnce() -> String) {
        if self.trace {
            eprintln!("{}", what());
        }
    }

    /// Mostly near `usual`, sometimes anything.
    pub(super) fn number(&mut self, usual: f64) -> f64 {
        let wild =
            [0.0, -0.0, 1.0, -1.0, 1e-300, 1e300, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.5, 2.0];
        match self.random.below(10) {
            0 => self.random.pick(&wild),
            1 => self.random.unit() - 0.5,
            2 => usual,
            _ => usual * (0.8 + 0.4 * self.random.unit()) + 0.02 * (self.random.unit() - 0.5),
        }
    }

    fn size(&mut self) -> f64 {
        let usual = [1.0 / 600.0, 1.0 / 600.0, 1e-3, 1.0 / 30.0, 0.05];
        let odd = [0.0, -1e-3, f64::NAN, f64::INFINITY, 1e-12, 1e-300, 1.0];
        if self.random.per_cent(90) { self.random.pick(&usual) } else { self.random.pick(&odd) }
    }

    fn step(&mut self) -> Result<(), String> {
        let size = self.size();
        let from = if self.random.per_cent(95) { self.time } else { self.number(self.time) };
        let no_state_prior = i32::from(self.random.per_cent(30));
        self.tell(|| format!("step from {from} s, {size} s long"));
        // SAFETY: a living instance.
        let status = unsafe { (self.api.step)(self.c, from, size, no_state_prior) };
        if self.note("fmi2DoStep", status)? {
            self.time = from + size;
        } else {
            self.sound = false;
        }
        Ok(())
    }

    fn questions(&mut self) -> Result<(), String> {
        let kind = self.random.below(6) as i32 - 1;
        let null = self.random.per_cent(5);
        let (mut status_value, mut real, mut integer, mut boolean) = (0, 0.0, 0, 0);
        let mut text: Text = ptr::null();
        let (api, c) = (self.api, self.c);
        // SAFETY: places for one value, or null, which must be refused.
        let status = unsafe {
            match self.random.below(8) {
                0 => (api.status)(c, kind, if null { ptr::null_mut() } else { &mut status_value }),
                1 => (api.real_status)(c, kind, if null { ptr::null_mut() } else { &mut real }),
                2 => (api.integer_status)(c, kind, if null { ptr::null_mut() } else { &mut integer }),
                3 => (api.boolean_status)(c, kind, if null { ptr::null_mut() } else { &mut boolean }),
                4 => (api.string_status)(c, kind, if null { ptr::null_mut() } else { &mut text }),
                5 => {
                    let right = CStr::from_ptr((api.platform)()) == c"default"
                        && CStr::from_ptr((api.version)()) == c"2.0";
                    if right { OK } else { return Err("wrong platform or version".to_owned()) }
                }
                6 => (api.reset)(ptr::null_mut()),
                _ => (api.cancel)(c),
            }
        };
        self.note("fmi2Get…Status", status).map(drop)
    }

    fn logging(&mut self) -> Result<(), String> {
        let names = [c"logAll".as_ptr(), c"logStatusError".as_ptr(), c"none".as_ptr(), ptr::null()];
        let chosen: Vec<Text> = (0..self.random.below(3)).map(|_| self.random.pick(&names)).collect();
        // SAFETY: strings or null pointers, which must be refused.
        let status = unsafe { (self.api.debug)(self.c, 1, chosen.len(), chosen.as_ptr()) };
        self.note("fmi2SetDebugLogging", status)?;
        // All on again, so that no panic goes unheard.
        // SAFETY: no categories.
        let status = unsafe { (self.api.debug)(self.c, 1, 0, ptr::null()) };
        self.note("fmi2SetDebugLogging", status).map(drop)
    }
}
