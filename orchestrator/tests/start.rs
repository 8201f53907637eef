//! The start: values along dependencies, loops, conversions; and what a simulation can do besides running.

mod common;

use common::{FEEDTHROUGH, Fixture, STATEFUL, Units};
use orchestrator::{
    Comparison, CsvRecorder, Ended, Error, MemoryRecorder, Quiet, Scenario, Simulation, Value,
};

fn unit(name: &str, fmu: &str, set: &str) -> String {
    format!("[[units]]\nname = \"{name}\"\nfmu = \"{fmu}\"\ninterval = 0.125\nset = {{ {set} }}\n")
}

fn connection(from: &str, to: &str) -> String {
    format!("[[connections]]\nfrom = \"{from}\"\nto = \"{to}\"\n")
}

fn build(units: &Units, parts: &[String]) -> Result<Simulation, Error> {
    let text = format!("format = 1\nexperiment = {{ stop = 1 }}\n{}", parts.concat());
    Simulation::new(&Scenario::parse(&text, "test.toml")?, &units.unit_path())
}

#[test]
fn law_simulations_go_to_other_threads() {
    fn sends<T: Send>() {}
    fn shares<T: Send + Sync>() {}
    sends::<Simulation>();
    shares::<orchestrator::UnitPath>();
    shares::<Scenario>();
    let units = Units::new();
    let path = units.unit_path();
    let text = format!("format = 1\nexperiment = {{ stop = 1 }}\n{}", unit("a", "stateful.fmu", "u1 = 1"));
    let scenario = Scenario::parse(&text, "test.toml").expect("a scenario");
    let last = |k: f64| {
        let mut simulation = Simulation::new(&scenario, &path).expect("builds");
        simulation.set("a.k", k).expect("before a run");
        simulation.run(&mut orchestrator::NoRecorder, &mut Quiet).expect("runs");
        simulation.value("a.y1").expect("known")
    };
    std::thread::scope(|scope| {
        let runs = [1.0, 2.0, 3.0].map(|k| scope.spawn(move || last(k)));
        assert_eq!(runs.map(|run| run.join().expect("no panic")), [1.0, 2.0, 3.0]);
    });
}

#[test]
fn law_start_values_go_along_the_dependencies() {
    // A chain of gains in the wrong order: c needs b, b needs a.
    let parts = [
        unit("c", "feedthrough.fmu", "mode = 1, k = 5"),
        unit("b", "feedthrough.fmu", "mode = 1, k = 3, u1 = 9"),
        unit("a", "stateful.fmu", "x0 = 2"),
        connection("b.y1", "c.u1"),
        connection("a.y1", "b.u1"),
    ];
    let mut simulation = build(&Units::new(), &parts).expect("builds");
    assert_eq!(simulation.value("c.y1").expect("known"), 30.0);
    assert_eq!(simulation.replaced_starts(), ["b.u1 = 9.0 (now 2.0)", "c.u1 = 0.0 (now 6.0)"]);
    assert!(simulation.notices().is_empty());
}

#[test]
fn value_a_loop_that_settles_is_solved_by_going_round() {
    // y = 0.5 u + 1, u = y.
    let parts = [unit("a", "feedthrough.fmu", "mode = 1, k = 0.5, x0 = 1"), connection("a.y1", "a.u1")];
    let mut simulation = build(&Units::new(), &parts).expect("builds");
    // It ends within 1e-10 of itself, so within twice that of the solution.
    assert!((simulation.value("a.y1").expect("known") - 2.0).abs() < 1e-9);
    let told = simulation.notices().pop().expect("told");
    assert!(told.contains("at initialisation: solved in ") && told.ends_with(" iterations"), "{told}");
}

#[test]
fn value_sources_hold_at_the_start_where_they_lead() {
    let source = |to: &str, value: &str| {
        format!("[[sources]]\nto = \"{to}\"\nkind = \"hold\"\npoints = [[0, {value}], [9, 0]]\n")
    };
    let parts = [
        unit("a", "feedthrough.fmu", "mode = 1"),
        source("a.u2", "5"),
        source("a.i_in", "7"),
        source("a.b_in", "1"),
    ];
    let mut simulation = build(&Units::new(), &parts).expect("builds");
    let found = ["a.y1", "a.y2", "a.i_out", "a.b_out"].map(|name| simulation.value(name).expect("known"));
    assert_eq!(found, [0.0, 5.0, 8.0, 0.0]);
}

