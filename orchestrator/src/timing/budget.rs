//! The latency of loops, by its parts.
//!
//! A value of unit U (interval a, offset α) for unit V (b, β) on a way with the latency L:
//!
//! - transport: L; with jitter σ the mean of max(0, L + σ·N(0, 1)) = L·Φ(L/σ) + σ·φ(L/σ);
//! - sampling: how long ago U's newest sample was sent that V can have: the points of V fall on phases of U that are
//!   r, r + g, ..., r + a - g with g = gcd(a, b) and r = (β - L - α) mod g, each as often, so r + (a - g)/2 on average. Losses with
//!   probability p add a·p/(1 - p). A linear hold goes on along the line: 0;
//! - hold: V keeps an input over its step: b/2;
//! - scheme: what the algorithm adds. Jacobi takes values at the begin of the step: 0. Gauss-Seidel takes those of its end: -b;
//!   but where U steps after V, a value of the same instant is missed once in a/g times and is then older by a: g on average,
//!   unless the line goes on over it. Extrapolation and interpolation take direct values along the step: -b/2, no sampling.
//!
//! For two units at one rate this is the phase error of the scheme: x' = v, v' = -x has +h once round with Jacobi (explicit
//! Euler, amplitude times e^(h/2 t)) and 0 with Gauss-Seidel (symplectic Euler, no growth).

use super::{Schedule, Way, loops};
use crate::algorithm::Sees;
use crate::error::Error;
use crate::scenario::Scenario;
use crate::simulation::Simulation;
use std::fmt;

/// How late a value is, by where that comes from; means in s.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Terms {
    /// The sender has points only each interval, and samples are lost.
    pub sampling: f64,
    /// The receiver keeps its inputs over a step.
    pub hold: f64,
    /// Latency and jitter.
    pub transport: f64,
    /// What the master algorithm adds or, where it gives values of the end of a step, takes off.
    pub scheme: f64,
}

impl Terms {
    /// All of them.
    pub fn total(&self) -> f64 {
        self.sampling + self.hold + self.transport + self.scheme
    }

    fn plus(&self, other: &Self) -> Self {
        Self {
            sampling: self.sampling + other.sampling,
            hold: self.hold + other.hold,
            transport: self.transport + other.transport,
            scheme: self.scheme + other.scheme,
        }
    }
}

/// One way of a loop.
#[derive(Debug, Clone, PartialEq)]
pub struct Leg {
    /// The connection that is latest of those between these two units: `unit.variable` of its output.
    pub from: String,
    /// And of its input.
    pub to: String,
    /// How late.
    pub terms: Terms,
    /// Without jitter and losses: the least and the greatest age in s that a value has when the unit takes it.
    pub age: (f64, f64),
}

/// A loop.
#[derive(Debug, Clone, PartialEq)]
pub struct Budget {
    /// The units, each once.
    pub units: Vec<String>,
    /// From each unit to the next one, the last back to the first.
    pub legs: Vec<Leg>,
}

impl Budget {
    /// Once round.
    pub fn terms(&self) -> Terms {
        self.legs.iter().fold(Terms::default(), |sum, leg| sum.plus(&leg.terms))
    }
}

/// `loop a -> b -> a: 12.5 ms = sampling 2.5 + hold 7.5 + transport 5 + scheme -2.5`
impl fmt::Display for Budget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let terms = self.terms();
        // To the nanosecond, what is below is rounding, and to four digits: nobody reads on.
        let ms = |seconds: f64| {
            let exact = (seconds * 1e9).round() / 1e6 + 0.0;
            format!("{exact:.3e}").parse().unwrap_or(exact)
        };
        let first = self.units.first().map_or("", String::as_str);
        write!(
            f,
            "loop {} -> {first}: {} ms = sampling {} + hold {} + transport {} + scheme {}",
            self.units.join(" -> "),
            ms(terms.total()),
            ms(terms.sampling),
            ms(terms.hold),
            ms(terms.transport),
            ms(terms.scheme)
        )
    }
}

/// The loops of a scenario, at most so many, the latest first; and whether there are more.
///
/// # Errors
/// If the times of the scenario have no common tick.
pub fn budget(scenario: &Scenario, most: usize) -> Result<(Vec<Budget>, bool), Error> {
    in_order(scenario, 0..scenario.units.len(), most)
}

/// Those of a simulation, whose units may step in another order than the scenario's.
///
/// # Errors
/// None: it has a common tick.
pub fn budget_of(simulation: &Simulation, most: usize) -> Result<(Vec<Budget>, bool), Error> {
    in_order(simulation.scenario(), simulation.order().iter().copied(), most)
}

