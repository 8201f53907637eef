//! What moving a candidate does to the image, as a function of the pose: the camera's, whichever runs show it. A search that is repeated
//! without some runs need not take it again.

use super::surface::Surface;
use super::{COLUMNS, Column, ImageCut};
use crate::rigs::acrobot::residual::studio::AREAS;
use nalgebra::Vector3;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The laws that are known, by a candidate's name and the displacement's bits.
#[derive(Clone, Default)]
pub struct Laws(BTreeMap<(&'static str, u64), Arc<Law>>);

/// A column at any pose.
pub(super) enum Law {
    /// A surface; of what blurs, beyond an earlier middle of the exposure.
    Smooth { surface: Surface, blurs: bool },
    /// A short exposure's: the polynomial of [`powers`], by which areas change beyond its earlier middle.
    Blurred { weights: Vector3<f64>, from: f64, by: f64 },
}

/// What the areas' change by a short exposure is a sum of; `square` is of the way in a frame's interval, px².
pub(super) fn powers(square: f64, one: f64, two: f64) -> Vector3<f64> {
    let (one, two) = (square * one * one, square * two * two);
    Vector3::new(two - one, two * two - one * one, two.powi(3) - one.powi(3))
}

impl Laws {
    /// Adds those of other searches.
    pub fn extend<'a>(&mut self, others: impl IntoIterator<Item = &'a Self>) {
        let others = others.into_iter().flat_map(|other| &other.0);
        self.0.extend(others.map(|(key, law)| (*key, law.clone())));
    }

    pub(super) fn get(&self, name: &'static str, by: f64) -> Option<Arc<Law>> {
        self.0.get(&(name, by.to_bits())).cloned()
    }

    pub(super) fn insert(&mut self, name: &'static str, by: f64, law: Law) -> Arc<Law> {
        let law = Arc::new(law);
        self.0.insert((name, by.to_bits()), law.clone());
        law
    }
}

impl ImageCut {
    /// A law's column at the frames.
    pub(super) fn along(&self, law: &Law) -> Column {
        let at = |place: usize| match law {
            Law::Smooth { surface, blurs } => {
                let late = if *blurs { self.late(place) } else { Some([0.0; COLUMNS.len()]) };
                let (smooth, late) = (surface.at(&self.frames[place].shot.end)?, late?);
                Some(std::array::from_fn(|s| smooth[s] + late[s]))
            }
            Law::Blurred { weights, from, by } => {
                let (mut column, ways) = (self.late(place)?, self.ways(place)?);
                for (circle, way) in ways.into_iter().enumerate() {
                    column[AREAS.start + circle] += weights.dot(&powers(way, *from, from + by)) / by;
                }
                Some(column)
            }
        };
        Arc::new((0..self.frames.len()).map(at).collect())
    }
}