#[test]
fn every_source_of_whole_values_is_looked_at() {
    let source = |to: &str, what: &str| format!("[[sources]]\nto = \"a.{to}\"\n{what}\n");
    let hold = |points: &str| format!("kind = \"hold\"\npoints = {points}");
    let units = Units::new();
    let out = |name: &str, sources: &str| -> Result<f64, String> {
        let mut simulation = build(&units, &[unit("a", "stateful.fmu", ""), sources.to_owned()])
            .map_err(|error| error.to_string())?;
        simulation.run(&mut MemoryRecorder::new(), &mut Quiet).map_err(|error| error.to_string())?;
        simulation.value(name).map_err(|error| error.to_string())
    };
    assert_eq!(out("a.b_out", &source("b_in", &hold("[[0, 0], [0.5, 1]]"))), Ok(0.0));
    assert_eq!(out("a.b_out", &source("b_in", &hold("[[0, 1], [0.5, 0]]"))), Ok(1.0));
    assert_eq!(out("a.i_out", &source("i_in", &hold("[[0, -3], [0.5, 4]]"))), Ok(5.0));
    // A table may jump: at the ends of steps of 1/8 s three times 1 and five times 3.
    assert_eq!(
        out("a.y1", &source("u1", "kind = \"linear\"\npoints = [[0, 1], [0.5, 1], [0.5, 3], [1, 3]]")),
        Ok(2.25)
    );
    for (sources, expected) in [
        (source("b_in", &hold("[[0, 0], [0.5, 2]]")), "the value 2 at 0.5 s: the input is of type Boolean"),
        (
            source("i_in", &hold("[[0, 0], [0.5, 1.5]]")),
            "the value 1.5 at 0.5 s: the input is of type Integer",
        ),
        (source("i_in", &hold("[[0, 3e9]]")), "the value 3000000000 at 0 s: the input is of type Integer"),
        (source("u1", &hold("[]")), "points: one or more [time, value], all finite"),
        (source("u1", &hold("[[0, 1], [1, nan]]")), "points: one or more [time, value], all finite"),
        (source("s_in", &hold("[[0, 1]]")), "a table for a String input: only a constant can be a text"),
    ] {
        let error = out("a.y1", &sources).expect_err("refused");
        assert!(error.contains(expected), "{expected}\n{error}");
    }
    let parts = [
        unit("a", "stateful.fmu", "s_in = \"other\""),
        source("s_in", "kind = \"constant\"\nvalue = \"text\""),
    ];
    let mut simulation = build(&units, &parts).expect("builds");
    assert_eq!(simulation.get("a.s_out").expect("known"), Value::String("text".into()));
}

#[test]
fn value_types_that_lose_nothing_go_over() {
    use orchestrator::Kind;
    let (real, integer, boolean) = (Value::Real, Value::Integer, Value::Boolean);
    for (value, kind, expected) in [
        (integer(-3), Kind::Real, Some(real(-3.0))),
        (boolean(true), Kind::Real, Some(real(1.0))),
        (boolean(true), Kind::Integer, Some(integer(1))),
        (integer(1), Kind::Boolean, Some(boolean(true))),
        (integer(0), Kind::Boolean, Some(boolean(false))),
        (integer(2), Kind::Boolean, None),
        (real(1.0), Kind::Integer, None),
        (real(1.0), Kind::Real, Some(real(1.0))),
    ] {
        assert_eq!(value.cast(kind), expected, "{value:?} to {kind}");
    }
}

#[test]
fn value_a_last_step_is_told_in_seconds() {
    // The tick is 2 s: 4 s and then one of them.
    let text = "format = 1\nexperiment = { stop = 6 }\n[[units]]\nname = \"a\"\nfmu = \"stateful.fmu\"\ninterval = 4\nset = { mode = 2 }\n";
    let units = Units::new();
    let mut simulation =
        Simulation::new(&Scenario::parse(text, "test.toml").expect("a scenario"), &units.unit_path())
            .expect("builds");
    assert!(simulation.notices()[0].ends_with("its last step has 2 s"), "{:?}", simulation.notices());
    for stop in [6.0, 10.0] {
        assert!(simulation.end_at(stop));
        simulation.run(&mut MemoryRecorder::new(), &mut Quiet).expect("runs");
        let found = ["a.y1", "a.y2"].map(|name| simulation.value(name).expect("known"));
        assert_eq!(found, [stop, 2.0]);
    }
}

