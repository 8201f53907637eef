//! The pinhole, (1) and (2), between the mounting and the lens effects; pixels at the end.
//!
//! A squarely mounted camera looks along z at the scene's plane, at a distance D = f · field_of_view / 2, so that
//! half the field of view is one image unit.

use super::fold::FoldMap;
use crate::effects::Effects;
use crate::effects::mounting::{Mounting, Rotation};
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
    plain: bool,
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
            plain: effects.lens_parameters().iter().all(|(_, value)| *value == 0.0)
                && effects.mounting == Mounting::default(),
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

    /// Raster coordinates (x right from the left border, y down from the upper border) of an ideal image point.
    #[inline]
    pub fn raster_from_ideal(&self, ideal: (f64, f64)) -> (f64, f64) {
        let (u, v) = self.pixel_from_ideal(ideal);
        (self.half_width_px + u, self.half_height_px - v)
    }

    /// Raster coordinates of a world point; `None` behind the camera.
    #[inline]
    pub fn raster_from_world(&self, world: (f64, f64)) -> Option<(f64, f64)> {
        self.ideal_from_world(world).map(|ideal| self.raster_from_ideal(ideal))
    }

    /// Pixels a world unit, horizontally and vertically, if the picture is nothing but a scaled one: the lens
    /// does not distort and the mounting is square.
    pub fn plain_scale(&self) -> Option<(f64, f64)> {
        self.plain.then(|| {
            let scale = self.effects.placement.scale * self.image_per_world();
            (self.half_width_px * scale, self.half_height_px * scale)
        })
    }

    /// Image units a world unit on the axis, before the lens.
    pub fn image_per_world(&self) -> f64 {
        self.focal_length / self.distance
    }

    /// How much larger than at the axis of an ideal lens a small length can look within the region of interest.
    pub fn largest_magnification(&self) -> f64 {
        let (h, steps) = (1e-3, 16);
        let mut largest: f64 = 1.0;
        for i in -steps..=steps {
            for j in -steps..=steps {
                let (u, v) = (f64::from(i) / f64::from(steps), f64::from(j) / f64::from(steps));
                let at = |u, v| self.effects.distorted(u, v);
                let ((a, b), (c, d), (e, f)) = (at(u, v), at(u + h, v), at(u, v + h));
                let square = |x: f64, y: f64| (x * x + y * y) / (h * h);
                largest = largest.max(square(c - a, d - b).max(square(e - a, f - b)).sqrt());
            }
        }
        largest.min(4.0) * self.effects.placement.scale
    }

    /// Whether the lens images an ideal point: it lies inside the fold.
    pub fn images(&self, ideal: (f64, f64)) -> bool {
        self.fold.contains(ideal)
    }
}

/// Points nearer than this share of the scene's distance count as behind the camera.
const NEAREST: f64 = 1e-3;
