//! Columns of a run's logs: a row each. A new column of a data set is a new row; what it measures says who reads it.

use std::ops::Range;

/// A log of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum File {
    /// `camera.csv`, a row a delivered frame.
    Camera,
    /// `controller.csv`, held from row to row.
    Controller,
    /// `plant.csv`, encoders or motion capture.
    Plant,
}

impl File {
    /// The unit whose variables it holds.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Camera => "camera",
            Self::Controller => "controller",
            Self::Plant => "plant",
        }
    }
}

/// What a column measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measures {
    /// A coordinate of a circle's centroid.
    Centroid,
    /// Area of a circle.
    Area,
    /// An angle that the rig's own vision read.
    VisionAngle,
    /// An angle of a link.
    Angle,
    /// Its rate.
    Rate,
    /// The torque that arrives at the joint.
    AppliedTorque,
    /// A torque that was commanded.
    Command,
    /// A torque that a model lacks: no log holds it.
    LackingTorque,
    /// Whether a row of the image holds anything: never masked itself.
    Frame,
    /// Nothing that is compared.
    Other,
}

/// What is known of a column's noise beforehand.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Noise {
    /// Standard deviation to begin with where none is stated; of a torque, at an arm of inertia scale 1.
    pub guess: f64,
    /// Least standard deviation that is believed, with the same scale.
    pub least: f64,
    /// By how much two right renderers differ at one place on the pixel lattice.
    pub tolerance: f64,
}

/// A column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Channel {
    /// Where it is logged.
    pub file: File,
    /// Its name there, which is that of the unit's variable.
    pub column: &'static str,
    /// Its unit of measurement, for people; empty: a number without one.
    pub unit: &'static str,
    /// What it measures.
    pub measures: Measures,
    /// Its noise, if it is compared with what the model gives.
    pub noise: Option<Noise>,
}

/// A column of `camera.csv` that is compared.
const fn image(column: &'static str, measures: Measures, guess: f64) -> Channel {
    let (unit, tolerance) = match measures {
        Measures::Centroid => ("px", CENTROIDS_APART),
        Measures::Area => ("px", AREAS_APART),
        _ => ("rad", ANGLES_APART),
    };
    let noise = Some(Noise { guess, least: 0.0, tolerance });
    Channel { file: File::Camera, column, unit, measures, noise }
}

/// A column of `plant.csv` that is compared.
const fn motion(
    column: &'static str,
    unit: &'static str,
    measures: Measures,
    guess: f64,
    least: f64,
) -> Channel {
    let noise = Some(Noise { guess, least, tolerance: 0.0 });
    Channel { file: File::Plant, column, unit, measures, noise }
}

/// A column that is read, and not compared.
const fn told(file: File, column: &'static str, unit: &'static str, measures: Measures) -> Channel {
    Channel { file, column, unit, measures, noise: None }
}

/// By how much centroids of two right renderers differ at one place on the lattice, px: they cut the rim's pixels
/// differently, and a pixel near the threshold is in or out. Measured against a third one: docs/log/renderers.md.
pub const CENTROIDS_APART: f64 = 0.006;
/// By how much areas of two right renderers differ at one place on the lattice, px.
pub const AREAS_APART: f64 = 0.06;
/// By how much angles that are read off their images differ there, rad: a link is 160 px long.
pub const ANGLES_APART: f64 = 5e-5;

use File::{Camera, Controller, Plant};
use Measures::{Angle, AppliedTorque, Area, Centroid, Command, Frame, Other, Rate, VisionAngle};