#[test]
fn law_a_long_loop_is_told_in_short() {
    let told = |count: usize| {
        let mut parts: Vec<String> = (0..count)
            .map(|n| unit(&format!("a{n}"), "feedthrough.fmu", "mode = 1, k = 2, x0 = 1"))
            .collect();
        parts
            .extend((0..count).map(|n| connection(&format!("a{n}.y1"), &format!("a{}.u1", (n + 1) % count))));
        build(&Units::new(), &parts).expect("builds").notices().remove(0)
    };
    let short = told(9);
    assert_eq!(short.matches(" -> ").count(), 18, "each input, each output and the first again: {short}");
    let long = told(30);
    // Twenty of 61 names.
    assert_eq!(long.matches(" -> ").count(), 20, "{long}");
    assert!(long.contains(" -> (41 more) -> a0.") || long.contains(" -> (41 more) -> a"), "{long}");
}

#[test]
fn law_a_limit_is_passed_and_not_reached() {
    let parts = [unit("a", "stateful.fmu", "u1 = -1"), "[record]\nvariables = [\"a.y1\"]\n".into()];
    let units = Units::new();
    let ended = |comparison: Comparison, limit: f64| {
        let mut simulation = build(&units, &parts).expect("builds");
        simulation.stop_when("a.y1", comparison, limit).expect("recorded");
        match simulation.run(&mut MemoryRecorder::new(), &mut Quiet).expect("runs") {
            Ended::When { time, .. } => Some(time),
            _ => None,
        }
    };
    // y = -t, in eighths: exact.
    assert_eq!(ended(Comparison::AbsoluteAbove, 0.5), Some(0.625));
    assert_eq!(ended(Comparison::AbsoluteAbove, 1.0), None);
    assert_eq!(ended(Comparison::Below, -0.5), Some(0.625));
    assert_eq!(ended(Comparison::Above, -0.5), Some(0.0));
    assert_eq!(ended(Comparison::Above, 0.0), None);
}

#[test]
fn law_a_loop_of_states_is_none_at_the_start() {
    // An integrator begins with x0 whatever drives it, so there is nothing to be solved, and nothing to tell.
    let parts = [
        unit("x", "stateful.fmu", "x0 = 2"),
        unit("v", "stateful.fmu", "k = -1"),
        connection("v.y1", "x.u1"),
        connection("x.y1", "v.u1"),
    ];
    let mut simulation = build(&Units::new(), &parts).expect("builds");
    assert_eq!(simulation.value("v.u1").expect("known"), 2.0);
    assert_eq!(simulation.notices(), Vec::<String>::new());
}

#[test]
fn law_an_output_of_two_inputs_starts_after_both_in_whatever_order_they_are_written() {
    // `both` needs a gain and the state that the gain needs, too; nothing says which of its inputs comes first.
    let fixtures = Units::new();
    fixtures.add(Fixture { name: "12.fmu", y1_dependencies: "1 2", ..FEEDTHROUGH });
    fixtures.add(Fixture { name: "21.fmu", y1_dependencies: "2 1", ..FEEDTHROUGH });
    let pairs =
        [("gain.y1", "both.u1"), ("state.y1", "both.u2"), ("state.y1", "gain.u1"), ("both.y1", "last.u1")];
    let started = |fmu: &str, names: [&str; 4], pairs: &[(&str, &str)]| {
        let part = |name: &str| match name {
            "both" => unit(name, fmu, "mode = 1, k = 5"),
            "state" => unit(name, "stateful.fmu", "x0 = 2"),
            _ => unit(name, "feedthrough.fmu", "mode = 1, k = 3"),
        };
        let mut parts: Vec<String> = names.into_iter().map(part).collect();
        parts.extend(pairs.iter().map(|(from, to)| connection(from, to)));
        let mut simulation = build(&fixtures, &parts).expect("builds");
        // last: 3 * (5 * (3 * 2)); an input that was set too early keeps what its source said then
        assert_eq!(simulation.value("last.y1").expect("known"), 90.0, "{fmu} {names:?} {pairs:?}");
        assert_eq!(simulation.value("both.y2").expect("known"), 2.0, "{fmu} {names:?} {pairs:?}");
        simulation.replaced_starts().to_vec()
    };
    for fmu in ["12.fmu", "21.fmu"] {
        for names in [["last", "both", "gain", "state"], ["state", "gain", "both", "last"]] {
            for pairs in [pairs, [pairs[3], pairs[1], pairs[2], pairs[0]]] {
                let order = started(fmu, names, &pairs);
                let place = |input: &str| order.iter().position(|told| told.starts_with(input));
                let places = ["gain.u1 =", "both.u1 =", "both.u2 =", "last.u1 ="].map(place);
                let [gain, first, second, last] = places.map(|place| place.expect("its start gave way"));
                assert!(gain < first && first < last && second < last && order.len() == 4, "{order:?}");
                assert_eq!(started(fmu, names, &pairs), order, "again");
            }
        }
    }
}

