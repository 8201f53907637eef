//! Classes that usual windows leave open: what longer ones say of them, where the model follows the log to within noise.

use super::*;
use crate::residual::plant::PlantCut;
use crate::selection::{Evaluation, all_probes, refit};

/// Noise may look larger in longer windows by this much before they are taken to show what the model lacks.
const LOUDER: f64 = 1.05;

pub(super) fn told_apart(
    rows: &mut PlantCut,
    data: &DataSet,
    model: &Model,
    list: &[Candidate],
    part: &mut Part,
    step: f64,
) -> Result<(), Error> {
    let study = &part.study;
    let settled = !study.outweighed && study.last.softness == 0.0;
    if !settled || !part.classes.iter().any(|(effect, class)| open(*effect, class, list)) {
        return Ok(());
    }
    let point = &study.last.point;
    rows.linearise(point, &[], false)?;
    let motions = rows.motion(point, step)?;
    let Some(mut long) = rows.longer(data, model, point, &motions)? else { return Ok(()) };
    let fit = refit(&mut long, list, point, &study.active)?;
    let probes = all_probes(list, &fit.point, &|candidate| long.sees(candidate), &study.active);
    let last = Evaluation::at(&mut long, &fit.point, &probes, false)?;
    let louder = last.sigmas.iter().zip(&study.last.sigmas).any(|(now, before)| *now > LOUDER * before);
    if louder || last.softness > 0.0 {
        return Ok(());
    }
    for (effect, class) in part.classes.iter_mut().filter(|(effect, class)| open(*effect, class, list)) {
        *class = alternatives(&mut long, list, &last, &study.active, *effect, &study.steps)?;
    }
    Ok(())
}

/// Whether two parameters of the plant are in a class.
fn open(effect: usize, class: &[Alternative], list: &[Candidate]) -> bool {
    let member = |other: &&Alternative| other.candidate == effect || other.loss < CLASS;
    class.iter().filter(member).filter(|member| list[member.candidate].side == Side::Plant).count() > 1
}
