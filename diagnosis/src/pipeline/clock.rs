//! The plant log's clock: cleared before anything is named.

use super::*;

/// Standard errors by which a clock must miss the time that the picture asks for, not to be taken for it.
pub(super) const MISSES: f64 = 3.0;
/// By how much what was found may blur the clock, for the logs of plant and torque to say anything of it by themselves.
const BLURRED: f64 = 2.0;

/// The plant log's clock, s late, that explains what the picture alone would have called a delay: logs of plant and torque know
/// their clock to some ten microseconds only, a picture its delay to some microseconds.
pub(super) fn clock_instead(list: &[Candidate], compared: &Compared) -> Option<f64> {
    let Compared { parts, point, .. } = compared;
    let clock = list.iter().position(|candidate| candidate.name == CLOCK)?;
    let delay = list.iter().position(|candidate| candidate.name == "camera.T_delay")?;
    let plant = parts.iter().find(|part| part.torque && part.study.seen.contains(&clock))?;
    let (by, error) =
        parts.iter().filter(|part| !part.torque).find_map(|part| seen_late(part, list, delay))?;
    let (shift, blurred, alone) = known(plant, list, clock)?;
    let misses = (by + shift).abs() / error.hypot(blurred);
    if blurred > BLURRED * alone || misses > MISSES {
        return None;
    }
    let weights = (error.powi(-2), blurred.powi(-2));
    Some(point[clock] + (shift * weights.1 - by * weights.0) / (weights.0 + weights.1))
}

/// By how much a picture is late, s, and the standard error of that.
fn seen_late(part: &Part, list: &[Candidate], delay: usize) -> Option<(f64, f64)> {
    let late = |other: &&Alternative| other.candidate == delay && other.loss < CLASS;
    let (effect, by) = part.classes.iter().find_map(|(effect, class)| {
        let own = ["camera.T_delay", "camera.E_t"].contains(&list[*effect].name);
        let by = class.iter().find(late).map(|other| other.x - list[delay].off);
        own.then_some((*effect, by?))
    })?;
    let last = &part.study.last;
    let free: Vec<usize> =
        part.study.active.iter().copied().filter(|index| !list[*index].is_discrete()).collect();
    let place = free.iter().position(|index| *index == effect)?;
    let error = last.covariance(&free)?[(place, place)].sqrt();
    // an exposure is late by half of itself: the same share of the effect's size, whatever its name
    let share = error / (last.point[effect] - list[effect].off).abs();
    Some((by, share * by.abs()))
}

/// How much later the plant's log wants its clock still, s, with the standard errors of that beside what was found and alone.
fn known(part: &Part, list: &[Candidate], clock: usize) -> Option<(f64, f64, f64)> {
    let last = &part.study.last;
    let others = part.study.active.iter().copied().filter(|index| *index != clock);
    let mut free: Vec<usize> = others.filter(|index| !list[*index].is_discrete()).collect();
    let alone = last.covariance(&[clock])?[(0, 0)].sqrt();
    free.insert(0, clock);
    Some((last.wanted(&free)?[0], last.covariance(&free)?[(0, 0)].sqrt(), alone))
}

/// What the clock leaves in doubt of a delay and of an exposure beside their own errors: candidates, and standard deviations of
/// their x. Without a torque that is logged beside the angles there is no clock, and with an actuator's delay nobody knows it.
pub(super) fn doubts(model: &Model, list: &[Candidate], parts: &[Part]) -> Vec<(usize, f64)> {
    let place = |name: &str| list.iter().position(|candidate| candidate.name == name);
    let unsure = place(CLOCK).and_then(|clock| {
        let plant = parts.iter().find(|part| part.torque && part.study.seen.contains(&clock))?;
        known(plant, list, clock).filter(|(_, blurred, alone)| *blurred <= BLURRED * alone)
    });
    let Some((shift, error, _)) = unsure else { return Vec::new() };
    // an offset that shows, but not clearly enough to be taken, may be there
    let error = error.max(shift.abs());
    let twice = 2.0 * model.number("camera.omega_cam").unwrap_or(30.0);
    let of = |name, each: f64| place(name).map(|index| (index, each * error));
    [of("camera.T_delay", 1.0), of("camera.E_t", twice)].into_iter().flatten().collect()
}

/// Takes clocks that are off (by `before` besides, s) out of what is named. A plant log that is stamped late makes the
/// actuator look slow and the camera early by the same time; a delay of either does only one of both.
pub(super) fn clear_clock(
    list: &[Candidate],
    parts: &mut [Part],
    point: &mut [f64],
    before: f64,
    notices: &mut Vec<Notice>,
) {
    // half a millisecond, and a tenth: a lag and a delay of the same size differ by about that
    const SAME: f64 = 5e-4;
    const CLOSE: f64 = 0.1;
    let place = |name: &str| list.iter().position(|candidate| candidate.name == name);
    let mut gone = Vec::new();
    let mut late = (before != 0.0).then_some(0.0);
    if let Some(clock) = place(CLOCK).filter(|index| point[*index] != 0.0) {
        late = Some(point[clock]);
        gone.push(clock);
    }
    if let Some((shown, by)) = early(list, parts, point) {
        // one that was found, that is: nothing is the same as a clock that is off by less than SAME
        let found = |index: &usize| point[*index] != list[*index].off;
        let same = |index: &usize| found(index) && (point[*index] - by).abs() < SAME + CLOSE * by;
        let actuator = ["plant.tau_delay", "plant.T_act"].into_iter().filter_map(place).find(same);
        // an exposure may well be shorter than it is said to be, but no result comes before its picture
        if actuator.is_some() || list[shown].name == "camera.T_delay" {
            late = late.filter(|late| *late != 0.0).or(Some(by));
            gone.push(shown);
            gone.extend(actuator);
        }
    }
    for index in &gone {
        point[*index] = list[*index].off;
    }
    for part in parts {
        part.classes.retain(|(index, _)| !gone.contains(index));
    }
    if let Some(late) = late {
        let message = format!(
            "stamped {:.2} ms late against the other logs: taken as its clock, not as an effect",
            1e3 * (before + late)
        );
        notices.push(Notice { file: "plant.csv".into(), line: 0, message });
    }
}

/// The effect by which pictures come early, and by how much, s: a delay below zero, or an exposure that could be one.
fn early(list: &[Candidate], parts: &[Part], point: &[f64]) -> Option<(usize, f64)> {
    let delay = list.iter().position(|candidate| candidate.name == "camera.T_delay")?;
    if point[delay] < 0.0 {
        return Some((delay, -point[delay]));
    }
    let shown = |(effect, class): &(usize, Vec<Alternative>)| {
        let other =
            class.iter().find(|other| other.candidate == delay && other.loss < CLASS && other.x < 0.0)?;
        (list[*effect].name == "camera.E_t").then_some((*effect, -other.x))
    };
    parts.iter().flat_map(|part| &part.classes).find_map(shown)
}
