//! Effects that show only together. The terms of a real lens nearly cancel (a positive k1, a negative k2), so that a search one by
//! one takes a scale and a tilt for them and ends. Here every subset of the linear effects is weighed at once, by what it leaves and by how
//! many it needs (Miller, *Subset Selection in Regression*, Chapman & Hall 2002, chapter 3); columns are those at hand, so that no subset
//! costs a frame.

use super::evaluation::Evaluation;
use crate::rigs::acrobot::candidates::{Candidate, Motion, Side};
use crate::rigs::acrobot::residual::Signal;
use crate::rigs::acrobot::selection::policy::SELECTION;
use crate::statistics::linear::RANK_TOLERANCE;
use crate::statistics::linear::{inverse, solve, submatrix, subvector};
use nalgebra::{DMatrix, DVector};

/// Effects and a point for a fit to begin with.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Proposal {
    pub(super) active: Vec<usize>,
    pub(super) point: Vec<f64>,
}

/// Whether a decrease of the squares is worth so many more effects, beside so many that are left; of fewer, whether a rise is.
pub(super) fn pays(decrease: f64, more: f64, left: f64) -> bool {
    decrease > more * SELECTION.together + more.signum() * SELECTION.lattice * left
}

/// What all linear effects of the image say together, if those that are needed are others than the active ones.
pub(super) fn together(
    last: &Evaluation,
    candidates: &[Candidate],
    active: &[usize],
    signals: &[Signal],
) -> Option<Proposal> {
    let linear = |index: &usize| {
        let candidate = &candidates[*index];
        candidate.side == Side::Camera
            && !candidate.nonlinear
            && matches!(candidate.motion, Motion::Real { .. })
    };
    let kept: Vec<usize> = active.iter().copied().filter(|index| !linear(index)).collect();
    let all: Vec<usize> = (0..candidates.len())
        .filter(|index| linear(index) || kept.contains(index))
        .filter(|index| !last.places(&[*index]).is_empty())
        .collect();
    let places = last.places(&all);
    let off: Vec<f64> = all.iter().map(|index| last.point[*index] - candidates[*index].off).collect();
    let gram = submatrix(&last.total.gram, &places);
    let score = subvector(&last.total.score, &places);
    let held: Vec<bool> = all.iter().map(|index| kept.contains(index)).collect();
    let offsets = last.offsets(signals).select_rows(&places);
    let told = Told::new(&gram, &score, &offsets, &off)?;
    let (left, sizes) = told.best(&held)?;
    let chosen: Vec<usize> = left.iter().map(|place| all[*place]).collect();
    if chosen.len() == active.len() && chosen.iter().all(|index| active.contains(index)) {
        return None;
    }
    let mut point = last.point.clone();
    active.iter().for_each(|index| point[*index] = candidates[*index].off);
    for (index, size) in chosen.iter().zip(sizes) {
        let candidate = &candidates[*index];
        point[*index] = (candidate.off + size).clamp(candidate.range.0, candidate.range.1);
    }
    Some(Proposal { active: chosen, point })
}

/// What the data tell of distances from neutral, with what correct renderers may differ by reckoned as noise.
struct Told {
    information: DMatrix<f64>,
    score: DVector<f64>,
}

impl Told {
    /// `off` is where the effects are now; `offsets` are renderers' errors, as scores. Scores are N(Γδ, Γ + OOᵀ): generalised least
    /// squares.
    fn new(gram: &DMatrix<f64>, score: &DVector<f64>, offsets: &DMatrix<f64>, off: &[f64]) -> Option<Self> {
        // about neutral: the model is linear
        let about = score + gram * DVector::from_column_slice(off);
        let mut spread = gram + offsets * offsets.transpose();
        // by so much two are told apart that do the same
        for k in 0..off.len() {
            spread[(k, k)] *= 1.0 + RANK_TOLERANCE;
        }
        let weight = gram * inverse(&spread)?;
        Some(Self { information: &weight * gram, score: weight * about })
    }

