//! How the centre of a region is found: the paper's binary centroid, or from the grey levels around it.

use super::likelihood::{Expected, Likelihood, Seen};
use super::{Component, Feature, grey};
use crate::effects::Effects;
use crate::photometry::{Area, Mask, Plane};
use crate::variables::{Scene, Sensor};

/// A thresholded frame as the estimators see it.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    /// Grey levels; meaningful within the windows.
    pub picture: &'a Plane<u8>,
    /// At or above the threshold.
    pub mask: &'a Mask,
    /// Where circles can be.
    pub windows: &'a [Area],
    /// From one row of the field to the next.
    pub row_step: usize,
}

/// The estimators with their working space.
#[derive(Debug, Clone, Default)]
pub struct Estimators {
    likelihood: Likelihood,
}

/// How far from a circle's outline the chosen estimator looks, in pixels, beyond the reach of the defocus.
pub fn margin(sensor: &Sensor) -> usize {
    let row_step = if sensor.interlaced { 2 } else { 1 };
    if sensor.estimator == 0 { 0 } else { grey::DILATION * row_step }
}

impl Estimators {
    /// The centre and area of a region, by the estimator chosen.
    pub fn feature(
        &mut self,
        component: &Component,
        view: &View<'_>,
        scene: &Scene,
        sensor: &Sensor,
        effects: &Effects,
    ) -> Feature {
        let binary = Feature::binary(component, sensor);
        if sensor.estimator == 0 {
            return binary;
        }
        let holds = |window: &&Area| window.overlaps(&component.bounds);
        let Some(window) = view.windows.iter().find(holds) else { return binary };
        let Some(centre) = grey::centroid(component, view, window, scene) else { return binary };
        let centre = match sensor.estimator {
            2 => {
                let seen = Seen { component, view, window };
                self.likelihood.refine(centre, &seen, &Expected { scene, sensor, effects })
            }
            _ => centre,
        };
        Feature { centre_px: super::centroid::pixel_from_raster(centre, sensor), ..binary }
    }
}
