//! What happens to values on their way: probe units stamp what they send with the time at which they send it.

use crate::common;

use crate::common::Units;
use orchestrator::{CsvRecorder, MemoryRecorder, Quiet, Scenario, Simulation};

fn simulation(scenario: &str, algorithm: &str, units: &Units) -> Simulation {
    let mut scenario = Scenario::parse(scenario, "test.toml").expect("a scenario");
    scenario.algorithm.value = algorithm.into();
    Simulation::new(&scenario, &units.unit_path()).unwrap_or_else(|error| panic!("{error}"))
}

/// Inputs are those at the begin of a step.
fn at_begin(algorithm: &str) -> bool {
    orchestrator::sees(algorithm) == Some(orchestrator::Sees::Begin)
}

/// Runs a scenario with each algorithm.
fn every_algorithm(scenario: &str, mut check: impl FnMut(&str, &MemoryRecorder)) {
    let units = Units::new();
    for algorithm in common::every_rate() {
        let mut results = MemoryRecorder::new();
        simulation(scenario, algorithm, &units).run(&mut results, &mut Quiet).expect("runs");
        check(algorithm, &results);
    }
}

fn bytes(scenario: &str) -> Vec<u8> {
    let mut csv = CsvRecorder::new(Vec::new());
    simulation(scenario, "gauss-seidel", &Units::new()).run(&mut csv, &mut Quiet).expect("runs");
    csv.into_inner()
}

fn series<'a>(results: &'a MemoryRecorder, name: &str) -> &'a [f64] {
    results.series(name).unwrap_or_else(|error| panic!("{error}"))
}

/// A clock `a` and a listener `b`, both with mode 2, so that y1 is the time of the last point.
fn pair(stop: &str, sends: &str, listens: &str, way: &str) -> String {
    format!(
        r#"
        format = 1
        experiment = {{ stop = {stop} }}
        [[units]]
        name = "a"
        fmu = "stateful.fmu"
        interval = {sends}
        set = {{ mode = 2 }}
        [[units]]
        name = "b"
        fmu = "stateful.fmu"
        interval = {listens}
        set = {{ mode = 2, u1 = -1.0 }}
        [[connections]]
        from = "a.y1"
        to = "b.u1"
        {way}
        [record]
        variables = ["b.u1", "b.u1:age"]
        "#
    )
}

/// When each sample came, by the row that shows it first: its stamp and the time in between.
fn transits(results: &MemoryRecorder) -> Vec<(f64, f64)> {
    let (times, stamps) = (results.times(), series(results, "b.u1"));
    let rows = times.iter().zip(stamps).zip(stamps.iter().skip(1).zip(&times[1..]));
    rows.filter(|((_, before), (now, _))| before != now)
        .map(|(_, (stamp, time))| (*stamp, time - stamp))
        .collect()
}

#[test]
fn value_latency_is_what_was_called_delay() {
    let scenario = |key: &str| pair("1", "0.01", "\"1/300\"", &format!("{key} = \"1/60\""));
    let rows = bytes(&scenario("latency"));
    assert!(rows.len() > 5000 && rows == bytes(&scenario("delay")));
}

#[test]
fn every_age_is_the_time_since_the_value_was_sent() {
    // Three rates in a ring, with and without latency: in ticks of 1/3000 s the stamps say when they were sent.
    let scenario = r#"
        format = 1
        experiment = { start = 0.5, stop = 1 }
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
        to = "slow.u1"
        latency = "1/300"
        [[connections]]
        from = "fast.y1"
        to = "middle.u1"
        jitter = 0.002
        drop = 0.3
        [record]
        variables = ["*u1", "*u1:age"]
    "#;
    every_algorithm(scenario, |algorithm, results| {
        // Along a line a direct value is none that was sent.
        let stamped = |input: &&str| !(orchestrator::along(algorithm) && *input == "fast.u1");
        for input in ["fast.u1", "slow.u1", "middle.u1"].into_iter().filter(stamped) {
            let (stamps, ages) = (series(results, input), series(results, &format!("{input}:age")));
            let mut most = 0.0f64;
            for ((time, stamp), age) in results.times().iter().zip(stamps).zip(ages) {
                // A stamp of the start is 0 by the fixture, and a value that was never sent has the age of the start.
                let sent = if *stamp == 0.0 { 0.5 } else { *stamp };
                // Time, stamp and age are each rounded once, below 1 s.
                assert!((time - sent - age).abs() <= 2.3e-16, "{algorithm} {input} {time} {stamp} {age}");
                most = most.max(*age);
            }
            assert!(most > 0.0);
        }
    });
    let units = Units::new();
    let mut simulation = simulation(scenario, "jacobi", &units);
    simulation.advance_to(0.75).expect("steps");
    let (stamp, age) =
        (simulation.value("fast.u1").expect("one"), simulation.value("fast.u1:age").expect("one"));
    assert!((0.75 - stamp - age).abs() <= 2.3e-16, "{stamp} {age}");
    simulation.stop_when("fast.u1:age", orchestrator::Comparison::Above, 0.03).expect("recorded");
    let ended = simulation.run(&mut MemoryRecorder::new(), &mut Quiet).expect("runs");
    assert!(
        matches!(ended, orchestrator::Ended::When { time, .. } if time > 0.53 && time < 0.54),
        "{ended:?}"
    );
}

