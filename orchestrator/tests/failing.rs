//! A unit that fails: it is named, and the others are where they would be had they stepped one after the other.

use crate::common;

use crate::common::Units;
use orchestrator::{Scenario, Simulation};

#[test]
fn cross_a_unit_that_fails_leaves_the_same_behind_in_threads_as_one_after_the_other() {
    let units = Units::new();
    for failing in ["a", "b", "c"] {
        let failed = |algorithm: &str| {
            let unit = |name: &str| {
                let fault = if name == failing { ", fault = 3, fault_time = 0.5" } else { "" };
                format!(
                    "[[units]]\nname = \"{name}\"\nfmu = \"stateful.fmu\"\ninterval = 0.125\nset = {{ k = 2.0, u1 = 1.0{fault} }}\n"
                )
            };
            let text = format!(
                "format = 1\n[experiment]\nstop = 1\nalgorithm = \"{algorithm}\"\n{}",
                ["a", "b", "c"].map(unit).concat()
            );
            let scenario = Scenario::parse(&text, "test.toml").expect(algorithm);
            let mut simulation = Simulation::new(&scenario, &units.unit_path()).expect(algorithm);
            let error = simulation.advance_to(1.0).expect_err("it fails").to_string();
            let last = ["a.y1", "b.y1", "c.y1"].map(|name| simulation.value(name).expect("known"));
            (error, last)
        };
        let (error, last) = failed("jacobi");
        assert!(error.starts_with(&format!("unit {failing}: ")), "{error}");
        assert_eq!(failed("parallel-jacobi"), (error, last));
        // 2 t, up to the step that failed at 0.5 s or just after.
        assert!(last.iter().all(|y| (0.75..=1.25).contains(y)), "{last:?}");
    }
}

#[test]
fn every_unit_is_believed_how_far_it_came_only_if_it_can_tell() {
    let units = Units::new();
    let (answer, value) =
        ("return kind == 2 ? 0 : 2;", "*value = ((Unit *)c)->reached;\n    return kind == 2");
    for (change, told) in [
        (vec![], true),
        // It has no answer, and what it leaves behind is a number; or it answers with none.
        (vec![(answer, "return 2;")], false),
        (vec![(value, "*value = NAN;\n    return kind == 2")], false),
    ] {
        units.pack("stateful.fmu", &common::description(common::STATEFUL), &common::library_with(&change));
        let parts = [common::unit("a", "stateful.fmu", "fault = 2, fault_time = 0.5")];
        let mut simulation = common::build(&units, &parts).expect("builds");
        let error = simulation.advance_to(1.0).expect_err("it is discarded").to_string();
        assert!(error.contains("was discarded"), "{error}");
        assert_eq!(error.contains("which reached t = "), told, "{error}");
    }
}

#[test]
fn every_access_to_no_variables_is_made_and_its_answer_looked_at() {
    let units = Units::new();
    let with = |change: &[(&str, &str)]| {
        units.pack("stateful.fmu", &common::description(common::STATEFUL), &common::library_with(change));
        let fmu = orchestrator::fmu::Fmu::open(units.path().join("stateful.fmu")).expect("opens");
        let answer = fmu.instantiate("a").expect("instantiates").access_nothing();
        answer.map_err(|error| error.to_string())
    };
    assert_eq!(with(&[]), Ok(()));
    // A unit for which no values are an error when they are asked for, or when they are given.
    let refusing = |get: &str, set: &str| {
        format!(
            "API int fmi2GetReal(void *c, const unsigned *refs, size_t n, double *values) {{ fresh(c);\n\
             for (size_t i = 0; i < n; i++) values[i] = ((Unit *)c)->r[refs[i]];\n return {get}; }}\n\
             API int fmi2SetReal(void *c, const unsigned *refs, size_t n, const double *values) {{\n\
             for (size_t i = 0; i < n; i++) ((Unit *)c)->r[refs[i]] = values[i];\n return {set}; }}\n"
        )
    };
    for (get, set, named) in [("n ? 0 : 3", "0", "fmi2GetReal"), ("0", "n ? 0 : 3", "fmi2SetReal")] {
        let answer = with(&[("ACCESS(Real, double, r)", &refusing(get, set))]);
        assert!(answer.as_ref().is_err_and(|error| error.contains(named)), "{named}: {answer:?}");
    }
}

