//! Single readings that lie far from what linked states leave of all others: an encoder that slips, a value that came late, a bit that flipped.

use super::policy::LINKED;
use crate::infer::{Linearised, Noise};
use crate::statistics::levels::{FEW, HALF, MIDDLE, SEVERAL};
use crate::statistics::median::median;

/// Such readings of one angle.
#[derive(Debug, Clone, PartialEq)]
pub struct LoneReadings {
    /// The angle.
    pub angle: usize,
    /// How many, and of how many.
    pub count: usize,
    pub of: usize,
    /// The first: its run, and its time, s.
    pub first: (usize, f64),
    /// How far off the farthest is, rad.
    pub farthest: f64,
    /// They are more than the tail of the noise gives.
    pub stand_out: bool,
}

/// Time, residual and slope of each value of a run.
type Values = Vec<(f64, f64, f64)>;

/// Those of the angle that has most, of angles whose readings stand out if there are such. `angles` are the channels of the angles.
pub(super) fn lone_readings(
    runs: &[Linearised],
    noise: &Noise,
    angles: [Option<usize>; 2],
) -> Option<LoneReadings> {
    let of = |angle: usize| of_channel(runs, noise, angles[angle]?, angle);
    (0..angles.len()).filter_map(of).max_by_key(|lone| (lone.stand_out, lone.count))
}

fn of_channel(runs: &[Linearised], noise: &Noise, channel: usize, angle: usize) -> Option<LoneReadings> {
    let own = |run: &Linearised| {
        let values = run.measured.iter().filter(|value| value.channel == channel && value.weight > 0.0);
        let values: Values = values.map(|value| (value.time, value.residual, value.slope)).collect();
        // noise of one run may be larger than that of another
        let scale = median(values.iter().map(|(_, left, _)| left.abs())).filter(|left| *left > 0.0);
        let scale = scale.map_or(1.0, |left| left / MIDDLE);
        let in_scales = |(time, left, slope): (f64, f64, f64)| (time, left / scale, slope / scale);
        (scale, values.into_iter().map(in_scales).collect::<Values>())
    };
    let (scales, each): (Vec<f64>, Vec<Values>) = runs.iter().map(own).unzip();
    let late = lateness(&each.concat()).max(noise.jitter);
    let size = |(_, left, slope): &(f64, f64, f64)| left.abs() / 1.0_f64.hypot(slope * late);
    let far = |value: &(f64, f64, f64)| size(value) > LINKED.lone;
    let sizes: Vec<f64> = each.iter().flatten().map(size).collect();
    let mut lone: Vec<(usize, f64, f64)> = Vec::new();
    let mut lone_sizes = Vec::new();
    let mut all = 0;
    for (run, values) in each.iter().enumerate() {
        let is_far = |place: Option<usize>| place.and_then(|place| values.get(place)).is_some_and(far);
        for (place, value) in values.iter().enumerate().filter(|(_, value)| far(value)) {
            all += 1;
            let by_its_time = LINKED.uneven * (value.2 * unevenness(values, place)).abs();
            if !is_far(place.checked_sub(1)) && !is_far(Some(place + 1)) && value.1.abs() > by_its_time {
                lone.push((run, value.0, scales[run] * value.1.abs()));
                lone_sizes.push(size(value));
            }
        }
    }
    let (run, time, _) = *lone.first()?;
    // where most have neighbours as far off, a model is wrong for a while
    (lone.len() >= FEW && lone.len() as f64 > HALF * f64::from(all)).then(|| LoneReadings {
        angle,
        count: lone.len(),
        of: each.iter().map(Vec::len).sum(),
        first: (run, time),
        farthest: lone.iter().map(|(.., left)| *left).fold(0.0, f64::max),
        stand_out: stand_out(&lone_sizes, &sizes),
    })
}

/// Whether more lie far off, or far beyond that, than if all sizes went on falling off as from half of what is far to three quarters and from there
/// to it: by the same factor each quarter, as noise of a double exponential (Laplace) does, and a normal one faster.
fn stand_out(lone: &[f64], all: &[f64]) -> bool {
    let above = |sizes: &[f64], quarters: i32| {
        let limit = LINKED.lone * (1.0 + 0.25 * f64::from(quarters));
        sizes.iter().filter(|size| **size > limit).count() as f64
    };
    let (before, last) = (above(all, -2) - above(all, -1), above(all, -1) - above(all, 0));
    let falls = if last > 0.0 { last / before } else { 0.0 };
    let is_more = |quarters: i32| {
        let by_tail = last * falls.powi(quarters + 1) / (1.0 - falls);
        let count = above(lone, quarters);
        count >= FEW as f64 && count > by_tail + SEVERAL * by_tail.sqrt()
    };
    falls < 1.0 && (0..FEW as i32 * 4).any(is_more)
}

