//! Units and archives that mean no good, or don't know better: the run survives them and says what was odd.

use crate::common;

use crate::common::{STATEFUL, Units};
use orchestrator::{CsvRecorder, Ended, Error, Fmu, MemoryRecorder, Quiet, Scenario, Simulation};

/// One unit with a fault from 0.5 s on, stepping by 1/8 s to 1 s.
fn faulty(fault: i32, more: &str) -> String {
    format!(
        "format = 1\nexperiment = {{ stop = 1 }}\n[[units]]\nname = \"a\"\nfmu = \"stateful.fmu\"\ninterval = 0.125\n\
         set = {{ fault = {fault}, fault_time = 0.5, mode = 2 }}\n{more}"
    )
}

fn build(units: &Units, text: &str) -> Result<Simulation, Error> {
    Simulation::new(&Scenario::parse(text, "test.toml")?, &units.unit_path())
}

#[test]
fn law_a_foreign_environment_is_not_looked_into() {
    // As Overture's units do it: the unit logs with a pointer that the master never gave. Here it is the address 8.
    let units = Units::new();
    let mut simulation = build(&units, &faulty(19, "")).expect("builds");
    assert_eq!(simulation.run(&mut MemoryRecorder::new(), &mut Quiet).expect("runs"), Ended::AtStop);
    let path = units.path().join("stateful.fmu");
    let mut instance = Fmu::open(path).expect("opens").instantiate("b").expect("instantiates");
    instance.set_integer(&[2], &[19]).expect("fault");
    instance.set_real(&[6], &[0.0]).expect("fault_time");
    instance.setup_experiment(0.0, None).expect("set up");
    instance.enter_initialization().expect("enters");
    instance.exit_initialization().expect("exits");
    assert_eq!(instance.do_step(0.0, 0.25, true), orchestrator::fmu::Status::Ok);
    let log: Vec<String> = instance.log().iter().map(ToString::to_string).collect();
    assert_eq!(log, ["[warning, mine] unknown instance: for nobody at 0.25"]);
    // It is the library that tells whose it may be: an instance of another one is not told.
    let other = Fmu::open(units.path().join("feedthrough.fmu"))
        .expect("opens")
        .instantiate("c")
        .expect("instantiates");
    assert_eq!(instance.do_step(0.25, 0.25, true), orchestrator::fmu::Status::Ok);
    assert_eq!((instance.log().len(), other.log().len()), (2, 0));
}

#[test]
fn law_a_unit_that_wants_to_end_ends_the_run() {
    let units = Units::new();
    let mut simulation = build(&units, &faulty(15, "")).expect("builds");
    let mut results = MemoryRecorder::new();
    // The step from 0.375 s is left half way, at 0.4375 s: that is the last row.
    let ended = Ended::ByUnit { unit: "a".into(), time: 0.4375 };
    assert_eq!(simulation.run(&mut results, &mut Quiet).expect("a regular end"), ended);
    assert_eq!(results.times(), [0.0, 0.125, 0.25, 0.375, 0.4375]);
    assert_eq!(simulation.run(&mut orchestrator::NoRecorder, &mut Quiet).expect("again, unseen"), ended);
    simulation.reset();
    while simulation.advance().expect("a regular end").is_some() {}
    assert_eq!(simulation.time(), 0.4375);
    // One that does not get on at all has its last row already.
    let stays = ("u->reached = from + size / 2;", "u->reached = from;");
    units.pack("stateful.fmu", &common::description(STATEFUL), &common::library_with(&[stays]));
    let ended = Ended::ByUnit { unit: "a".into(), time: 0.375 };
    let mut simulation = build(&units, &faulty(15, "")).expect("builds");
    assert_eq!(simulation.run(&mut results, &mut Quiet).expect("a regular end"), ended);
    assert_eq!(results.times(), [0.0, 0.125, 0.25, 0.375]);
    units.add(STATEFUL);
    // Beside a unit that has gone on to the point already, the row is that of the point.
    let text = faulty(15, "[[units]]\nname = \"b\"\nfmu = \"stateful.fmu\"\ninterval = 0.125\n");
    let (head, units_of) = text.split_once("[[units]]").expect("units");
    let (a, b) = units_of.split_once("[[units]]").expect("two");
    let mut simulation = build(&units, &format!("{head}[[units]]{b}[[units]]{a}")).expect("builds");
    let ended = Ended::ByUnit { unit: "a".into(), time: 0.5 };
    assert_eq!(simulation.run(&mut results, &mut Quiet).expect("a regular end"), ended);
    assert_eq!(results.times().last(), Some(&0.5));
}

