//! Cutting the loop: each unit is fed what was measured at its inputs, and what comes out is compared.
//!
//! A [`Cut`] turns a point (a value for each candidate) into [`Block`]s: residuals with the columns of the
//! nuisances and of the candidates, all by moving things in the units themselves.
//!
//! - [`plant`]: commanded torque in, motion out, in short windows with free start states (multiple shooting).
//! - [`weak`]: accelerations at measured states, read as torques, for logs that the model misses by far more than
//!   their noise.
//! - [`image`]: motion in, picture out, frame by frame.
//! - [`chain`]: commanded torque in, picture out, where no encoder was logged.
//! - [`logged`]: the motion for a picture straight from encoders, where no torque was logged.

mod actuator;
pub mod chain;
pub mod forced;
pub mod image;
pub mod logged;
pub mod picture;
pub mod plant;
mod settings;
mod smooth;
pub mod torque;
pub mod trajectory;
pub mod weak;

use crate::error::Error;
use crate::rigs::acrobot::candidates::Candidate;
use crate::statistics::linear::Cell;

/// A column that is wanted: candidate and displacement of its coordinate, over which the secant is taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Probe {
    /// Index of the candidate.
    pub candidate: usize,
    /// Displacement of x; the column is per unit of x.
    pub by: f64,
}

/// A measured signal that a cut compares.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    /// `instance.variable`.
    pub name: String,
    /// Unit for people.
    pub unit: &'static str,
    /// Standard deviation as the data set states it.
    pub known: Option<f64>,
    /// Standard deviation in use.
    pub sigma: f64,
    /// Least standard deviation that is believed: nothing is measured more finely.
    pub least: f64,
    /// By how much two honest renderers differ in it at one place on the pixel lattice.
    pub honest: f64,
}

/// Rows that belong together in time: the independent unit of the statistics.
#[derive(Debug, Clone)]
pub struct Block {
    /// Index of the run.
    pub run: usize,
    /// First scored time in s.
    pub from: f64,
    /// Last scored time in s.
    pub to: f64,
    /// Sets of rows that share nuisances.
    pub cells: Vec<Cell>,
    /// Mean state (q1, q2, dq1, dq2) over the block, for saying where a rest sits.
    pub state: [f64; 4],
}

/// One cut of the loop.
pub trait Cut: Send + Sync {
    /// What it compares, for people.
    fn name(&self) -> &'static str;
    /// The signals, in the order of `Cell::signal`.
    fn signals(&self) -> &[Signal];
    /// Whether moving a candidate can change anything here.
    fn sees(&self, candidate: &Candidate) -> bool;
    /// Residuals at a point and the columns of the probes there. `quick` leaves the nuisances where an earlier call
    /// found them, with their columns: enough while a fit goes on, since the projection takes care of the rest.
    ///
    /// # Errors
    /// A unit failed.
    fn linearise(&mut self, point: &[f64], probes: &[Probe], quick: bool) -> Result<Vec<Block>, Error>;
    /// Puts the nuisances back to where the last look that was not quick left them, so that a fit that went astray
    /// doesn't spoil the next one.
    fn back(&mut self);
    /// Remembers the nuisances as they are now, for `recall`.
    fn remember(&mut self) {}
    /// Puts the nuisances where they were when they were remembered: looks at other models may have led them far away, to
    /// where a machine that moves fast doesn't find back.
    fn recall(&mut self) {}
    /// Holds the nuisances as they are now, for `release`: where each look settles them anew, a refused one must leave no trace.
    fn hold(&mut self) {}
    /// Puts them where they were when they were held.
    fn release(&mut self) {}
    /// Whether nuisances were left that a full look may settle better.
    fn hopeful(&self) -> bool {
        true
    }
    /// Whether pictures are compared, whose pixel lattice moves with every refit.
    fn lattice(&self) -> bool {
        false
    }
    /// By how much the log may be late before an effect that looks like it stands before its clock, s.
    fn clock_doubt(&self) -> f64 {
        0.0
    }
    /// Frames in which the data show what the model's camera didn't find at the last look.
    fn unseen(&self) -> usize {
        0
    }
    /// Whether poses are read off the pictures themselves.
    fn free_pose(&self) -> bool {
        false
    }
    /// Whether poses are angles that were logged without their circles.
    fn reads_angles(&self) -> bool {
        false
    }
    /// Whether a look leaves nothing behind, so that looking again gives the same.
    fn steady(&self) -> bool {
        false
    }
    /// Forgets the nuisances: the next look begins from the data again.
    fn afresh(&mut self) {}
    /// Whether what the model lacks outweighs noise here, so that gains must be judged by how well blocks agree.
    fn outweighed(&self) -> bool {
        false
    }
    /// Size of the discrepancy that scattering time stamps of the torque explain.
    fn explained(&self) -> f64 {
        0.0
    }
    /// What a size of 1 of the model discrepancy means, for people.
    fn discrepancy_unit(&self) -> &'static str;
}
