//! What a point sets in one unit: the parameters of the candidates that are on.

use super::Perturbation;
use crate::error::Error;
use crate::rigs::acrobot::bench::{Bench, Setting};
use crate::rigs::acrobot::candidates::{Candidate, Side};

/// Parameter values of one unit at a point, one candidate moved on.
///
/// # Errors
/// The unit lacks a candidate's variable.
pub fn settings(
    bench: &Bench,
    candidates: &[Candidate],
    side: Side,
    point: &[f64],
    moved: Option<Perturbation>,
) -> Result<Vec<Setting>, Error> {
    let mut all = Vec::new();
    for (index, candidate) in candidates.iter().enumerate() {
        if candidate.side != side {
            continue;
        }
        let by = moved
            .filter(|perturbation| perturbation.candidate == index)
            .map_or(0.0, |perturbation| perturbation.by);
        let x = (point[index] + by).clamp(candidate.range.0, candidate.range.1);
        if x != candidate.off {
            let variable = candidate.name.split_once('.').map_or(candidate.name, |(_, variable)| variable);
            all.push(bench.setting(variable, candidate.value(x))?);
        }
    }
    Ok(all)
}
