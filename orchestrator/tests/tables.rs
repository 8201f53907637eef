//! Sources from files and texts that a unit is started with: what is wrong in them is said with its place.

use crate::common::{self, STATEFUL, Units};
use orchestrator::{MemoryRecorder, Quiet, Scenario, Simulation};

/// A unit whose input comes from `u.csv`.
const SYSTEM: &str = "format = 1
experiment = { stop = 1 }
[[units]]
name = \"a\"
fmu = \"stateful.fmu\"
interval = 0.5
[[sources]]
to = \"a.u1\"
kind = \"csv\"
file = \"u.csv\"
column = \"u\"
";

/// The last value of the input, or why there is none.
fn last(units: &Units, text: &str, table: &str) -> Result<f64, String> {
    std::fs::write(units.path().join("u.csv"), table).expect("writable");
    let scenario = Scenario::parse(text, units.path().join("s.toml")).map_err(|error| error.to_string())?;
    let mut simulation = Simulation::new(&scenario, &units.unit_path()).map_err(|error| error.to_string())?;
    let mut results = MemoryRecorder::new();
    simulation.run(&mut results, &mut Quiet).map_err(|error| error.to_string())?;
    let column = results.series("a.u1").map_err(|error| error.to_string())?;
    column.last().copied().ok_or_else(|| "no row".to_owned())
}

#[test]
fn value_cells_may_stand_in_quotes_and_rows_be_incomplete() {
    let units = Units::new();
    for table in [
        "time,u\n0,1\n0.5,2\n",
        "\"t [s]\",\"a,b\",\"u\"\n\"0\",x,\"1\"\n0.25,y\n0.5, , 2 \n",
        "time,v,u\n0,0,1\n0.5,,2\n",
    ] {
        assert_eq!(last(&units, SYSTEM, table), Ok(2.0), "{table}");
    }
}

#[test]
fn bad_data_a_table_is_refused_with_its_line() {
    let units = Units::new();
    for (table, expected) in [
        ("time,u\n0,1\n0.5,2,3\n", "u.csv:3: 3 cells: 2, as many as columns"),
        ("time,u,u\n0,1,2\n", "two columns \"u\": one of that name"),
        ("time,u\n0,1\n0.5,nan\n", "u.csv:3: \"nan\": a finite number"),
        ("time,u\n0.5,1\n0,1\n", "u.csv:3: \"0\": times in rising order"),
        ("time,v\n0,1\n", "has no column \"u\" after the time"),
        ("time [ms],u\n0,1\n", "its first column, \"time [ms]\", is in ms: times in s"),
        ("t_us,u\n0,1\n", "is in us: times in s"),
        ("time;u\n0;1,5\n", "its head is one column, \"time;u\": commas between columns"),
        ("time,u\n0,\n", "holds no values of \"u\": one row at least"),
    ] {
        let told = last(&units, SYSTEM, table).expect_err("refused");
        assert!(told.contains(expected), "{table}: {told}");
    }
}

#[test]
fn bad_input_texts_have_no_zero_byte_and_ranges_no_unit_of_one() {
    let units = Units::new();
    let given = |set: &str| {
        let text = SYSTEM.replace("interval = 0.5\n", &format!("interval = 0.5\nset = {{ {set} }}\n"));
        last(&units, &text, "time,u\n0,1\n").expect_err("refused")
    };
    assert!(
        given("s_in = \"a\\u0000b\"").contains("a text without a zero byte"),
        "{}",
        given("s_in = \"a\\u0000b\"")
    );
    let points = SYSTEM
        .replace("kind = \"csv\"\nfile = \"u.csv\"\ncolumn = \"u\"\n", "kind = \"hold\"\npoints = POINTS\n");
    for (table, expected) in [
        ("[[0, 1, 2]]", "a point of 3 numbers: expected [time, value]"),
        ("[[\"1/3\", 2]]", "expected a number, true or false"),
    ] {
        let told = last(&units, &points.replace("POINTS", table), "").expect_err("refused");
        assert!(told.contains("s.toml:10: ") && told.contains(expected), "{told}");
    }
}

#[test]
fn bad_input_a_source_beyond_the_range_of_its_input_is_refused_or_told() {
    let units = Units::new();
    let start = "name=\"u1\" valueReference=\"0\" causality=\"input\"><Real start=\"0\"";
    let limited = common::description(STATEFUL).replace(start, &format!("{start} min=\"-1\" max=\"2\""));
    units.pack("stateful.fmu", &limited, &common::library());
    let constant = |value: &str| {
        let kind = "kind = \"csv\"\nfile = \"u.csv\"\ncolumn = \"u\"\n";
        last(&units, &SYSTEM.replace(kind, &format!("kind = \"constant\"\nvalue = {value}\n")), "")
    };
    assert_eq!(constant("2"), Ok(2.0));
    let told = constant("5").expect_err("as of a start value");
    assert!(told.contains("s.toml:7") && told.contains("value = 5: a number from -1 to 2"), "{told}");
    // what a sensor logged may lie a little beyond: it is fed, and told
    std::fs::write(units.path().join("u.csv"), "time,u\n0,1\n0.5,2.5\n").expect("writable");
    let scenario = Scenario::parse(SYSTEM, units.path().join("s.toml")).expect("it is one");
    let simulation = Simulation::new(&scenario, &units.unit_path()).expect("it runs");
    let wanted = "a.u1: the signal is 2.5 at 0.5 s, and its description says a number from -1 to 2";
    assert!(simulation.notices().iter().any(|told| told == wanted), "{:?}", simulation.notices());
}