#[test]
fn law_what_is_not_finite_is_told_once_and_recorded() {
    let units = Units::new();
    for (fault, expected, column) in [
        (17, "a.y2 is NaN at t = 0.5 s, for the first time", "a.y2"),
        (16, "a.y1 is inf at t = 0.5 s, for the first time", "a.y1"),
    ] {
        let mut simulation = build(&units, &faulty(fault, "")).expect("builds");
        let mut results = MemoryRecorder::new();
        for _ in 0..2 {
            simulation.run(&mut results, &mut Quiet).expect("nobody reads it");
            assert_eq!(simulation.notices(), [expected]);
        }
        let series = results.series(column).expect("recorded");
        assert!(series[3].is_finite() && !series[4].is_finite() && !series[8].is_finite());
    }
}

#[test]
fn law_what_is_not_finite_is_told_at_the_end_where_nobody_reads_it() {
    let units = Units::new();
    for (record, expected) in [
        ("a.y1", vec!["a.y2 is NaN at t = 1 s, at the end; nothing reads it"]),
        ("a.*", vec!["a.y2 is NaN at t = 0.5 s, for the first time"]),
    ] {
        let text = faulty(17, &format!("[record]\nvariables = [\"{record}\"]\n"));
        let mut simulation = build(&units, &text).expect("builds");
        for _ in 0..2 {
            simulation.run(&mut MemoryRecorder::new(), &mut Quiet).expect("nobody reads it");
            simulation.look_over();
            simulation.look_over();
            assert_eq!(simulation.notices(), expected);
        }
        simulation.terminate();
        simulation.look_over();
        assert_eq!(simulation.notices(), expected, "a unit that was ended is asked nothing");
    }
}

#[test]
fn law_what_is_not_finite_at_the_start_is_told_or_an_error() {
    let units = Units::new();
    let parts = [
        common::unit("a", "feedthrough.fmu", "mode = 1, k = 1e6, u1 = 1e303"),
        common::unit("b", "stateful.fmu", ""),
    ];
    let mut simulation = common::build(&units, &parts).expect("builds");
    simulation.initialize().expect("nobody has it");
    assert_eq!(simulation.notices(), ["a.y1 is inf at t = 0 s, for the first time"]);
    let delayed = format!("{}latency = 0.125\n", common::connection("a.y1", "b.u1"));
    let mut simulation = common::build(&units, &[&parts[..], &[delayed]].concat()).expect("builds");
    let error = simulation.initialize().expect_err("b would get it").to_string();
    assert!(error.contains("a.y1") && error.contains("inf") && error.contains("t = 0 s"), "{error}");
}

#[test]
fn law_an_end_that_a_unit_refuses_is_told() {
    let mut simulation = build(&Units::new(), &faulty(22, "")).expect("builds");
    simulation.run(&mut MemoryRecorder::new(), &mut Quiet).expect("runs");
    assert!(simulation.notices().is_empty());
    simulation.terminate();
    assert_eq!(simulation.notices(), ["unit a: fmi2Terminate answered error"]);
    simulation.terminate();
    assert_eq!(simulation.notices().len(), 1, "once");
    simulation.run(&mut MemoryRecorder::new(), &mut Quiet).expect("runs again");
}

#[test]
fn law_names_that_are_not_clear_are_refused_where_they_count() {
    let units = Units::new();
    let good = common::description(STATEFUL);
    let twice = good.replace("name=\"y2\"", "name=\"y1\"");
    units.pack("stateful.fmu", &twice, &common::library());
    let message = |more: &str| build(&units, &faulty(0, more)).err().map(|error| error.to_string());
    assert_eq!(
        message("").expect("all outputs are recorded"),
        "test.toml:3: unit a has several variables called \"y1\": mend its modelDescription.xml, or record and connect \
         others: it is not clear which is meant"
    );
    let by_name = message("[record]\nvariables = [\"a.y1\"]\n").expect("named");
    assert!(by_name.starts_with("test.toml:9: unit a has several variables called \"y1\""), "{by_name}");
    assert_eq!(message("[record]\nvariables = [\"a.b_out\"]\n"), None, "others are clear");
    units.pack("stateful.fmu", &good.replace("name=\"y2\"", "name=\"\""), &common::library());
    assert!(message("").expect("recorded").starts_with("test.toml:3: unit a has a variable without a name"));
}

