//! A torque's log that begins late or ends early: what other logs show of the rest of the run tells nothing of the plant.

use super::Run;
use crate::error::Notice;
use crate::rigs::acrobot::story::brief;
use crate::statistics::levels::SMALL;

/// Says so where it is more than a tenth of the run.
pub fn tell(run: &Run, notices: &mut Vec<Notice>) {
    let ((from, to), (first, last)) = (run.span(), run.driven());
    // a run without rows of anything else is told as such
    if run.camera.is_none() && run.plant.is_none() {
        return;
    }
    let without = (first - from).max(0.0) + (to - last).max(0.0);
    if without.is_infinite() || without <= SMALL * (to - from) {
        return;
    }
    let message = format!(
        "the torque is logged from {} s to {} s, other logs go from {} s to {} s: where it is missing, nothing is told of the \
         plant",
        brief(first),
        brief(last),
        brief(from),
        brief(to)
    );
    notices.push(Notice { file: format!("{}/controller.csv", run.name), line: 0, message });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::dataset::Table;

    fn told(torque: (usize, usize), plant: (usize, usize)) -> Vec<Notice> {
        let log = |(from, to): (usize, usize), column: &str| {
            let time: Vec<f64> = (from..=to).map(|row| row as f64 * 0.01).collect();
            let values = vec![0.1; time.len()];
            Some(Table::new(time, vec![(column.to_owned(), values)]))
        };
        let (controller, plant) = (log(torque, "tau"), log(plant, "q1"));
        let mut notices = Vec::new();
        tell(&Run { name: "run-01".into(), camera: None, controller, plant }, &mut notices);
        notices
    }

    #[test]
    fn bad_data_a_torque_that_ends_a_tenth_before_the_run_does_is_told() {
        assert!(told((0, 1000), (0, 1000)).is_empty() && told((0, 901), (0, 1000)).is_empty());
        let late = told((150, 1000), (0, 1000));
        assert!(late[0].message.contains("from 1.50 s to 10.0"), "{}", late[0].message);
        assert!(told((0, 800), (0, 1000)).len() == 1 && told((0, 950), (50, 1060)).len() == 1);
    }

    #[test]
    fn bad_data_a_run_without_any_row_has_no_torque_that_is_missing() {
        let mut notices = Vec::new();
        let mut run = Run { name: "run-01".into(), camera: None, controller: None, plant: None };
        tell(&run, &mut notices);
        run.controller = Some(Table::new(vec![0.0, 1.0], vec![("tau".into(), vec![0.1; 2])]));
        tell(&run, &mut notices);
        assert_eq!(notices, []);
    }

    #[test]
    fn neutral_a_torque_without_a_log_or_of_a_few_rows_is_held() {
        assert!(told((0, 3), (0, 1000)).is_empty());
    }
}
