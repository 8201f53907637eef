//! What a residual looks like: the simple law of state, place or time that takes most of it away.

use crate::rigs::acrobot::candidates::Candidate;
use crate::rigs::acrobot::residual::Signal;
use crate::rigs::acrobot::residual::picture::{ANGLES, AREAS};
use crate::rigs::acrobot::residual::torque::torques;
use crate::rigs::acrobot::selection::{Evaluation, Study};
use nalgebra::DVector;

/// What of the list comes nearest to it.
pub(super) fn nearest(study: &Study, candidates: &[Candidate]) -> String {
    let total = study.last.total.square.max(1.0);
    match study.screen.hits.iter().find(|hit| !study.active.contains(&hit.candidate)) {
        Some(hit) => format!(
            "{} ({}) comes nearest, but takes away only {:.1} % of what is left",
            candidates[hit.candidate].name,
            candidates[hit.candidate].phrase,
            100.0 * hit.gain / total
        ),
        None => "no listed effect resembles it".into(),
    }
}

/// Simple variables on which a residual may depend.
fn regressors(state: &[f64; 4], time: f64) -> Vec<(&'static [&'static str], &'static str, f64)> {
    let [q1, q2, dq1, dq2] = *state;
    let (bend, slip) = (q2 - q1, dq2 - dq1);
    let sign = |x: f64| libm::tanh(x / 0.05);
    vec![
        (&[], "constant", 1.0),
        (&["time"], "drifting with time", time),
        (&["q1"], "odd in q1, like a spring", q1),
        (&["q2"], "odd in q2, like a spring", q2),
        (&["q1", "q2"], "odd in the joint angle q2 - q1, like a spring", bend),
        (&["q1", "q2"], "cubic in the joint angle q2 - q1, like a stiffening spring", bend * bend * bend),
        (&["q2"], "even in q2", q2 * q2),
        (&["dq1"], "odd in dq1, growing with speed", dq1),
        (&["dq1", "dq2"], "odd in the joint's rate dq2 - dq1, growing with speed", slip),
        (&["dq1"], "odd in dq1, of constant size: sticking", sign(dq1)),
        (
            &["dq1", "dq2"],
            "odd in the joint's rate dq2 - dq1, of constant size: sticking or play",
            sign(slip),
        ),
        (&["dq1"], "odd in dq1, with the square of speed: drag", dq1 * dq1.abs()),
        (&["dq1", "dq2"], "odd in the joint's rate, with the square of speed: drag", slip * slip.abs()),
        (
            &["dq1", "dq2"],
            "strongest at small rates of the joint: Stribeck or sticking",
            sign(slip) / (1.0 + slip * slip / 0.04),
        ),
    ]
}

/// Names of what a law depends on, and its form.
type Form = (&'static [&'static str], &'static str);

/// What torques that lack look like.
struct Torques {
    /// The simple law that takes most of one link's squares away, with the share of them, and the link.
    best: Option<(f64, usize, Form)>,
    /// Of each link.
    squares: [f64; 2],
    /// Where few windows hold most of it, which is an event and no law: the share that they hold, and the block of the largest.
    event: Option<(f64, usize)>,
}

fn law_of_torques(study: &Study, at: &Evaluation) -> Torques {
    let lacking = torques(&at.blocks, &[], &[], &study.folds.of);
    let mut best: Option<(f64, usize, Form)> = None;
    let mut squares = [0.0; 2];
    for (link, square) in squares.iter_mut().enumerate() {
        let values: Vec<(f64, [f64; 4], f64)> = lacking
            .iter()
            .filter(|t| t.floor[link].is_finite())
            .map(|t| {
                let block = &at.blocks[t.block];
                (t.torque[link], block.state, 0.5 * (block.from + block.to))
            })
            .collect();
        let total: f64 = values.iter().map(|(x, ..)| x * x).sum();
        *square = total;
        let Some(count) = values.first().map(|(_, state, time)| regressors(state, *time).len()) else {
            continue;
        };
        for place in 0..count {
            let (mut xy, mut xx) = (0.0, 0.0);
            let mut name = None;
            for (y, state, time) in &values {
                let all = regressors(state, *time);
                let (variables, shape, x) = all[place];
                xy += x * y;
                xx += x * x;
                name = Some((variables, shape));
            }
            let share = if xx > 0.0 && total > 0.0 { xy * xy / xx / total } else { 0.0 };
            if let Some(form) = name.filter(|_| best.is_none_or(|(known, ..)| share > known)) {
                best = Some((share, link, form));
            }
        }
    }
    let mut sizes: Vec<(f64, usize)> =
        lacking.iter().map(|t| (t.torque.iter().map(|x| x * x).sum::<f64>(), t.block)).collect();
    sizes.sort_by(|a, b| b.0.total_cmp(&a.0));
    let few = sizes.len().div_ceil(20);
    let held: f64 = sizes[..few].iter().map(|(size, _)| size).sum::<f64>()
        / sizes.iter().map(|(s, _)| s).sum::<f64>().max(1e-300);
    let event = sizes.first().filter(|_| held > 0.8).map(|largest| (held, largest.1));
    Torques { best, squares, event }
}

