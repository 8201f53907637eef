//! How late a loop is, by its table and by what it does to an oscillation.

use crate::common;

use crate::common::Units;
use orchestrator::{MemoryRecorder, Quiet, Scenario, Simulation};

#[test]
fn cross_the_budget_of_a_loop_is_how_its_oscillation_grows() {
    let units = Units::new();
    // x' = v, v' = -x; with a small delay T once round the energy goes as e^(T t).
    for (slow, way) in [
        ("0.01", ""),
        ("0.04", ""),
        ("0.01", "latency = 0.02"),
        ("0.03", "latency = 0.005"),
        ("0.02", "hold = \"linear\""),
        ("0.01", "latency = 0.02\njitter = 0.02\ndrop = 0.2"),
    ] {
        let text = format!(
            r#"
            format = 1
            experiment = {{ stop = 24 }}
            [[units]]
            name = "x"
            fmu = "stateful.fmu"
            interval = 0.01
            set = {{ x0 = 1 }}
            [[units]]
            name = "v"
            fmu = "stateful.fmu"
            interval = {slow}
            set = {{ k = -1 }}
            [[connections]]
            from = "v.y1"
            to = "x.u1"
            {way}
            [[connections]]
            from = "x.y1"
            to = "v.u1"
            "#
        );
        for algorithm in common::every_rate() {
            let mut scenario = Scenario::parse(&text, "test.toml").expect("a scenario");
            scenario.algorithm.value = algorithm.into();
            let mut results = MemoryRecorder::new();
            let run = &mut Simulation::new(&scenario, &units.unit_path()).expect("a simulation");
            run.run(&mut results, &mut Quiet).expect("runs");
            let series = |name: &str| results.series(name).expect("it is recorded");
            let (loops, more) = orchestrator::timing::budget(&scenario, 9).expect("ticks");
            assert!(loops.len() == 1 && !more);
            let energies = series("x.y1").iter().zip(series("v.y1"));
            let energies: Vec<f64> = energies.map(|(x, v)| x * x + v * v).collect();
            // Over whole turns, in which what the energy does within one cancels.
            let turn = |from: f64| {
                let rows = results.times().iter().zip(&energies);
                let rows = rows.filter(|(t, _)| **t >= from && **t < from + std::f64::consts::TAU);
                let (sum, count) = rows.fold((0.0, 0.0), |(sum, n), (_, energy)| (sum + energy, n + 1.0));
                sum / count
            };
            let grown = (turn(17.0) / turn(1.0)).ln() / 16.0;
            let expected = loops[0].terms().total();
            // The next order of the delay; jitter and losses scatter: some thousand draws of 0.02 s over 16 s.
            let within = if way.contains("jitter") { 0.006 } else { 0.0025 };
            assert!((grown - expected).abs() < within, "{algorithm} {slow} {way:?}: {grown}, not {expected}");
        }
    }
}

#[test]
fn value_a_unit_that_drives_itself_is_a_step_late_where_its_own_value_comes_too_late() {
    // Where units step one after the other and see what others have just sent, its own value of the same instant is not there
    // yet: it is one step old in the middle, as under the algorithm that sees the begin of a step only.
    let text = "format = 1\nexperiment = { stop = 1 }\n[[units]]\nname = \"a\"\nfmu = \"stateful.fmu\"\ninterval = 0.125\n\
                set = { k = -1, x0 = 1 }\n[[connections]]\nfrom = \"a.y1\"\nto = \"a.u1\"\n";
    let units = Units::new();
    let of = |algorithm: &str| {
        let mut scenario = Scenario::parse(text, "test.toml").expect("a scenario");
        scenario.algorithm.value = algorithm.into();
        let mut results = MemoryRecorder::new();
        Simulation::new(&scenario, &units.unit_path())
            .expect("builds")
            .run(&mut results, &mut Quiet)
            .expect("runs");
        let (loops, _) = orchestrator::timing::budget(&scenario, 9).expect("ticks");
        (loops[0].terms().total(), results.series("a.y1").expect("recorded").to_vec())
    };
    let (jacobi, begin) = of("jacobi");
    let (seidel, end) = of("gauss-seidel");
    // Both take the same steps, so both are as late.
    assert_eq!(begin, end);
    assert_eq!(jacobi, seidel);
    // x' = -x held over a step: (1 - h) each.
    assert!((begin[8] - 0.875_f64.powi(8)).abs() < 1e-15, "{}", begin[8]);
}
