//! A run goes on from a checkpoint to the same bytes, whenever it was left.

use crate::common;

use crate::common::Units;
use orchestrator::{
    Checkpoint, Checkpoints, CsvRecorder, Ended, Isolation, Progress, Quiet, Scenario, Simulation, UnitPath,
};
use std::ops::ControlFlow;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

/// Three rates, values on their way that jitter and get lost, a line between values, ages, an offset, texts, a source, a value
/// that is not finite, a last step that is shorter.
const SYSTEM: &str = r#"
    format = 1
    experiment = { stop = 2.05, seed = 7 }
    [[units]]
    name = "a"
    fmu = "stateful.fmu"
    interval = 0.005
    set = { k = 2.0, x0 = 0.25, s_in = "tex,t" }
    [[units]]
    name = "b"
    fmu = "feedthrough.fmu"
    interval = 0.03
    offset = 0.01
    set = { mode = 1, k = -0.3 }
    [[units]]
    name = "c"
    fmu = "stateful.fmu"
    interval = "1/30"
    set = { fault = 17, fault_time = 0.1 }
    [[connections]]
    from = "a.y1"
    to = "b.u1"
    latency = 0.02
    hold = "linear"
    [[connections]]
    from = "b.y1"
    to = "c.u1"
    [[connections]]
    from = "c.y1"
    to = "a.u1"
    latency = "1/4"
    jitter = 0.05
    drop = 0.2
    [[connections]]
    from = "a.s_out"
    to = "b.s_in"
    [[sources]]
    to = "a.u2"
    kind = "smooth"
    points = [[0, 0], [1.5, 1]]
    [record]
    variables = ["*", "*:age"]
"#;

/// Ends the run after so many looks.
struct Leave(u32);

