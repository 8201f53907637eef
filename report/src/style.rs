//! How lines are drawn: strokes, steps, marks.

use serde::{Deserialize, Serialize};

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Style {
    /// Connected points.
    Solid,
    /// Connected points, dashed.
    Dashed,
    /// Connected points, dotted.
    Dotted,
    /// Each value held until the next point: what changes at once, as Booleans and Integers do.
    Held(Stroke),
    /// Each point by itself.
    Points(Marks),
}

/// The stroke of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Stroke {
    /// Without gaps.
    Solid,
    /// Dashed.
    Dashed,
    /// Dotted.
    Dotted,
}

impl Style {
    /// The same stroke, with values that are held from point to point.
    #[must_use]
    pub fn held(self) -> Self {
        match self {
            Self::Solid => Self::Held(Stroke::Solid),
            Self::Dashed => Self::Held(Stroke::Dashed),
            Self::Dotted => Self::Held(Stroke::Dotted),
            other => other,
        }
    }

    /// The same stroke between points that are connected.
    pub(crate) fn connected(self) -> Self {
        match self {
            Self::Held(Stroke::Solid) => Self::Solid,
            Self::Held(Stroke::Dashed) => Self::Dashed,
            Self::Held(Stroke::Dotted) => Self::Dotted,
            other => other,
        }
    }
}

/// The mark of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Marks {
    /// A disc.
    Dot,
    /// A diagonal cross.
    Cross,
}
