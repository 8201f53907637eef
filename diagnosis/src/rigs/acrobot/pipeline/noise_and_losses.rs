//! What shows in no mean: the sensor's noise in the scatter of images, lost frames in their count.

use super::Rig;
use super::compare::Part;
use super::policy::PIPELINE;
use crate::diagnosis::Effect;
use crate::error::Notice;
use crate::rigs::acrobot::candidates::{Attribute, Candidate, Side};
use crate::rigs::acrobot::lost_frames::{Losses, count_losses, tell_unlogged};
use crate::rigs::acrobot::selection::policy::SELECTION;
use crate::statistics::levels::{DOUBTED, WITHIN};
use std::collections::BTreeMap;

/// Adds the sensor's noise, where the image scatters as no nominal sensor does.
pub(super) fn add_sensor_noise(
    parts: &[Part],
    list: &[Candidate],
    effects: &mut Vec<Effect>,
    smallest: &mut BTreeMap<String, f64>,
    notices: &mut Vec<Notice>,
) {
    let Some(candidate) = list.iter().find(|candidate| candidate.side == Side::SensorNoise) else { return };
    for noise in parts.iter().filter_map(|part| part.noise) {
        smallest.insert(candidate.name.to_owned(), noise.detectable);
        if noise.clear {
            let ci95 = [(noise.value - WITHIN * noise.error).max(0.0), noise.value + WITHIN * noise.error];
            let sure = 1.0 - SELECTION.alpha;
            let probability = if noise.is_lit() { sure } else { PIPELINE.half_asked };
            effects.push(Effect::alone(candidate, noise.value, ci95, probability));
            notices.extend((!noise.is_lit()).then(|| unlit(candidate.name, noise.larger)));
        }
    }
}

/// Another light than the nominal one, of which noise is a share.
fn unlit(name: &str, larger: f64) -> Notice {
    let than = if larger < 0.0 { "smaller" } else { "larger" };
    let message = format!(
        "circles are {:.1} px {than} than the model has them, all alike: another light, threshold or target. {name} is told as if the light \
         were the nominal one",
        larger.abs()
    );
    Notice { file: "camera.csv".into(), line: 0, message }
}

/// Adds lost frames, where more or fewer are missing than the nominal camera loses.
pub(super) fn add_lost_frames(
    rig: &Rig<'_>,
    effects: &mut Vec<Effect>,
    smallest: &mut BTreeMap<String, f64>,
    notices: &mut Vec<Notice>,
) {
    let Some(candidate) = rig.list.iter().find(|candidate| candidate.is(Attribute::LostFrames)) else {
        return;
    };
    let interval = 1.0 / rig.model.frame_rate();
    notices.extend(tell_unlogged(&rig.data, interval));
    let Some(losses) = count_losses(&rig.data, interval) else { return };
    // one frame that isn't there is proof against "none is ever lost"; two are asked for
    smallest.insert(candidate.name.to_owned(), candidate.off + 6.0 / losses.expected);
    let by_count = losses.by_count();
    let is_lost = |losses: &Losses| differs(losses, candidate.off);
    let found = match (is_lost(&by_count), is_lost(&losses)) {
        (true, _) => Some((by_count, 1.0 - SELECTION.alpha)),
        // whether camera or log lost them hangs on what `frame` counts
        (false, true) => Some((losses, PIPELINE.half_asked)),
        (false, false) => None,
    };
    effects.extend(found.map(|(losses, probability)| {
        Effect::alone(candidate, losses.share(), losses.interval(WITHIN), probability)
    }));
}

/// Whether more or fewer frames are lost than the nominal share: by more than chance, of which "none is ever lost" leaves nothing.
fn differs(losses: &Losses, nominal: f64) -> bool {
    let [fewest, most] = losses.interval(DOUBTED);
    if nominal > 0.0 { nominal < fewest || nominal > most } else { losses.lost >= 2.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_a_share_differs_by_three_standard_errors_or_two_frames_from_none() {
        let differs =
            |lost: f64, nominal: f64| differs(&Losses { expected: 1800.0, lost, counted: 0.0 }, nominal);
        assert_eq!([1.0, 2.0].map(|lost| differs(lost, 0.0)), [false, true]);
        // 180 are expected, give or take 12.7
        assert_eq!(
            [0.0, 140.0, 150.0, 215.0, 225.0].map(|lost| differs(lost, 0.1)),
            [true, true, false, false, true]
        );
    }
}
