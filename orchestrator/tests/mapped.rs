//! Connections with a table of values: Integers, Booleans and enumerations.

use crate::common;

use crate::common::{STATEFUL, Units, description};
use orchestrator::{MemoryRecorder, Quiet, Scenario, Simulation};

fn scenario(map: &str, from: &str, to: &str) -> String {
    format!(
        "format = 1\nexperiment = {{ stop = 0.2 }}\n\
         [[units]]\nname = \"a\"\nfmu = \"stateful.fmu\"\ninterval = 0.1\n\
         [[units]]\nname = \"b\"\nfmu = \"stateful.fmu\"\ninterval = 0.1\n\
         [[sources]]\nto = \"a.i_in\"\nkind = \"hold\"\npoints = [[0, 4], [0.2, 5]]\n\
         [[connections]]\nfrom = \"{from}\"\nto = \"{to}\"\n{map}\n"
    )
}

fn build(text: &str, units: &Units) -> Result<Simulation, String> {
    let scenario = Scenario::parse(text, "test.toml").map_err(|error| error.to_string())?;
    Simulation::new(&scenario, &units.unit_path()).map_err(|error| error.to_string())
}

fn units() -> Units {
    let units = Units::new();
    let types = "<TypeDefinitions><SimpleType name=\"Valve\"><Enumeration><Item name=\"shut\" value=\"5\"/>\
                 <Item name=\"open\" value=\"7\"/></Enumeration></SimpleType>";
    let typed = description(STATEFUL).replace("<TypeDefinitions>", types).replace(
        "causality=\"output\"><Integer/>",
        "causality=\"output\"><Enumeration declaredType=\"Valve\"/>",
    );
    units.pack("typed.fmu", &typed, &common::library());
    units
}

fn series(text: &str, name: &str, units: &Units) -> Vec<f64> {
    let mut simulation = build(text, units).unwrap_or_else(|error| panic!("{error}"));
    let mut results = MemoryRecorder::new();
    simulation.run(&mut results, &mut Quiet).expect("runs");
    let resolved = simulation.resolved();
    let mut again = MemoryRecorder::new();
    build(&resolved, units).expect("builds").run(&mut again, &mut Quiet).expect("runs");
    assert_eq!(results.series(name).expect("recorded"), again.series(name).expect("recorded"), "resolved");
    results.series(name).expect("recorded").to_vec()
}

#[test]
fn value_single_values_become_others_and_the_rest_passes() {
    let units = units();
    // i_out = i_in + 1: 5, 5, 6.
    let mapped = scenario("map = [[5, -3], [7, 1]]", "a.i_out", "b.i_in");
    assert_eq!(series(&mapped, "b.i_in", &units), [-3.0, -3.0, 6.0]);
    let late = scenario("map = [[5, -3], [7, 1]]\nlatency = 0.1", "a.i_out", "b.i_in");
    assert_eq!(series(&late, "b.i_in", &units), [0.0, -3.0, -3.0]);
    // b_out = not b_in, which is false.
    let swapped = scenario("map = [[true, false], [false, true]]", "a.b_out", "b.b_in");
    assert_eq!(series(&swapped, "b.b_in", &units), [0.0, 0.0, 0.0]);
    let counted = scenario("map = [[true, 12]]", "a.b_out", "b.i_in");
    assert_eq!(series(&counted, "b.i_in", &units), [12.0, 12.0, 12.0]);
    let numbered = scenario("map = [[1, 12], [0, 3]]", "a.b_out", "b.i_in");
    assert_eq!(series(&numbered, "b.i_in", &units), [12.0, 12.0, 12.0], "a table of numbers");
    let items =
        scenario("map = [[\"shut\", 1], [7, 2]]", "a.i_out", "b.i_in").replacen("stateful", "typed", 1);
    assert_eq!(series(&items, "b.i_in", &units), [1.0, 1.0, 6.0]);
}

#[test]
fn every_table_that_fits_no_variable_is_refused() {
    let units = units();
    for (map, from, to, expected) in [
        ("map = [[1, 2]]", "a.y1", "b.i_in", "map from a.y1 (Real) to b.i_in (Integer)"),
        ("map = [[1, 2]]\ngain = 2.0", "a.i_out", "b.i_in", "without gain, bias and convert_units"),
        ("map = [[true, 2]]", "a.i_out", "b.i_in", "map: true of a.i_out: it is of type Integer"),
        ("map = [[1, 2], [1, 3]]", "a.i_out", "b.i_in", "map: 1 a second time: each value once"),
        ("map = [[1, 2.5]]", "a.i_out", "b.i_in", "map: 2.5 of b.i_in: it is of type Integer"),
        ("map = [[1, 2, 3]]", "a.i_out", "b.i_in", "map: 3 values in [1, 2, 3]: pairs"),
        ("map = []", "a.i_out", "b.i_in", "map without values: pairs"),
    ] {
        let error = build(&scenario(map, from, to), &units).err().expect("refused");
        assert!(error.contains(expected) && error.starts_with("test.toml:"), "{map}: {error}");
    }
    for (map, expected) in
        [("[[\"sut\", 1]]", "one of shut (5), open (7)"), ("[[6, 1]]", "one of shut (5), open (7)")]
    {
        let text = scenario(&format!("map = {map}"), "a.i_out", "b.i_in").replacen("stateful", "typed", 1);
        let error = build(&text, &units).err().expect("refused");
        assert!(error.contains(expected), "{map}: {error}");
    }
}
