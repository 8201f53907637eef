//! `acroscope run` as a person types it: what is said first is true, and nothing old stands beside anything new. The
//! packed units must be there: `cargo xtask pack`.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// Runs in a folder of its own, where `out/` then lies.
fn acroscope(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_acroscope"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("the program starts")
}

fn done(folder: &Path, arguments: &[&str]) -> String {
    let output = acroscope(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn read(path: impl AsRef<Path>) -> String {
    let path = path.as_ref();
    std::fs::read_to_string(path).unwrap_or_else(|why| panic!("{}: {why}", path.display()))
}

fn summary(out: PathBuf) -> Value {
    serde_json::from_str(&read(out.join("summary.json"))).expect("JSON")
}

/// A column of results.csv, and the times.
fn column(out: &Path, name: &str) -> Vec<(f64, f64)> {
    let mut reader = csv::Reader::from_path(out.join("results.csv")).expect("readable");
    let at = reader.headers().expect("a head").iter().position(|head| head == name).expect("recorded");
    let number = |cell: &str| cell.parse::<f64>().expect("a number");
    reader.records().map(|row| row.expect("a row")).map(|row| (number(&row[0]), number(&row[at]))).collect()
}

#[test]
fn law_a_fall_is_told_first_and_under_its_own_title() {
    let folder = folder();
    let text = done(folder.path(), &["run", "visual-servo", "--set", "camera.T_delay=0.05", "--stop", "4"]);
    let out = folder.path().join("out/visual-servo+camera.T_delay=0.05+stop=4");
    let fell = column(&out, "plant.contact").iter().find(|(_, contact)| *contact == 1.0).expect("it falls").0;
    // Four digits are shown.
    let words = format!("lost balance at t = {fell:.3} s");
    assert!(text.starts_with(&words), "{text}");

    let title = "visual-servo with camera.T_delay = 0.05, to t = 4 s";
    let page = read(out.join("report.html"));
    assert!(page.contains(&format!("<h1>{title}</h1>")) && !page.contains("Figure 19"), "the figure's title");
    assert!(page.find(&words) < page.find("<svg"), "before the graphs");
    assert!(read(out.join("resolved.toml")).contains(title));

    let summary = summary(out.clone());
    assert_eq!(summary["verdict"]["standing"], "bad");
    // serde_json reads a double to its last digit but one.
    let same = |value: &Value, other: f64| {
        value.as_f64().is_some_and(|value| (value - other).abs() <= 1e-12 * other)
    };
    assert!(same(&summary["failed_at"], fell));
    // Against the rows themselves, up to the fall.
    let before = |name: &str| -> Vec<f64> {
        column(&out, name).iter().filter(|(time, _)| *time <= fell).map(|(_, value)| *value).collect()
    };
    let figure = |label: &str| {
        let figures = summary["verdict"]["figures"].as_array().expect("a list").clone();
        figures.into_iter().find(|figure| figure["label"] == label).expect(label)
    };
    let peak = before("controller.tau").iter().fold(0.0, |peak: f64, tau| peak.max(tau.abs()));
    assert!(same(&figure("peak torque")["value"], peak));
    assert_eq!(figure("peak torque")["unit"], "N.m");
    let (wanted, z) = (before("controller.z_desired"), before("plant.z"));
    let squares: f64 = wanted.iter().zip(&z).map(|(wanted, z)| (wanted - z).powi(2)).sum();
    let rms = figure("rms tracking error")["value"].as_f64().expect("a number");
    // Sums in the same order differ by nothing but the text's last digit.
    assert!((rms - (squares / z.len() as f64).sqrt()).abs() < 1e-12, "{rms}");
}

#[test]
fn law_a_needle_after_the_fall_does_not_set_the_scale() {
    let folder = folder();
    done(
        folder.path(),
        &["run", "visual-servo", "--set", "camera.T_delay=0.05", "--stop", "4", "--out", "o"],
    );
    let torque = column(&folder.path().join("o"), "controller.tau");
    let largest = torque.iter().fold(0.0, |peak: f64, (_, tau)| peak.max(tau.abs()));
    assert!(largest > 100.0, "there is a needle: {largest}");
    let page = read(folder.path().join("o/report.html"));
    assert!(page.contains("scaled up to then"), "and the graph says so");
    let graph = page.split("<svg").find(|svg| svg.contains("N·m")).expect("the graph of the torque");
    let ticks = graph
        .split("</text>")
        .filter_map(|text| text.trim_end().rsplit('\n').next()?.trim().parse::<f64>().ok());
    let highest = ticks.fold(0.0, f64::max);
    assert!(highest > 0.0 && highest < 100.0, "the axis ends at {highest}");
}

#[test]
fn law_a_balanced_run_says_so_and_where_it_comes_from() {
    let folder = folder();
    let text = done(folder.path(), &["run", "visual-servo", "--stop", "1"]);
    assert!(text.starts_with("balanced to t = 1 s\n"), "{text}");
    assert!(
        text.contains("unseen frames 0") && text.contains("again: acroscope run visual-servo --stop 1"),
        "{text}"
    );
    let summary = summary(folder.path().join("out/visual-servo+stop=1"));
    assert_eq!(summary["verdict"]["standing"], "good");
    assert_eq!(summary["rows"], 601);
    let provenance = &summary["provenance"];
    assert_eq!(provenance["program"]["version"], env!("CARGO_PKG_VERSION"));
    // Against sha256sum, and the GUIDs against the committed descriptions.
    let sum = |path: &str| {
        let output = Command::new("sha256sum").arg(path).output().expect("coreutils are there");
        String::from_utf8_lossy(&output.stdout).split_whitespace().next().unwrap_or_default().to_owned()
    };
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    assert_eq!(provenance["inputs"][0]["sha256"], sum(&format!("{root}/scenarios/visual-servo.toml")));
    for unit in provenance["units"].as_array().expect("a list") {
        let stem = unit["file"].as_str().and_then(|file| file.strip_suffix(".fmu")).expect("a unit");
        let description = read(format!("{root}/modelDescriptions/{stem}.xml"));
        let guid = unit["guid"].as_str().expect("a text");
        assert!(description.contains(&format!("guid=\"{guid}\"")), "{stem}");
    }
    assert_eq!(provenance["units"].as_array().map(Vec::len), Some(3));
    let page = read(folder.path().join("out/visual-servo+stop=1/report.html"));
    for said in
        ["Where this comes from", "acroscope run visual-servo --stop 1", "acrobot_camera.fmu", "commit "]
    {
        assert!(page.contains(said), "{said}");
    }
}

#[test]
fn value_lost_frames_are_counted() {
    let folder = folder();
    let lost = ["run", "visual-servo", "--set", "camera.drop_rate=0.2", "--stop", "3", "--out", "o"];
    done(folder.path(), &lost);
    let out = folder.path().join("o");
    let last = |name: &str| column(&out, name).last().expect("a row").1;
    // Frames 0 to k, of which so many were delivered; the vision finds the circles in each.
    let expected = last("camera.frame_index") + 1.0 - last("camera.frame");
    assert!(expected > 5.0, "18 of 90 on average: {expected}");
    let figures = summary(out)["verdict"]["figures"].as_array().cloned().expect("a list");
    let counted = figures.iter().find(|figure| figure["label"] == "unseen frames").expect("counted");
    assert_eq!(counted["value"], expected);
}

#[test]
fn law_equal_input_gives_equal_bytes_wherever_it_is_written() {
    let folder = folder();
    for out in ["one", "other/place"] {
        done(folder.path(), &["run", "full-state", "--stop", "1", "--set", "plant.q1_0=-0.04", "--out", out]);
    }
    for file in ["results.csv", "report.html", "summary.json", "resolved.toml"] {
        let at = |out: &str| read(folder.path().join(out).join(file));
        assert!(at("one") == at("other/place"), "{file} differs");
    }
}

#[test]
fn law_what_was_asked_differently_goes_elsewhere() {
    let folder = folder();
    done(folder.path(), &["run", "full-state", "--stop", "0.5"]);
    done(folder.path(), &["run", "full-state", "--stop", "0.5", "--set", "plant.q1_0=-0.04"]);
    assert!(folder.path().join("out/full-state+stop=0.5/report.html").exists());
    assert!(folder.path().join("out/full-state+plant.q1_0=-0.04+stop=0.5/report.html").exists());
}

#[test]
fn law_a_refused_run_leaves_nothing() {
    let folder = folder();
    let wrong: [&[&str]; 6] = [
        &["run", "visual-servo", "--set", "plant.q1_0=nan"],
        &["run", "visual-servo", "--set", "camera.k9=1"],
        &["run", "visual-servo", "--stop", "soon"],
        &["run", "visual-servo", "--stop", "-1"],
        // Seen by the unit only, when it is initialised.
        &["run", "visual-servo", "--set", "camera.k1=-5"],
        &["run", "visual-sevro"],
    ];
    for arguments in wrong {
        let output = acroscope(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let left: Vec<_> = std::fs::read_dir(folder.path()).expect("readable").flatten().collect();
        assert!(left.is_empty(), "{arguments:?} left {left:?}");
    }
    let text = String::from_utf8_lossy(&acroscope(folder.path(), wrong[0]).stderr).into_owned();
    assert!(text.contains("a finite number in rad"), "{text}");
    let text = String::from_utf8_lossy(&acroscope(folder.path(), wrong[3]).stderr).into_owned();
    assert!(text.contains("stop = -1: not before the start, 0 s"), "{text}");
}

#[test]
fn law_no_old_report_stands_beside_new_rows() {
    let folder = folder();
    let out = folder.path().join("o");
    done(folder.path(), &["run", "full-state", "--stop", "1", "--out", "o"]);
    // Refused before it begins: what was there stays, whole.
    let output = acroscope(folder.path(), &["run", "full-state", "--set", "plant.q9=1", "--out", "o"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(out.join("report.html").exists() && out.join("results.csv").exists());
    // Fails at 0.5 s: the rows are new, and so is the report.
    std::fs::write(folder.path().join("bad.csv"), "time,z\n0,0\n0.5,0\n0.5001,1e300\n").expect("writable");
    let scenario = read(concat!(env!("CARGO_MANIFEST_DIR"), "/../scenarios/full-state.toml"));
    let broken = scenario.replace(
        "kind = \"smooth\"\npoints = [[0, 0], [2, 0], [12, 0.5], [15, 0.5], [25, 0], [30, 0]]",
        "kind = \"csv\"\nfile = \"bad.csv\"\ncolumn = \"z\"",
    );
    assert_ne!(broken, scenario, "the source is replaced");
    std::fs::write(folder.path().join("broken.toml"), broken).expect("writable");
    let output = acroscope(folder.path(), &["run", "broken.toml", "--stop", "5", "--out", "o"]);
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{text}");
    let rows = column(&out, "plant.q1");
    assert!(rows.len() > 250 && rows.len() < 601, "{} rows up to the failure", rows.len());
    let summary = summary(out.clone());
    assert_eq!(summary["ended"]["how"], "error");
    assert_eq!(summary["rows"], rows.len());
    assert!(read(out.join("report.html")).contains("ended by an error"));
}

#[test]
fn law_a_run_that_a_unit_refuses_leaves_older_results() {
    let folder = folder();
    let out = folder.path().join("o");
    let first = ["run", "visual-servo", "--stop", "0.5", "--checkpoint", "0.2", "--out", "o"];
    done(folder.path(), &[&first[..], &["--set", "camera.frames_every=5"]].concat());
    let files = |folder: &Path| -> Vec<(PathBuf, Vec<u8>)> {
        let mut found: Vec<_> = std::fs::read_dir(folder)
            .expect("readable")
            .map(|entry| entry.expect("readable").path())
            .filter(|path| path.is_file())
            .map(|path| (path.clone(), std::fs::read(path).expect("readable")))
            .collect();
        found.sort();
        found
    };
    let before = (files(&out), files(&out.join("frames")));
    assert!(before.0.len() == 5 && before.1.len() > 1, "results, a checkpoint, pictures");
    // Seen by the unit only, when it is initialised.
    for more in [&["--mcap"][..], &[]] {
        let refused = ["run", "visual-servo", "--set", "camera.k1=-5", "--out", "o"];
        let output = acroscope(folder.path(), &[&refused[..], more].concat());
        assert_eq!(output.status.code(), Some(2));
        assert!((files(&out), files(&out.join("frames"))) == before, "something is new or gone");
    }
    // One that begins takes all of it away.
    done(folder.path(), &["run", "visual-servo", "--stop", "0.1", "--out", "o"]);
    assert!(!out.join("checkpoint.bin").exists() && files(&out).len() == 4);
    let pictures = files(&out.join("frames"));
    assert!(pictures.len() < before.1.len());
    // The camera writes the first one when it is initialised, before what was there is taken away.
    assert_eq!(pictures[0].0.file_name().expect("named"), "frame_000000.png");
}

#[test]
fn law_a_scenario_without_a_report_gets_graphs_of_its_outputs() {
    let folder = folder();
    let scenario = read(concat!(env!("CARGO_MANIFEST_DIR"), "/../scenarios/full-state.toml"));
    let bare = scenario.split("[[report.graphs]]").next().and_then(|text| text.split("[report").next());
    std::fs::write(folder.path().join("bare.toml"), bare.expect("a beginning")).expect("writable");
    let text = done(folder.path(), &["run", "bare.toml", "--stop", "1"]);
    assert!(text.starts_with("ran to t = 1 s"), "{text}");
    let page = read(folder.path().join("out/bare+stop=1/report.html"));
    assert!(page.contains("Outputs of plant, rad/s") && page.contains("Outputs of controller, N.m"));
    assert!(page.matches("<svg").count() >= 4, "angles, rates, torques have a graph each");
}

#[test]
fn bad_input_a_mistake_in_the_report_is_told_with_its_line() {
    const HEAD: &str = "format = 1\nexperiment = { stop = 1.0 }\n[[units]]\nname = \"plant\"\nfmu = \"acrobot_plant.fmu\"\ninterval = 0.1\n\
        [report]\ntitle = \"a\"\n";
    let known = HEAD.replace("title = \"a\"\n", "");
    let folder = folder();
    for (head, table, expected) in [
        (HEAD, "", "mine.toml:8: [report]: unknown field `title`"),
        (
            &known,
            "[[report.graphs]]\ntitle = \"t\"\ny = \"y\"\nlines = [\n{ signal = \"plant.q9\" }]\n",
            "mine.toml:12: [report]: `plant.q9` is shown",
        ),
        (
            &known,
            "[report.verdict]\nfails_when = \"plant.q1\"\n",
            "mine.toml:9: [report]: `plant.q1` is of type Real: fails_when wants a Boolean",
        ),
        (
            &known,
            "[report.verdict]\nfigures = [\n{ label = \"d\", signal = \"plant.q1\", minus = \"plant.dq1\", reduce = \"rms\" }]\n",
            "mine.toml:10: [report]: minus = \"plant.dq1\": plant.q1 is in rad, plant.dq1 in rad/s",
        ),
        (
            &known,
            "[report.picture]\ncaption = \"c\"\nunit = \"plant\"\ndirectory = \"d\"\nindex = \"q1\"\nmarks = [[\"q1\", \"q2\", \"z\"]]\n",
            "mine.toml:13: [report]: a mark of 3 names: two outputs are wanted, u and v",
        ),
        (
            &known,
            "[[sources]]\nto = \"plant.tau\"\nkind = \"linear\"\npoints = [[0, 0, 1]]\n",
            "a point of 3 numbers: expected [time, value]",
        ),
    ] {
        std::fs::write(folder.path().join("mine.toml"), format!("{head}{table}")).expect("a file");
        let refused = acroscope(folder.path(), &["run", "mine.toml"]);
        let told = String::from_utf8_lossy(&refused.stderr);
        assert!(refused.status.code() == Some(2) && told.contains(expected), "{table}: {told}");
        assert!(told.contains("mine.toml:"), "{told}");
    }
}

#[test]
fn bad_input_a_driven_input_is_refused_and_nothing_is_written() {
    let folder = folder();
    let refused = acroscope(folder.path(), &["run", "visual-servo", "--set", "controller.z_desired=0.3"]);
    let told = String::from_utf8_lossy(&refused.stderr);
    let text = read(concat!(env!("CARGO_MANIFEST_DIR"), "/../scenarios/visual-servo.toml"));
    let driver = text.split("[[sources]]").next().expect("there is one").lines().count() + 1;
    assert_eq!(
        told.trim_end(),
        format!(
            "error: --set controller.z_desired=0.3: controller.z_desired is driven: its signal at \
             scenarios/visual-servo.toml:{driver} would overwrite it"
        )
    );
    assert!(refused.status.code() == Some(2) && !folder.path().join("out").exists());
}