#[test]
fn every_recorded_age_leaves_the_values_as_they_were() {
    let with = pair("1", "0.03", "0.02", "");
    let without = with.replace(", \"b.u1:age\"", "");
    let units = Units::new();
    for algorithm in common::every_rate() {
        let run = |scenario: &str| {
            let mut results = MemoryRecorder::new();
            simulation(scenario, algorithm, &units).run(&mut results, &mut Quiet).expect("runs");
            series(&results, "b.u1").to_vec()
        };
        assert_eq!(run(&with), run(&without), "{algorithm}");
    }
}

#[test]
fn law_jitter_has_the_mean_and_deviation_that_were_asked_for() {
    // 500 samples so far apart that none overtakes another; seen each 1/2 ms.
    let scenario = pair("100", "0.2", "0.0005", "latency = 0.05\njitter = 0.01");
    every_algorithm(&scenario, |algorithm, results| {
        let mut transits: Vec<f64> = transits(results).into_iter().map(|(_, transit)| transit).collect();
        assert!(transits.len() >= 498, "{algorithm}: {}", transits.len());
        transits.remove(0); // from the start value
        let count = transits.len() as f64;
        let mean = transits.iter().sum::<f64>() / count;
        let sd = (transits.iter().map(|transit| (transit - mean).powi(2)).sum::<f64>() / count).sqrt();
        // Seen 1/4 ms late on average, with Jacobi a step of 1/2 ms more; four standard errors.
        let late = if at_begin(algorithm) { 0.00075 } else { 0.00025 };
        assert!((mean - 0.05 - late).abs() < 4.0 * 0.01 / count.sqrt(), "{algorithm}: {mean}");
        assert!((sd - 0.01).abs() < 4.0 * 0.01 / (2.0 * count).sqrt(), "{algorithm}: {sd}");
    });
}

#[test]
fn law_what_was_overtaken_changes_nothing() {
    // Sent each millisecond with a deviation of five: most are overtaken.
    every_algorithm(&pair("4", "0.001", "0.001", "latency = 0.02\njitter = 0.005"), |algorithm, results| {
        let stamps = series(results, "b.u1");
        assert!(stamps.windows(2).all(|pair| pair[0] <= pair[1]), "{algorithm}");
        let seen = transits(results).len();
        assert!((500..2500).contains(&seen), "{algorithm}: {seen} of 4000");
    });
}

#[test]
fn law_a_share_of_the_samples_is_lost() {
    every_algorithm(&pair("20", "0.005", "0.005", "drop = 0.3"), |algorithm, results| {
        // Nothing is late: what came, came at once. The start's stamp is the first one.
        let late = if at_begin(algorithm) { 0.005 } else { 0.0 };
        let transits = transits(results);
        for (stamp, transit) in &transits {
            assert!((transit - late).abs() < 1e-12, "{algorithm}: {stamp} after {transit}");
        }
        let share = transits.len() as f64 / 4000.0;
        // Five standard errors.
        assert!((share - 0.7).abs() < 5.0 * (0.21f64 / 4000.0).sqrt(), "{algorithm}: {share}");
    });
    every_algorithm(&pair("1", "0.01", "0.01", "drop = 1"), |algorithm, results| {
        assert!(series(results, "b.u1").iter().all(|value| *value == -1.0), "{algorithm}");
        // Exactly a hundredth each, correctly rounded, as the times are.
        assert_eq!(series(results, "b.u1:age"), results.times(), "{algorithm}");
    });
}

