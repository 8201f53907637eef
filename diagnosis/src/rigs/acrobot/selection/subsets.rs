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

/// The linear effects of an image, beside those that are held, and what the data tell of all.
pub(super) struct Subsets<'a> {
    last: &'a Evaluation,
    candidates: &'a [Candidate],
    active: &'a [usize],
    /// Candidates that columns are there of.
    all: Vec<usize>,
    /// Which of them are in each subset.
    held: Vec<bool>,
    told: Told,
}

impl<'a> Subsets<'a> {
    /// All linear effects that have a column; `None` where these say nothing.
    pub(super) fn of(
        last: &'a Evaluation,
        candidates: &'a [Candidate],
        active: &'a [usize],
        signals: &[Signal],
    ) -> Option<Self> {
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
        Some(Self { last, candidates, active, all, held, told })
    }

    /// The subset that is needed, if it is another than the active ones.
    pub(super) fn best(&self) -> Option<Proposal> {
        let (left, sizes) = self.told.best(&self.held)?;
        let proposal = self.proposal(&left, &sizes);
        let same = proposal.active.len() == self.active.len()
            && proposal.active.iter().all(|index| self.active.contains(index));
        (!same).then_some(proposal)
    }

    /// One more in the place of two, those that columns speak for most first. Two that together come near a third one take its place
    /// where its column errs by more than what tells it from them: the larger the effects beside it, the more.
    pub(super) fn one_for_two(&self) -> Vec<Proposal> {
        let is_active = |place: &usize| self.active.contains(&self.all[*place]);
        let on: Vec<usize> = (0..self.all.len()).filter(is_active).collect();
        let open = |place: &usize| !self.held[*place];
        let mut ranked: Vec<(f64, Proposal)> = Vec::new();
        for more in (0..self.all.len()).filter(|place| !is_active(place) && open(place)) {
            for (i, one) in on.iter().enumerate().filter(|(_, one)| open(one)) {
                for other in on[i + 1..].iter().filter(|other| open(other)) {
                    let rest = on.iter().copied().filter(|place| place != one && place != other);
                    let places: Vec<usize> = rest.chain([more]).collect();
                    let Some((explained, sizes)) = self.told.explained(&places) else { continue };
                    ranked.push((explained, self.proposal(&places, &sizes)));
                }
            }
        }
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        ranked.into_iter().map(|(_, proposal)| proposal).collect()
    }

    /// Effects at some places with their sizes, in the place of all that are active.
    fn proposal(&self, places: &[usize], sizes: &[f64]) -> Proposal {
        let mut point = self.last.point.clone();
        self.active.iter().for_each(|index| point[*index] = self.candidates[*index].off);
        let active: Vec<usize> = places.iter().map(|place| self.all[*place]).collect();
        for (index, size) in active.iter().zip(sizes) {
            let candidate = &self.candidates[*index];
            point[*index] = (candidate.off + size).clamp(candidate.range.0, candidate.range.1);
        }
        Proposal { active, point }
    }
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
            let Some((explained, sizes)) = self.explained(&places) else { continue };
            let worth = explained - SELECTION.together * places.len() as f64;
            if best.as_ref().is_none_or(|(known, _, _)| worth > *known) {
                best = Some((worth, places, sizes));
            }
        }
        best.map(|(_, places, sizes)| (places, sizes))
    }

    /// What a subset explains, and its sizes.
    fn explained(&self, places: &[usize]) -> Option<(f64, Vec<f64>)> {
        let score = subvector(&self.score, places);
        let sizes = solve(&submatrix(&self.information, places), &score)?;
        Some((sizes.dot(&score), sizes.iter().copied().collect()))
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
