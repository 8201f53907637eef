//! The units of measurement that a column may be written in.

use super::kinds;
use super::ways::{Change, Way, all_written, list, named, numbers, then, times_log, written};
use crate::observe::{Affine, Problem, measure};
use crate::statistics::levels::ROUNDING;
use crate::text::brief;
use std::f64::consts::PI;

/// Units that logs are written in, beside the model's own and those with a prefix.
const USUAL: [&str; 24] = [
    "degC", "degF", "deg", "deg/s", "rpm", "km/h", "cm", "bar", "%", "K", "mm", "mN.m", "mA.h", "W.h", "l",
    "g", "inch", "ft", "lbf", "psi", "mile/h", "l/s", "l/min", "m3/h",
];
/// Prefixes that loggers put before the model's unit.
const PREFIXES: [&str; 4] = ["m", "k", "u", "M"];
/// Factors of a variable, and the unit that its description must name, or none: prefixes, and what logs have in place of what models count in.
const FACTORS: [(f64, &str, &str); 11] = [
    (1e3, "", ""),
    (1e-3, "", ""),
    (1e6, "", ""),
    (1e-6, "", ""),
    (1e-2, " (% or cm)", ""),
    (1e2, "", ""),
    (PI / 180.0, " (deg in place of rad)", ""),
    (180.0 / PI, " (rad in place of deg)", ""),
    (9.80665, " (g in place of m/s2)", ""),
    (PI / 30.0, " (rpm in place of rad/s)", ""),
    (1e-2, " (a grade in %)", "rad"),
];

/// From what is said of a channel to a unit of measurement.
fn to_unit(problem: &Problem, place: usize, unit: &str) -> Option<Affine> {
    let channel = &problem.channels[place];
    let variable = problem.model.variable(channel.variable);
    let own = channel.conversion;
    let found =
        measure::conversion(unit, variable, problem.model.description(channel.variable.instance)).ok()?;
    let found = if own.scale < 0.0 { Affine { scale: -found.scale, offset: found.offset } } else { found };
    let by = Affine {
        scale: found.scale / own.scale,
        offset: found.offset - found.scale / own.scale * own.offset,
    };
    let same = (by.scale - 1.0).abs() < ROUNDING && by.offset.abs() < ROUNDING * own.scale.abs();
    (!same).then_some(by)
}

fn in_unit(problem: &Problem, found: &[(usize, Affine, &str)]) -> Way {
    let channel = |place: &usize| &problem.channels[*place];
    let lines = found.iter().map(|(place, by, unit)| {
        let to = then(channel(place).conversion, *by);
        let line = if to.scale < 0.0 { numbers(to) } else { format!("unit = \"{unit}\"") };
        (channel(place), line)
    });
    let said = found.iter().map(|(place, _, unit)| format!("{} in {unit}", named(channel(place))));
    Way {
        change: Change::Values(found.iter().map(|(place, by, _)| (*place, *by)).collect()),
        line: channel(&found[0].0).line,
        what: list(said),
        add: all_written(lines),
        exact: false,
    }
}

