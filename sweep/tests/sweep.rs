//! Sweeps of a small unit: rows against single runs, parts against the whole, ends in the middle.

mod common;

use common::{
    Bench, LEAKY, Notes, ONLY_ONCE, STATEFUL, column, described_as_only_once, description, files,
    library_with,
};
use orchestrator::{MemoryRecorder, Quiet, Scenario, Simulation};
use parquet::record::Field;
use std::sync::atomic::{AtomicU64, Ordering};
use sweep::{Error, Limits, Plan, Silent, Study, Watch};

/// 12 cases: an integrator of 2 k from x0 on.
const GRID: &str = "[grid]\n\"a.k\" = [1, 2.5, -3]\n\"a.x0\" = { from = 0, to = 0.3, step = 0.1 }\n\
    [scalars]\nend = { signal = \"a.y1\", reduce = \"last\" }\nrms = { signal = \"a.y1\", minus = \"a.u1\", reduce = \"rms\" }\n\
    over = { signal = \"a.y1\", reduce = \"first_true\", above = 1.0 }\n";

fn reals(rows: &[Vec<(String, Field)>], name: &str) -> Vec<f64> {
    column(rows, name).into_iter().map(|value| value.expect("a value")).collect()
}

#[test]
fn law_rows_are_those_of_single_runs() {
    let bench = Bench::new();
    let done = bench.sweep(GRID, "out", 2, None).expect("runs");
    assert_eq!((done.cases, done.ran, done.failed, done.parts), (12, 12, 0, (1, 1)));
    let rows = bench.rows("out", "cases");
    assert!(reals(&rows, "case").into_iter().eq((0..12).map(f64::from)));
    assert_eq!(reals(&rows, "a.x0")[..4], [0.0, 0.1, 0.2, 0.3], "exact decimals, the last parameter fastest");
    for (row, cells) in rows.iter().enumerate() {
        let (k, x0) = (reals(&rows, "a.k")[row], reals(&rows, "a.x0")[row]);
        let mut scenario = Scenario::load(bench.path("scenario.toml")).expect("a scenario");
        scenario.set("a.k", &k.to_string()).expect("known");
        scenario.set("a.x0", &x0.to_string()).expect("known");
        let mut results = MemoryRecorder::new();
        let mut simulation = Simulation::new(&scenario, &bench.units.unit_path()).expect("fits");
        simulation.run(&mut results, &mut Quiet).expect("runs");
        let y1 = results.series("a.y1").expect("recorded");
        let squares = y1.iter().map(|y1| (y1 - 2.0) * (y1 - 2.0)).sum::<f64>();
        assert_eq!(reals(&rows, "end")[row].to_bits(), y1[8].to_bits());
        assert_eq!(reals(&rows, "rms")[row], (squares / 9.0).sqrt());
        let over = y1.iter().position(|y1| *y1 > 1.0).map(|at| results.times()[at]);
        assert_eq!(column(&rows, "over")[row], over);
        assert!(cells.contains(&("status".into(), Field::Str("ok".into()))));
        assert!(cells.contains(&("error".into(), Field::Null)));
    }
    let page = std::fs::read_to_string(bench.path("out/report.html")).expect("a page");
    assert!(page.contains("All 12 cases ran") && page.matches("<svg").count() == 3);
}

#[test]
fn law_bytes_do_not_depend_on_threads() {
    let bench = Bench::new();
    let text = format!("{GRID}[signals]\nvariables = [\"a.y*\", \"a.i_out\", \"a.b_out\", \"a.s_out\"]\n");
    bench.sweep(&text, "one", 1, Some((2, 3))).expect("runs");
    bench.sweep(&text, "three", 3, Some((2, 3))).expect("runs");
    for kind in ["cases", "signals"] {
        let bytes = |out| std::fs::read(&bench.files(out, kind)[0]).expect("there");
        assert!(bytes("one") == bytes("three"), "{kind}");
    }
}

