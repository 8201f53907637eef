//! Every algorithm over the same units: values against closed forms, multi-rate, delays, sources.

use crate::common;

use crate::common::Units;
use orchestrator::{CsvRecorder, Ended, MemoryRecorder, Progress, Quiet, Scenario, Sees, Simulation};
use std::ops::ControlFlow;

/// Runs a scenario with each algorithm.
fn every_algorithm(units: &Units, scenario: &str, mut check: impl FnMut(&str, &MemoryRecorder)) {
    every_order(units, scenario, |algorithm, _, results| check(algorithm, results));
}

/// The same, with the order in which the units step.
fn every_order(units: &Units, scenario: &str, mut check: impl FnMut(&str, &[usize], &MemoryRecorder)) {
    for algorithm in common::every_rate() {
        let mut scenario = Scenario::parse(scenario, "test.toml").expect("a scenario");
        scenario.algorithm.value = algorithm.into();
        let mut simulation = Simulation::new(&scenario, &units.unit_path()).expect("builds");
        let mut results = MemoryRecorder::new();
        simulation.run(&mut results, &mut Quiet).expect("runs");
        check(algorithm, simulation.order(), &results);
    }
}

fn sees(algorithm: &str) -> Sees {
    orchestrator::sees(algorithm).expect("an algorithm")
}

fn series<'a>(results: &'a MemoryRecorder, name: &str) -> &'a [f64] {
    results.series(name).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn every_algorithm_integrates_a_constant_exactly() {
    let scenario = r#"
        format = 1
        experiment = { stop = 1 }
        [[units]]
        name = "a"
        fmu = "stateful.fmu"
        interval = 0.125
        set = { k = 2.0, x0 = 0.5 }
        [[sources]]
        to = "a.u1"
        kind = "constant"
        value = 3
    "#;
    every_algorithm(&Units::new(), scenario, |_, results| {
        assert_eq!(results.times().len(), 9);
        for (time, y) in results.times().iter().zip(series(results, "a.y1")) {
            // All numbers are dyadic, so there is no rounding.
            assert_eq!(*y, 0.5 + 6.0 * time);
        }
    });
}

#[test]
fn every_algorithm_couples_as_it_says() {
    // dx = v, dv = -x, x first: at the end in order it is x += h v, v -= h x(new); at the begin it takes the old x, and at the
    // end of all x = x(old) + h v, v = v(old) - h x. Along lines the slope is that between the last two points, none at first:
    // the second method of Adams and Bashforth; of an x that has stepped already, the mean over the step.
    let scenario = r#"
        format = 1
        experiment = { stop = 1 }
        [[units]]
        name = "x"
        fmu = "stateful.fmu"
        interval = 0.125
        set = { x0 = 1 }
        [[units]]
        name = "v"
        fmu = "stateful.fmu"
        interval = "1/8"
        set = { k = -1 }
        [[connections]]
        from = "v.y1"
        to = "x.u1"
        [[connections]]
        from = "x.y1"
        to = "v.u1"
    "#;
    every_algorithm(&Units::new(), scenario, |algorithm, results| {
        let (mut x, mut v) = (1.0, 0.0);
        let mut before = (x, v);
        for row in 0..9 {
            let found = (series(results, "x.y1")[row], series(results, "v.y1")[row]);
            // Dyadic numbers have no rounding; an iteration ends within its tolerance of 1e-10 of each of eight steps.
            // Lines are read at times that are not the numbers' own: a rounding each.
            let within = match sees(algorithm) {
                Sees::End => 1e-9,
                _ if orchestrator::along(algorithm) => 1e-14,
                _ => 0.0,
            };
            let off = (found.0 - x).abs().max((found.1 - v).abs());
            assert!(off <= within, "{algorithm} {row}: {found:?}, not {x}, {v}");
            let (old, h) = (x, 0.125);
            let (middle_x, middle_v) = (1.5 * x - 0.5 * before.0, 1.5 * v - 0.5 * before.1);
            before = (x, v);
            match sees(algorithm) {
                Sees::Begin if orchestrator::along(algorithm) => {
                    (x, v) = (x + h * middle_v, v - h * middle_x)
                }
                Sees::EndInOrder if orchestrator::along(algorithm) => {
                    x += h * middle_v;
                    v -= h * 0.5 * (old + x);
                }
                Sees::Begin => (x, v) = (x + h * v, v - h * old),
                Sees::EndInOrder => (x, v) = (x + h * v, v - h * (x + h * v)),
                Sees::End => {
                    x = (old + h * v) / (1.0 + h * h);
                    v -= h * x;
                }
            }
        }
    });
}

