//! Levels at which saturations of the torque are tried.

use crate::rigs::acrobot::candidates::Cuts;
use crate::rigs::acrobot::dataset::DataSet;

/// Levels at which a saturation would cut what was commanded while the arm was seen to move, before it reached its mechanical limit, `contact` (rad).
pub(super) fn saturations(data: &DataSet, cuts: Cuts, contact: f64) -> Vec<f64> {
    let mut sizes: Vec<f64> = Vec::new();
    for run in &data.runs {
        let Some(controller) = &run.controller else { continue };
        let Some(tau) = controller.column("tau") else { continue };
        let tau = &tau[..controller.time.partition_point(|row| *row < run.moves_until(contact))];
        match cuts {
            Cuts::Torque => sizes.extend(tau.iter().map(|tau| tau.abs()).filter(|tau| tau.is_finite())),
            Cuts::TorqueRate => {
                sizes.extend(
                    tau.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|jump| jump.is_finite()),
                );
            }
        }
    }
    sizes.sort_by(f64::total_cmp);
    let quantile =
        |share: f64| sizes.get(((sizes.len().max(1) - 1) as f64 * share) as usize).copied().unwrap_or(0.0);
    let levels: Vec<f64> = match cuts {
        Cuts::Torque => {
            let top = [0.97, 0.9].map(|share| share * quantile(1.0));
            [0.999, 0.995, 0.97, 0.9, 0.75, 0.5].map(quantile).into_iter().chain(top).collect()
        }
        // a large step of the torque then takes 0.6 to 80 ms
        Cuts::TorqueRate => {
            [0.0006, 0.002, 0.006, 0.02, 0.08].iter().map(|time| quantile(0.95) / time).collect()
        }
    };
    levels.into_iter().filter(|level| *level > 0.0).collect()
}
