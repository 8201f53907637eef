//! `acroscope reproduce` as a person types it. The packed units must be there: `cargo xtask pack`.

use std::process::{Command, Output};

fn acroscope(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_acroscope")).args(arguments).output().expect("the program starts")
}

#[test]
fn paper_one_study_by_the_name_of_a_claim() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("made if it is missing");
    let output = acroscope(&["reproduce", "C25", "--out", &out.to_string_lossy()]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(
        text.contains("1 of 1 statements of the paper hold; beside them: 6 of 6")
            && text.contains("index.html"),
        "{text}"
    );

    let claims = std::fs::read_to_string(out.join("claims.json")).expect("written");
    for key in ["id", "kind", "quantity", "paper", "ours", "tolerance", "holds"] {
        assert!(claims.contains(&format!("\"{key}\":")), "claims.json lacks {key}");
    }
    assert!(claims.contains("\"id\": \"T3.k1\""), "{claims}");
    let page = std::fs::read_to_string(out.join("index.html")).expect("written");
    assert!(page.contains("Table 3") && !page.contains("=\"http"), "the page needs nothing from elsewhere");
}

#[test]
fn law_parts_on_many_machines_are_the_studies_on_one() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let ids = ["tables-1-2", "figure-11", "table-3"];
    let call = |out: &str, more: &[&str]| {
        let out = folder.path().join(out).to_string_lossy().into_owned();
        let output = acroscope(&[&["reproduce"], &ids[..], &["--out", &out], more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    };
    let read = |out: &str, name: &str| std::fs::read(folder.path().join(out).join(name)).expect("written");
    call("one", &[]);
    call("parts", &["--partition", "2/2"]);
    let studies = |out: &str| {
        let mut names: Vec<_> = std::fs::read_dir(folder.path().join(out).join("studies"))
            .expect("readable")
            .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
            .filter(|name| name.ends_with(".json"))
            .collect();
        names.sort();
        names
    };
    assert_eq!(studies("parts").len(), 1, "of three studies the second part has one");
    call("parts", &["--partition", "1/2"]);
    assert_eq!(studies("parts"), studies("one"));
    for name in ["claims.json", "index.html"] {
        assert!(read("parts", name) == read("one", name), "{name}");
    }
    let page = String::from_utf8(read("parts", "index.html")).expect("a page");
    assert!(
        page.contains("acroscope reproduce tables-1-2 figure-11 table-3<"),
        "all that it holds, not the last call's"
    );
    // A part that is there is not made again; one that is missing or of another program is.
    let [kept, lost, old] = ["table-3", "figure-11", "tables-1-2"]
        .map(|id| folder.path().join(format!("parts/studies/{id}.json")));
    let made = std::fs::metadata(&kept).and_then(|file| file.modified()).expect("a time");
    std::fs::remove_file(&lost).expect("was there");
    let text = std::fs::read_to_string(&old).expect("readable");
    std::fs::write(&old, text.replacen("\"version\":\"", "\"version\":\"0.0.0-", 1)).expect("writable");
    call("parts", &["--partition", "1/1"]);
    assert_eq!(std::fs::metadata(&kept).and_then(|file| file.modified()).expect("a time"), made);
    assert_eq!(std::fs::read_to_string(&old).expect("readable"), text);
    assert!(read("parts", "index.html") == read("one", "index.html"));
}

#[test]
fn law_an_unknown_id_ends_with_status_2_and_names_those_there_are() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = acroscope(&["reproduce", "table-9", "--out", &folder.path().to_string_lossy()]);
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.contains("`table-9`: did you mean table-3"), "{text}");
    assert!(text.contains("there are figures-1-2, "), "{text}");
    assert!(!folder.path().join("claims.json").exists());
}

#[test]
fn law_a_folder_that_cannot_be_made_ends_with_status_2() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("file");
    std::fs::write(&file, "in the way").expect("writable");
    let output = acroscope(&["reproduce", "table-3", "--out", &file.join("below").to_string_lossy()]);
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.contains("below"), "{text}");
}

#[test]
fn law_quiet_prints_errors_only() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = acroscope(&["--quiet", "reproduce", "figure-9", "--out", &folder.path().to_string_lossy()]);
    assert_eq!(output.status.code(), Some(0));
    assert!(output.stdout.is_empty() && output.stderr.is_empty());
}

#[test]
fn law_a_pipe_closed_by_its_reader_is_no_error() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut child = Command::new(env!("CARGO_BIN_EXE_acroscope"))
        .args(["reproduce", "figure-9", "--out", &folder.path().to_string_lossy()])
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn law_a_later_call_joins_what_is_there() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().to_string_lossy().into_owned();
    let reproduce = |id: &str| {
        let output = acroscope(&["reproduce", id, "--out", &out]);
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect("written");
        (read("claims.json"), read("index.html"))
    };
    let first = reproduce("figures-4-8");
    assert!(first.0.contains("\"C1\"") && !first.0.contains("\"C6\""));
    let both = reproduce("figure-9");
    for id in ["C1", "C6"] {
        assert!(both.0.contains(&format!("\"id\": \"{id}\"")), "{id} is in claims.json");
        assert!(both.1.contains(&format!("#{id}\"")), "{id} has its link on the page");
    }
    assert!(both.0.find("\"C1\"") < both.0.find("\"C6\""), "in the order of the paper");
    let figures = |page: &str| page.matches("<svg").count();
    assert!(figures(&first.1) > 0 && figures(&both.1) >= figures(&first.1), "figures stay, too");
    assert!(both.1.contains("Where this comes from") && !both.1.contains("made by an earlier call"));
    assert_eq!(reproduce("figure-9"), both, "again: the same bytes");
    // What another program made says so.
    let stored = folder.path().join("studies/figures-4-8.json");
    let text = std::fs::read_to_string(&stored).expect("written");
    let commit =
        text.split("\"commit\":\"").nth(1).and_then(|rest| rest.split('"').next()).expect("a commit");
    std::fs::write(&stored, text.replace(commit, "0123abc")).expect("writable");
    assert!(reproduce("figure-9").1.contains("made by an earlier call (acroscope 0.1.0, commit 0123abc)"));
}
