//! A column as a smooth function of the pose.
//!
//! What a lens or a mount does to a centroid is smooth over poses; what a single frame shows of it carries the pixel
//! lattice's error, some per cent. Two effects that look alike would be told apart by that noise alone. A polynomial
//! through all frames leaves it out.

use crate::rigs::acrobot::residual::image::policy::IMAGES;
use crate::rigs::acrobot::residual::studio::{ANGLES, COLUMNS, Seen};
use crate::rigs::acrobot::residual::trajectory::State;
use crate::statistics::levels::ROUNDING;
use crate::statistics::linear::solve;
use nalgebra::{DMatrix, DVector};

/// On what a column depends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Terms {
    /// The angles.
    Poses,
    /// The angles, and their rates up to squares.
    Motions,
}

/// A fitted column.
pub(super) struct Surface {
    terms: Terms,
    middle: State,
    scale: State,
    weights: Option<Vec<DVector<f64>>>,
}

impl Surface {
    /// Least squares through samples; no surface where there are too few.
    pub(super) fn fit(samples: &[(State, Seen)], terms: Terms) -> Self {
        let n = samples.len().max(1) as f64;
        let middle: State =
            std::array::from_fn(|i| samples.iter().map(|(state, _)| state[i]).sum::<f64>() / n);
        let scale = std::array::from_fn(|i| {
            let far = samples.iter().map(|(state, _)| (state[i] - middle[i]).abs()).fold(0.0, f64::max);
            far.max(1e-9)
        });
        let mut surface = Self { terms, middle, scale, weights: None };
        let count = surface.row(&middle).len();
        if samples.len() < IMAGES.each * count {
            return surface;
        }
        let mut design = DMatrix::zeros(samples.len(), count);
        for (place, (state, _)) in samples.iter().enumerate() {
            design.row_mut(place).copy_from_slice(&surface.row(state));
        }
        let mut normal = design.tr_mul(&design);
        // a ridge against terms that the poses don't tell apart, harmless at the poses themselves
        (0..count).for_each(|place| normal[(place, place)] += ROUNDING * n);
        let fitted = |s: usize| {
            let values = DVector::from_iterator(samples.len(), samples.iter().map(|(_, seen)| seen[s]));
            let weights = solve(&normal, &design.tr_mul(&values))?;
            let by_chance = ANGLES.contains(&s) && by_chance(&(&design * &weights), &values, count);
            Some(if by_chance { DVector::zeros(count) } else { weights })
        };
        surface.weights = (0..COLUMNS.len()).map(fitted).collect();
        surface
    }

    /// Whether there were too few samples.
    pub(super) fn is_none(&self) -> bool {
        self.weights.is_none()
    }

    /// The column at a state, if there is a surface.
    pub(super) fn at(&self, state: &State) -> Option<Seen> {
        let weights = self.weights.as_ref()?;
        let row = DVector::from_vec(self.row(state));
        Some(std::array::from_fn(|s| weights[s].dot(&row)))
    }

    /// The terms of the surface at a state: products of powers of the scaled angles, and of the rates where these count, too.
    fn row(&self, state: &State) -> Vec<f64> {
        let x: State = std::array::from_fn(|i| (state[i] - self.middle[i]) / self.scale[i]);
        let degree = if self.terms == Terms::Poses { IMAGES.degree } else { 2 };
        let products = |a: f64, b: f64, degree: usize| -> Vec<f64> {
            (0..=degree)
                .flat_map(|all| (0..=all).map(move |second| (all - second, second)))
                .map(|(i, j)| a.powi(i as i32) * b.powi(j as i32))
                .collect()
        };
        let poses = products(x[0], x[1], degree);
        if self.terms == Terms::Poses {
            return poses;
        }
        let rates = products(x[2], x[3], 2);
        poses.iter().flat_map(|pose| rates.iter().map(move |rate| pose * rate)).collect()
    }
}

/// Whether the scatter of samples alone gives such a surface (F test, with its threshold far above).
fn by_chance(surface: &DVector<f64>, values: &DVector<f64>, terms: usize) -> bool {
    let freedom = (values.len() - terms).max(1) as f64;
    let scatter = (values - surface).norm_squared() / freedom;
    surface.norm_squared() < IMAGES.chance * scatter * terms as f64
}
