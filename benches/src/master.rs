//! The master on a ring of three nearly free units with six connections: a C loop calling the same functions, ours,
//! FMPy, libcosim and Ecos, in turns; and what it costs to open a unit.

#![allow(unsafe_code)] // the plain C loop beside the master

use crate::ring::Ring;
use crate::samples::seconds;
use crate::{Peer, Row, Samples, closed_loop};
use orchestrator::{CsvRecorder, Fmu, NoRecorder, Quiet, Recorder, Simulation};
use std::ffi::{c_int, c_uint, c_void};

const STEPS: i64 = 10_000;
const PEER_STEPS: i64 = 2_000;
const ROUNDS: usize = 25;
/// Turns of C loop and our master within a round.
const TURNS: usize = 10;

type Loop = unsafe extern "C" fn(*const c_void, *const c_void, *const c_void, f64, i64) -> f64;
type Call = unsafe extern "C" fn(*mut c_void, *const c_uint, usize, *mut f64) -> c_int;

/// The C loop, ready to run.
struct Limit {
    library: libloading::Library,
}

impl Limit {
    fn run(&self, steps: i64) {
        let symbol = |name: &str| {
            // SAFETY: the library is the one just compiled from `ring.c`; used only as an address.
            *unsafe { self.library.get::<Call>(name) }.expect("exported") as *const c_void
        };
        let (set, get, step) = (symbol("fmi2SetReal"), symbol("fmi2GetReal"), symbol("fmi2DoStep"));
        // SAFETY: the types are those of the source; functions and loop are of the same library.
        let last = unsafe {
            let run = *self.library.get::<Loop>("ring_loop").expect("exported");
            run(set, get, step, 1e-3, steps)
        };
        assert!(last > 0.0);
    }
}

fn run(simulation: &mut Simulation, recorder: &mut dyn Recorder) {
    simulation.run(recorder, &mut Quiet).expect("runs");
}

/// What was measured. Of a step in µs, of a short run in ms.
#[derive(Default)]
struct Times {
    c: Samples,
    ours: Samples,
    rows: Samples,
    /// What the rows cost beyond the steps.
    extra: Samples,
    c_short: Samples,
    once: Samples,
    fmpy: Samples,
    fmpy_csv: Samples,
    fmpy_short: Samples,
    cosim: Samples,
    cosim_csv: Samples,
    serial: Samples,
    ecos: Samples,
    ecos_csv: Samples,
}

/// Takes all of them in turns.
fn measured() -> Times {
    let ring = Ring::new();
    // SAFETY: loading runs the initialisers of a library that has none.
    let limit = Limit { library: unsafe { libloading::Library::new(ring.library()) }.expect("loads") };
    let folder = closed_loop::folder();
    let mut peer = Peer::start("masters.py", &[&ring.fmu().display().to_string(), &folder]);
    let ten = r#""a.y1", "a.y2", "b.y1", "b.y2", "c.y1", "c.y2", "a.u1", "a.u2", "b.u1", "b.u2""#;
    let (mut bare, mut csv) = (ring.simulation(STEPS, ""), ring.simulation(STEPS, ten));
    assert_eq!(csv.columns().len(), 10, "ten values a row");
    let mut short = ring.simulation(1000, "");
    let out = ring.path().join("ring.csv");

    let mut times = Times::default();
    let micros = 1e6 / STEPS as f64;
    for _ in 0..ROUNDS {
        for _ in 0..TURNS {
            times.c.0.push(micros * seconds(|| limit.run(STEPS)));
            let plain = micros * seconds(|| run(&mut bare, &mut NoRecorder));
            let with = micros * seconds(|| run(&mut csv, &mut CsvRecorder::create(&out).expect("writable")));
            times.ours.0.push(plain);
            times.rows.0.push(with);
            times.extra.0.push(with - plain);
            times.c_short.0.push(1e3 * seconds(|| limit.run(1000)));
            times.once.0.push(1e3 * seconds(|| run(&mut short, &mut NoRecorder)));
        }
        for (name, times) in [
            ("fmpy", &mut times.fmpy),
            ("fmpy_csv", &mut times.fmpy_csv),
            ("libcosim", &mut times.cosim),
            ("libcosim_csv", &mut times.cosim_csv),
            ("serial", &mut times.serial),
            ("ecos", &mut times.ecos),
            ("ecos_csv", &mut times.ecos_csv),
        ] {
            peer.measure(&format!("{name} {PEER_STEPS}"), times);
        }
        peer.measure("fmpy_short 1000", &mut times.fmpy_short);
    }
    times.fmpy_short.0.iter_mut().for_each(|time| *time *= 1e-3);
    times
}

/// The ring: steps, rows and a short run.
pub fn rows() -> Vec<Row> {
    let times = measured();
    let step = || Row::faster("master", "step of the ring, nothing recorded".into(), "µs", &times.ours);
    let row = || Row::faster("master", "step of the ring, ten values to CSV".into(), "µs", &times.rows);
    let brief = || Row::faster("master", "run of 1000 steps, instances reused".into(), "ms", &times.once);
    let mut table = vec![
        step().than("C loop", &times.c).at_most_times(1.5),
        step().than("libcosim (libcosimpy)", &times.cosim).note("Jacobi, simulate_until".into()),
        step()
            .than("libcosim without its threads", &times.serial)
            .at_least(3.0)
            .note("Jacobi, its C++ class, cosim_execution_step".into()),
        step().than("Ecos (ecospy)", &times.ecos).at_least(3.0).note("Jacobi, its own loop".into()),
        step().than("FMPy", &times.fmpy),
        Row::faster("master", "a row of ten values to CSV, beyond the step".into(), "µs", &times.extra)
            .at_most(1.6)
            .note("shortest text that reads back as the same double".into()),
        row()
            .than("libcosim, file observer", &times.cosim_csv)
            .note("all twelve of its values, six digits".into()),
        row().than("Ecos, CSV writer", &times.ecos_csv).note("six decimals".into()),
        row().than("FMPy, csv.writer", &times.fmpy_csv),
        brief()
            .than("C loop", &times.c_short)
            .at_most(0.06)
            .note("the C loop that the project began with takes 0.055".into()),
        brief().than("FMPy", &times.fmpy_short),
    ];
    table.extend(crate::real::rows());
    table.extend(opening());
    table
}

/// Opening our units: unpacking and reading the description, then loading the library and an instance.
fn opening() -> Vec<Row> {
    let mut rows = Vec::new();
    for name in ["plant", "camera", "controller"] {
        let path = closed_loop::unit(name);
        let [mut all, mut unpack]: [Samples; 2] = Default::default();
        for _ in 0..40 {
            let mut opened = None;
            let first = 1e3 * seconds(|| opened = Some(Fmu::open(&path).expect("opens")));
            let opened = opened.expect("opened");
            let mut instance = None;
            let second = 1e3 * seconds(|| instance = Some(opened.instantiate("unit").expect("loads")));
            unpack.0.push(first);
            all.0.push(first + second);
        }
        rows.push(
            Row::faster("master", format!("opening acrobot_{name}"), "ms", &all)
                .at_most(15.0)
                .note(format!("of which unpacking and XML {}", unpack.text())),
        );
    }
    rows
}
