//! z(q₂) for the parameters of the moment, with the tables of the last few others.
//!
//! A table takes longer to build than a hundred steps of 5 ms. Who asks an instance for one theta and then another in turn, as
//! a fit does, would build it again and again. Tables are rebuilt where they are missing, so they are no part of a state.

use fmi2_export::Log;
use mechanics::{Place, Theta};
use std::sync::Arc;

/// Tables that are kept beside the current one, of 8 kB each: a value and a step of each parameter of [`Theta`].
const KEPT: usize = 15;

/// Tables of z(q₂), shared by all copies of a state.
#[derive(Debug, Clone, Default)]
pub struct Places {
    /// For the parameters of the moment; no table where they have no z.
    now: Option<(Theta, Option<Arc<Place>>)>,
    /// For those before, the latest first.
    before: Vec<(Theta, Arc<Place>)>,
}

impl Places {
    /// z(q₂) for these parameters; `None`, and a warning once, where they have no z.
    pub fn at(&mut self, theta: &Theta, log: &mut dyn Log) -> Option<&Place> {
        if !self.now.as_ref().is_some_and(|(built_for, _)| built_for == theta) {
            self.change_to(theta, log);
        }
        self.current()
    }

    /// The table that was asked for last.
    pub fn current(&self) -> Option<&Place> {
        self.now.as_ref().and_then(|(_, place)| place.as_deref())
    }

    /// Without the memory of parameters that have no table: the warning that says so must come again.
    pub fn renewed(self) -> Self {
        Self { now: self.now.filter(|(_, place)| place.is_some()), ..self }
    }

    fn change_to(&mut self, theta: &Theta, log: &mut dyn Log) {
        if let Some((built_for, Some(place))) = self.now.take() {
            self.before.insert(0, (built_for, place));
        }
        let known = self.before.iter().position(|(built_for, _)| built_for == theta);
        let place = match known {
            Some(known) => Some(self.before.remove(known).1),
            None => Self::built(theta, log),
        };
        self.before.truncate(KEPT);
        self.now = Some((*theta, place));
    }

    fn built(theta: &Theta, log: &mut dyn Log) -> Option<Arc<Place>> {
        let place = Place::new(theta);
        if let Err(error) = &place {
            log.log("logStatusWarning", &|| {
                format!("z stays 0, since theta gives no place on the manifold: {error}")
            });
        }
        place.ok().map(Arc::new)
    }
}
