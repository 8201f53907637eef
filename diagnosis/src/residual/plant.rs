//! The plant's cut: logged torque in, encoder columns out, in windows with free start states.

use super::trajectory::{DENSE, Drive, Motion, PREROLL, Ports, Push, State, simulate};
use super::{Block, Cut, Probe, Signal};
use crate::bench::{Bench, Setting};
use crate::candidates::{Candidate, Side};
use crate::dataset::{DataSet, Run};
use crate::error::Error;
use crate::model::Model;
use crate::statistics::linear::{Cell, nuisances};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::sync::Arc;

/// Scored length of a window, s. Long enough for four start values to cost little, short against the plant's
/// growth: e^(7 · 0.6) = 67 times the error of the start state. Half of it on demand where rows are plenty: an arm
/// that swings with friction unknown leaves the data sooner.
const WINDOW: f64 = 0.5;
const SHORT_WINDOW: f64 = 0.25;
const PLENTY: f64 = 36.0;
/// A window needs at least this many rows, and its length grows up to `LONGEST` for that.
const ROWS: f64 = 12.0;
const LONGEST: f64 = 1.0;
/// Rows closer than this are averaged: a bin per window and signal; more would cost time and tell no more.
const BINS: usize = 25;
/// Parts of a window that each get a torque the model may lack.
const PARTS: usize = 2;
/// Where the rest is this many standard deviations, the plant is first led along the log by such torques, so that
/// everything is linearised about the motion that was measured and not about one that the lacking model invents.
const LED: f64 = 4.0;
/// Perturbations for derivatives: far above the integrator's 1e-9, far below where the plant bends.
const NUDGE: State = [1e-4, 1e-4, 1e-3, 1e-3];
const PUSH: f64 = 1e-3;
/// Columns of `plant.csv` in the order of the simulated outputs.
pub const COLUMNS: [&str; 5] = ["q1", "q2", "dq1", "dq2", "tau_applied"];
const UNITS: [&str; 5] = ["rad", "rad", "rad/s", "rad/s", "N·m"];
/// Standard deviations to begin with where none is stated.
const FIRST_GUESS: [f64; 5] = [1e-3, 1e-3, 5e-2, 5e-2, 1e-2];
/// A window starts from a straight line through rows this far around, s.
const AROUND: f64 = 0.03;

struct Window {
    run: usize,
    drive: Drive,
    /// Rows of `plant.csv` that are scored.
    rows: Vec<usize>,
    start: State,
    /// Edges of the parts, s.
    edges: Vec<f64>,
    /// Torques that lead the plant along the log: link 1 and joint of each part, N·m.
    leads: Vec<f64>,
    /// Columns of the nuisances, from the last full look.
    kept: Option<(DMatrix<f64>, DMatrix<f64>)>,
}

impl Window {
    fn pushes(&self, leads: &[f64]) -> Vec<Push> {
        (leads.iter().enumerate())
            .filter(|(_, size)| **size != 0.0)
            .map(|(place, size)| self.push(place, *size))
            .collect()
    }

    fn push(&self, place: usize, size: f64) -> Push {
        Push { joint: place % 2 == 1, from: self.edges[place / 2], to: self.edges[place / 2 + 1], size }
    }
}

/// A window, simulated.
#[derive(Clone)]
struct Fit {
    start: State,
    leads: Vec<f64>,
    base: Vec<[f64; 5]>,
    cell: Cell,
}

/// Poses that were read off pictures.
#[derive(Debug, Clone, Default)]
pub struct Poses {
    /// Per run and row: q1, q2; `NaN` where the picture says nothing.
    pub angles: Vec<Vec<[f64; 2]>>,
    /// Per run and row: how each probe would move them, per unit.
    pub moves: Vec<Vec<DMatrix<f64>>>,
}

impl Poses {
    /// None yet.
    pub fn new(runs: usize) -> Self {
        Self { angles: vec![Vec::new(); runs], moves: vec![Vec::new(); runs] }
    }