/// A clock at each of three rates, each feeding an echo at another rate.
const RATES: &str = r#"
    format = 1
    experiment = { stop = "1/2" }
    [[units]]
    name = "fast"
    fmu = "stateful.fmu"
    interval = 0.001
    set = { mode = 2 }
    [[units]]
    name = "middle"
    fmu = "stateful.fmu"
    interval = "5e-3"
    set = { mode = 2 }
    [[units]]
    name = "slow"
    fmu = "stateful.fmu"
    interval = "1/30"
    set = { mode = 2 }
    [[connections]]
    from = "slow.y1"
    to = "fast.u1"
    [[connections]]
    from = "middle.y1"
    to = "fast.u2"
    [[connections]]
    from = "fast.y1"
    to = "slow.u1"
    [[connections]]
    from = "slow.y1"
    to = "middle.u1"
    [[connections]]
    from = "fast.y1"
    to = "middle.u2"
    delay = "1/300"
"#;

/// Ticks of the three rates are 1/3000 s.
const FAST: i64 = 3;
const MIDDLE: i64 = 15;
const SLOW: i64 = 100;

/// The last point of a rate that is not later than a tick.
fn last(ticks: i64, rate: i64) -> i64 {
    ticks.div_euclid(rate) * rate
}

/// The time at which a value was made that a unit of one rate shows in a row; computed from the rule, not from steps.
fn made(algorithm: &str, row: i64, own: i64, other: i64, other_is_later: bool, delay: i64) -> i64 {
    let seen_at = match sees(algorithm) {
        Sees::End => last(row, own),
        // The end of its last step; a unit that steps after it was then still at the point before.
        Sees::EndInOrder => last(row, own) - i64::from(other_is_later),
        // The begin of the step that ends here or, between its points, that is under way.
        _ if row % own == 0 => row - own,
        _ => last(row, own),
    };
    last(seen_at - delay, other).max(0)
}

/// The value of a clock of another rate along the step of a unit: the middle of the step, once the other has a slope.
fn along(algorithm: &str, row: i64, own: i64, other: i64, other_is_later: bool) -> f64 {
    let (begin, seen_at) = match sees(algorithm) {
        // The input of a unit that has not stepped is its start value.
        _ if row < own && sees(algorithm) != Sees::Begin || row == 0 => return 0.0,
        Sees::Begin if row % own == 0 => (row - own, row - own),
        Sees::Begin => (last(row, own), last(row, own)),
        _ => (last(row, own) - own, last(row, own) - i64::from(other_is_later)),
    };
    if last(seen_at, other) == 0 { 0.0 } else { begin as f64 + own as f64 / 2.0 }
}

