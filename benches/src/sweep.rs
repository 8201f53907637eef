//! Many short runs with reused instances: two threads against one, and what a run costs beyond its steps.

use crate::closed_loop::{scenario, units};
use crate::samples::{seconds, short};
use crate::{Row, Samples};
use orchestrator::{NoRecorder, Quiet, Simulation};
use std::hint::black_box;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Barrier, Mutex};
use std::time::Instant;

const RUNS: usize = 1000;
const ROUNDS: usize = 7;

fn built() -> Simulation {
    // A tenth of a second: 60 points, 4 frames, with another initial state in each run.
    Simulation::new(&scenario("1/10", &[]), &units()).expect("cargo xtask pack has made the units")
}

fn one(simulation: &mut Simulation, run: usize) {
    simulation.set("plant.q2_0", 0.1 + 1e-5 * run as f64).expect("a start value");
    simulation.run(&mut NoRecorder, &mut Quiet).expect("runs");
}

/// Seconds that this thread has spent on a processor.
fn processor_time() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    text.split(' ').next().and_then(|ns| ns.parse::<f64>().ok()).map_or(f64::NAN, |ns| ns * 1e-9)
}

/// Seconds from the first piece of work to the last, what it needs made before, and those spent on processors.
fn shared<W: FnMut(usize)>(threads: usize, make: impl Fn() -> W + Sync) -> (f64, f64) {
    let (next, ready) = (AtomicUsize::new(0), Barrier::new(threads + 1));
    let ended = Mutex::new(Vec::new());
    let mut began = Instant::now();
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                let mut work = make();
                work(0);
                ready.wait();
                let spent = processor_time();
                loop {
                    let run = next.fetch_add(1, Ordering::Relaxed);
                    if run >= RUNS {
                        break;
                    }
                    work(run);
                }
                let spent = processor_time() - spent;
                ended.lock().expect("no thread panicked").push((Instant::now(), spent));
            });
        }
        ready.wait();
        began = Instant::now();
    });
    let ended = ended.into_inner().expect("no thread panicked");
    let last = ended.iter().map(|(end, _)| *end).max().expect("threads");
    ((last - began).as_secs_f64(), ended.iter().map(|(_, spent)| spent).sum())
}

fn sweep(threads: usize) -> (f64, f64) {
    shared(threads, || {
        let mut simulation = built();
        move |run| one(&mut simulation, run)
    })
}

/// What the machine gives while it is measured: as many pieces of arithmetic, each about as long as a run, that share
/// nothing and touch no memory.
fn arithmetic(threads: usize) -> (f64, f64) {
    shared(threads, || {
        |run| {
            let step = |x: f64, _| x * 1.000_000_1 + 1e-9;
            black_box((0..black_box(18_000)).fold(run as f64, step));
        }
    })
}

/// Two threads against one, and short runs against one long one.
pub fn rows() -> Vec<Row> {
    let [mut single, mut double, mut speedup, mut alike, mut brief_steps, mut long]: [Samples; 6] =
        Default::default();
    let [mut lone, mut pair, mut given]: [Samples; 3] = Default::default();
    let mut brief = built();
    let mut lasting = Simulation::new(&scenario("10", &[]), &units()).expect("builds");
    for _ in 0..ROUNDS {
        let ((one_thread, one_spent), (two_threads, two_spent)) = (sweep(1), sweep(2));
        alike.0.push(2.0 * one_spent / two_spent);
        single.0.push(one_thread);
        double.0.push(two_threads);
        speedup.0.push(one_thread / two_threads);
        let ((one_thread, _), (two_threads, _)) = (arithmetic(1), arithmetic(2));
        lone.0.push(one_thread);
        pair.0.push(two_threads);
        given.0.push(one_thread / two_threads);
        brief_steps.0.push(1e6 / 6000.0 * seconds(|| (0..100).for_each(|run| one(&mut brief, run))));
        long.0.push(1e6 / 6000.0 * seconds(|| one(&mut lasting, 0)));
    }
    vec![
        Row::faster("sweep", "1000 runs of 0.1 s, two threads".into(), "s", &double)
            .than("one thread", &single)
            .at_least(1.9)
            .note(format!("round by round {}; needs two idle processors: see the arithmetic", speedup.text())),
        Row::faster("sweep", "1000 pieces of arithmetic, two threads".into(), "s", &pair)
            .than("one thread", &lone)
            .note(format!(
                "round by round {}; they share nothing and touch no memory: what the machine gave in the same rounds",
                given.text()
            )),
        Row::faster("sweep", "the 1000 runs by processor time, x".into(), "", &Samples(vec![alike.median()])).note(format!(
            "inferred, not measured: median of 2 x time of one thread by that of both ({}–{}); 2 if they don't hinder each other",
            short(alike.at(0.1)),
            short(alike.at(0.9))
        )),
        Row::faster("sweep", "communication point within 100 runs of 0.1 s".into(), "µs", &brief_steps)
            .than("within one run of 10 s", &long)
            .note("the short runs also pay for 100 first frames".into()),
    ]
}
