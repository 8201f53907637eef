//! What is wrong in a scenario or a unit is said with file, line, name and what would be right.

use crate::common;

use crate::common::{FEEDTHROUGH, Fixture, STATEFUL, Units};
use orchestrator::{Error, Fmu, MemoryRecorder, Quiet, Scenario, Simulation};

/// Two units `a` and `b`; what a test adds begins at line 10.
const BASE: &str = "format = 1
experiment = { stop = 1 }
[[units]]
name = \"a\"
fmu = \"stateful.fmu\"
interval = 0.125
[[units]]
name = \"b\"
fmu = \"stateful.fmu\"
interval = 0.125
";

fn build(units: &Units, text: &str) -> Result<Simulation, Error> {
    Simulation::new(&Scenario::parse(text, "test.toml")?, &units.unit_path())
}

fn message(units: &Units, text: &str) -> String {
    match build(units, text) {
        Ok(_) => panic!("no error for:\n{text}"),
        Err(error) => {
            assert!(error.is_input(), "{error}");
            error.to_string()
        }
    }
}

fn connection(from: &str, to: &str) -> String {
    format!("[[connections]]\nfrom = \"{from}\"\nto = \"{to}\"\n")
}

#[test]
fn every_mistake_in_a_scenario_is_named() {
    let units = Units::new();
    let with = |extra: &str| format!("{BASE}{extra}");
    let way = |extra: &str| with(&format!("{}{extra}\n", connection("a.y1", "b.u1")));
    let source = |kind: &str| with(&format!("[[sources]]\nto = \"a.u1\"\n{kind}\n"));
    for (text, expected) in [
        (
            "format = 2\nunits = []\nexperiment = { stop = 1 }".into(),
            "test.toml:1: format = 2: this program reads format = 1",
        ),
        (
            BASE.replace("stop = 1", "stopp = 1"),
            "test.toml:2: not a scenario: unknown field `stopp`, expected one of `start`, `stop`, `algorithm`",
        ),
        (BASE.replace("stop = 1", "stop = -1"), "test.toml:2: stop = -1: not before start = 0"),
        (
            BASE.replace("stop = 1", "stop = 1, algorithm = \"jacoby\""),
            "test.toml:2: there is no algorithm \"jacoby\": did you mean jacobi?",
        ),
        (BASE.replacen("0.125", "\"1/x\"", 1), "test.toml:6: interval = \"1/x\": a time in s"),
        (BASE.replacen("0.125", "0", 1), "test.toml:6: interval = 0: greater than zero"),
        (BASE.replacen("0.125", "\"1/9223372036854775807\"", 1), "have no common tick that fits 64 bits"),
        (BASE.replace("\"b\"", "\"a\""), "test.toml:8: a second unit \"a\": the first one is at test.toml:3"),
        (BASE.replace("\"b\"", "\"\""), "test.toml:8: unit name \"\": a name without dots"),
        (BASE.replace("\"b\"", "\"b.c\""), "test.toml:8: unit name \"b.c\": a name without dots, stars"),
        (BASE.replace("\"b\"", "\"b*\""), "test.toml:8: unit name \"b*\": a name without dots, stars"),
        (
            BASE.replace("\"b\"", "\"b=\""),
            "test.toml:8: unit name \"b=\": a name without dots, stars, equal signs",
        ),
        (BASE.replace("\"b\"", "\"b c\""), "test.toml:8: unit name \"b c\": a name without dots"),
        (
            BASE.replacen("stateful", "stateless", 1),
            "test.toml:5: fmu = \"stateless.fmu\" was not found: looked in .",
        ),
        (with("[units.set]\nx_0 = 1"), "test.toml:12: unit b has no variable \"x_0\": did you mean x0?"),
        (with("[units.set]\nx0 = \"1\""), "test.toml:12: b.x0 = \"1\": it is of type Real"),
        (with("[units.set]\nmode = 1.5"), "b.mode = 1.5: it is of type Integer: a whole number from 0 to 2"),
        (with("[units.set]\nb_in = \"maybe\""), "b.b_in = \"maybe\": it is of type Boolean: true or false"),
        (with("[units.set]\nmode = 3"), "test.toml:12: b.mode = 3: a number from 0 to 2"),
        (with("[units.set]\nfault_time = -1"), "test.toml:12: b.fault_time = -1: a number of 0 m or more"),
        (with("[units.set]\nx0 = nan"), "test.toml:12: b.x0 = nan: a finite number"),
        (with("[units.set]\ny1 = 1"), "test.toml:12: b.y1 is computed by the unit: only parameters, inputs"),
        (
            with(&connection("a.y9", "b.u1")),
            "test.toml:11: unit a has no variable \"y9\": did you mean y1 (or y2)?",
        ),
        (with(&connection("c.y1", "b.u1")), "test.toml:11: there is no unit \"c\": did you mean a (or b)?"),
        (
            with(&connection("a.u1", "b.u1")),
            "test.toml:11: a.u1 is an input: a connection begins at an output (did you mean y1 (or y2)?)",
        ),
        (with(&connection("a.y1", "b.y1")), "test.toml:11: b.y1 is an output: only an input can be driven"),
        (
            with(&connection("a.y1", "b.k")),
            "test.toml:11: b.k is a parameter: only an input can be driven; give parameters their values in [units.set]",
        ),
        (
            with(&connection("a.y1", "b.i_in")),
            "test.toml:11: a.y1 is of type Real, b.i_in of type Integer: a Real would lose digits",
        ),
        (
            with(&connection("a.s_out", "b.u1")),
            "test.toml:11: a.s_out is of type String, b.u1 of type Real: a String goes only to a String",
        ),
        (
            with(&[connection("a.y1", "b.u1"), connection("a.y2", "b.u1")].concat()),
            "test.toml:14: a second signal for the input b.u1: the first one is at test.toml:11",
        ),
        (
            with(&format!("{}delay = -0.5", connection("a.y1", "b.u1"))),
            "test.toml:14: delay = -1/2: not less than zero",
        ),
        (way("latency = -0.5"), "test.toml:14: latency = -1/2: not less than zero"),
        (way("latency = \"soon\""), "test.toml:14: latency = \"soon\": a time in s"),
        (
            way("latency = 1\ndelay = 1"),
            "test.toml:15: delay beside latency: it is the old name of latency; keep one of them",
        ),
        (way("jitter = -1"), "test.toml:14: jitter = -1: not less than zero"),
        (way("jitter = nan"), "test.toml:14: jitter = nan: a time in s"),
        (
            way("drop = 1.5"),
            "test.toml:14: drop = 1.5: the share of values that are lost, a number from 0 to 1",
        ),
        (way("drop = nan"), "test.toml:14: drop = nan: the share"),
        (way("drop = \"half\""), "test.toml:14: drop = \"half\": the share"),
        (way("hold = \"liner\""), "test.toml:14: hold = \"liner\": zero or linear; did you mean linear?"),
        (
            BASE.replace("stop = 1", "stop = 1, options = { tolerance = 1 }"),
            "test.toml:2: algorithm \"gauss-seidel\" has no option \"tolerance\": it has no options",
        ),
        (
            BASE.replace("stop = 1", "stop = 1, algorithm = \"iterated\", options = { tolerence = 1 }"),
            "test.toml:2: algorithm \"iterated\" has no option \"tolerence\": did you mean tolerance",
        ),
        (
            BASE.replace("stop = 1", "stop = 1, algorithm = \"iterated\", options = { tolerance = 0 }"),
            "test.toml:2: tolerance = 0: a number from 0.000000000000001 to 1",
        ),
        (
            BASE.replace("stop = 1", "stop = 1, algorithm = \"iterated\", options = { iterations = 2.5 }"),
            "test.toml:2: iterations = 2.5: a whole number from 2 to 1000000",
        ),
        (
            BASE.replace("stop = 1", "stop = 1, algorithm = \"step-halving\"").replacen("0.125", "0.25", 1),
            "test.toml:7: algorithm \"step-halving\" with units at different points: a, b: the same interval and offset",
        ),
        (
            with("[record]\nvariables = [\"b.y1:error\"]"),
            "test.toml:12: b.y1:error with algorithm \"gauss-seidel\": algorithm = \"step-halving\", which estimates errors",
        ),
        (
            with("[record]\nvariables = [\"*:error\"]"),
            "test.toml:12: nothing matches \"*:error\": errors of Real outputs, by algorithm = \"step-halving\"",
        ),
        (way("seed = 3"), "test.toml:14: seed: it goes with jitter or drop"),
        (way("drop = 0.1\nseed = -3"), "test.toml:15: seed = -3: an integer, not less than zero"),
        (BASE.replace("stop = 1", "stop = 1, seed = -1"), "test.toml:2: seed = -1: an integer, not less"),
        (
            with(&format!("{}hold = \"linear\"", connection("a.i_out", "b.i_in"))),
            "test.toml:11: hold = \"linear\" from a.i_out to b.i_in: only a Real lies on a line",
        ),
        (
            with(&format!("{}hold = \"linear\"", connection("a.i_out", "b.u1"))),
            "test.toml:11: hold = \"linear\" from a.i_out to b.u1: only a Real lies on a line",
        ),
        (
            BASE.replacen("0.125", "0.125\noffset = 0.125", 1),
            "test.toml:7: offset = 1/8: less than the interval of 1/8 s",
        ),
        (
            BASE.replacen("0.125", "0.125\noffset = -0.1", 1),
            "test.toml:7: offset = -1/10: not less than zero",
        ),
        (
            with("[record]\nvariables = [\"b.u1:age\"]"),
            "test.toml:12: b.u1:age: no connection leads to b.u1: an age is that of a value that came through one",
        ),
        (
            way("[record]\nvariables = [\"b.u2:age\"]"),
            "test.toml:15: b.u2:age: no connection leads to b.u2: an age is that of a value that came through one (did \
             you mean b.u1:age?)",
        ),
        (
            way("[record]\nvariables = [\"b.u9:age\"]"),
            "test.toml:15: unit b has no variable \"u9\": did you mean u1",
        ),
        (way("[record]\nvariables = [\"c*:age\"]"), "test.toml:15: nothing matches \"c*:age\""),
        (source("kind = \"cubic\""), "test.toml:13: kind = \"cubic\": constant, hold, linear, smooth or csv"),
        (source("kind = \"linear\""), "test.toml:11: a source of kind \"linear\": it needs points"),
        (source("kind = \"constant\"\nvalue = nan"), "test.toml:11: value = nan: a finite number"),
        (source("kind = \"constant\"\nvalue = -inf"), "test.toml:11: value = -inf: a finite number"),
        (
            source("kind = \"linear\"\npoints = [[0, 0]]\nvalue = 1"),
            "test.toml:11: a source of kind \"linear\": it has no key value",
        ),
        (
            source("kind = \"linear\"\npoints = [[1, 0], [0, 0]]"),
            "test.toml:14: time 0 comes after 1: times in rising order",
        ),
        (
            source("kind = \"csv\"\nfile = \"none.csv\"\ncolumn = \"x\""),
            "test.toml:11: file none.csv: No such file",
        ),
        (
            with("[[sources]]\nto = \"a.b_in\"\nkind = \"linear\"\npoints = [[0, 1]]"),
            "a continuous signal for an input of type Boolean: kind = \"hold\"",
        ),
        (
            with("[record]\nvariables = [\"c.*\"]"),
            "test.toml:12: nothing matches \"c.*\": there is no unit \"c\"",
        ),
        (with("[record]\nvariables = [\"a.y1\", \"a.z\"]"), "test.toml:12: unit a has no variable \"z\""),
    ] {
        let found = message(&units, &text);
        assert!(found.contains(expected), "expected: {expected}\nfound:    {found}");
    }
}