/// All columns. Least standard deviations of the motion are what encoders of 19 bits count, and no arm here has better: logs of a
/// simulation have no noise at all, and what is left there, of integrators and of starts within stiction, would be a finding.
#[rustfmt::skip]
pub const CHANNELS: &[Channel] = &[
    image("u1", Centroid, 0.05),
    image("v1", Centroid, 0.05),
    image("u2", Centroid, 0.08),
    image("v2", Centroid, 0.05),
    image("u3", Centroid, 0.08),
    image("v3", Centroid, 0.06),
    image("area1", Area, 0.7),
    image("area2", Area, 1.0),
    image("area3", Area, 1.0),
    told(Camera, "valid", "", Frame),
    told(Camera, "frame", "", Frame),
    told(Camera, "t_mid", "s", Other),
    image("q1_est", VisionAngle, 5e-4),
    image("q2_est", VisionAngle, 5e-4),
    told(Camera, "dq1_est", "rad/s", Other),
    told(Camera, "dq2_est", "rad/s", Other),
    told(Controller, "tau", "N·m", Command),
    told(Controller, "z_desired", "", Other),
    told(Controller, "tau_1", "N·m", Command),
    told(Controller, "z_hat", "", Other),
    motion("q1", "rad", Angle, 1e-3, 1e-5),
    motion("q2", "rad", Angle, 1e-3, 1e-5),
    motion("dq1", "rad/s", Rate, 5e-2, 1e-4),
    motion("dq2", "rad/s", Rate, 5e-2, 1e-4),
    motion("tau_applied", "N·m", AppliedTorque, 1e-2, 1e-5),
    told(Plant, "z", "", Other),
    told(Plant, "contact", "", Other),
];

/// Names of all columns that a log may hold.
pub fn columns(file: File) -> Vec<&'static str> {
    CHANNELS.iter().filter(|channel| channel.file == file).map(|channel| channel.column).collect()
}

/// How many columns of a log are compared.
pub const fn count(file: File) -> usize {
    let (mut count, mut row) = (0, 0);
    while row < CHANNELS.len() {
        count += (CHANNELS[row].file as u8 == file as u8 && CHANNELS[row].noise.is_some()) as usize;
        row += 1;
    }
    count
}

/// The compared columns of a log, in the table's order.
pub const fn compared<const N: usize>(file: File) -> [Channel; N] {
    let mut found = [CHANNELS[0]; N];
    let (mut place, mut row) = (0, 0);
    while row < CHANNELS.len() {
        if CHANNELS[row].file as u8 == file as u8 && CHANNELS[row].noise.is_some() {
            found[place] = CHANNELS[row];
            place += 1;
        }
        row += 1;
    }
    assert!(place == N, "so many columns of the log are compared");
    found
}

/// Names of channels.
pub const fn names<const N: usize>(channels: &[Channel; N]) -> [&'static str; N] {
    let mut all = [""; N];
    let mut place = 0;
    while place < N {
        all[place] = channels[place].column;
        place += 1;
    }
    all
}

/// Where among channels those stand that measure something: next to each other in the table.
pub const fn places(channels: &[Channel], measures: Measures) -> Range<usize> {
    let mut from = 0;
    while from < channels.len() && channels[from].measures as u8 != measures as u8 {
        from += 1;
    }
    let mut to = from;
    while to < channels.len() && channels[to].measures as u8 == measures as u8 {
        to += 1;
    }
    from..to
}

/// Standard deviation to begin with of what measures something, in its unit; of several kinds of columns the first one's.
pub const fn guess_of(measures: Measures) -> f64 {
    match CHANNELS[places(CHANNELS, measures).start].noise {
        Some(noise) => noise.guess,
        None => 0.0,
    }
}

/// Columns of a log that measure something.
pub fn measuring(file: File, measures: Measures) -> Vec<&'static str> {
    let own = |channel: &&Channel| channel.file == file && channel.measures == measures;
    CHANNELS.iter().filter(own).map(|channel| channel.column).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_motion_begins_with_its_state() {
        let own: [Channel; count(Plant)] = compared(Plant);
        assert_eq!(names(&own)[..4], ["q1", "q2", "dq1", "dq2"]);
        assert_eq!((places(&own, Angle), places(&own, Rate)), (0..2, 2..4));
    }

    #[test]
    fn every_column_stands_once_and_beside_its_like() {
        for (row, channel) in CHANNELS.iter().enumerate() {
            let again = CHANNELS[row + 1..]
                .iter()
                .find(|other| other.file == channel.file && other.column == channel.column);
            assert_eq!(again, None);
        }
        // a gap between two of a kind would cut a range of places short
        for file in [Camera, Plant] {
            let own: Vec<Channel> =
                CHANNELS.iter().filter(|one| one.file == file && one.noise.is_some()).copied().collect();
            for channel in &own {
                let range = places(&own, channel.measures);
                assert_eq!(range.len(), own.iter().filter(|one| one.measures == channel.measures).count());
            }
        }
    }
}
