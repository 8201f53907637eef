//! Connections that scale what they carry.

use crate::common;

use crate::common::Units;
use orchestrator::{Scenario, Simulation};

fn scenario(connection: &str) -> String {
    format!(
        r#"
format = 1
[experiment]
stop = 0.1
[[units]]
name = "a"
fmu = "feedthrough.fmu"
interval = 0.01
[units.set]
u1 = 5.0
[[units]]
name = "b"
fmu = "feedthrough.fmu"
interval = 0.01
[[connections]]
{connection}
"#
    )
}

#[test]
fn value_gain_bias_and_units_left_alone() {
    let units = Units::new();
    let mut stretched = common::STATEFUL;
    (stretched.name, stretched.y1_dependencies) = ("feedthrough.fmu", "1");
    const DEG: f64 = 0.017_453_292_519_943_295;
    type Expected = fn(f64) -> f64;
    let cases: [(&str, &str, &str, Expected); 5] = [
        ("", "", "gain = 2\nbias = 3", |y| 2.0 * y + 3.0),
        ("rad", "deg", "gain = 1.0", |y| y * DEG),
        // The unit first.
        ("rad", "deg", "gain = 2.0\nbias = 1.0", |y| 2.0 * DEG * y + 1.0),
        ("rad", "deg", "convert_units = false", |y| y),
        // What doesn't fit passes only where it is said to be meant.
        ("K", "deg", "convert_units = false\ngain = -1.0", |y| -y),
    ];
    for (u1_unit, y1_unit, keys, expected) in cases {
        (stretched.u1_unit, stretched.y1_unit) = (u1_unit, y1_unit);
        units.add(stretched);
        let text = scenario(&format!("from = \"a.y1\"\nto = \"b.u1\"\n{keys}"));
        let scenario = Scenario::parse(&text, "test.toml").expect(keys);
        let mut simulation = Simulation::new(&scenario, &units.unit_path()).expect(keys);
        simulation.advance_to(0.1).expect("runs");
        let y = simulation.value("a.y1").expect("an output");
        assert!(y != 0.0);
        let expected = expected(y);
        assert_eq!(simulation.value("b.u1").expect("an input"), expected, "{u1_unit} {y1_unit} {keys}");
        // What a run says that it used gives the same.
        let again = Scenario::parse(&simulation.resolved(), "resolved.toml").expect("resolved");
        let mut again = Simulation::new(&again, &units.unit_path()).expect("resolved");
        again.advance_to(0.1).expect("runs");
        assert_eq!(again.value("b.u1").expect("an input"), expected, "{keys}");
    }
}

#[test]
fn every_scale_that_can_not_be_is_refused() {
    let units = Units::new();
    for (keys, expected) in [
        ("from = \"a.i_out\"\nto = \"b.i_in\"\ngain = 2.0", "only numbers for a Real input are scaled"),
        ("from = \"a.s_out\"\nto = \"b.u1\"\nbias = 2.0", "only numbers for a Real input are scaled"),
        ("from = \"a.y1\"\nto = \"b.u1\"\ngain = nan", "gain = NaN: a finite number"),
        ("from = \"a.y1\"\nto = \"b.u1\"\nconvert_unit = false", "convert_unit"),
    ] {
        let built = Scenario::parse(&scenario(keys), "test.toml")
            .and_then(|scenario| Simulation::new(&scenario, &units.unit_path()).map(drop));
        let told = built.expect_err(keys).to_string();
        assert!(told.starts_with("test.toml:") && told.contains(expected), "{told}");
    }
}

#[test]
fn every_algorithm_scales_what_it_carries() {
    let units = Units::new();
    let each = orchestrator::algorithms()
        .flat_map(|algorithm| ["", "latency = 0.1\n"].map(|latency| (algorithm, latency)));
    for (algorithm, latency) in each {
        // Two constants, so that no way to fill the time between points moves them.
        let text = format!(
            "format = 1\n[experiment]\nstop = 0.5\nalgorithm = \"{algorithm}\"\n\
             [[units]]\nname = \"a\"\nfmu = \"feedthrough.fmu\"\ninterval = 0.1\nset = {{ mode = 1, u1 = 5.0, u2 = -7.0 }}\n\
             [[units]]\nname = \"b\"\nfmu = \"feedthrough.fmu\"\ninterval = 0.1\nset = {{ mode = 1 }}\n\
             [[connections]]\nfrom = \"a.y1\"\nto = \"b.u1\"\ngain = 2.0\nbias = 3.0\n{latency}\
             [[connections]]\nfrom = \"a.y2\"\nto = \"b.u2\"\ngain = -1.0\nbias = 0.25\n{latency}"
        );
        let scenario = Scenario::parse(&text, "test.toml").expect(algorithm);
        let mut simulation = Simulation::new(&scenario, &units.unit_path()).expect(algorithm);
        simulation.advance_to(0.5).expect("runs");
        for (name, expected) in
            [("a.y1", 5.0), ("a.y2", -7.0), ("b.u1", 13.0), ("b.u2", 7.25), ("b.y1", 13.0)]
        {
            assert_eq!(simulation.value(name).expect(name), expected, "{algorithm}, {latency:?}: {name}");
        }
    }
}
