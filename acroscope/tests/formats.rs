//! `acroscope ssp`, `container`, and `run` of a package: what is refused, and with which exit status. What they write is
//! tested with foreign programs in `tests/fmpy`.

use std::path::Path;
use std::process::Command;

fn refused(folder: &Path, arguments: &[&str]) -> String {
    let program = env!("CARGO_BIN_EXE_acroscope");
    let output =
        Command::new(program).args(arguments).current_dir(folder).output().expect("the program starts");
    assert_eq!(output.status.code(), Some(2), "{arguments:?}");
    let left: Vec<_> =
        std::fs::read_dir(folder).expect("readable").flatten().map(|entry| entry.file_name()).collect();
    assert_eq!(left, ["broken.ssp"], "nothing is left of a refused call");
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn every_mistake_is_told_and_leaves_nothing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("broken.ssp"), "no archive").expect("writable");
    for (arguments, expected) in [
        (&["ssp", "visual-servo", "-o", "x.zip"][..], "a name that ends in .ssp"),
        (&["container", "visual-servo", "-o", "x.ssp"], "a name that ends in .fmu"),
        (&["ssp", "visual-sevro", "-o", "x.ssp"], "did you mean visual-servo?"),
        (&["ssp", "visual-servo", "-o", "no/such/folder/x.ssp"], "no/such/folder"),
        (&["ssp", "visual-servo", "--set", "plant.q1_O=1", "-o", "x.ssp"], "q1_0"),
        (&["container", "visual-servo", "--set", "camera.k1", "-o", "x.fmu"], "UNIT.VARIABLE=VALUE"),
        (&["run", "broken.ssp"], "broken.ssp"),
        (&["params", "broken.ssp"], "broken.ssp"),
        (&["run", "brocken.ssp"], "did you mean broken.ssp?"),
    ] {
        let told = refused(folder.path(), arguments);
        assert!(told.contains(expected), "{arguments:?}: {told}");
    }
}