#[test]
fn every_override_is_checked() {
    let units = Units::new();
    let mut scenario = Scenario::parse(BASE, "test.toml").expect("a scenario");
    assert_eq!(
        scenario.set("k=1", "1").expect_err("no dot").to_string(),
        "--set k=1=1: \"k=1\" names no unit: write unit.variable=value, e.g. camera.k1=0.1"
    );
    assert_eq!(
        scenario.set("bb.k", "1").expect_err("no unit").to_string(),
        "--set bb.k=1: there is no unit \"bb\": did you mean b (or a)?"
    );
    scenario.set("a.k", "a lot").expect("checked when built");
    let error = Simulation::new(&scenario, &units.unit_path()).err().expect("no number").to_string();
    assert_eq!(error, "--set a.k=a lot: a.k = a lot: it is of type Real: a number of 1000000 or less");
    // A later one replaces an earlier one.
    scenario.set("a.k", "2.5").expect("a unit");
    scenario.set("a.b_in", "1").expect("a unit");
    let mut simulation = Simulation::new(&scenario, &units.unit_path()).expect("builds");
    assert_eq!(simulation.value("a.k").expect("known"), 2.5);
    assert_eq!(simulation.value("a.b_out").expect("known"), 0.0);
}

#[test]
fn every_status_is_handled() {
    let units = Units::new();
    let run = |fault: i32| {
        let text = BASE.replacen(
            "interval = 0.125",
            &format!("interval = 0.125\nset = {{ fault = {fault}, fault_time = 0.25 }}"),
            1,
        ) + &connection("a.y1", "b.u1");
        let mut simulation = build(&units, &text).expect("builds");
        let mut results = MemoryRecorder::new();
        let ended = simulation.run(&mut results, &mut Quiet).map_err(|error| {
            assert!(!error.is_input(), "{error}");
            // The same simulation runs again: a failed unit is reset or replaced.
            assert_eq!(
                simulation.run(&mut MemoryRecorder::new(), &mut Quiet).expect_err("again").to_string(),
                error.to_string()
            );
            error.to_string()
        });
        (ended.map(|_| simulation.notices()), results.times().last().copied())
    };
    let (warned, last) = run(1);
    assert_eq!(last, Some(1.0), "a warning stops nothing");
    let notices = warned.expect("goes on");
    assert_eq!(
        notices,
        [
            "unit a answered 7 calls with a warning; last log line: [warning, logStatusError] fault 1 at 0.875 100%"
        ]
    );
    for (fault, expected) in [
        (
            2,
            "unit a: the step from t = 0.125 s by 0.125 s was discarded by the unit, which reached t = 0.125 s; a smaller interval may help, or `retry = true` of the unit\n  [discard, logStatusError] fault 2 at 0.125 100%",
        ),
        (
            3,
            "unit a: fmi2DoStep at t = 0.125 s answered error\n  [error, logStatusError] fault 3 at 0.125 100%",
        ),
        (
            4,
            "unit a: fmi2DoStep at t = 0.125 s answered fatal\n  [fatal, logStatusError] fault 4 at 0.125 100%",
        ),
        (5, "unit a: fmi2DoStep at t = 0.125 s answered pending\n"),
        (42, "unit a: fmi2DoStep at t = 0.125 s answered unknown status 42\n"),
        (7, "a.y1 is NaN at t = 0.25 s; the run stops before another unit gets it"),
        (16, "a.y1 is inf at t = 0.25 s; the run stops before another unit gets it"),
    ] {
        let (result, last) = run(fault);
        let error = result.expect_err("stops");
        assert!(error.starts_with(expected), "expected: {expected}\nfound:    {error}");
        assert_eq!(last, Some(0.125), "what was there before the fault stays recorded");
    }
}