#[test]
fn every_index_up_to_the_last_variable_is_known_wherever_the_structure_stands() {
    let units = Units::new();
    let text = common::description(common::STATEFUL);
    let (begin, end) = ("  <ModelStructure>", "</ModelStructure>\n");
    let (from, to) = (text.find(begin).expect("there"), text.find(end).expect("there") + end.len());
    let structure = &text[from..to];
    let count = text.matches("<ScalarVariable").count();
    assert_eq!(count, 15);
    for (index, is_known) in [(15, true), (16, false)] {
        let structure = structure.replace("index=\"15\"", &format!("index=\"{index}\""));
        for early in [false, true] {
            let rest = [&text[..from], &text[to..]].concat();
            let place = if early { "<ModelVariables>" } else { "</fmiModelDescription>" };
            let moved = rest.replace(place, &format!("{structure}{place}"));
            let path = units.pack("moved.fmu", &moved, &common::library());
            let opened = orchestrator::fmu::Fmu::open(path).map(drop).map_err(|error| error.to_string());
            assert_eq!(opened.is_ok(), is_known, "{index}, early {early}: {opened:?}");
        }
    }
}

#[test]
fn every_warning_before_a_saved_state_is_counted_after_it() {
    let units = Units::new();
    let parts = [common::unit("a", "stateful.fmu", "fault = 1, fault_time = 0.25")];
    let fresh = || common::build(&units, &parts).expect("builds");
    let mut whole = fresh();
    whole.advance_to(1.0).expect("a warning stops nothing");
    let told = whole.notices();
    // Steps that end at 3/8 s and later, or from 1/4 s on: six or seven of eight.
    assert!(told[0].starts_with("unit a answered 7 calls with a warning"), "{told:?}");
    let mut first = fresh();
    first.advance_to(0.625).expect("steps");
    let saved = first.save().expect("saved");
    let mut second = fresh();
    second.go_back(&saved).expect("the same");
    second.advance_to(1.0).expect("steps");
    assert_eq!(second.notices()[0].split(';').next(), told[0].split(';').next());
}

#[test]
fn law_a_unit_is_not_called_for_nothing() {
    let units = Units::new();
    // It takes a call about no variables for a mistake.
    let fields = [
        (
            "values[i] = ((Unit *)c)->FIELD[refs[i]];",
            "{ values[i] = ((Unit *)c)->FIELD[refs[i]]; } if (!n) return 3;",
        ),
        (
            "((Unit *)c)->FIELD[refs[i]] = values[i];",
            "{ ((Unit *)c)->FIELD[refs[i]] = values[i]; } if (!n) return 3;",
        ),
        (
            "values[i] = ((Unit *)c)->s[refs[i]];",
            "values[i] = ((Unit *)c)->s[refs[i]];\n    if (!n) return 3;",
        ),
        (
            "snprintf(((Unit *)c)->s[refs[i]], 64, \"%s\", values[i]);",
            "snprintf(((Unit *)c)->s[refs[i]], 64, \"%s\", values[i]);\n    if (!n) return 3;",
        ),
    ];
    units.pack("stateful.fmu", &common::description(common::STATEFUL), &common::library_with(&fields));
    for (from, to) in [("y1", "u1"), ("i_out", "i_in"), ("b_out", "b_in"), ("s_out", "s_in")] {
        let parts = [
            common::unit("a", "stateful.fmu", ""),
            common::unit("b", "stateful.fmu", ""),
            common::connection(&format!("a.{from}"), &format!("b.{to}")),
            format!("[record]\nvariables = [\"b.{to}\"]\n"),
        ];
        let mut simulation = common::build(&units, &parts).expect("builds");
        simulation.advance_to(1.0).unwrap_or_else(|error| panic!("{from}: {error}"));
    }
}

