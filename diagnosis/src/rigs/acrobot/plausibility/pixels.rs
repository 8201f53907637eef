//! Where pixels are counted from.

use super::{Facts, Finding};
use crate::rigs::acrobot::dataset::Run;
use crate::rigs::acrobot::plausibility::policy::PLAUSIBLE;
use crate::rigs::acrobot::policy::POLICY;

/// Pixels from a corner, or with v down.
pub(super) fn origin(facts: &Facts<'_>) -> Option<Finding> {
    let ground = facts.nominal.ground?;
    let half = 0.5 * facts.nominal.image.1;
    facts.runs.iter().find_map(|run| {
        let height = height(run)?;
        if (height - ground).abs() < PLAUSIBLE.near {
            return None;
        }
        let ways = [("top left", half - height), ("bottom left", height - half), ("centre, v down", -height)];
        let (way, _) = ways.into_iter().find(|(_, height)| (height - ground).abs() < PLAUSIBLE.near)?;
        Some(Finding {
            file: format!("{}/camera.csv", run.name),
            line: run.camera.as_ref().map_or(0, |log| log.line[0]),
            sentence: format!(
                "circle 1 lies at v1 = {height:.0} px, where the nominal camera sees it at {ground:.0} px, counted from the \
                 middle of the image with v up: pixels look counted from: {way}"
            ),
            add: format!("pixels = {way:?}"),
        })
    })
}

/// Median height of circle 1, px.
fn height(run: &Run) -> Option<f64> {
    let log = run.camera.as_ref()?;
    let mut heights: Vec<f64> = log.column("v1")?.iter().copied().filter(|v| v.is_finite()).collect();
    heights.sort_by(f64::total_cmp);
    if heights.len() < POLICY.rows { None } else { heights.get(heights.len() / 2).copied() }
}
