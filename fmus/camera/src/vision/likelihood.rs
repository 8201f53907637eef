//! Maximum likelihood of a circle's centre, given the grey levels around it.
//!
//! The model is the disc of nominal size, defocused as the camera is, in noise of the camera's σ, cut to 0..255: a
//! pixel at 0 or 255 says only that the noise went at least so far. The log-likelihood of each pixel is concave in
//! its mean, so Newton's method from the grey centroid settles in a few steps. What the lens does to the disc's size
//! is not modelled; it is symmetric and hardly moves the centre. *Deviations*: beyond the paper.

use super::{Component, estimator::View};
use crate::effects::Effects;
use crate::geometry::{Outline, UnitCircle};
use crate::photometry::{Area, Coverage, defocus::blur};
use crate::variables::{Scene, Sensor};

/// Newton steps; from 0.05 px off, three reach 1e-4 px.
const STEPS: usize = 4;
/// Half the distance of the two discs whose difference is the model's derivative, in pixels.
const HALF_DIFFERENCE: f64 = 0.05;
/// Smallest deviation assumed: rounding to whole grey levels, and what the model leaves out.
const LEAST_DEVIATION: f64 = 1.0;

/// What the camera sees of a circle.
#[derive(Debug, Clone, Copy)]
pub struct Seen<'a> {
    /// The region above the threshold.
    pub component: &'a Component,
    /// The frame.
    pub view: &'a View<'a>,
    /// The window that the region lies in.
    pub window: &'a Area,
}

/// What is known of the circle and the camera.
#[derive(Debug, Clone, Copy)]
pub struct Expected<'a> {
    /// Size of the circle, and its grey levels.
    pub scene: &'a Scene,
    /// Size of the frame.
    pub sensor: &'a Sensor,
    /// Defocus and noise.
    pub effects: &'a Effects,
}

/// The model's disc, wherever it lies.
#[derive(Clone, Copy)]
struct Disc<'a> {
    radii: (f64, f64),
    /// The pixels that are compared.
    area: &'a Area,
    scene: &'a Scene,
    effects: &'a Effects,
}

/// The model with its working space.
#[derive(Debug, Clone, Default)]
pub struct Likelihood {
    circle: Option<(f64, UnitCircle)>,
    outline: Outline,
    coverage: Coverage,
    scratch: Vec<f32>,
    middle: Vec<f32>,
    sides: [Vec<f32>; 4],
}

impl Likelihood {
    /// Improves a centre in raster coordinates.
    pub fn refine(&mut self, start: (f64, f64), seen: &Seen<'_>, expected: &Expected<'_>) -> (f64, f64) {
        let Seen { component, view, window } = *seen;
        let Expected { scene, sensor, effects } = *expected;
        let share = scene.circle_radius / scene.field_of_view;
        let radii = (share * f64::from(sensor.width), share * f64::from(sensor.height));
        let largest = radii.0.max(radii.1);
        if self.circle.as_ref().is_none_or(|(radius, _)| *radius != largest) {
            self.circle = Some((largest, UnitCircle::for_radius_px(largest)));
        }
        let reach = effects.defocus.passes as usize + 2 * view.row_step;
        let area = component.bounds.grown(reach, window.x1, window.y1);
        let area = Area { x0: area.x0.max(window.x0), y0: area.y0.max(window.y0), ..area };
        let disc = Disc { radii, area: &area, scene, effects };
        let sigma = effects.noise.deviation.max(LEAST_DEVIATION);
        let (mut x, mut y) = start;
        for _ in 0..STEPS {
            let h = HALF_DIFFERENCE;
            let places = [(x, y), (x + h, y), (x - h, y), (x, y + h), (x, y - h)];
            for (which, place) in places.into_iter().enumerate() {
                self.model(which, place, disc);
            }
            let (dx, dy) = self.newton(&area, component, view, sigma);
            // The start is good to a fraction of a pixel; a longer step means that this is no disc.
            if !(dx.abs() < 1.0 && dy.abs() < 1.0) {
                return start;
            }
            (x, y) = (x + dx, y + dy);
        }
        (x, y)
    }

    /// Grey levels of a disc at a place, into the middle (0) or a side.
    fn model(&mut self, which: usize, place: (f64, f64), disc: Disc<'_>) {
        let Disc { radii, area, scene, effects } = disc;
        let Some((_, circle)) = &self.circle else { return };
        let passes = effects.defocus.passes as usize;
        // A margin of background, so that the border of the patch is that of no circle.
        let (width, height) = (area.width() + 2 * passes, area.height() + 2 * passes);
        let origin = (area.x0 as f64 - passes as f64, area.y0 as f64 - passes as f64);
        self.outline.clear();
        self.outline.add_disc(circle, (place.0 - origin.0, place.1 - origin.1), radii);
        self.coverage.begin(width, height);
        self.coverage.add(&self.outline.xs, &self.outline.ys, (0.0, 0.0), false);
        self.coverage.finish(1.0);
        let patch = if which == 0 { &mut self.middle } else { &mut self.sides[which - 1] };
        let (dark, contrast) = (scene.background as f32, (scene.foreground - scene.background) as f32);
        patch.clear();
        for row in 0..height {
            patch.extend(self.coverage.row(row).iter().map(|share| dark + contrast * share));
        }
        blur(patch, width, &mut self.scratch, &effects.defocus);
        if passes > 0 {
            for row in 0..area.height() {
                let from = (row + passes) * width + passes;
                patch.copy_within(from..from + area.width(), row * area.width());
            }
            patch.truncate(area.width() * area.height());
        }
    }