#[test]
fn every_algorithm_is_exact_at_three_rates_and_causal() {
    every_order(&Units::new(), RATES, |algorithm, order, results| {
        let rank = |unit: usize| order.iter().position(|other| *other == unit);
        let later = |from: usize, to: usize| rank(from) > rank(to);
        // In the order of the scenario fast steps first; derived, after middle, on which an output of it depends directly.
        let (slow_fast, middle_fast) = (later(2, 0), later(1, 0));
        let expected_order: &[usize] = if algorithm == "derived-order" { &[1, 0, 2] } else { &[0, 1, 2] };
        assert_eq!(order, expected_order, "{algorithm}");
        let came = |row: i64, own: i64, other: i64, other_is_later: bool| match orchestrator::along(algorithm)
        {
            true => along(algorithm, row, own, other, other_is_later),
            false => made(algorithm, row, own, other, other_is_later, 0) as f64,
        };
        let times = results.times();
        let rows: Vec<i64> =
            (0..=1500).filter(|t| t % FAST == 0 || t % MIDDLE == 0 || t % SLOW == 0).collect();
        let exact: Vec<f64> = rows.iter().map(|row| *row as f64 / 3000.0).collect();
        assert_eq!(times, exact, "the doubles nearest to the exact times");
        for (at, &row) in rows.iter().enumerate() {
            let expected = [
                ("fast.y1", last(row, FAST) as f64),
                ("middle.y1", last(row, MIDDLE) as f64),
                ("slow.y1", last(row, SLOW) as f64),
                ("fast.u1", came(row, FAST, SLOW, slow_fast)),
                ("fast.u2", came(row, FAST, MIDDLE, middle_fast)),
                ("slow.u1", came(row, SLOW, FAST, false)),
                ("middle.u1", came(row, MIDDLE, SLOW, true)),
                ("middle.u2", made(algorithm, row, MIDDLE, FAST, later(0, 1), 10) as f64),
            ];
            for (name, ticks) in expected {
                let value = series(results, name)[at];
                // The clock adds begin and size, each rounded once: two half ulps of a number below 1, and one more.
                // A line through two of them has a slope of 1 within a thousandth of an ulp's share of its own step.
                let error = (value - ticks / 3000.0).abs();
                let within = if orchestrator::along(algorithm) { 1e-13 } else { 1.7e-16 };
                assert!(error <= within, "{algorithm}: {name} = {value} at {row}/3000 s, not {ticks}/3000");
            }
        }
    });
}

#[test]
fn every_run_gives_the_same_bytes() {
    let units = Units::new();
    let scenario = Scenario::parse(RATES, "test.toml").expect("a scenario");
    let bytes = |simulation: &mut Simulation| {
        let mut csv = CsvRecorder::new(Vec::new());
        simulation.run(&mut csv, &mut Quiet).expect("runs");
        csv.into_inner()
    };
    let mut simulation = Simulation::new(&scenario, &units.unit_path()).expect("builds");
    let first = bytes(&mut simulation);
    assert!(first.len() > 10_000);
    assert!(bytes(&mut simulation) == first, "reset");
    let mut other = Simulation::new(&scenario, &units.unit_path()).expect("builds");
    other.advance_to(0.1).expect("steps");
    assert!(bytes(&mut other) == first, "built again and left half way");
    let resolved = Scenario::parse(&simulation.resolved(), "resolved.toml").expect("loads");
    assert!(bytes(&mut Simulation::new(&resolved, &units.unit_path()).expect("builds")) == first, "resolved");
}

#[test]
fn every_algorithm_reads_sources_at_its_time_and_shortens_the_last_step_where_it_can() {
    // 0.4 s divides neither the run nor the points of the table; the last step has 0.2 s, or there is none.
    let scenario = r#"
        format = 1
        experiment = { stop = 1 }
        [[units]]
        name = "a"
        fmu = "feedthrough.fmu"
        interval = 0.4
        set = { mode = 1 }
        [[sources]]
        to = "a.u1"
        kind = "linear"
        points = [[0, 1], [0.5, 2], [1, 2]]
        [[sources]]
        to = "a.u2"
        kind = "hold"
        points = [[0, 0], [0.4, 3]]
        [[sources]]
        to = "a.i_in"
        kind = "hold"
        points = [[0, 0], [0.4, 3]]
    "#;
    let units = Units::new();
    let check = |rows: usize| {
        every_algorithm(&units, scenario, |algorithm, results| {
            let jacobi = sees(algorithm) == Sees::Begin;
            assert_eq!(results.times(), &[0.0, 0.4, 0.8, 1.0][..rows]);
            // 1 + 0.4 / 0.5 is exactly representable up to one rounding of the quotient.
            let y1 = match jacobi {
                // The mean of both ends, whatever is seen of other units.
                _ if orchestrator::along(algorithm) => [1.0, 1.4, 1.9, 2.0],
                true => [1.0, 1.0, 1.8, 2.0],
                false => [1.0, 1.8, 2.0, 2.0],
            };
            assert_eq!(series(results, "a.y1"), &y1[..rows]);
            let i_out = if jacobi { [1.0, 1.0, 4.0, 4.0] } else { [1.0, 4.0, 4.0, 4.0] };
            assert_eq!(series(results, "a.i_out"), &i_out[..rows]);
            // What jumps is no line, whatever the type.
            assert_eq!(series(results, "a.y2"), i_out.map(|out| out - 1.0).get(..rows).expect("as many"));
        });
        let scenario = Scenario::parse(scenario, "test.toml").expect("a scenario");
        Simulation::new(&scenario, &units.unit_path()).expect("builds").notices()
    };
    let off = "unit a: its interval of 2/5 s does not divide the run up to 1 s: its last";
    assert_eq!(check(4), [format!("{off} step has 1/5 s")]);
    let fixed = common::description(common::FEEDTHROUGH)
        .replace("canHandleVariableCommunicationStepSize=\"true\"", "");
    units.pack("feedthrough.fmu", &fixed, &common::library());
    assert_eq!(check(3), [format!("{off} point lies 1/5 s before the stop, since its steps can't differ")]);
}

