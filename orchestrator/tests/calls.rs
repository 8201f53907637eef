//! Single calls of a unit's functions, through libraries that are strict about what they are given or tell it.

use crate::common::{STATEFUL, Units, description, library_with};
use orchestrator::fmu::{Begin, Instance, Status};
use orchestrator::{Fmu, MemoryRecorder, Quiet, Scenario, Simulation, Value};

/// An instance of the stateful unit with these changes of its description and its library.
fn instance(units: &Units, described: &[(&str, &str)], library: &[(&str, &str)]) -> Instance {
    let mut text = description(STATEFUL);
    for (honest, other) in described {
        assert!(text.contains(honest), "{honest}");
        text = text.replace(honest, other);
    }
    let fmu = Fmu::open(units.pack("changed.fmu", &text, &library_with(library))).expect("opens");
    fmu.instantiate("a").expect("instantiates")
}

/// It refuses a step that does not begin where the last one ended, or the experiment.
const STRICT: [(&str, &str); 2] = [
    ("    u->set_up = 1;\n", "    u->set_up = 1;\n    u->reached = from;\n"),
    ("    (void)no_return;\n", "    (void)no_return;\n    if (fabs(from - u->reached) > 1e-12) return 3;\n"),
];

#[test]
fn every_step_begins_where_the_last_one_ended() {
    let units = Units::new();
    units.pack("strict.fmu", &description(STATEFUL), &library_with(&STRICT));
    let pair = |experiment: &str, more: [&str; 2]| {
        let unit =
            |name: &str, more: &str| format!("[[units]]\nname = \"{name}\"\nfmu = \"strict.fmu\"\n{more}\n");
        format!(
            "format = 1\nexperiment = {{ {experiment} }}\n{}{}[[connections]]\nfrom = \"v.y1\"\nto = \"x.u1\"\n\
             [[connections]]\nfrom = \"x.y1\"\nto = \"v.u1\"\n",
            unit("x", more[0]),
            unit("v", more[1])
        )
    };
    let (x, v) = ("interval = 0.25\nset = { x0 = 1 }", "interval = 0.25\nset = { k = -1 }");
    for algorithm in orchestrator::algorithms() {
        let mut tried = vec![
            pair(&format!("stop = 2, algorithm = \"{algorithm}\""), [x, v]),
            pair(&format!("start = 0.5, stop = 2.1, algorithm = \"{algorithm}\""), [x, v]),
            // Steps of more than 0.03 s are discarded, and made anew in shorter ones.
            pair(
                &format!("stop = 2, algorithm = \"{algorithm}\""),
                [&x.replace("set = { ", "retry = true\nset = { fault = 23, "), v],
            ),
        ];
        if !orchestrator::needs(algorithm).expect("an algorithm").one_rate {
            let other = v.replace("0.25", "0.1\noffset = 0.05");
            tried.push(pair(&format!("stop = 2, algorithm = \"{algorithm}\""), [x, &other]));
        }
        for text in tried {
            let scenario = Scenario::parse(&text, "test.toml").expect("a scenario");
            let mut simulation = Simulation::new(&scenario, &units.unit_path()).expect("builds");
            for _ in 0..2 {
                let ended = simulation.run(&mut MemoryRecorder::new(), &mut Quiet);
                ended.unwrap_or_else(|error| panic!("{error}\n{text}"));
            }
        }
    }
}

/// Setting anything of a reference is refused.
fn refuses(what: &str) -> (&'static str, String) {
    let honest = "        for (size_t i = 0; i < n; i++) ((Unit *)c)->FIELD[refs[i]] = values[i];";
    (
        honest,
        format!(
            "        for (size_t i = 0; i < n; i++) {{ if ({what}) return 3; ((Unit *)c)->FIELD[refs[i]] = values[i]; }}"
        ),
    )
}

#[test]
fn every_trial_of_a_reset_keeps_to_time_and_to_the_bounds_of_inputs() {
    let start = "name=\"u1\" valueReference=\"0\" causality=\"input\"><Real start=\"0\"";
    let restores = |described: &[(&str, &str)], refused: &str| {
        let outputs = refuses("refs[i] > U2");
        let check = format!(
            "    (void)no_return;\n    if ({refused} || fabs(from - u->reached) > 1e-12 || !(size > 0 && size < 1)) return 3;\n"
        );
        let library = [STRICT[0], (STRICT[1].0, check.as_str()), (outputs.0, outputs.1.as_str())];
        instance(&Units::new(), described, &library).fmu().restores()
    };
    for (bounds, refused) in [
        ("min=\"0\"", "u->r[U1] < 0"),
        ("max=\"0\"", "u->r[U1] > 0"),
        // It is moved all the same: from the second step on, since a first one begins at the start value.
        ("min=\"0\"", "u->r[U1] == 0"),
        ("max=\"0\"", "u->r[U1] == 0"),
        ("min=\"0\" max=\"0.01\"", "u->r[U1] != 0.01"),
    ] {
        assert!(restores(&[(start, &format!("{start} {bounds}"))], refused), "{bounds}, refused {refused}");
    }
    assert!(!restores(&[], "size > 0.005"), "what it refuses is seen");
    for odd in ["0", "-0.01", "INF", "NaN"] {
        assert!(restores(&[("stepSize=\"0.01\"", &format!("stepSize=\"{odd}\""))], "0"), "{odd}");
    }
}

