//! The measured inputs of a run in the amended scenario, so that running it gives a trajectory to lay beside the log.
//!
//! Where the reference was logged and the scenario has a controller, the loop stays closed and follows that reference: a plant that is
//! unstable leaves any log within a second when it is driven by the logged torque alone. Else the controller goes, and the logged torque
//! drives the plant. Either way the run begins in the state that the log shows at its beginning.

use crate::rigs::acrobot::dataset::{DataSet, Run, Table, directions};
use crate::rigs::acrobot::policy::POLICY;
use orchestrator::Place;
use orchestrator::scenario::{Scenario, Shape, SignalEntry, SourceEntry};

/// Puts the inputs of the first run that has any into a scenario; what was done, in words, or `None` where nothing was logged. The links
/// touch at `limit`, where the scenario has one.
pub fn insert(scenario: &mut Scenario, data: &DataSet, limit: Option<f64>) -> Option<String> {
    let (run, log) = data.runs.iter().find_map(|run| Some((run, run.controller.as_ref()?)))?;
    let (from, to) = run.span();
    let begin = from.max(log.time.first().copied()?);
    let fed = |scenario: &Scenario, to: &str| scenario.sources.iter().any(|source| source.to == to);
    let reference = "controller.z_desired";
    let words = if fed(scenario, reference) && measured(log, "z_desired") {
        feed(scenario, reference, points(log, "z_desired", begin)?);
        "the logged z_desired"
    } else {
        without_controller(scenario);
        feed(scenario, "plant.tau", points(log, "tau", begin)?);
        "the logged torque"
    };
    if measured(log, "tau_1") {
        feed(scenario, "plant.tau_1", points(log, "tau_1", begin)?);
    }
    let state = state(run, begin)?;
    for (name, value) in ["q1_0", "q2_0", "dq1_0", "dq2_0"].into_iter().zip(state) {
        scenario.set(&format!("plant.{name}"), &format!("{value:?}")).ok()?;
    }
    // a whole millisecond, which any step reaches
    scenario.set_stop(&format!("{:.3}", ((to - begin) * 1e3).floor().max(1.0) * 1e-3)).ok()?;
    scenario.description = described(run, words, limit.map(|limit| data.contact(limit)));
    Some(format!("{words} of {}, from {begin} s of its log on", run.name))
}

/// The title of the amended model's run. That it loses its balance is then no fault of the model.
fn described(run: &Run, words: &str, contact: Option<f64>) -> String {
    let fell = contact.and_then(|contact| run.touches(contact)).is_some();
    let end = if fell { ", which lost its balance" } else { "" };
    format!("The amended model beside {}{end}: {words}", run.name)
}

/// Whether a log has numbers in a column.
fn measured(log: &Table, name: &str) -> bool {
    log.column(name).is_some_and(|values| values.iter().any(|value| value.is_finite()))
}

/// What a log has from a time on, counted from there.
fn points(log: &Table, name: &str, begin: f64) -> Option<Vec<(f64, f64)>> {
    let rows = log.time.iter().zip(log.column(name)?).filter(|(_, value)| value.is_finite());
    let points: Vec<(f64, f64)> = rows.map(|(time, value)| (time - begin, *value)).collect();
    (!points.is_empty()).then_some(points)
}

/// Feeds an input, whatever fed it before.
fn feed(scenario: &mut Scenario, to: &str, points: Vec<(f64, f64)>) {
    scenario.connections.retain(|connection| connection.to != to);
    scenario.sources.retain(|source| source.to != to);
    let signal = SignalEntry::Table { shape: Shape::Hold, points };
    scenario.sources.push(SourceEntry {
        to: to.into(),
        signal,
        place: Place::Override("the replayed log".into()),
    });
}

/// Takes the controller out of a scenario, and all that names its signals.
fn without_controller(scenario: &mut Scenario) {
    let own = |variable: &str| variable.starts_with("controller.");
    scenario.connections.retain(|entry| !own(&entry.from) && !own(&entry.to));
    scenario.sources.retain(|entry| !own(&entry.to));
    scenario.units.retain(|unit| unit.name != "controller");
    if let Some(record) = &mut scenario.record {
        record.retain(|pattern| !own(&pattern.value));
    }
    forget(&mut scenario.report);
}

