//! Rules that run the unit: each planted fault is found, whatever it does to the process, and units without one are clean.

mod common;

use common::{DESCRIPTION, OURS, Units, check, faulty, short};
use inspection::Limits;
use inspection::Severity::{self, Error, Warning};
use std::path::Path;
use std::time::Duration;

/// The processes of the rules are this program with only this test, which looks at one and never returns.
#[test]
fn rule_host() {
    common::host();
}

/// Number of the fault, the rule that looks, what it then finds: rule, severity, variable, a part of the text.
type Planted = (u32, &'static str, &'static str, Severity, Option<&'static str>, &'static str);

const PLANTED: &[Planted] = &[
    (
        1,
        "runs",
        "crash",
        Error,
        None,
        "by signal 11 (SIGSEGV, a segmentation fault) in fmi2DoStep from 0.02 s by 0.01 s of unit",
    ),
    (2, "runs", "exit", Error, None, "by exit with status 0 in fmi2DoStep"),
    (3, "runs", "endless-loop", Error, None, "did not come back within 1 s in fmi2DoStep"),
    (4, "start-values", "start-values", Error, Some("k"), "is 2.0 in the description and 3.0 in the unit"),
    (5, "reset", "reset", Error, Some("y"), "does not run as a new instance"),
    (6, "several-instances", "several-instances", Error, Some("y"), "disturb each other"),
    (7, "threads", "threads", Error, Some("y"), "disturb each other"),
    (8, "state-restore", "state-restore", Error, Some("y"), "as it was saved"),
    (9, "state-serialize", "state-serialize", Error, Some("y"), "goes on otherwise"),
    (10, "step-splitting", "step-splitting", Warning, Some("y"), "depend on the communication interval"),
    (11, "dependencies", "dependencies", Error, Some("y"), "its dependencies in InitialUnknowns do not list"),
    (12, "dependencies", "dependencies", Warning, Some("y"), "depends directly on that input"),
    (
        13,
        "directional-derivatives",
        "directional-derivatives",
        Error,
        Some("d"),
        "its derivative by u is said to be -2",
    ),
    (14, "leak", "leak", Error, None, "each instance leaves some 8"),
    (
        15,
        "unknown-references",
        "unknown-references",
        Warning,
        None,
        "are read or set as Real without an error",
    ),
    (16, "unknown-references", "crash", Error, None, "of the unknown value reference"),
    (17, "not-a-number", "crash", Error, None, "SIGABRT"),
    (18, "null-arguments", "crash", Error, None, "fmi2FreeInstance of a null pointer"),
    (19, "log-categories", "log-categories", Warning, None, "does not declare: mine"),
    (20, "guid-checked", "guid-checked", Warning, None, "takes another GUID"),
    (21, "call-order", "call-order", Warning, None, "before the initialisation"),
    (22, "repeatable", "repeatable", Warning, None, "two runs from the same start"),
    (23, "interpolation", "interpolation", Error, None, "refuses first derivatives"),
    (24, "runs", "crash", Error, None, "the end (fmi2Terminate, fmi2FreeInstance)"),
    (25, "not-a-number", "not-a-number", Error, Some("y"), "even after fmi2Reset"),
    (26, "output-range", "output-range", Warning, Some("y"), "beyond its max 1000000"),
    (28, "runs", "endless-loop", Error, None, "the end (fmi2Terminate"),
    (29, "reset", "reset", Error, None, "fmi2Reset answered error"),
    (30, "log-categories", "log-categories", Error, None, "its own log categories are refused"),
    (31, "runs", "runs", Warning, Some("y"), "it is NaN at t = 0.01 s"),
    (33, "values-before-setup", "values-before-setup", Error, Some("k"), "as 2 of 2 that were set"),
    (
        35,
        "values-in-initialization",
        "values-in-initialization",
        Error,
        Some("y"),
        "where parameters are set before fmi2EnterInitializationMode",
    ),
    (36, "state-restore", "state-restore", Warning, None, "leaves the pointer to the state as it was"),
    (37, "runs", "runs", Error, None, "the unit ("),
    (34, "start-time", "start-time", Warning, None, "its first step goes the whole way from 0 s"),
];

