//! Algorithms that take steps back: what they converge to, what they refuse, and that they go on from saved states.

use crate::common;

use crate::common::Units;
use orchestrator::{Ended, Error, MemoryRecorder, Quiet, Scenario, Simulation};

/// x' = v, v' = -x.
fn oscillator(experiment: &str, interval: &str) -> String {
    format!(
        r#"
        format = 1
        experiment = {{ {experiment} }}
        [[units]]
        name = "x"
        fmu = "stateful.fmu"
        interval = {interval}
        set = {{ x0 = 1 }}
        [[units]]
        name = "v"
        fmu = "stateful.fmu"
        interval = {interval}
        set = {{ k = -1 }}
        [[connections]]
        from = "v.y1"
        to = "x.u1"
        [[connections]]
        from = "x.y1"
        to = "v.u1"
        "#
    )
}

fn build(units: &Units, text: &str) -> Result<Simulation, Error> {
    Simulation::new(&Scenario::parse(text, "test.toml")?, &units.unit_path())
}

fn run(units: &Units, text: &str) -> Result<Ended, Error> {
    build(units, text)?.run(&mut MemoryRecorder::new(), &mut Quiet)
}

fn results(text: &str) -> MemoryRecorder {
    let mut results = MemoryRecorder::new();
    let mut simulation = build(&Units::new(), text).unwrap_or_else(|error| panic!("{error}"));
    simulation.run(&mut results, &mut Quiet).unwrap_or_else(|error| panic!("{error}"));
    results
}

#[test]
fn cross_step_halving_comes_as_near_as_it_is_asked_to() {
    let off = |tolerance: &str| {
        let options =
            format!("stop = 4, algorithm = \"step-halving\", options = {{ tolerance = {tolerance} }}");
        let text =
            oscillator(&options, "0.5") + "[record]\nvariables = [\"x.y1\", \"v.y1\", \"x.y1:error\"]\n";
        let results = results(&text);
        assert_eq!(results.times(), [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0], "the points stay");
        let tolerance: f64 = tolerance.parse().expect("a number");
        let errors = results.series("x.y1:error").expect("recorded");
        assert_eq!(errors[0], 0.0);
        // Relative to the larger of the value and one, and no value is above 1.1.
        assert!(errors[1..].iter().all(|e| *e > 0.0 && *e <= 1.1 * tolerance), "{errors:?}");
        let rows = results.times().iter().zip(results.series("x.y1").expect("recorded"));
        rows.map(|(t, x)| (x - t.cos()).abs()).fold(0.0, f64::max)
    };
    // A step of h differs from its halves by h²/4, which stays below the tolerance; the halves, Euler steps of h/2, are off by
    // t h/4 after t: at 4 s by twice the root of the tolerance.
    let (coarse, fine) = (off("1e-4"), off("1e-6"));
    assert!(coarse < 0.021 && fine < 0.0021, "{coarse} {fine}");
    // The root of a hundred, and steps are powers of two of each other.
    assert!((4.0..25.0).contains(&(coarse / fine)), "{coarse} {fine}");
    let jacobi = results(&oscillator("stop = 4, algorithm = \"jacobi\"", "0.5"));
    assert!((jacobi.series("x.y1").expect("recorded")[8] - 4.0f64.cos()).abs() > 0.5, "as it was");
}

#[test]
fn law_step_halving_takes_larger_steps_again_where_they_have_a_place() {
    // Halves agree where the source is the same at both begins: not from 0 over 8 or 4 s, but over 2 s. Then nothing stands
    // against 4 s, but these begin at 0 and at 4 s only.
    let text = r#"
        format = 1
        experiment = { stop = 8, algorithm = "step-halving", options = { tolerance = 1e-6, halvings = 2 } }
        [[units]]
        name = "a"
        fmu = "stateful.fmu"
        interval = 8
        [[units]]
        name = "clock"
        fmu = "stateful.fmu"
        interval = 8
        set = { mode = 2 }
        [[connections]]
        from = "a.y1"
        to = "clock.u1"
        [[connections]]
        from = "clock.y1"
        to = "a.u2"
        [[sources]]
        to = "a.u1"
        kind = "hold"
        points = [[0, 0], [2, 1], [8, 1]]
    "#;
    let last = |text: &str| {
        let results = results(text);
        ["a.y1", "clock.y1", "clock.y2"].map(|name| results.series(name).expect("recorded")[1])
    };
    assert_eq!(last(text), [6.0, 8.0, 2.0], "2, 2 and 4 s, each in two halves");
    // From 2 s on the halves are off by 0.25 of 2.25: allowed, but too near to the limit for larger ones to be tried.
    let late = text.replace("[8, 1]", "[3, 1.25], [4, 1], [8, 1]").replace("1e-6", "0.125");
    assert_eq!(last(&late), [6.25, 8.0, 1.0]);
}