/// The units that one channel may be written in.
pub(super) fn units(problem: &Problem, place: usize) -> Vec<Way> {
    let channel = &problem.channels[place];
    let variable = problem.model.variable(channel.variable);
    let way = |(factor, why, _): &(f64, &str, &str)| {
        let by = times_log(channel, *factor);
        Way {
            change: Change::Values(vec![(place, by)]),
            line: channel.line,
            what: format!("{} times {}{why}", named(channel), brief(*factor)),
            add: written(channel, &numbers(then(channel.conversion, by))),
            exact: false,
        }
    };
    let Some(own) = variable.unit.as_deref().filter(|own| !own.is_empty()) else {
        return FACTORS.iter().filter(|(_, _, of)| of.is_empty()).map(way).collect();
    };
    let prefixed: Vec<String> = PREFIXES.iter().map(|prefix| format!("{prefix}{own}")).collect();
    let names = USUAL.into_iter().chain(prefixed.iter().map(String::as_str)).chain([own]);
    let mut found: Vec<(usize, Affine, &str)> = Vec::new();
    for name in names {
        let Some(by) = to_unit(problem, place, name) else { continue };
        let same = |(_, known, _): &(usize, Affine, &str)| {
            (known.scale / by.scale - 1.0).abs() < ROUNDING && (known.offset - by.offset).abs() < ROUNDING
        };
        if !found.iter().any(same) {
            found.push((place, by, name));
        }
    }
    let is_known = |(factor, ..): &&(f64, &str, &str)| {
        let same = |by: &Affine| by.offset == times_log(channel, *factor).offset;
        found.iter().any(|(_, by, _)| (by.scale / factor - 1.0).abs() < ROUNDING && same(by))
    };
    let own_kind = FACTORS
        .iter()
        .filter(|(_, _, of)| *of == own)
        .filter_map(|(factor, why, _)| counted(problem, place, *factor, why));
    let bare = FACTORS[..2].iter().filter(|factor| !is_known(factor)).map(way);
    let in_units = found.iter().map(|one| in_unit(problem, std::slice::from_ref(one)));
    in_units.chain(bare).chain(own_kind).chain(kinds::rates(problem, place)).collect()
}

/// The numbers of the log times a factor, whatever is said of their unit; nothing where they are read so.
fn counted(problem: &Problem, place: usize, factor: f64, why: &str) -> Option<Way> {
    let channel = &problem.channels[place];
    let own = channel.conversion;
    let to = Affine { scale: factor.copysign(own.scale), offset: 0.0 };
    let by = Affine { scale: to.scale / own.scale, offset: -own.offset * to.scale / own.scale };
    let same = (by.scale - 1.0).abs() < ROUNDING && by.offset == 0.0;
    (!same).then(|| Way {
        change: Change::Values(vec![(place, by)]),
        line: channel.line,
        what: format!("{} times {}{why}", named(channel), brief(factor)),
        add: written(channel, &numbers(to)),
        exact: false,
    })
}

/// All of these channels that are of one kind in another unit: all angles in degrees.
pub(super) fn together(problem: &Problem, places: &[usize], names: &[&'static str]) -> Option<Way> {
    let of =
        |place: &usize| names.iter().find_map(|name| Some((*place, to_unit(problem, *place, name)?, *name)));
    let found: Vec<(usize, Affine, &str)> = places.iter().filter_map(of).collect();
    (found.len() > 1).then(|| in_unit(problem, &found))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::tests::swung;

    #[test]
    fn value_an_angle_may_be_a_grade_and_a_torque_not() {
        let mut problem = swung("grade", 60);
        let grades = |problem: &Problem, name: &str| {
            let place = problem.channels.iter().position(|channel| channel.name.ends_with(name));
            let all = units(problem, place.expect("it is logged"));
            all.into_iter()
                .filter(|way| way.what.contains("a grade in %"))
                .map(|way| way.add)
                .collect::<Vec<_>>()
        };
        let angle = grades(&problem, ".q2");
        assert!(angle.len() == 1 && angle[0].contains("scale = 0.01"), "{angle:?}");
        assert!(grades(&problem, ".tau").is_empty());
        // of a column that is read in degrees, too, and of none that is read so
        let place = problem.channels.iter().position(|channel| channel.name.ends_with(".q2"));
        let place = place.expect("it is logged");
        problem.channels[place].conversion = Affine { scale: -PI / 180.0, offset: 0.0 };
        assert!(grades(&problem, ".q2")[0].ends_with("scale = -0.01"));
        let factor = |way: Way| match way.change {
            Change::Values(by) => by[0].1.scale,
            _ => f64::NAN,
        };
        assert!(units(&problem, place).into_iter().any(|way| (factor(way) - 0.572_957_795).abs() < 1e-9));
        problem.channels[place].conversion = Affine { scale: 0.01, offset: 0.0 };
        assert!(grades(&problem, ".q2").is_empty());
    }
}
