//! What the unit made of a window lately. A fit begins with the columns that a linearisation has just taken at the same point, and one that
//! refuses a step begins again where it was: a fifth of the simulations of an arm that sticks was asked for before.

use crate::error::Error;
use crate::rigs::acrobot::bench::Setting;
use crate::rigs::acrobot::residual::plant::policy::WINDOWS;
use crate::rigs::acrobot::residual::trajectory::{Drive, Push, Row, State};
use std::collections::VecDeque;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// What a simulation of a window is made from, beside its drive.
#[derive(Debug, Clone, Copy)]
pub(super) struct Asked<'a> {
    pub(super) settings: &'a [Setting],
    pub(super) start: &'a State,
    pub(super) pushes: &'a [Push],
}

/// The last simulations of a window. Clones share them: what comes out depends on nothing else than what is asked.
#[derive(Debug, Clone, Default)]
pub(super) struct Memory(Arc<Mutex<Known>>);

/// Simulations of one drive, the newest at the end.
#[derive(Debug, Default)]
struct Known {
    drive: Option<Drive>,
    made: VecDeque<Made>,
}

#[derive(Debug)]
struct Made {
    digest: u64,
    settings: Vec<Setting>,
    start: State,
    pushes: Vec<Push>,
    rows: Vec<Row>,
}

impl Memory {
    /// The rows of a drive, which `make` makes unless they are known.
    ///
    /// # Errors
    /// Those of `make`, which are not remembered.
    pub(super) fn rows(
        &self,
        drive: &Drive,
        asked: Asked<'_>,
        make: impl FnOnce() -> Result<Vec<Row>, Error>,
    ) -> Result<Vec<Row>, Error> {
        let digest = asked.digest();
        if let Some(rows) = self.open().find(drive, &asked, digest) {
            return Ok(rows);
        }
        let rows = make()?;
        self.open().keep(drive, asked, digest, &rows);
        Ok(rows)
    }

    fn open(&self) -> MutexGuard<'_, Known> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Known {
    fn find(&self, drive: &Drive, asked: &Asked<'_>, digest: u64) -> Option<Vec<Row>> {
        let here = self.drive.as_ref() == Some(drive);
        let same = |made: &&Made| {
            made.digest == digest
                && made.start == *asked.start
                && made.settings == asked.settings
                && made.pushes == asked.pushes
        };
        // what was asked last is asked again soonest
        self.made.iter().rev().find(same).filter(|_| here).map(|made| made.rows.clone())
    }

    fn keep(&mut self, drive: &Drive, asked: Asked<'_>, digest: u64, rows: &[Row]) {
        if self.drive.as_ref() != Some(drive) {
            self.drive = Some(drive.clone());
            self.made.clear();
        }
        if self.made.len() >= WINDOWS.remembered {
            self.made.pop_front();
        }
        let Asked { settings, start, pushes } = asked;
        self.made.push_back(Made {
            digest,
            settings: settings.to_vec(),
            start: *start,
            pushes: pushes.to_vec(),
            rows: rows.to_vec(),
        });
    }
}

impl Asked<'_> {
    /// Differs wherever a bit does, but for chance.
    fn digest(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        for (reference, value) in self.settings {
            (reference, value.as_f64().map(f64::to_bits)).hash(&mut hasher);
        }
        self.start.map(f64::to_bits).hash(&mut hasher);
        for push in self.pushes {
            (push.joint, [push.from, push.to, push.size].map(f64::to_bits)).hash(&mut hasher);
        }
        hasher.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::residual::trajectory::Event;
    use orchestrator::Value;

    /// A drive that begins at a time, s.
    fn drive(time: f64) -> Drive {
        let event = Event { time, tau: 0.0, tau_1: 0.0, rates: [0.0; 2], wanted: true };
        Drive { events: vec![event], before: 0.0, past: Arc::default() }
    }

    #[test]
    fn every_simulation_is_made_once_until_three_hundred_others_were() {
        let (memory, mut made) = (Memory::default(), 0);
        let mut ask = |drive: &Drive, value: f64, start: State, pushes: &[Push]| {
            let settings = [(7, Value::Real(value))];
            let asked = Asked { settings: &settings, start: &start, pushes };
            let rows = memory.clone().rows(drive, asked, || {
                made += 1;
                Ok(vec![[value; _]])
            });
            assert_eq!(rows.expect("made"), [[value; _]]);
            made
        };
        let (here, still) = (drive(0.0), [0.0; 4]);
        let push = Push { joint: true, from: 0.0, to: 1.0, size: 0.1 };
        assert_eq!([1.0, 1.0, 2.0, 1.0].map(|value| ask(&here, value, still, &[])), [1, 1, 2, 2]);
        // anything else is another one, also the sign of a zero
        assert_eq!(ask(&here, 1.0, [0.0, 0.0, 0.0, -0.0], &[]), 3);
        assert_eq!([push, push].map(|push| ask(&here, 1.0, still, &[push])), [4, 4]);
        let others = (0..300).map(|k| ask(&here, 10.0 + f64::from(k), still, &[])).last();
        assert_eq!((others, ask(&here, 1.0, still, &[])), (Some(304), 305));
        // a log whose clock was corrected
        assert_eq!([0.0, 0.5, 0.5].map(|time| ask(&drive(time), 1.0, still, &[])), [305, 306, 306]);
    }

    #[test]
    fn law_what_failed_is_tried_again() {
        let (memory, here, settings) = (Memory::default(), drive(0.0), []);
        let asked = Asked { settings: &settings, start: &[0.0; 4], pushes: &[] };
        assert!(memory.rows(&here, asked, || Err(Error::Model("lost".into()))).is_err());
        assert_eq!(memory.rows(&here, asked, || Ok(Vec::new())).ok(), Some(Vec::new()));
    }
}
