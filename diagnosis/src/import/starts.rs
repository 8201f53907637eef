//! Which parameter is where a state starts: found by its name, believed once the unit was seen to start there. What has no such name and what no
//! variable shows is tried further (`unshown.rs`).
//!
//! A parameter is tried where its name says so (`x_initial`, `initialPositionY`, `T_0`): variables that are there after initialisation, at
//! two values of it, start there. Of several the one that has its name goes first, then what was measured, then outputs.

use super::instance;
use super::policy::IMPORT;
use super::unshown::Likely;
use crate::observe;
use orchestrator::fmu::{Begin, Causality, Description, Variable};
use orchestrator::{Fmu, Isolation, Kind, Value};

/// What tools and people put behind a state's name for its start: 20-sim, Modelica's libraries, our units.
const BEHIND: [&str; 6] = ["_initial", "_start", "_init", "_0", ".start", "0"];
/// How a word of a start's name begins.
const WORDS: [&str; 2] = ["init", "start"];

/// A state with what sets it, by their places in the description.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Start {
    /// A parameter, or the variable itself where it is of initial "exact".
    pub start: usize,
    /// The variable that shows it.
    pub shows: usize,
}

/// States of a unit that can be started; of two variables that one parameter starts a measured one goes first. Where many parameters are
/// moved at once the unit runs in a process of its own within `limits`: nobody knows what it bears. And those that may be such: what was
/// measured is there, but no name says so.
pub(super) fn find_starts(fmu: &Fmu, measured: &[usize], limits: &Isolation) -> (Vec<Start>, Vec<Start>) {
    let description = fmu.description();
    let mut all: Vec<Start> = (0..description.variables.len())
        .filter(|place| observe::shows_its_start(&description.variables[*place]))
        .map(|place| Start { start: place, shows: place })
        .collect();
    let shown: Vec<usize> =
        (0..description.variables.len()).filter(|place| moves(&description.variables[*place])).collect();
    let Ok(nominal) = initialised(fmu, &shown, &[]) else { return (all, Vec::new()) };
    let apart = fmu.isolated(limits.clone());
    let mut maybe = Vec::new();
    for (place, parameter) in description.variables.iter().enumerate().filter(|(_, one)| may_be_a_start(one))
    {
        let namesake = namesake(description, parameter);
        let by_its_name = tells_a_start(&parameter.name);
        let free = |one: &usize| all.iter().all(|known| known.shows != *one);
        let mut there = follows(fmu, parameter, &shown, &nominal).unwrap_or_default();
        let is_like = |one: &usize| {
            let shown = (&description.variables[*one], description);
            !observe::measure::are_unlike((parameter, description), shown)
        };
        there.retain(|one| free(one) && is_like(one));
        if !there.is_empty() {
            there.retain(|one| hangs_on_it_alone(&apart, parameter, *one));
        }
        let first = |one: &usize| {
            let output = description.variables[*one].causality == Causality::Output;
            (Some(*one) != namesake, !measured.contains(one), !output)
        };
        let named = |one: &usize| by_its_name || Some(*one) == namesake;
        let start = |shows: usize| Start { start: place, shows };
        match there.iter().copied().filter(named).min_by_key(first) {
            Some(shows) => all.push(start(shows)),
            None => maybe.extend(there.into_iter().find(|one| measured.contains(one)).map(start)),
        }
    }
    let is_free = |one: &Start| all.iter().all(|known| known.shows != one.shows);
    maybe.retain(is_free);
    maybe.dedup_by_key(|one| one.shows);
    (all, maybe)
}

/// What may start a state: what shows it though no name says so, and by its name, though no variable shows it, what a unit keeps to itself.
pub(super) fn likely(fmu: &Fmu, candidates: &[usize], maybe: &[Start]) -> Vec<Likely> {
    let shown = maybe.iter().map(|one| Likely { start: one.start, shows: Some(one.shows) });
    let is_shown = |place: &usize| maybe.iter().any(|one| one.start == *place);
    let unshown = unshown(fmu, candidates).into_iter().filter(|place| !is_shown(place));
    shown.chain(unshown.map(|start| Likely { start, shows: None })).collect()
}

