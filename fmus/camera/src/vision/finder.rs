//! Regions of a thresholded frame that may be circles, with their centres: what frames that were rendered and frames
//! that were recorded have in common.

use super::{Component, Estimators, Feature, Labeller, View, select};
use crate::effects::Effects;
use crate::variables::{Scene, Sensor};

/// Finds circles; keeps its working space from frame to frame.
#[derive(Debug, Clone, Default)]
pub struct Finder {
    labeller: Labeller,
    estimators: Estimators,
    components: Vec<Component>,
    features: Vec<Feature>,
}

impl Finder {
    /// The regions that may be circles, in reading order.
    pub fn find(&mut self, view: &View<'_>, scene: &Scene, sensor: &Sensor, effects: &Effects) -> &[Feature] {
        let Self { labeller, estimators, components, features } = self;
        labeller.label(view.mask, view.windows, view.row_step, components);
        features.clear();
        let circles = components.iter().filter(|component| select::may_be_circle(component, sensor));
        features.extend(circles.map(|component| estimators.feature(component, view, scene, sensor, effects)));
        features
    }

    /// All regions of the last frame at or above the threshold, in reading order.
    pub fn regions(&self) -> &[Component] {
        &self.components
    }
}
