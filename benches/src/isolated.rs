//! What a unit in a process of its own costs: the rings with and without, in turns. The nearly free unit shows the exchange, the
//! oscillator what is left of it beside a small real unit.

use crate::Row;
use crate::Samples;
use crate::ring::Ring;
use crate::samples::seconds;
use orchestrator::{NoRecorder, Quiet, Simulation};

const STEPS: i64 = 2000;
const ROUNDS: usize = 60;
/// Units of a ring.
const UNITS: f64 = 3.0;

/// One row a ring.
pub fn rows() -> Vec<Row> {
    let row = |what: &str, ring: &Ring| {
        let (mut here, mut apart) = (ring.simulation(STEPS, ""), ring.isolated(STEPS));
        let [mut plain, mut isolated]: [Samples; 2] = Default::default();
        let time = |simulation: &mut Simulation| {
            1e6 / (UNITS * STEPS as f64)
                * seconds(|| {
                    simulation.run(&mut NoRecorder, &mut Quiet).expect("runs");
                })
        };
        for _ in 0..ROUNDS {
            plain.0.push(time(&mut here));
            isolated.0.push(time(&mut apart));
        }
        Row::faster(
            "isolated",
            format!("unit step of a ring of three {what}, each in its process"),
            "µs",
            &isolated,
        )
        .than("in this process", &plain)
        .at_most(10.0)
        .note("one exchange a step; all on one processor, or each on its own, whichever is faster".into())
    };
    vec![row("nearly free units", &Ring::new()), row("oscillators", &Ring::of_oscillators())]
}
