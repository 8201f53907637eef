//! The member that is named first in each class stands in the model itself, or isn't named first: what columns or linked states prefer is fitted
//! through the units before it is told, with all that is beside it.

use super::effects::better_guess;
use crate::error::Error;
use crate::rigs::acrobot::candidates::Candidate;
use crate::rigs::acrobot::residual::Tracked;
use crate::rigs::acrobot::selection::{Alternative, Study, replace_effect};

/// Puts the best of a class in the place of its effect, where a fit there raises the deviance by no more than `most`. Where it does, the
/// effect stays, and nobody counts as better than it. Whether another took the place.
pub(super) fn put_best_first(
    cut: &mut Tracked,
    list: &[Candidate],
    study: &mut Study,
    (effect, class): (&mut usize, &mut [Alternative]),
    most: f64,
) -> Result<bool, Error> {
    // what of a log is off is weighed against effects that look like it by itself, in `log_clocks.rs`
    if list[*effect].side.is_of_log() {
        return Ok(false);
    }
    // a name that another effect has already says nothing of this one
    let open = |other: &&Alternative| other.candidate == *effect || !study.active.contains(&other.candidate);
    let others: Vec<Alternative> = class.iter().filter(open).cloned().collect();
    let Some(best) = better_guess(*effect, &others, list) else { return Ok(false) };
    if replace_effect(cut, list, study, *effect, best, most)? {
        *effect = best.candidate;
        return Ok(true);
    }
    raise_to_effect(*effect, class);
    Ok(false)
}

/// Lets nobody be better than an effect that no fit speaks against.
fn raise_to_effect(effect: usize, class: &mut [Alternative]) {
    let own = class.iter().find(|other| other.candidate == effect).map_or(0.0, |own| own.loss);
    class.iter_mut().for_each(|other| other.loss = (other.loss - own).max(0.0));
    class.sort_by(|a, b| a.loss.total_cmp(&b.loss));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::candidates::Side;
    use crate::rigs::acrobot::selection::examples::{candidate, toy};
    use crate::rigs::acrobot::selection::policy::SELECTION;
    use crate::rigs::acrobot::selection::study;
    use crate::watch::{Doing, Watch};

    /// An effect that is all that is missing, and another that columns or linked states prefer by 10: who is in the model in the end, at
    /// which values, and who may be left of the class. The other does what the effect does, but for so much.
    fn told(missing: f64) -> (Vec<usize>, Vec<f64>, Vec<f64>) {
        let list = [candidate(Side::Plant, false), candidate(Side::Plant, false)];
        let mut cut = toy(move |x| vec![30.0 - x[0] - 2.0 * x[1], missing * x[1]]);
        let mut nobody = |_: &Doing<'_>| {};
        let watch = &mut Watch::new(&mut nobody, None);
        let mut study = study(&mut cut, &list, &[30.0, 0.0], &[0], watch).expect("runs");
        // as far off as a column may be
        let mut class =
            [(1, 12.0, 0.0), (0, 30.0, 10.0)].map(|(candidate, x, loss)| Alternative { candidate, x, loss });
        let mut effect = 0;
        put_best_first(&mut cut, &list, &mut study, (&mut effect, &mut class), SELECTION.settled)
            .expect("runs");
        assert_eq!(study.active, [effect]);
        (study.active, study.last.point, class.iter().map(|other| other.loss).collect())
    }

    #[test]
    fn law_who_is_named_is_who_was_fitted_and_at_the_value_of_the_fit() {
        let (active, point, losses) = told(0.0);
        assert_eq!((active, losses), (vec![1], vec![0.0, 10.0]));
        assert!(point[0] == 0.0 && (point[1] - 15.0).abs() < 1e-6, "{point:?}");
        // 15 times a half: 56 of deviance
        let (active, point, losses) = told(0.5);
        assert_eq!((active, losses), (vec![0], vec![0.0, 0.0]));
        assert!((point[0] - 30.0).abs() < 1e-6 && point[1] == 0.0, "{point:?}");
    }
}
