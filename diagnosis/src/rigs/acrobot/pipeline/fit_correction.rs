//! Where the plant's residual has no name: a labelled correction for the amended model.

use super::Rig;
use super::compare::Part;
use super::policy::PIPELINE;
use crate::diagnosis::{Correction, Term};
use crate::error::{Error, Notice};
use crate::rigs::acrobot::candidates::{Attribute, Entry, LIST};
use crate::rigs::acrobot::correction::{Offer, offer, wiring};
use crate::rigs::acrobot::residual::Tracked;
use crate::rigs::acrobot::residual::forced_torques::Forced;

/// The correction that runs left out support, if any. Failing to find one is no failure of the diagnosis.
pub(super) fn fit_correction(rig: &Rig<'_>, part: &Part, notices: &mut Vec<Notice>) -> Option<Correction> {
    best_offer(rig, part).unwrap_or_else(|error| {
        let message = format!("no correction of the residual is offered: {error}");
        notices.push(Notice { file: "amended.toml".into(), line: 0, message });
        None
    })
}

/// What fits beside all effects, or without those that it replaces.
fn best_offer(rig: &Rig<'_>, part: &Part) -> Result<Option<Correction>, Error> {
    let list = &rig.list;
    let runs: Vec<String> = rig.data.runs.iter().map(|run| run.name.clone()).collect();
    let name = wiring::free_name(&rig.model.scenario);
    let named: Vec<usize> = part.classes.iter().map(|(index, _)| *index).collect();
    let point = &part.study.last.point;
    let Some(mut cut) = judged_cut(rig, part)? else { return Ok(None) };
    // each begins from the data again
    let mut at = |point: &[f64]| {
        cut.reset();
        offer(cut.as_mut(), point, &runs, rig.units, &name)
    };
    let beside = at(point)?;
    for withdrawn in withdrawable(&named) {
        let mut rest = point.clone();
        withdrawn.iter().for_each(|index| rest[*index] = list[*index].off);
        let names: Vec<String> = withdrawn.iter().map(|index| list[*index].name.to_owned()).collect();
        let without = at(&rest)?;
        if replaces(&beside, &without, &names) {
            return Ok(without.correction.map(|found| Correction { supersedes: names, ..found }));
        }
    }
    Ok(beside.correction)
}

/// Which effects are tried without: all, and each of the last few.
fn withdrawable(named: &[usize]) -> Vec<Vec<usize>> {
    let all = (!named.is_empty()).then(|| named.to_vec());
    let singles =
        named.iter().rev().take(if named.len() > 1 { PIPELINE.singles } else { 0 }).map(|index| vec![*index]);
    all.into_iter().chain(singles).collect()
}

/// Where a residual is large, selection may have taken an effect for a part of it. Without such effects a correction has
/// fewer numbers in all and leaves no more, or as many and leaves far less.
fn replaces(beside: &Offer, without: &Offer, withdrawn: &[String]) -> bool {
    let terms = |offer: &Offer| offer.correction.as_ref().map_or(0, |correction| correction.terms.len());
    let Some(correction) = &without.correction else { return false };
    let says =
        |term: &Term, entry: &Entry| entry.twin.is_some_and(|twin| term.name.ends_with(&format!(".{twin}")));
    // an effect is never withdrawn for its own twin
    let twin = |entry: &Entry| {
        withdrawn.iter().any(|name| name == entry.name)
            && correction.terms.iter().any(|term| says(term, entry))
    };
    // friction in another form is a listed effect, and no residual that an effect stood for
    let friction = |term: &Term| LIST.iter().any(|entry| entry.is(Attribute::Friction) && says(term, entry));
    let listed = correction.terms.iter().all(friction);
    let (now, before) = (terms(without), withdrawn.len() + terms(beside));
    let fewer = now < before && without.left <= beside.left.max(correction.gap.floor);
    let better = now == before && without.left <= PIPELINE.far_less * beside.left;
    !listed && !LIST.iter().any(twin) && (fewer || better)
}

/// The cut on which the residual was judged, at its beginning.
fn judged_cut(rig: &Rig<'_>, part: &Part) -> Result<Option<Box<Tracked<dyn Forced>>>, Error> {
    if part.study.discrepancy_dominated {
        return Ok(rig.torque_cut()?.map(|cut| Box::new(cut) as Box<Tracked<dyn Forced>>));
    }
    let Some(mut rows) = rig.plant_cut()? else { return Ok(None) };
    rows.begin(&part.study.last.point)?;
    Ok(Some(Box::new(rows)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::correction::Closing;

    fn offered(left: f64, terms: usize) -> Offer {
        let term = Term {
            name: "residual.any".into(),
            value: 1.0,
            ci95: [1.0; 2],
            measure: String::new(),
            phrase: String::new(),
        };
        let gap = Closing { before: 1.0, after: 0.1, floor: 0.1, closed: 1.0, held_out_runs: Vec::new() };
        let correction = Correction {
            label: String::new(),
            unit: String::new(),
            terms: vec![term; terms],
            gap,
            supersedes: Vec::new(),
            parameters: Vec::new(),
            usual: 0.0,
            left: Vec::new(),
        };
        Offer { correction: (terms > 0).then_some(correction), left }
    }

    #[test]
    fn value_a_correction_takes_the_place_of_as_many_effects_that_leaves_far_less() {
        let withdrawn = ["plant.any".to_owned()];
        let takes = |left: f64, terms: usize| replaces(&offered(1.0, 1), &offered(left, terms), &withdrawn);
        // two numbers for two: 0.7 of what is left
        assert_eq!([0.65, 0.75].map(|left| takes(left, 2)), [true, false]);
        // one for two: as much; three for two: never
        assert_eq!([0.95, 1.05].map(|left| takes(left, 1)), [true, false]);
        assert!(!takes(0.01, 3) && !takes(0.01, 0));
    }

    #[test]
    fn value_all_are_tried_without_and_each_of_the_last_three() {
        assert_eq!(withdrawable(&[4, 5, 6, 7]), [vec![4, 5, 6, 7], vec![7], vec![6], vec![5]]);
        assert_eq!(withdrawable(&[4, 5]), [vec![4, 5], vec![5], vec![4]]);
        // the only one is all
        assert_eq!(withdrawable(&[4]), [vec![4]]);
        assert_eq!(withdrawable(&[]), [[0; 0]; 0]);
    }
}
