//! What single algorithms promise: an order that follows from the units, threads that change no bit, lines of second order.

use crate::common;

use crate::common::{FEEDTHROUGH, Fixture, STATEFUL, Units, description};
use orchestrator::{CsvRecorder, MemoryRecorder, Quiet, Scenario, Simulation};

fn simulation(text: &str, algorithm: &str, units: &Units) -> Simulation {
    let mut scenario = Scenario::parse(text, "test.toml").expect("a scenario");
    scenario.algorithm.value = algorithm.into();
    Simulation::new(&scenario, &units.unit_path()).unwrap_or_else(|error| panic!("{algorithm}: {error}"))
}

fn results(text: &str, algorithm: &str, units: &Units) -> MemoryRecorder {
    let mut results = MemoryRecorder::new();
    simulation(text, algorithm, units).run(&mut results, &mut Quiet).expect("runs");
    results
}

fn series<'a>(results: &'a MemoryRecorder, name: &str) -> &'a [f64] {
    results.series(name).unwrap_or_else(|error| panic!("{error}"))
}

/// A plant `x`, and a chain of gains that measures it, filters it and answers: written backwards.
const CHAIN: [&str; 4] = [
    "[[units]]\nname = \"answer\"\nfmu = \"feedthrough.fmu\"\ninterval = 0.125\nset = { mode = 1, k = -1 }\n",
    "[[units]]\nname = \"filter\"\nfmu = \"feedthrough.fmu\"\ninterval = 0.125\nset = { mode = 1, k = 0.5 }\n",
    "[[units]]\nname = \"measure\"\nfmu = \"feedthrough.fmu\"\ninterval = 0.125\nset = { mode = 1, k = 2 }\n",
    "[[units]]\nname = \"x\"\nfmu = \"stateful.fmu\"\ninterval = 0.125\nset = { x0 = 1 }\n",
];

fn chain(order: [usize; 4]) -> String {
    let mut text = "format = 1\nexperiment = { stop = 2 }\n".to_owned();
    order.iter().for_each(|unit| text += CHAIN[*unit]);
    for (from, to) in [("x", "measure"), ("measure", "filter"), ("filter", "answer"), ("answer", "x")] {
        text += &format!("[[connections]]\nfrom = \"{from}.y1\"\nto = \"{to}.u1\"\n");
    }
    text
}

#[test]
fn law_a_derived_order_is_the_same_however_the_scenario_is_written() {
    let units = Units::new();
    let right = results(&chain([3, 2, 1, 0]), "gauss-seidel", &units);
    for order in [[0, 1, 2, 3], [3, 2, 1, 0], [1, 3, 0, 2], [2, 0, 3, 1]] {
        let text = chain(order);
        let names = ["answer", "filter", "measure", "x"];
        let simulation = simulation(&text, "derived-order", &units);
        let stepped: Vec<&str> = simulation.order().iter().map(|unit| names[order[*unit]]).collect();
        assert_eq!(stepped, ["x", "measure", "filter", "answer"], "{order:?}");
        let derived = results(&text, "derived-order", &units);
        assert_eq!(series(&derived, "x.y1"), series(&right, "x.y1"), "{order:?}");
        // The budget knows it, too: measured, filtered and answered in the instant, used over the next step.
        let (loops, _) = orchestrator::timing::budget_of(&simulation, 9).expect("ticks");
        // Four units of one rate: each holds half a step and is given the end of it; only the plant misses an instant.
        assert!((loops[0].terms().total() + 4.0 * 0.125 / 2.0 - 0.125).abs() < 1e-12, "{}", loops[0]);
    }
    // As written, each unit of the chain is a step late.
    assert_ne!(
        series(&results(&chain([0, 1, 2, 3]), "gauss-seidel", &units), "x.y1"),
        series(&right, "x.y1")
    );
}

#[test]
fn law_a_loop_of_feedthrough_steps_as_it_is_written() {
    let units = Units::new();
    let text = chain([1, 0, 2, 3])
        .replace("name = \"x\"\nfmu = \"stateful.fmu\"", "name = \"x\"\nfmu = \"feedthrough.fmu\"");
    assert_eq!(simulation(&text, "derived-order", &units).order(), [0, 1, 2, 3]);
    // What takes time on its way ties nothing.
    let late = text.replace("from = \"answer.y1\"", "latency = 0.125\nfrom = \"answer.y1\"");
    assert_eq!(simulation(&late, "derived-order", &units).order(), [3, 2, 0, 1]);
}