#[test]
fn law_parts_join_to_the_whole() {
    let bench = Bench::new();
    let text = format!("{GRID}[signals]\nvariables = [\"a.y1\"]\nevery = 0.25\n");
    bench.sweep(&text, "whole", 2, None).expect("runs");
    for part in [3, 1, 5, 2, 4] {
        let done = bench.sweep(&text, "parts", 1, Some((part, 5))).expect("runs");
        assert_eq!(done.page.is_some(), part == 4, "with the last part comes the page");
    }
    for kind in ["cases", "signals"] {
        assert_eq!(bench.rows("parts", kind), bench.rows("whole", kind), "{kind}");
    }
    let signals = bench.rows("whole", "signals");
    assert_eq!(reals(&signals, "time")[..6], [0.0, 0.25, 0.5, 0.75, 1.0, 0.0], "every 0.25 s");
    // More parts than cases: empty ones are there, too.
    for part in 1..=14 {
        bench.sweep(&text, "many", 1, Some((part, 14))).expect("runs");
    }
    assert_eq!(bench.files("many", "cases").len(), 14);
    assert_eq!(bench.rows("many", "cases"), bench.rows("whole", "cases"));
    // The whole is completed in as many parts as there are.
    std::fs::remove_file(bench.path("many/cases/part-07.parquet")).expect("there");
    let done = bench.sweep(&text, "many", 2, None).expect("runs");
    assert_eq!((done.parts, done.page.is_some()), ((14, 14), true));
    assert_eq!(bench.rows("many", "cases"), bench.rows("whole", "cases"));
}

#[test]
fn law_finished_parts_are_not_made_again_unless_something_differs() {
    let bench = Bench::new();
    let written = |out: &str| {
        std::fs::metadata(&bench.files(out, "cases")[0]).expect("there").modified().expect("a time")
    };
    bench.sweep(GRID, "out", 1, None).expect("runs");
    let before = written("out");
    let done = bench.sweep(&format!("# a comment\n{GRID}"), "out", 3, None).expect("runs");
    assert_eq!((done.ran, written("out")), (0, before));
    // Another value of all cases: another study. Alone it takes the place; one part of many refuses.
    let other = format!("[set]\n\"a.i_in\" = 7\n{GRID}");
    let refused = bench.sweep(&other, "out", 1, Some((1, 1))).expect_err("it is another's");
    assert!(refused.is_input() && refused.to_string().contains("belongs to another study"), "{refused}");
    let refused = bench.sweep(GRID, "out", 1, Some((1, 2))).expect_err("in another number of parts");
    assert!(refused.to_string().contains("in 1 parts, not 2"), "{refused}");
    assert_eq!(bench.sweep(&other, "out", 1, None).expect("runs").ran, 12);
    // A unit that was built anew is another one.
    let unit = bench.path("stateful.fmu");
    std::fs::copy(bench.path("feedthrough.fmu"), &unit).expect("writable");
    assert_eq!(bench.sweep(&other, "out", 1, None).expect("runs").ran, 12);
    std::fs::write(bench.path("out/cases/part-9.parquet"), "no Parquet").expect("writable");
    let refused = bench.sweep(&other, "out", 1, None).expect_err("not ours");
    assert!(refused.to_string().contains("part-9.parquet"), "{refused}");
}

#[test]
fn law_a_failing_case_is_a_row_and_costs_nothing_else() {
    let bench = Bench::new();
    let text = "[set]\n\"a.fault_time\" = 0.5\n[list]\n\"a.fault\" = [0, 3, 0, 7, 4, 0]\n\"a.x0\" = [1, 2, 3, 4, 5, 6]\n\
        [scalars]\nend = { signal = \"a.y1\", reduce = \"last\" }\n";
    let done = bench.sweep(text, "out", 1, None).expect("runs");
    // A NaN that goes to no other unit is no failure.
    assert_eq!((done.ran, done.failed), (6, 2));
    let rows = bench.rows("out", "cases");
    assert_eq!(column(&rows, "end")[0], Some(3.0), "1 + 2");
    assert_eq!(column(&rows, "end")[1], None);
    assert_eq!(column(&rows, "end")[2], Some(5.0));
    assert_eq!(column(&rows, "end")[5], Some(8.0), "units of a run that failed are not used again");
    let text = |row: usize, name: &str| {
        rows[row]
            .iter()
            .find(|(known, _)| known == name)
            .map(|(_, field)| field.to_string())
            .expect("a column")
    };
    assert_eq!(text(1, "status"), "\"failed\"");
    assert!(
        text(1, "error").contains("unit a: fmi2DoStep at t = 0.375 s answered error"),
        "{}",
        text(1, "error")
    );
    let page = std::fs::read_to_string(bench.path("out/report.html")).expect("a page");
    assert!(page.contains("of 6 cases failed") && page.contains("fmi2DoStep"));
}

