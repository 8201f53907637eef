//! Where the plant's rest has no name: a labelled correction for the amended model.

use super::*;
use crate::correction::{Correction, Offer, offer, wiring};
use crate::residual::forced::Forced;
use crate::residual::plant::PlantCut;
use crate::residual::weak::Weak;

/// What a correction alone may leave of what effects leave, to take their place with as many numbers.
const FAR_LESS: f64 = 0.7;

/// The correction that runs left out support, if any. Failing to find one is no failure of the diagnosis.
pub(super) fn correct(
    data: &DataSet,
    model: &Model,
    list: &Arc<Vec<Candidate>>,
    part: &Part,
    units: &UnitPath,
    notices: &mut Vec<Notice>,
) -> Option<Correction> {
    let runs: Vec<String> = data.runs.iter().map(|run| run.name.clone()).collect();
    let name = wiring::free_name(&model.scenario);
    let at = |point: &[f64]| match cut(data, model, list, part, point)? {
        Some(mut cut) => offer(cut.as_mut(), point, &runs, units, &name),
        None => Ok(Offer::default()),
    };
    let named: Vec<usize> = part.classes.iter().map(|(index, _)| *index).collect();
    let point = &part.study.last.point;
    let found = at(point).and_then(|beside| {
        if named.is_empty() {
            return Ok(beside.correction);
        }
        let mut bare = point.clone();
        named.iter().for_each(|index| bare[*index] = list[*index].off);
        let names = named.iter().map(|index| list[*index].name.to_owned()).collect();
        Ok(simpler(beside, at(&bare)?, names))
    });
    found.unwrap_or_else(|error| {
        let message = format!("no correction of the rest is offered: {error}");
        notices.push(Notice { file: "amended.toml".into(), line: 0, message });
        None
    })
}

/// The correction beside the effects that were named, or alone: where a rest is large, selection may have taken an
/// effect for a part of it. With fewer numbers in all and no more left,
/// or as many and far less left, it stands alone.
fn simpler(beside: Offer, alone: Offer, named: Vec<String>) -> Option<Correction> {
    let numbers = named.len() + beside.correction.as_ref().map_or(0, |correction| correction.terms.len());
    match alone.correction {
        Some(correction) => {
            let no_more = alone.left <= beside.left.max(correction.gap.floor);
            let far_less = alone.left <= FAR_LESS * beside.left;
            let terms = correction.terms.len();
            if (terms < numbers && no_more) || (terms == numbers && far_less) {
                Some(Correction { supersedes: named, ..correction })
            } else {
                beside.correction
            }
        }
        None => beside.correction,
    }
}

/// The cut on which the rest was judged, at its beginning.
fn cut(
    data: &DataSet,
    model: &Model,
    list: &Arc<Vec<Candidate>>,
    part: &Part,
    point: &[f64],
) -> Result<Option<Box<dyn Forced>>, Error> {
    if part.study.outweighed {
        return Ok(Weak::new(data, model, list.clone())?.map(|cut| Box::new(cut) as Box<dyn Forced>));
    }
    let Some(mut rows) = PlantCut::new(data, model, list.clone(), false)? else { return Ok(None) };
    rows.find_jitter(point)?;
    Ok(Some(Box::new(rows)))
}