#[test]
fn law_values_on_their_way_are_not_seen_earlier_by_halved_steps() {
    // A clock, seen 0.3 s late by steps of 0.25 s: at each begin what was sent two points before.
    let seen = |algorithm: &str| {
        let text = format!(
            r#"
            format = 1
            experiment = {{ stop = 2, algorithm = "{algorithm}" }}
            [[units]]
            name = "clock"
            fmu = "stateful.fmu"
            interval = 0.25
            set = {{ mode = 2 }}
            [[units]]
            name = "b"
            fmu = "stateful.fmu"
            interval = 0.25
            [[connections]]
            from = "clock.y1"
            to = "b.u1"
            latency = 0.3
            "#
        );
        results(&text).series("b.u1").expect("recorded").to_vec()
    };
    assert_eq!(seen("step-halving"), [0.0, 0.0, 0.0, 0.0, 0.25, 0.5, 0.75, 1.0, 1.25]);
    assert_eq!(seen("step-halving"), seen("jacobi"));
}

#[test]
fn every_error_is_found_by_stars() {
    let text = |record: &str| {
        let options = "stop = 1, algorithm = \"step-halving\", options = { tolerance = 1e-4 }";
        oscillator(options, "0.5") + &format!("[record]\nvariables = [{record}]\n")
    };
    let found = results(&text("\"*:error\""));
    let names: Vec<&str> = found.columns().iter().map(|column| column.name.as_str()).collect();
    assert_eq!(names, ["x.y1:error", "x.y2:error", "v.y1:error", "v.y2:error"]);
    let named = results(&text("\"x.y1:error\""));
    assert_eq!(found.series("x.y1:error").expect("recorded"), named.series("x.y1:error").expect("recorded"));
    let all = results(&text("\"*\""));
    assert!(all.columns().iter().all(|column| !column.name.contains(':')), "a star alone means signals");
}

#[test]
fn every_algorithm_goes_on_from_a_saved_state() {
    let units = Units::new();
    for algorithm in orchestrator::algorithms() {
        let text = oscillator(&format!("stop = 3, algorithm = \"{algorithm}\""), "0.25");
        let mut simulation = build(&units, &text).expect("builds");
        simulation.advance_to(1.0).expect("steps");
        let saved = simulation.save().expect("saves");
        let rest = |simulation: &mut Simulation| {
            let mut seen = Vec::new();
            while let Some(time) = simulation.advance().expect("steps") {
                seen.push((time, simulation.value("x.y1").expect("a number").to_bits()));
            }
            seen
        };
        let first = rest(&mut simulation);
        assert_eq!(first.len(), 8);
        let mut other = build(&units, &text).expect("builds");
        other.go_back(&saved).expect("the same");
        assert_eq!(rest(&mut other), first, "{algorithm}");
        assert!(other.run(&mut MemoryRecorder::new(), &mut Quiet).is_ok(), "again");
    }
}

#[test]
fn every_algorithm_makes_a_discarded_step_in_shorter_ones() {
    let units = Units::new();
    for algorithm in orchestrator::algorithms() {
        let text = |retry: &str| {
            format!(
                r#"
                format = 1
                experiment = {{ stop = 1, algorithm = "{algorithm}" }}
                [[units]]
                name = "a"
                fmu = "stateful.fmu"
                interval = 0.25
                {retry}
                set = {{ fault = 23, u1 = 2.0 }}
                "#
            )
        };
        let mut results = MemoryRecorder::new();
        let mut simulation = build(&units, &text("retry = true")).expect("builds");
        simulation.run(&mut results, &mut Quiet).unwrap_or_else(|error| panic!("{algorithm}: {error}"));
        // Steps of 1/64 s: dyadic, so exact, and each counted once.
        assert_eq!(results.series("a.y1").expect("recorded"), [0.0, 0.5, 1.0, 1.5, 2.0], "{algorithm}");
        assert!(results.series("a.y2").expect("recorded")[1] <= 0.03, "{algorithm}");
        let told = simulation.notices().into_iter().filter(|n| n.contains("shorter ones were made")).count();
        assert_eq!(told, 1, "{algorithm}");
        match (algorithm, run(&units, &text(""))) {
            // It halves its steps anyway.
            ("step-halving", ended) => assert!(ended.is_ok()),
            (_, ended) => {
                let error = ended.expect_err("discarded").to_string();
                assert!(error.contains("or `retry = true` of the unit"), "{error}");
            }
        }
    }
}