#[test]
fn law_a_full_disk_of_a_unit_is_the_machines() {
    let units = Units::new();
    let error = |fault: i32| {
        let set = format!("interval = 0.125\nset = {{ fault = {fault}, fault_time = 0.25 }}");
        let mut simulation = build(&units, &BASE.replacen("interval = 0.125", &set, 1)).expect("builds");
        simulation.run(&mut MemoryRecorder::new(), &mut Quiet).expect_err("stops")
    };
    let (full, other) = (error(32), error(3));
    assert!(full.to_string().contains("my file: "), "{full}");
    assert!(!full.is_input() && !other.is_input());
}

#[test]
fn every_broken_unit_is_named() {
    let units = Units::new();
    let error = |path: &std::path::Path| {
        let error = Fmu::open(path).and_then(|fmu| fmu.instantiate("a").map(|_| ())).expect_err("broken");
        assert!(error.is_input(), "exit status 2: {error}");
        error.to_string()
    };
    let folder = units.path();
    std::fs::write(folder.join("text.fmu"), "no archive").expect("writable");
    let good = common::description(STATEFUL);
    let library = common::library();
    units.pack("version.fmu", &good.replace("fmiVersion=\"2.0\"", "fmiVersion=\"3.0\""), &library);
    units.pack("index.fmu", &good.replace("index=\"9\"", "index=\"99\""), &library);
    units.pack("exchange.fmu", &good.replace("CoSimulation", "ModelExchange"), &library);
    units.pack("open.fmu", "<fmiModelDescription fmiVersion=\"2.0\">\n<a>\n", &library);
    units.pack_files(
        "name.fmu",
        &good.replace("\"unit\"", "\"other\""),
        &[("binaries/linux64/unit.so", &library), ("binaries/linux64/more.so", &library)],
    );
    units.pack("outside.fmu", &good.replace("\"unit\"", "\"../../elsewhere/probe\""), &library);
    units.pack("absolute.fmu", &good.replace("\"unit\"", "\"/elsewhere/probe\""), &library);
    units.pack("noelf.fmu", &good, b"no library");
    units.add(Fixture { name: "guid.fmu", guid: "{other}", ..FEEDTHROUGH });
    for (name, expected) in [
        ("none.fmu", "none.fmu: No such file"),
        ("text.fmu", "text.fmu: not a usable FMU: "),
        (
            "version.fmu",
            "version.fmu: modelDescription.xml:4: fmiVersion is \"3.0\"; this master runs FMI \"2.0\"",
        ),
        ("index.fmu", "index.fmu: modelDescription.xml:40: index 99 in ModelStructure is not within 1..15"),
        ("exchange.fmu", "there is no <CoSimulation>; a unit for model exchange can't be stepped"),
        ("open.fmu", "open.fmu: modelDescription.xml:3: "),
        ("name.fmu", "name.fmu: it holds no binaries/linux64/other.so (platforms inside: linux64)"),
        (
            "outside.fmu",
            "modelDescription.xml:6: modelIdentifier=\"../../elsewhere/probe\" is no C identifier",
        ),
        ("absolute.fmu", "modelDescription.xml:6: modelIdentifier=\"/elsewhere/probe\" is no C identifier"),
        ("noelf.fmu", "noelf.fmu: "),
        (
            "guid.fmu",
            "fmi2Instantiate gave no instance\n  [error, logStatusError] guid is {other}, not {fixture}",
        ),
    ] {
        let found = error(&folder.join(name));
        assert!(found.contains(expected), "expected: {expected}\nfound:    {found}");
    }
}

