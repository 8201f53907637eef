//! The master on units that do work, beside a C loop over the same functions: a ring of three oscillators
//! (`oscillator.c`), and our own plant, camera and controller in the closed loop of Figure 19 (`closed.c`). Both sides
//! must end at the same bits, so that they are known to do the same.

#![allow(unsafe_code)] // the plain C loop beside the master

use crate::closed_loop::{scenario, unit, units};
use crate::ring::{Calls, Ring, STEPPING, compile};
use crate::samples::seconds;
use crate::{Row, Samples};
use orchestrator::scenario::Placed;
use orchestrator::{Fmu, MemoryRecorder, NoRecorder, Place, Quiet, Simulation};
use std::ffi::{CString, c_char, c_int, c_uint};
use tempfile::TempDir;

const ROUNDS: usize = 200;
const STEPS: i64 = 2_000;
/// Points a second of the closed loop, and simulated seconds.
const RATE: f64 = 600.0;
const SECONDS: usize = 3;
const POINTS: usize = 600 * SECONDS;

/// All comparisons.
pub fn rows() -> Vec<Row> {
    let mut rows = vec![oscillators()];
    rows.extend(crate::feedthrough::rows());
    rows.push(closed());
    rows
}

type RingLoop = unsafe extern "C" fn(*const Calls<7>, f64, i64) -> f64;

