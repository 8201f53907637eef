//! Units of time, and rows that are missing.

use super::{Facts, Finding};
use crate::observe::{SINCE_1970, units_below_seconds as units};
use crate::rigs::acrobot::dataset::row_times::{pauses_of, torque_holes_of};
use crate::rigs::acrobot::dataset::{Run, Table, typical_gap};
use crate::rigs::acrobot::plausibility::policy::PLAUSIBLE;
use crate::rigs::acrobot::policy::POLICY;
use crate::statistics::levels::SEVERAL;
use crate::text::brief;

/// Times in milliseconds, or less.
pub(super) fn unit(facts: &Facts<'_>) -> Option<Finding> {
    facts.runs.iter().find_map(|run| in_other_unit(run, facts))
}

/// A run whose frames, or whose rows of encoders, are so far apart that time must be in another unit than s.
fn in_other_unit(run: &Run, facts: &Facts<'_>) -> Option<Finding> {
    let gap = |log: &Option<Table>| log.as_ref().filter(|log| log.len() >= POLICY.rows).and_then(typical_gap);
    let fastest = facts.nominal.falling[0].max(facts.nominal.falling[1]);
    let found = |file: &str, sentence: String, unit: &str| Finding {
        file: format!("{}/{file}", run.name),
        line: 0,
        sentence,
        add: format!("time = {unit:?}"),
    };
    if let Some(gap) = gap(&run.camera) {
        let (unit, _) = units().find(|(_, by)| gap * by < PLAUSIBLE.other_unit * facts.nominal.interval)?;
        return (gap > PLAUSIBLE.other_unit * facts.nominal.interval).then(|| {
            let sentence = format!(
                "frames are {} s apart, where the nominal camera takes one each {:.4} s: time looks like {unit}",
                brief(gap),
                facts.nominal.interval
            );
            found("camera.csv", sentence, unit)
        });
    }
    let log = run
        .plant
        .as_ref()
        .filter(|log| log.column("q1").is_some_and(|q1| q1.iter().any(|x| x.is_finite())))?;
    let gap = gap(&run.plant)?;
    // counted from 1970, a time tells its unit
    let epoch = units().find(|(_, by)| SINCE_1970.contains(&(log.time[0] * by)));
    let (unit, _) = epoch.or_else(|| units().find(|(_, by)| gap * by * fastest < POLICY.coarse))?;
    (gap * fastest > POLICY.coarse).then(|| {
        let sentence = format!(
            "rows are {} s apart, and the arm loses its balance in between: time looks like {unit}",
            brief(gap)
        );
        found("plant.csv", sentence, unit)
    })
}

/// One log of a run in another unit than the others: it lasts that much longer, and nothing can be followed from row to row.
pub(super) fn units_apart(facts: &Facts<'_>) -> Option<Finding> {
    let fastest = facts.nominal.falling[0].max(facts.nominal.falling[1]);
    facts.runs.iter().find_map(|run| {
        let logs =
            [("camera.csv", &run.camera), ("controller.csv", &run.controller), ("plant.csv", &run.plant)];
        let known = logs.into_iter().filter_map(|(file, log)| Some((file, log.as_ref()?)));
        let known = known.filter(|(_, log)| log.len() >= POLICY.rows);
        let spans: Vec<(&str, f64, &Table)> =
            known.map(|(file, log)| (file, log.time[log.len() - 1] - log.time[0], log)).collect();
        let (file, longest, log) = spans.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let (other, shortest, _) = spans.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1))?;
        let alike = |by: f64| (longest * by / shortest).ln().abs() < SEVERAL.ln();
        let (unit, _) = units().find(|(_, by)| alike(*by))?;
        typical_gap(log).filter(|gap| gap * fastest > POLICY.coarse).map(|_| Finding {
            file: format!("{}/{file}", run.name),
            line: 0,
            sentence: format!(
                "it lasts {} s and {other} {} s: its times look like {unit}, and all logs need the same unit",
                brief(longest),
                brief(shortest)
            ),
            add: String::new(),
        })
    })
}

/// A time in which nothing was logged at all: frames would count as lost, and a torque as held.
pub(super) fn pauses(facts: &Facts<'_>) -> Option<Finding> {
    facts.runs.iter().filter(|_| !facts.gaps_stated).find_map(|run| {
        let (from, to) = pauses_of(run).first().copied()?;
        Some(Finding {
            file: run.name.clone(),
            line: 0,
            sentence: format!(
                "no log has a row from {from:.3} to {to:.3} s: logging paused, or these are two runs in one"
            ),
            add: "gaps = \"unknown\"".into(),
        })
    })
}