/// Those that are numbers and may be anything.
pub(super) fn numbers(fmu: &Fmu, candidates: &[usize]) -> Vec<usize> {
    let variables = &fmu.description().variables;
    candidates.iter().copied().filter(|place| may_be_a_start(&variables[*place])).collect()
}

/// Whether the name of a parameter says that it is where a variable starts.
pub(super) fn is_told_by_name(description: &Description, one: Start) -> bool {
    let parameter = &description.variables[one.start];
    tells_a_start(&parameter.name) || namesake(description, parameter) == Some(one.shows)
}

/// Parameters that are starts by their names, though no variable shows them: those of states that a unit keeps to itself.
fn unshown(fmu: &Fmu, candidates: &[usize]) -> Vec<usize> {
    let variables = &fmu.description().variables;
    let named = |place: &usize| {
        let name = &variables[*place].name;
        may_be_a_start(&variables[*place])
            && (has_the_word(name) || BEHIND.iter().any(|end| ends_as_a_start(name, end)))
    };
    candidates.iter().copied().filter(named).collect()
}

/// Whether a name ends so; `w0` is a start, `k10` may be anything.
fn ends_as_a_start(name: &str, end: &str) -> bool {
    name.strip_suffix(end).is_some_and(|stem| end != "0" || stem.ends_with(char::is_alphabetic))
}

/// The one that starts a variable.
pub(super) fn find(starts: &[Start], shows: usize) -> Option<Start> {
    starts.iter().copied().find(|one| one.shows == shows)
}

/// A parameter that is a number.
fn may_be_a_start(variable: &Variable) -> bool {
    variable.kind == Kind::Real && variable.causality == Causality::Parameter && variable.start.is_some()
}

/// Whether a name is that of a start by itself, whatever variables there are: `initialPositionY`, `T_0`; `w0` may be anything.
fn tells_a_start(name: &str) -> bool {
    let is_bare = |end: &&str| end.starts_with(char::is_alphanumeric);
    has_the_word(name) || BEHIND.iter().filter(|end| !is_bare(end)).any(|end| name.ends_with(end))
}

/// Whether a word of the name is that of a start: `initialPositionY`, `mt0_init`.
fn has_the_word(name: &str) -> bool {
    super::matching::words(name).iter().any(|word| WORDS.iter().any(|begin| word.starts_with(begin)))
}

/// The variable whose name stands in that of its start, with the same index: `x_initial[2]` starts `x[2]`.
fn namesake(description: &Description, parameter: &Variable) -> Option<usize> {
    let (name, index) = match parameter.name.find('[') {
        Some(at) if parameter.name.ends_with(']') => parameter.name.split_at(at),
        _ => (parameter.name.as_str(), ""),
    };
    let stems = BEHIND.iter().filter_map(|end| name.strip_suffix(end));
    stems
        .filter_map(|stem| description.place(&format!("{stem}{index}")))
        .find(|place| moves(&description.variables[*place]))
}

fn moves(variable: &Variable) -> bool {
    use orchestrator::fmu::Variability::{Continuous, Discrete};
    let seen = matches!(variable.causality, Causality::Output | Causality::Local);
    seen && variable.kind == Kind::Real && matches!(variable.variability, Continuous | Discrete)
}

/// The variables that are where a parameter says after initialisation, at its nominal value and moved off it.
fn follows(
    fmu: &Fmu,
    parameter: &Variable,
    shown: &[usize],
    nominal: &[f64],
) -> Result<Vec<usize>, orchestrator::Error> {
    let value = value_of(parameter);
    let by = by(value);
    let is = |shown: f64, value: f64| is_shown(shown, value, by);
    let (Some(moved), true) = (moved(parameter), nominal.iter().any(|one| is(*one, value))) else {
        return Ok(Vec::new());
    };
    let there = initialised(fmu, shown, &[(parameter.reference, Value::Real(moved))])?;
    let both = shown.iter().zip(nominal.iter().zip(&there));
    Ok(both
        .filter(|(_, (before, after))| is(**before, value) && is(**after, moved))
        .map(|(place, _)| *place)
        .collect())
}

