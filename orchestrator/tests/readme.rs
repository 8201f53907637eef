//! The README that a registry shows says what is so. Its program is compiled as a test of the documentation.

use orchestrator::Scenario;

const README: &str = include_str!("../README.md");

#[test]
fn value_the_scenario_of_the_readme_is_one() {
    let (_, rest) = README.split_once("```toml\n").expect("a scenario");
    let (text, _) = rest.split_once("```").expect("its end");
    let scenario = Scenario::parse(text, "README.md").expect("a scenario that can be read");
    assert_eq!(scenario.units.len(), 2);
    assert_eq!(scenario.connections.len(), 2);
}

#[test]
fn value_the_oldest_rust_of_the_readme_is_that_of_the_manifest() {
    let oldest = concat!("Oldest Rust: ", env!("CARGO_PKG_RUST_VERSION"), ".");
    assert!(README.contains(oldest), "the README does not say {oldest:?}");
}