/// Units of all types at three rates, one of which misbehaves after a while.
fn mixed(fault: i32, threads: usize) -> String {
    let mut text =
        format!("format = 1\nexperiment = {{ stop = 0.5, options = {{ threads = {threads} }} }}\n");
    for unit in 0..12 {
        let fault = if unit == 5 { fault } else { 0 };
        let (interval, x0) = ([0.001, 0.005, 0.0025][unit % 3], unit as f64 / 8.0);
        text += &format!(
            "[[units]]\nname = \"u{unit}\"\nfmu = \"stateful.fmu\"\ninterval = {interval}\nset = {{ x0 = {x0}, s_in = \"{unit}\", \
             fault = {fault}, fault_time = 0.25 }}\n"
        );
    }
    for unit in 0..12 {
        let (next, other) = ((unit + 5) % 12, (unit + 7) % 12);
        text += &format!("[[connections]]\nfrom = \"u{unit}.y1\"\nto = \"u{next}.u1\"\n");
        text += &format!("[[connections]]\nfrom = \"u{unit}.y2\"\nto = \"u{other}.u2\"\nlatency = 0.005\n");
        for kind in ["i", "b", "s"] {
            text += &format!("[[connections]]\nfrom = \"u{unit}.{kind}_out\"\nto = \"u{next}.{kind}_in\"\n");
        }
    }
    text
}

#[test]
fn every_number_of_threads_gives_the_bits_of_jacobi() {
    let units = Units::new();
    // All well; a step that is an error; one with a warning; one after which the unit wants to end; one that is no number.
    for fault in [0, 3, 1, 15, 7] {
        let told = |algorithm: &str, threads: usize| {
            let text = mixed(fault, threads);
            let text =
                if algorithm == "jacobi" { text.replace(", options = { threads = 0 }", "") } else { text };
            let mut simulation = simulation(&text, algorithm, &units);
            let run = |simulation: &mut Simulation| {
                let mut csv = CsvRecorder::new(Vec::new());
                let ended = simulation.run(&mut csv, &mut Quiet).map_err(|error| error.to_string());
                (csv.into_inner(), ended, simulation.notices())
            };
            let first = run(&mut simulation);
            assert!(run(&mut simulation) == first, "again");
            first
        };
        let (rows, ended, notices) = told("jacobi", 0);
        assert!(rows.len() > 10_000, "{}", rows.len());
        for threads in [1, 2, 3, 8] {
            let found = told("parallel-jacobi", threads);
            assert!(found.0 == rows, "fault {fault}, {threads} threads");
            assert_eq!(
                (found.1, found.2),
                (ended.clone(), notices.clone()),
                "fault {fault}, {threads} threads"
            );
        }
    }
}

/// x' = v, v' = -x from x = 1; how far x is off at 4 s.
fn oscillator(algorithm: &str, interval: f64, units: &Units) -> f64 {
    let text = format!(
        "format = 1\nexperiment = {{ stop = 4 }}\n\
         [[units]]\nname = \"x\"\nfmu = \"stateful.fmu\"\ninterval = {interval}\nset = {{ x0 = 1 }}\n\
         [[units]]\nname = \"v\"\nfmu = \"stateful.fmu\"\ninterval = {interval}\nset = {{ k = -1 }}\n\
         [[connections]]\nfrom = \"v.y1\"\nto = \"x.u1\"\n[[connections]]\nfrom = \"x.y1\"\nto = \"v.u1\"\n"
    );
    let results = results(&text, algorithm, units);
    (series(&results, "x.y1").last().expect("rows") - 4.0f64.cos()).abs()
}

#[test]
fn value_lines_make_the_coupling_one_of_second_order() {
    let (held, lines) = (Units::new(), Units::new());
    let flags = "modelIdentifier=\"unit\" canInterpolateInputs=\"true\" maxOutputDerivativeOrder=\"1\"";
    let with = |fixture: Fixture| description(fixture).replace("modelIdentifier=\"unit\"", flags);
    lines.pack("stateful.fmu", &with(STATEFUL), &common::compile("lines.c"));
    for units in [&held, &lines] {
        // Halving the step halves the error of a scheme of first order and quarters that of one of second; the next order is a
        // tenth of it at these steps.
        let ratio = |algorithm: &str| {
            oscillator(algorithm, 1.0 / 32.0, units) / oscillator(algorithm, 1.0 / 64.0, units)
        };
        assert!((ratio("jacobi") - 2.0).abs() < 0.3, "{}", ratio("jacobi"));
        for algorithm in ["extrapolated", "interpolated"] {
            assert!((ratio(algorithm) - 4.0).abs() < 0.6, "{algorithm}: {}", ratio(algorithm));
        }
    }
    // x + h v - h² x / 2 once the unit tells the slope -x of v: the series of Taylor, worked out beside it.
    let (mut x, mut v, h) = (1.0f64, 0.0f64, 1.0 / 32.0);
    let (mut slope_x, mut slope_v) = (0.0, 0.0);
    for _ in 0..128 {
        let (used_v, used_x) = ((v, slope_v), (x, slope_x));
        x += h * (used_v.0 + used_v.1 * h / 2.0);
        v -= h * (used_x.0 + used_x.1 * h / 2.0);
        (slope_x, slope_v) = (used_v.0 + used_v.1 * h, -(used_x.0 + used_x.1 * h));
    }
    let off = oscillator("extrapolated", h, &lines);
    // 128 steps, each with a few roundings of numbers below one.
    assert!((off - (x - 4.0f64.cos()).abs()).abs() < 1e-13, "{off}");
}