#[test]
fn every_call_that_no_run_makes_reaches_the_unit() {
    let units = Units::new();
    let frees = [
        ("API void *fmi2Instantiate(", "static int nothing;\nAPI void *fmi2Instantiate("),
        (
            "    start(u);\n    return u;\n",
            "    start(u);\n    callbacks->logger(callbacks->environment, name, 1, \"events\", \"%d\", nothing);\n    return u;\n",
        ),
        (
            "API void fmi2FreeInstance(void *c) { ",
            "API void fmi2FreeInstance(void *c) { if (!c) { nothing++; return; }\n",
        ),
        (
            "    (void)c; (void)on; (void)n; (void)names;\n    return 0;",
            "    Unit *u = c;\n    for (size_t i = 0; i < n; i++) u->callbacks->logger(u->callbacks->environment, \"u\", 0, \"\", \"%d %s\", \
             on, names[i]);\n    return n > 1 ? 3 : 0;",
        ),
    ];
    units.pack("stateful.fmu", &common::description(common::STATEFUL), &common::library_with(&frees));
    let fmu = orchestrator::fmu::Fmu::open(units.path().join("stateful.fmu")).expect("opens");
    let log = |instance: &orchestrator::fmu::Instance, from: usize| {
        instance.log().into_iter().skip(from).map(|line| line.text).collect::<Vec<_>>()
    };
    let first = fmu.instantiate("a").expect("instantiates");
    // What it is to log is said once it was made.
    assert_eq!(log(&first, 0), ["0", "1 logStatusError"]);
    fmu.free_nothing().expect("loaded");
    let mut second = fmu.instantiate("b").expect("instantiates");
    assert_eq!(log(&second, 0), ["1", "1 logStatusError"]);
    second.set_debug_logging(false, &["logEvents".into()]).expect("one is no error");
    assert_eq!(log(&second, 2), ["0 logEvents"]);
    let error = second.set_debug_logging(true, &["a".into(), "b\0c".into()]).expect_err("two are");
    assert_eq!(log(&second, 3), ["1 a", "1 bc"]);
    assert!(error.to_string().contains("fmi2SetDebugLogging"), "{error}");
    second.free_no_state().expect("no state");
}

#[test]
fn law_kept_states_are_given_back_before_their_unit_goes() {
    let units = Units::new();
    let mark = units.path().join("kept");
    let leaves = format!(
        "API void fmi2FreeInstance(void *c) {{ FILE *f = kept ? fopen(\"{}\", \"w\") : NULL; if (f) fclose(f);\n",
        mark.display()
    );
    let counts = [
        ("API void *fmi2Instantiate(", "static int kept;\nAPI void *fmi2Instantiate("),
        ("    if (!*state) *state = malloc", "    if (!*state) kept++;\n    if (!*state) *state = malloc"),
        ("    free(*state);\n", "    kept--;\n    free(*state);\n"),
        ("API void fmi2FreeInstance(void *c) { ", &*leaves),
    ];
    units.pack("stateful.fmu", &common::description(common::STATEFUL), &common::library_with(&counts));
    let fmu = orchestrator::fmu::Fmu::open(units.path().join("stateful.fmu")).expect("opens");
    let mut instance = fmu.instantiate("a").expect("instantiates");
    let _ = instance.save_state().expect("and never given back");
    drop(instance);
    assert!(mark.exists(), "it tells");
    std::fs::remove_file(&mark).expect("there");
    for algorithm in ["iterated", "step-halving"] {
        let text = format!(
            "format = 1\nexperiment = {{ stop = 1, algorithm = \"{algorithm}\" }}\n{}",
            common::unit("a", "stateful.fmu", "")
        );
        let scenario = Scenario::parse(&text, "test.toml").expect("a scenario");
        let mut simulation = Simulation::new(&scenario, &units.unit_path()).expect("builds");
        simulation.advance_to(0.5).expect("steps");
        drop(simulation);
        assert!(!mark.exists(), "{algorithm}");
    }
}

