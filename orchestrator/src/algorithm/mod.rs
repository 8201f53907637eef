//! Master algorithms: in what order units step, which values they see, and whether they take steps back. One file each; a
//! new one is added to [`ALGORITHMS`].

mod derived_order;
mod extrapolated;
mod gauss_seidel;
mod iterated;
mod jacobi;
mod options;
mod parallel_jacobi;
mod step_halving;

pub(crate) use options::Options;

use crate::error::Error;
use crate::scenario::Scenario;
use crate::suggest::nearest;
use crate::system::{Point, System};
use crate::time::Clock;
use options::Known;

/// An algorithm: its name in a scenario, what can be set of it, and how it is made.
struct Entry {
    name: &'static str,
    options: &'static [Known],
    make: fn(&Options<'_>) -> Box<dyn Algorithm>,
}

/// Every algorithm.
const ALGORITHMS: &[Entry] = &[
    Entry { name: "gauss-seidel", options: &[], make: |_| Box::new(gauss_seidel::GaussSeidel) },
    Entry { name: "jacobi", options: &[], make: |_| Box::new(jacobi::Jacobi) },
    Entry {
        name: "iterated",
        options: iterated::OPTIONS,
        make: |options| Box::new(iterated::Iterated::new(options)),
    },
    Entry {
        name: "step-halving",
        options: step_halving::OPTIONS,
        make: |options| Box::new(step_halving::StepHalving::new(options)),
    },
    Entry { name: "derived-order", options: &[], make: |_| Box::new(derived_order::DerivedOrder) },
    Entry {
        name: "parallel-jacobi",
        options: parallel_jacobi::OPTIONS,
        make: |options| Box::new(parallel_jacobi::ParallelJacobi::new(options)),
    },
    Entry { name: "extrapolated", options: &[], make: |_| Box::new(extrapolated::Extrapolated::new(false)) },
    Entry { name: "interpolated", options: &[], make: |_| Box::new(extrapolated::Extrapolated::new(true)) },
];

/// Which values of other units a unit sees in a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sees {
    /// Those at the begin of its step; so with sources.
    Begin,
    /// Those at the end of its step of units that step before it ([`crate::Simulation::order`]), and of the others those of
    /// their last point before that. Sources are read at the end.
    EndInOrder,
    /// Those at the end of its step, of all units; so with sources.
    End,
}

/// What an algorithm asks of units.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Needs {
    /// They save and restore their states.
    pub states: bool,
    /// They take steps of any size.
    pub any_step: bool,
    /// All have the same interval and offset.
    pub one_rate: bool,
    /// Nothing: what they give each other is made to agree at each communication point, so that loops of direct feedthrough are not cut.
    pub settles: bool,
    /// They step in the order that follows from who depends on whom, instead of the scenario's.
    pub order: bool,
}

/// What is done at a communication point: a time at which the step of at least one unit ends.
pub(crate) trait Algorithm: Send {
    /// Which values of others a unit sees.
    fn sees(&self) -> Sees;

    /// Continuous Reals that come directly go on along lines over a step, and so do sources.
    fn along(&self) -> bool {
        false
    }

    /// What it asks of units.
    fn needs(&self) -> Needs {
        Needs::default()
    }

    /// It tells how far off the values are.
    fn estimates(&self) -> bool {
        false
    }

    /// It steps units side by side, in several threads.
    #[cfg(isolation)]
    fn side_by_side(&self) -> bool {
        false
    }

    /// All units are at the start.
    fn start(&mut self, system: &mut System) {
        let _ = system;
    }

    /// What it knows beside the state of the system, for a checkpoint.
    fn save(&self) -> Vec<f64> {
        Vec::new()
    }

    /// The same, from a checkpoint.
    fn restore(&mut self, saved: &[f64]) {
        let _ = saved;
    }

    /// Before the values at `point` (the start included) are left.
    fn begin(&mut self, system: &mut System, point: Point) {
        let _ = (system, point);
    }

    /// Steps the units that are due, so that all values are those at `point`.
    fn step(&mut self, system: &mut System, point: Point) -> Result<(), Box<Error>>;

