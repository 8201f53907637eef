//! Whether the loop of a scenario is the one that held the arm in the runs that were made: an experiment is simulated in the scenario's, and a lab makes
//! it in its own.

use crate::rigs::acrobot::dataset::{DataSet, Table};
use crate::rigs::acrobot::lost_frames::changes;
use crate::statistics::levels::{FAR, MORE};
use crate::statistics::median::usual_step;
use crate::text::brief;

/// Why the loop in which the runs were simulated once more is none of this lab's: its controller asks for far more than any that was logged.
pub fn beyond_the_logs(made: &Table, like: &DataSet) -> Option<String> {
    let logs = like.runs.iter().filter_map(|run| run.controller.as_ref());
    let [asked, logged] = [largest(made), logs.map(largest).fold(0.0, f64::max)];
    (logged > 0.0 && asked > FAR * logged).then(|| {
        format!(
            "the scenario's controller asks for {} N·m, where no more than {} N·m were logged: another one held this arm",
            brief(asked),
            brief(logged)
        )
    })
}

fn largest(log: &Table) -> f64 {
    let torques = log.column("tau").unwrap_or_default().iter().filter(|torque| torque.is_finite());
    torques.fold(0.0, |most, torque| torque.abs().max(most))
}

/// What to say of an experiment where the logs have new torques oftener than the loop in which it was simulated.
pub fn quicker_than(made: &Table, like: &DataSet) -> Option<String> {
    let logs = like.runs.iter().filter_map(|run| run.controller.as_ref());
    let own = logs.filter_map(|log| usual_step(&changes(log))).reduce(f64::min)?;
    let simulated = usual_step(&changes(made))?;
    (own * MORE < simulated).then(|| {
        format!(
            "This was simulated in the scenario's own loop, with {:.0} torques a second. The runs that were made had {:.0}: in such a loop it may tell \
             less.",
            1.0 / simulated,
            1.0 / own
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::dataset::Run;

    /// So many torques a second, of this size.
    fn log(rate: f64, size: f64) -> Table {
        let (time, tau) =
            (0..100).map(|row| (f64::from(row) / rate, size * libm::sin(f64::from(row)))).unzip();
        Table::new(time, vec![("tau".into(), tau)])
    }

    fn logged(rate: f64, size: f64) -> DataSet {
        let run = Run { name: "run-01".into(), camera: None, controller: Some(log(rate, size)), plant: None };
        DataSet { runs: vec![run], ..super::super::tests::nothing_logged() }
    }

    #[test]
    fn law_a_loop_that_asks_for_far_more_than_was_logged_is_another() {
        assert_eq!(beyond_the_logs(&log(30.0, 9.0), &logged(30.0, 1.0)), None);
        let told = beyond_the_logs(&log(30.0, 90.0), &logged(30.0, 1.0)).expect("90 times as much");
        assert!(told.starts_with("the scenario's controller asks for 90"), "{told}");
        // whose torque nobody logged
        assert_eq!(beyond_the_logs(&log(30.0, 90.0), &super::super::tests::nothing_logged()), None);
    }

    #[test]
    fn law_a_quicker_loop_is_told() {
        assert_eq!(quicker_than(&log(30.0, 1.0), &logged(30.0, 1.0)), None);
        let told = quicker_than(&log(30.0, 1.0), &logged(200.0, 1.0)).expect("200 a second");
        assert!(told.contains("with 30 torques a second. The runs that were made had 200"), "{told}");
    }
}
