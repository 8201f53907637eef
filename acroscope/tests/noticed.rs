//! What a unit does beside its answers is noticed: to new files of the process, and in its log.

use crate::common;

use crate::common::Units;
use crate::misbehave::{noted, run};

#[test]
fn law_a_unit_that_changes_the_mask_of_new_files_leaves_the_results_readable() {
    use std::os::unix::fs::PermissionsExt as _;
    const MASK: &str = "a unit changes which permissions new files have (umask)";
    let change = [
        ("#include <unistd.h>", "#include <unistd.h>\n#include <sys/stat.h>"),
        ("    (void)no_return;\n", "    (void)no_return; umask(0777);\n"),
    ];
    let units = Units::new();
    units.pack("stateful.fmu", &common::description(common::STATEFUL), &common::library_with(&change));
    let out = tempfile::TempDir::new().expect("a temporary folder");
    for more in [&[][..], &["--isolate"]] {
        let (status, text, last) = run(&units, out.path(), 0, more);
        assert_eq!((status, last), (Some(0), 1.0), "{text}");
        for file in ["results.csv", "summary.json", "report.html"] {
            let mode =
                std::fs::metadata(out.path().join("0").join(file)).expect("there").permissions().mode();
            assert_eq!(mode & 0o600, 0o600, "{file}: {mode:o}");
        }
        // In a process of its own it is nobody else's business.
        assert_eq!(noted(out.path(), 0, MASK), usize::from(more.is_empty()));
    }
}

#[test]
fn law_an_error_that_a_unit_only_logs_is_noted() {
    let logs = |status: i32| {
        let line = format!(
            "    (void)no_return; if (from == 0.25) {{ u->callbacks->logger(u->callbacks->environment, \"a\", {status}, \"log\", \"valve %d\", 3);\n\
             u->callbacks->logger(u->callbacks->environment, \"a\", {status}, NULL, NULL); }}\n"
        );
        common::library_with(&[("    (void)no_return;\n", &line)])
    };
    let units = Units::new();
    let out = tempfile::TempDir::new().expect("a temporary folder");
    for (status, expected) in [(3, 1), (0, 0)] {
        units.pack("stateful.fmu", &common::description(common::STATEFUL), &logs(status));
        for more in [&[][..], &["--isolate"]] {
            let (done, text, _) = run(&units, out.path(), 0, more);
            assert_eq!(done, Some(0), "{text}");
            let told = "unit a logged an error: [error, log] valve 3, and 1 more among its last lines";
            assert_eq!(noted(out.path(), 0, told), expected);
        }
    }
}