#[test]
fn value_loops_at_the_start_are_solved_or_named() {
    // a = k (k a + 4) + 1 at the start.
    let parts = |k: f64| {
        let gain = |name, x0| unit(name, "feedthrough.fmu", &format!("mode = 1, k = {k:?}, x0 = {x0}"));
        [gain("a", 1), gain("b", 4), connection("a.y1", "b.u1"), connection("b.y1", "a.u1")]
    };
    let units = Units::new();
    let mut simulation = build(&units, &parts(-0.5)).expect("builds");
    // (1 - k²) a = 4 k + 1; the iteration contracts by 1/4 and ends when a round changes less than 1e-12.
    assert!((simulation.value("a.y1").expect("solved") - -1.0 / 0.75).abs() < 1e-12);
    let path = "a.u1 -> a.y1 -> b.u1 -> b.y1 -> a.u1";
    let notices = simulation.notices();
    assert!(
        notices[0].starts_with(&format!("algebraic loop {path}: while stepping it is cut")),
        "{notices:?}"
    );
    assert!(
        notices.iter().any(|n| n.contains(path) && n.contains("at initialisation: solved in")),
        "{notices:?}"
    );

    // Iterating diverges here, by a factor of four a round, and there converges by 0.81 only: Newton's method.
    for k in [-2.0, 0.9] {
        let mut simulation = build(&units, &parts(k)).expect("builds");
        let solution = (4.0 * k + 1.0) / (1.0 - k * k);
        // The residual of 1e-12 is enlarged by 1/(1 - 0.81).
        let found = simulation.value("a.y1").expect("solved");
        assert!((found / solution - 1.0).abs() < 6e-12, "{found} {solution}");
        let notices = simulation.notices();
        assert!(notices.iter().any(|n| n.contains(path) && n.contains("Newton's method")), "{notices:?}");
    }
    // A gain of one with something added has no solution.
    let error = build(&units, &parts(1.0)).expect("builds").initialize().expect_err("parallel").to_string();
    assert!(
        error.starts_with(&format!("algebraic loop at initialisation: {path}: no fixed point")),
        "{error}"
    );
    // A delay breaks the loop.
    let mut delayed = parts(1.0).to_vec();
    delayed.push("delay = 0.5\n".into());
    build(&units, &delayed).expect("builds").initialize().expect("no loop");
}

#[test]
fn value_enumerations_go_by_name_or_number() {
    let units = Units::new();
    let types = "<SimpleType name=\"Modes\"><Enumeration><Item name=\"integrator\" value=\"0\"/><Item name=\"gain\" \
                 value=\"1\"/><Item name=\"clock\" value=\"2\"/></Enumeration></SimpleType></TypeDefinitions>";
    let text = common::description(STATEFUL)
        .replace("</TypeDefinitions>", types)
        .replace(
            "<Integer start=\"0\" min=\"0\" max=\"2\"/>",
            "<Enumeration declaredType=\"Modes\" start=\"0\"/>",
        )
        .replace(
            "<Integer start=\"0\"/></ScalarVariable>\n    <ScalarVariable name=\"i_out\"",
            "<Enumeration \
                 declaredType=\"Modes\" start=\"0\"/></ScalarVariable>\n    <ScalarVariable name=\"i_out\"",
        );
    units.pack("stateful.fmu", &text, &common::library());
    let one = |set: &str| build(&units, &[unit("a", "stateful.fmu", set)]);
    let mode = |simulation: &mut Simulation| simulation.get("a.mode").expect("known");
    for set in ["mode = 2", "mode = \"clock\""] {
        assert_eq!(mode(&mut one(set).expect("builds")), Value::Integer(2));
    }
    let mut simulation = one("").expect("builds");
    simulation.set("a.mode", "gain").expect("by name");
    assert_eq!(mode(&mut simulation), Value::Integer(1));
    let all = "one of integrator (0), gain (1), clock (2)";
    for (set, shown) in [("mode = 3", "3"), ("mode = \"clok\"", "\"clok\""), ("mode = -1", "-1")] {
        let error = one(set).err().expect("no item").to_string();
        assert_eq!(error, format!("test.toml:7: a.mode = {shown}: {all}"));
    }
    assert!(simulation.set("a.mode", 7).expect_err("no item").to_string().ends_with(all));
    let mut scenario = simulation.scenario().clone();
    scenario.set("a.mode", "clock").expect("a unit");
    let mut simulation = Simulation::new(&scenario, &units.unit_path()).expect("builds");
    assert_eq!(mode(&mut simulation), Value::Integer(2), "--set a.mode=clock");
    let source = |signal: &str| {
        let source = format!("[[sources]]\nto = \"a.i_in\"\n{signal}\n");
        build(&units, &[unit("a", "stateful.fmu", ""), source])
    };
    let mut simulation = source("kind = \"constant\"\nvalue = \"clock\"").expect("builds");
    assert_eq!(simulation.get("a.i_out").expect("known"), Value::Integer(3));
    let error = source("kind = \"hold\"\npoints = [[0, 1], [0.5, 3]]").err().expect("no item").to_string();
    assert!(error.ends_with(&format!("the value 3 at 0.5 s: {all}")), "{error}");
}

