//! Windows of a log: where they begin and end, which rows count, and a guess of the state at their begin.

use super::fitting::Fit;
use super::log_correction::has_changing_torque;
use super::memory::Memory;
use crate::rigs::acrobot::bench::Setting;
use crate::rigs::acrobot::dataset::{DataSet, Run};
use crate::rigs::acrobot::model::Model;
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::residual::plant::policy::WINDOWS;
use crate::rigs::acrobot::residual::policy::RESIDUAL;
use crate::rigs::acrobot::residual::trajectory::{Drive, PREROLL, Push, State};
use crate::statistics::levels::HALF;
use crate::statistics::linear::solve;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;
use std::sync::Arc;

/// What a linearisation found of a window's nuisances.
#[derive(Debug, Clone)]
pub(super) struct Kept {
    pub(super) start: State,
    pub(super) slack: Vec<f64>,
    pub(super) hard: DMatrix<f64>,
    pub(super) soft: DMatrix<f64>,
    /// What the columns were taken with.
    pub(super) settings: Vec<Setting>,
    pub(super) drive: Drive,
}

impl Kept {
    /// Whether the columns are those of a fit.
    pub(super) fn is_of(&self, settings: &[Setting], drive: &Drive, fit: &Fit) -> bool {
        self.start == fit.start
            && self.slack == fit.slack
            && self.settings == settings
            && self.drive == *drive
    }
}

/// Most windows that are compared. Where an arm tumbles, or is quick, they are short, each takes twice as long, and what it tells grows
/// with the square of the rates.
pub(super) fn most_windows(windows: &[Window], runs: &[Run]) -> usize {
    let length = |window: &Window| {
        let time = &runs[window.run].plant.as_ref()?.time;
        Some(time[*window.rows.last()?] - time[*window.rows.first()?])
    };
    // some end where the torque is not known
    let first = windows.iter().take_while(|window| window.run == windows[0].run);
    let short = first.filter_map(length).all(|length| length < HALF * WINDOWS.window);
    if short { WINDOWS.most / 4 } else { WINDOWS.most }
}

/// From this rate on (rad/s) nothing is simulated any more.
pub(super) fn runaway_rate(data: &DataSet, model: &Model) -> f64 {
    WINDOWS.lost * data.runs.iter().map(Run::speed).fold(model.growth().unwrap_or(0.0), f64::max)
}

/// Evenly chosen windows, at most so many.
pub(super) fn thin_windows(windows: &mut Vec<Window>, most: usize) {
    let all = windows.len();
    let mut place = 0;
    windows.retain(|_| {
        place += 1;
        all <= most || place * most / all != (place - 1) * most / all
    });
}

/// Where a window's nuisances are.
#[derive(Debug, Clone)]
pub struct WindowState {
    start: State,
    slack: Vec<f64>,
    kept: Option<Arc<Kept>>,
    free: Option<Arc<Fit>>,
}

impl WindowState {
    /// Where the last linearisation had them.
    pub(in crate::rigs::acrobot::residual) fn linearised(&self) -> Self {
        match &self.kept {
            Some(kept) => Self { start: kept.start, slack: kept.slack.clone(), ..self.clone() },
            None => self.clone(),
        }
    }

    /// Whether the plant needs slack torques to follow the log in it.
    pub(super) fn has_slack(&self) -> bool {
        self.slack.iter().any(|torque| *torque != 0.0)
    }
}

/// A stretch of a run with a free start state.
#[derive(Clone)]
pub(super) struct Window {
    pub(super) run: usize,
    pub(super) drive: Drive,
    /// Rows of `plant.csv` that are scored.
    pub(super) rows: Vec<usize>,
    pub(super) start: State,
    /// What it is guessed from.
    curve: Curve,
    /// Edges of the parts, s.
    pub(super) edges: Vec<f64>,
    /// Slack torques, which hold the plant to the log: link 1 and joint of each part, N·m.
    pub(super) slack: Vec<f64>,
    /// Start, slack torques and columns of the nuisances, from the last linearisation.
    pub(super) kept: Option<Arc<Kept>>,
    /// The fit without slack torques of the last linearisation: by it the window got slack torques, or not.
    pub(super) free: Option<Arc<Fit>>,
    /// What the unit made of it lately.
    pub(super) memory: Memory,
}