/// A time without a torque while everything else goes on: held over it, a torque looks like a spring.
pub(super) fn torque_holes(facts: &Facts<'_>) -> Option<Finding> {
    facts.runs.iter().filter(|_| !facts.gaps_stated).find_map(|run| {
        let (row, from, to) = torque_holes_of(run).first().copied()?;
        let line = run.controller.as_ref().map_or(0, |log| log.line[row]);
        Some(Finding {
            file: format!("{}/controller.csv", run.name),
            line,
            sentence: format!(
                "the torque has no row from {from:.3} to {to:.3} s, where other logs go on (if it was held, write \"known\" below)"
            ),
            add: "gaps = \"unknown\"".into(),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::dataset::Nominal;

    #[test]
    fn every_log_in_another_unit_than_the_others_is_told() {
        let each = |gap: f64| log((0..50).map(|row| f64::from(row) * gap));
        let told = |plant: f64, controller: f64| {
            let runs = [run(Some(each(plant)), Some(each(controller)), None)];
            let found = units_apart(&facts(&runs))?;
            Some((found.file, found.sentence.contains("look like ms")))
        };
        assert_eq!(told(33.3, 0.0333), Some(("run-01/plant.csv".into(), true)));
        assert_eq!(told(0.0333, 33.3), Some(("run-01/controller.csv".into(), true)));
        assert_eq!([told(0.0333, 0.0333), told(33.3, 33.3), told(0.0333, 3.33)], [None, None, None]);
    }

    /// A log of zeros with rows at these times.
    fn log(time: impl Iterator<Item = f64>) -> Table {
        let time: Vec<f64> = time.collect();
        let q1 = vec![0.0; time.len()];
        Table::new(time, vec![("q1".into(), q1)])
    }

    /// 200 rows so far apart, with a hole so long after half of them.
    fn broken(gap: f64, hole: f64) -> Table {
        log((0..200).map(|row| f64::from(row) * gap + if row < 100 { 0.0 } else { hole - gap }))
    }

    /// What is known of runs of an arm that grows by e^7 in a second.
    fn facts(runs: &[Run]) -> Facts<'_> {
        Facts {
            runs,
            nominal: Nominal {
                falling: [7.0, 7.0],
                gravity: 1.0,
                image: (640.0, 480.0),
                interval: 0.04,
                ground: None,
                links: [150.0, 180.0],
            },
            gaps_stated: false,
        }
    }

    fn run(plant: Option<Table>, controller: Option<Table>, camera: Option<Table>) -> Run {
        Run { name: "run-01".into(), camera, controller, plant }
    }

    #[test]
    fn value_logs_pause_for_a_second_and_for_ten_rows() {
        let pauses = |gap: f64, hole: f64| pauses_of(&run(Some(broken(gap, hole)), None, None)).len();
        assert_eq!([0.95, 1.05].map(|hole| pauses(0.01, hole)), [0, 1]);
        assert_eq!([1.9, 2.1].map(|hole| pauses(0.2, hole)), [0, 1]);
    }

    #[test]
    fn value_a_torque_is_missing_for_a_stretch_and_ten_rows_while_three_others_go_on() {
        let holes = |gap: f64, hole: f64, others: f64| {
            let plant = log((0..4000).map(|row| f64::from(row) * others));
            torque_holes_of(&run(Some(plant), Some(broken(gap, hole)), None)).len()
        };
        assert_eq!([0.29, 0.31].map(|hole| holes(0.01, hole, 0.01)), [0, 1]);
        assert_eq!([0.48, 0.52].map(|hole| holes(0.05, hole, 0.01)), [0, 1]);
        // from 0.99 s on: rows each 0.12 s lie there twice, each 0.09 s three times
        assert_eq!([0.12, 0.09].map(|others| holes(0.01, 0.31, others)), [0, 1]);
    }

    #[test]
    fn value_a_torque_that_is_logged_where_it_changes_misses_nothing() {
        // so many of 100 rows come a tenth of the usual time after the one before: more than a tenth, and no clock wrote them
        let holes = |early: u32| {
            let odd = (0..100)
                .map(|row| f64::from(row) * 0.01 - if row % 2 == 1 && row < 2 * early { 0.009 } else { 0.0 });
            let torque = log(odd.chain((0..100).map(|row| 1.5 + f64::from(row) * 0.01)));
            let plant = log((0..300).map(|row| f64::from(row) * 0.01));
            torque_holes_of(&run(Some(plant), Some(torque), None)).len()
        };
        // each makes two of 199 gaps odd
        assert_eq!([9, 11].map(holes), [1, 0]);
    }

    #[test]
    fn value_rows_in_which_an_arm_falls_and_frames_a_hundred_times_as_slow_are_in_other_units() {
        let told = |plant: Option<f64>, camera: Option<f64>| {
            let each = |gap: Option<f64>| gap.map(|gap| log((0..50).map(|row| f64::from(row) * gap)));
            let runs = [run(each(plant), None, each(camera))];
            unit(&facts(&runs)).is_some()
        };
        // an arm that grows by e^7 in a second loses its balance in 1.5 / 7 s
        assert_eq!([0.21, 0.22].map(|gap| told(Some(gap), None)), [false, true]);
        assert_eq!([3.9, 4.1].map(|gap| told(None, Some(gap))), [false, true]);
    }
}