    /// The next row of a run.
    pub fn push(&mut self, run: usize, angles: [f64; 2], moves: &DMatrix<f64>) {
        self.angles[run].push(angles);
        self.moves[run].push(moves.clone());
    }
}

/// What lies between the motion and a log that a camera made.
struct Through {
    index: Option<usize>,
    delay: f64,
    poses: Poses,
}

/// Torque in, motion out.
pub struct PlantCut {
    bench: Arc<Bench>,
    ports: Ports,
    candidates: Arc<Vec<Candidate>>,
    runs: Arc<Vec<Run>>,
    windows: Vec<Window>,
    signals: Vec<Signal>,
    through: Option<Through>,
    clock: Option<usize>,
}

impl PlantCut {
    /// Windows over all runs that have a torque and a motion; `None` if there is none.
    ///
    /// # Errors
    /// The plant unit lacks a variable.
    pub fn new(
        data: &DataSet,
        model: &Model,
        candidates: Arc<Vec<Candidate>>,
        short: bool,
    ) -> Result<Option<Self>, Error> {
        let ports = Ports::of(&model.plant)?;
        let contact = model.number("plant.q2_max").unwrap_or(f64::INFINITY);
        let mut windows = Vec::new();
        for (index, run) in data.runs.iter().enumerate() {
            cut_run(index, run, contact, short, &mut windows);
        }
        if windows.is_empty() {
            return Ok(None);
        }
        let signals = (0..COLUMNS.len())
            .map(|place| {
                let name = format!("plant.{}", COLUMNS[place]);
                let known = data.known_noise(&name).filter(|sigma| *sigma > 0.0);
                Signal { name, unit: UNITS[place], known, sigma: known.unwrap_or(FIRST_GUESS[place]) }
            })
            .collect();
        let runs = Arc::new(data.runs.clone());
        let clock = candidates.iter().position(|candidate| candidate.side == Side::Clock);
        let through = Some(Through { index: clock, delay: 0.0, poses: Poses::new(runs.len()) });
        Ok(Some(Self {
            bench: model.plant.clone(),
            ports,
            candidates,
            runs,
            windows,
            signals,
            through,
            clock,
        }))
    }

    fn settings(&self, point: &[f64], moved: Option<Probe>) -> Result<Vec<Setting>, Error> {
        settings(&self.bench, &self.candidates, Side::Plant, point, moved)
    }

    /// The log is none of encoders but what a camera with this delay saw.
    pub fn see_through(&mut self, delay: f64) {
        let poses = Poses::new(self.runs.len());
        self.clock = None;
        self.through = Some(Through { index: None, delay: 0.0, poses });
        self.shift(delay);
    }

    /// Other poses for the log's rows, and another delay of the camera (its candidate and value).
    pub fn replace(&mut self, poses: Poses, delay: Option<(usize, f64)>) {
        for (run, angles) in Arc::make_mut(&mut self.runs).iter_mut().zip(&poses.angles) {
            let Some(log) = &mut run.plant else { continue };
            for (place, name) in ["q1", "q2"].iter().enumerate() {
                if let Some(column) = log.column_mut(name) {
                    column.iter_mut().zip(angles).for_each(|(value, angles)| *value = angles[place]);
                }
            }
        }
        if let Some(through) = &mut self.through {
            through.poses = poses;
            through.index = delay.map(|(index, _)| index);
        }
        if let Some((_, delay)) = delay {
            self.shift(delay);
        }
    }

    /// Moves the log to when the exposures ended.
    fn shift(&mut self, delay: f64) {
        let Some(through) = &mut self.through else { return };
        let by = through.delay - delay;
        if by == 0.0 {
            return;
        }
        through.delay = delay;
        for log in Arc::make_mut(&mut self.runs).iter_mut().filter_map(|run| run.plant.as_mut()) {
            log.time.iter_mut().for_each(|time| *time += by);
        }
        for window in &mut self.windows {
            let run = &self.runs[window.run];
            let Some(log) = &run.plant else { continue };
            let times: Vec<f64> = window.rows.iter().map(|row| log.time[*row]).collect();
            window.edges.iter_mut().for_each(|edge| *edge += by);
            window.drive = Drive::new(run, window.drive.start() + by, &times, &window.edges);
        }
    }