#[test]
fn bad_a_limit_that_is_no_number_is_refused_with_its_line() {
    let units = Units::new();
    let odd = common::description(STATEFUL).replace("start=\"1\" max=\"1e6\"", "start=\"1\" max=\"NaN\"");
    let path = units.pack("stateful.fmu", &odd, &common::library());
    let error = orchestrator::Fmu::open(path).map(drop).expect_err("it limits nothing").to_string();
    assert!(
        error.contains("modelDescription.xml:") && error.contains("max=\"NaN\" in <Real> is not a number"),
        "{error}"
    );
}

#[test]
fn law_odd_descriptions_are_told() {
    let units = Units::new();
    let odd = common::description(STATEFUL)
        .replace("start=\"1\" max=\"1e6\"", "start=\"2e6\" max=\"1e6\" unit=\"furlong\"")
        .replace("min=\"0\" max=\"2\"", "min=\"3\" max=\"2\"")
        .replace("modelIdentifier=\"unit\"", "modelIdentifier=\"another\"");
    units.pack("stateful.fmu", &odd, &common::library());
    let text = faulty(0, "").replace(", mode = 2", "");
    assert_eq!(
        build(&units, &text).expect("builds").notices(),
        [
            "unit a: its library is called unit.so, not another.so; it is the only one",
            "unit a: its UnitDefinitions lack furlong: values in these are not converted",
            "unit a: k: its start value 2000000 lies outside its own limits",
            "unit a: mode: min 3 is above max 2",
        ]
    );
    // A start value just at its limits is within them.
    for (start, told) in [("1", 0), ("2", 0), ("3", 1), ("0", 1)] {
        let limits = format!("start=\"{start}\" min=\"1\" max=\"2\"");
        let limited = common::description(STATEFUL).replace("start=\"1\" max=\"1e6\"", &limits);
        units.pack("stateful.fmu", &limited, &common::library());
        assert_eq!(build(&units, &text).expect("builds").notices().len(), told, "{start}");
    }
    // Of many the first ones stand for all.
    let start =
        |name: &str| format!("name=\"{name}\" valueReference=\"0\" causality=\"input\"><Real start=\"0\"/>");
    let many: String =
        (0..7).map(|n| format!("<ScalarVariable {}</ScalarVariable>", start(&format!("n{n}")))).collect();
    let many = many.replace("start=\"0\"", "start=\"0\" min=\"1\"");
    let odd =
        common::description(STATEFUL).replace("  </ModelVariables>", &format!("{many}</ModelVariables>"));
    units.pack("stateful.fmu", &odd, &common::library());
    let told = build(&units, &text).expect("builds").notices();
    assert_eq!(told.len(), 6, "{told:#?}");
    assert_eq!(told[4], "unit a: n4: its start value 0 lies outside its own limits");
    assert_eq!(told[5], "unit a: and 2 more like these");
}

#[test]
fn law_a_unit_is_told_the_tolerance_that_its_description_proposes() {
    let units = Units::new();
    let plain = common::description(STATEFUL);
    for (tolerance, told) in [
        ("", vec![]),
        ("tolerance=\"1e-5\"", vec!["[warning, events] tolerance 1e-05"]),
        ("tolerance=\"0\"", vec![]),
    ] {
        let text = plain.replace("<DefaultExperiment ", &format!("<DefaultExperiment {tolerance} "));
        let path = units.pack("told.fmu", &text, &common::library());
        for isolated in [false, true] {
            let mut fmu = Fmu::open(&path).expect("opens");
            if isolated {
                unit_host();
                fmu = fmu.isolated(orchestrator::Isolation::default());
            }
            let mut instance = fmu.instantiate("a").expect("instantiates");
            instance.setup_experiment(0.0, None).expect("set up");
            let log: Vec<String> = instance.log().iter().map(ToString::to_string).collect();
            assert_eq!(log, told, "{tolerance}, isolated {isolated}");
        }
    }
}

/// The units' processes are this program with only this test, which serves them and never returns.
#[test]
fn unit_host() {
    orchestrator::host_units(["--exact", "hostile::unit_host", "--nocapture", "--test-threads=1"]);
}

