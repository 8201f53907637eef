//! Connections that scale what they carry.

mod common;

use common::Units;
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