#[test]
fn every_library_that_lacks_a_python_says_so() {
    let units = Units::new();
    for (symbol, is_python) in [("Py_Flag", true), ("_Py_NoneStruct", true), ("nobodys_flag", false)] {
        let lacks = format!(
            "extern int {symbol};\nAPI int *lacks(void) {{ return &{symbol}; }}\nAPI int fmi2Terminate("
        );
        let library = common::library_with(&[("API int fmi2Terminate(", &lacks)]);
        units.pack("stateful.fmu", &common::description(common::STATEFUL), &library);
        let built = common::build(&units, &[common::unit("a", "stateful.fmu", "")]).map(drop);
        let error = built.expect_err("it can't be loaded").to_string();
        assert!(error.contains(&format!("undefined symbol: {symbol}")), "{error}");
        assert_eq!(
            error.contains("the unit needs a Python interpreter in this process"),
            is_python,
            "{error}"
        );
    }
}

#[cfg(all(target_os = "linux", target_env = "gnu"))]
#[test]
fn law_a_library_finds_its_own_symbols_first_where_the_program_has_the_same() {
    let units = Units::new();
    let own = (
        "static void start(Unit *u) {\n",
        "API int getppid(void) { return 42; }\nstatic int (*volatile parent)(void) = getppid;\nstatic void start(Unit *u) {\n",
    );
    let tells = ("u->i[I_OUT] = u->i[I_IN] + 1;", "u->i[I_OUT] = parent();");
    units.pack("stateful.fmu", &common::description(common::STATEFUL), &common::library_with(&[own, tells]));
    let parent = || {
        let mut simulation = common::build(&units, &[common::unit("a", "stateful.fmu", "")]).expect("builds");
        simulation.value("a.i_out").expect("known")
    };
    assert_ne!(parent(), 42.0, "the C library's");
    // For a program that serves units and has functions of FMI of its own.
    orchestrator::serve_units();
    assert_eq!(parent(), 42.0, "its own");
}

#[test]
fn every_piece_of_a_step_that_is_discarded_is_no_reason_to_advise_smaller_ones() {
    let units = Units::new();
    let rule = ("    (void)no_return;\n", "    (void)no_return; if (from >= 0.5) return 2;\n");
    units.pack("refuses.fmu", &common::description(common::STATEFUL), &common::library_with(&[rule]));
    for (retry, advice) in [
        ("", "or `retry = true` of the unit"),
        ("retry = true\n", "pieces as small as are tried with `retry = true` did not"),
    ] {
        let text = format!(
            "format = 1\nexperiment = {{ stop = 1 }}\n[[units]]\nname = \"a\"\nfmu = \"refuses.fmu\"\ninterval = 0.25\n{retry}"
        );
        let scenario = Scenario::parse(&text, "test.toml").expect("a scenario");
        let mut simulation = Simulation::new(&scenario, &units.unit_path()).expect("builds");
        let error = simulation.advance_to(1.0).expect_err("discarded").to_string();
        assert!(error.contains("a smaller interval may help, ") && error.contains(advice), "{error}");
    }
}

#[test]
fn law_a_loop_that_is_iterated_is_not_said_to_be_cut() {
    let units = Units::new();
    let unit = |name: &str| {
        format!(
            "[[units]]\nname = \"{name}\"\nfmu = \"feedthrough.fmu\"\ninterval = 0.25\nset = {{ mode = 1, k = K, x0 = 1.0 }}\n"
        )
    };
    let wire = |from: &str, to: &str| format!("[[connections]]\nfrom = \"{from}.y1\"\nto = \"{to}.u1\"\n");
    let built = |algorithm: &str, gain: &str| {
        let head = format!("format = 1\n[experiment]\nstop = 1\nalgorithm = \"{algorithm}\"\n");
        let text = [head, unit("a"), unit("b"), wire("a", "b"), wire("b", "a")]
            .concat()
            .replace("K,", &format!("{gain},"));
        let scenario = Scenario::parse(&text, "test.toml").expect("a scenario");
        Simulation::new(&scenario, &units.unit_path()).expect("builds")
    };
    let is_cut = |simulation: &Simulation| {
        simulation.notices().iter().any(|notice| notice.contains("it is cut where"))
    };
    assert!(is_cut(&built("gauss-seidel", "0.5")));
    let mut iterated = built("iterated", "0.5");
    iterated.advance_to(1.0).expect("it settles");
    // y = 0.5 y + 1 at both.
    assert!(!is_cut(&iterated) && (iterated.value("a.y1").expect("known") - 2.0).abs() < 1e-9);
}