    /// Goes from `now` over the next points, at most so many; tells how many there were. The one place from which an
    /// algorithm steps, and made anew for each: so its steps are part of this loop, and what they look up stays in
    /// registers from point to point where nobody looks at the values in between.
    fn advance(
        &mut self,
        system: &mut System,
        clock: &Clock,
        now: &mut Point,
        most: u32,
    ) -> Result<u32, Box<Error>> {
        for made in 0..most {
            let Some(ticks) = system.next() else { return Ok(made) };
            let point = Point { ticks, time: clock.seconds(ticks) };
            self.begin(system, *now);
            self.step(system, point)?;
            *now = point;
        }
        Ok(most)
    }
}

/// The names of all algorithms.
pub fn names() -> impl Iterator<Item = &'static str> {
    ALGORITHMS.iter().map(|entry| entry.name)
}

/// Which values of others a unit sees with an algorithm, by its name.
pub fn sees(name: &str) -> Option<Sees> {
    plain(name).map(|algorithm| algorithm.sees())
}

/// Whether Reals go on along lines over a step with an algorithm, by its name.
pub fn along(name: &str) -> bool {
    plain(name).is_some_and(|algorithm| algorithm.along())
}

/// Whether an algorithm estimates errors, by its name.
pub(crate) fn estimates(name: &str) -> bool {
    plain(name).is_some_and(|algorithm| algorithm.estimates())
}

/// What an algorithm asks of units, by its name.
pub fn needs(name: &str) -> Option<Needs> {
    plain(name).map(|algorithm| algorithm.needs())
}

/// An algorithm with nothing set.
fn plain(name: &str) -> Option<Box<dyn Algorithm>> {
    let entry = ALGORITHMS.iter().find(|entry| entry.name == name)?;
    Some((entry.make)(&Options { known: entry.options, given: &[] }))
}

/// The algorithm of a scenario, with its options.
pub(crate) fn of(scenario: &Scenario) -> Result<Box<dyn Algorithm>, Error> {
    let name = &scenario.algorithm;
    let entry = ALGORITHMS.iter().find(|entry| entry.name == name.value).ok_or_else(|| Error::Scenario {
        place: name.place.clone(),
        what: format!("there is no algorithm {:?}", name.value),
        expected: nearest(&name.value, names()),
    })?;
    let options = Options { known: entry.options, given: &scenario.options };
    options.check(entry.name)?;
    let algorithm = (entry.make)(&options);
    if algorithm.needs().one_rate
        && let [first, others @ ..] = scenario.units.as_slice()
    {
        let rate = |unit: &crate::scenario::UnitEntry| (unit.interval, unit.offset.as_ref().map(|o| o.value));
        if let Some(other) = others.iter().find(|unit| rate(unit) != rate(first)) {
            return Err(Error::Scenario {
                place: other.place.clone(),
                what: format!(
                    "algorithm {:?} with units at different points: {}, {}",
                    entry.name, first.name, other.name
                ),
                expected: "the same interval and offset for all units; it divides their steps itself".into(),
            });
        }
    }
    Ok(algorithm)
}

/// Whether the units can do what the algorithm and they themselves are asked for.
pub(crate) fn fits(scenario: &Scenario, algorithm: &dyn Algorithm, system: &System) -> Result<(), Error> {
    for (entry, unit) in scenario.units.iter().zip(&system.units) {
        let flags = &unit.instance.fmu().description().co_simulation;
        let needs = algorithm.needs();
        let lacking = [
            (needs.states || entry.retry, flags.can_get_and_set_state, "canGetAndSetFMUstate"),
            (
                needs.any_step || entry.retry,
                flags.can_handle_variable_step,
                "canHandleVariableCommunicationStepSize",
            ),
        ];
        if let Some((.., flag)) = lacking.into_iter().find(|(needed, can, _)| *needed && !can) {
            let what = match entry.retry {
                true => format!("retry = true of unit {}", entry.name),
                false => format!("algorithm {:?} with unit {}", scenario.algorithm.value, entry.name),
            };
            let expected = format!("a unit that says {flag}: its steps have to be taken back");
            return Err(Error::Scenario { place: entry.place.clone(), what, expected });
        }
    }
    Ok(())
}