#[test]
fn law_chance_is_by_seed_connection_and_sample() {
    let way = "latency = 0.02\njitter = 0.01\ndrop = 0.1";
    let plain = pair("2", "0.01", "0.01", way);
    let first = bytes(&plain);
    assert!(bytes(&plain) == first, "again");
    assert!(bytes(&plain.replace("stop = 2", "stop = 2, seed = 0")) == first, "none is zero");
    let other = bytes(&plain.replace("stop = 2", "stop = 2, seed = 1"));
    assert!(other != first, "another seed");
    assert!(bytes(&plain.replace("drop = 0.1", "drop = 0.1\nseed = 1")) == other, "of the connection alone");
    // Another connection before it, with chance of its own.
    let more = format!("[[connections]]\nfrom = \"b.y1\"\nto = \"a.u2\"\n{way}\n[record]");
    let (before, after) = plain.split_once("[[connections]]").expect("one");
    let ordered = format!("{before}{}\n[[connections]]{after}", more.replace("[record]", ""));
    assert!(bytes(&ordered) == first, "whatever stands beside it");
    assert!(bytes(&ordered.replace("u1", "u2").replace("\"a.u2\"", "\"a.u1\"")) != first, "by its input");
}

#[test]
fn every_linear_hold_goes_on_along_the_line() {
    // A ramp, sent each 1/8 s: on the line through the newest two it is exact from the second sample on.
    for latency in ["0", "0.25"] {
        let way = format!("latency = {latency}\nhold = \"linear\"");
        let late: f64 = latency.parse().expect("a number");
        every_algorithm(&pair("2", "0.125", "0.015625", &way), |algorithm, results| {
            let step = if at_begin(algorithm) { 0.015625 } else { 0.0 };
            let second = 0.125 + late + step;
            let rows = results.times().iter().zip(series(results, "b.u1"));
            for (time, value) in rows.filter(|(time, _)| **time >= second) {
                assert_eq!(*value, time - late - step, "{algorithm} {latency}");
            }
            let first = series(results, "b.u1")[..8].to_vec();
            assert!(first.iter().all(|v| *v == if late > 0.0 { -1.0 } else { 0.0 }), "{algorithm} {first:?}");
        });
    }
    // Where samples come late or never the line goes on from the newest two that came.
    let way = "latency = 0.25\njitter = 0.0625\ndrop = 0.5\nhold = \"linear\"";
    every_algorithm(&pair("8", "0.125", "0.015625", way), |algorithm, results| {
        let step = if at_begin(algorithm) { 0.015625 } else { 0.0 };
        let exact = results.times().iter().zip(series(results, "b.u1"));
        let exact = exact.filter(|(time, value)| **time - 0.25 - step == **value).count();
        assert!(exact > results.times().len() * 3 / 4, "{algorithm}: {exact}");
    });
}