    /// A column that needs no simulation: what moving the camera does to angles that were read off its picture.
    fn seen_column(
        &self,
        window: &Window,
        layout: &Layout,
        base: &[[f64; 5]],
        place: usize,
        candidate: usize,
    ) -> Vec<f64> {
        let Some(through) = &self.through else { return vec![0.0; layout.len()] };
        (layout.bins.iter())
            .map(|(signal, rows)| {
                let of = |row: &usize| {
                    if through.index == Some(candidate) {
                        -base[*row][2 + *signal]
                    } else {
                        through.poses.moves[window.run]
                            .get(window.rows[*row])
                            .map_or(0.0, |moves| moves[(*signal, place)])
                    }
                };
                rows.iter().map(of).sum::<f64>() / rows.len() as f64
            })
            .collect()
    }

    /// Share of windows in which the plant must be led to stay with the log.
    pub fn led(&self) -> f64 {
        let led = self.windows.iter().filter(|window| window.leads.iter().any(|lead| *lead != 0.0)).count();
        led as f64 / self.windows.len().max(1) as f64
    }

    /// Keeps at most so many windows, evenly spread.
    pub fn thin(&mut self, most: usize) {
        let every = self.windows.len().div_ceil(most.max(1)).max(1);
        let mut place = 0;
        self.windows.retain(|_| {
            place += 1;
            (place - 1) % every == 0
        });
    }

    /// The fitted motion on a grid of `every` s, one stretch a window (the last scored time of one to that of the
    /// next). Call after `linearise` at the same point.
    ///
    /// # Errors
    /// The unit failed.
    pub fn motion(&self, point: &[f64], every: f64) -> Result<Vec<Motion>, Error> {
        let settings = self.settings(point, None)?;
        let mut motions = vec![Motion::default(); self.runs.len()];
        let stretches: Vec<_> = self
            .windows
            .par_iter()
            .map(|window| {
                let log = &self.runs[window.run];
                let first = log.plant.as_ref().map_or(0.0, |plant| plant.time[window.rows[0]]);
                // back to where the window before ended
                let from = (first - LONGEST.min(PREROLL)).max(window.drive.start());
                let count = ((window.drive.end() - from) / every).ceil().max(1.0) as usize;
                let times: Vec<f64> = (0..=count)
                    .map(|k| from + (window.drive.end() - from) * k as f64 / count as f64)
                    .collect();
                let drive = Drive::new(log, window.drive.start(), &times, &window.edges);
                let rows = simulate(
                    &self.bench,
                    &self.ports,
                    &settings,
                    &drive,
                    &window.start,
                    &window.pushes(&window.leads),
                )?;
                let states: Vec<State> = rows.iter().map(|row| [row[0], row[1], row[2], row[3]]).collect();
                Ok::<_, Error>((window.run, times, states))
            })
            .collect::<Result<_, _>>()?;
        for (run, times, states) in stretches {
            motions[run].stretches.push((times, states));
        }
        Ok(motions)
    }

