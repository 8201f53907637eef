//! Frames as tests of doubts need them: half a minute of an arm that swings before a still camera, whose noise is 0.025 px, and 1 px for areas.

use crate::rigs::acrobot::candidates::{Attribute, Candidate, Motion, Side};
use crate::rigs::acrobot::channels::Measures;
use crate::rigs::acrobot::residual::studio::{AREAS, COLUMNS, circle_of};
use crate::rigs::acrobot::residual::{Block, Perturbation, Signal};
use crate::rigs::acrobot::selection::Evaluation;
use crate::statistics::linear::{Cell, Drawn};
use crate::statistics::random::Random;
use nalgebra::DMatrix;

/// A frame: its number, its time, and the state of the arm.
pub(super) struct Moment {
    pub(super) frame: usize,
    pub(super) time: f64,
    pub(super) state: [f64; 4],
}

/// Noise of a signal.
pub(super) fn noise(signal: usize) -> f64 {
    if AREAS.contains(&signal) { 1.0 } else { 0.025 }
}

/// A mount that shifts along u, and a delay.
pub(super) fn candidates() -> [Candidate; 2] {
    let own = |name, phrase, attributes| Candidate {
        name,
        side: Side::Camera,
        phrase,
        motion: Motion::Real { steps: &[0.01], range: (-1e3, 1e3) },
        off: 0.0,
        steps: vec![0.01],
        range: (-1e3, 1e3),
        nonlinear: false,
        attributes,
    };
    [own("shift", "moved along u", &[]), own("delay", "late", &[Attribute::ImageDelay])]
}

/// What a pixel of a signal moves by with q2: more for the tip than for the joint, and nothing for the drum.
fn turned(signal: usize, [_, q2, ..]: [f64; 4]) -> f64 {
    let arm = [0.0, 0.0, 10.0, 10.0, 160.0, 160.0];
    let along = if signal.is_multiple_of(2) { libm::cos(q2) } else { -libm::sin(q2) };
    arm.get(signal).map_or(0.0, |arm| arm * along)
}

/// Where a signal's circle is from the image centre, px: the drum's rolls, the joint and the tip hang on.
pub(super) fn place(signal: usize, [q1, q2, ..]: [f64; 4]) -> [f64; 2] {
    let circle = circle_of(signal);
    let joint = if circle > 0 { 160.0 } else { 0.0 };
    let tip = if circle > 1 { 160.0 } else { 0.0 };
    [
        10.0 * q1 + joint * libm::sin(q1) + tip * libm::sin(q2),
        joint * libm::cos(q1) + tip * libm::cos(q2) - 180.0,
    ]
}

/// How fast a signal of a circle's place changes, px a second.
pub(super) fn rate(signal: usize, state: [f64; 4]) -> f64 {
    let [q1, q2, dq1, dq2] = state;
    let after = [q1 + 1e-6 * dq1, q2 + 1e-6 * dq2, dq1, dq2];
    (place(signal, after)[signal % 2] - place(signal, state)[signal % 2]) / 1e-6
}

/// 900 frames in which a model leaves so much of each signal, beside noise.
pub(super) fn frames(left: impl Fn(&Moment, usize) -> f64) -> Evaluation {
    let (mut random, mut blocks) = (Random::new(5), Vec::<Block>::new());
    for frame in 0..900 {
        let time = frame as f64 / 30.0;
        let (q1, dq1) = (0.2 * libm::sin(2.0 * time), 0.4 * libm::cos(2.0 * time));
        let (q2, dq2) = (0.3 * libm::sin(3.1 * time), 0.93 * libm::cos(3.1 * time));
        let moment = Moment { frame, time, state: [q1, q2, dq1, dq2] };
        let rows = 0..AREAS.end;
        let shift = |signal: usize| if signal < AREAS.start && signal.is_multiple_of(2) { 1.0 } else { 0.0 };
        let cell = Cell {
            residual: rows.clone().map(|s| left(&moment, s) + noise(s) * random.normal()).collect(),
            sigma: rows.clone().map(noise).collect(),
            signal: rows.clone().collect(),
            time: vec![time; AREAS.end],
            hard: DMatrix::zeros(AREAS.end, 0),
            soft: DMatrix::from_fn(AREAS.end, 2, |s, link| {
                if link == 1 { 1e-4 * turned(s, moment.state) } else { 0.0 }
            }),
            discrepancy: 2,
            inertia_scale: 1.0,
            columns: DMatrix::from_fn(AREAS.end, 2, |s, own| {
                if own == 0 { shift(s) } else { -dq2 * turned(s, moment.state) }
            }),
            floor: Vec::new(),
            state: moment.state.to_vec(),
            lattice: Vec::new(),
            drawn: rows
                .clone()
                .map(|s| Drawn { place: place(s, moment.state), rate: rate(s, moment.state) })
                .collect(),
        };
        match blocks.last_mut() {
            Some(block) if time - block.from < 1.0 => {
                block.to = time;
                block.cells.push(cell);
            }
            _ => blocks.push(Block { run: 0, from: time, to: time, cells: vec![cell], state: moment.state }),
        }
    }
    let perturbations = [0, 1].map(|candidate| Perturbation { candidate, by: 0.01 });
    Evaluation::of(blocks, &[0.0; 2], &perturbations, &signals())
}

/// The signals of an image.
pub(super) fn signals() -> Vec<Signal> {
    let signal = |(place, name): (usize, &&str)| Signal {
        name: format!("camera.{name}"),
        unit: "px",
        measures: Measures::Centroid,
        known: None,
        sigma: noise(place),
        least: 0.0,
        tolerance: 0.0,
    };
    COLUMNS.iter().enumerate().map(signal).collect()
}

/// What a delay moves a signal by, a second.
pub(super) fn moved(moment: &Moment, signal: usize) -> f64 {
    moment.state[3] * turned(signal, moment.state)
}

/// What an encoder of q2 that reads so much too far moves it by, rad.
pub(super) fn read(moment: &Moment, signal: usize, by: f64) -> f64 {
    -by * turned(signal, moment.state)
}
