//! Is what is left noise? And if not, what does it look like?

use crate::diagnosis::Unknown;
use crate::rigs::acrobot::candidates::{Attribute, Candidate, Side, place};
use crate::rigs::acrobot::gap::led;
use crate::rigs::acrobot::residual::picture::{ANGLES, AREAS, COLUMNS};
use crate::rigs::acrobot::residual::torque::{rms, torques};
use crate::rigs::acrobot::residual::{Block, Signal};
use crate::rigs::acrobot::selection::{Evaluation, STAMPS, Study, lacking, steadiness};
use crate::statistics::linear::bare;
use nalgebra::DVector;

/// How a rest differs from noise.
#[derive(Debug, Clone, PartialEq)]
pub struct Rest {
    /// For each signal: scatter over what is known of it (1 where nothing is), and correlation from row to row.
    pub signals: Vec<(f64, f64)>,
    /// For each signal: variance of block means over what independent rows would give, and the rows of a block.
    pub means: Vec<(f64, f64)>,
}

/// Judges the rest of a model, beside torques of a size that is accounted for (N·m).
pub fn rest(evaluation: &Evaluation, signals: &[Signal], accounted: f64) -> Rest {
    let mut sums = vec![(0.0, 0.0, 0.0); signals.len()];
    let mut means = vec![(0.0, 0.0, 0.0, 0.0); signals.len()];
    for block in &evaluation.blocks {
        for s in 0..signals.len() {
            let rows: Vec<f64> = whitened(block, s, accounted);
            for pair in rows.windows(2) {
                sums[s].0 += pair[0] * pair[1];
                sums[s].1 += 0.5 * (pair[0] * pair[0] + pair[1] * pair[1]);
            }
            if rows.len() > 3 {
                let mean = rows.iter().sum::<f64>() / rows.len() as f64;
                means[s].0 += mean * mean * rows.len() as f64;
                means[s].1 += rows.iter().map(|x| x * x).sum::<f64>() / rows.len() as f64;
                means[s].2 += rows.len() as f64;
                means[s].3 += 1.0;
            }
            sums[s].2 += rows.len() as f64;
        }
    }
    let per_signal = signals
        .iter()
        .enumerate()
        .map(|(s, signal)| {
            let ratio = signal.known.map_or(1.0, |known| evaluation.seen[s] / known);
            (ratio, if sums[s].1 > 0.0 { sums[s].0 / sums[s].1 } else { 0.0 })
        })
        .collect();
    let means = means
        .iter()
        .map(|(a, b, rows, blocks)| if *b > 0.0 { (a / b, rows / blocks) } else { (1.0, 0.0) })
        .collect();
    Rest { signals: per_signal, means }
}

fn whitened(block: &Block, signal: usize, accounted: f64) -> Vec<f64> {
    let mut rows = Vec::new();
    for cell in &block.cells {
        let rest = bare(cell, &cell.residual, accounted).rest;
        rows.extend((0..cell.residual.len()).filter(|row| cell.signal[*row] == signal).map(|row| rest[row]));
    }
    rows
}

/// Lacking torque over what noise alone gives.
const TORQUE_RATIO: f64 = 1.4;
/// Scatter and correlation of a rest too quick for the torques, in angles and rates: a logged torque may be that before or after
/// a command, which scatters without a rest.
const MOTION: usize = 4;
const SCATTER: f64 = 1.15;
const CORRELATED: f64 = 0.25;
/// Variance of block means over what independent rows would give: 0.7 to 1.6 in sets without a rest, where a block has
/// so many rows. At a measured motion the means of more rows show more of the motion's own error, which rows share.
const MEANS: f64 = 2.5;
const ROWS: f64 = 6.0;