#[test]
fn law_a_parameter_that_a_reset_leaves_shows() {
    let leaves = (
        "API int fmi2Reset(void *c) { start(c); return 0; }",
        "API int fmi2Reset(void *c) { start(c); ((Unit *)c)->r[FAULT_TIME] = 1e200; return 0; }",
    );
    assert!(!instance(&Units::new(), &[], &[leaves]).fmu().restores());
}

#[test]
fn law_an_instance_that_is_dropped_is_ended_and_freed() {
    // It gives no other one before; and it is to be terminated if it came out of initialization mode, else not.
    let counts = [
        ("API void *fmi2Instantiate(", "static int alive, owed;\nAPI void *fmi2Instantiate("),
        ("    if (type != 1 ||", "    if (owed || alive++) return NULL;\n    if (type != 1 ||"),
        ("API void fmi2FreeInstance(void *c) { ", "API void fmi2FreeInstance(void *c) { alive--; "),
        (
            "    u->x = u->r[X0];\n    outputs(u, 0, 0);\n    u->init",
            "    owed++;\n    u->x = u->r[X0];\n    outputs(u, 0, 0);\n    u->init",
        ),
        ("API int fmi2Terminate(void *c) { ", "API int fmi2Terminate(void *c) { owed--; "),
    ];
    let units = Units::new();
    let mut one = instance(&units, &[], &counts);
    let fmu = one.fmu().clone();
    for stepped in [false, true, false] {
        one.setup_experiment(0.0, None).expect("set up");
        one.enter_initialization().expect("enters");
        if stepped {
            one.exit_initialization().expect("exits");
        }
        drop(one);
        one = fmu.instantiate("another").unwrap_or_else(|error| panic!("stepped {stepped}: {error}"));
    }
}

#[test]
fn law_a_unit_whose_step_was_fatal_is_called_no_more_and_one_that_failed_is_only_freed() {
    // It gives no other one once it was called when it may not be.
    let minds = [
        ("API void *fmi2Instantiate(", "static int ended, freed;\nAPI void *fmi2Instantiate("),
        ("    if (type != 1 ||", "    if (ended || freed != FREED) return NULL;\n    if (type != 1 ||"),
        ("API void fmi2FreeInstance(void *c) { ", "API void fmi2FreeInstance(void *c) { freed++; "),
        ("API int fmi2Terminate(void *c) { ", "API int fmi2Terminate(void *c) { ended++; "),
    ];
    for (fault, freed) in [(3, "1"), (4, "0")] {
        let born = minds[1].1.replace("FREED", &format!("(born++ ? {freed} : 0)"));
        let born = ("    if (type != 1 ||", &*format!("    static int born;\n{born}"));
        let mut one = instance(&Units::new(), &[], &[minds[0], born, minds[2], minds[3]]);
        let fmu = one.fmu().clone();
        one.set_integer(&[2], &[fault]).expect("fault");
        one.set_real(&[6], &[0.0]).expect("fault_time");
        one.setup_experiment(0.0, None).expect("set up");
        one.enter_initialization().expect("enters");
        one.exit_initialization().expect("exits");
        assert_eq!(one.do_step(0.0, 0.5, true), orchestrator::fmu::Status::from(fault));
        drop(one);
        fmu.instantiate("another").unwrap_or_else(|error| panic!("fault {fault}: {error}"));
    }
}

#[test]
fn law_resources_are_told_as_an_address() {
    let tells = (
        "    u->callbacks = callbacks;\n    start(u);\n",
        "    u->callbacks = callbacks;\n    start(u);\n    callbacks->logger(callbacks->environment, name, 1, \"events\", \"%s\", resources);\n",
    );
    let unit = instance(&Units::new(), &[], &[tells]);
    let log = unit.log();
    let path = log[0].text.strip_prefix("file://").expect("a file's address");
    assert!(path.starts_with('/') && !path.starts_with("//"), "{path}");
    assert!(path.ends_with("/resources") && std::path::Path::new(path).is_dir(), "{path}");
}