#[test]
fn every_planted_fault_of_a_library_is_found() {
    common::host();
    let units = Units::new();
    let limits = Limits { call: Duration::from_secs(1), memory: 1 << 30 };
    let mut missed = Vec::new();
    for (fault, by, rule, severity, variable, text) in PLANTED {
        let findings = inspection::check_by(by, &faulty(&units, *fault), &limits).expect("looked at");
        let found = findings.iter().any(|finding| {
            let about = finding.variable.as_deref() == *variable && finding.text.contains(text);
            finding.rule == *rule && finding.severity == *severity && about
        });
        let doubled = findings.iter().any(|finding| finding.text.contains("unit unit"));
        if !found || doubled {
            missed.push(format!("fault {fault}: wanted is {rule}, found {findings:#?}"));
        }
    }
    assert!(missed.is_empty(), "{}", missed.join("\n"));
}

#[test]
fn law_a_unit_without_a_fault_has_no_finding() {
    // Number 27 prints without an end of line, into the middle of what the process says. Number 32 fills the C library's
    // caches of freed memory, which is no leak.
    let units = Units::new();
    for fault in [0, 27, 32] {
        assert_eq!(check(&faulty(&units, fault)), []);
    }
}

#[test]
fn law_a_unit_that_cannot_run_is_not_run_again() {
    let units = Units::new();
    let findings = check(&faulty(&units, 2));
    assert_eq!(short(&findings), [("exit", Error, None)]);
    let last = &findings[0].text;
    assert!(last.contains("calls before: ") && last.contains("fmi2SetReal u of unit"), "{last}");
}

#[test]
fn law_rules_after_a_run_that_failed_are_said_not_to_be_looked_at() {
    common::host();
    let units = Units::new();
    let limits = Limits { call: Duration::from_secs(3), memory: 1 << 30 };
    let looked = inspection::look(&faulty(&units, 2), &limits).expect("looked at");
    let reasons = looked.reasons();
    assert_eq!(reasons[0], ("its process came to an end before it was through", vec!["runs"]));
    assert_eq!(reasons[1].0, "the unit does not get through its first plain run");
    assert!(reasons[1].1.contains(&"leak") && !reasons[1].1.contains(&"crash"), "{reasons:?}");
    let sound = inspection::look(&faulty(&units, 0), &limits).expect("looked at");
    assert_eq!(sound.rules(), inspection::rules());
}

/// The library knows no variable of this number and type.
#[test]
fn law_a_variable_that_can_not_be_read_is_named() {
    let units = Units::new();
    let text = DESCRIPTION.replace("name=\"x0\" valueReference=\"4\"", "name=\"x0\" valueReference=\"77\"");
    let path = units.pack("reference.fmu", &text, &common::library());
    let findings = check(&path);
    let named = findings.iter().any(|finding| {
        finding.variable.as_deref() == Some("x0")
            && finding.text.contains("fmi2GetReal of ")
            && finding.text.contains(" answered error")
    });
    assert!(named, "{findings:#?}");
}

#[test]
fn law_an_unknown_rule_gets_a_suggestion() {
    let error = inspection::check_by("leek", "any.fmu".as_ref(), &Limits::default()).expect_err("none");
    assert_eq!(error.to_string(), "the rule \"leek\" does not run a unit: did you mean leak?");
}

#[test]
fn every_unit_of_ours_is_clean_of_errors() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/fmus");
    for name in OURS {
        let findings = check(&folder.join(format!("{name}.fmu")));
        let worse: Vec<_> = findings.iter().filter(|finding| finding.severity != Severity::Note).collect();
        assert!(worse.is_empty(), "{name}: {worse:#?}");
    }
}

/// All that it lacks of FMI 2.0 follows from that.
#[test]
fn value_a_unit_of_another_version_is_told_as_such_and_before_all_else() {
    let units = Units::new();
    let other = common::DESCRIPTION.replace("fmiVersion=\"2.0\"", "fmiVersion=\"3.0\"");
    let library = common::library();
    let more = [("binaries/linux64/unit.so", &library[..]), ("more/of.it", &library[..])];
    let path = units.pack_files("other.fmu", &other, &more);
    let limits = Limits { call: Duration::from_secs(3), memory: 1 << 30 };
    let looked = inspection::look(&path, &limits).expect("looked at");
    let told: Vec<String> = looked.findings.iter().map(ToString::to_string).collect();
    assert_eq!(told.len(), 2, "and the folder at the root: {told:?}");
    assert!(told[0].ends_with("fmiVersion=\"3.0\": only \"2.0\" is checked"), "{told:?}");
    let functions = looked.left_out.iter().find(|left| left.rule == "binary-functions");
    assert_eq!(functions.map(|left| left.why.as_str()), Some("it is no description of FMI 2.0"));
}
