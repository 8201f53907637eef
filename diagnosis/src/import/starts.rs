//! Which parameter is where a state starts: found by its name, believed once the unit was seen to start there.

use crate::observe;
use crate::statistics::levels::{ROUNDING, STEP};
use orchestrator::fmu::{Causality, Description, Variable};
use orchestrator::{Fmu, Kind, Value};

/// What tools and people put behind a state's name for its start: 20-sim, Modelica's libraries, our units.
const BEHIND: [&str; 6] = ["_initial", "_start", "_init", "_0", ".start", "0"];
/// A start value is moved by this share of its size.
const MOVED: f64 = STEP;
/// And shown again to this share.
const SHOWN: f64 = ROUNDING;

/// A state with what sets it, by their places in the description.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Start {
    /// A parameter, or the variable itself where it is of initial "exact".
    pub start: usize,
    /// The variable that shows it.
    pub shows: usize,
}

/// States of a unit that can be started.
pub(super) fn of(fmu: &Fmu) -> Vec<Start> {
    let description = fmu.description();
    let mut all: Vec<Start> = (0..description.variables.len())
        .filter(|place| observe::shows_its_start(&description.variables[*place]))
        .map(|place| Start { start: place, shows: place })
        .collect();
    let named: Vec<Start> =
        named(description).filter(|one| all.iter().all(|own| own.shows != one.shows)).collect();
    all.extend(named.into_iter().filter(|one| is_started(fmu, *one).unwrap_or(false)));
    all
}

/// The one that starts a variable.
pub(super) fn find(starts: &[Start], shows: usize) -> Option<Start> {
    starts.iter().copied().find(|one| one.shows == shows)
}

fn named(description: &Description) -> impl Iterator<Item = Start> + '_ {
    let parameters = description.variables.iter().enumerate().filter(|(_, variable)| {
        variable.kind == Kind::Real && variable.causality == Causality::Parameter && variable.start.is_some()
    });
    parameters.filter_map(|(start, parameter)| {
        // x_initial[2] starts x[2]
        let (name, index) = match parameter.name.find('[') {
            Some(at) if parameter.name.ends_with(']') => parameter.name.split_at(at),
            _ => (parameter.name.as_str(), ""),
        };
        let shows = BEHIND.iter().find_map(|end| {
            let place = description.place(&format!("{}{index}", name.strip_suffix(end)?))?;
            moves(&description.variables[place]).then_some(place)
        })?;
        Some(Start { start, shows })
    })
}

fn moves(variable: &Variable) -> bool {
    use orchestrator::fmu::Variability::{Continuous, Discrete};
    let seen = matches!(variable.causality, Causality::Output | Causality::Local);
    seen && variable.kind == Kind::Real && matches!(variable.variability, Continuous | Discrete)
}

/// Whether the variable is where the parameter says after initialisation, at two places.
fn is_started(fmu: &Fmu, one: Start) -> Result<bool, orchestrator::Error> {
    let [start, shows] = [one.start, one.shows].map(|place| &fmu.description().variables[place]);
    let nominal = start.start.as_ref().and_then(Value::as_f64).unwrap_or(0.0);
    let by = MOVED * if nominal == 0.0 { 1.0 } else { nominal.abs() };
    let room = |value: f64| {
        start.max.is_none_or(|most| value <= most) && start.min.is_none_or(|least| value >= least)
    };
    let moved = [nominal + by, nominal - by].into_iter().find(|value| room(*value));
    for value in [Some(nominal), moved].into_iter().flatten() {
        let mut instance = fmu.instantiate("start")?;
        instance.setup_experiment(0.0, None)?;
        instance.set_real(&[start.reference], &[value])?;
        instance.enter_initialization()?;
        instance.exit_initialization()?;
        let mut shown = [f64::NAN];
        instance.get_real(&[shows.reference], &mut shown)?;
        let there = (shown[0] - value).abs() <= SHOWN * value.abs().max(by);
        if !there {
            return Ok(false);
        }
    }
    Ok(moved.is_some())
}
