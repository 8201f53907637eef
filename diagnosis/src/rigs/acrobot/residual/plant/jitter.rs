//! Timestamps that scatter: a row is stamped a little early or late, so that both angles are off by their rates times
//! the same time. That is a nuisance with a prior for each row; its size is found by maximum likelihood.

use super::PlantCut;
use super::fitting::Fit;
use super::layout::Layout;
use super::window::Window;
use crate::error::Error;
use crate::rigs::acrobot::dataset::Run;
use crate::rigs::acrobot::dataset::row_times::{typical_gaps, unevenness};
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::residual::plant::policy::WINDOWS;
use crate::rigs::acrobot::residual::trajectory::{MOTION, Row};
use crate::rigs::acrobot::residual::{Block, Nuisances, Tracked};
use crate::rigs::acrobot::selection::Evaluation;
use crate::statistics::levels::anywhere_in;
use crate::statistics::linear::{Cell, Reduced};
use nalgebra::DMatrix;

impl PlantCut {
    /// Linearises at a point, finds how much the timestamps scatter, and settles the windows with that. Answers where they are then.
    ///
    /// # Errors
    /// The unit failed.
    pub fn find_jitter(&mut self, point: &[f64], from: &Nuisances) -> Result<Nuisances, Error> {
        self.begin_from(from);
        // timestamps that stand unevenly may scatter by as much: a plant that was held to such rows by slack torques would hide it
        let uneven = (self.runs.iter())
            .filter_map(|run| run.plant.as_ref())
            .map(|log| unevenness(&log.time))
            .fold(WINDOWS.jitter, f64::max);
        self.jitter = uneven;
        let unit = self.settle_all(point, &[], from.in_vain);
        self.jitter = 0.0;
        let (unit, mut in_vain) = unit?;
        self.jitter = self.likeliest_jitter(point, &unit, uneven);
        if uneven <= WINDOWS.jitter && self.jitter > WINDOWS.evenly * self.spacing() {
            self.jitter = 0.0;
        }
        if self.jitter > 0.0 || uneven > WINDOWS.jitter {
            in_vain = self.slacken_again(point, in_vain)?;
        }
        self.windows.iter_mut().for_each(|window| window.free = None);
        Ok(self.nuisances(in_vain))
    }

    /// The most likely scatter of the timestamps, s, by a linearisation whose timestamps' columns are those of a scatter of `unit_size` s; 0
    /// where no other is much more likely.
    fn likeliest_jitter(&self, point: &[f64], unit: &[Block], unit_size: f64) -> f64 {
        let judged = |size: f64| {
            let mut blocks = unit.to_vec();
            for block in &mut blocks {
                let ticks = usize::from(self.runs[block.run].tick_error() > 0.0);
                for cell in &mut block.cells {
                    for place in ticks..cell.discrepancy {
                        cell.soft.column_mut(place).scale_mut(size / unit_size);
                    }
                }
            }
            Evaluation::of(blocks, point, &[], &self.signals)
        };
        let steady = judged(0.0);
        let mut best = (steady.deviance() - POLICY.evidence, 0.0);
        let mut more_likely = |size: f64| {
            let there = judged(size);
            if there.deviance() < best.0 && gain_all_along(&steady, &there) >= POLICY.evidence {
                best = (there.deviance(), size);
            }
            best.1
        };
        let mut jitter = 0.0;
        let twice = std::iter::successors(Some(WINDOWS.smallest), |size| Some(2.0 * size));
        for size in twice.take_while(|size| *size < POLICY.motion_step) {
            jitter = more_likely(size);
        }
        // then to either side of it: a sixth too little leaves the rows a tenth more scatter than noise has
        let mut finer = 2.0_f64;
        for _ in 0..2 {
            finer = finer.sqrt();
            let coarse = jitter;
            for size in [coarse / finer, coarse * finer].into_iter().filter(|size| *size > 0.0) {
                jitter = more_likely(size);
            }
        }
        jitter
    }

    /// By how much the timestamps scatter, s: found by `find_jitter`.
    pub fn scatter(&self) -> f64 {
        self.jitter
    }

    /// Usual time between rows, s: the least over runs.
    fn spacing(&self) -> f64 {
        let logs = self.runs.iter().filter_map(|run| run.plant.as_ref());
        logs.filter_map(|log| typical_gaps(&log.time).map(|gaps| gaps.0)).fold(f64::INFINITY, f64::min)
    }

    /// Puts the timestamps' columns before the slack torques: one for all rows, whose ticks are off together, then one for each row.
    pub(super) fn timestamps(&self, window: &Window, layout: &Layout, base: &[Row], cell: &mut Cell) {
        // the windows of a run are off together: a prior for each by itself lets as many move alike as one for all of them would
        let alike = self.windows.iter().filter(|other| other.run == window.run).count();
        let ticks = self.runs[window.run].tick_error() * (alike as f64).sqrt();
        let mut columns: Vec<Vec<f64>> = Vec::new();
        if ticks > 0.0 {
            let slopes = self.slopes(window, layout, base);
            columns.push(slopes.iter().map(|slope| ticks * slope).collect());
        }
        if self.jitter > 0.0 {
            let mut groups: Vec<&Vec<usize>> = Vec::new();
            // rates that were logged change little in that time
            for (_, rows) in layout.bins.iter().filter(|(signal, _)| *signal < 2) {
                if !groups.contains(&rows) {
                    groups.push(rows);
                }
            }
            columns.extend(groups.into_iter().map(|group| {
                let late = |(signal, rows): &(usize, Vec<usize>)| {
                    if *signal < 2 && rows == group { self.jitter * rate(base, *signal, rows) } else { 0.0 }
                };
                layout.bins.iter().map(late).collect()
            }));
        }
        let (priors, slack) = (columns.len(), cell.soft.ncols());
        let mut soft = DMatrix::zeros(layout.len(), priors + slack);
        for (place, column) in columns.iter().enumerate() {
            soft.column_mut(place).copy_from_slice(column);
        }
        soft.columns_mut(priors, slack).copy_from(&cell.soft);
        cell.discrepancy = priors;
        cell.soft = soft;
    }