#[test]
fn every_offset_shifts_the_points_of_a_unit() {
    let scenario = |stop: &str| {
        pair(stop, "0.25", "0.5", "")
            .replacen("interval = 0.5", "interval = 0.5\noffset = 0.125", 1)
            .replace("variables = [", "variables = [\"b.y1\", \"b.y2\", ")
    };
    every_algorithm(&scenario("1.5"), |algorithm, results| {
        assert_eq!(results.times(), [0.0, 0.125, 0.25, 0.5, 0.625, 0.75, 1.0, 1.125, 1.25, 1.5]);
        assert_eq!(
            series(results, "b.y1"),
            [0.0, 0.125, 0.125, 0.125, 0.625, 0.625, 0.625, 1.125, 1.125, 1.5]
        );
        // The first and the last step are shorter.
        assert_eq!(series(results, "b.y2"), [0.0, 0.125, 0.125, 0.125, 0.5, 0.5, 0.5, 0.5, 0.5, 0.375]);
        let seen: &[f64] = match at_begin(algorithm) {
            // In the middle of the step, on the line through the last two points of the clock.
            true if orchestrator::along(algorithm) => {
                &[0.0, 0.0, 0.0, 0.0, 0.0, 0.875, 0.875, 0.875, 1.3125, 1.3125]
            }
            false if orchestrator::along(algorithm) => {
                &[0.0, 0.0, 0.0, 0.0, 0.375, 0.375, 0.375, 0.875, 0.875, 1.3125]
            }
            true => &[0.0, 0.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.5, 1.0, 1.0],
            false => &[0.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.5, 1.0, 1.0, 1.5],
        };
        assert_eq!(series(results, "b.u1"), seen, "{algorithm}");
    });
    every_algorithm(&scenario("0.0625"), |algorithm, results| {
        assert_eq!(results.times(), [0.0, 0.0625], "{algorithm}");
        assert_eq!(series(results, "b.y2")[1], 0.0625, "{algorithm}: its points begin after the stop");
    });
    let units = Units::new();
    let notices = simulation(&scenario("1.5"), "jacobi", &units).notices();
    let expected = "unit b: its interval of 1/2 s from 1/8 s on does not divide the run up to 3/2 s: its last step has 3/8 s";
    assert_eq!(notices.iter().filter(|notice| *notice == expected).count(), 1, "{notices:?}");
    let fixed =
        common::description(common::STATEFUL).replace("canHandleVariableCommunicationStepSize=\"true\"", "");
    units.pack("stateful.fmu", &fixed, &common::library());
    let text = Scenario::parse(&scenario("1.5"), "test.toml").expect("a scenario");
    let error = Simulation::new(&text, &units.unit_path()).err().expect("refused");
    assert!(
        error.is_input() && error.to_string().starts_with("test.toml:13: offset = 1/8 of unit b: "),
        "{error}"
    );
}

#[test]
fn every_way_comes_back_from_the_resolved_scenario() {
    let way = "latency = \"1/60\"\njitter = 0.01\ndrop = 0.1\nhold = \"linear\"\nseed = 5";
    let scenario =
        pair("1", "0.01", "0.02", way).replacen("interval = 0.02", "interval = 0.02\noffset = \"1/300\"", 1);
    let units = Units::new();
    let resolved =
        simulation(&scenario.replace("stop = 1", "stop = 1, seed = 3"), "gauss-seidel", &units).resolved();
    for line in [
        "seed = 3",
        "offset = \"1/300\"",
        "latency = \"1/60\"",
        "jitter = \"1/100\"",
        "drop = 0.1",
        "hold = \"linear\"",
        "seed = 5",
    ] {
        assert!(resolved.lines().any(|known| known == line), "{line}\n{resolved}");
    }
    assert!(bytes(&scenario) == bytes(&resolved.replace("seed = 3\n", "")));
    let plain = simulation(&pair("1", "0.01", "0.02", ""), "gauss-seidel", &units).resolved();
    for key in ["seed", "offset", "latency", "jitter", "drop", "hold", "gain", "bias", "convert_units", "map"]
    {
        assert!(!plain.lines().any(|line| line.starts_with(key)), "{key}\n{plain}");
    }
}

#[test]
fn value_truths_arrive_as_truths() {
    let scenario =
        pair("0.5", "0.125", "0.125", "").replace("a.y1", "a.b_out").replace("b.u1\"\n", "b.b_in\"\n");
    let scenario =
        scenario.replace(r#"variables = ["b.u1", "b.u1:age"]"#, r#"variables = ["b.b_in", "b.b_out"]"#);
    every_algorithm(&scenario, |algorithm, results| {
        // The sender's input is false, so it sends true, which the listener turns into false.
        assert_eq!(series(results, "b.b_in"), [1.0; 5], "{algorithm}");
        assert_eq!(series(results, "b.b_out"), [0.0; 5], "{algorithm}");
    });
}

#[test]
fn law_many_values_may_be_under_way() {
    // 200 at a time: 0.2 s at one a ms.
    let scenario = pair("1", "0.001", "0.001", "latency = 0.2");
    every_algorithm(&scenario, |algorithm, results| {
        let seen = series(results, "b.u1");
        // At the begin of the last step, or at its end; the clock's own sum is rounded once.
        let expected = if at_begin(algorithm) { 0.799 } else { 0.8 };
        assert!((seen[1000] - expected).abs() <= 2.3e-16, "{algorithm}: {}", seen[1000]);
    });
}