/// The rest in words, if it is more than noise.
pub fn unknown(study: &Study, signals: &[Signal], candidates: &[Candidate], torque: bool) -> Option<Unknown> {
    let stamps = STAMPS * study.explained;
    // what scattering stamps of the torque do goes on from row to row, too
    let accounted = if study.last.softness <= stamps { study.last.softness } else { 0.0 };
    let rest = rest(&study.last, signals, accounted);
    let nearest = nearest(study, candidates);
    if torque {
        let quick =
            rest.signals.iter().take(MOTION).position(|(ratio, rho)| *ratio > SCATTER && *rho > CORRELATED);
        let (size, floor) = rms(&torques(&study.last.blocks, &[], &[], &study.folds.of));
        let evident = lacking(&study.last, &study.folds, study.explained, false);
        if !evident && quick.is_none() && size < TORQUE_RATIO * floor.hypot(stamps) {
            return None;
        }
        let (signal, depends_on, shape) = torque_shape(study, &study.last);
        return Some(Unknown { signal, depends_on, shape, nearest, ..Unknown::default() });
    }
    if led(signals) && lacking(&study.last, &study.folds, study.explained, true) {
        let (signal, depends_on, shape) = torque_shape(study, &study.last);
        return Some(Unknown { signal, depends_on, shape, nearest, ..Unknown::default() });
    }
    let measured = study
        .last
        .blocks
        .iter()
        .flat_map(|block| &block.cells)
        .any(|cell| cell.signal.first().is_some_and(|s| *s < COLUMNS.len()) && cell.soft.ncols() > 0);
    // a circle that stays at one place on the lattice shows there what honest renderers differ by, row after row
    let honest = |s: usize, rows: f64| rows * (signals[s].honest / study.last.sigmas[s]).powi(2);
    let most = |rows: f64| if measured { 1.0 + (MEANS - 1.0) * (rows / ROWS).max(1.0) } else { MEANS };
    let over = |s: usize, (mean, rows): (f64, f64)| mean / (most(rows) + honest(s, rows));
    let worst = |rest: &Rest| {
        let all = rest.means.iter().enumerate().take(COLUMNS.len()).filter(|(s, _)| !AREAS.contains(s));
        let all = all.map(|(s, mean)| (s, over(s, *mean)));
        all.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, size)| *size >= 1.0)
    };
    let (worst, _) = worst(&rest).filter(|_| {
        let beside = beside_dropped(study, candidates);
        beside.is_none_or(|beside| worst(&self::rest(&beside, signals, accounted)).is_some())
    })?;
    let (depends_on, shape) = image_shape(&study.last, worst);
    Some(Unknown { signal: signals[worst].name.clone(), depends_on, shape, nearest, ..Unknown::default() })
}

/// The model with the likeliest effect of the picture that was dropped: honest renderers may differ by as much, so that it is
/// neither named nor a rest.
fn beside_dropped(study: &Study, candidates: &[Candidate]) -> Option<Evaluation> {
    let dropped = |index: usize| study.steps.iter().any(|step| step.dropped.contains(&index));
    let pictured = |index: usize| candidates[index].side == Side::Camera && !study.active.contains(&index);
    let hit = study.screen.hits.iter().find(|hit| pictured(hit.candidate) && dropped(hit.candidate))?;
    let mut beside = study.last.clone();
    for cell in beside.blocks.iter_mut().flat_map(|block| &mut block.cells) {
        let column = cell.columns.column(hit.column);
        cell.residual.iter_mut().zip(&column).for_each(|(rest, slope)| *rest -= hit.displacement * slope);
    }
    Some(beside)
}

/// Standard errors from which a clock drifts.
const DRIFTING: f64 = 4.5;