#[test]
fn law_loops_begin_with_the_start_values() {
    // Gains of one: every value solves the loop, so the start values do, whatever an earlier run left behind.
    let gain = |name| unit(name, "feedthrough.fmu", "mode = 1");
    let parts = [gain("a"), gain("b"), connection("a.y1", "b.u1"), connection("b.y1", "a.u1")];
    let units = Units::new();
    let mut simulation = build(&units, &parts).expect("builds");
    for start in [7.0, -3.0] {
        simulation.reset();
        for input in ["a.u1", "b.u1"] {
            simulation.set(input, start).expect("before a run");
        }
        assert_eq!(simulation.value("a.y1").expect("solved"), start);
        simulation.run(&mut orchestrator::NoRecorder, &mut Quiet).expect("runs");
        assert_eq!(simulation.value("a.y1").expect("passed on"), start);
    }
    // A solution found from elsewhere would differ in its last bits.
    let more = [
        unit("a", "feedthrough.fmu", "mode = 1, k = -0.5, x0 = 1"),
        unit("b", "feedthrough.fmu", "mode = 1, k = -0.7, x0 = 4"),
    ];
    let mut simulation = build(&units, &[&more, &parts[2..]].concat()).expect("builds");
    let mut first = || {
        simulation.reset();
        let value = simulation.value("a.y1").expect("solved");
        simulation.run(&mut orchestrator::NoRecorder, &mut Quiet).expect("runs");
        value.to_bits()
    };
    assert_eq!(first(), first());
}

