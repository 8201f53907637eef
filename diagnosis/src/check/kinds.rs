//! Ways to read channels that one logger writes alike: a rate per minute or per hour, and all columns of one kind in another unit.
//!
//! Flows of one plant are logged in one unit. Where that isn't the one that is said, no column alone read otherwise lets the model follow, and
//! a unit may fail as they are read, so that pairs aren't looked at.

use super::units::units;
use super::ways::named;
use super::ways::{Change, Way, fed_and_compared, list, numbers, then, times_log, written};
use crate::observe::{Affine, Problem, measure};
use crate::statistics::levels::ROUNDING;

/// Units of time that rates are logged per, beside the second.
const RATES: [&str; 2] = ["min", "h"];

/// A channel's numbers per minute and per hour, where the model counts per second.
pub(super) fn rates(problem: &Problem, place: usize) -> Vec<Way> {
    let channel = &problem.channels[place];
    let variable = problem.model.variable(channel.variable);
    if !measure::is_rate(variable, problem.model.description(channel.variable.instance)) {
        return Vec::new();
    }
    let way = |unit: &&str| {
        let by = times_log(channel, measure::seconds(unit).ok()?.recip());
        Some(Way {
            change: Change::Values(vec![(place, by)]),
            line: channel.line,
            what: format!("{} per {unit} in place of per s", named(channel)),
            add: written(channel, &numbers(then(channel.conversion, by))),
            exact: true,
        })
    };
    RATES.iter().filter_map(way).collect()
}

/// All channels whose variables have the same unit in another one, alike: of all, of what is fed, of what is compared.
pub(super) fn of_one_kind(problem: &Problem) -> Vec<Way> {
    let (fed, compared) = fed_and_compared(problem);
    let all: Vec<usize> = (0..problem.channels.len()).collect();
    let mut ways: Vec<Way> = Vec::new();
    for places in [all, fed, compared] {
        for (at, first) in places.iter().enumerate() {
            let is_like = |place: &usize| own_unit(problem, *place) == own_unit(problem, *first);
            // each kind once, by its first channel
            if own_unit(problem, *first).is_none() || places[..at].iter().any(is_like) {
                continue;
            }
            let others: Vec<usize> = places[at + 1..].iter().copied().filter(is_like).collect();
            let alike = units(problem, *first).into_iter().filter_map(|way| alike(problem, way, &others));
            let new: Vec<Way> =
                alike.filter(|way| ways.iter().all(|known| known.change != way.change)).collect();
            ways.extend(new);
        }
    }
    ways
}

/// The unit that a channel's variable is said to have.
fn own_unit(problem: &Problem, place: usize) -> Option<&str> {
    problem.model.variable(problem.channels[place].variable).unit.as_deref().filter(|unit| !unit.is_empty())
}

/// A way of one channel, and the same of others; nothing where there are none, or one can't be read so.
fn alike(problem: &Problem, way: Way, others: &[usize]) -> Option<Way> {
    let by = change(&way)?;
    let same = |other: &Way| {
        change(other).is_some_and(|other| {
            (other.scale / by.scale - 1.0).abs() < ROUNDING
                && (other.offset - by.offset).abs() <= ROUNDING * by.offset.abs()
        })
    };
    let found = others.iter().map(|place| units(problem, *place).into_iter().find(same));
    let mut all = vec![way];
    all.extend(found.collect::<Option<Vec<Way>>>()?);
    let values = |way: &Way| match &way.change {
        Change::Values(values) => values.clone(),
        _ => Vec::new(),
    };
    (all.len() > 1).then(|| Way {
        change: Change::Values(all.iter().flat_map(values).collect()),
        line: all[0].line,
        what: list(all.iter().map(|way| way.what.clone())),
        add: all.iter().map(|way| way.add.clone()).collect::<Vec<_>>().join(". "),
        exact: true,
    })
}

/// What is done to the numbers of a way's only channel.
fn change(way: &Way) -> Option<Affine> {
    match &way.change {
        Change::Values(values) => values.first().map(|(_, by)| *by),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::tests::swung;

    #[test]
    fn value_rates_are_read_per_minute_and_per_hour_and_nothing_else_is() {
        let mut problem = swung("rates", 60);
        let place = |name: &str| problem.channels.iter().position(|channel| channel.name.ends_with(name));
        let (tau, q1) = (place("tau").expect("it is fed"), place("q1").expect("it is compared"));
        assert_eq!((rates(&problem, tau), rates(&problem, q1)), (Vec::new(), Vec::new()));
        // the same column as a rate
        let rate = problem.model.fmus[0].description().variables.iter().position(|one| one.name == "dq1");
        problem.channels[q1].variable.place = rate.expect("the pendulum has one");
        let found = rates(&problem, q1);
        let scale = |way: &Way| change(way).map_or(0.0, |by| by.scale);
        assert_eq!(found.iter().map(scale).collect::<Vec<_>>(), [1.0 / 60.0, 1.0 / 3600.0]);
        assert!(found[0].what.contains("per min in place of per s"), "{}", found[0].what);
        assert!(found[0].add.contains("scale = 0.01666"), "{}", found[0].add);
    }

    #[test]
    fn value_columns_of_one_unit_are_read_alike() {
        let problem = swung("alike", 60);
        let ways = of_one_kind(&problem);
        let both = ways.iter().find(|way| way.what.contains("q1") && way.what.contains("mrad"));
        let both = both.expect("two angles in thousandths");
        assert_eq!(both.channels(&problem).len(), 2, "{}", both.what);
        assert!(both.add.matches("Write in").count() == 2, "{}", both.add);
        let count = |change: &Change| ways.iter().filter(|way| way.change == *change).count();
        assert!(ways.iter().all(|way| count(&way.change) == 1), "each once");
    }
}
