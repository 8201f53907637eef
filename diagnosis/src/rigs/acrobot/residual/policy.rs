//! Numbers by which torques and poses are read off logs, each with its reason.

/// How much is enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    /// Three standard deviations of an angle read off a picture, rad.
    pub near: f64,
    /// Lattice of such an angle, rad: a twentieth of a pixel over the length of a link.
    pub place: f64,
    /// Length of a stretch, s; at least so many rows; the next one begins half of it later.
    pub length: f64,
    /// Most time between states at which the unit is asked, s.
    pub grid: f64,
    pub around_rows: usize,
    /// So many times a stretch's usual length may these rows take: at 20 rows a second they do once.
    pub seen: f64,
    pub torn_share: f64,
    /// Standard deviation of an angle where none is stated, rad.
    pub first_guess: f64,
    /// Torques this many typical sizes out count less (Huber).
    pub outlying: f64,
    /// Stretches that overlap belong to one block, s.
    pub block: f64,
    /// Logs shorter than this in all, s, are cut into so many blocks, down to a stretch each: a statistic over n blocks is at
    /// most √n, and none below 4.5 counts.
    pub short: f64,
    pub blocks: f64,
    pub short_block: f64,
    /// Longest step between readings, s.
    pub step: f64,
    /// Fewest rows of a stretch.
    pub fewest: usize,
    /// Pictures of a frame that are averaged where the sensor is noisy.
    pub averaged: i32,
}

/// Those in force.
pub const RESIDUAL: Residual = Residual {
    near: 3e-3,
    place: 3e-4,
    length: 0.3,
    grid: 0.008,
    around_rows: 7,
    seen: 1.1,
    torn_share: 0.06,
    first_guess: 1e-3,
    outlying: 4.0,
    block: 1.0,
    short: 30.0,
    blocks: 40.0,
    short_block: 0.15,
    step: 0.004,
    fewest: 6,
    averaged: 4,
};