#[test]
fn every_call_checks_its_lengths() {
    let units = Units::new();
    let fmu = Fmu::open(units.path().join("stateful.fmu")).expect("opens");
    let mut instance = fmu.instantiate("a").expect("instantiates");
    drop(fmu); // the folder and the library live on with the instance
    let error = instance.get_real(&[2, 3], &mut [0.0]).expect_err("too short").to_string();
    assert_eq!(error, "unit a: fmi2GetReal called with 2 references and 1 values");
    assert!(matches!(instance.set_boolean(&[], &[1]), Err(Error::Lengths { .. })));
    assert!(matches!(instance.set_string(&[0], &[]), Err(Error::Lengths { .. })));
    let derivative = instance.directional_derivative(&[2], &[0], &[1.0], &mut [0.0]);
    assert!(matches!(derivative, Err(Error::Missing { function: "fmi2GetDirectionalDerivative", .. })));
    instance.set_string(&[0], &["ä%s".into()]).expect("set");
    instance.setup_experiment(0.0, None).expect("set up");
    instance.enter_initialization().expect("enters");
    let mut text = [String::new()];
    instance.get_string(&[1], &mut text).expect("read");
    assert_eq!(text, ["ä%s"]);
}

#[test]
fn law_a_unit_that_lives_once_per_process_gets_a_library_of_its_own() {
    let units = Units::new();
    let once = "canBeInstantiatedOnlyOncePerProcess=\"true\" modelIdentifier";
    units.pack(
        "stateful.fmu",
        &common::description(STATEFUL).replace("modelIdentifier", once),
        &common::library(),
    );
    let mut simulation = build(&units, &(BASE.to_owned() + &connection("a.y1", "b.u1"))).expect("builds");
    simulation.set("a.x0", 1.0).expect("known");
    simulation.run(&mut MemoryRecorder::new(), &mut Quiet).expect("runs");
    assert_eq!(simulation.value("b.y1").expect("known"), 1.0, "one times a second");
}