    /// Gauss-Newton for the start state (and the leading torques, if `led`), a step only if it brings the rows
    /// closer. What is left then is so small that the linear projection takes care of it.
    fn settle(
        &self,
        window: &Window,
        layout: &Layout,
        settings: &[Setting],
        led: bool,
        from: Fit,
    ) -> Result<Fit, Error> {
        let mut fit = from;
        for _ in 0..if window.kept.is_some() { 2 } else { 4 } {
            self.nuisance_columns(window, layout, settings, led, &mut fit)?;
            let Some((whole, leads)) = next(&fit, led) else { break };
            let mut length = 1.0;
            let better = loop {
                let part = |from: f64, to: f64| from + length * (to - from);
                let start: State = std::array::from_fn(|place| part(fit.start[place], whole[place]));
                let leads = fit.leads.iter().zip(&leads).map(|(from, to)| part(*from, *to)).collect();
                if let Ok(trial) = self.fit(window, layout, settings, start, leads)
                    && square(&trial.cell) < square(&fit.cell)
                {
                    break Some(trial);
                }
                length *= 0.25;
                if length < 0.01 {
                    break None;
                }
            };
            let Some(better) = better else { break };
            let (hard, soft) = (fit.cell.hard, fit.cell.soft);
            fit = better;
            (fit.cell.hard, fit.cell.soft) = (hard, soft);
        }
        Ok(fit)
    }

    /// As `settle`, with the columns that are there: one simulation a step.
    fn chord(
        &self,
        window: &Window,
        layout: &Layout,
        settings: &[Setting],
        led: bool,
        from: Fit,
    ) -> Result<Fit, Error> {
        let mut fit = from;
        for _ in 0..if led { 1 } else { 4 } {
            let Some((start, leads)) = next(&fit, led) else { break };
            let Ok(trial) = self.fit(window, layout, settings, start, leads) else { break };
            if square(&trial.cell) >= square(&fit.cell) {
                break;
            }
            let (hard, soft) = (fit.cell.hard, fit.cell.soft);
            fit = trial;
            (fit.cell.hard, fit.cell.soft) = (hard, soft);
        }
        Ok(fit)
    }

    fn fit(
        &self,
        window: &Window,
        layout: &Layout,
        settings: &[Setting],
        start: State,
        leads: Vec<f64>,
    ) -> Result<Fit, Error> {
        let base =
            simulate(&self.bench, &self.ports, settings, &window.drive, &start, &window.pushes(&leads))?;
        let cell = layout.cell(self, window, &base);
        Ok(Fit { start, leads, base, cell })
    }

    fn nuisance_columns(
        &self,
        window: &Window,
        layout: &Layout,
        settings: &[Setting],
        soft: bool,
        fit: &mut Fit,
    ) -> Result<(), Error> {
        let pushes = window.pushes(&fit.leads);
        let mut hard = DMatrix::zeros(layout.len(), 4);
        for place in 0..4 {
            let mut moved = fit.start;
            moved[place] += NUDGE[place];
            let rows = simulate(&self.bench, &self.ports, settings, &window.drive, &moved, &pushes)?;
            layout.column(&fit.base, &rows, NUDGE[place], &mut hard, place);
        }
        fit.cell.hard = hard;
        if soft {
            let mut columns = DMatrix::zeros(layout.len(), fit.leads.len());
            for place in 0..fit.leads.len() {
                let mut more = pushes.clone();
                more.push(window.push(place, PUSH));
                let rows = simulate(&self.bench, &self.ports, settings, &window.drive, &fit.start, &more)?;
                layout.column(&fit.base, &rows, PUSH, &mut columns, place);
            }
            fit.cell.soft = columns;
        }
        Ok(())
    }

