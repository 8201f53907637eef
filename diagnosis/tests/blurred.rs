//! A camera out of focus: so far that its circles are lost, or with a noisy sensor.

use crate::common::{found, names, notice, recorded};
use diagnosis::Verdict;

#[test]
fn law_a_camera_that_sees_nothing_is_not_as_it_should_be() {
    let found = found(&recorded("blind", &[("camera.N", "12")]));
    notice(&found.notices, "found its circles in no frame");
    assert_eq!(found.verdict, Verdict::Unknown);
    assert_eq!(found.unknown.map(|unknown| unknown.signal).as_deref(), Some("camera.valid"));
}

#[test]
fn law_passes_beyond_which_the_model_sees_nothing_have_no_upper_end() {
    // with ten the circles cover 40 to 42 px, and the vision wants 40 of them
    let found = found(&recorded("passes", &[("camera.N", "10")]));
    assert!(names(&found).contains(&"camera.N"), "{:?}", found.effects);
    let passes = found.effects.iter().find(|effect| effect.name == "camera.N").expect("it is there");
    assert!(passes.ci95[0] < 10.0 && 10.0 < passes.ci95[1], "{passes:?}");
    assert!(passes.at_end || passes.value == 10.0, "{passes:?}");
}

#[test]
fn recovers_noise_beside_a_blur_and_no_lens() {
    // a sharp image must be far noisier to scatter by as much, and rendered so its circles lie up to 0.014 px elsewhere, as by a lens
    let found = found(&recorded("noisy", &[("camera.sigma", "9"), ("camera.N", "1")]));
    let mut named = names(&found);
    named.sort_unstable();
    assert_eq!(named, ["camera.N", "camera.sigma"], "{:?}", found.effects);
    let noise = found.effects.iter().find(|effect| effect.name == "camera.sigma").expect("it is there");
    assert!(noise.ci95[0] < 9.0 && 9.0 < noise.ci95[1], "{noise:?}");
}
