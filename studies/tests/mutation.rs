//! Claims can fail: with a camera whose parameter acts with the wrong sign or size, those that speak of it turn false.
//!
//! A fault multiplies whatever a study gives to a variable of a unit on its way to it, so that the studies see a unit
//! with another equation and compare it with what they know of the right one. The packed units must be there:
//! `cargo xtask pack`.

use std::collections::BTreeSet;
use studies::{Bench, reproduce};

fn failing(studies: &[&str], faults: &[(&str, f64)]) -> BTreeSet<String> {
    let bench = Bench::new(scenarios::unit_path());
    let bench = faults.iter().fold(bench, |bench, (name, factor)| bench.with_fault(name, *factor));
    let ids: Vec<String> = studies.iter().map(|id| (*id).to_owned()).collect();
    let reproduction = reproduce(&ids, &bench, &|_| {}).expect("the units are packed: cargo xtask pack");
    reproduction.claims().filter(|claim| !claim.holds).map(|claim| claim.id.clone()).collect()
}

fn set(ids: &[&str]) -> BTreeSet<String> {
    ids.iter().map(|id| (*id).to_owned()).collect()
}

/// Figures 4 to 8 and 13 to 17.
const FRAMES: [&str; 2] = ["figures-4-8", "figures-13-17"];
/// What fails without any fault.
const ALWAYS: &str = "C27.worded";

#[track_caller]
fn fails(fault: (&str, f64), expected: &[&str]) {
    let found = failing(&FRAMES, &[fault]);
    let missing: Vec<_> = set(expected).difference(&found).cloned().collect();
    assert!(missing.is_empty(), "{fault:?} leaves {missing:?} as they are; fails: {found:?}");
}

#[test]
fn law_nothing_fails_without_a_fault() {
    assert_eq!(failing(&FRAMES, &[]), set(&[ALWAYS]));
}

#[test]
fn paper_s2_with_the_wrong_sign_fails_what_speaks_of_it() {
    fails(("camera.s2", -1.0), &["C3", "C4", "C26", "C28", "C30", "C31", "C32", "C33", "F4-8", "F13-17"]);
}

#[test]
fn paper_p1_with_the_wrong_sign_fails_what_speaks_of_it() {
    fails(("camera.p1", -1.0), &["C2", "C4", "C26", "C27", "C32", "F4-8", "F13-17"]);
}

#[test]
fn paper_p2_with_the_wrong_sign_fails_what_speaks_of_it() {
    fails(("camera.p2", -1.0), &["C2", "C4", "C26", "C28", "C30", "C31", "C32", "F4-8", "F13-17"]);
}

#[test]
fn paper_k1_with_the_wrong_sign_fails_what_speaks_of_it() {
    fails(("camera.k1", -1.0), &["C1", "C4", "C26", "C28", "C29", "C32", "F4-8", "F13-17"]);
}

#[test]
fn paper_s1_of_a_tenth_too_much_fails_what_speaks_of_it() {
    fails(("camera.s1", 1.1), &["C3", "C26", "C27", "C32", "F4-8", "F13-17"]);
}

#[test]
fn paper_the_closed_loop_tells_every_distortion_of_another_sign_or_size() {
    // p1 and p2 by half: with the other sign the search for what fells the loop meets lenses that fold the picture.
    let faults = [
        ("camera.k1", -1.0),
        ("camera.p1", 0.5),
        ("camera.p2", 0.5),
        ("camera.s1", -1.0),
        ("camera.s2", -1.0),
    ];
    let found = failing(&["figures-21-27"], &faults);
    let expected = ["F21", "F22", "F23", "F24", "F25", "F26", "F27", "C45", "C49"];
    assert!(set(&expected).is_subset(&found), "{found:?}");
}

#[test]
fn paper_the_closed_loop_tells_one_distortion_of_the_wrong_sign() {
    let found = failing(&["figures-21-27"], &[("camera.s2", -1.0)]);
    assert!(set(&["F27", "C45", "C52"]).is_subset(&found), "{found:?}");
    assert!(!found.contains("F23"), "p1 is as it should be: {found:?}");
}

#[test]
fn paper_beta_of_another_size_fails_what_speaks_of_it() {
    let found = failing(&["section-4.1.1"], &[("camera.beta", 1.5)]);
    assert!(set(&["C5", "C24"]).is_subset(&found), "{found:?}");
}

#[test]
fn paper_the_table_tells_a_distortion_of_another_size() {
    assert!(failing(&["table-3"], &[]).is_empty());
    let found = failing(&["table-3"], &[("camera.p1", 0.8)]);
    assert!(set(&["C25", "T3.p1", "T3"]).is_subset(&found), "{found:?}");
}