fn oscillators() -> Row {
    let ring = Ring::of_oscillators();
    // SAFETY: loading runs the initialisers of a library that has none.
    let library = unsafe { libloading::Library::new(ring.library()) }.expect("loads");
    let calls = Calls::of(&library, STEPPING);
    // SAFETY: the type is that of the source.
    let run = *unsafe { library.get::<RingLoop>("ring_loop") }.expect("exported");
    let mut simulation = ring.simulation(STEPS, r#""c.y1""#);
    let [mut c, mut ours]: [Samples; 2] = Default::default();
    let micros = 1e6 / STEPS as f64;
    for _ in 0..ROUNDS {
        let mut last = 0.0;
        // SAFETY: functions and loop are of the same library.
        c.0.push(micros * seconds(|| last = unsafe { run(&calls, 1e-3, STEPS) }));
        ours.0.push(
            micros
                * seconds(|| {
                    simulation.run(&mut NoRecorder, &mut Quiet).expect("runs");
                }),
        );
        let found = simulation.value("c.y1").expect("recorded");
        assert_eq!(found.to_bits(), last.to_bits(), "our master gives {found}, the C loop {last}");
    }
    Row::faster("master", "step of a ring of three oscillators, 12 connections".into(), "µs", &ours)
        .than("C loop", &c)
        .at_most_times(1.15)
        .note("reals, an integer and a Boolean each; same bits at the end".into())
}

/// As in `closed.c`.
#[repr(C)]
struct References {
    plant_start: [c_uint; 2],
    plant_out: [c_uint; 4],
    plant_in: c_uint,
    camera_in: [c_uint; 4],
    camera_out: [c_uint; 4],
    camera_frame: c_uint,
    controller_in: [c_uint; 5],
    controller_frame: c_uint,
    controller_out: c_uint,
}
type Open = unsafe extern "C" fn(c_int, *const c_char, *const c_char, *const c_char) -> c_int;
type Run = unsafe extern "C" fn(*const References, *const f64, f64, i64, *const f64, *mut f64) -> c_int;

/// Our units in a C loop.
struct Closed {
    library: libloading::Library,
    references: References,
    _folder: TempDir,
}

impl Closed {
    fn open() -> Self {
        let folder = TempDir::new().expect("a temporary folder");
        // SAFETY: loading runs the initialisers of a library that has none.
        let library = unsafe { libloading::Library::new(compile("closed.c", folder.path())) }.expect("loads");
        // SAFETY: the type is that of the source.
        let open = *unsafe { library.get::<Open>("closed_open") }.expect("exported");
        let fmus = ["plant", "camera", "controller"].map(|name| Fmu::open(unit(name)).expect("opens"));
        for (number, fmu) in (0..).zip(&fmus) {
            let inside = folder.path().join(number.to_string());
            let file = std::fs::File::open(fmu.path()).expect("readable");
            zip::ZipArchive::new(file).expect("an archive").extract(&inside).expect("extracted");
            let name = &fmu.description().co_simulation.model_identifier;
            let text = |text: String| CString::new(text).expect("no zero in it");
            let path = text(format!("{}/binaries/linux64/{name}.so", inside.display()));
            let guid = text(fmu.description().guid.clone());
            let resources = text(format!("file://{}/resources", inside.display()));
            // SAFETY: all texts end in zero and live over the call.
            let opened = unsafe { open(number, path.as_ptr(), guid.as_ptr(), resources.as_ptr()) };
            assert!(opened != 0, "{} opens", fmu.path().display());
        }
        let of = |unit: usize, name: &str| {
            let variable = fmus[unit].description().variable(name);
            variable.unwrap_or_else(|| panic!("{name} is a variable")).reference
        };
        let references = References {
            plant_start: ["q1_0", "q2_0"].map(|name| of(0, name)),
            plant_out: ["q1", "q2", "dq1", "dq2"].map(|name| of(0, name)),
            plant_in: of(0, "tau"),
            camera_in: ["q1", "q2", "dq1", "dq2"].map(|name| of(1, name)),
            camera_out: ["q1_est", "q2_est", "dq1_est", "dq2_est"].map(|name| of(1, name)),
            camera_frame: of(1, "frame"),
            controller_in: ["q1", "q2", "dq1", "dq2", "z_desired"].map(|name| of(2, name)),
            controller_frame: of(2, "frame"),
            controller_out: of(2, "tau"),
        };
        Self { library, references, _folder: folder }
    }

    fn run(&self, z_desired: &[f64]) -> [f64; 5] {
        let (start, mut last) = ([-0.05, 0.1], [0.0; 5]); // (14), as the scenario says
        assert!(z_desired.len() > POINTS, "z desired at the start and at each point");
        // SAFETY: the types are those of the source, and the slices are as long as it reads.
        let status = unsafe {
            let run = *self.library.get::<Run>("closed_run").expect("exported");
            run(&self.references, start.as_ptr(), RATE, POINTS as i64, z_desired.as_ptr(), last.as_mut_ptr())
        };
        assert_eq!(status, 0, "the C loop runs");
        last
    }
}

fn closed() -> Row {
    const ENDS: [&str; 5] = ["plant.q1", "plant.q2", "plant.dq1", "plant.dq2", "controller.tau"];
    let stop = SECONDS.to_string();
    let mut full = Simulation::new(&scenario(&stop, &[]), &units()).expect("packed units");
    let mut recorded = MemoryRecorder::new();
    full.run(&mut recorded, &mut Quiet).expect("runs");
    let z_desired = recorded.series("controller.z_desired").expect("recorded").to_vec();
    // As the C loop: nothing is read but what is passed on.
    let mut bare = scenario(&stop, &[]);
    let placed = |name: &str| Placed { value: name.to_owned(), place: Place::Override(name.to_owned()) };
    bare.record = Some(ENDS.map(placed).to_vec());
    let mut simulation = Simulation::new(&bare, &units()).expect("packed units");
    let closed = Closed::open();
    let [mut c, mut ours]: [Samples; 2] = Default::default();
    let micros = 1e6 / POINTS as f64;
    for _ in 0..ROUNDS {
        let mut last = [0.0; 5];
        c.0.push(micros * seconds(|| last = closed.run(&z_desired)));
        ours.0.push(
            micros
                * seconds(|| {
                    simulation.run(&mut NoRecorder, &mut Quiet).expect("runs");
                }),
        );
        for (name, expected) in ENDS.iter().zip(last) {
            let found = simulation.value(name).expect("recorded");
            assert_eq!(found.to_bits(), expected.to_bits(), "{name}: ours {found}, the C loop's {expected}");
        }
    }
    Row::faster("master", "point of the closed loop of Figure 19, our three units".into(), "µs", &ours)
        .than("C loop", &c)
        .at_most_times(1.15)
        .note("a frame at each twentieth point; same bits at the end".into())
}