    fn window(
        &self,
        window: &Window,
        point: &[f64],
        probes: &[Probe],
        quick: bool,
    ) -> Result<(State, Vec<f64>, Block), Error> {
        let settings = self.settings(point, None)?;
        let layout = Layout::of(self, window);
        let begin = self.fit(window, &layout, &settings, window.start, window.leads.clone())?;
        let mut fit;
        if let Some((hard, soft)) =
            window.kept.as_ref().filter(|(hard, _)| quick && hard.nrows() == layout.len())
        {
            fit = begin;
            (fit.cell.hard, fit.cell.soft) = (hard.clone(), soft.clone());
            let led = window.leads.iter().any(|lead| *lead != 0.0);
            fit = self.chord(window, &layout, &settings, led, fit)?;
        } else {
            let led_before = window.leads.iter().any(|lead| *lead != 0.0);
            fit = if led_before { begin } else { self.settle(window, &layout, &settings, false, begin)? };
            if led_before || square(&fit.cell) > LED * LED * layout.len() as f64 {
                // from the first guess again: a state that was fitted without leads may be far away
                let again = self.fit(window, &layout, &settings, window.start, window.leads.clone())?;
                fit = self.settle(window, &layout, &settings, true, again)?;
            }
            self.nuisance_columns(window, &layout, &settings, true, &mut fit)?;
        }
        let Fit { start, leads, base, mut cell } = fit;
        // the model itself has no leads: what they did is part of the rest
        let missing = &cell.soft * DVector::from_column_slice(&leads);
        cell.residual.iter_mut().zip(missing.iter()).for_each(|(rest, lead)| *rest += lead);
        let pushes = window.pushes(&leads);
        let (from, to) = (window.drive.start(), window.drive.end());
        let mut columns = DMatrix::zeros(layout.len(), probes.len());
        for (place, probe) in probes.iter().enumerate() {
            let candidate = &self.candidates[probe.candidate];
            if candidate.side != Side::Plant && self.sees(candidate) {
                let column = self.seen_column(window, &layout, &base, place, probe.candidate);
                (0..layout.len()).for_each(|row| columns[(row, place)] = column[row]);
            } else if self.sees(candidate) {
                let moved = self.settings(point, Some(*probe))?;
                // a value that the plant can't follow has no column
                if let Ok(rows) = simulate(&self.bench, &self.ports, &moved, &window.drive, &start, &pushes) {
                    layout.column(&base, &rows, probe.by, &mut columns, place);
                }
            }
        }
        cell.columns = columns;
        let mut state = [0.0; 4];
        for row in &base {
            for (sum, value) in state.iter_mut().zip(row) {
                *sum += value / base.len() as f64;
            }
        }
        let block = Block {
            run: window.run,
            from: cell.time.first().copied().unwrap_or(from),
            to,
            cells: vec![cell],
            state,
        };
        Ok((start, leads, block))
    }
}

impl Cut for PlantCut {
    fn name(&self) -> &'static str {
        "plant: torque in, motion out"
    }

    fn signals(&self) -> &[Signal] {
        &self.signals
    }

    fn sees(&self, candidate: &Candidate) -> bool {
        match candidate.side {
            Side::Plant => true,
            Side::Clock => self.clock.is_some(),
            Side::Camera => self.through.is_some() && self.clock.is_none(),
            _ => false,
        }
    }

    fn linearise(&mut self, point: &[f64], probes: &[Probe], quick: bool) -> Result<Vec<Block>, Error> {
        if let Some(clock) = self.clock {
            self.shift(point[clock]);
        }
        let done: Vec<_> =
            self.windows.par_iter().map(|window| self.window(window, point, probes, quick)).collect();
        let mut blocks = Vec::with_capacity(done.len());
        for (window, result) in self.windows.iter_mut().zip(done) {
            let (start, leads, block) = result?;
            window.start = start;
            window.leads = leads;
            if !quick {
                window.kept = block.cells.first().map(|cell| (cell.hard.clone(), cell.soft.clone()));
            }
            blocks.push(block);
        }
        Ok(blocks)
    }

    fn discrepancy_unit(&self) -> &'static str {
        "N·m"
    }
}

/// Parameter values of one unit at a point, one candidate moved on.
///
/// # Errors
/// The unit lacks a candidate's variable.
pub fn settings(
    bench: &Bench,
    candidates: &[Candidate],
    side: Side,
    point: &[f64],
    moved: Option<Probe>,
) -> Result<Vec<Setting>, Error> {
    let mut all = Vec::new();
    for (index, candidate) in candidates.iter().enumerate() {
        if candidate.side != side {
            continue;
        }
        let by = moved.filter(|probe| probe.candidate == index).map_or(0.0, |probe| probe.by);
        let x = (point[index] + by).clamp(candidate.range.0, candidate.range.1);
        if x != candidate.off {
            let variable = candidate.name.split_once('.').map_or(candidate.name, |(_, variable)| variable);
            all.push(bench.setting(variable, candidate.value(x))?);
        }
    }
    Ok(all)
}

