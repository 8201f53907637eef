//! What `record` writes of a finished run.

use crate::common::Folder;
use diagnosis::rigs::acrobot::record::{Recording, record, recorded};
use std::path::Path;

/// Encoders that read every row as it is, 100 times a second.
fn exact(torque_noise: Option<f64>) -> Recording {
    Recording { encoder_noise: 0.0, encoder_rate: 100.0, torque_noise, ..Recording::default() }
}

/// Records one run and answers what stands in a file of it, or of the set.
fn written(name: &str, results: &str, recording: &Recording, file: &str) -> String {
    let folder = Folder::new(name);
    folder.put("run/results.csv", results);
    folder.put(
        "run/resolved.toml",
        "[[units]]\nname = \"plant\"\n[units.set]\nk_tau = 1.0\n\n\
         [[units]]\nname = \"camera\"\n[units.set]\nomega_cam = 50.0\nT_delay = 0.014\n",
    );
    record(&[folder.path().join("run")], &folder.path().join("set"), recording).expect("it can be recorded");
    std::fs::read_to_string(folder.path().join("set").join(file)).expect("it was written")
}

#[test]
fn value_a_frame_is_stamped_when_it_was_ready() {
    // frame 1 was ready at 0.034 s, frame 2 (which no clock would have in this step) is left with its row
    let results = "time,camera.u1,camera.frame,camera.frame_index\n0,0,0,-1\n0.03,0,0,-1\n0.04,2.5,1,1\n0.05,2.5,1,1\n0.06,3.5,2,5\n";
    let camera = written("stamps", results, &exact(None), "run-01/camera.csv");
    assert_eq!(camera, "time,u1,frame\n0.034,2.5,1\n0.06,3.5,2\n");
}

#[test]
fn value_the_torque_is_logged_where_it_is_asked_for() {
    let results =
        "time,plant.q1,plant.q2,plant.tau_applied,controller.tau\n0,0.1,0.2,0,1\n0.01,0.11,0.21,0.5,1\n";
    let plant = written("torque", results, &exact(Some(0.0)), "run-01/plant.csv");
    assert_eq!(plant, "time,q1,q2,tau_applied\n0,0.1,0.2,0\n0.01,0.11,0.21,0.5\n");
    let plant = written("no-torque", results, &exact(None), "run-01/plant.csv");
    assert_eq!(plant, "time,q1,q2\n0,0.1,0.2\n0.01,0.11,0.21\n");
    let noise = written("noise", results, &exact(Some(0.01)), "dataset.toml");
    assert!(noise.contains("[noise]\n\"plant.tau_applied\" = 1e-2\n"), "{noise}");
}

#[test]
fn value_encoders_are_logged_where_no_applied_torque_is() {
    let results = "time,plant.q1,plant.q2,controller.tau\n0,0.1,0.2,1\n0.01,0.11,0.21,1\n";
    let plant = written("no-applied-torque", results, &exact(None), "run-01/plant.csv");
    assert_eq!(plant, "time,q1,q2\n0,0.1,0.2\n0.01,0.11,0.21\n");
}

#[test]
fn value_a_torque_without_a_controller_acts_from_the_row_before() {
    // a row has the input of the step that it ends
    let results =
        "time,plant.tau,plant.tau_1,plant.q1,plant.q2\n0,0,0,0.1,0.2\n0.01,0,0,0.1,0.2\n0.02,0.4,0,0.1,0.2\n";
    let controller = written("driven", results, &exact(None), "run-01/controller.csv");
    assert_eq!(controller, "time,tau,tau_1\n0,0,0\n0.01,0.4,0\n");
    // the first row may have an input that no step was driven with
    let results = "time,plant.tau,plant.q1,plant.q2\n0,0,0.1,0.2\n0.01,0.3,0.1,0.2\n0.02,0.4,0.1,0.2\n";
    let controller = written("driven-at-once", results, &exact(None), "run-01/controller.csv");
    assert_eq!(controller, "time,tau\n0,0.3\n0.01,0.4\n");
}

#[test]
fn refuses_a_run_of_other_units() {
    let folder = Folder::new("others");
    folder.put("run/results.csv", "time,arm.angle\n0,1\n");
    let found = record(&[folder.path().join("run")], Path::new("unused"), &exact(None));
    let message = found.expect_err("nothing can be logged").to_string();
    assert!(message.contains("results.csv:1") && message.contains("plant (q1, q2, tau)"), "{message}");
    assert!(!Path::new("unused").exists());
}

#[test]
fn law_an_earlier_data_set_goes_when_the_new_one_is_there() {
    let folder = Folder::new("replaced");
    let results =
        "time,plant.q1,plant.q2,plant.tau_applied,controller.tau\n0,0.1,0.2,0,1\n0.01,0.11,0.21,0.5,1\n";
    folder.put("run/results.csv", results);
    let (out, run) = (folder.path().join("set"), folder.path().join("run"));
    // where a folder of the new one would be is a file
    folder.put("set/run-02", "measured");
    folder.put("set/run-01/camera.csv", "measured, too");
    let old = [out.join("run-01/camera.csv"), out.join("run-02")];
    let twice = recorded(&[run.clone(), run.clone()], &exact(None)).expect("it can be recorded");
    assert!(twice.write(&out, &old).is_err());
    let left = std::fs::read_dir(out.join("run-01")).expect("it was there").count();
    assert!(old.iter().all(|path| path.is_file()) && left == 1, "{left} files");
    assert!(recorded(&[run.clone(), folder.path().join("missing")], &exact(None)).is_err());

    recorded(&[run], &exact(None)).expect("it can be recorded").write(&out, &old[..1]).expect("written");
    assert!(!old[0].exists() && out.join("run-01/plant.csv").is_file() && out.join("dataset.toml").is_file());
    assert!(!out.join("dataset.toml.new").exists());
}
