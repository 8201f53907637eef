//! What is said to be found is found: effects of hardly the smallest size that is stated where nothing is hidden.

use crate::common;

use diagnosis::{Diagnosis, Verdict, diagnose};

fn found(name: &str, set: &[(&str, &str)]) -> Diagnosis {
    let folder = common::recorded(name, set);
    diagnose(folder.path(), &common::units(), &common::options(), &mut |_| {}).expect("the data is good")
}

#[test]
fn every_effect_of_nearly_its_stated_size_is_found() {
    let nothing = found("nothing-hidden", &[]);
    assert_eq!(nothing.verdict, Verdict::None, "{:?}", nothing.effects);
    // 39 in 40 are found at it, nine in ten at a tenth less (seen of the scale there: 7 of 8 draws of the noise). So one draw may
    // miss it, but then two others don't: all but one in fifty.
    for (name, off) in [("camera.roll", 0.0), ("camera.scale", 1.0), ("plant.k_tau", 1.0)] {
        let size = 0.91 * nothing.minimum_detectable[name];
        let value = (off + size).to_string();
        let shown = |draw: &[(&str, &str)]| {
            let found = found("a-little-more", &[&[(name, value.as_str())], draw].concat());
            found.effects.iter().any(|effect| effect.class.iter().any(|other| other == name))
        };
        let again = || ["11", "12"].into_iter().all(|seed| shown(&[("camera.seed", seed)]));
        assert!(shown(&[]) || again(), "{name} {size:e}");
    }
}
