//! A unit that fails: it is named, and the others are where they would be had they stepped one after the other.

mod common;

use common::Units;
use orchestrator::{Scenario, Simulation};

#[test]
fn cross_a_unit_that_fails_leaves_the_same_behind_in_threads_as_one_after_the_other() {
    let units = Units::new();
    for failing in ["a", "b", "c"] {
        let failed = |algorithm: &str| {
            let unit = |name: &str| {
                let fault = if name == failing { ", fault = 3, fault_time = 0.5" } else { "" };
                format!(
                    "[[units]]\nname = \"{name}\"\nfmu = \"stateful.fmu\"\ninterval = 0.125\nset = {{ k = 2.0, u1 = 1.0{fault} }}\n"
                )
            };
            let text = format!(
                "format = 1\n[experiment]\nstop = 1\nalgorithm = \"{algorithm}\"\n{}",
                ["a", "b", "c"].map(unit).concat()
            );
            let scenario = Scenario::parse(&text, "test.toml").expect(algorithm);
            let mut simulation = Simulation::new(&scenario, &units.unit_path()).expect(algorithm);
            let error = simulation.advance_to(1.0).expect_err("it fails").to_string();
            let last = ["a.y1", "b.y1", "c.y1"].map(|name| simulation.value(name).expect("known"));
            (error, last)
        };
        let (error, last) = failed("jacobi");
        assert!(error.starts_with(&format!("unit {failing}: ")), "{error}");
        assert_eq!(failed("parallel-jacobi"), (error, last));
        // 2 t, up to the step that failed at 0.5 s or just after.
        assert!(last.iter().all(|y| (0.75..=1.25).contains(y)), "{last:?}");
    }
}
