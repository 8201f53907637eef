//! Parameters whose own limits are no range around their value: a fit can't be kept within them.

use crate::common;

use crate::common::Folder;
use diagnosis::Notice;
use diagnosis::testing::load_problem;
use std::io::{Read as _, Write as _};

const LOG: &str = "time,q1\n0.0,0.1\n0.01,0.2\n0.02,0.1\n";

/// The plant with other limits of `b_joint` in its description.
fn plant_with(folder: &Folder, limits: &str) {
    let of = r#"the links; off at 0." causality="parameter" variability="tunable" initial="exact">
      <Real unit="N.m.s/rad" "#;
    let (from, to) = (format!(r#"{of}min="0.0" start="0.0""#), format!("{of}{limits}"));
    let packed = common::root().join("target/fmus/acrobot_plant.fmu");
    let mut archive = zip::ZipArchive::new(std::fs::File::open(packed).expect("packed")).expect("an archive");
    let altered = std::fs::File::create(folder.path().join("altered.fmu")).expect("writable");
    let mut altered = zip::ZipWriter::new(altered);
    for place in 0..archive.len() {
        let mut entry = archive.by_index(place).expect("an entry");
        let name = entry.name().expect("UTF-8").into_owned();
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).expect("readable");
        if name == "modelDescription.xml" {
            let text = String::from_utf8(bytes).expect("UTF-8");
            assert!(text.contains(&from), "{from}");
            bytes = text.replace(&from, &to).into_bytes();
        }
        altered.start_file(name, zip::write::SimpleFileOptions::default()).expect("a new entry");
        altered.write_all(&bytes).expect("written");
    }
    altered.finish().expect("finished");
}

#[test]
fn bad_limits_of_a_parameter_are_told_and_leave_it_out() {
    // limits that don't hold the start value, and limits that are exchanged
    for (limits, told) in [
        (r#"start="0" min="1""#, "b_joint = 0 lies outside of its own limits, 1 to inf"),
        (r#"start="0" min="0" max="-1""#, "b_joint = 0 lies outside of its own limits, 0 to -1"),
    ] {
        let folder = Folder::new("limits");
        plant_with(&folder, limits);
        folder.put("a.csv", LOG);
        let load = |candidate: &str| {
            let set = format!(
                "format = 2\nfmu = \"altered.fmu\"\n{candidate}[[channel]]\nvariable = \"altered.q1\"\n[[run]]\nfile = \"a.csv\"\n"
            );
            folder.put("dataset.toml", &set);
            load_problem(folder.path(), &common::units(), None)
        };
        let problem = load("").unwrap_or_else(|error| panic!("{error}"));
        let candidates: Vec<&str> =
            problem.candidates.iter().map(|candidate| candidate.name.as_str()).collect();
        assert!(candidates.iter().any(|name| name.ends_with(".b_roll")), "{candidates:?}");
        assert!(!candidates.iter().any(|name| name.ends_with(".b_joint")), "{candidates:?}");
        let said =
            |notice: &Notice| notice.message.contains(told) && notice.message.ends_with("is no candidate");
        assert!(problem.notices.iter().any(said), "{:?}", problem.notices);
        let error = load("[[candidate]]\nvariable = \"altered.b_joint\"\n").expect_err("listed").to_string();
        assert!(error.contains("dataset.toml:4: ") && error.contains(told), "{error}");
    }
}