    /// The subset that explains most for its number, and its sizes. `held` ones are in each.
    fn best(&self, held: &[bool]) -> Option<(Vec<usize>, Vec<f64>)> {
        let open: Vec<usize> = (0..held.len()).filter(|place| !held[*place]).collect();
        let mut best: Option<(f64, Vec<usize>, Vec<f64>)> = None;
        for chosen in 0_u32..1 << open.len() {
            let is_in = |place: &usize| {
                let bit = open.iter().position(|other| other == place);
                bit.is_none_or(|bit| chosen >> bit & 1 == 1)
            };
            let places: Vec<usize> = (0..held.len()).filter(is_in).collect();
            let score = subvector(&self.score, &places);
            let Some(sizes) = solve(&submatrix(&self.information, &places), &score) else { continue };
            let worth = sizes.dot(&score) - SELECTION.together * places.len() as f64;
            if best.as_ref().is_none_or(|(known, _, _)| worth > *known) {
                best = Some((worth, places, sizes.iter().copied().collect()));
            }
        }
        best.map(|(_, places, sizes)| (places, sizes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::candidates::LIST;

    /// Rows along the radius, its first three powers as columns, and what k1 and k2 of opposite sign leave.
    fn lens(sizes: [f64; 3], noise: f64) -> (DMatrix<f64>, DVector<f64>) {
        let mut random = crate::statistics::random::Random::new(7);
        let rows: Vec<f64> = (0..600).map(|k| f64::from(k) / 600.0).collect();
        let columns = DMatrix::from_fn(rows.len(), 3, |i, j| rows[i].powi(j as i32 + 1) / noise);
        let clean = &columns * DVector::from_column_slice(&sizes);
        let seen = clean.map(|value| value + random.normal());
        (columns.tr_mul(&columns), columns.tr_mul(&seen))
    }

    fn best(
        gram: &DMatrix<f64>,
        score: &DVector<f64>,
        offsets: &DMatrix<f64>,
        off: &[f64],
        count: usize,
    ) -> Option<(Vec<usize>, Vec<f64>)> {
        Told::new(gram, score, offsets, off)?.best(&vec![false; count])
    }

    /// Renderers that agree.
    fn exact(columns: usize) -> DMatrix<f64> {
        DMatrix::zeros(columns, 0)
    }

    #[test]
    fn value_fits_that_the_lattice_alone_tells_apart_are_equally_good() {
        // one of 10 000 squares with two effects more: 0.011 and 0.014 of them are the lattice's, 0.03 aren't
        let left = 1e4;
        let decreases = [110.0, 140.0, 300.0].map(|decrease| pays(decrease, 2.0, left));
        assert_eq!(decreases, [false, false, true]);
        // two that aren't there go though 0.014 more is left, and stay where 0.03 would be
        let rises = [140.0, 300.0].map(|rise| pays(-rise, -2.0, left));
        assert_eq!(rises, [true, false]);
        // within a hundredth of where the line is: 2 * 20.25 + 0.02 * 10 000
        assert!(!pays(240.0, 2.0, left) && pays(241.0, 2.0, left));
    }

    #[test]
    fn law_all_subsets_of_the_linear_effects_of_an_image_are_few() {
        let linear = LIST.iter().filter(|entry| {
            entry.side == Side::Camera && !entry.nonlinear && matches!(entry.motion, Motion::Real { .. })
        });
        // 2^16 solutions of a small system take less than a frame
        assert!((1..=16).contains(&linear.count()));
    }

    #[test]
    fn value_terms_that_nearly_cancel_are_found_together() {
        // a scale that isn't there, r³ and r⁵ of opposite sign
        let (gram, score) = lens([0.0, 0.12, -0.25], 1e-3);
        let (left, sizes) = best(&gram, &score, &exact(3), &[0.0; 3], 3).expect("columns differ");
        assert_eq!(left, [1, 2]);
        // 600 rows of 1e-3 know each, beside the other, to 7e-4: four standard deviations
        assert!((sizes[0] - 0.12).abs() < 3e-3 && (sizes[1] + 0.25).abs() < 3e-3, "{sizes:?}");
        // from a point at which a search has a scale for them, the same
        let from = &score - &gram * DVector::from_column_slice(&[0.05, 0.0, 0.0]);
        let again = best(&gram, &from, &exact(3), &[0.05, 0.0, 0.0], 3).expect("columns differ");
        assert_eq!(again.0, [1, 2]);
    }

    #[test]
    fn value_what_renderers_differ_by_is_no_effect() {
        let (gram, score) = lens([0.0, 0.12, -0.25], 1e-3);
        // an error that looks like the third column, of a third of its size
        let offsets = DMatrix::from_columns(&[gram.column(2) * 0.08]);
        let (left, _) = best(&gram, &score, &offsets, &[0.0; 3], 3).expect("columns differ");
        assert!(!left.contains(&2), "{left:?}");
    }

    #[test]
    fn law_noise_alone_leaves_nothing_and_equal_columns_leave_one() {
        let (gram, score) = lens([0.0; 3], 1e-3);
        assert_eq!(best(&gram, &score, &exact(3), &[0.0; 3], 3).expect("columns differ").0, [0_usize; 0]);
        let twice = DMatrix::from_row_slice(2, 2, &[100.0, 100.0, 100.0, 100.0]);
        let (left, _) = best(&twice, &DVector::from_column_slice(&[90.0, 90.0]), &exact(2), &[0.0; 2], 2)
            .expect("one of the two");
        assert_eq!(left, [0]);
    }
}
