//! A bent target, seen by images alone: a circle that stands beside its link's line.

use crate::common::{found, logged_in, names, shipped};
use diagnosis::Verdict;

/// How far circle 3 is seen off link 2, rad: 0.02 of 6.9 world units.
const BENT: f64 = 0.003;

#[test]
fn law_a_circle_beside_its_link_is_no_ground_by_images_alone() {
    let to = "to = \"camera.q2\"\n";
    let text = shipped().replace(to, &format!("{to}bias = {BENT}\n"));
    let folder = logged_in("bent", &text, &[], false);
    for run in ["run-01", "run-02"] {
        std::fs::remove_file(folder.path().join(run).join("plant.csv")).expect("it was recorded");
    }
    let found = found(&folder);
    assert_eq!((found.verdict, names(&found)), (Verdict::Unknown, vec![]), "{:?}", found.effects);
    let left = found.unknown.expect("an angle is off");
    assert_eq!((left.signal.as_str(), left.depends_on), ("camera.u3", vec!["q2".to_owned()]));
    let words: Vec<&str> = left.shape.split(' ').collect();
    let at = words.iter().position(|word| *word == "rad").expect("an angle");
    let said: f64 = words[at - 1].parse().expect("a number");
    // 24 s at 30 Hz: its standard error is 1.5e-4 beside free start states
    assert!((said - BENT).abs() < 5e-4, "{}", left.shape);
    // the machine itself was told right: nothing is closed by what no scenario holds
    assert_eq!(found.gap.closed.unwrap_or(0.0), 0.0, "{:?}", found.gap);
}
