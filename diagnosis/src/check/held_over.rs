//! Readings that a log repeats since its sensor is slower, or was late: only the first row of each value measured it.

use crate::error::Notice;
use crate::nuisance::held_over;
use crate::observe::{Problem, Role};

/// Takes the others out, and tells.
pub(super) fn leave_out(problem: &mut Problem) {
    for (place, channel) in problem.channels.iter().enumerate().filter(|(_, one)| one.role == Role::Compared)
    {
        for run in &mut problem.runs {
            let series = &mut run.series[place];
            let Some(rows) = held_over(&series.values) else { continue };
            let message = format!(
                "{}: column {:?} ({}) repeats the row before in {} of {} rows, and its noise leaves no two alike by chance: readings that were held \
                 over, taken as not measured",
                run.name,
                channel.column,
                channel.name,
                rows.len(),
                series.values.len()
            );
            problem.notices.push(Notice { file: "dataset.toml".into(), line: channel.line, message });
            let mut fresh = vec![true; series.values.len()];
            rows.iter().for_each(|row| fresh[*row] = false);
            for column in [&mut series.time, &mut series.values] {
                let mut is_fresh = fresh.iter();
                column.retain(|_| is_fresh.next() == Some(&true));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::tests::swung;

    #[test]
    fn value_a_reading_that_repeats_is_measured_once() {
        let mut problem = swung("held-over", 300);
        let place = problem.channels.iter().position(|channel| channel.name.ends_with("q1"));
        let place = place.expect("it is compared");
        let values = &mut problem.runs[0].series[place].values;
        (0..300).filter(|row| row % 3 == 2).for_each(|row| values[row] = values[row - 1]);
        leave_out(&mut problem);
        let series = &problem.runs[0].series[place];
        assert_eq!((series.values.len(), series.time.len()), (200, 200));
        assert!(series.time.windows(2).all(|pair| pair[1] > pair[0]), "in order");
        let told = &problem.notices.last().expect("told").message;
        assert!(told.contains("(acrobot_plant.q1) repeats the row before in 100 of 300 rows"), "{told}");
        let notices = problem.notices.len();
        leave_out(&mut problem);
        assert_eq!(problem.notices.len(), notices, "nothing repeats any more");
    }
}
