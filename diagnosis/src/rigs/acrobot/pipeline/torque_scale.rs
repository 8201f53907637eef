//! A scale of all torques, which no log tells: angles and commands stay the same where every inertia, every gravity torque and the
//! gain of the torque grow by one factor. What is named as a gain beside some of the plant's inertias is, as well, a change of all the
//! others; that is one story with two readings, and neither of them is sure.

use super::policy::PIPELINE;
use crate::diagnosis::{Effect, Member};
use crate::rigs::acrobot::candidates::{Attribute, Candidate, Motion, place};
use crate::rigs::acrobot::dataset::{DataSet, Run};
use crate::text::brief;

/// Tells the other reading, and puts all that it changes into the class of the gain; what has another value there has an interval over
/// both. The line that tells it, where there is one.
pub(super) fn tell_torque_scale(
    data: &DataSet,
    list: &[Candidate],
    effects: &mut [Effect],
) -> Option<String> {
    if data.runs.iter().any(tells_torques) {
        return None;
    }
    let name = place(list, Attribute::Gain).map(|index| list[index].name)?;
    let place = effects.iter().position(|effect| effect.name == name)?;
    let gain = effects[place].value / effects[place].off;
    let is_inertia = |name: &str| {
        list.iter().any(|own| {
            own.name == name && !own.is(Attribute::Gain) && matches!(own.motion, Motion::Share { .. })
        })
    };
    let named: Vec<usize> = (0..effects.len()).filter(|k| is_inertia(&effects[*k].name)).collect();
    let others: Vec<&Candidate> = (list.iter())
        .filter(|own| is_inertia(own.name) && named.iter().all(|k| effects[*k].name != own.name))
        .collect();
    // a gain without inertias beside it is one number, where the other reading changes all seven
    if named.is_empty() || others.is_empty() || gain.is_nan() || gain <= 0.0 {
        return None;
    }
    let share = effects[place].probability / PIPELINE.readings / others.len() as f64;
    let mut told: Vec<String> =
        others.iter().map(|own| format!("{} = {}", own.name, brief(own.value(own.off) / gain))).collect();
    told.extend(named.iter().filter_map(|k| widen_to_both(&mut effects[*k], gain)));
    let members = &mut effects[place].members;
    members.iter_mut().for_each(|member| member.probability /= PIPELINE.readings);
    for own in &others {
        if members.iter().all(|member| member.name != own.name) {
            members.push(Member { name: own.name.to_owned(), probability: share });
        }
    }
    effects[place].class = effects[place].members.iter().map(|member| member.name.clone()).collect();
    let named: Vec<&str> = named.iter().map(|k| effects[*k].name.as_str()).collect();
    Some(format!(
        "{name} beside {} is one of two readings: no log tells a scale of all torques. With {name} at its nominal value the same data \
         say {}; friction and biases that were found go by the same factor, {}.",
        named.join(", "),
        told.join(", "),
        brief(1.0 / gain)
    ))
}

/// An inertia's value where the gain is nominal. If that is the inertia's nominal one, the effect is one of two readings; else its interval is
/// widened over both, and the value is told.
fn widen_to_both(effect: &mut Effect, gain: f64) -> Option<String> {
    let [low, high] = effect.ci95.map(|end| end / gain);
    if low <= effect.off && effect.off <= high {
        effect.probability /= PIPELINE.readings;
        effect.members.iter_mut().for_each(|member| member.probability /= PIPELINE.readings);
        return None;
    }
    let here = effect.ci95;
    effect.ci95 = [here[0].min(low), here[1].max(high)];
    Some(format!("{} = {}", effect.name, brief(effect.value / gain)))
}

/// Whether a run's logs hold a torque in N·m beside the one that the gain is of.
fn tells_torques(run: &Run) -> bool {
    let moves =
        |column: Option<&[f64]>| column.is_some_and(|all| all.iter().any(|x| x.is_finite() && *x != 0.0));
    moves(run.controller.as_ref().and_then(|log| log.column("tau_1")))
        || moves(run.plant.as_ref().and_then(|log| log.column("tau_applied")))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::rigs::acrobot::candidates::{Side, name};
    use std::collections::BTreeMap;

    fn effect(name: &str, off: f64, value: f64) -> Effect {
        let members = vec![Member { name: name.into(), probability: 0.995 }];
        Effect {
            name: name.into(),
            class: vec![name.into()],
            value,
            ci95: [0.99 * value, 1.01 * value],
            probability: 0.995,
            members,
            phrase: String::new(),
            unit: String::new(),
            off,
            at_end: false,
            unbounded: false,
        }
    }

    fn inertias() -> Vec<Candidate> {
        let gain = name(Attribute::Gain);
        let share = |(name, off): (&'static str, f64)| {
            let motion = Motion::Share { steps: &[0.001], range: (0.25, 4.0) };
            let (side, phrase) = (Side::Plant, "");
            Candidate {
                name,
                side,
                phrase,
                motion,
                off,
                steps: vec![0.001],
                range: (0.25, 4.0),
                nonlinear: false,
                attributes: if name == gain { &[Attribute::Gain] } else { &[] },
            }
        };
        [
            (name(Attribute::Gain), 1.0),
            ("plant.theta_1", 0.2),
            ("plant.theta_5", 0.11),
            ("plant.theta_9", 4.8),
        ]
        .map(share)
        .to_vec()
    }

    pub(in super::super) fn unlogged() -> DataSet {
        let manifest = crate::rigs::acrobot::dataset::Manifest {
            stated: crate::rigs::acrobot::dataset::stated_log::Stated::default(),
            scenario: "visual-servo".into(),
            set: BTreeMap::new(),
            noise: BTreeMap::new(),
            runs: Vec::new(),
        };
        let (runs, notices) = (Vec::new(), Vec::new());
        DataSet {
            path: ".".into(),
            manifest,
            runs,
            notices,
            clocks_apart: false,
            late_by_hand: 0.0,
            frames_apart: false,
            blind: std::collections::BTreeMap::new(),
        }
    }

    #[test]
    fn value_a_second_link_heavier_by_half_is_one_of_two_readings() {
        // theta_5 alone is 1.5 times what it was; said by the gain and by what is not heavier
        let mut found = [
            effect(name(Attribute::Gain), 1.0, 1.0 / 1.5),
            effect("plant.theta_1", 0.2, 0.2 / 1.5),
            effect("plant.theta_9", 4.8, 4.0),
        ];
        let told = tell_torque_scale(&unlogged(), &inertias(), &mut found).expect("two readings");
        assert!(told.contains("plant.theta_5 = 0.165") && told.contains("plant.theta_9 = 6"), "{told}");
        assert!(!told.contains("plant.theta_1 ="), "it is nominal in the other reading: {told}");
        assert_eq!(found[0].class, [name(Attribute::Gain), "plant.theta_5"]);
        assert!(found[0].members.iter().all(|member| (member.probability - 0.4975).abs() < 1e-12));
        assert!((found[1].probability - 0.4975).abs() < 1e-12 && found[2].probability == 0.995);
        // 4 here and 6 there, each within a hundredth
        assert!(found[2].ci95.iter().zip([3.96, 6.06]).all(|(end, wanted)| (end - wanted).abs() < 1e-12));
        // a gain alone is one
        let mut alone = [effect(name(Attribute::Gain), 1.0, 0.8)];
        assert_eq!(tell_torque_scale(&unlogged(), &inertias(), &mut alone), None);
    }
}