pub fn torque_shape(study: &Study, at: &Evaluation) -> (String, Vec<String>, String) {
    let Torques { best, squares, event } = law_of_torques(study, at);
    let link = if squares[0] > squares[1] { 0 } else { 1 };
    let signal =
        |link: usize| format!("plant torque {}", if link == 0 { "on link 1" } else { "at the joint" });
    match (event, best) {
        (Some((held, largest)), _) => {
            let block = &at.blocks[largest];
            let shape = format!(
                "an event, {:.0} % of it in few windows around {:.1} s: a push from outside",
                100.0 * held,
                block.from
            );
            (signal(link), vec!["time".into()], shape)
        }
        (None, Some((share, link, (variables, shape)))) if share > 0.15 => (
            signal(link),
            variables.iter().map(|name| (*name).to_owned()).collect(),
            format!("{shape} ({:.0} % of it)", 100.0 * share),
        ),
        _ => (signal(link), Vec::new(), "no simple law of angles, rates or time".into()),
    }
}

/// Share of what a model leaves that one law takes away which is common to all runs: of the torques, or of the image's worst signal.
pub(super) fn common(study: &Study, at: &Evaluation, signals: &[Signal], torque: bool) -> f64 {
    if torque {
        let Torques { best, squares, event } = law_of_torques(study, at);
        let all = squares.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        let law = best.map_or(0.0, |(share, link, _)| share * squares[link] / all);
        return event.map_or(law, |(held, _)| held.max(law));
    }
    let worst = (0..signals.len().min(AREAS.start)).max_by(|a, b| square(at, *a).total_cmp(&square(at, *b)));
    worst.and_then(|worst| law_of_image(at, worst)).map_or(0.0, |(share, _)| share)
}

/// Simple laws of a residual of the image.
const LAWS: [Form; 7] = [
    (&[], "constant: this circle sits elsewhere than the model has it"),
    (&["u"], "linear in u"),
    (&["v"], "linear in v"),
    (&["u", "v"], "with the square of the distance from the centre"),
    (&["dq2"], "with the motion: a matter of time, the same all along"),
    (&["dq2", "v"], "with motion times height in the image: rows exposed one after the other"),
    (&["dq2", "time"], "with motion times time: clocks that drift apart"),
];

/// The law that takes most of a signal's residual away, and the share of it.
fn law_of_image(at: &Evaluation, signal: usize) -> Option<(f64, Form)> {
    let mut rows: Vec<(f64, [f64; 7])> = Vec::new();
    for block in &at.blocks {
        for cell in &block.cells {
            let Some(row) = cell.signal.iter().position(|s| *s == signal) else { continue };
            let [q1, q2, dq1, dq2] = block.state;
            let (u, v) =
                (libm::sin(q1) * 0.6 + libm::sin(q2) * 0.7, libm::cos(q1) * 0.6 + libm::cos(q2) * 0.7 - 0.7);
            let speed = match signal {
                _ if signal < 4 || signal == ANGLES.start => dq1,
                _ if signal == ANGLES.start + 1 => dq2,
                _ => dq1 + dq2,
            };
            let time = cell.time[row];
            rows.push((cell.residual[row], [1.0, u, v, u * u + v * v, speed, speed * v, speed * time]));
        }
    }
    let total: f64 = rows.iter().map(|(y, _)| y * y).sum();
    let share = |law: usize| {
        let design = DVector::from_iterator(rows.len(), rows.iter().map(|(_, x)| x[law]));
        let residual = DVector::from_iterator(rows.len(), rows.iter().map(|(y, _)| *y));
        let xx = design.dot(&design);
        if xx > 0.0 && total > 0.0 { design.dot(&residual).powi(2) / xx / total } else { 0.0 }
    };
    (0..LAWS.len()).map(|law| (share(law), LAWS[law])).max_by(|a, b| a.0.total_cmp(&b.0))
}

pub(super) fn image_shape(at: &Evaluation, signal: usize) -> (Vec<String>, String) {
    match law_of_image(at, signal) {
        Some((share, (variables, shape))) if share > 0.1 => (
            variables.iter().map(|name| (*name).to_owned()).collect(),
            format!("{shape} ({:.0} % of it)", 100.0 * share),
        ),
        _ => (Vec::new(), "no simple law of place, motion or time".into()),
    }
}

/// Where and how the nominal model misses the data.
pub(super) fn nominal_shape(
    study: &Study,
    signals: &[Signal],
    torque: bool,
) -> Option<(String, Vec<String>, String)> {
    let nominal = &study.nominal;
    if torque {
        return Some(torque_shape(study, nominal));
    }
    let worst =
        (0..signals.len().min(6)).max_by(|a, b| square(nominal, *a).total_cmp(&square(nominal, *b)))?;
    let (depends_on, shape) = image_shape(nominal, worst);
    Some((signals[worst].name.clone(), depends_on, shape))
}

/// Sum of squares of one signal, in its standard deviations.
fn square(at: &Evaluation, signal: usize) -> f64 {
    let cells = at.blocks.iter().flat_map(|block| &block.cells);
    let rows = cells.flat_map(|cell| cell.signal.iter().zip(cell.residual.iter().zip(&cell.sigma)));
    rows.filter(|(own, _)| **own == signal).map(|(_, (residual, sigma))| (residual / sigma).powi(2)).sum()
}