    /// Mean square of the motion's rows with the timestamps' scatter counted as noise. What was logged of the torque is none of it: no
    /// lead changes that, and a late one is off by far more than noise wherever the command jumps.
    pub(super) fn loose(&self, layout: &Layout, fit: &Fit) -> f64 {
        let rows = fit.cell.residual.iter().zip(&fit.cell.sigma).zip(&layout.bins);
        let squares =
            rows.filter(|(_, (signal, _))| *signal < MOTION).map(|((residual, sigma), (signal, rows))| {
                let late = if *signal < 2 { self.jitter * rate(&fit.base, *signal, rows) } else { 0.0 };
                (residual * residual / (sigma * sigma + late * late), 1.0)
            });
        let (sum, count) =
            squares.fold((0.0, 0.0), |(sum, count), (square, one)| (sum + square, count + one));
        sum / f64::max(count, 1.0)
    }
}

impl Tracked<PlantCut> {
    /// Linearises at a point, finds how much the timestamps scatter, and settles the windows with that.
    ///
    /// # Errors
    /// The unit failed.
    pub fn begin(&mut self, point: &[f64]) -> Result<(), Error> {
        let from = self.nuisances.clone();
        let found = self.find_jitter(point, &from)?;
        self.restore(&found);
        Ok(())
    }

    /// Whether the timestamps scatter by as much with effects on as they seemed to before, when what was missing may have passed for it.
    /// If not, the windows are settled with what they scatter by now.
    ///
    /// # Errors
    /// The unit failed.
    pub fn jitter_remains(&mut self, point: &[f64]) -> Result<bool, Error> {
        let before = self.jitter;
        if before == 0.0 {
            return Ok(true);
        }
        self.begin(point)?;
        if self.jitter < WINDOWS.still * before {
            return Ok(false);
        }
        self.jitter = before;
        self.reset();
        self.linearise(point, &[])?;
        Ok(true)
    }
}

/// The gain of deviance without the windows that gain most: timestamps scatter all along, what happens now and then is something else.
fn gain_all_along(steady: &Evaluation, scattering: &Evaluation) -> f64 {
    let deviance = |block: &Reduced| block.square + block.log_det;
    let pairs = steady.reduced.iter().zip(&scattering.reduced);
    let mut gains: Vec<f64> = pairs.map(|(before, after)| deviance(before) - deviance(after)).collect();
    gains.sort_by(f64::total_cmp);
    let usual = gains.len() - (WINDOWS.events * gains.len() as f64) as usize;
    gains[..usual].iter().sum()
}

/// How well encoders and torques are known to drift apart by the same in all runs, by the slopes of the lines that gave their ticks, s a second:
/// a line that is off by e, root mean square over a time T, has a slope that is off by (e/√2) / (T/√12).
pub fn tick_drift(runs: &[Run]) -> f64 {
    let driven: Vec<&Run> =
        runs.iter().filter(|run| run.plant.is_some() && run.controller.is_some()).collect();
    let variance = |run: &&Run| {
        let (from, to) = run.span();
        0.5 * (run.tick_error() / anywhere_in(to - from)).powi(2)
    };
    driven.iter().map(variance).sum::<f64>().sqrt() / driven.len().max(1) as f64
}

/// What scattering timestamps of the torque and its rounding do: each step of it comes a little early or late, an impulse too much or too
/// little, and together they are a torque over a part of a window (s). Root mean square over runs, N·m.
///
/// The timestamps' scatter is their distance from even spacing. If a log was really sampled so unevenly and stamped
/// rightly, this allows for too much.
pub fn torque_jitter(runs: &[Run], part: f64) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for run in runs.iter().filter(|run| run.plant.is_some()) {
        let Some((log, tau)) = run.controller.as_ref().and_then(|log| Some((log, log.column("tau")?))) else {
            continue;
        };
        let scatter = unevenness(&log.time);
        let steps: f64 =
            tau.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).filter(|s| s.is_finite()).sum();
        let duration = log.time.last().unwrap_or(&0.0) - log.time.first().unwrap_or(&0.0);
        if duration > 0.0 {
            sum += steps / duration * scatter * scatter / part + run.rounded_torque(part).powi(2);
            count += 1.0;
        }
    }
    if count > 0.0 { (sum / count).sqrt() } else { 0.0 }
}

/// Mean rate over a bin, divided by the root of its rows: what a second's scatter of each timestamp does to the bin.
fn rate(base: &[Row], signal: usize, rows: &[usize]) -> f64 {
    let sum: f64 = rows.iter().map(|row| base[*row][2 + signal]).sum();
    sum / (rows.len() as f64).powf(1.5)
}