#[test]
fn law_a_retried_step_grows_again_where_it_has_a_place() {
    // A step that begins before 0.3 s must not be longer than 1/8 s: four of these, of which the third is tried as 1/4 s from
    // 1/4 s on; then from 1/2 s on the rest in one. Each begins where the last one ended.
    let rule = (
        "    (void)no_return;\n",
        "    (void)no_return;\n    if (fabs(from - u->reached) > 1e-12) return 3;\n    if (size > 0.125 && from < 0.3) return 2;\n",
    );
    let units = Units::new();
    units.pack("picky.fmu", &common::description(common::STATEFUL), &common::library_with(&[rule]));
    let text = "format = 1\nexperiment = { stop = 1 }\n[[units]]\nname = \"a\"\nfmu = \"picky.fmu\"\ninterval = 1\nretry = true\n\
                set = { u1 = 2.0 }\n";
    let mut results = MemoryRecorder::new();
    let mut simulation = build(&units, text).expect("builds");
    for _ in 0..2 {
        simulation.run(&mut results, &mut Quiet).unwrap_or_else(|error| panic!("{error}"));
        let last = |name: &str| results.series(name).expect("recorded")[1];
        assert_eq!([last("a.y1"), last("a.y2")], [2.0, 0.5]);
    }
}

#[test]
fn law_kept_states_are_given_back_before_a_unit_is_reset() {
    // As long as there are any, it is neither reset nor instantiated once more.
    let counts = [
        ("API void *fmi2Instantiate(", "static int kept;\nAPI void *fmi2Instantiate("),
        ("    if (type != 1 ||", "    if (kept || type != 1 ||"),
        ("    if (!*state) *state = malloc", "    if (!*state) kept++;\n    if (!*state) *state = malloc"),
        ("    free(*state);\n", "    kept--;\n    free(*state);\n"),
        ("API int fmi2Reset(void *c) { ", "API int fmi2Reset(void *c) { if (kept) return 3; "),
    ];
    let units = Units::new();
    units.pack("stateful.fmu", &common::description(common::STATEFUL), &common::library_with(&counts));
    for algorithm in ["iterated", "step-halving"] {
        let text = format!(
            "format = 1\nexperiment = {{ stop = 1, algorithm = \"{algorithm}\" }}\n\
             [[units]]\nname = \"a\"\nfmu = \"stateful.fmu\"\ninterval = 0.5\n"
        );
        let mut simulation = build(&units, &text).expect("builds");
        for _ in 0..3 {
            let ended = simulation.run(&mut MemoryRecorder::new(), &mut Quiet);
            ended.unwrap_or_else(|error| panic!("{algorithm}: {error}"));
        }
        simulation.reset();
        simulation.initialize().expect("once more");
    }
}

#[test]
fn law_what_a_unit_used_is_what_its_input_was() {
    // Gains in a loop, which settles far from its end: y1 is that of the recorded input to the bit.
    let gain = |name: &str, k: f64| {
        format!(
            "[[units]]\nname = \"{name}\"\nfmu = \"feedthrough.fmu\"\ninterval = 0.25\nset = {{ mode = 1, k = {k}, x0 = 1 }}\n"
        )
    };
    let text = format!(
        "format = 1\nexperiment = {{ stop = 2, algorithm = \"iterated\", options = {{ tolerance = 0.1 }} }}\n{}{}\
         [[connections]]\nfrom = \"a.y1\"\nto = \"b.u1\"\n[[connections]]\nfrom = \"b.y1\"\nto = \"a.u1\"\n\
         [[sources]]\nto = \"a.u2\"\nkind = \"linear\"\npoints = [[0, 0], [2, 2]]\n\
         [[connections]]\nfrom = \"a.y2\"\nto = \"c.u1\"\n[[connections]]\nfrom = \"c.y1\"\nto = \"b.u2\"\n{}",
        gain("a", 0.75),
        gain("b", 0.5),
        gain("c", -0.7)
    );
    let results = results(&text);
    let series = |name: &str| results.series(name).expect("recorded").to_vec();
    for (unit, k) in [("a", 0.75), ("b", 0.5), ("c", -0.7)] {
        let (inputs, outputs) = (series(&format!("{unit}.u1")), series(&format!("{unit}.y1")));
        for (input, output) in inputs.iter().zip(&outputs) {
            assert_eq!(k * input + 1.0, *output, "{unit} {input}");
        }
    }
}