    /// One step of Newton's method.
    fn newton(&self, area: &Area, component: &Component, view: &View<'_>, sigma: f64) -> (f64, f64) {
        let (mut score, mut info) = ([0.0; 2], [0.0; 3]);
        let first = area.y0 + (component.bounds.y0 - area.y0) % view.row_step;
        for y in (first..area.y1).step_by(view.row_step) {
            let start = (y - area.y0) * area.width();
            for (column, grey) in view.picture.row(y)[area.x0..area.x1].iter().enumerate() {
                let at = start + column;
                let slope = |plus: usize, minus: usize| {
                    f64::from(self.sides[plus][at] - self.sides[minus][at]) / (2.0 * HALF_DIFFERENCE)
                };
                let (a, b) = (slope(0, 1), slope(2, 3));
                if a == 0.0 && b == 0.0 {
                    continue;
                }
                let (pull, stiffness) = pixel(*grey, f64::from(self.middle[at]), sigma);
                score = [score[0] + pull * a, score[1] + pull * b];
                info =
                    [info[0] + stiffness * a * a, info[1] + stiffness * a * b, info[2] + stiffness * b * b];
            }
        }
        let determinant = info[0] * info[2] - info[1] * info[1];
        (
            (info[2] * score[0] - info[1] * score[1]) / determinant,
            (info[0] * score[1] - info[1] * score[0]) / determinant,
        )
    }
}

/// First derivative of a pixel's log-likelihood with respect to its mean, and the negative of the second.
fn pixel(grey: u8, mean: f64, sigma: f64) -> (f64, f64) {
    let (z, sign) = match grey {
        0 => ((0.5 - mean) / sigma, -1.0),
        255 => ((mean - 254.5) / sigma, 1.0),
        _ => return ((f64::from(grey) - mean) / (sigma * sigma), 1.0 / (sigma * sigma)),
    };
    // λ = φ(z)/Φ(z), the inverse of Mills' ratio, and λ (λ + z); their asymptotes where Φ has no digits left.
    let (lambda, stiffness) = if z < -25.0 {
        (-z, 1.0)
    } else {
        let phi = libm::exp(-0.5 * z * z) / libm::sqrt(core::f64::consts::TAU);
        let lambda = phi / (0.5 * libm::erfc(-z * core::f64::consts::FRAC_1_SQRT_2));
        (lambda, lambda * (lambda + z))
    };
    (sign * lambda / sigma, stiffness / (sigma * sigma))
}

#[cfg(test)]
mod tests {
    use super::pixel;

    /// Logarithm of the probability of a grey level, but for what does not depend on the mean.
    fn log_likelihood(grey: u8, mean: f64, sigma: f64) -> f64 {
        let below = |z: f64| (0.5 * libm::erfc(-z * core::f64::consts::FRAC_1_SQRT_2)).ln();
        match grey {
            0 => below((0.5 - mean) / sigma),
            255 => below((mean - 254.5) / sigma),
            _ => -0.5 * ((f64::from(grey) - mean) / sigma).powi(2),
        }
    }

    #[test]
    fn value_a_pixel_pulls_as_the_derivatives_of_its_likelihood_say() {
        for sigma in [1.0, 3.7, 15.0] {
            for grey in [0, 1, 100, 254, 255] {
                for mean in (0..=255).step_by(5).map(f64::from) {
                    let (slope, stiffness) = pixel(grey, mean, sigma);
                    // Either asymptote is λ = −z: off by 1/z² of it.
                    let z = if grey == 0 { 0.5 - mean } else { mean - 254.5 } / sigma;
                    let (expected, bend) = if (grey == 0 || grey == 255) && z < -20.0 {
                        ((if grey == 0 { z } else { -z }) / sigma, 1.0 / (sigma * sigma))
                    } else {
                        let h = 1e-3 * sigma;
                        let at = |k: f64| log_likelihood(grey, mean + k * h, sigma);
                        ((at(1.0) - at(-1.0)) / (2.0 * h), (2.0 * at(0.0) - at(1.0) - at(-1.0)) / (h * h))
                    };
                    // Differences over 1e-3 deviations of logarithms of up to 200: 3e-8 of a second derivative of 1e-6.
                    let (scale, within) = (1.0 / sigma, if z < -20.0 { 3e-3 } else { 1e-5 });
                    let off = (slope - expected).abs() / (expected.abs() + scale);
                    assert!(off < within, "{grey} {mean} {sigma}: {slope}, not {expected}");
                    let off = (stiffness - bend).abs() / (scale * scale);
                    assert!(off < within.max(1e-4), "{grey} {mean} {sigma}: {stiffness}, not {bend}");
                }
            }
        }
    }
}
