//! Where a lens folds the picture back on itself, and the refusal of lenses that do so inside the picture.
//!
//! A strong negative displacement maps two ideal points to one picture point; there the Jacobian of
//! (u, v) ↦ (u + δu, v + δv) is no longer positive. The place of the fold is searched along rays from the optical
//! axis. A lens is refused if it folds within [`INTEREST`] = 1 image unit of the axis: the circle inscribed in the
//! paper's area of interest −1 ≤ u, v ≤ 1 (Section 2.1). Its corners are left out, for the paper's own radial
//! values fold there (k₁ = −0.3 at r = 1.054) and no balancing robot reaches them (r ≤ 0.72 on the manifold). A
//! circle that does get beyond the fold is not imaged, rather than showing a mirrored ghost.

use crate::effects::Effects;
use fmi2_export::ModelError;

/// Radius in image units within which a lens must not fold.
pub const INTEREST: f64 = 1.0;
const RAYS: usize = 64;
/// Radii of the search: fine where pictures are, coarse up to [`FARTHEST`].
const FINE: (f64, usize) = (1.0 / 32.0, 64);
const COARSE: (f64, usize) = (0.25, 24);
/// Radius in image units up to which a fold is looked for; beyond it a lens that distorts images nothing.
const FARTHEST: f64 = 8.0;

/// Radius of the fold in each direction.
#[derive(Debug, Clone)]
pub struct FoldMap {
    /// Empty: the lens does not distort.
    radius: Vec<f64>,
}

impl FoldMap {
    /// Searches the fold.
    ///
    /// # Errors
    /// [`ModelError::Value`] naming the parameter that contributes most to a fold inside the region of interest.
    pub fn checked(effects: &Effects) -> Result<Self, ModelError> {
        if effects.lens_parameters().iter().all(|(_, value)| *value == 0.0) {
            return Ok(Self { radius: Vec::new() });
        }
        let radius: Vec<f64> = (0..RAYS).map(|ray| fold_radius(effects, direction(ray))).collect();
        let first = (0..RAYS).fold(0, |best, ray| if radius[ray] < radius[best] { ray } else { best });
        if radius[first] < INTEREST {
            return Err(refusal(effects, radius[first], direction(first)));
        }
        Ok(Self { radius })
    }

    /// Whether an ideal point lies inside the fold.
    pub fn contains(&self, (u, v): (f64, f64)) -> bool {
        if self.radius.is_empty() {
            return true;
        }
        let turn = libm::atan2(v, u) / core::f64::consts::TAU;
        let ray = libm::floor((turn + 1.0) * RAYS as f64) as usize;
        let smaller = self.radius[ray % RAYS].min(self.radius[(ray + 1) % RAYS]);
        u * u + v * v < smaller * smaller
    }
}

fn direction(ray: usize) -> (f64, f64) {
    let angle = core::f64::consts::TAU * ray as f64 / RAYS as f64;
    (libm::cos(angle), libm::sin(angle))
}

/// Determinant of the Jacobian, by central differences: the displacement is a polynomial of low order, so 1e-5 is
/// good to ten digits.
fn jacobian(effects: &Effects, (u, v): (f64, f64)) -> f64 {
    let h = 1e-5;
    let at = |u, v| effects.distorted(u, v);
    let ((a, b), (c, d)) = (at(u + h, v), at(u - h, v));
    let ((e, f), (g, i)) = (at(u, v + h), at(u, v - h));
    ((a - c) * (f - i) - (e - g) * (b - d)) / (4.0 * h * h)
}

fn fold_radius(effects: &Effects, (u, v): (f64, f64)) -> f64 {
    let folded = |r: f64| jacobian(effects, (r * u, r * v)) <= 0.0;
    let fine = (0..=FINE.1).map(|step| step as f64 * FINE.0);
    let coarse = (1..=COARSE.1).map(|step| FINE.1 as f64 * FINE.0 + step as f64 * COARSE.0);
    let mut inside = 0.0;
    let Some(mut outside) = fine.chain(coarse).find(|r| {
        let found = folded(*r);
        if !found {
            inside = *r;
        }
        found
    }) else {
        return FARTHEST;
    };
    for _ in 0..40 {
        let middle = 0.5 * (inside + outside);
        if folded(middle) { outside = middle } else { inside = middle }
    }
    outside
}

fn refusal(effects: &Effects, radius: f64, (u, v): (f64, f64)) -> ModelError {
    let place = (radius * u, radius * v);
    let gain = |name: &str| jacobian(&effects.without(name), place);
    let parameters = effects.lens_parameters();
    let mut worst = parameters[0]; // lens_parameters() is never empty: the list of lens effects isn't
    for parameter in &parameters {
        if gain(parameter.0) > gain(worst.0) {
            worst = *parameter;
        }
    }
    ModelError::Value {
        name: worst.0,
        value: format!("{}", worst.1),
        expected: format!(
            "the lens folds the picture back at radius {radius:.4} image units from the optical axis (at ideal \
             u = {:.4}, v = {:.4}); it must not fold within {INTEREST}",
            place.0, place.1
        ),
    }
}