/// The same with a law in between, F = -x: how far x is off at 4 s.
fn controlled(law: &str, algorithm: &str, interval: f64, units: &Units) -> f64 {
    let text = format!(
        "format = 1\nexperiment = {{ stop = 4 }}\n\
         [[units]]\nname = \"x\"\nfmu = \"stateful.fmu\"\ninterval = {interval}\nset = {{ x0 = 1 }}\n\
         [[units]]\nname = \"law\"\nfmu = \"{law}\"\ninterval = {law_interval}\nset = {{ mode = 1, k = -1 }}\n\
         [[units]]\nname = \"v\"\nfmu = \"stateful.fmu\"\ninterval = {interval}\n\
         [[connections]]\nfrom = \"v.y1\"\nto = \"x.u1\"\n[[connections]]\nfrom = \"x.y1\"\nto = \"law.u1\"\n\
         [[connections]]\nfrom = \"law.y1\"\nto = \"v.u1\"\n",
        law_interval = 2.0 * interval
    );
    let results = results(&text, algorithm, units);
    (series(&results, "x.y1").last().expect("rows") - 4.0f64.cos()).abs()
}

#[test]
fn value_lines_stay_of_second_order_with_a_unit_whose_output_follows_its_input_at_once() {
    let units = Units::new();
    let nothing_said = description(FEEDTHROUGH)
        .replace("<Unknown index=\"3\" dependencies=\"1\"/>", "<Unknown index=\"3\"/>");
    units.pack("silent.fmu", &nothing_said, &common::library());
    let ratio = |law: &str, algorithm: &str| {
        let at = |steps: f64| controlled(law, algorithm, 1.0 / steps, &units);
        at(64.0) / at(128.0)
    };
    for algorithm in ["extrapolated", "interpolated"] {
        // As above: 4 with the next order a tenth of it; a law that is half a step late makes it 2.
        let found = ratio("feedthrough.fmu", algorithm);
        assert!((found - 4.0).abs() < 0.6, "{algorithm}: {found}");
        // Nothing is said of its outputs: taken as one of states, in the middle of the step. `docs/scenario.md` says so.
        let found = ratio("silent.fmu", algorithm);
        assert!((found - 2.0).abs() < 0.3, "{algorithm}, nothing said: {found}");
    }
}

#[test]
fn value_what_follows_a_source_at_once_is_that_of_the_row() {
    let units = Units::new();
    for (unit, record, expected) in [
        ("feedthrough.fmu", "", [0.0, 0.5, 1.0, 1.5, 2.0]),
        // No other unit gets it: its input is that of the middle, as for a state.
        ("feedthrough.fmu", "alone", [0.0, 0.25, 0.75, 1.25, 1.75]),
    ] {
        let mut text = format!(
            "format = 1\nexperiment = {{ stop = 1 }}\n[[units]]\nname = \"a\"\nfmu = \"{unit}\"\ninterval = 0.25\nset = {{ mode = 1 }}\n\
             [[units]]\nname = \"b\"\nfmu = \"stateful.fmu\"\ninterval = 0.25\n\
             [[sources]]\nto = \"a.u1\"\nkind = \"linear\"\npoints = [[0.0, 0.0], [1.0, 2.0]]\n"
        );
        if record.is_empty() {
            text += "[[connections]]\nfrom = \"a.y1\"\nto = \"b.u1\"\n";
        }
        for algorithm in ["extrapolated", "interpolated"] {
            let results = results(&text, algorithm, &units);
            for name in ["a.u1", "a.y1"] {
                assert_eq!(series(&results, name), expected, "{algorithm}, {record}: {name}");
            }
        }
    }
}

#[test]
fn every_line_leaves_what_does_not_vary_continuously() {
    let units = Units::new();
    let discrete = description(FEEDTHROUGH).replace(
        "name=\"y1\" valueReference=\"2\" causality=\"output\"",
        "name=\"y1\" valueReference=\"2\" causality=\"output\" variability=\"discrete\"",
    );
    units.pack("discrete.fmu", &discrete, &common::library());
    let text = |unit: &str| {
        format!(
            "format = 1\nexperiment = {{ stop = 1 }}\n[[units]]\nname = \"a\"\nfmu = \"{unit}\"\ninterval = 0.25\nset = {{ mode = 2 }}\n\
             [[units]]\nname = \"b\"\nfmu = \"stateful.fmu\"\ninterval = 0.25\n[[connections]]\nfrom = \"a.y1\"\nto = \"b.u1\"\n"
        )
    };
    let seen =
        |unit: &str, algorithm: &str| series(&results(&text(unit), algorithm, &units), "b.u1").to_vec();
    assert_eq!(seen("discrete.fmu", "extrapolated"), seen("discrete.fmu", "jacobi"));
    assert_eq!(seen("discrete.fmu", "interpolated"), seen("discrete.fmu", "gauss-seidel"));
    // A clock: in the middle of the step that begins there, from the second point on.
    assert_eq!(seen("stateful.fmu", "extrapolated"), [0.0, 0.0, 0.375, 0.625, 0.875]);
    assert_eq!(seen("stateful.fmu", "interpolated"), [0.0, 0.125, 0.375, 0.625, 0.875]);
}
