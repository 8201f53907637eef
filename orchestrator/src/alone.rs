//! Tests that need a process of their own: they look at what all threads of one share.

/// Whether this is the process of the test that asks. Else that is started, and must pass: the test has nothing more to do here.
pub(crate) fn is_alone() -> bool {
    const ALONE: &str = "ORCHESTRATOR_TEST_ALONE";
    let name = std::thread::current().name().map(str::to_owned).expect("that of the test");
    if std::env::var(ALONE).is_ok_and(|own| own == name) {
        return true;
    }
    let mut again = std::process::Command::new(std::env::current_exe().expect("this program"));
    let done = again.args(["--exact", &name]).env(ALONE, &name).output().expect("starts");
    let told = String::from_utf8_lossy(&done.stdout);
    assert!(done.status.success() && told.contains("1 passed"), "{told}");
    false
}