fn open(units: &Units, name: &str) -> String {
    Fmu::open(units.path().join(name)).expect_err("too large").to_string()
}

/// Set in the process that has limits of its own.
const CHILD: &str = "ORCHESTRATOR_SMALL_LIMITS";

#[test]
fn law_limits_can_be_moved() {
    let units = Units::new();
    if std::env::var_os(CHILD).is_some() {
        // The unit's library alone has more than 1 KiB.
        let found = open(&units, "stateful.fmu");
        let what = "what it unpacks to, as far as binaries/linux64/unit.so, exceeds the limit of 1K; if it is to be \
                    trusted, set ACROSCOPE_MAX_UNPACKED=2K";
        assert!(found.ends_with(what), "{found}");
        let many: Vec<String> = (0..60).map(|number| format!("resources/{number}")).collect();
        let files: Vec<(&str, &[u8])> = many.iter().map(|name| (name.as_str(), &b""[..])).collect();
        units.pack_files("many.fmu", &common::description(STATEFUL), &files);
        let found = open(&units, "many.fmu");
        let what = "the number of its entries, 61, exceeds the limit of 50; if it is to be trusted, set \
                    ACROSCOPE_MAX_ENTRIES=100";
        assert!(found.ends_with(what), "{found}");
        return;
    }
    let child = std::process::Command::new(std::env::current_exe().expect("this program"))
        .args(["--exact", "hostile::law_limits_can_be_moved"])
        .envs([(CHILD, "1"), ("ACROSCOPE_MAX_UNPACKED", "1K"), ("ACROSCOPE_MAX_ENTRIES", "50")])
        .output()
        .expect("starts");
    assert!(child.status.success(), "{}", String::from_utf8_lossy(&child.stdout));
}

#[test]
fn law_a_file_in_too_many_folders_is_refused() {
    // More folders than files that may be open could not be taken away again.
    let units = Units::new();
    let open = |folders: usize| {
        let resource = format!("resources/{}file", "d/".repeat(folders - 1));
        units.pack_files("deep.fmu", &common::description(STATEFUL), &[(&resource, b"x")]);
        Fmu::open(units.path().join("deep.fmu")).map(drop).map_err(|error| error.to_string())
    };
    assert_eq!(open(100), Ok(()));
    let error = open(101).expect_err("too deep");
    let told =
        format!("resources/{}… lies in 101 folders; expected at most 100, one in the other", "d/".repeat(25));
    assert!(error.ends_with(&told), "{error}");
}

#[test]
fn law_archives_unpack_no_more_than_they_may() {
    let units = Units::new();
    let good = common::description(STATEFUL);
    // 300 MB of spaces shrink to 300 kB.
    let long = good.replace("<DefaultExperiment", &format!("{}<DefaultExperiment", " ".repeat(300 << 20)));
    units.pack("description.fmu", &long, b"");
    drop(long);
    let found = open(&units, "description.fmu");
    assert!(
        found.ends_with(
            "modelDescription.xml exceeds the limit of 256M; if it is to be trusted, set ACROSCOPE_MAX_DESCRIPTION=512M"
        ),
        "{found}"
    );
    // Nesting costs neither stack nor memory, whether the elements are known or not.
    let nested = |name: &str| {
        format!("{}{}", format!("<{name}>").repeat(200_000), format!("</{name}>").repeat(200_000))
    };
    let annotated = good.replace("<anything at=\"all\"/>", &nested("anything"));
    units.pack("nested.fmu", &annotated, b"");
    Fmu::open(units.path().join("nested.fmu")).expect("annotations are nobody's business");
    units.pack(
        "known.fmu",
        &good.replace("<DefaultExperiment", &format!("{}<DefaultExperiment", nested("Unit"))),
        b"",
    );
    assert!(open(&units, "known.fmu").contains("elements nest more than 100 deep"));
}

#[test]
fn law_a_changed_directory_spoils_no_results() {
    // The file is open before the unit moves away; a path of its own would be lost.
    let units = Units::new();
    let folder = tempfile::TempDir::new().expect("a temporary folder");
    let mut simulation = build(&units, &faulty(18, "")).expect("builds");
    let file = folder.path().join("results.csv");
    simulation.run(&mut CsvRecorder::create(&file).expect("made"), &mut Quiet).expect("runs");
    assert_eq!(std::fs::read_to_string(file).expect("there").lines().count(), 10);
}