#[test]
fn value_units_and_types_are_converted() {
    let units = Units::new();
    units.add(Fixture { name: "rad.fmu", y1_unit: "rad", u1_unit: "rad", ..FEEDTHROUGH });
    units.add(Fixture { name: "deg.fmu", y1_unit: "deg", u1_unit: "deg", ..FEEDTHROUGH });
    units.add(Fixture { name: "kelvin.fmu", y1_unit: "K", u1_unit: "K", ..FEEDTHROUGH });
    units.add(Fixture { name: "celsius.fmu", y1_unit: "degC", u1_unit: "degC", ..FEEDTHROUGH });
    units.add(Fixture { name: "fahrenheit.fmu", y1_unit: "degF", u1_unit: "degF", ..FEEDTHROUGH });
    units.add(Fixture { name: "apples.fmu", y1_unit: "apples", u1_unit: "apples", ..STATEFUL });
    let through = |from: &str, to: &str, x0: &str| {
        let parts = [
            unit("a", &format!("{from}.fmu"), &format!("mode = 1, x0 = {x0}")),
            unit("b", &format!("{to}.fmu"), "mode = 1"),
            connection("a.y1", "b.u1"),
        ];
        build(&units, &parts).map(|mut simulation| {
            simulation.advance().expect("steps");
            (simulation.value("b.y1").expect("known"), simulation.notices())
        })
    };
    let value = |from, to, x0| through(from, to, x0).expect("converts").0;
    // One rounding of the factor and one of the product.
    assert!((value("deg", "rad", "180") - std::f64::consts::PI).abs() < 1e-15);
    assert!((value("rad", "deg", "1") - 57.295_779_513_082_32).abs() < 2e-14);
    assert_eq!(value("celsius", "kelvin", "20"), 293.15);
    // Factor and offset together, while stepping: 1 °F = 5/9 K, 0 °F = 255.372… K. NIST SP 811: 68 °F = 20 °C. The factor
    // and the offset have 16 digits each, of numbers up to 500.
    assert!((value("fahrenheit", "celsius", "68") - 20.0).abs() < 2e-13);
    assert!((value("celsius", "fahrenheit", "-40") - -40.0).abs() < 2e-13);
    assert!((value("fahrenheit", "kelvin", "0") - 255.372_222_222_222_2).abs() < 1e-13);
    assert_eq!(value("kelvin", "celsius", "0"), -273.15);
    assert_eq!(
        value("stateful", "rad", "2"),
        value("rad", "rad", "2"),
        "without a unit values pass unchanged"
    );
    // A difference of temperatures has no zero; between one and a temperature it is a temperature that is meant.
    let relative = |name: &str, u1_unit: &'static str, y1_unit: &'static str| {
        let fixture = Fixture { u1_unit, y1_unit, ..FEEDTHROUGH };
        let text = common::description(fixture).replace(" unit=\"", " relativeQuantity=\"true\" unit=\"");
        units.pack(name, &text, &common::library());
    };
    relative("dcelsius.fmu", "degC", "degC");
    relative("dkelvin.fmu", "K", "K");
    assert_eq!(value("dcelsius", "dkelvin", "20"), 20.0);
    assert_eq!((value("dcelsius", "kelvin", "20"), value("celsius", "dkelvin", "20")), (293.15, 293.15));
    let (passed, notices) = through("rad", "apples", "0.5").expect("passes");
    assert_eq!(passed, 0.5);
    assert!(notices[0].contains("a.y1 (rad) -> b.u1 (apples)"), "{notices:?}");
    let error = through("rad", "kelvin", "1").expect_err("other quantity").to_string();
    assert!(
        error.ends_with("a.y1 is in rad, b.u1 in K: these units don't measure the same quantity (rad and K)"),
        "{error}"
    );

    let parts = [
        unit("a", "stateful.fmu", "i_in = 41, b_in = false, s_in = \"text, with \\\"quotes\\\"\""),
        unit("b", "stateful.fmu", ""),
        connection("a.i_out", "b.u1"),
        connection("a.b_out", "b.i_in"),
        connection("a.i_out", "b.b_in"),
        connection("a.b_out", "b.u2"),
        connection("a.s_out", "b.s_in"),
    ];
    let mut simulation = build(&units, &parts).expect("builds");
    let mut csv = CsvRecorder::new(Vec::new());
    simulation.run(&mut csv, &mut Quiet).expect("runs");
    let mut get = |name: &str| simulation.get(name).expect("known");
    assert_eq!(get("b.u1"), Value::Real(42.0));
    assert_eq!((get("b.i_in"), get("b.u2")), (Value::Integer(1), Value::Real(1.0)));
    assert_eq!((get("b.b_in"), get("b.b_out")), (Value::Boolean(true), Value::Boolean(false)));
    assert_eq!(get("b.s_out"), Value::from("text, with \"quotes\""));
    let text = String::from_utf8(csv.into_inner()).expect("UTF-8");
    assert!(
        text.lines()
            .nth(1)
            .expect("a row")
            .ends_with("1,0,\"text, with \"\"quotes\"\"\",\"text, with \"\"quotes\"\"\""),
        "{text}"
    );
}

#[test]
fn law_runs_are_repeated_with_other_values() {
    let units = Units::new();
    let parts = [unit("a", "stateful.fmu", "u1 = 1")];
    let mut simulation = build(&units, &parts).expect("builds");
    let mut results = MemoryRecorder::new();
    for k in [1.0, -2.0, 1.0] {
        simulation.set("a.k", k).expect("before a run");
        assert_eq!(simulation.run(&mut results, &mut Quiet).expect("runs"), Ended::AtStop);
        assert_eq!(results.times().len(), 9);
        assert_eq!(results.series("a.y1").expect("recorded").last(), Some(&k), "u1 = 1 over 1 s");
    }
    // Step by step, with an input and a tunable parameter changed on the way.
    simulation.reset();
    simulation.advance_to(0.5).expect("steps");
    assert_eq!((simulation.time(), simulation.value("a.y1").expect("known")), (0.5, 0.5));
    simulation.set("a.u1", 4).expect("an Integer is a Real too");
    simulation.set("a.k", 2.0).expect("tunable");
    let fixed = simulation.set("a.x0", 1.0).expect_err("fixed").to_string();
    assert!(fixed.contains("only inputs and tunable parameters change while stepping"), "{fixed}");
    simulation.advance_to(0.74).expect("steps");
    assert_eq!((simulation.time(), simulation.value("a.y1").expect("known")), (0.625, 1.5));
    simulation.advance_to(9.0).expect("steps to the end");
    assert_eq!(simulation.time(), 1.0);
    assert_eq!(simulation.advance().expect("nothing left"), None);
    // What was set on the way does not outlive the reset.
    simulation.run(&mut results, &mut Quiet).expect("runs");
    assert_eq!(results.series("a.y1").expect("recorded").last(), Some(&1.0));
    simulation.stop_when("a.y1", Comparison::AbsoluteAbove, 0.3).expect("recorded");
    let ended = simulation.run(&mut results, &mut Quiet).expect("runs");
    assert_eq!(ended, Ended::When { condition: "|a.y1| > 0.3".into(), time: 0.375 });
    // Each comparison on the negative side: u1 = 1, k = -1.
    for (comparison, limit, condition) in [
        (Comparison::AbsoluteAbove, 0.3, "|a.y1| > 0.3"),
        (Comparison::Below, -0.3, "a.y1 < -0.3"),
        (Comparison::Above, -2.0, "a.y1 > -2"),
    ] {
        let mut simulation = build(&units, &parts).expect("builds");
        simulation.set("a.k", -1.0).expect("before a run");
        simulation.stop_when("a.y1", comparison, limit).expect("recorded");
        let ended = simulation.run(&mut results, &mut Quiet).expect("runs");
        let time = if comparison == Comparison::Above { 0.0 } else { 0.375 };
        assert_eq!(ended, Ended::When { condition: condition.into(), time });
    }
    let error = simulation.value("a.y11").expect_err("unknown").to_string();
    assert_eq!(error, "variable \"a.y11\" does not exist: did you mean y1 (or y2, u1)?");
}

