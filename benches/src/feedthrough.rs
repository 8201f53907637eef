//! The master on rings of three units that hand on what they get, beside a C loop over the same functions
//! (`feedthrough_loop.c`): our own unit (`feedthrough.c`), and the Feedthrough of the FMI project's reference units where
//! `ACROSCOPE_FEEDTHROUGH` names its file. Both sides must end at the same values, so that they are known to do the same.

#![allow(unsafe_code)] // the plain C loop beside the master

use crate::ring::{Calls, Ring, STEPPING, compile};
use crate::samples::seconds;
use crate::{Row, Samples};
use orchestrator::{Fmu, NoRecorder, Quiet, Value};
use std::ffi::{CStr, CString, c_char, c_int, c_uint};
use std::path::PathBuf;

const ROUNDS: usize = 200;
const STEPS: i64 = 2_000;
/// Places in memory: the cost of a copy of 128 bytes depends on where they lie, so both sides are measured in several.
const PLACES: usize = 8;

/// All comparisons.
pub fn rows() -> Vec<Row> {
    let ours = "a ring of three feedthroughs";
    let mut rows = vec![
        row(&Ring::of_feedthroughs(false), ours, ""),
        row(
            &Ring::of_feedthroughs(true),
            ours,
            "; a text each, of which both sides keep a copy of their own",
        ),
    ];
    if let Some(file) = std::env::var_os("ACROSCOPE_FEEDTHROUGH").map(PathBuf::from) {
        let theirs = "a ring of three reference units, Feedthrough";
        rows.push(row(&Ring::of_reference(&file, false), theirs, ""));
        rows.push(row(&Ring::of_reference(&file, true), theirs, "; a text each"));
    }
    rows
}

/// As in `feedthrough_loop.c`.
#[repr(C)]
struct References {
    reals: [[c_uint; 2]; 2],
    others: [c_uint; 6],
}
const CALLS: usize = 14;
type Loop = unsafe extern "C" fn(
    *const Calls<CALLS>,
    *const References,
    *const c_char,
    f64,
    i64,
    c_int,
    *mut c_char,
) -> f64;

/// A ring stepped by the C loop.
struct Limit {
    unit: libloading::Library,
    step: libloading::Library,
    references: References,
    guid: CString,
    texts: bool,
}

impl Limit {
    fn of(ring: &Ring) -> Self {
        // SAFETY: loading runs the initialisers of libraries that have none.
        let load = |path| unsafe { libloading::Library::new(path) }.expect("loads");
        let fmu = Fmu::open(ring.fmu()).expect("opens");
        let of = |name: &str| fmu.description().variable(name).expect("is a variable").reference;
        let port = |number: usize| ring.ports()[number];
        // Without texts on the way the loop still reads the first one.
        let text = ring.ports().get(4).copied().unwrap_or(match port(0).0 {
            "y1" => ("t_out", "t_in"),
            _ => ("String_output", "String_input"),
        });
        let others = [port(2), port(3), text];
        let [integer, boolean, text] = others.map(|(out, into)| [of(into), of(out)]);
        let [continuous, discrete] = [port(0), port(1)].map(|(out, into)| [of(into), of(out)]);
        Self {
            unit: load(ring.library().to_owned()),
            step: load(compile("feedthrough_loop.c", ring.path())),
            references: References {
                reals: [[continuous[0], discrete[0]], [continuous[1], discrete[1]]],
                others: [integer[0], integer[1], boolean[0], boolean[1], text[0], text[1]],
            },
            guid: CString::new(fmu.description().guid.clone()).expect("no zero in it"),
            texts: ring.ports().len() > 4,
        }
    }

    fn calls(&self) -> Calls<CALLS> {
        let others = [
            "SetString",
            "GetString",
            "Instantiate",
            "SetupExperiment",
            "EnterInitializationMode",
            "ExitInitializationMode",
            "FreeInstance",
        ];
        let mut names = [""; CALLS];
        names.iter_mut().zip(STEPPING.into_iter().chain(others)).for_each(|(to, name)| *to = name);
        Calls::of(&self.unit, names)
    }

    /// The first real and the text of the third unit at the end.
    fn run(&self, calls: &Calls<CALLS>, run: Loop) -> (f64, String) {
        let mut text = [0; 128];
        let (references, guid, texts) = (&self.references, self.guid.as_ptr(), c_int::from(self.texts));
        // SAFETY: the types are those of the source; the text is as long as it says and ends in zero.
        unsafe {
            let last = run(calls, references, guid, 1e3, STEPS, texts, text.as_mut_ptr());
            (last, CStr::from_ptr(text.as_ptr()).to_string_lossy().into_owned())
        }
    }
}

fn row(ring: &Ring, what: &str, note: &str) -> Row {
    let limit = Limit::of(ring);
    let calls = limit.calls();
    // SAFETY: the type is that of the source.
    let run = *unsafe { limit.step.get::<Loop>("ring_loop") }.expect("exported");
    let outputs: Vec<String> = ring.ports().iter().map(|(out, _)| format!("c.{out}")).collect();
    let record: Vec<String> = outputs.iter().step_by(4).map(|name| format!("{name:?}")).collect();
    let room = |place: usize| Vec::<u8>::with_capacity(1 + 208 * place);
    let mut simulations: Vec<_> =
        (0..PLACES).map(|place| (room(place), ring.simulation(STEPS, &record.join(", ")))).collect();
    let [mut c, mut ours]: [Samples; 2] = Default::default();
    let micros = 1e6 / STEPS as f64;
    for round in 0..ROUNDS {
        let _room = std::hint::black_box(room(round % PLACES));
        let simulation = &mut simulations[round % PLACES].1;
        let mut last = (0.0, String::new());
        c.0.push(micros * seconds(|| last = limit.run(&calls, run)));
        let ran = || drop(simulation.run(&mut NoRecorder, &mut Quiet).expect("runs"));
        ours.0.push(micros * seconds(ran));
        let found = simulation.value(&outputs[0]).expect("recorded");
        assert_eq!(found.to_bits(), last.0.to_bits(), "our master gives {found}, the C loop {}", last.0);
        if limit.texts {
            assert_eq!(simulation.get(&outputs[4]).expect("recorded"), Value::String(last.1));
        }
    }
    let connections = 3 * ring.ports().len();
    Row::faster("master", format!("step of {what}, {connections} connections"), "µs", &ours)
        .than("C loop", &c)
        .at_most_times(1.15)
        .note(format!("two reals, an integer and a Boolean each{note}; same bits at the end"))
}
