//! The motion that the camera knows of: poses between communication points.
//!
//! Between two communication points the pose is the cubic Hermite polynomial of the poses and rates at both; if the
//! master gives input derivatives, it is the straight line from the earlier one. Before the start it is extrapolated
//! with the rates of the start.

use crate::scene::Pose;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// Pose and rates at a time.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Motion {
    /// Time in s.
    pub time: f64,
    /// Pose in rad.
    pub pose: Pose,
    /// Rates of the angles in rad/s.
    pub rates: Pose,
}

impl Motion {
    /// The pose on the straight line through this one.
    pub fn extrapolated(&self, time: f64) -> Pose {
        let dt = time - self.time;
        Pose {
            link1_angle: self.pose.link1_angle + self.rates.link1_angle * dt,
            link2_angle: self.pose.link2_angle + self.rates.link2_angle * dt,
        }
    }
}

/// The motion between two communication points.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Segment {
    /// Where it begins.
    pub from: Motion,
    /// Where it ends.
    pub to: Motion,
}

impl Segment {
    /// The pose at a time within the segment.
    pub fn pose(&self, time: f64) -> Pose {
        let h = self.to.time - self.from.time;
        let s = ((time - self.from.time) / h).clamp(0.0, 1.0);
        // Hermite's cubic: from + s·(h m0 + s·(3Δ − 2 h m0 − h m1 + s·(h m0 + h m1 − 2Δ)))
        let cubic = |p0: f64, p1: f64, m0: f64, m1: f64| {
            let (change, m0, m1) = (p1 - p0, h * m0, h * m1);
            p0 + s * (m0 + s * (3.0 * change - 2.0 * m0 - m1 + s * (m0 + m1 - 2.0 * change)))
        };
        let (a, b) = (&self.from, &self.to);
        Pose {
            link1_angle: cubic(
                a.pose.link1_angle,
                b.pose.link1_angle,
                a.rates.link1_angle,
                b.rates.link1_angle,
            ),
            link2_angle: cubic(
                a.pose.link2_angle,
                b.pose.link2_angle,
                a.rates.link2_angle,
                b.rates.link2_angle,
            ),
        }
    }
}

/// The motion as far back as an exposure can reach.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct History {
    newest: Motion,
    segments: VecDeque<Segment>,
}

impl History {
    /// Starts with the motion at the start time.
    pub fn starting(at: Motion) -> Self {
        Self { newest: at, segments: VecDeque::new() }
    }

    /// Where the motion was at the last communication point.
    pub fn newest(&self) -> Motion {
        self.newest
    }

    /// Adds the motion up to the next communication point.
    pub fn push(&mut self, segment: Segment) {
        self.segments.push_back(segment);
        self.newest = segment.to;
    }

    /// Forgets segments that end before `time`.
    pub fn forget_before(&mut self, time: f64) {
        while self.segments.front().is_some_and(|segment| segment.to.time < time) {
            self.segments.pop_front();
        }
    }

    /// The pose at a time up to the newest.
    pub fn pose(&self, time: f64) -> Pose {
        // The search is short from the end: exposures end close to the newest point.
        match self.segments.iter().rev().find(|segment| segment.from.time <= time) {
            Some(segment) => segment.pose(time),
            None => self.segments.front().map_or(self.newest, |segment| segment.from).extrapolated(time),
        }
    }
}