/// Clocks that drift apart: by how much the log's, or the picture's delay, moves along the runs.
pub fn drifting(study: &Study, candidates: &[Candidate]) -> Option<Unknown> {
    let clock = candidates.iter().position(|candidate| candidate.side == Side::Clock);
    let delay = place(candidates, Attribute::ImageDelay);
    let stamps = [(clock, "timestamps of the plant's log"), (delay, "timestamps of the image")];
    stamps.into_iter().find_map(|(index, signal)| {
        let index = index?;
        let (rate, clear) = steadiness(&study.last, index, &study.active)?.drift;
        let told = || Unknown {
            signal: signal.to_owned(),
            depends_on: vec!["time".into()],
            shape: format!("clocks that drift apart, by some {:.0} ms in a minute", 6e4 * rate),
            nearest: nearest(study, candidates),
            ..Unknown::default()
        };
        (clear.abs() > DRIFTING).then(told)
    })
}

fn nearest(study: &Study, candidates: &[Candidate]) -> String {
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

/// Simple variables on which a rest may depend.
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

pub(crate) fn torque_shape(study: &Study, at: &Evaluation) -> (String, Vec<String>, String) {
    let lacking = torques(&at.blocks, &[], &[], &study.folds.of);
    let mut best: Option<(f64, usize, &'static [&'static str], &'static str)> = None;
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
            if let Some((variables, shape)) = name
                && best.is_none_or(|(known, ..)| share > known)
            {
                best = Some((share, link, variables, shape));
            }
        }
    }
    // a few windows that hold most of it are an event, not a law
    let mut sizes: Vec<(f64, usize)> =
        lacking.iter().map(|t| (t.torque.iter().map(|x| x * x).sum::<f64>(), t.block)).collect();
    sizes.sort_by(|a, b| b.0.total_cmp(&a.0));
    let few = sizes.len().div_ceil(20);
    let held: f64 = sizes[..few].iter().map(|(size, _)| size).sum::<f64>()
        / sizes.iter().map(|(s, _)| s).sum::<f64>().max(1e-300);
    let link = if squares[0] > squares[1] { 0 } else { 1 };
    let signal =
        |link: usize| format!("plant torque {}", if link == 0 { "on link 1" } else { "at the joint" });
    match best {
        _ if held > 0.8 => {
            let block = &at.blocks[sizes[0].1];
            let shape = format!(
                "an event, {:.0} % of it in few windows around {:.1} s: a push from outside",
                100.0 * held,
                block.from
            );
            (signal(link), vec!["time".into()], shape)
        }
        Some((share, link, variables, shape)) if share > 0.15 => (
            signal(link),
            variables.iter().map(|name| (*name).to_owned()).collect(),
            format!("{shape} ({:.0} % of it)", 100.0 * share),
        ),
        _ => (signal(link), Vec::new(), "no simple law of angles, rates or time".into()),
    }
}

pub(crate) fn image_shape(at: &Evaluation, signal: usize) -> (Vec<String>, String) {
    type Law = (&'static [&'static str], &'static str);
    const LAWS: [Law; 7] = [
        (&[], "constant: this circle sits elsewhere than the model has it"),
        (&["u"], "linear in u"),
        (&["v"], "linear in v"),
        (&["u", "v"], "with the square of the distance from the centre"),
        (&["dq2"], "with the motion: a matter of time, the same all along"),
        (&["dq2", "v"], "with motion times height in the picture: rows exposed one after the other"),
        (&["dq2", "time"], "with motion times time: clocks that drift apart"),
    ];
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
        let rest = DVector::from_iterator(rows.len(), rows.iter().map(|(y, _)| *y));
        let xx = design.dot(&design);
        if xx > 0.0 && total > 0.0 { design.dot(&rest).powi(2) / xx / total } else { 0.0 }
    };
    let best = (0..LAWS.len()).map(|law| (share(law), law)).max_by(|a, b| a.0.total_cmp(&b.0));
    match best {
        Some((share, law)) if share > 0.1 => (
            LAWS[law].0.iter().map(|name| (*name).to_owned()).collect(),
            format!("{} ({:.0} % of it)", LAWS[law].1, 100.0 * share),
        ),
        _ => (Vec::new(), "no simple law of place, motion or time".into()),
    }
}