#[test]
fn law_a_guess_is_set_before_initialization_mode_only() {
    // In the mode it is the unit's to compute.
    let guess = (
        "name=\"k\" valueReference=\"4\" causality=\"parameter\" variability=\"tunable\"",
        "name=\"k\" valueReference=\"4\" causality=\"local\" variability=\"continuous\" initial=\"approx\"",
    );
    let computes = (
        "    ((Unit *)c)->initialising = 1;\n",
        "    ((Unit *)c)->initialising = 1;\n    ((Unit *)c)->r[K] *= 2;\n",
    );
    let units = Units::new();
    let exact = (guess.0, &*guess.1.replace("approx", "exact"));
    for (described, expected) in [(&[guess][..], 6.0), (&[exact], 3.0), (&[], 3.0)] {
        for begin in [
            Begin { settings: &[(4, Value::Real(3.0))], ..Begin::default() },
            Begin { reals: &[4], values: &[3.0], ..Begin::default() },
        ] {
            let mut unit = instance(&units, described, &[computes]);
            unit.begin(0.0, None, begin).expect("begins");
            let mut k = [0.0];
            unit.get_real(&[4], &mut k).expect("read");
            assert_eq!(k, [expected], "{begin:?}");
        }
    }
}

#[test]
fn law_a_unit_is_asked_for_errors_and_warnings_only() {
    let tells = (
        "    (void)c; (void)on; (void)n; (void)names;\n",
        "    Unit *u = c;\n    u->callbacks->logger(u->callbacks->environment, \"u\", 1, \"events\", \"%d: %d %s\", on, (int)n, names[0]);\n",
    );
    let log = |described: &[(&str, &str)]| {
        let unit = instance(&Units::new(), described, &[tells]);
        unit.log().iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    assert_eq!(log(&[]), ["[warning, events] 1: 1 logStatusError"]);
    // One that does not tell them apart is not asked.
    assert!(log(&[("<Category name=\"logStatusError\"/>", "")]).is_empty());
}

#[test]
fn law_the_newest_lines_of_a_log_are_kept() {
    let tells = (
        "    (void)no_return;\n",
        "    (void)no_return;\n    u->callbacks->logger(u->callbacks->environment, \"u\", 1, \"events\", \"%g\", from);\n",
    );
    let mut unit = instance(&Units::new(), &[], &[tells]);
    unit.setup_experiment(0.0, None).expect("set up");
    unit.enter_initialization().expect("enters");
    unit.exit_initialization().expect("exits");
    let mut step = |count: u32| {
        for number in 0..count {
            assert_eq!(unit.do_step(f64::from(number), 1.0, true), Status::Ok);
        }
        unit.log().into_iter().map(|line| line.text).collect::<Vec<_>>()
    };
    assert_eq!(step(3), ["0", "1", "2"]);
    // the newest are kept
    let many = step(1000);
    assert_eq!(many.len(), 256);
    assert_eq!((many[0].as_str(), many[255].as_str()), ("744", "999"));
}

#[test]
fn every_text_of_a_call_arrives() {
    // One, few and many: each is handed over another way.
    let mut unit = instance(&Units::new(), &[], &[]);
    for count in [1, 2, 7, 8, 9, 40] {
        let references: Vec<u32> = (0..count).map(|at| at % 2).collect();
        let sent: Vec<String> = (0..count).map(|at| format!("{} of {count}", at % 2)).collect();
        unit.set_string(&references, &sent).expect("set");
        let mut found = vec![String::new(); count as usize];
        unit.get_string(&references, &mut found).expect("read");
        assert_eq!(found, sent);
    }
}

#[test]
fn value_derivatives_are_those_of_the_unit() {
    let derivative = (
        "#ifdef LINES\n",
        "API int fmi2GetDirectionalDerivative(void *c, const unsigned *z, size_t nz, const unsigned *v, size_t nv, const double *dv,\n\
         double *dz) {\n    for (size_t i = 0; i < nz; i++) {\n        dz[i] = 0;\n        for (size_t j = 0; j < nv; j++) {\n\
         if (z[i] == Y1 && v[j] == U1) dz[i] += ((Unit *)c)->r[K] * dv[j];\n            if (z[i] == Y2 && v[j] == U2) dz[i] += dv[j];\n\
         }\n    }\n    return 0;\n}\n#define LINES\n#ifdef LINES\n",
    );
    let mut unit = instance(&Units::new(), &[], &[derivative]);
    unit.set_real(&[4], &[3.0]).expect("k");
    let mut found = [f64::NAN; 3];
    unit.directional_derivative(&[2, 3, 2], &[0, 1], &[2.0, 5.0], &mut found).expect("known");
    assert_eq!(found, [6.0, 5.0, 6.0]);
    let told = |result: Result<(), orchestrator::Error>| result.expect_err("of other lengths").to_string();
    let name = "unit a: fmi2GetDirectionalDerivative called with";
    let few = told(unit.directional_derivative(&[2], &[0, 1], &[1.0], &mut [0.0]));
    assert_eq!(few, format!("{name} 2 references and 1 values"));
    let none = told(unit.directional_derivative(&[2, 3], &[0], &[1.0], &mut [0.0]));
    assert_eq!(none, format!("{name} 2 references and 1 values"));
    // Slopes of inputs and outputs, of first order.
    unit.setup_experiment(0.0, None).expect("set up");
    unit.enter_initialization().expect("enters");
    unit.exit_initialization().expect("exits");
    unit.set_input_derivatives(&[0], &[1], &[4.0]).expect("taken");
    assert_eq!(unit.do_step(0.0, 0.5, true), Status::Ok);
    let mut slope = [0.0];
    unit.get_output_derivatives(&[2], &[1], &mut slope).expect("told");
    assert_eq!(slope, [3.0 * 4.0 * 0.5], "k times what u1 has become");
    for (orders, values) in [(&[1, 1][..], &[0.0][..]), (&[1], &[0.0, 0.0])] {
        let set = told(unit.set_input_derivatives(&[0], orders, values));
        assert_eq!(set, "unit a: fmi2SetRealInputDerivatives called with 1 references and 2 values");
        let get = told(unit.get_output_derivatives(&[2], orders, &mut values.to_vec()));
        assert_eq!(get, "unit a: fmi2GetRealOutputDerivatives called with 1 references and 2 values");
    }
}

#[test]
fn law_a_unit_that_rounds_another_way_changes_nobody_elses_numbers() {
    let units = Units::new();
    let text = "format = 1\nexperiment = { stop = 1 }\n[[units]]\nname = \"a\"\nfmu = \"stateful.fmu\"\ninterval = 0.25\n\
                set = { fault = 27, fault_time = 0.25 }\n";
    let scenario = Scenario::parse(text, "test.toml").expect("a scenario");
    let mut simulation = Simulation::new(&scenario, &units.unit_path()).expect("builds");
    simulation.run(&mut MemoryRecorder::new(), &mut Quiet).expect("runs");
    let told = simulation.notices();
    assert!(told.iter().any(|notice| notice.contains("unit a") && notice.contains("round")), "{told:?}");
    // Upwards this would be the next number above one.
    assert_eq!(std::hint::black_box(1.0) + std::hint::black_box(1e-17), 1.0);
}

#[test]
fn every_probe_tells_what_the_unit_answers() {
    let refuses = [
        ("    free(*state);\n", "    if (!*state) return 3;\n    free(*state);\n"),
        ("    u->set_up = 1;\n", "    u->set_up = 1;\n    if (u->r[K] > 1) return 3;\n"),
    ];
    let mut honest = instance(&Units::new(), &[], &[]);
    honest.free_no_state().expect("passed over");
    honest.access_nothing().expect("nothing to be read or set");
    let mut other = instance(&Units::new(), &[], &refuses);
    assert!(other.free_no_state().is_err());
}

#[test]
fn law_types_may_be_defined_after_their_variables() {
    let units = Units::new();
    let text = description(STATEFUL);
    let types = "<TypeDefinitions><SimpleType name=\"Positive\"><Real min=\"0\" unit=\"m\"/></SimpleType></TypeDefinitions>";
    let late =
        text.replace(types, "").replace("</fmiModelDescription>", &format!("{types}</fmiModelDescription>"));
    assert_ne!(late, text);
    let read =
        |text: &str| Fmu::open(units.pack("types.fmu", text, &[])).expect("opens").description().clone();
    assert_eq!(read(&late).variables, read(&text).variables);
    let place = read(&late).place("fault_time").expect("there");
    assert_eq!(read(&late).variables[place].min, Some(0.0));
}

#[test]
fn every_name_of_a_library_is_one_of_c() {
    let units = Units::new();
    let opens = |identifier: &str| {
        let text = description(STATEFUL)
            .replace("modelIdentifier=\"unit\"", &format!("modelIdentifier=\"{identifier}\""));
        Fmu::open(units.pack("named.fmu", &text, &[])).is_ok()
    };
    for (identifier, is_one) in [
        ("unit", true),
        ("_unit_1", true),
        ("1unit", false),
        ("", false),
        ("../unit", false),
        ("u-nit", false),
        ("-unit", false),
    ] {
        assert_eq!(opens(identifier), is_one, "{identifier}");
    }
}