fn in_order(
    scenario: &Scenario,
    order: impl IntoIterator<Item = usize>,
    most: usize,
) -> Result<(Vec<Budget>, bool), Error> {
    let schedule = Schedule::of(scenario, order)?;
    let (found, mut more) = loops::of(&schedule);
    let mut budgets: Vec<Budget> = (found.into_iter())
        .map(|ways| Budget {
            units: ways.iter().map(|way| scenario.units[way.from].name.clone()).collect(),
            legs: ways.iter().map(|way| schedule.leg(scenario, way)).collect(),
        })
        .collect();
    // A stable sort: loops that are equally late stay in the order of the units.
    budgets.sort_by(|a, b| b.terms().total().total_cmp(&a.terms().total()));
    more |= budgets.len() > most;
    budgets.truncate(most);
    Ok((budgets, more))
}

impl Schedule {
    fn leg(&self, scenario: &Scenario, way: &Way) -> Leg {
        let entry = &scenario.connections[way.number];
        let (first, cycle) = self.phases(way);
        let (a, _) = self.units[way.from];
        let missed = first == 0 && self.misses(way);
        let oldest = if missed { a } else { first + a - cycle };
        let youngest = if missed { cycle } else { first };
        let seconds = |ticks: i64| (way.latency + ticks) as f64 * self.tick;
        Leg {
            from: entry.from.clone(),
            to: entry.to.clone(),
            terms: self.terms(way),
            age: (seconds(youngest), seconds(oldest)),
        }
    }

    /// The least time since the sender's last point at a point of the receiver, and the step from one such time to the next.
    fn phases(&self, way: &Way) -> (i64, i64) {
        let ((a, alpha), (b, beta)) = (self.units[way.from], self.units[way.to]);
        let cycle = gcd(a, b);
        ((beta - way.latency - alpha).rem_euclid(cycle), cycle)
    }

    pub(super) fn terms(&self, way: &Way) -> Terms {
        let (a, b) = (self.units[way.from].0 as f64, self.units[way.to].0 as f64);
        let (first, cycle) = self.phases(way);
        let lost = if way.drop > 0.0 { a * way.drop / (1.0 - way.drop) } else { 0.0 };
        // A value that goes on along a line is none of the last point.
        let along = self.along && way.direct;
        let sampling = if along || way.linear { 0.0 } else { first as f64 + (a - cycle as f64) / 2.0 + lost };
        let missed = if first == 0 && !way.linear && self.misses(way) { cycle as f64 } else { 0.0 };
        let scheme = match self.sees {
            // Nor does it stand still over a step.
            _ if along => -b / 2.0,
            Sees::Begin => 0.0,
            Sees::EndInOrder => missed - b,
            Sees::End => -b,
        };
        Terms {
            sampling: sampling * self.tick,
            hold: b / 2.0 * self.tick,
            transport: mean_transit(way.latency as f64 * self.tick, way.jitter),
            scheme: scheme * self.tick,
        }
    }
}

/// Mean of max(0, latency + jitter · N(0, 1)).
fn mean_transit(latency: f64, jitter: f64) -> f64 {
    if jitter == 0.0 {
        return latency;
    }
    let z = latency / jitter;
    let density = libm::exp(-z * z / 2.0) / std::f64::consts::TAU.sqrt();
    latency * 0.5 * libm::erfc(-z * std::f64::consts::FRAC_1_SQRT_2) + jitter * density
}