/// Takes what names a signal of the controller out of a part of the report, and graphs that have no line left.
fn forget(part: &mut toml::Table) {
    let own = |value: &toml::Value| value.as_str().is_some_and(|text| text.starts_with("controller."));
    let names_it = |table: &toml::Table| table.values().any(own);
    let empty = |table: &toml::Table| table.values().any(|value| value.as_array().is_some_and(Vec::is_empty));
    for value in part.iter_mut().map(|(_, value)| value) {
        match value {
            toml::Value::Table(inner) => forget(inner),
            toml::Value::Array(entries) => {
                entries.iter_mut().filter_map(toml::Value::as_table_mut).for_each(forget);
                entries
                    .retain(|entry| !entry.as_table().is_some_and(|table| names_it(table) || empty(table)));
            }
            _ => {}
        }
    }
    part.retain(|_, value| !value.as_table().is_some_and(names_it));
}

/// Angles and rates at a time, by a line through the first rows after it: of encoders, or of the links in the images.
fn state(run: &Run, begin: f64) -> Option<[f64; 4]> {
    let logged: Option<Vec<(f64, [f64; 2])>> = run.plant.as_ref().and_then(|log| {
        let (q1, q2) = (log.column("q1")?, log.column("q2")?);
        Some((0..log.len()).map(|row| (log.time[row], [q1[row], q2[row]])).collect())
    });
    let rows = logged.or_else(|| run.camera.as_ref().map(directions))?;
    let known = |row: &&(f64, [f64; 2])| row.0 >= begin && row.1.iter().all(|angle| angle.is_finite());
    let after: Vec<&(f64, [f64; 2])> = rows.iter().filter(known).collect();
    let count = after
        .iter()
        .take_while(|row| row.0 <= after[0].0 + POLICY.replay_first)
        .count()
        .max(POLICY.replay_rows)
        .min(after.len());
    let near = after.get(..count).filter(|near| near.len() >= 2)?;
    let n = near.len() as f64;
    let mean_time = near.iter().map(|row| row.0).sum::<f64>() / n;
    let line = |link: usize| {
        let mean = near.iter().map(|row| row.1[link]).sum::<f64>() / n;
        let along: f64 = near.iter().map(|row| (row.0 - mean_time) * (row.1[link] - mean)).sum();
        let rate = along / near.iter().map(|row| (row.0 - mean_time).powi(2)).sum::<f64>();
        (mean + rate * (begin - mean_time), rate)
    };
    let ((q1, dq1), (q2, dq2)) = (line(0), line(1));
    Some([q1, q2, dq1, dq2]).filter(|state| state.iter().all(|value| value.is_finite()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shipped_scenario_shows_nothing_of_a_controller_that_is_gone() {
        for name in ["visual-servo", "full-state", "dual-loop"] {
            let path = format!("{}/../scenarios/{name}.toml", env!("CARGO_MANIFEST_DIR"));
            let text = std::fs::read_to_string(path).expect("it is shipped");
            let mut scenario = Scenario::parse(&text, name).expect("it loads");
            without_controller(&mut scenario);
            let report = scenario.report.to_string();
            assert!(!report.contains("controller.") && report.contains("plant.q1"), "{name}: {report}");
            assert!(scenario.report.contains_key("verdict"), "{name}");
        }
    }

    #[test]
    fn law_a_run_that_lost_its_balance_is_told_as_such() {
        let q2 = vec![0.1, 0.9, 2.35];
        let plant = Table::new(vec![0.0, 0.1, 0.2], vec![("q1".into(), vec![0.0; 3]), ("q2".into(), q2)]);
        let run = Run { name: "run-01".into(), camera: None, controller: None, plant: Some(plant) };
        let told = |contact| described(&run, "the logged torque", contact);
        assert_eq!(
            told(Some(2.35)),
            "The amended model beside run-01, which lost its balance: the logged torque"
        );
        for contact in [None, Some(f64::INFINITY), Some(3.0)] {
            assert_eq!(told(contact), "The amended model beside run-01: the logged torque");
        }
    }

    #[test]
    fn value_a_run_begins_in_the_state_that_its_log_shows() {
        let time: Vec<f64> = (0..30).map(|row| 10.0 + f64::from(row) / 30.0).collect();
        let line =
            |at: f64, rate: f64| time.iter().map(|time| at + rate * (time - 10.5)).collect::<Vec<f64>>();
        let plant =
            Table::new(time.clone(), vec![("q1".into(), line(0.1, 0.5)), ("q2".into(), line(-0.2, 2.0))]);
        let run = Run { name: "run-01".into(), camera: None, controller: None, plant: Some(plant) };
        let found = state(&run, 10.4).expect("it was logged");
        for (found, wanted) in found.iter().zip([0.05, -0.4, 0.5, 2.0]) {
            assert!((found - wanted).abs() < 1e-9, "{found} {wanted}");
        }
    }
}
