//! Large systems: what it takes to open them grows as they do, and no faster. Bytes are counted, which are the same on
//! every machine; instructions are in `benches/instructions.txt`.

#![allow(unsafe_code)] // an allocator that counts

use crate::common::{Units, library};
use orchestrator::{Fmu, NoRecorder, Quiet, Scenario, Simulation};
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Counts what is held.
struct Counting;

static HELD: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);

// SAFETY: the system's allocator does everything.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let held = HELD.fetch_add(layout.size(), Relaxed) + layout.size();
        MOST.fetch_max(held, Relaxed);
        // SAFETY: as asked.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        HELD.fetch_sub(layout.size(), Relaxed);
        // SAFETY: as asked.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// To be held by a test from its first line on: what another one makes meanwhile, measured or not, would be counted.
fn turn() -> MutexGuard<'static, ()> {
    static TURNS: Mutex<()> = Mutex::new(());
    TURNS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The most bytes that were held at once while something was done.
fn most<T>(work: impl FnOnce() -> T) -> (T, usize) {
    let before = HELD.load(Relaxed);
    MOST.store(before, Relaxed);
    let made = work();
    (made, MOST.load(Relaxed) - before)
}

const HEAD: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="large" guid="{fixture}">
<CoSimulation modelIdentifier="unit" canHandleVariableCommunicationStepSize="true"/>
<UnitDefinitions><Unit name="Pa"><BaseUnit kg="1" m="-1" s="-2"/></Unit></UnitDefinitions>
<TypeDefinitions><SimpleType name="Pressure"><Real unit="Pa" min="0"/></SimpleType></TypeDefinitions>
<ModelVariables>
"#;

/// A description of so many variables as Modelica tools write them.
fn described(count: usize) -> String {
    let mut text = HEAD.to_owned();
    for number in 0..count {
        let (part, volume) = (number / 100, number % 100);
        text += &format!(
            "<ScalarVariable name=\"system.part{part}.volume{volume}.p\" valueReference=\"3\" description=\"pressure of \
             volume {volume} in part {part}\" causality=\"local\"><Real declaredType=\"Pressure\"/></ScalarVariable>\n"
        );
    }
    text + "</ModelVariables><ModelStructure/></fmiModelDescription>"
}

#[test]
fn law_a_description_takes_memory_for_its_variables_only() {
    let _turn = turn();
    let units = Units::new();
    let opened = |count: usize| {
        let file = units.pack(&format!("large{count}.fmu"), &described(count), b"none is loaded");
        let (fmu, most) = most(|| Fmu::open(&file).expect("a unit"));
        let last = format!("system.part{}.volume99.p", count / 100 - 1);
        let found = fmu.description().variable(&last).expect("the last variable");
        assert_eq!((found.unit.as_deref(), found.min), (Some("Pa"), Some(0.0)));
        most
    };
    let (once, twice) = (opened(20_000), opened(40_000));
    // A variable of these is 104 bytes, its two texts 26 and 33, a place by name 16 at most, and a vector that grows may be
    // three quarters empty while it does. The text itself would be 190 more, a tree of elements 1500.
    let each = (twice - once) / 20_000;
    assert!(each < 400, "{each} bytes a variable; {once}, {twice}");
}

/// A network: each input of ten a unit from an output of another one.
fn network(units: usize) -> String {
    let mut text =
        "format = 1\nexperiment = { stop = 0.02 }\nrecord = { variables = [\"u0.y1\"] }\n".to_owned();
    for unit in 0..units {
        text += &format!("[[units]]\nname = \"u{unit}\"\nfmu = \"wide.fmu\"\ninterval = 0.01\n");
    }
    for unit in 0..units {
        for port in 1..=10 {
            let from = (unit * 7 + port * 13 + 1) % units;
            text += &format!("[[connections]]\nfrom = \"u{from}.y{port}\"\nto = \"u{unit}.u{port}\"\n");
        }
    }
    text
}

/// Ten inputs and outputs, of which nothing is said to depend on what where `said` is false.
fn wide(said: bool) -> String {
    let mut text = HEAD.to_owned();
    for (causality, letter, reference, start) in [("input", "u", 0, " start=\"0\""), ("output", "y", 2, "")] {
        for port in 1..=10 {
            text += &format!(
                "<ScalarVariable name=\"{letter}{port}\" valueReference=\"{reference}\" causality=\"{causality}\"><Real{start}/></ScalarVariable>\n"
            );
        }
    }
    text += "</ModelVariables><ModelStructure><Outputs>";
    let dependencies = if said { " dependencies=\"\"" } else { "" };
    for output in 11..=20 {
        text += &format!("<Unknown index=\"{output}\"{dependencies}/>");
    }
    text + "</Outputs></ModelStructure></fmiModelDescription>"
}

#[test]
fn law_a_network_takes_memory_for_its_connections_only() {
    let _turn = turn();
    for said in [true, false] {
        let units = Units::new();
        units.pack("wide.fmu", &wide(said), &library());
        let run = |count: usize| {
            let scenario =
                Scenario::parse(&network(count), units.path().join("network.toml")).expect("a scenario");
            let (mut simulation, most) =
                most(|| Simulation::new(&scenario, &units.unit_path()).expect("it is built"));
            simulation.run(&mut NoRecorder, &mut Quiet).expect("it runs");
            // A loop through many units is told in a line that a person can read.
            let notices = simulation.notices();
            assert_eq!(notices.iter().any(|notice| notice.contains("algebraic loop")), !said);
            assert!(notices.iter().all(|notice| notice.len() < 1000), "{notices:?}");
            most
        };
        let (once, twice) = (run(200), run(400));
        // Tables double their size at other places; four times would be quadratic.
        assert!((twice as f64) < 2.6 * once as f64, "{once} bytes for 200 units, {twice} for 400");
    }
}