#[test]
fn every_loop_that_does_not_settle_is_told() {
    let units = Units::new();
    // Over a step b adds 40 · 0.25 s · y1, of which a makes -2: no iteration settles.
    let text = r#"
        format = 1
        experiment = { stop = 1, algorithm = "iterated" }
        [[units]]
        name = "a"
        fmu = "feedthrough.fmu"
        interval = 0.25
        set = { mode = 1, k = -2, x0 = 1 }
        [[units]]
        name = "b"
        fmu = "stateful.fmu"
        interval = 0.25
        set = { k = 40 }
        [[connections]]
        from = "a.y1"
        to = "b.u1"
        [[connections]]
        from = "b.y1"
        to = "a.u1"
    "#;
    let error = run(&units, text).expect_err("it grows");
    assert!(error.is_input(), "{error}");
    let told = error.to_string();
    assert!(
        told.contains("at t = 0.25 s: it still changes by ") && told.contains("after 100 iterations"),
        "{told}"
    );
    assert!(told.starts_with("a.u1 ") || told.starts_with("b.u1 "), "an input of the loop: {told}");
    run(&units, &text.replace("k = 40", "k = 0.4")).expect("a contraction");
    let coarse = "stop = 1, algorithm = \"step-halving\", options = { tolerance = 1e-9, halvings = 2 }";
    let told = run(&units, &oscillator(coarse, "0.5")).expect_err("too coarse").to_string();
    assert!(told.starts_with("x.y1 at t = 0 s"), "{told}");
    assert!(told.contains("after 2 halvings of the step, more than the tolerance of 0.000000001"), "{told}");
}

#[test]
fn every_unit_that_cannot_be_taken_back_is_named() {
    let units = Units::new();
    let plain = common::description(common::STATEFUL).replace("canGetAndSetFMUstate=\"true\"", "");
    units.pack("stateful.fmu", &plain, &common::library());
    let message = |text: &str| build(&units, text).err().expect("refused").to_string();
    for algorithm in ["iterated", "step-halving"] {
        let found = message(&oscillator(&format!("stop = 1, algorithm = \"{algorithm}\""), "0.5"));
        let expected = format!(
            "test.toml:4: algorithm \"{algorithm}\" with unit x: a unit that says canGetAndSetFMUstate"
        );
        assert!(found.starts_with(&expected), "{found}");
    }
    let found = message(&oscillator("stop = 1", "0.5\n        retry = true"));
    assert!(
        found.starts_with("test.toml:4: retry = true of unit x: a unit that says canGetAndSetFMUstate"),
        "{found}"
    );
}

#[test]
fn every_unit_whose_steps_cannot_differ_is_named() {
    let units = Units::new();
    let fixed =
        common::description(common::STATEFUL).replace("canHandleVariableCommunicationStepSize=\"true\"", "");
    units.pack("stateful.fmu", &fixed, &common::library());
    let message = |text: &str| build(&units, text).err().expect("refused").to_string();
    let flag = "a unit that says canHandleVariableCommunicationStepSize";
    let found = message(&oscillator("stop = 1, algorithm = \"step-halving\"", "0.5"));
    assert!(
        found.starts_with(&format!("test.toml:4: algorithm \"step-halving\" with unit x: {flag}")),
        "{found}"
    );
    let found = message(&oscillator("stop = 1", "0.5\n        retry = true"));
    assert!(found.starts_with(&format!("test.toml:4: retry = true of unit x: {flag}")), "{found}");
    // Others take back steps of one length, or none.
    for algorithm in ["iterated", "jacobi"] {
        build(&units, &oscillator(&format!("stop = 1, algorithm = \"{algorithm}\""), "0.5"))
            .expect(algorithm);
    }
}

#[test]
fn law_a_discarded_step_is_begun_anew_with_its_half_and_told_with_its_time() {
    // From 0.5 s on a quarter of a second is refused, and nothing else: neither shorter nor longer ones.
    let rule = (
        "    (void)no_return;\n",
        "    (void)no_return;\n    if (from >= 0.5 && size > 0.2 && size < 0.3) return 2;\n",
    );
    let units = Units::new();
    units.pack("picky.fmu", &common::description(common::STATEFUL), &common::library_with(&[rule]));
    let text = "format = 1\nexperiment = { stop = 1 }\n[[units]]\nname = \"a\"\nfmu = \"picky.fmu\"\ninterval = 0.25\n\
                retry = true\nset = { u1 = 2.0 }\n";
    let mut results = MemoryRecorder::new();
    let mut simulation = build(&units, text).expect("builds");
    for _ in 0..2 {
        simulation.run(&mut results, &mut Quiet).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(results.series("a.y1").expect("recorded"), [0.0, 0.5, 1.0, 1.5, 2.0]);
        assert_eq!(results.series("a.y2").expect("recorded"), [0.0, 0.25, 0.25, 0.125, 0.125]);
        let told = simulation.notices();
        let expected = "unit a discarded 2 steps, the first at t = 0.5 s; shorter ones were made instead";
        assert!(told.iter().any(|notice| notice == expected), "{told:?}");
    }
}