impl Window {
    /// The same window, begun anew at a state.
    pub(super) fn started_at(&self, start: State) -> Self {
        Self {
            run: self.run,
            drive: self.drive.clone(),
            rows: self.rows.clone(),
            start,
            curve: self.curve,
            edges: self.edges.clone(),
            slack: vec![0.0; self.slack.len()],
            kept: None,
            free: None,
            memory: self.memory.clone(),
        }
    }

    /// Back to where it was before anything was fitted.
    pub(super) fn begin(&mut self, run: &Run) {
        if let Some(plant) = &run.plant
            && let (Some(q1), Some(q2)) = (plant.column("q1"), plant.column("q2"))
        {
            self.start = guess(&plant.time, q1, q2, self.drive.start(), self.curve);
        }
        self.slack.iter_mut().for_each(|torque| *torque = 0.0);
        self.kept = None;
        self.free = None;
    }

    pub(super) fn state(&self) -> WindowState {
        let (kept, free) = (self.kept.clone(), self.free.clone());
        WindowState { start: self.start, slack: self.slack.clone(), kept, free }
    }

    pub(super) fn restore(&mut self, state: &WindowState) {
        let WindowState { start, slack, kept, free } = state.clone();
        (self.start, self.slack, self.kept, self.free) = (start, slack, kept, free);
    }

    pub(super) fn has_slack(&self) -> bool {
        self.slack.iter().any(|torque| *torque != 0.0)
    }

    pub(super) fn pushes(&self, slack: &[f64]) -> Vec<Push> {
        (slack.iter().enumerate())
            .filter(|(_, size)| **size != 0.0)
            .map(|(place, size)| self.push(place, *size))
            .collect()
    }

    pub(super) fn push(&self, place: usize, size: f64) -> Push {
        Push { joint: place % 2 == 1, from: self.edges[place / 2], to: self.edges[place / 2 + 1], size }
    }
}

/// Cuts one run into windows.
///
/// `pace` is the length of a window against those of an arm that isn't quick.
pub(super) fn cut_run(index: usize, run: &Run, contact: f64, pace: f64, into: &mut Vec<Window>) {
    let (Some(plant), Some(_)) = (&run.plant, &run.controller) else { return };
    let (Some(q1), Some(q2)) = (plant.column("q1"), plant.column("q2")) else { return };
    let limit = run.touches(contact).unwrap_or(plant.len());
    let usable: Vec<usize> = (0..limit).filter(|row| q1[*row].is_finite() || q2[*row].is_finite()).collect();
    if usable.len() < POLICY.rows {
        return;
    }
    let mut gaps: Vec<f64> =
        usable.windows(2).map(|pair| plant.time[pair[1]] - plant.time[pair[0]]).collect();
    gaps.sort_by(f64::total_cmp);
    let typical = gaps[gaps.len() / 2];
    let plenty = WINDOWS.plenty * typical < HALF * WINDOWS.window;
    let tumbling = plenty && tumbles(&plant.time, &usable, q2);
    let usual =
        if tumbling { (HALF * WINDOWS.window).min(pace * WINDOWS.window) } else { pace * WINDOWS.window };
    // of one angle, where they are logged in turn
    let each =
        typical * usable.len() as f64 / usable.iter().filter(|row| q2[**row].is_finite()).count() as f64;
    let curve = if tumbling || pace < 1.0 { Curve::near(each) } else { Curve::USUAL };
    // only an actuator has a past that must fill up
    let before = if has_changing_torque(run) { pace * PREROLL } else { 0.0 };
    let length = usual.max(POLICY.rows as f64 * typical).min(WINDOWS.window.max(6.0 * typical));
    // rows before the first torque may start a window, and say nothing else
    let (begin, end) = run.driven();
    let earliest = plant.time[usable[0]].max(begin - PREROLL);
    let driven = |row: &usize| (begin..=end).contains(&plant.time[*row]);
    let usable = thinned(each, &plant.time, [q1, q2], usable.into_iter().filter(driven));
    for part in parts(&plant.time, &usable, (length, typical), (&run.undriven(), before)) {
        let rows = usable[part].to_vec();
        let times: Vec<f64> = rows.iter().map(|row| plant.time[*row]).collect();
        let (start, end) = ((times[0] - before).max(earliest), times[times.len() - 1]);
        let edges: Vec<f64> =
            (0..=WINDOWS.parts).map(|k| start + (end - start) * k as f64 / WINDOWS.parts as f64).collect();
        into.push(Window {
            run: index,
            drive: Drive::new(run, start, &times, &edges),
            rows,
            start: guess(&plant.time, q1, q2, start, curve),
            curve,
            edges,
            slack: vec![0.0; 2 * WINDOWS.parts],
            kept: None,
            free: None,
            memory: Memory::default(),
        });
    }
}