#[test]
fn every_algorithm_reads_decimals_that_a_float_printed() {
    // 1/600 and 1/30 as Python prints them: read as decimals they would have no common tick, and no row at the stop.
    let scenario = RATES.replace("0.001", "0.0016666666666666668").replace("\"1/30\"", "0.03333333333333333");
    every_algorithm(&Units::new(), &scenario, |_, results| {
        assert_eq!(results.times()[1], 1.0 / 600.0);
        assert_eq!(results.times().last(), Some(&0.5));
        assert_eq!(
            *series(results, "fast.y2").last().expect("rows"),
            1.0 / 600.0,
            "the last step is a whole one"
        );
    });
    let mut scenario = Scenario::parse(&scenario, "test.toml").expect("a scenario");
    scenario.set_stop("0.3333333333333333").expect("a time");
    let simulation = Simulation::new(&scenario, &Units::new().unit_path()).expect("builds");
    let notices: Vec<String> = simulation.notices();
    for expected in [
        "test.toml:7: interval = 0.0016666666666666668 is read as 1/600",
        "test.toml:17: interval = 0.03333333333333333 is read as 1/30",
        "stop = 0.3333333333333333 is read as 1/3",
    ] {
        assert!(notices.iter().any(|notice| notice == expected), "{expected}\n{notices:#?}");
    }
}

#[test]
fn every_algorithm_ends_at_a_stop_between_two_points() {
    // 0.55 s are eleven steps of 1/20 s; the row at the stop is the last one.
    let scenario = RATES.replace("0.001", "\"1/20\"").replace("\"1/2\"", "0.55");
    every_algorithm(&Units::new(), &scenario, |_, results| {
        let last = results.times().len() - 1;
        assert_eq!(results.times()[last], 0.55);
        // The clock adds begin and size, each rounded once.
        assert!((series(results, "fast.y1")[last] - 0.55).abs() <= 1.2e-16);
        assert!(results.times()[last - 1] < 0.55);
    });
}

#[test]
fn law_progress_is_told_and_may_end_the_run() {
    struct Watch(Vec<f64>);
    impl Progress for Watch {
        fn begin(&mut self, start: f64, stop: f64) {
            self.0.extend([start, stop]);
        }
        fn at(&mut self, time: f64, factor: f64) -> ControlFlow<()> {
            assert!(factor > 0.0);
            self.0.push(time);
            if self.0.len() < 5 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        }
        fn end(&mut self, time: f64, _: f64) {
            self.0.push(time);
        }
    }
    let units = Units::new();
    let mut scenario = Scenario::parse(RATES, "test.toml").expect("a scenario");
    assert!(scenario.set_stop("soon").is_err() && scenario.set_stop("-1").is_err());
    scenario.set_stop("20/2").expect("a time");
    let mut simulation = Simulation::new(&scenario, &units.unit_path()).expect("builds");
    let (mut watch, mut results) = (Watch(Vec::new()), MemoryRecorder::new());
    let ended = simulation.run(&mut results, &mut watch).expect("runs");
    let last = *results.times().last().expect("rows");
    assert_eq!(ended, Ended::Interrupted { time: last });
    assert_eq!(watch.0[..2], [0.0, 10.0]);
    assert_eq!(watch.0[4..], [last, last]);
    assert_eq!(simulation.run(&mut results, &mut Quiet).expect("runs again"), Ended::AtStop);
    assert_eq!(results.times().last(), Some(&10.0));
}