fn square(cell: &Cell) -> f64 {
    cell.residual.iter().zip(&cell.sigma).map(|(rest, sigma)| (rest / sigma).powi(2)).sum()
}

/// Start state and leads after a Gauss-Newton step; `None` when it moves the rows by less than a tenth of a standard
/// deviation. Leads are free while they are looked for.
fn next(fit: &Fit, led: bool) -> Option<(State, Vec<f64>)> {
    let mut cell = fit.cell.clone();
    if !led {
        cell.soft = DMatrix::zeros(cell.residual.len(), 0);
    }
    let shift = nuisances(&cell, if led { crate::selection::FREE } else { 0.0 });
    let hard = cell.hard.ncols();
    let moved = &cell.hard * shift.rows(0, hard) + &cell.soft * shift.rows(hard, shift.len() - hard);
    let size = moved.iter().zip(&cell.sigma).map(|(moved, sigma)| (moved / sigma).powi(2)).sum::<f64>();
    if size < 0.01 * cell.residual.len() as f64 {
        return None;
    }
    let start = std::array::from_fn(|place| fit.start[place] + shift[place]);
    let mut leads = fit.leads.clone();
    if led {
        leads.iter_mut().enumerate().for_each(|(place, lead)| *lead += shift[hard + place]);
    }
    Some((start, leads))
}

/// Which simulated row goes into which bin.
struct Layout {
    /// Signal, rows (index among the wanted ones).
    bins: Vec<(usize, Vec<usize>)>,
}

impl Layout {
    fn of(cut: &PlantCut, window: &Window) -> Self {
        let mut bins = Vec::new();
        let Some(log) = cut.runs[window.run].plant.as_ref() else { return Self { bins } };
        let size = window.rows.len().div_ceil(BINS);
        for (signal, name) in COLUMNS.iter().enumerate() {
            let Some(values) = log.column(name) else { continue };
            for chunk in (0..window.rows.len()).collect::<Vec<_>>().chunks(size) {
                let rows: Vec<usize> =
                    chunk.iter().copied().filter(|place| values[window.rows[*place]].is_finite()).collect();
                if !rows.is_empty() {
                    bins.push((signal, rows));
                }
            }
        }
        Self { bins }
    }

    fn len(&self) -> usize {
        self.bins.len()
    }

    fn column(&self, base: &[[f64; 5]], moved: &[[f64; 5]], by: f64, into: &mut DMatrix<f64>, place: usize) {
        for (bin, (signal, rows)) in self.bins.iter().enumerate() {
            let sum: f64 = rows.iter().map(|row| moved[*row][*signal] - base[*row][*signal]).sum();
            into[(bin, place)] = sum / (rows.len() as f64 * by);
        }
    }

    fn cell(&self, cut: &PlantCut, window: &Window, base: &[[f64; 5]]) -> Cell {
        let empty = || DMatrix::zeros(self.len(), 0);
        let mut cell = Cell {
            residual: Vec::new(),
            sigma: Vec::new(),
            signal: Vec::new(),
            time: Vec::new(),
            hard: empty(),
            soft: empty(),
            discrepancy: 0,
            columns: empty(),
            floor: Vec::new(),
        };
        let Some(log) = cut.runs[window.run].plant.as_ref() else { return cell };
        for (signal, rows) in &self.bins {
            let values = log.column(COLUMNS[*signal]).unwrap_or(&[]);
            let n = rows.len() as f64;
            let rest: f64 = rows.iter().map(|row| values[window.rows[*row]] - base[*row][*signal]).sum();
            let time: f64 = rows.iter().map(|row| log.time[window.rows[*row]]).sum();
            cell.residual.push(rest / n);
            cell.sigma.push(cut.signals[*signal].sigma / n.sqrt());
            cell.signal.push(*signal);
            cell.time.push(time / n);
        }
        cell
    }
}

