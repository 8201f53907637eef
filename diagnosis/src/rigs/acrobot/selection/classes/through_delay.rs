//! An effect of the plant against an exposure: compared through the camera's delay.
//!
//! Their columns are not of one kind. A plant's moves the simulated arm under the pixel lattice, an exposure's blurs the image where it is, so that
//! each looks better at the other's fit than it is. The camera's delay stands between them: it moves what is seen in time, as an actuator's lag
//! does (compared by fits), and is a matter of the camera, as an exposure is (compared by columns, at one pose).

use super::{OwnFit, blurs, linear_loss, predicted_loss};
use crate::error::Error;
use crate::rigs::acrobot::candidates::{Attribute, Side, place};
use crate::rigs::acrobot::residual::Tracked;
use crate::rigs::acrobot::selection::evaluation::{Evaluation, all_perturbations};

impl OwnFit<'_> {
    /// What an exposure loses to the plant's effect, through the delay; nothing for other pairs.
    pub(super) fn loss_through_delay(&self, cut: &mut Tracked, index: usize) -> Result<Option<f64>, Error> {
        let between = place(self.candidates, Attribute::ImageDelay).filter(|delay| {
            *delay != index && !self.others.contains(delay) && cut.sees(&self.candidates[*delay])
        });
        let apart = self.candidates[self.effect].side == Side::Plant && blurs(&self.candidates[index]);
        let Some(delay) = between.filter(|_| apart) else { return Ok(None) };
        let Some((fit, lost)) = self.fitted_instead(cut, delay)? else { return Ok(None) };
        let mut active = self.others.clone();
        active.push(delay);
        let asked = |place: usize| active.contains(&place) || place == index;
        let perturbations: Vec<_> =
            all_perturbations(self.candidates, &fit.point, &|one| cut.sees(one), &active)
                .into_iter()
                .filter(|perturbation| asked(perturbation.candidate))
                .collect();
        let last = &Evaluation::chord(cut, &fit.point, &perturbations)?;
        let replaced = linear_loss(last, &self.others, delay, index, self.candidates);
        let told = predicted_loss(last, &self.others, delay, index, self.candidates);
        let Some((replaced, (_, strength))) = replaced.zip(told) else { return Ok(None) };
        let from = OwnFit {
            candidates: self.candidates,
            last,
            others: self.others.clone(),
            effect: delay,
            temper: self.temper,
            offsets: last.offsets(cut.signals()),
            deviance: fit.deviance(),
            nuisances: cut.nuisances.clone(),
            unseen: cut.unseen,
        };
        Ok(Some(lost + from.loss_by_columns(cut, index, &replaced, strength)))
    }
}
