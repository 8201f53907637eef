//! Every command that the book and README.md print is run, in an empty folder with the examples beside it, or is in a short list
//! of those that another test runs. The packed units must be there: `cargo xtask pack`.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Beginnings of commands that are not run here, and who runs them.
const ELSEWHERE: [(&str, &str); 26] = [
    ("./scripts/", "they are the tests, or build what is shipped"),
    ("cargo xtask", "scripts/test.sh, scripts/platforms.sh"),
    ("cargo install", "tests/fmpy/test_own_unit.py builds with cargo-fmi2"),
    ("cargo fmi2", "tests/fmpy/test_own_unit.py"),
    (".venv/bin/python", "scripts/platforms.sh"),
    ("rustup target add", "scripts/platforms.sh"),
    ("pip install", "scripts/test-wheel.sh"),
    ("python ", "scripts/test.sh"),
    ("python3 -m venv", "scripts/test.sh, which makes one likewise"),
    ("cd tests", "tests/hidden/test_sets.py"),
    ("sbatch ", "a cluster's scheduler; tests/fmpy/test_sweep.py runs its parts"),
    ("kubectl ", "a cluster's scheduler; tests/fmpy/test_sweep.py runs its parts"),
    ("acroscope import box-1.csv", "tests/fmpy/test_own_unit.py"),
    ("acroscope diagnose box", "tests/fmpy/test_own_unit.py"),
    ("acroscope sweep STUDY", "a pattern; tests/fmpy/test_sweep.py runs its parts"),
    ("acroscope sweep study.toml --out /shared", "tests/fmpy/test_sweep.py"),
    ("acroscope sweep my-study.toml", "tests/fmpy/test_sweep.py"),
    ("acroscope sweep delay-and-rate", "sweep/tests run the shipped studies"),
    ("acroscope reproduce", "studies/tests run every study"),
    ("acroscope diagnose path/to/dataset", "a pattern"),
    ("acroscope run embrace.ssp", "ssp/tests read packages of others"),
    ("acroscope import examples/motor", "tests/hidden_any/test_import.py runs the page's commands in order"),
    ("acroscope diagnose out/motor", "tests/hidden_any/test_import.py"),
    ("acroscope run out/motor-diagnosis", "tests/hidden_any/test_import.py"),
    ("acroscope new plant.fmu controller.fmu", "acroscope/tests/new.rs"),
    ("acroscope run my-scenario.toml", "acroscope/tests/new.rs"),
];

/// The pages of the book, from its summary, and README.md.
fn pages() -> Vec<String> {
    let summary = std::fs::read_to_string(root().join("docs/SUMMARY.md")).expect("the book has a summary");
    let links = summary.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    let pages: Vec<String> = links.map(|page| format!("docs/{page}")).collect();
    assert!(pages.len() > 15, "{pages:?}");
    pages.into_iter().chain(["README.md".to_owned(), "examples/README.md".to_owned()]).collect()
}

/// Each command of a page's console blocks without its comment; a line that ends in a backslash goes on.
fn commands(page: &str) -> Vec<String> {
    let text = std::fs::read_to_string(root().join(page)).unwrap_or_else(|why| panic!("{page}: {why}"));
    let text = text.replace("\\\n", " ");
    let blocks = text.split("```console\n").skip(1).filter_map(|rest| rest.split("```").next());
    let lines: Vec<&str> = blocks.flat_map(str::lines).filter_map(|line| line.strip_prefix("$ ")).collect();
    lines.iter().map(|line| line.split(" # ").next().unwrap_or_default().trim().to_owned()).collect()
}

/// `cargo acroscope` builds first; what it runs then is the program.
fn program(command: &str) -> Option<&str> {
    command.strip_prefix("cargo acroscope ").or_else(|| command.strip_prefix("acroscope "))
}

fn elsewhere(command: &str) -> bool {
    let plain = command.strip_prefix("cargo ").filter(|_| program(command).is_some()).unwrap_or(command);
    ELSEWHERE.iter().any(|(begins, _)| plain.starts_with(begins))
}

/// What a reader has before the commands of a page: a unit and a scenario of their own, results of earlier pages.
fn prepare(folder: &Path, page: &str) {
    std::os::unix::fs::symlink(root().join("examples"), folder.join("examples")).expect("linked");
    let unit = root().join("target/fmus/acrobot_plant.fmu");
    std::fs::copy(unit, folder.join("my-unit.fmu")).expect("units are packed");
    let first: &[&str] = match page {
        "docs/results.md" => &[
            "run visual-servo --stop 1 --out out/visual-servo",
            "run full-state --stop 1 --out out/full-state",
        ],
        "README.md" => &["run visual-servo --stop 1 --out out/visual-servo"],
        _ => &[],
    };
    first.iter().for_each(|words| run(folder, page, words));
}

fn run(folder: &Path, page: &str, words: &str) {
    // A server would wait for Ctrl-C: it writes a file.
    let served = words.starts_with("view ") && !words.contains(" -o ");
    let words: Vec<&str> =
        words.split_whitespace().chain(served.then_some(["-o", "view.html"]).into_iter().flatten()).collect();
    let output = Command::new(env!("CARGO_BIN_EXE_acroscope"))
        .args(&words)
        .env("ACROSCOPE_FMUS", root().join("target/fmus"))
        .current_dir(folder)
        .output()
        .expect("the program starts");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{page}: acroscope {}\n{said}", words.join(" "));
}

#[test]
fn every_command_of_the_book_runs() {
    let mut ran = BTreeSet::new();
    for page in pages() {
        let due: Vec<String> = commands(&page).into_iter().filter(|command| !elsewhere(command)).collect();
        // What an earlier page has shown is not run again, unless this page goes on from it.
        if due.iter().all(|command| ran.contains(command)) {
            continue;
        }
        let folder = tempfile::tempdir().expect("a temporary folder");
        prepare(folder.path(), &page);
        for command in due {
            let words = program(&command).unwrap_or_else(|| panic!("{page}: nobody runs `{command}`"));
            run(folder.path(), &page, words);
            ran.insert(command);
        }
    }
    assert!(ran.len() >= 25, "{} commands: {ran:?}", ran.len());
}

#[test]
fn law_what_is_run_elsewhere_is_still_in_the_book() {
    let all: Vec<String> = pages().iter().flat_map(|page| commands(page)).collect();
    for (begins, who) in ELSEWHERE {
        let plain = |command: &String| {
            command.strip_prefix("cargo ").unwrap_or(command).starts_with(begins)
                || command.starts_with(begins)
        };
        assert!(all.iter().any(plain), "no page has `{begins}` any more ({who})");
    }
}