/// How far a row's time lies from the middle of its neighbours', s.
fn unevenness(values: &[(f64, f64, f64)], place: usize) -> f64 {
    let time = |place: Option<usize>| place.and_then(|place| values.get(place)).map(|value| value.0);
    let beside = time(place.checked_sub(1)).zip(time(Some(place + 1)));
    beside.map_or(0.0, |(before, after)| values[place].0 - HALF * (before + after))
}

/// By how much timestamps may scatter, s: as much as explains the fastest third of the rows.
fn lateness(values: &[(f64, f64, f64)]) -> f64 {
    let mut fastest: Vec<&(f64, f64, f64)> = values.iter().collect();
    fastest.sort_by(|one, other| other.2.abs().total_cmp(&one.2.abs()));
    fastest.truncate(values.len().div_ceil(LINKED.fastest));
    let late =
        fastest.into_iter().filter(|value| value.2 != 0.0).map(|(_, left, slope)| (left / slope).abs());
    median(late).map_or(0.0, |late| late / MIDDLE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::infer::Measured;
    use crate::statistics::random::Random;

    /// What is found of 2000 readings with noise of 1, with these more in some rows.
    fn found(more: &[(usize, f64)], slope: f64) -> Option<LoneReadings> {
        let mut random = Random::new(7);
        let mut measured: Vec<Measured> = (0..2000)
            .map(|row| {
                let (time, residual) = (f64::from(row), random.normal());
                Measured { channel: 0, time, residual, slope, weight: 1.0 }
            })
            .collect();
        more.iter().for_each(|(row, by)| measured[*row].residual = *by);
        let noise = Noise { channels: vec![1.0], process: Vec::new(), jitter: 0.0, disturbance: None };
        lone_readings(&[Linearised { measured, ..Linearised::default() }], &noise, [None, Some(0)])
    }

    #[test]
    fn every_reading_that_lies_far_off_alone_is_counted() {
        assert_eq!(found(&[], 0.0), None);
        let seen = found(&[(100, 16.0), (700, -15.0), (1500, 14.0)], 0.0).expect("three");
        assert_eq!(
            (seen.angle, seen.count, seen.of, seen.first, seen.farthest),
            (1, 3, 2000, (0, 100.0), 16.0)
        );
        assert!(seen.stand_out, "{seen:?}");
        // where an angle moves, noise may be timestamps' scatter: readings that are as far off beside it aren't
        let seen = |by: f64| found(&[(100, by), (700, by), (1500, by)], 4.0).is_some();
        assert_eq!([7.0, 12.0].map(seen), [false, true]);
        // a model that is wrong for a while
        let while_long: Vec<(usize, f64)> =
            (100..120).chain([700, 900, 1100]).map(|row| (row, 16.0)).collect();
        assert_eq!(found(&while_long, 0.0), None);
    }

    #[test]
    fn value_what_the_tail_of_noise_gives_does_not_stand_out() {
        let mut random = Random::new(2);
        // a double exponential: of 2000 four lie beyond six robust standard deviations, seven of these, and its tail says eight
        let mut laplace = || -libm::log(random.uniform()) * random.sign();
        let rows: Vec<(usize, f64)> = (0..2000).map(|row| (row, laplace())).collect();
        let seen = found(&rows, 0.0).expect("seven");
        assert!(!seen.stand_out, "{seen:?}");
        // three that are ten times as far off as the tail reaches are no part of it
        let more = [100, 300, 500].map(|row| (row, 80.0));
        let seen = found(&[rows, more.to_vec()].concat(), 0.0).expect("ten");
        assert!(seen.stand_out, "{seen:?}");
        // where nothing falls off there is no end of it, and where nothing comes near there is no tail
        assert!(!stand_out(&[7.0; 9], &[4.0, 5.0, 5.5]) && stand_out(&[7.0; 3], &[0.5, 1.0]));
    }

    #[test]
    fn value_a_reading_that_its_own_time_explains_is_none() {
        let rows = |late: f64| [0.0, 1.0, 2.0 + late, 3.0, 4.0].map(|time| (time, 16.0, 1.0)).to_vec();
        assert!((unevenness(&rows(4.0), 2) - 4.0).abs() < 1e-12 && unevenness(&rows(4.0), 0) == 0.0);
        // three times that is more
        let explained = |late: f64| 16.0 <= LINKED.uneven * unevenness(&rows(late), 2);
        assert_eq!([5.2, 5.5].map(explained), [false, true]);
    }

    #[test]
    fn value_three_readings_beyond_six_deviations_are_the_fewest() {
        let told = |by: f64, count: usize| {
            let more: Vec<_> = (0..count).map(|k| (100 + 200 * k, by)).collect();
            found(&more, 0.0).is_some()
        };
        // the median of 2000 tells their scale to 3 %
        assert_eq!([5.5, 6.5].map(|by| told(by, 3)), [false, true]);
        assert_eq!([2, 3].map(|count| told(9.0, count)), [false, true]);
    }
}