/// The fixture's library with lines of its source replaced.
#[test]
fn law_a_unit_that_can_live_only_once_is_loaded_by_each_thread() {
    let bench = Bench::new();
    bench.sweep(GRID, "honest", 1, None).expect("runs");
    let (described, library) = (described_as_only_once(STATEFUL), library_with(&ONLY_ONCE));
    bench.units.pack("stateful.fmu", &described, &library);
    bench.sweep(GRID, "once", 3, None).expect("runs");
    assert_eq!(bench.rows("once", "cases"), bench.rows("honest", "cases"));
}

#[test]
fn law_a_unit_that_keeps_something_over_a_reset_gets_fresh_instances() {
    let bench = Bench::new();
    let library = library_with(&[LEAKY]);
    let study = "[grid]\n\"a.x0\" = [0, 1, 2]\n[scalars]\nend = { signal = \"a.y1\", reduce = \"last\" }\n";
    bench.sweep(study, "honest", 1, None).expect("runs");
    bench.units.pack("stateful.fmu", &description(STATEFUL), &library);
    let notes = Notes::default();
    bench.watched(study, "leaky", 1, None, &notes).expect("runs");
    let said = notes.0.lock().expect("no panic").join("\n");
    assert!(said.contains("keeps something over fmi2Reset"), "{said}");
    assert_eq!(reals(&bench.rows("leaky", "cases"), "end"), [2.0, 3.0, 4.0]);
    assert_eq!(bench.rows("leaky", "cases"), bench.rows("honest", "cases"));
}

/// Asks for the end after so many cases.
struct Ends(AtomicU64);

impl Watch for Ends {
    fn begin(&self, _: u64, _: u64) {}
    fn ran(&self, cases: u64) {
        let _ =
            self.0.fetch_update(Ordering::SeqCst, Ordering::SeqCst, |left| Some(left.saturating_sub(cases)));
    }
    fn note(&self, _: &str) {}
    fn ends(&self) -> bool {
        self.0.load(Ordering::SeqCst) == 0
    }
}

#[test]
fn law_an_interruption_keeps_what_is_whole_and_leaves_nothing_else() {
    let bench = Bench::new();
    let text = "[random]\ncount = 1000\nseed = 1\n\"a.x0\" = { from = 0, to = 1 }\n[scalars]\nend = { signal = \"a.y1\", reduce = \"last\" }\n";
    let ended = bench.watched(text, "out", 2, None, &Ends(AtomicU64::new(500))).expect_err("interrupted");
    assert!(matches!(ended, Error::Interrupted { cases, parts } if cases >= 500 && parts >= 3), "{ended}");
    let there = files(&bench.path("out/cases"));
    assert!(!there.is_empty() && there.len() < 8, "{there:?}");
    assert!(there.iter().all(|path| path.extension().is_some_and(|ending| ending == "parquet")), "{there:?}");
    let done = bench.sweep(text, "out", 2, None).expect("runs");
    assert!(done.ran < 1000 && done.parts == (8, 8));
    bench.sweep(text, "whole", 1, None).expect("runs");
    assert_eq!(bench.rows("out", "cases"), bench.rows("whole", "cases"));
}

#[test]
fn law_until_ends_a_run() {
    let bench = Bench::new();
    let text = format!("until = \"a.y1 > 2.2\"\n{GRID}");
    bench.sweep(&text, "out", 1, None).expect("runs");
    let rows = bench.rows("out", "cases");
    // k = 2.5 rises by 0.625 a step: 0, 0.625, 1.25, 1.875, 2.5.
    assert_eq!(reals(&rows, "end")[4], 2.5);
    assert_eq!(reals(&rows, "end")[0], 2.0, "k = 1 comes to 2");
}

