//! Whether timestamps that scatter are to be believed: rows may have been taken so unevenly, or stamped so badly. The motion knows.

use super::Rig;
use crate::rigs::acrobot::dataset::DataSet;
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::residual::Tracked;
use crate::rigs::acrobot::residual::plant::PlantCut;
use crate::rigs::acrobot::selection::Evaluation;

/// The data with rows at the ticks of even clocks, where the nominal plant follows such a log better than the one that was stamped.
pub(super) fn at_clock_ticks(rig: &Rig<'_>) -> Option<DataSet> {
    let ticks = rig.data.at_ticks()?;
    let (stamped, ticked) = (deviance_by_row(rig, &rig.data)?, deviance_by_row(rig, &ticks)?);
    // windows may begin and end a row apart
    let better = (stamped.0 - ticked.0) * stamped.1.min(ticked.1);
    (better > POLICY.evidence).then_some(ticks)
}

/// Deviance of the nominal model for each row, and their number. A log that can't be judged is no better one.
fn deviance_by_row(rig: &Rig<'_>, data: &DataSet) -> Option<(f64, f64)> {
    let point = rig.nominal_point();
    let mut rows = Tracked::new(PlantCut::new(data, rig.model, rig.list.clone()).ok()??);
    rows.begin(&point).ok()?;
    let there = Evaluation::at(&mut rows, &point, &[]).ok()?;
    let cells = there.blocks.iter().flat_map(|block| &block.cells);
    let count = cells.map(|cell| cell.residual.len()).sum::<usize>() as f64;
    (count > 0.0).then(|| (there.deviance() / count, count))
}
