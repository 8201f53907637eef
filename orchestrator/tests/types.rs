//! Types, enumerations and units of measurement of what goes along a connection.

use crate::common;

use crate::common::{FEEDTHROUGH, Fixture, STATEFUL, Units, build, connection, unit};
use orchestrator::{CsvRecorder, MemoryRecorder, Quiet, Simulation, Value};

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
    // As far as an Integer goes.
    for (points, last) in [("[[0, -2147483648]]", -2_147_483_648.0), ("[[0, 2147483647]]", 2_147_483_647.0)] {
        assert_eq!(out("a.i_in", &source("i_in", &hold(points))), Ok(last));
    }
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
        (
            source("i_in", &hold("[[0, 2147483648]]")),
            "the value 2147483648 at 0 s: the input is of type Integer",
        ),
        (source("i_in", &hold("[[0, -2147483649]]")), "the value -2147483649 at 0 s: the input is"),
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
fn every_algorithm_carries_truths_and_texts_as_they_change() {
    let units = Units::new();
    for algorithm in orchestrator::algorithms() {
        let text = format!(
            "format = 1\n[experiment]\nstop = 1\nalgorithm = \"{algorithm}\"\n\
             [[units]]\nname = \"a\"\nfmu = \"stateful.fmu\"\ninterval = 0.125\nset = {{ i_in = 41, s_in = \"first\" }}\n\
             [[units]]\nname = \"b\"\nfmu = \"stateful.fmu\"\ninterval = 0.125\n\
             [[connections]]\nfrom = \"a.b_out\"\nto = \"b.b_in\"\n\
             [[connections]]\nfrom = \"a.i_out\"\nto = \"b.i_in\"\n\
             [[connections]]\nfrom = \"a.s_out\"\nto = \"b.s_in\"\n"
        );
        let scenario = orchestrator::Scenario::parse(&text, "test.toml").expect(algorithm);
        let mut simulation = Simulation::new(&scenario, &units.unit_path()).expect(algorithm);
        for (at, truth, number, text) in
            [(0.25, true, 7, "second"), (0.5, false, -3, ""), (0.75, true, 0, "third")]
        {
            simulation.set("a.b_in", truth).expect("an input");
            simulation.set("a.i_in", number).expect("an input");
            simulation.set("a.s_in", text).expect("an input");
            // Two steps: what is seen at the beginning of one comes of the one before.
            simulation.advance_to(at).expect("steps");
            let mut get = |name: &str| simulation.get(name).expect("known");
            assert_eq!(
                (get("a.b_out"), get("b.b_in")),
                (Value::Boolean(!truth), Value::Boolean(!truth)),
                "{algorithm}"
            );
            assert_eq!(get("b.b_out"), Value::Boolean(truth), "{algorithm}");
            assert_eq!(
                (get("b.i_in"), get("b.i_out")),
                (Value::Integer(number + 1), Value::Integer(number + 2))
            );
            assert_eq!(
                (get("b.s_in"), get("b.s_out")),
                (Value::from(text), Value::from(text)),
                "{algorithm}"
            );
        }
    }
}

#[test]
fn every_table_in_a_file_may_jump_and_never_goes_back() {
    let units = Units::new();
    let file = units.path().join("z.csv");
    let out = |rows: &str| {
        std::fs::write(&file, format!("time,z\n{rows}\n")).expect("writable");
        let source = format!(
            "[[sources]]\nto = \"a.u1\"\nkind = \"csv\"\nfile = \"{}\"\ncolumn = \"z\"\n",
            file.display()
        );
        let mut simulation =
            build(&units, &[unit("a", "stateful.fmu", ""), source]).map_err(|error| error.to_string())?;
        simulation.run(&mut MemoryRecorder::new(), &mut Quiet).map_err(|error| error.to_string())?;
        simulation.value("a.y1").map_err(|error| error.to_string())
    };
    // At the ends of steps of 1/8 s three times 1 and five times 3, as in a table of the scenario.
    assert_eq!(out("0,1\n0.5,1\n0.5,3\n1,3"), Ok(2.25));
    let error = out("0,1\n0.5,1\n0.499,3\n1,3").expect_err("back in time");
    assert!(error.contains("times in rising order") && error.contains("z.csv:4"), "{error}");
}