#[test]
fn every_mistake_is_named_with_its_line() {
    let bench = Bench::new();
    let tail = "[scalars]\nend = { signal = \"a.y1\", reduce = \"last\" }\n";
    let axis = |values: &str| format!("[grid]\n\"a.k\" = {values}\n{tail}");
    for (text, line, said) in [
        ("[gird]\n\"a.k\" = [1]\n".to_owned() + tail, 3, "did you mean grid"),
        (axis("{ from = 0, to = 0.05, step = 0.02 }"), 4, "to = 0.04 or 0.06"),
        (axis("{ from = 0, to = 0.05, stp = 0.01 }"), 4, "did you mean step"),
        (axis("{ from = 0, to = \"x\", step = 0.02 }"), 4, "a number such as"),
        (axis("{ from = 0, to = 1, step = 0 }"), 4, "a step that is not 0"),
        (axis("{ from = 0, to = 1, step = -0.1 }"), 4, "leads from the one to the other"),
        (axis("{ from = 0, to = 1 }"), 4, "count"),
        (axis("{ from = 0, to = 1, count = 3, scale = \"log\" }"), 4, "both ends above 0"),
        (axis("[1, 2..3]"), 4, "not a study"),
        (axis("[]"), 4, "one value at least"),
        (axis("[1, [2]]"), 4, "a number, true, false or a text"),
        (axis("[\"abc\"]"), 4, "a.k = \"abc\""),
        (axis("[1, 1e7]"), 4, "a.k = 10000000"),
        ("[grid]\n\"a.kk\" = [1]\n".to_owned() + tail, 4, "did you mean k (or"),
        ("[grid]\n\"b.k\" = [1]\n".to_owned() + tail, 4, "there is no unit \"b\""),
        ("[grid]\n\"a.y1\" = [1]\n".to_owned() + tail, 4, "computed by the unit"),
        ("[grid]\n\"a.u1\" = [1]\n".to_owned() + tail, 4, "is driven"),
        ("[grid]\n\"k\" = [1]\n".to_owned() + tail, 4, "is no parameter"),
        (
            "[grid]\n\"a.k\" = [1]\n[sobol]\ncount = 4\n\"a.x0\" = { from = 0, to = 1 }\n".to_owned() + tail,
            5,
            "one of both",
        ),
        (format!("[random]\ncount = 4\n\"a.x0\" = {{ from = 0, to = 1 }}\n{tail}"), 3, "no seed"),
        (format!("[sobol]\n\"a.x0\" = {{ from = 0, to = 1 }}\n{tail}"), 3, "no count"),
        (format!("[sobol]\ncount = 0\n\"a.x0\" = {{ from = 0, to = 1 }}\n{tail}"), 3, "[sobol] count = 0"),
        (format!("[grid]\n\"a.x0\" = {{ from = 0, to = 1 }}\n{tail}"), 4, "neither step nor count"),
        (
            format!("[grid]\n\"a.x0\" = {{ from = 0, to = 1, step = 0.5, count = 3 }}\n{tail}"),
            4,
            "both step and count",
        ),
        (format!("[sobol]\ncount = 4\n\"a.x0\" = [0, 1]\n{tail}"), 5, "a range"),
        (
            format!("[sobol]\ncount = 4\n\"a.x0\" = {{ from = 1, to = 0 }}\n{tail}"),
            5,
            "smaller to the larger",
        ),
        (format!("[sobol]\ncount = 4\n\"a.fault\" = {{ from = 0, to = 1.5 }}\n{tail}"), 5, "whole numbers"),
        (
            format!("[list]\nrows = [{{ \"a.k\" = 1 }}, {{ \"a.x0\" = 1 }}]\n{tail}"),
            4,
            "not in the first row",
        ),
        (format!("[list]\n\"a.k\" = [1, 2]\n\"a.x0\" = [1]\n{tail}"), 5, "2, as many as a.k"),
        (axis("[1]") + "s = { signal = \"a.y1\", reduce = \"lats\" }", 7, "did you mean last"),
        (axis("[1]") + "s = { signal = \"a.y9\", reduce = \"last\" }", 7, "did you mean y1"),
        (axis("[1]") + "s = { signal = \"a.s_out\", reduce = \"last\" }", 7, "is a String"),
        (axis("[1]") + "s = { signal = \"a.y1\", reduce = \"first_true\" }", 7, "a limit"),
        (axis("[1]") + "s = { signal = \"a.y1\", reduce = \"max\", above = 1 }", 7, "first_true"),
        (axis("[1]") + "case = { signal = \"a.y1\", reduce = \"max\" }", 7, "another name"),
        (axis("[1]") + "[signals]\nvariables = [\"a.nothing*\"]", 8, "nothing matches"),
        ("stop = \"soon\"\n".to_owned() + &axis("[1]"), 3, "soon"),
        ("until = \"a.y1\"\n".to_owned() + &axis("[1]"), 3, "a limit"),
        ("until = \"a.y1 > x\"\n".to_owned() + &axis("[1]"), 3, "a Boolean such as"),
        ("[set]\n\"a.kk\" = 1\n".to_owned() + &axis("[1]"), 4, "k"),
        ("[set]\n\"a.k\" = 1\n".to_owned() + &axis("[1]"), 4, "varies too"),
    ] {
        let error = bench.plan(&text).err().unwrap_or_else(|| panic!("accepted: {text}"));
        let told = error.to_string();
        let line = format!("study.toml:{line}: ");
        assert!(
            told.contains(said) && told.contains(&line) && error.is_input(),
            "{text}\n→ {told} (wanted: {line}{said})"
        );
    }
    let only = "[grid]\n\"a.k\" = [1]\n";
    assert!(
        bench
            .plan(only)
            .err()
            .is_some_and(|error| error.to_string().contains("nothing of a run would be kept"))
    );
    let unknown = Study::load("delay-and-rte").expect_err("there is none").to_string();
    assert!(unknown.contains("did you mean delay-and-rate"), "{unknown}");
    let scenario = Study::load("visual-servo").expect_err("it is a scenario").to_string();
    assert!(scenario.contains("--grid"), "{scenario}");
    let part = bench.sweep(GRID, "out", 1, Some((3, 2))).expect_err("there is none").to_string();
    assert!(part.contains("K from 1 to N"), "{part}");
    let nope =
        Study::parse(&format!("format = 1\nscenario = \"nope.toml\"\n{GRID}"), &bench.path("study.toml"));
    let plan = Plan::new(&nope.expect("a study"), &bench.units.unit_path(), &Limits::default());
    let nope = plan.err().expect("no such scenario").to_string();
    assert!(nope.contains("study.toml:2: no scenario `"), "{nope}");
}