#[test]
fn law_the_resolved_scenario_names_every_value_and_gives_the_same_run() {
    let units = Units::new();
    let folder = tempfile::TempDir::new().expect("a temporary folder");
    std::fs::write(folder.path().join("z.csv"), "time,z\n0,0\n0.3,1\n\n1,\n1,-1\n").expect("writable");
    let text = [
        "format = 1\ndescription = \"a \\\"test\\\"\"\nexperiment = { start = 0.5, stop = \"3/2\", algorithm = \"jacobi\" }\n".into(),
        unit("a", "stateful.fmu", "s_in = \"x\""),
        unit("b", "feedthrough.fmu", "mode = 1"),
        connection("a.y1", "b.u1"),
        "delay = \"1/3\"\n".into(),
        "[[sources]]\nto = \"a.u1\"\nkind = \"csv\"\nfile = \"z.csv\"\ncolumn = \"z\"\n".into(),
        "[[sources]]\nto = \"b.u2\"\nkind = \"smooth\"\npoints = [[0, 0], [1.0, 0.1]]\n".into(),
        "[[sources]]\nto = \"b.i_in\"\nkind = \"hold\"\npoints = [[0, 1], [1.0, 2]]\n".into(),
        "[record]\nvariables = [\"*\"]\n[report]\ntitle = \"t\"\nnested = { a = [1, 2] }\n".into(),
    ]
    .concat();
    let mut scenario = Scenario::parse(&text, folder.path().join("test.toml")).expect("a scenario");
    scenario.set("a.k", "0.1").expect("a unit");
    let bytes = |scenario: &Scenario| {
        let mut simulation = Simulation::new(scenario, &units.unit_path()).expect("builds");
        let mut csv = CsvRecorder::new(Vec::new());
        simulation.run(&mut csv, &mut Quiet).expect("runs");
        (String::from_utf8(csv.into_inner()).expect("UTF-8"), simulation.resolved())
    };
    let (first, resolved) = bytes(&scenario);
    let again = Scenario::parse(&resolved, "elsewhere/resolved.toml").expect("loads");
    assert_eq!(again.report, scenario.report);
    assert_eq!(again.description, "a \"test\"");
    assert_eq!(bytes(&again), (first, resolved.clone()));
    for line in [
        "start = \"1/2\"",
        "interval = \"1/8\"",
        "latency = \"1/3\"",
        "k = 0.1",
        "fault_time = 1e+300",
        "mode = 1",
        "s_in = \"x\"",
    ] {
        assert!(resolved.lines().any(|l| l == line), "{line} in\n{resolved}");
    }
}

