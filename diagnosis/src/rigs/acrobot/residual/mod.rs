//! Cutting the loop: each unit is fed what was measured at its inputs, and what comes out is compared.
//!
//! A [`Cut`] turns a point (a value for each candidate) into [`Block`]s: residuals with the columns of the
//! nuisances and of the candidates, all by moving things in the units themselves.
//!
//! - [`plant`]: commanded torque in, motion out, in short windows with free start states (multiple shooting).
//! - [`weak`]: accelerations at measured states, read as torques, for logs that the model misses by far more than
//!   their noise.
//! - [`image`]: motion in, image out, frame by frame.
//! - [`chain`]: commanded torque in, image out, where no encoder was logged.
//! - [`logged_motion`]: the motion for an image straight from encoders, where no torque was logged.

mod actuator;
pub mod chain;
pub mod forced_torques;
pub mod image;
pub mod logged_motion;
mod nuisances;
pub mod plant;
pub(crate) mod policy;
mod settings;
mod settled_actuator;
pub mod studio;
pub mod torque;
mod tracked;
pub mod trajectory;
pub mod weak;
mod weak_stretches;

use crate::error::Error;
use crate::rigs::acrobot::candidates::Candidate;
use crate::rigs::acrobot::channels::Measures;
use crate::statistics::linear::Cell;
pub use nuisances::Nuisances;
pub use tracked::Tracked;

/// A sensitivity (column of the Jacobian) that is wanted: candidate and displacement of its coordinate, over which the difference is taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Perturbation {
    /// Index of the candidate.
    pub candidate: usize,
    /// Displacement of x; the sensitivity is per unit of x.
    pub by: f64,
}

/// A measured signal that a cut compares.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    /// `instance.variable`.
    pub name: String,
    /// Unit for people.
    pub unit: &'static str,
    /// What it measures.
    pub measures: Measures,
    /// Standard deviation as the data set states it.
    pub known: Option<f64>,
    /// Standard deviation in use.
    pub sigma: f64,
    /// Least standard deviation that is believed: nothing is measured more finely.
    pub least: f64,
    /// By how much two right renderers differ in it at one place on the pixel lattice.
    pub tolerance: f64,
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
    /// Mean state (q1, q2, dq1, dq2) over the block, for saying where a residual sits.
    pub state: [f64; 4],
}

/// How results of a cut are to be judged: what it is by its logs and its unit, the same at every point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Policy {
    /// Images are compared, whose pixel lattice moves with every refit.
    pub lattice: bool,
    /// Poses are read off the images themselves.
    pub free_pose: bool,
    /// Poses are angles that were logged without their circles.
    pub reads_angles: bool,
    /// A linearisation needs no nuisances, so that another one gives the same.
    pub steady: bool,
    /// What the model lacks outweighs noise, so that gains must be judged by how well blocks agree.
    pub discrepancy_dominated: bool,
    /// By how much the log may be late before an effect with the same sensitivity is preferred to its clock, s.
    pub clock_doubt: f64,
    /// Size of the discrepancy that scattering timestamps of the torque explain, in its own unit.
    pub explained: f64,
    /// How well clocks of the log are known to go alike, s a second.
    pub tick_drift: f64,
}

impl Policy {
    /// Logs of a plant that is followed to within their noise.
    pub const USUAL: Self = Self {
        lattice: false,
        free_pose: false,
        reads_angles: false,
        steady: false,
        discrepancy_dominated: false,
        clock_doubt: 0.0,
        explained: 0.0,
        tick_drift: 0.0,
    };
}

/// What a linearisation or a chord step finds at a point.
#[derive(Debug)]
pub struct Linearised {
    /// Residuals with the sensitivities of nuisances and candidates.
    pub blocks: Vec<Block>,
    /// Where the nuisances are there.
    pub nuisances: Nuisances,
    /// Frames in which the data show what the model's camera doesn't find.
    pub unseen: usize,
}

/// One cut of the loop. Nuisances belong to the caller: a call begins from those that it is given and answers where they are at the
/// point, so that nothing is to be saved or restored in a cut.
pub trait Cut: Send + Sync {
    /// What it compares, for people.
    fn name(&self) -> &'static str;
    /// The signals, in the order of `Cell::signal`.
    fn signals(&self) -> &[Signal];
    /// Whether moving a candidate can change anything here.
    fn sees(&self, candidate: &Candidate) -> bool;
    /// How its results are judged.
    fn policy(&self) -> Policy;
    /// The nuisances as the data alone have them.
    fn initial(&self) -> Nuisances;
    /// Residuals at a point, with nuisances settled there, and the sensitivities to the perturbations.
    ///
    /// # Errors
    /// A unit failed.
    fn linearise(
        &mut self,
        at: &[f64],
        perturbations: &[Perturbation],
        from: &Nuisances,
    ) -> Result<Linearised, Error>;
    /// Residuals at a point by the sensitivities of the nuisances that `from` was linearised with: enough while a fit goes on, since the
    /// projection takes care of the rest.
    ///
    /// # Errors
    /// A unit failed.
    fn chord(
        &mut self,
        at: &[f64],
        perturbations: &[Perturbation],
        from: &Nuisances,
    ) -> Result<Linearised, Error>;
}
