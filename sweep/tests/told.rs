//! What a sweep makes again, refuses or tells, so that a row that looks healthy is.

mod common;

use common::{Bench, Notes, STATEFUL, column, description, library_with};
use sweep::{Limits, Plan};

/// 3 cases: an integrator of 2 from x0 on, with its rows.
const KEPT: &str = "[grid]\n\"a.x0\" = [0, 1, 2]\n[scalars]\nend = { signal = \"a.y1\", reduce = \"last\" }\n\
    [signals]\nvariables = [\"a.y1\"]\n";

#[test]
fn law_a_part_without_its_signals_is_made_again() {
    let bench = Bench::new();
    for part in 1..=3 {
        bench.sweep(KEPT, "out", 1, Some((part, 3))).expect("runs");
    }
    let signals = bench.path("out/signals/part-2.parquet");
    let whole = std::fs::read(&signals).expect("there");
    std::fs::remove_file(&signals).expect("there");
    let notes = Notes::default();
    let done = bench.watched(KEPT, "out", 1, None, &notes).expect("runs");
    assert_eq!((done.ran, done.parts, done.page.is_some()), (1, (3, 3), true));
    let said = notes.0.lock().expect("no panic").join("\n");
    assert!(said.contains("part-2.parquet is not there, or not of these cases: made again"), "{said}");
    assert!(std::fs::read(&signals).expect("there") == whole, "the same bytes");
    // Another part's in its place, and a file that is cut off.
    std::fs::copy(bench.path("out/signals/part-1.parquet"), &signals).expect("writable");
    assert_eq!(bench.sweep(KEPT, "out", 1, Some((2, 3))).expect("runs").ran, 1);
    std::fs::write(&signals, &whole[..whole.len() / 2]).expect("writable");
    assert_eq!(bench.sweep(KEPT, "out", 1, Some((1, 3))).expect("runs").ran, 0, "not asked for");
    assert_eq!(bench.sweep(KEPT, "out", 1, None).expect("runs").ran, 1);
    assert!(std::fs::read(&signals).expect("there") == whole);
    assert_eq!(bench.sweep(KEPT, "out", 1, None).expect("runs").ran, 0);
}

#[test]
fn law_cases_with_values_that_are_not_finite_are_told() {
    let bench = Bench::new();
    // 7: the output is NaN from 0.5 s on.
    let text = "[set]\n\"a.fault_time\" = 0.5\n[list]\n\"a.fault\" = [0, 7, 3, 7]\n\
        [scalars]\nend = { signal = \"a.y1\", reduce = \"last\" }\n";
    let done = bench.sweep(text, "out", 1, None).expect("runs");
    let words = done.not_finite.clone().unwrap_or_default();
    assert!(words.starts_with("2 cases (the first is 1) have values that are not finite"), "{words}");
    assert_eq!((done.failed, column(&bench.rows("out", "cases"), "end")[1].is_some()), (1, true));
    let page = std::fs::read_to_string(bench.path("out/report.html")).expect("a page");
    assert!(page.contains(&words), "on the page, too");
    assert_eq!(bench.sweep(text, "out", 1, None).expect("all there").not_finite, Some(words));
    assert_eq!(bench.sweep(KEPT, "healthy", 1, None).expect("runs").not_finite, None);
}

#[test]
fn bad_input_a_library_that_remembers_what_ran_before_is_refused() {
    let bench = Bench::new();
    let remembers = [
        ("static void start(Unit *u) {", "static double lives;\nstatic void start(Unit *u) {"),
        ("    u->r[K] = 1;", "    u->r[K] = 1 + lives++;"),
    ];
    bench.units.pack("stateful.fmu", &description(STATEFUL), &library_with(&remembers));
    let refused = bench.sweep(KEPT, "out", 1, None).expect_err("rows would depend on their order");
    let text = refused.to_string();
    assert!(refused.is_input() && text.contains("(static data)") && text.contains("add --isolate"), "{text}");
    assert!(bench.files("out", "cases").is_empty());
}

/// It would stand in `resolved.toml` as what all cases share, and be in none.
#[test]
fn bad_input_a_value_for_all_cases_of_what_varies_is_refused() {
    let bench = Bench::new();
    let limits = Limits { set: vec![("a.x0".into(), "0.3".into())], ..Limits::default() };
    let study = bench.study(KEPT).expect("a study");
    let refused = Plan::new(&study, &bench.units.unit_path(), &limits).map(drop).expect_err("it varies");
    let text = refused.to_string();
    assert!(refused.is_input() && text.starts_with("--set a.x0=0.3: "), "{text}");
    assert!(text.contains("study.toml:4 varies a.x0") && text.contains("leave --set out"), "{text}");
    let other = Limits { set: vec![("a.k".into(), "2".into())], ..Limits::default() };
    assert!(Plan::new(&study, &bench.units.unit_path(), &other).is_ok(), "what does not vary may be set");
}