#[test]
fn bad_input_a_signal_of_another_unit_can_not_be_taken_off() {
    let bench = Bench::new();
    let unlike = |u1_unit: &'static str, y1_unit: &'static str| {
        bench.units.add(units_of(u1_unit, y1_unit));
        bench.plan(GRID).err().map(|error| error.to_string())
    };
    let refused = unlike("rad", "m").expect("an angle is no length");
    assert!(refused.contains("study.toml:8: a.y1 is in m, a.u1 in rad"), "{refused}");
    assert!(unlike("deg", "rad").is_some(), "numbers are taken off as they are");
    for (u1, y1) in [("m", "m"), ("", "m"), ("apples", "m"), ("m", "")] {
        assert_eq!(unlike(u1, y1), None, "{u1:?} {y1:?}");
    }
}

fn units_of(u1_unit: &'static str, y1_unit: &'static str) -> common::Fixture {
    common::Fixture { u1_unit, y1_unit, ..STATEFUL }
}

#[test]
fn value_words_make_the_same_study() {
    let bench = Bench::new();
    let words = sweep::Words {
        scenario: bench.path("scenario.toml").display().to_string(),
        grid: vec!["a.k=1,2.5,-3".into(), "a.x0=0:0.3:0.1".into()],
        until: None,
        scalars: vec!["end=a.y1:last".into(), "rms=a.y1-a.u1:rms".into()],
    };
    let plan = |study| Plan::new(&study, &bench.units.unit_path(), &Limits::default());
    let typed = plan(Study::of_words(&words).expect("a study")).expect("fits");
    sweep::sweep(&typed, &bench.options("typed", 1, None), &Silent).expect("runs");
    bench.sweep(GRID, "file", 1, None).expect("runs");
    for name in ["a.k", "a.x0", "end", "rms"] {
        assert_eq!(
            column(&bench.rows("typed", "cases"), name),
            column(&bench.rows("file", "cases"), name),
            "{name}"
        );
    }
    let until = sweep::Words { until: Some("a.y1 > 2".into()), scalars: Vec::new(), ..words.clone() };
    let typed = plan(Study::of_words(&until).expect("a study")).expect("fits");
    sweep::sweep(&typed, &bench.options("until", 1, None), &Silent).expect("runs");
    assert_eq!(column(&bench.rows("until", "cases"), "a.y1")[4], Some(0.5), "k = 2.5: 2.5 at 0.5 s");
    for (grid, said) in [
        ("a.k", "it has no ="),
        ("a.k=0:1", "wrong values"),
        ("a.k=0:1:0.3", "whole steps"),
        ("a.q=1", "did you mean"),
    ] {
        let words = sweep::Words { grid: vec![grid.into()], ..words.clone() };
        let error =
            Study::of_words(&words).and_then(plan).err().map(|error| error.to_string()).unwrap_or_default();
        assert!(error.contains(said) && error.contains(&format!("--grid {grid}")), "{error}");
    }
}