/// Which of some rows belong to each window: as many as are `length` long without a gap, `typical` s apart. A window ends where the torque
/// is not known, and the next one begins `before` s after it is known again, when the actuator has forgotten what was not.
fn parts(
    time: &[f64],
    usable: &[usize],
    (length, typical): (f64, f64),
    (undriven, before): (&[(f64, f64)], f64),
) -> Vec<Range<usize>> {
    let at = |place: usize| time[usable[place]];
    let (mut all, mut from) = (Vec::new(), 0);
    while from < usable.len() {
        let begin = at(from);
        let unknown = |span: &&(f64, f64)| span.0 <= begin && span.1 + before > begin;
        if let Some((_, known)) = undriven.iter().find(unknown) {
            from = usable.partition_point(|row| time[*row] < known + before).max(from + 1);
            continue;
        }
        let stop =
            undriven.iter().map(|span| span.0).filter(|stop| *stop > begin).fold(f64::INFINITY, f64::min);
        let mut to = from;
        while to < usable.len()
            && at(to) < begin + length - 0.5 * typical
            && at(to) <= stop
            && (to == from || at(to) - at(to - 1) < (5.0 * typical).max(0.1))
        {
            to += 1;
        }
        if to - from >= 6 {
            all.push(from..to);
        }
        from = to.max(from + 1);
    }
    all
}

/// Whether link 2 turns so fast that it goes over the top within a window, time after time: then errors of the start state
/// grow much faster than at the upright.
fn tumbles(time: &[f64], usable: &[usize], q2: &[f64]) -> bool {
    let speed = |pair: &[usize]| ((q2[pair[1]] - q2[pair[0]]) / (time[pair[1]] - time[pair[0]])).abs();
    let rows: Vec<usize> = usable.iter().copied().filter(|row| q2[*row].is_finite()).collect();
    let mut speeds: Vec<f64> = rows.windows(2).map(speed).collect();
    speeds.sort_by(f64::total_cmp);
    speeds.get(speeds.len() / 2).is_some_and(|typical| typical * WINDOWS.window > std::f64::consts::TAU)
}

/// Every so many of the rows that hold an angle, `each` s apart, so that `RESIDUAL.step` lies between: two encoders may be logged in turn.
/// Counted, not timed, where rows are as near as usual: those chosen by timestamps that scatter would be the ones that are stamped late.
fn thinned(each: f64, time: &[f64], angles: [&[f64]; 2], rows: impl Iterator<Item = usize>) -> Vec<usize> {
    let every = (RESIDUAL.step / each - 1e-9).ceil().max(1.0);
    // rows and the time since the last that was kept
    let mut since = [(every, f64::NEG_INFINITY); 2];
    rows.filter(|row| {
        let held = [0, 1].map(|angle| angles[angle][*row].is_finite());
        (0..2).filter(|angle| held[*angle]).for_each(|angle| since[angle].0 += 1.0);
        let far =
            |(count, last): (f64, f64)| count > every || time[*row] - last > POLICY.steps * every * each;
        let new = (0..2).any(|angle| held[angle] && far(since[angle]));
        (0..2).filter(|angle| new && held[*angle]).for_each(|angle| since[angle] = (1.0, time[*row]));
        new
    })
    .collect()
}

/// The curve through a log that a state is read off.
#[derive(Debug, Clone, Copy)]
pub(super) struct Curve {
    /// Rows on either side that it goes through, s.
    around: f64,
    /// Highest power of time.
    power: usize,
}

impl Curve {
    pub(super) const USUAL: Self = Self { around: POLICY.around, power: 2 };

    fn near(typical: f64) -> Self {
        Self { around: (WINDOWS.near_rows * typical).clamp(POLICY.motion_step, POLICY.around), power: 3 }
    }
}

