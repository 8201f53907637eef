//! Cost of the master beside a plain C loop over the same functions: a ring of three nearly free units with six
//! connections. Rounds are interleaved, medians are shown: `cargo bench -p orchestrator`.

#[path = "../tests/common/mod.rs"]
mod common;

use common::Units;
use orchestrator::{CsvRecorder, MemoryRecorder, NoRecorder, Quiet, Recorder, Scenario, Simulation};
use std::ffi::{c_int, c_uint, c_void};
use std::time::Instant;

const STEPS: i64 = 100_000;
const ROUNDS: usize = 31;

type Loop = unsafe extern "C" fn(*const c_void, *const c_void, *const c_void, f64, i64) -> f64;
type Call = unsafe extern "C" fn(*mut c_void, *const c_uint, usize, *mut f64) -> c_int;

fn ring_description() -> String {
    let variable = |name: &str, reference: u32, causality: &str| {
        let start = if causality == "input" { " start=\"0\"" } else { "" };
        format!(
            "<ScalarVariable name=\"{name}\" valueReference=\"{reference}\" causality=\"{causality}\"><Real{start}/></ScalarVariable>"
        )
    };
    let variables = [("u1", 0, "input"), ("u2", 1, "input"), ("y1", 2, "output"), ("y2", 3, "output")]
        .map(|(name, reference, causality)| variable(name, reference, causality))
        .concat();
    format!(
        "<fmiModelDescription fmiVersion=\"2.0\" modelName=\"ring\" guid=\"ring\"><CoSimulation modelIdentifier=\"unit\"/>\
         <ModelVariables>{variables}</ModelVariables><ModelStructure><Outputs><Unknown index=\"3\" dependencies=\"1\"/>\
         <Unknown index=\"4\" dependencies=\"2\"/></Outputs><InitialUnknowns><Unknown index=\"3\" dependencies=\"\"/>\
         <Unknown index=\"4\" dependencies=\"\"/></InitialUnknowns></ModelStructure></fmiModelDescription>"
    )
}

fn ring(units: &Units, stop: i64, record: &str) -> Simulation {
    let mut text = format!("format = 1\nexperiment = {{ stop = \"{stop}/1000\" }}\n");
    for name in ["a", "b", "c"] {
        text.push_str(&format!("[[units]]\nname = \"{name}\"\nfmu = \"ring.fmu\"\ninterval = \"1/1000\"\n"));
    }
    for (from, to) in [("c", "a"), ("a", "b"), ("b", "c")] {
        for port in [1, 2] {
            text.push_str(&format!("[[connections]]\nfrom = \"{from}.y{port}\"\nto = \"{to}.u{port}\"\n"));
        }
    }
    text.push_str(&format!("[record]\nvariables = [{record}]\n"));
    let scenario = Scenario::parse(&text, "ring.toml").expect("a scenario");
    Simulation::new(&scenario, &units.unit_path()).expect("builds")
}

fn micros_per_step(steps: i64, work: impl FnOnce()) -> f64 {
    let began = Instant::now();
    work();
    began.elapsed().as_secs_f64() * 1e6 / steps as f64
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() {
    let units = Units::new();
    let library = common::compile("ring.c");
    let file = units.path().join("ring.so");
    std::fs::write(&file, &library).expect("writable");
    // SAFETY: the library is the one just compiled, its symbols have the types of its source.
    let loaded = unsafe { libloading::Library::new(&file) }.expect("loads");
    let symbol = |name: &str| {
        // SAFETY: as above; used only as an address.
        *unsafe { loaded.get::<Call>(name) }.expect("exported") as *const c_void
    };
    let (set, get, step) = (symbol("fmi2SetReal"), symbol("fmi2GetReal"), symbol("fmi2DoStep"));
    // SAFETY: as above.
    let c_loop = *unsafe { loaded.get::<Loop>("ring_loop") }.expect("exported");

    units.pack("ring.fmu", &ring_description(), &library);
    let opened = micros_per_step(1, || drop(ring(&units, 1, "")));
    let ten = r#""*", "a.u1""#;
    let (mut bare, mut csv, mut memory) =
        (ring(&units, STEPS, ""), ring(&units, STEPS, ten), ring(&units, STEPS, ten));
    let mut short = ring(&units, 1000, "");
    let out = units.path().join("ring.csv");
    let run = |simulation: &mut Simulation, recorder: &mut dyn Recorder| {
        simulation.run(recorder, &mut Quiet).expect("runs");
    };
    let mut results = MemoryRecorder::new();
    let mut times: [Vec<f64>; 5] = Default::default();
    for _ in 0..ROUNDS {
        // SAFETY: the functions and the loop are of the same library.
        times[0]
            .push(micros_per_step(STEPS, || assert!(unsafe { c_loop(set, get, step, 1e-3, STEPS) } > 0.0)));
        times[1].push(micros_per_step(STEPS, || run(&mut bare, &mut NoRecorder)));
        times[2].push(micros_per_step(STEPS, || {
            run(&mut csv, &mut CsvRecorder::create(&out).expect("writable"))
        }));
        times[3].push(micros_per_step(STEPS, || run(&mut memory, &mut results)));
        times[4].push(micros_per_step(1, || run(&mut short, &mut NoRecorder)));
    }
    let [c, bare, csv, memory, short] = times.map(median);
    println!("ring of three nearly free units, us a step, medians of {ROUNDS} rounds of {STEPS} steps");
    println!("  C loop                      {c:8.4}");
    println!("  master, nothing recorded    {bare:8.4}   {:.2} x the C loop", bare / c);
    println!("  master, 12 values to CSV    {csv:8.4}   + {:.3} us a row", csv - bare);
    println!("  master, 12 values to memory {memory:8.4}   + {:.3} us a row", memory - bare);
    println!("a run of 1000 steps, reused    {:8.4} ms", short / 1000.0);
    println!("first build of the scenario    {:8.4} ms", opened / 1000.0);
}