#[test]
fn law_a_bundle_has_each_file_once_and_by_a_name_of_its_own() {
    let (units, folder) = (Units::new(), tempfile::TempDir::new().expect("a temporary folder"));
    let other = folder.path().join("stateful.fmu");
    std::fs::copy(units.path().join("feedthrough.fmu"), &other).expect("copied");
    std::fs::create_dir(folder.path().join("more")).expect("a folder");
    let tables = ["z.csv", "more/z.csv"];
    for name in tables {
        std::fs::write(folder.path().join(name), "time,z\n0,0\n1,1\n").expect("writable");
    }
    let source = |to: &str, file: &str| {
        format!("[[sources]]\nto = \"{to}\"\nkind = \"csv\"\nfile = \"{file}\"\ncolumn = \"z\"\n")
    };
    let text = [
        "format = 1\nexperiment = { stop = 1 }\n".into(),
        unit("a", "stateful.fmu", "k = 3"),
        unit("b", &other.display().to_string(), "mode = 1"),
        unit("c", &units.path().join("stateful.fmu").display().to_string(), "x0 = 1"),
        source("a.u1", tables[0]),
        source("b.u1", tables[1]),
        source("c.u1", tables[0]),
    ]
    .concat();
    let scenario = Scenario::parse(&text, folder.path().join("test.toml")).expect("a scenario");
    let time = source("a.u1", tables[0]).replace("\"z\"\n", "\"time\"\n");
    let of_time = ["format = 1\nexperiment = { stop = 1 }\n", &unit("a", "stateful.fmu", ""), &time].concat();
    let of_time = Scenario::parse(&of_time, folder.path().join("test.toml")).expect("a scenario");
    let error = Simulation::new(&of_time, &units.unit_path())
        .err()
        .expect("the first column is the time")
        .to_string();
    assert!(error.contains("has no column \"time\" after the time"), "{error}");
    let mut simulation = Simulation::new(&scenario, &units.unit_path()).expect("builds");
    simulation.set("c.x0", 2.0).expect("before a run");
    let bundle = simulation.bundle();
    let named: Vec<&str> = bundle.scenario.units.iter().map(|unit| unit.fmu.value.as_str()).collect();
    let files: Vec<&str> = bundle.files.iter().map(|(name, _)| name.as_str()).collect();
    // What lies beside the scenario comes before what the unit path has.
    assert_eq!(named, ["stateful.fmu", "stateful.fmu", "stateful-2.fmu"]);
    assert_eq!(files, ["stateful.fmu", "stateful-2.fmu", "z.csv", "z-2.csv"]);
    // Unpacked side by side it is the same run.
    let unpacked = tempfile::TempDir::new().expect("a temporary folder");
    for (name, path) in &bundle.files {
        std::fs::copy(path, unpacked.path().join(name)).expect("copied");
    }
    let again =
        Scenario::parse(&simulation.bundled(&bundle), unpacked.path().join("test.toml")).expect("loads");
    let path = orchestrator::UnitPath::new().with(unpacked.path());
    let mut again = Simulation::new(&again, &path).expect("builds");
    let bytes = |simulation: &mut Simulation| {
        let mut csv = CsvRecorder::new(Vec::new());
        simulation.run(&mut csv, &mut Quiet).expect("runs");
        csv.into_inner()
    };
    assert_eq!(bytes(&mut again), bytes(&mut simulation));
    assert_eq!(simulation.given()[2], [("x0", &Value::Real(2.0))]);
    let used = simulation.used();
    assert!(!used[0].iter().any(|(name, _)| name == "u1" || name == "y1"), "driven or computed: {used:?}");
    for (name, value) in [("k", 3.0), ("x0", 0.0), ("u2", 0.0)] {
        assert!(used[0].contains(&(name.into(), Value::Real(value))), "{name}");
    }
}

#[test]
fn every_state_comes_back_in_its_own_and_in_another_instance() {
    let units = Units::new();
    let fmu = orchestrator::Fmu::open(units.path().join("stateful.fmu")).expect("opens");
    let start = |name: &str| {
        let mut instance = fmu.instantiate(name).expect("instantiates");
        instance.set_real(&[0], &[3.0]).expect("an input");
        instance.setup_experiment(0.0, None).expect("set up");
        instance.enter_initialization().expect("enters");
        instance.exit_initialization().expect("exits");
        instance
    };
    let step = |instance: &mut orchestrator::fmu::Instance| {
        assert_eq!(instance.do_step(0.0, 0.5, false), orchestrator::fmu::Status::Ok);
        instance.get(orchestrator::Kind::Real, 2).expect("y1")
    };
    let (mut first, mut second) = (start("first"), start("second"));
    assert_eq!(step(&mut first), Value::Real(1.5));
    let saved = first.save_state().expect("saved");
    let bytes = first.serialize_state(&saved).expect("bytes");
    assert_eq!(step(&mut first), Value::Real(3.0));
    first.restore_state(&saved).expect("restored");
    assert_eq!(step(&mut first), Value::Real(3.0), "again from 1.5");
    first.free_state(saved).expect("freed");
    let moved = second.deserialize_state(&bytes).expect("a state");
    second.restore_state(&moved).expect("restored");
    assert_eq!(step(&mut second), Value::Real(3.0), "from the other's 1.5");
    second.free_state(moved).expect("freed");
}