/// Whether a variable is where a parameter says, moved, when all others are moved as well: a state does, and what is computed of one doesn't, a speed
/// behind a gear. Of a unit that can't be begun so, or ends its process, nothing speaks against it.
fn hangs_on_it_alone(fmu: &Fmu, parameter: &Variable, place: usize) -> bool {
    let is_other =
        |one: &&Variable| one.causality == Causality::Parameter && one.reference != parameter.reference;
    let elsewhere = |one: &Variable| {
        let to = one.start.is_some().then(|| moved(one)).flatten()?;
        match one.kind {
            Kind::Real => Some((one.reference, Value::Real(to))),
            Kind::Integer => Some((one.reference, Value::Integer(to as i32))),
            _ => None,
        }
    };
    let Some(own) = moved(parameter) else { return true };
    let mut set: Vec<(u32, Value)> =
        fmu.description().variables.iter().filter(is_other).filter_map(elsewhere).collect();
    // at zero, what is a multiple of it shows it, too
    set.push((parameter.reference, Value::Real(own)));
    initialised(fmu, &[place], &set).map_or(true, |there| is_shown(there[0], own, by(value_of(parameter))))
}

/// A number's start value.
fn value_of(variable: &Variable) -> f64 {
    variable.start.as_ref().and_then(Value::as_f64).unwrap_or(0.0)
}

/// How far a value is moved.
fn by(value: f64) -> f64 {
    IMPORT.start_move * if value == 0.0 { 1.0 } else { value.abs() }
}

/// A number's start value moved within its range, a whole one by one.
pub(super) fn moved(variable: &Variable) -> Option<f64> {
    let value = value_of(variable);
    let by = if variable.kind == Kind::Integer { 1.0 } else { by(value) };
    let room = |value: f64| {
        variable.max.is_none_or(|most| value <= most) && variable.min.is_none_or(|least| value >= least)
    };
    [value + by, value - by].into_iter().find(|value| room(*value))
}

/// Whether a variable is where a parameter of this value says, which was moved by so much.
fn is_shown(shown: f64, value: f64, by: f64) -> bool {
    (shown - value).abs() <= IMPORT.start_shown * value.abs().max(by)
}

/// What variables show after initialisation, with values of parameters.
fn initialised(fmu: &Fmu, shown: &[usize], set: &[(u32, Value)]) -> Result<Vec<f64>, orchestrator::Error> {
    let mut instance = fmu.instantiate(&instance(fmu))?;
    instance.begin(0.0, None, Begin { settings: set, ..Begin::default() })?;
    instance.exit_initialization()?;
    let references: Vec<u32> =
        shown.iter().map(|place| fmu.description().variables[*place].reference).collect();
    let mut values = vec![f64::NAN; shown.len()];
    instance.get_real(&references, &mut values)?;
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_names_of_starts() {
        for name in ["initialPositionY", "mt0_init", "x_start", "Mass.InitialVelocity"] {
            assert!(has_the_word(name), "{name}");
        }
        for name in ["restartless", "l0", "position", "reinit"] {
            assert!(!has_the_word(name) && !tells_a_start(name), "{name}");
        }
        for name in ["T_0", "x_start", "level.start", "mt0_init", "initialPositionY"] {
            assert!(tells_a_start(name), "{name}");
        }
    }

    #[test]
    fn value_a_start_is_shown_again_but_for_rounding() {
        // kelvins that a unit computes as degrees and back are off by 1e-15; a state that follows its start in a first step is not there
        assert!(
            is_shown(300.0 * (1.0 + 0.9e-6), 300.0, 3.0) && !is_shown(300.0 * (1.0 + 1.1e-6), 300.0, 3.0)
        );
        assert!(is_shown(0.9e-8, 0.0, 0.01) && !is_shown(1.1e-8, 0.0, 0.01), "of 0, a share of the move");
    }
}