/// Rows with a value within a time, or the nearest few.
fn nearby(time: &[f64], values: &[f64], at: f64, around: f64) -> Vec<usize> {
    let (mut from, mut to) =
        (time.partition_point(|t| *t < at - around), time.partition_point(|t| *t <= at + around));
    let known = |row: usize| usize::from(values[row].is_finite());
    let mut count: usize = (from..to).map(known).sum();
    // the nearer side first: rows beyond a gap say little
    while count < WINDOWS.fewest && to - from < time.len() {
        let before = if from > 0 { at - time[from - 1] } else { f64::INFINITY };
        let after = if to < time.len() { time[to] - at } else { f64::INFINITY };
        if before < after {
            from -= 1;
            count += known(from);
        } else {
            count += known(to);
            to += 1;
        }
    }
    (from..to).filter(|row| values[*row].is_finite()).collect()
}

/// A state to begin with: curves through the rows around, or straight lines where these are few.
pub(super) fn guess(time: &[f64], q1: &[f64], q2: &[f64], at: f64, curve: Curve) -> State {
    let Curve { around, power } = curve;
    let curve = |values: &[f64]| {
        let rows = nearby(time, values, at, around);
        let Some(first) = rows.first() else { return (0.0, 0.0) };
        let powers = 1 + if rows.len() < WINDOWS.curved { 1 } else { power };
        // in units of the rows' reach, so that the normal equations are well conditioned
        let design = DMatrix::from_fn(rows.len(), powers, |row, power| {
            ((time[rows[row]] - at) / around).powi(power as i32)
        });
        let change = DVector::from_fn(rows.len(), |row, _| values[rows[row]] - values[*first]);
        match solve(&design.tr_mul(&design), &design.tr_mul(&change)) {
            Some(found) => (values[*first] + found[0], found[1] / around),
            None => (values[*first], 0.0),
        }
    };
    let ((a, da), (b, db)) = (curve(q1), curve(q2));
    [a, b, da, db]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_of_a_log_that_is_dense_in_parts_only_counts_where_it_is_not() {
        // 200 rows at 1 kHz, then 50 at 100 Hz
        let time: Vec<f64> = (0..250)
            .map(|row: u32| 1e-3 * f64::from(row.min(200)) + 0.01 * f64::from(row.saturating_sub(200)))
            .collect();
        let angle = vec![0.0; time.len()];
        let kept = thinned(1e-3, &time, [&angle, &angle], 0..time.len());
        assert_eq!(kept.iter().filter(|row| **row < 200).count(), 50);
        assert!((201..250).all(|row| kept.contains(&row)), "{kept:?}");
    }

    #[test]
    fn every_row_counts_that_is_driven_by_what_is_known() {
        let (time, usable): (Vec<f64>, Vec<usize>) = (0..60).map(|row| (0.03125 * row as f64, row)).unzip();
        let cut = |undriven: &[(f64, f64)]| parts(&time, &usable, (0.5, 0.03125), (undriven, 0.1));
        assert_eq!(cut(&[]), [0..16, 16..32, 32..48, 48..60]);
        // from row 20 to row 22; 0.1 s later is row 26
        assert_eq!(cut(&[(time[20], time[22])]), [0..16, 26..42, 42..58]);
        // up to the last row before it, if these are enough
        assert_eq!(cut(&[(time[10], time[11])]), [0..11, 15..31, 31..47, 47..60]);
        assert_eq!(cut(&[(time[4], time[6]), (time[8], time[9])]), [13..29, 29..45, 45..60]);
    }

    #[test]
    fn every_angle_that_is_logged_in_turn_is_kept() {
        let time: Vec<f64> = (0..400).map(|row| 1.25e-3 * f64::from(row)).collect();
        let held = |first: usize| -> Vec<f64> {
            (0..400).map(|row| if row % 2 == first { 0.0 } else { f64::NAN }).collect()
        };
        let kept = thinned(2.5e-3, &time, [&held(0), &held(1)], 0..400);
        let of = |first: usize| kept.iter().filter(|row| **row % 2 == first).count();
        // each at 400 Hz, of which every second
        assert_eq!((of(0), of(1)), (100, 100));
    }
}