impl Progress for Leave {
    fn at(&mut self, _: f64, _: f64) -> ControlFlow<()> {
        self.0 = self.0.saturating_sub(1);
        if self.0 == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

fn whole(scenario: &Scenario, path: &UnitPath, file: &Path) -> String {
    let mut simulation = Simulation::new(scenario, path).expect("builds");
    simulation.run(&mut CsvRecorder::create(file).expect("made"), &mut Quiet).expect("runs");
    std::fs::read_to_string(file).expect("there")
}

/// Goes on from the last checkpoint, or begins.
fn go_on(scenario: &Scenario, path: &UnitPath, folder: &Path, progress: &mut dyn Progress) -> Ended {
    let (file, results) = (folder.join("checkpoint.bin"), folder.join("results.csv"));
    let from = Checkpoint::load(&file).expect("whole");
    let mut simulation = Simulation::new(scenario, path).expect("builds");
    let mut recorder = match &from {
        Some(checkpoint) => CsvRecorder::resume(&results, checkpoint.position()).expect("goes on"),
        None => CsvRecorder::create(&results).expect("made"),
    };
    let checkpoints = Checkpoints { file, every: 0.1 };
    let ended = simulation.run_on(from.as_ref(), Some(&checkpoints), &mut recorder, progress).expect("runs");
    if ended == Ended::AtStop {
        let notices = simulation.notices();
        assert!(notices.iter().any(|n| n.starts_with("c.y2 is NaN at t = 0.1")), "{notices:?}");
    }
    ended
}

#[test]
fn unit_host() {
    orchestrator::host_units(["--exact", "checkpoint::unit_host", "--nocapture", "--test-threads=1"]);
}

#[test]
fn every_algorithm_goes_on_to_the_same_bytes() {
    unit_host();
    let units = Units::new();
    for algorithm in common::every_rate() {
        for isolated in [false, true] {
            let folder = tempfile::TempDir::new().expect("a temporary folder");
            let mut scenario = Scenario::parse(SYSTEM, "test.toml").expect("a scenario");
            scenario.algorithm.value = algorithm.into();
            for unit in scenario.units.iter_mut().filter(|_| isolated) {
                unit.isolation = Some(Isolation::default());
            }
            let expected = whole(&scenario, &units.unit_path(), &folder.path().join("whole.csv"));
            let mut times = 0;
            // Left after one look more each time: before, at and between checkpoints.
            while go_on(&scenario, &units.unit_path(), folder.path(), &mut Leave(5 + times)) != Ended::AtStop
            {
                times += 1;
            }
            assert!(times > 1, "left {times} times");
            let found = std::fs::read_to_string(folder.path().join("results.csv")).expect("there");
            assert!(found == expected, "{algorithm}, left {times} times");
        }
    }
}

/// Ends the run at this time.
struct Until(f64);

impl Progress for Until {
    fn at(&mut self, time: f64, _: f64) -> ControlFlow<()> {
        if time >= self.0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

#[test]
fn law_a_run_that_starts_later_has_its_checkpoints_and_tells_all_it_told() {
    unit_host();
    let units = Units::new();
    let folder = tempfile::TempDir::new().expect("a temporary folder");
    let text = SYSTEM
        .replace("stop = 2.05", "start = 10, stop = 12.05")
        .replace("fault_time = 0.1", "fault_time = 10.1")
        .replace("[[0, 0], [1.5, 1]]", "[[10, 0], [11.5, 1]]");
    let scenario = Scenario::parse(&text, "test.toml").expect("a scenario");
    let path = units.unit_path();
    let mut simulation = Simulation::new(&scenario, &path).expect("builds");
    let whole = folder.path().join("whole.csv");
    simulation.run(&mut CsvRecorder::create(&whole).expect("made"), &mut Quiet).expect("runs");
    let expected = simulation.notices().to_vec();
    assert!(!expected.is_empty());

    let (file, results) = (folder.path().join("checkpoint.bin"), folder.path().join("results.csv"));
    let checkpoints = Checkpoints { file, every: 0.1 };
    let mut first = Simulation::new(&scenario, &path).expect("builds");
    let mut recorder = CsvRecorder::create(&results).expect("made");
    let ended = first.run_on(None, Some(&checkpoints), &mut recorder, &mut Until(11.0)).expect("runs");
    assert_ne!(ended, Ended::AtStop);
    drop(recorder);
    let checkpoint =
        Checkpoint::load(&checkpoints.file).expect("whole").expect("there is one after a second");
    let mut recorder = CsvRecorder::resume(&results, checkpoint.position()).expect("goes on");
    let mut second = Simulation::new(&scenario, &path).expect("builds");
    second.run_on(Some(&checkpoint), None, &mut recorder, &mut Quiet).expect("runs");
    drop(recorder);
    assert_eq!(second.notices(), expected, "what was told before the checkpoint, and once");
    let read = |file| std::fs::read_to_string(file).expect("there");
    assert!(read(results) == read(whole));
}

#[test]
fn every_checkpoint_that_does_not_fit_is_refused() {
    let units = Units::new();
    let folder = tempfile::TempDir::new().expect("a temporary folder");
    let file = folder.path().join("checkpoint.bin");
    let scenario = Scenario::parse(SYSTEM, "test.toml").expect("a scenario");
    assert!(Checkpoint::load(&file).expect("none").is_none());
    while Checkpoint::load(&file).expect("whole").is_none() {
        go_on(&scenario, &units.unit_path(), folder.path(), &mut Leave(8));
    }
    let checkpoint = Checkpoint::load(&file).expect("whole").expect("one");
    let mut other = scenario.clone();
    other.set("a.k", "2.5").expect("a unit");
    let mut simulation = Simulation::new(&other, &units.unit_path()).expect("builds");
    let results = folder.path().join("results.csv");
    let mut recorder = CsvRecorder::resume(&results, checkpoint.position()).expect("goes on");
    let error =
        simulation.run_on(Some(&checkpoint), None, &mut recorder, &mut Quiet).expect_err("another run");
    assert!(error.is_input());
    assert!(error.to_string().ends_with("this one differs: `k = 2.5` instead of `k = 2.0`"), "{error}");

    let bytes = std::fs::read(&file).expect("there");
    for (damaged, expected) in [
        (&bytes[..bytes.len() - 1], "it is damaged"),
        (&bytes[..30], "it is cut off"),
        (&b"something else"[..], "it is no checkpoint of this version"),
    ] {
        std::fs::write(&file, damaged).expect("writable");
        let error = Checkpoint::load(&file).expect_err("damaged");
        assert!(error.is_input() && error.to_string().contains(expected), "{error}");
    }
    std::fs::write(&results, "time\n").expect("writable");
    let error = CsvRecorder::resume(&results, checkpoint.position()).err().expect("cut off").to_string();
    assert!(
        error.ends_with("it is shorter than at the checkpoint; without --resume the run begins anew"),
        "{error}"
    );

    let plain = common::description(common::STATEFUL).replace("canSerializeFMUstate=\"true\"", "");
    units.pack("stateful.fmu", &plain, &common::library());
    let mut simulation = Simulation::new(&scenario, &units.unit_path()).expect("builds");
    let checkpoints = Checkpoints { file, every: 0.1 };
    let mut recorder = CsvRecorder::new(Vec::new());
    let error = simulation.run_on(None, Some(&checkpoints), &mut recorder, &mut Quiet).expect_err("can't");
    assert!(error.is_input() && error.to_string().starts_with("checkpoint = unit a: "), "{error}");
}

/// Set in the process that is to be killed: the folder of its results, and that of the units.
const CHILD: &str = "ORCHESTRATOR_KILLED_CHECKPOINTS";
const UNITS: &str = "ORCHESTRATOR_KILLED_UNITS";

/// Each step of `a` takes 2 ms.
fn slow() -> Scenario {
    let text = SYSTEM.replace("x0 = 0.25", "x0 = 0.25, fault = 8, fault_time = 0");
    Scenario::parse(&text, "test.toml").expect("a scenario")
}

#[test]
fn law_a_run_that_is_killed_again_and_again_gives_the_same_bytes() {
    if let (Some(folder), Some(units)) = (std::env::var_os(CHILD), std::env::var_os(UNITS)) {
        go_on(&slow(), &UnitPath::new().with(units), Path::new(&folder), &mut Quiet);
        return;
    }
    let units = Units::new();
    let folder = tempfile::TempDir::new().expect("a temporary folder");
    let child = || {
        Command::new(std::env::current_exe().expect("this program"))
            .args(["--exact", "checkpoint::law_a_run_that_is_killed_again_and_again_gives_the_same_bytes"])
            .env(CHILD, folder.path())
            .env(UNITS, units.path())
            // Its units lie here, since a killed process cleans nothing up.
            .env("TMPDIR", folder.path())
            .stdout(Stdio::null())
            .spawn()
            .expect("starts")
    };
    let mut moment = 1u64;
    for _ in 0..50 {
        let mut child = child();
        moment = moment.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        // From before its first row to a few checkpoints later.
        std::thread::sleep(Duration::from_millis((moment >> 33) % 150));
        child.kill().expect("killed with SIGKILL");
        child.wait().expect("ends");
    }
    assert!(child().wait().expect("ends").success());
    let found = std::fs::read_to_string(folder.path().join("results.csv")).expect("there");
    let expected = whole(&slow(), &units.unit_path(), &folder.path().join("whole.csv"));
    assert!(found == expected);
}

#[test]
fn law_a_full_disk_leaves_whole_rows_and_is_the_machines() {
    let units = Units::new();
    let scenario = Scenario::parse(SYSTEM, "test.toml").expect("a scenario");
    let mut simulation = Simulation::new(&scenario, &units.unit_path()).expect("builds");
    let mut recorder = CsvRecorder::create("/dev/full").expect("opens");
    let error = simulation.run(&mut recorder, &mut Quiet).expect_err("full");
    assert!(!error.is_input(), "exit status 1");
    assert!(
        error.to_string().starts_with("cannot write results to /dev/full: No space left on device"),
        "{error}"
    );
    let error = CsvRecorder::create("/proc/results.csv").err().expect("nobody writes there");
    assert!(error.is_input());
}

#[test]
fn law_a_saved_state_leads_on_to_the_same_bits() {
    let units = Units::new();
    let scenario = Scenario::parse(SYSTEM, "test.toml").expect("a scenario");
    let path = units.unit_path();
    let mut simulation = Simulation::new(&scenario, &path).expect("builds");
    simulation.advance_to(0.7).expect("steps");
    let state = simulation.save().expect("the units save their states");
    let rest = |simulation: &mut Simulation| {
        let mut seen = Vec::new();
        while let Some(time) = simulation.advance().expect("steps") {
            let names = ["a.y1", "b.y1", "c.y1"];
            seen.push((time, names.map(|name| simulation.value(name).expect("a number").to_bits())));
        }
        seen
    };
    let first = rest(&mut simulation);
    assert!(first.len() > 100, "{} points", first.len());
    // From the end, and from the middle of other values.
    simulation.go_back(&state).expect("the same scenario");
    assert_eq!(simulation.time(), state.time());
    assert_eq!(rest(&mut simulation), first);
    let mut other = Simulation::new(&scenario, &path).expect("builds");
    other.advance_to(0.2).expect("steps");
    other.go_back(&state).expect("the same scenario");
    assert_eq!(rest(&mut other), first);

    // A description is words, and two of a run may differ.
    let text = SYSTEM.replacen("format = 1", "format = 1\n    description = \"the same\"", 1);
    let told = Scenario::parse(&text, "test.toml").expect("a scenario");
    let mut other = Simulation::new(&told, &path).expect("builds");
    other.go_back(&state).expect("the same run");
    assert_eq!(rest(&mut other), first);
    let back = other.save().and_then(|state| simulation.go_back(&state));
    back.expect("the other way round");

    let mut changed = scenario.clone();
    changed.set("a.k", "2.5").expect("a parameter");
    let refused = Simulation::new(&changed, &path).expect("builds").go_back(&state).unwrap_err().to_string();
    assert!(refused.contains("differs"), "{refused}");
}

#[test]
fn bad_input_a_table_that_changed_since_the_checkpoint_is_told() {
    let units = Units::new();
    let text = "format = 1\nexperiment = { stop = 1 }\n[[units]]\nname = \"a\"\nfmu = \"stateful.fmu\"\ninterval = 0.5\n\
                [[sources]]\nto = \"a.u1\"\nkind = \"csv\"\nfile = \"u.csv\"\ncolumn = \"u\"\n";
    let scenario = Scenario::parse(text, units.path().join("s.toml")).expect("a scenario");
    let build = |table: &str| {
        std::fs::write(units.path().join("u.csv"), table).expect("writable");
        Simulation::new(&scenario, &units.unit_path()).expect("builds")
    };
    let state = build("time,u\n0,1\n1,3\n").save().expect("it can be saved");
    build("time,u\n0,1.0\n\n1,3\n").go_back(&state).expect("the same values");
    let told = build("time,u\n0,5\n1,3\n").go_back(&state).expect_err("others").to_string();
    assert!(told.contains("this one differs: `unit a: values fed from outside, of checksum "), "{told}");
}

#[test]
fn law_an_input_is_released_from_what_drives_it() {
    let units = Units::new();
    let path = units.unit_path();
    let mut scenario = Scenario::parse(SYSTEM, "test.toml").expect("a scenario");
    let mut bound = Simulation::new(&scenario, &path).expect("builds");
    bound.advance().expect("steps");
    assert!(bound.set("b.u1", 3.0).is_err(), "its connection would overwrite it");
    scenario.release("b.u1").expect("a connection drives it");
    scenario.release("a.u2").expect("a source drives it");
    let refused = scenario.release("c.u2").unwrap_err();
    assert!(refused.is_input());
    let refused = refused.to_string();
    assert!(refused.contains("driven input") && refused.contains("c.u1"), "{refused}");
    assert!(!refused.contains("does not exist"), "c.u2 does: {refused}");
    let mut free = Simulation::new(&scenario, &path).expect("builds");
    free.advance().expect("steps");
    free.set("b.u1", 3.0).expect("nothing drives it");
    assert_eq!(free.value("b.u1").expect("a number"), 3.0);
}

#[test]
fn law_a_checkpoint_is_made_at_the_point_that_is_due() {
    let (units, folder) = (Units::new(), tempfile::TempDir::new().expect("a temporary folder"));
    let (file, results) = (folder.path().join("checkpoint.bin"), folder.path().join("results.csv"));
    for (start, stop, expected) in [("0", "0.375", "0.25"), ("0", "0.5", "0.5"), ("0.125", "0.5", "0.375")] {
        let text = format!(
            "format = 1\nexperiment = {{ start = {start}, stop = {stop} }}\n[[units]]\nname = \"a\"\nfmu = \"stateful.fmu\"\ninterval = 0.125\n"
        );
        let scenario = Scenario::parse(&text, "test.toml").expect("a scenario");
        let mut simulation = Simulation::new(&scenario, &units.unit_path()).expect("builds");
        let checkpoints = Checkpoints { file: file.clone(), every: 0.25 };
        let mut recorder = CsvRecorder::create(&results).expect("made");
        simulation.run_on(None, Some(&checkpoints), &mut recorder, &mut Quiet).expect("runs");
        // The rows that it counts are those up to it.
        let checkpoint = Checkpoint::load(&file).expect("whole").expect("one");
        drop(CsvRecorder::resume(&results, checkpoint.position()).expect("goes on"));
        let rows = std::fs::read_to_string(&results).expect("there");
        let last = rows.lines().last().expect("rows").split(',').next();
        assert_eq!(last, Some(expected), "from {start} to {stop} s");
    }
}