/// Cuts one run into windows.
fn cut_run(index: usize, run: &Run, contact: f64, short: bool, into: &mut Vec<Window>) {
    let (Some(plant), Some(_)) = (&run.plant, &run.controller) else { return };
    let (Some(q1), Some(q2)) = (plant.column("q1"), plant.column("q2")) else { return };
    let fallen = q2.iter().position(|angle| angle.abs() >= contact - 0.02).unwrap_or(plant.len());
    let usable: Vec<usize> = (0..fallen).filter(|row| q1[*row].is_finite() && q2[*row].is_finite()).collect();
    if usable.len() < ROWS as usize {
        return;
    }
    let mut gaps: Vec<f64> =
        usable.windows(2).map(|pair| plant.time[pair[1]] - plant.time[pair[0]]).collect();
    gaps.sort_by(f64::total_cmp);
    let typical = gaps[gaps.len() / 2];
    let short = if short && PLENTY * typical < SHORT_WINDOW { SHORT_WINDOW } else { WINDOW };
    let length = short.max(ROWS * typical).min(LONGEST.max(6.0 * typical));
    let usable = thinned(&plant.time, usable);
    let mut from = 0;
    while from < usable.len() {
        let begin = plant.time[usable[from]];
        let mut to = from;
        while to < usable.len()
            && plant.time[usable[to]] < begin + length - 0.5 * typical
            && (to == from || plant.time[usable[to]] - plant.time[usable[to - 1]] < (5.0 * typical).max(0.1))
        {
            to += 1;
        }
        let rows = usable[from..to].to_vec();
        if rows.len() >= 6 {
            let times: Vec<f64> = rows.iter().map(|row| plant.time[*row]).collect();
            let earliest = plant.time[usable[0]];
            let start = (begin - PREROLL).max(earliest);
            let end = times[times.len() - 1];
            let edges: Vec<f64> =
                (0..=PARTS).map(|k| start + (end - start) * k as f64 / PARTS as f64).collect();
            into.push(Window {
                run: index,
                drive: Drive::new(run, start, &times, &edges),
                rows,
                start: guess(&plant.time, q1, q2, start),
                edges,
                leads: vec![0.0; 2 * PARTS],
                kept: None,
            });
        }
        from = to.max(from + 1);
    }
}

/// Rows at least `DENSE` apart.
fn thinned(time: &[f64], rows: Vec<usize>) -> Vec<usize> {
    let mut kept: Vec<usize> = Vec::with_capacity(rows.len());
    for row in rows {
        if kept.last().is_none_or(|last| time[row] - time[*last] > DENSE) {
            kept.push(row);
        }
    }
    kept
}

/// A state to begin with: straight lines through the rows around.
fn guess(time: &[f64], q1: &[f64], q2: &[f64], at: f64) -> State {
    let place = time.partition_point(|t| *t < at).min(time.len() - 1);
    let (mut from, mut to) = (place.saturating_sub(1), (place + 2).min(time.len()));
    while from > 0 && at - time[from] < AROUND {
        from -= 1;
    }
    while to < time.len() && time[to - 1] - at < AROUND {
        to += 1;
    }
    let line = |values: &[f64]| {
        let rows: Vec<usize> = (from..to).filter(|row| values[*row].is_finite()).collect();
        let n = rows.len().max(1) as f64;
        let mean = |f: &dyn Fn(usize) -> f64| rows.iter().map(|row| f(*row)).sum::<f64>() / n;
        let (t, x) = (mean(&|row| time[row] - at), mean(&|row| values[row]));
        let tt = mean(&|row| (time[row] - at - t).powi(2));
        let tx = mean(&|row| (time[row] - at - t) * (values[row] - x));
        let slope = if tt > 0.0 { tx / tt } else { 0.0 };
        (x - slope * t, slope)
    };
    let ((a, da), (b, db)) = (line(q1), line(q2));
    [a, b, da, db]
}
