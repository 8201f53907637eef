//! Torques along the motion of a window, held over short pieces and stepped through the plant unit.

use super::PlantCut;
use super::layout::Layout;
use super::window::Window;
use crate::error::Error;
use crate::rigs::acrobot::bench::Setting;
use crate::rigs::acrobot::residual::Nuisances;
use crate::rigs::acrobot::residual::forced_torques::{Forced, Pair};
use crate::rigs::acrobot::residual::plant::policy::WINDOWS;
use crate::rigs::acrobot::residual::trajectory::{Drive, Push, Row, State, simulate, state_of};
use nalgebra::DMatrix;
use rayon::prelude::*;

/// Edges of the pieces of a window, s.
fn edges(window: &Window) -> Vec<f64> {
    let (from, to) = (window.drive.start(), window.drive.end());
    let count = ((to - from) / WINDOWS.piece).ceil().max(1.0) as usize;
    (0..=count).map(|k| from + (to - from) * k as f64 / count as f64).collect()
}

impl PlantCut {
    /// Simulates a window with one torque along its motion, scaled to a small root mean square. Answers its rows and the scale.
    fn column(
        &self,
        window: &Window,
        settings: &[Setting],
        drive: &Drive,
        torque: &[Pair],
    ) -> Result<(Vec<Row>, f64), Error> {
        let square: f64 = torque.iter().flatten().map(|x| x * x).sum::<f64>() / torque.len().max(1) as f64;
        let by = if square > 0.0 { self.inertia_scale * WINDOWS.push / square.sqrt() } else { 0.0 };
        let mut pushes = window.pushes(&window.slack);
        for (piece, pair) in edges(window).windows(2).zip(torque) {
            for (joint, size) in [(false, by * pair[0]), (true, by * pair[1])] {
                if size != 0.0 {
                    pushes.push(Push { joint, from: piece[0], to: piece[1], size });
                }
            }
        }
        Ok((simulate(&self.bench, &self.ports, settings, drive, &window.start, &pushes)?, by))
    }

    /// The columns of several torques along a window's motion.
    fn columns(
        &self,
        window: &Window,
        settings: &[Setting],
        torques: &[Vec<Pair>],
    ) -> Result<DMatrix<f64>, Error> {
        let layout = Layout::of(self, window);
        let run = &self.runs[window.run];
        let times: Vec<f64> = run
            .plant
            .as_ref()
            .map_or(Vec::new(), |log| window.rows.iter().map(|row| log.time[*row]).collect());
        let mut all = edges(window);
        all.extend(&window.edges);
        let drive = Drive::new(run, window.drive.start(), &times, &all);
        let still = vec![[0.0; 2]; 1];
        let (base, _) = self.column(window, settings, &drive, &still)?;
        let mut columns = DMatrix::zeros(layout.len(), torques.len());
        for (place, torque) in torques.iter().enumerate() {
            let (moved, by) = self.column(window, settings, &drive, torque)?;
            if by > 0.0 {
                layout.column(&base, &moved, by, &mut columns, place);
            }
        }
        Ok(columns)
    }
}

impl Forced for PlantCut {
    fn states(&mut self, point: &[f64], at: &Nuisances) -> Result<Vec<Vec<State>>, Error> {
        self.begin_from(at);
        let settings = self.settings(point, None)?;
        self.windows
            .par_iter()
            .map(|window| {
                let middles: Vec<f64> =
                    edges(window).windows(2).map(|piece| 0.5 * (piece[0] + piece[1])).collect();
                let run = &self.runs[window.run];
                let drive = Drive::new(run, window.drive.start(), &middles, &window.edges);
                let pushes = window.pushes(&window.slack);
                let rows = simulate(&self.bench, &self.ports, &settings, &drive, &window.start, &pushes)?;
                Ok(rows.iter().map(state_of).collect())
            })
            .collect()
    }

    fn pushed(
        &mut self,
        point: &[f64],
        at: &Nuisances,
        torques: &[Vec<Vec<Pair>>],
    ) -> Result<Vec<DMatrix<f64>>, Error> {
        self.begin_from(at);
        let settings = self.settings(point, None)?;
        self.windows
            .par_iter()
            .zip(torques)
            .map(|(window, torques)| self.columns(window, &settings, torques))
            .collect()
    }
}
