//! Rows of the applied torque about when the command changes: timestamps that scatter put them on either side of the change.

use crate::rigs::acrobot::dataset::row_times::unevenness;
use crate::rigs::acrobot::dataset::{Run, Table};
use crate::rigs::acrobot::residual::plant::policy::WINDOWS;
use crate::statistics::levels::FAR;

/// How far a row and a change of the command may lie apart and be stamped in the wrong order, s: as far as no timestamp scatters.
pub(super) fn doubt_of_torque(run: &Run) -> f64 {
    // rows that were put at ticks scattered before, of which the ticks' own error tells
    let ticks = |log: &Table| log.tick_error * (0.5 * log.len() as f64).sqrt();
    let scatter = |log: &Option<Table>| log.as_ref().map_or(0.0, |log| unevenness(&log.time).max(ticks(log)));
    let both = scatter(&run.plant) + scatter(&run.controller);
    if both < WINDOWS.smallest { 0.0 } else { FAR * both }
}

/// By how much the torque at a time is in doubt, N·m: the changes of the command within that reach.
pub(super) fn in_doubt(run: &Run, time: f64, reach: f64) -> f64 {
    let log = run.controller.as_ref().filter(|_| reach > 0.0);
    let Some((log, tau)) = log.and_then(|log| Some((log, log.column("tau")?))) else { return 0.0 };
    let from = log.time.partition_point(|change| *change < time - reach).max(1);
    let near = (from..log.len()).take_while(|row| log.time[*row] <= time + reach);
    let changes = near.map(|row| tau[row] - tau[row - 1]).filter(|change| change.is_finite());
    changes.map(|change| change * change).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A command that goes up by 0.3 N·m at 0.1 s, beside encoders; timestamps that scatter by so much.
    fn run(scatter: f64) -> Run {
        let time = |row: u32| 0.02 * f64::from(row) + scatter * libm::sin(f64::from(row * row));
        let times = || (0..20).map(time).collect::<Vec<f64>>();
        let tau = (0..20).map(|row| if row < 5 { 0.1 } else { 0.4 }).collect();
        Run {
            name: String::new(),
            camera: None,
            controller: Some(Table::new(times(), vec![("tau".into(), tau)])),
            plant: Some(Table::new(times(), vec![("q1".into(), vec![0.0; 20])])),
        }
    }

    #[test]
    fn law_a_torque_is_in_doubt_by_the_changes_that_stamps_may_confuse_it_with() {
        let even = run(0.0);
        assert_eq!((doubt_of_torque(&even), in_doubt(&even, 0.1, doubt_of_torque(&even))), (0.0, 0.0));
        // rows that were put at ticks: 20 of them, of timestamps that scattered by 1 ms
        let mut ticks = run(0.0);
        ticks.plant.iter_mut().for_each(|log| log.tick_error = 1e-3 / 10.0_f64.sqrt());
        assert!((super::doubt_of_torque(&ticks) - 1e-2).abs() < 1e-12);
        let uneven = run(4e-4);
        let reach = doubt_of_torque(&uneven);
        // ten times the scatter of both logs, 0.3 ms each
        assert!((4e-3..1e-2).contains(&reach), "{reach}");
        let (doubt, change) =
            (|time: f64| in_doubt(&uneven, time, reach), uneven.controller.as_ref().unwrap().time[5]);
        for near in [-0.99, 0.0, 0.99] {
            assert!((doubt(change + near * reach) - 0.3).abs() < 1e-12, "{near}");
        }
        assert_eq!([-1.01, 1.01].map(|far| doubt(change + far * reach)), [0.0; 2]);
    }
}
