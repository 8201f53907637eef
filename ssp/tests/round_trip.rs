//! Scenarios that are written as packages and read again give the same bytes. The units are the packed ones.

mod common;

use common::{results, units};
use orchestrator::{Scenario, Simulation, UnitPath};

#[test]
fn law_a_scenario_gives_the_same_bytes_from_its_package() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let toml = r#"
format = 1
description = "effects & <more>"
[experiment]
stop = "1/3"
seed = 7
algorithm = "jacobi"
[[units]]
name = "a"
fmu = "signal_effects.fmu"
interval = "1/300"
[units.set]
bias = 0.1
gain = 1e-300
[[units]]
name = "b"
fmu = "signal_effects.fmu"
interval = "1/70"
offset = "1/140"
[units.set]
delay = 0.02
[[units]]
name = "c"
fmu = "signal_effects.fmu"
interval = "0.01"
[[connections]]
from = "a.y"
to = "b.u"
latency = "1/60"
jitter = 0.001
drop = 0.1
hold = "linear"
[[connections]]
from = "b.y"
to = "c.u"
gain = -0.3
bias = 1e-3
[[sources]]
to = "a.u"
kind = "smooth"
points = [[0.0, 0.0], [0.1, 0.7], [0.3, -0.2]]
[record]
variables = ["c.*", "a.y", "b.u", "b.u:age"]
[report]
[[report.graphs]]
title = "one\ntwo"
y = "y"
lines = [{ signal = "c.y", label = "c", style = "solid" }]
"#;
    let scenario = Scenario::parse(toml, folder.path().join("mine.toml")).expect("a scenario");
    let simulation = Simulation::new(&scenario, &UnitPath::new().with(units())).expect("builds");
    let bytes = ssp::write(&simulation).expect("written");
    assert!(bytes == ssp::write(&simulation).expect("written"), "the same bytes each time");
    let path = folder.path().join("mine.ssp");
    std::fs::write(&path, &bytes).expect("writable");
    let read = ssp::read(&path).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(results(&scenario, folder.path()), results(&read, folder.path()));
    assert_eq!((&read.description, &read.report), (&scenario.description, &scenario.report));
    // And once more, from the package's scenario.
    let simulation = Simulation::new(&read, &UnitPath::new()).expect("builds");
    let again = folder.path().join("again.ssp");
    std::fs::write(&again, ssp::write(&simulation).expect("written")).expect("writable");
    assert_eq!(results(&scenario, folder.path()), results(&ssp::read(&again).expect("read"), folder.path()));
    // What a run says that it used runs by itself.
    let resolved =
        Scenario::parse(&simulation.resolved(), folder.path().join("resolved.toml")).expect("a scenario");
    assert_eq!(results(&scenario, folder.path()), results(&resolved, folder.path()));
}

#[test]
fn law_units_delay_as_latencies_do() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let toml = r#"
format = 1
[experiment]
stop = 0.5
algorithm = "jacobi"
[[units]]
name = "a"
fmu = "signal_effects.fmu"
interval = 0.01
[[units]]
name = "delay_1"
fmu = "signal_effects.fmu"
interval = 0.02
[[units]]
name = "c"
fmu = "signal_effects.fmu"
interval = 0.01
[[connections]]
from = "a.y"
to = "delay_1.u"
latency = 0.1
gain = 2.0
bias = 1.0
[[connections]]
from = "delay_1.y"
to = "c.u"
latency = 0.1
jitter = 0.01
[[sources]]
to = "a.u"
kind = "linear"
points = [[0.0, 0.0], [0.5, 1.0]]
[record]
variables = ["delay_1.u", "a.u"]
"#;
    let scenario = Scenario::parse(toml, folder.path().join("mine.toml")).expect("a scenario");
    let simulation = Simulation::new(&scenario, &UnitPath::new().with(units())).expect("builds");
    let (with_units, notes) = ssp::with_delay_units(&simulation);
    assert_eq!(notes.len(), 1, "{notes:?}");
    assert!(notes[0].starts_with("delay_1.y -> c.u: its latency stays an annotation of ours"), "{notes:?}");
    let names: Vec<&str> = with_units.units.iter().map(|unit| unit.name.as_str()).collect();
    assert_eq!(names, ["a", "delay_1", "c", "delay_2"]);
    let table = |scenario: &Scenario| {
        let rows = results(scenario, folder.path());
        let number = |cell: &str| cell.parse::<f64>().expect("a number");
        rows.lines().skip(1).map(|row| row.split(',').map(number).collect::<Vec<_>>()).collect::<Vec<_>>()
    };
    let (latency, units) = (table(&scenario), table(&with_units));
    assert_eq!(latency.len(), units.len());
    for (by_latency, by_unit) in latency.iter().zip(&units).filter(|(row, _)| row[0] >= 0.2) {
        // The ramp's 2/s, doubled, over two steps of the delay's unit with Jacobi and one that the receiver is behind.
        let late = by_latency[1] - by_unit[1];
        assert!(late.abs() <= 4.0 * 0.031, "{by_latency:?} {by_unit:?}");
    }
    // The package runs in our master as it would in another one.
    let simulation = Simulation::new(&with_units, &UnitPath::new().with(self::units())).expect("builds");
    let path = folder.path().join("mine.ssp");
    std::fs::write(&path, ssp::write(&simulation).expect("written")).expect("writable");
    assert_eq!(table(&ssp::read(&path).expect("read")), units);
}

#[test]
fn law_mappings_of_values_come_back() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let toml = r#"
format = 1
[experiment]
stop = 0.2
[[units]]
name = "camera"
fmu = "acrobot_camera.fmu"
interval = "1/60"
[[units]]
name = "controller"
fmu = "acrobot_controller.fmu"
interval = "1/60"
[[units]]
name = "other"
fmu = "acrobot_controller.fmu"
interval = "1/60"
[[connections]]
from = "camera.frame"
to = "controller.frame"
map = [[1, -1], [3, 0]]
[[connections]]
from = "camera.valid"
to = "other.frame"
map = [[true, 8]]
[record]
variables = ["camera.frame", "controller.frame", "other.frame"]
"#;
    let scenario = Scenario::parse(toml, folder.path().join("mine.toml")).expect("a scenario");
    let simulation = Simulation::new(&scenario, &UnitPath::new().with(units())).expect("builds");
    let path = folder.path().join("mine.ssp");
    std::fs::write(&path, ssp::write(&simulation).expect("written")).expect("writable");
    let read = ssp::read(&path).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(results(&scenario, folder.path()), results(&read, folder.path()));
    let rows = results(&read, folder.path());
    // Frames come at 30 Hz: the second one passes, the first and the third become others.
    let seen: Vec<&str> =
        rows.lines().skip(1).filter_map(|row| row.split_once(',')).map(|(_, rest)| rest).collect();
    for row in ["1,-1,8", "2,2,8", "3,0,8"] {
        assert!(seen.contains(&row), "{row}: {rows}");
    }
}
