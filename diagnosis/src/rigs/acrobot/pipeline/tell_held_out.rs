//! What repeated searches say in a diagnosis: gaps of models that never saw the runs, and names that aren't found again.

use super::held_out::HeldOut;
use super::policy::PIPELINE;
use crate::diagnosis::{Diagnosis, Effect};
use crate::rigs::acrobot::gap::above_floor;
use crate::text::brief;

impl HeldOut {
    /// Whether a repeated search doesn't find an effect that it could, by any of its names.
    fn misses(&self, effect: &Effect) -> bool {
        let is = |names: &[String]| effect.class.iter().any(|name| names.contains(name));
        is(&self.searched) && self.found.iter().any(|(_, names)| !is(names))
    }
}

/// Puts the gaps of models that never saw the runs in the place of those by cross-validation, and tells what they named.
pub(super) fn tell_held_out(diagnosis: &mut Diagnosis, held_out: HeldOut) {
    for (runs, names) in &held_out.found {
        let named = if names.is_empty() { "nothing".to_owned() } else { names.join(", ") };
        diagnosis.story.push(format!("Searched again without {runs}: {named}."));
    }
    for effect in diagnosis.effects.iter_mut().filter(|effect| held_out.misses(effect)) {
        effect.probability = effect.probability.min(PIPELINE.missed);
        diagnosis
            .story
            .push(format!("{} isn't found by each of these searches: it may be chance.", effect.name));
    }
    let widest = held_out.gaps.iter().max_by(|a, b| above_floor(a).total_cmp(&above_floor(b)));
    if let Some(gap) = widest.cloned() {
        if let Some(percent) = gap.percent() {
            diagnosis.story.push(format!(
                "On these runs, which the repeated searches never saw, the gap goes from {} to {} {} (noise alone: {}): {:.0} % \
                 of it is closed.",
                brief(gap.before),
                brief(gap.after),
                gap.unit,
                brief(gap.floor),
                percent
            ));
        }
        diagnosis.gap = gap;
    }
    diagnosis.gaps = held_out.gaps;
    for channel in held_out.channels {
        if let Some(known) = diagnosis.channels.iter_mut().find(|known| known.signal == channel.signal) {
            *known = channel;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::Member;

    #[test]
    fn law_a_name_that_a_repeated_search_could_find_and_does_not_is_missed() {
        let effect = |class: &[&str]| Effect {
            name: class[0].into(),
            class: class.iter().map(|name| (*name).to_owned()).collect(),
            value: 1.0,
            ci95: [0.9, 1.1],
            probability: 0.99,
            members: Vec::<Member>::new(),
            phrase: String::new(),
            unit: String::new(),
            off: 0.0,
            at_end: false,
            unbounded: false,
        };
        let names = |all: &[&str]| all.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
        let held_out = HeldOut {
            gaps: Vec::new(),
            found: vec![("run-01".into(), names(&["d", "a"])), ("run-02".into(), names(&["a", "c"]))],
            searched: names(&["a", "b", "d"]),
            channels: Vec::new(),
        };
        let missed =
            [&["a"][..], &["b"], &["b", "a"], &["d"], &["c"]].map(|class| held_out.misses(&effect(class)));
        // by another name of its class it is found; what the first search didn't find by itself isn't asked for
        assert_eq!(missed, [false, true, false, true, false]);
    }
}