fn gcd(a: i64, b: i64) -> i64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(algorithm: &str, units: &[(&str, &str)], ways: &[(&str, &str)]) -> Vec<Budget> {
        let mut text = format!("format = 1\nexperiment = {{ stop = 1, algorithm = \"{algorithm}\" }}\n");
        for (name, interval) in units {
            text += &format!("[[units]]\nname = \"{name}\"\nfmu = \"x.fmu\"\n{interval}\n");
        }
        for (from_to, way) in ways {
            let (from, to) = from_to.split_once('>').expect("two ends");
            text += &format!("[[connections]]\nfrom = \"{from}.y\"\nto = \"{to}.u\"\n{way}\n");
        }
        budget(&Scenario::parse(&text, "test.toml").expect("a scenario"), 9).expect("ticks").0
    }

    fn close(terms: Terms, expected: [f64; 4]) {
        let found = [terms.sampling, terms.hold, terms.transport, terms.scheme];
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{terms:?}, not {expected:?}");
        }
    }

    #[test]
    fn value_ages_between_points_that_are_shifted() {
        // v is taken 20 ms after it was sent at the earliest: that is 30 ms after a point of x, and every 100 ms so.
        let units = [("x", "interval = 0.1"), ("v", "interval = 0.1\noffset = 0.03")];
        let found = of("jacobi", &units, &[("x>v", "latency = 0.02"), ("v>x", "")]);
        let ages: Vec<(f64, f64)> = found[0].legs.iter().map(|leg| leg.age).collect();
        for (age, expected) in ages.iter().zip([0.03, 0.07]) {
            // Seconds of ticks: a rounding each.
            assert!((age.0 - expected).abs() < 1e-15 && (age.1 - expected).abs() < 1e-15, "{ages:?}");
        }
        // Twice as often: taken 30 or 80 ms after a point.
        let units = [("x", "interval = 0.1"), ("v", "interval = 0.05\noffset = 0.03")];
        let found = of("jacobi", &units, &[("x>v", "latency = 0.02"), ("v>x", "")]);
        let age = found[0].legs[0].age;
        assert!((age.0 - 0.03).abs() < 1e-15 && (age.1 - 0.08).abs() < 1e-15, "{age:?}");
    }

    #[test]
    fn law_a_table_of_just_all_loops_leaves_none_out() {
        let text = "format = 1\nexperiment = { stop = 1 }\n[[units]]\nname = \"x\"\nfmu = \"x.fmu\"\ninterval = 1\n\
                    [[units]]\nname = \"v\"\nfmu = \"x.fmu\"\ninterval = 1\n[[connections]]\nfrom = \"x.y\"\nto = \"v.u\"\n\
                    [[connections]]\nfrom = \"v.y\"\nto = \"x.u\"\n[[connections]]\nfrom = \"v.y\"\nto = \"v.w\"\n";
        let scenario = Scenario::parse(text, "test.toml").expect("a scenario");
        let found =
            |most: usize| budget(&scenario, most).map(|(loops, more)| (loops.len(), more)).expect("ticks");
        assert_eq!((found(9), found(2), found(1), found(0)), ((2, false), (2, false), (1, true), (0, true)));
        let alone = "format = 1\nexperiment = { stop = 1 }\n[[units]]\nname = \"x\"\nfmu = \"x.fmu\"\ninterval = 1\n\
                     [[connections]]\nfrom = \"x.y\"\nto = \"x.u\"\n";
        let (found, more) =
            budget(&Scenario::parse(alone, "test.toml").expect("a scenario"), 9).expect("ticks");
        assert_eq!((found.len(), more), (1, false), "all of one unit");
    }

    #[test]
    fn law_ways_that_lead_out_of_a_loop_and_a_unit_that_drives_itself_hide_none() {
        // The first way of x leads to w, which drives nobody; v drives itself, too.
        let units = ["x", "w", "v"].map(|name| (name, "interval = 0.1"));
        let ways = [("x>w", ""), ("x>v", ""), ("v>x", ""), ("v>v", "")];
        let found = of("gauss-seidel", &units, &ways);
        let names: Vec<String> = found.iter().map(|budget| budget.units.join(" ")).collect();
        assert_eq!(names, ["v", "x v"]);
        // It steps when its value of this instant is not sent yet.
        close(found[0].terms(), [0.0, 0.05, 0.0, 0.0]);
        assert_eq!(found[0].legs[0].age, (0.1, 0.1));
    }

    #[test]
    fn law_two_hundred_loops_are_enough() {
        // Each of seven units drives all others: 2359 loops, which are walked through soon.
        let names: Vec<String> = (0..7).map(|unit| format!("a{unit}")).collect();
        let mut text = "format = 1\nexperiment = { stop = 1 }\n".to_owned();
        for name in &names {
            text += &format!("[[units]]\nname = \"{name}\"\nfmu = \"x.fmu\"\ninterval = 1\n");
        }
        for (from, to) in names.iter().flat_map(|from| names.iter().map(move |to| (from, to))) {
            if from != to {
                text += &format!("[[connections]]\nfrom = \"{from}.y\"\nto = \"{to}.{from}\"\n");
            }
        }
        let scenario = Scenario::parse(&text, "test.toml").expect("a scenario");
        let (found, more) = budget(&scenario, 10_000).expect("ticks");
        assert_eq!((found.len(), more), (200, true));
    }

    #[test]
    fn law_more_loops_than_anybody_reads_are_not_walked() {
        // Each of 60 units drives the next five: there are more loops than could be counted.
        let mut text = "format = 1\nexperiment = { stop = 1 }\n".to_owned();
        for unit in 0..60 {
            text += &format!("[[units]]\nname = \"a{unit}\"\nfmu = \"x.fmu\"\ninterval = 1\n");
        }
        for (unit, next) in (0..60).flat_map(|unit| (1..6).map(move |next| (unit, next))) {
            text +=
                &format!("[[connections]]\nfrom = \"a{unit}.y\"\nto = \"a{}.u{next}\"\n", (unit + next) % 60);
        }
        let (found, more) =
            budget(&Scenario::parse(&text, "test.toml").expect("a scenario"), 9).expect("ticks");
        assert_eq!((found.len(), more), (9, true));
    }

    #[test]
    fn value_one_rate_is_the_phase_error_of_the_scheme() {
        let (units, ways) = ([("x", "interval = 0.1"), ("v", "interval = 0.1")], [("v>x", ""), ("x>v", "")]);
        let jacobi = of("jacobi", &units, &ways);
        assert_eq!(jacobi.len(), 1);
        close(jacobi[0].terms(), [0.0, 0.1, 0.0, 0.0]);
        let seidel = of("gauss-seidel", &units, &ways);
        close(seidel[0].terms(), [0.0, 0.1, 0.0, -0.1]);
        assert_eq!(
            seidel[0].to_string(),
            "loop x -> v -> x: 0 ms = sampling 0 + hold 100 + transport 0 + scheme -100"
        );
        // Four digits, not all that a third of a second has.
        let thirds = [("x", "interval = \"1/300\""), ("v", "interval = \"1/300\"")];
        assert!(
            of("gauss-seidel", &thirds, &ways)[0]
                .to_string()
                .ends_with("hold 3.333 + transport 0 + scheme -3.333")
        );
        // v steps after x, so x always has it of the point before.
        let ages: Vec<(f64, f64)> = seidel[0].legs.iter().map(|leg| leg.age).collect();
        assert_eq!(ages, [(0.0, 0.0), (0.1, 0.1)]);
    }

    #[test]
    fn value_three_rates_latency_jitter_and_losses() {
        let units = [
            ("p", "interval = 0.001"),
            ("c", "interval = \"1/30\"\noffset = 0.01"),
            ("k", "interval = 0.005"),
        ];
        let found = of("jacobi", &units, &[("p>c", ""), ("c>k", "latency = 0.02"), ("k>p", "")]);
        let legs: Vec<Terms> = found[0].legs.iter().map(|leg| leg.terms).collect();
        // gcd(1/1000, 1/30) = 1/3000, and 0.01 is a multiple of it.
        close(legs[0], [(0.001 - 1.0 / 3000.0) / 2.0, 0.5 / 30.0, 0.0, 0.0]);
        // gcd(1/30, 1/200) = 1/600; -0.02 - 0.01 is a multiple of it.
        close(legs[1], [(1.0 / 30.0 - 1.0 / 600.0) / 2.0, 0.0025, 0.02, 0.0]);
        close(legs[2], [0.002, 0.0005, 0.0, 0.0]);
        let ways = [("p>k", "latency = 0.001\njitter = 0.002\ndrop = 0.5"), ("k>p", "hold = \"linear\"")];
        let found = of("jacobi", &units, &ways);
        // scipy: norm.cdf(0.5) * 1e-3 + norm.pdf(0.5) * 2e-3
        let transit = 1e-3 * 0.691_462_461_274_013_1 + 2e-3 * 0.352_065_326_764_299_5;
        close(found[0].terms(), [0.001, 0.003, transit, 0.0]);
    }

    #[test]
    fn law_the_latest_of_parallel_ways_counts_and_loops_come_latest_first() {
        let units = [("a", "interval = 0.01"), ("b", "interval = 0.01"), ("c", "interval = 0.02")];
        let ways =
            [("a>b", ""), ("b>a", "latency = 0.3"), ("a>b", "latency = 0.1"), ("b>c", ""), ("c>a", "")];
        let found = of("gauss-seidel", &units, &ways);
        let names: Vec<String> = found.iter().map(|budget| budget.units.join(" ")).collect();
        assert_eq!(names, ["a b", "a b c"]);
        assert!((found[0].terms().transport - 0.4).abs() < 1e-12);
        // Of those that are equally late the first one is told.
        let text = "format = 1\nexperiment = { stop = 1 }\n[[units]]\nname = \"a\"\nfmu = \"x.fmu\"\ninterval = 1\n\
                    [[connections]]\nfrom = \"a.y\"\nto = \"a.u\"\n[[connections]]\nfrom = \"a.z\"\nto = \"a.w\"\n";
        let found = budget(&Scenario::parse(text, "test.toml").expect("a scenario"), 9).expect("ticks").0;
        assert_eq!((found.len(), found[0].legs[0].from.as_str()), (1, "a.y"));
    }
}
