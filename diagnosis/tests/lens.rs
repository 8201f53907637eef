//! A real lens: terms that nearly cancel, and a mount that is a little off.

use crate::common::{found, recorded};
use diagnosis::Verdict;

#[test]
fn recovers_a_lens_whose_terms_nearly_cancel() {
    // about what a calibrated webcam has (Logitech C920: k1 0.12, k2 -0.25)
    let truth: [(&str, f64); 5] = [
        ("camera.k1", 0.12),
        ("camera.k2", -0.25),
        ("camera.p1", 0.002),
        ("camera.u0", 0.012),
        ("camera.roll", 0.008),
    ];
    let texts: Vec<(&str, String)> = truth.iter().map(|(name, value)| (*name, value.to_string())).collect();
    let set: Vec<(&str, &str)> = texts.iter().map(|(name, value)| (*name, value.as_str())).collect();
    let found = found(&recorded("lens", &set));
    assert_ne!(found.verdict, Verdict::Unknown, "{:?}", found.story);
    for (name, value) in truth {
        let of = |effect: &&diagnosis::Effect| effect.class.iter().any(|member| member == name);
        let effect = found.effects.iter().find(of);
        let effect = effect.unwrap_or_else(|| panic!("{name} is not among {:?}", found.effects));
        assert_eq!(effect.name, name);
        // the renderer is the same on both sides: four standard deviations, which are twice the half of an interval, and those are 0.2 to 5 %
        let [low, high] = effect.ci95;
        let near = (high - low).min(0.05 * value.abs());
        assert!((effect.value - value).abs() < near, "{name}: {} in {low} to {high}", effect.value);
    }
    assert_eq!(found.effects.len(), truth.len(), "{:?}", found.effects);
}
