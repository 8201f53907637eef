//! The pinhole, (1) and (2), between the mounting and the lens effects; pixels at the end.
//!
//! A squarely mounted camera looks along z at the scene's plane, at a distance D = f · field_of_view / 2, so that
//! half the field of view is one image unit.

use super::fold::FoldMap;
use crate::effects::{Effects, mounting::Rotation};
use crate::variables::{Scene, Sensor};
use fmi2_export::ModelError;

/// Everything that maps world points to pixels, worked out once a change of parameters.
#[derive(Debug, Clone)]
pub struct Projection {
    rotation: Rotation,
    focal_length: f64,
    distance: f64,
    effects: Effects,
    fold: FoldMap,
    half_width_px: f64,
    half_height_px: f64,
}

impl Projection {
    /// Checks the lens and prepares the map.
    ///
    /// # Errors
    /// A lens that folds the picture back inside the region of interest (see [`FoldMap`]).
    pub fn new(scene: &Scene, sensor: &Sensor, effects: &Effects) -> Result<Self, ModelError> {
        Ok(Self {
            rotation: effects.mounting.rotation(),
            focal_length: sensor.focal_length,
            distance: sensor.focal_length * scene.field_of_view / 2.0,
            effects: effects.clone(),
            fold: FoldMap::checked(effects)?,
            half_width_px: f64::from(sensor.width) / 2.0,
            half_height_px: f64::from(sensor.height) / 2.0,
        })
    }

    /// Ideal image point of a world point in the scene's plane; `None` behind the camera.
    #[inline]
    pub fn ideal_from_world(&self, (x, y): (f64, f64)) -> Option<(f64, f64)> {
        let [x_c, y_c, z_c] = self.rotation.camera_from_square([x, y, self.distance]);
        if z_c <= NEAREST * self.distance {
            return None;
        }
        let f = self.focal_length;
        Some((
            f * (x_c / z_c), // (1)
            f * (y_c / z_c), // (2)
        ))
    }

    /// Pixel coordinates (u right, v up, origin at the image centre) of an ideal image point.
    #[inline]
    pub fn pixel_from_ideal(&self, (u, v): (f64, f64)) -> (f64, f64) {
        let (u, v) = self.effects.placement.placed(self.effects.distorted(u, v));
        (self.half_width_px * u, self.half_height_px * v)
    }

    /// Pixel coordinates of a world point; `None` behind the camera.
    pub fn pixel_from_world(&self, world: (f64, f64)) -> Option<(f64, f64)> {
        self.ideal_from_world(world).map(|ideal| self.pixel_from_ideal(ideal))
    }

    /// Whether the lens images an ideal point: it lies inside the fold.
    pub fn images(&self, ideal: (f64, f64)) -> bool {
        self.fold.contains(ideal)
    }

    /// Half the size of the picture in pixels.
    pub fn half_size_px(&self) -> (f64, f64) {
        (self.half_width_px, self.half_height_px)
    }
}

/// Points nearer than this share of the scene's distance count as behind the camera.
const NEAREST: f64 = 1e-3;
