//! Times and step sizes of the toy unit: which roundings are let through, and which steps can be told.

use crate::common::Instance;

/// At this time, before a stop.
fn at(start: f64, stop: Option<f64>) -> Instance {
    let toy = Instance::new();
    assert_eq!(toy.setup(start, stop), 0);
    assert_eq!(toy.enter() + toy.exit(), 0);
    toy
}

#[test]
fn every_rounding_of_time_is_let_through_and_no_more() {
    // A billionth of the times at hand: 1 µs at 1000 s, a picosecond in steps of a millisecond.
    for (time, size, off) in
        [(1000.0, 0.1, 1e-6), (-1000.0, 0.1, 1e-6), (0.0, 1e-3, 1e-12), (1e-3, 1e-3, 1e-12)]
    {
        for (share, right) in [(0.5, 0), (-0.5, 0), (3.0, 3), (-3.0, 3)] {
            let toy = at(time, None);
            assert_eq!(toy.step(time + share * off, size), right, "{share} of {off} beside {time}");
            // So does the end of the run.
            let toy = at(time, Some(time + size));
            let right = if share < 0.0 { 0 } else { right };
            assert_eq!(toy.step(time, size + share * off), right, "{share} of {off} beside {}", time + size);
        }
    }
}

#[test]
fn every_step_that_time_can_tell_is_taken() {
    // The smallest number there is, to its own stop too; a step that moves nothing, or leaves the numbers.
    let smallest = f64::from_bits(1);
    assert_eq!(at(0.0, None).step(0.0, smallest), 0);
    assert_eq!(at(0.0, Some(smallest)).step(0.0, smallest), 0);
    assert_eq!(at(1.0, Some(1.0)).step(1.0, 0.5), 3, "an experiment may be a point");
    for (start, size) in [(1.0, 1e-20), (1.5e308, 1e308), (-1e300, 1.0)] {
        let toy = at(start, None);
        assert_eq!(toy.step(start, size), 3, "{size} from {start}");
        let message = toy.error();
        assert!(message.contains(&format!("too small or large to step from {start} s")), "{message}");
    }
}
