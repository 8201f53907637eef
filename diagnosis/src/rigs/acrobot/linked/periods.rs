//! Laws that go to and fro along an angle or in time, of which nobody knows how often: the number of waves that stands out of what linked
//! states leave, by a periodogram (Lomb, *Astrophys. Space Sci.* 39 (1976) 447; of an angle in the place of time as well). Whether it is more
//! than noise, the same test says as of any other law.

use super::policy::LINKED;
use super::unlisted_law::Beside;
use crate::rigs::acrobot::simple_laws::{Law, On, PERIODIC, Periodic};
use crate::statistics::levels::HALF;
use crate::statistics::median::median;
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// A value at a place along what waves go, rad or s.
type Sample = (f64, f64);

/// How many waves a turn or a second are tried: from `first` on, `step` apart.
struct Tried {
    first: f64,
    step: f64,
    count: usize,
}

/// Of each kind the law that stands out most; those of readings where angles were read by encoders, each rounded to its quantum.
/// `process` are the sizes of the states' process noise.
pub(super) fn periodic_laws(
    runs: &[Beside<'_>],
    process: &[f64],
    readings: Option<[f64; 2]>,
) -> Vec<(On, Law)> {
    let of = |kind: &Periodic| {
        let (each, quantum): (Vec<Vec<Sample>>, f64) = match kind.on {
            On::Torque(link) => (runs.iter().map(|run| torques(run, kind, link, process)).collect(), 0.0),
            On::Reading(angle) => {
                (runs.iter().map(|run| left_of_readings(run, kind, angle)).collect(), readings?[angle])
            }
        };
        let (groups, tried) = match kind.in_time {
            true => (each.iter().map(Vec::as_slice).collect::<Vec<_>>(), seconds(&each)),
            false => (Vec::new(), turns(&each, quantum)),
        };
        let all = each.concat();
        let groups = if groups.is_empty() { vec![all.as_slice()] } else { groups };
        let (times, height) = strongest(&groups, &tried)?;
        let once = if kind.in_time { None } else { in_one_place(all.clone(), times, height[0]) };
        Some((kind.on, kind.law(times, height, tried.count, once)))
    };
    PERIODIC.iter().filter_map(of).collect()
}

/// Whole numbers of waves a turn: so many that the angle goes through a few of them, and no more than are no rounding. What lies between two
/// codes of an encoder goes to and fro as often as it has codes.
fn turns(runs: &[Vec<Sample>], quantum: f64) -> Tried {
    let (low, high) = ends(runs.iter().flatten());
    let codes = if quantum > 0.0 { HALF * TAU / quantum } else { f64::INFINITY };
    // without a row there is no span
    let first = (LINKED.seen * TAU / (high - low).max(0.0)).ceil().max(1.0);
    Tried { first, step: 1.0, count: (codes.min(LINKED.waves) - first + 1.0).max(0.0) as usize }
}

/// Waves a second that rows of one run tell apart: faster than an arm moves, and slower than half as often as rows come.
fn seconds(runs: &[Vec<Sample>]) -> Tried {
    let spans = runs.iter().map(|run| ends(run.iter()));
    let longest = spans.map(|(low, high)| high - low).fold(0.0, f64::max);
    let apart = runs.iter().flat_map(|run| run.windows(2).map(|pair| pair[1].0 - pair[0].0));
    let most = HALF / median(apart).unwrap_or(f64::INFINITY);
    let step = HALF / longest;
    let count = ((most - LINKED.hum) / step).max(0.0);
    Tried { first: LINKED.hum, step, count: if count.is_finite() { count as usize } else { 0 } }
}

fn ends<'a>(samples: impl Iterator<Item = &'a Sample>) -> (f64, f64) {
    let wider = |(low, high): (f64, f64), (at, _): &Sample| (low.min(*at), high.max(*at));
    samples.fold((f64::INFINITY, f64::NEG_INFINITY), wider)
}

/// The torque that process noise stands for in each interval, where it is asked for in proportion to the height of a wave there.
fn torques(run: &Beside<'_>, kind: &Periodic, link: usize, process: &[f64]) -> Vec<Sample> {
    let of = |row: usize| {
        let lacking = &run.run.defect[row * run.run.states..];
        let pushes = run.push(row, link).iter().zip(process).zip(lacking);
        let (along, square) = pushes.fold((0.0, 0.0), |(along, square), ((push, size), defect)| {
            let weight = 1.0 / (size * size);
            (along - weight * push * defect, square + weight * push * push)
        });
        let at = run.middle(row);
        let value = (kind.height)(&at) * along / square;
        (!run.run.is_torn(row) && value.is_finite()).then(|| ((kind.along)(&at), value))
    };
    (0..run.run.rows().saturating_sub(1)).filter_map(of).collect()
}

/// What an angle's readings leave.
fn left_of_readings(run: &Beside<'_>, kind: &Periodic, angle: usize) -> Vec<Sample> {
    let of = |row: usize| {
        let along = (kind.along)(&run.row(row));
        let measured = run.run.measured[run.run.values(row)].iter();
        let own = measured.filter(|value| Some(value.channel) == run.angles[angle] && value.weight > 0.0);
        own.map(move |value| (along, value.residual))
    };
    (0..run.run.rows()).flat_map(of).collect()
}

/// How often waves go to and fro that explain most of these values, each group by itself, and the heights of their cosine and sine there.
fn strongest(groups: &[&[Sample]], tried: &Tried) -> Option<(f64, Vec<[f64; 2]>)> {
    let scale = if groups.len() > 1 { TAU } else { 1.0 };
    let turned = |by: f64| move |(at, _): &Sample| [libm::cos(by * at), libm::sin(by * at)];
    let by = |times: f64| groups.iter().map(|group| group.iter().map(turned(times)).collect()).collect();
    let mut waves: Vec<Vec<[f64; 2]>> = by(scale * tried.first);
    let steps: Vec<Vec<[f64; 2]>> = by(scale * tried.step);
    let mut best: Option<(f64, usize, Vec<[f64; 2]>)> = None;
    for count in 0..tried.count {
        let sums = groups.iter().zip(&waves).map(|(group, waves)| {
            let sum = group.iter().zip(waves).fold([0.0; 2], |[cos, sin], ((_, value), wave)| {
                [cos + value * wave[0], sin + value * wave[1]]
            });
            sum.map(|sum| 2.0 * sum / group.len().max(1) as f64)
        });
        let height: Vec<[f64; 2]> = sums.collect();
        let power =
            |(group, [cos, sin]): (&&[Sample], &[f64; 2])| group.len() as f64 * (cos * cos + sin * sin);
        let power = groups.iter().zip(&height).map(power).sum::<f64>();
        if best.as_ref().is_none_or(|(known, ..)| power > *known) {
            best = Some((power, count, height));
        }
        for (wave, step) in waves.iter_mut().flatten().zip(steps.iter().flatten()) {
            *wave = [wave[0] * step[0] - wave[1] * step[1], wave[0] * step[1] + wave[1] * step[0]];
        }
    }
    best.map(|(_, count, height)| (tried.first + count as f64 * tried.step, height))
}

/// Where along an angle the one period is that holds waves, rad, if what else was seen doesn't: there they are less than half as high. A law that
/// comes again with each period must show in more than one.
fn in_one_place(mut samples: Vec<Sample>, times: f64, [cos, sin]: [f64; 2]) -> Option<f64> {
    samples.sort_by(|one, other| one.0.total_cmp(&other.0));
    let wave = |at: f64| cos * libm::cos(times * at) + sin * libm::sin(times * at);
    // along the wave, the same times the place, and the wave's own square: the last tells how high the first is
    let parts = |(at, value): &Sample| {
        let along = wave(*at) * value;
        Vector3::new(along, along * at, wave(*at) * wave(*at))
    };
    let all: Vector3<f64> = samples.iter().map(parts).sum();
    let (mut held, mut best, mut first) = (Vector3::zeros(), Vector3::zeros(), 0);
    for sample in &samples {
        held += parts(sample);
        while sample.0 - samples[first].0 > TAU / times {
            held -= parts(&samples[first]);
            first += 1;
        }
        if held.x > best.x {
            best = held;
        }
    }
    let rest = all - best;
    let elsewhere = rest.x / rest.z.max(f64::MIN_POSITIVE);
    (elsewhere < HALF * all.x / all.z).then_some(best.y / best.x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::random::Random;

    /// Waves of 0.3 times the noise, 120 a turn, along an angle that goes through so many rad.
    fn samples(span: f64) -> Vec<Sample> {
        let mut random = Random::new(5);
        let mut sample = || {
            let angle = span * (random.uniform() - 0.5);
            (angle, 0.3 * libm::cos(120.0 * angle - 1.0) + random.normal())
        };
        (0..4000).map(|_| sample()).collect()
    }

    #[test]
    fn recovers_how_often_a_turn_and_how_high() {
        let samples = samples(2.0);
        let (times, height) = strongest(&[&samples], &turns(std::slice::from_ref(&samples), 0.0))
            .expect("many waves were tried");
        // 4000 values of noise 1 tell a height to √(2 / 4000) = 0.022
        assert_eq!(times, 120.0);
        let [cos, sin] = height[0];
        assert!(
            (cos - 0.3 * 1_f64.cos()).abs() < 0.09 && (sin - 0.3 * 1_f64.sin()).abs() < 0.09,
            "{height:?}"
        );
    }

    #[test]
    fn recovers_how_often_a_second_in_runs_that_begin_anywhere() {
        let mut random = Random::new(8);
        let mut run = |rows: usize, phase: f64| -> Vec<Sample> {
            let time = (0..rows).map(|row| row as f64 / 90.0);
            time.map(|time| (time, 0.3 * libm::sin(TAU * 10.1 * time + phase) + random.normal())).collect()
        };
        let runs = [run(1400, 0.3), run(1100, 2.9)];
        let groups: Vec<&[Sample]> = runs.iter().map(Vec::as_slice).collect();
        let (times, height) = strongest(&groups, &seconds(&runs)).expect("many waves were tried");
        // half of what 15.6 s tell apart
        assert!((times - 10.1).abs() < 0.04 && height.len() == 2, "{times}");
        let size = height.iter().map(|[cos, sin]| cos.hypot(*sin)).fold(f64::INFINITY, f64::min);
        assert!((size - 0.3).abs() < 0.15, "{height:?}");
    }

    #[test]
    fn law_what_shows_in_one_period_alone_does_not_come_again() {
        let mut random = Random::new(5);
        let mut seen = |torque: &dyn Fn(f64) -> f64| {
            let mut sample = || {
                let angle = 2.4 * (random.uniform() - 0.5);
                (angle, torque(angle) + 0.3 * random.normal())
            };
            let samples: Vec<Sample> = (0..4000).map(|_| sample()).collect();
            let (times, height) = strongest(&[&samples], &turns(std::slice::from_ref(&samples), 0.0))
                .expect("many waves were tried");
            in_one_place(samples, times, height[0])
        };
        // a magnet at 0.15 rad that pulls both ways, and seven teeth a turn of which three pass by
        let magnet = seen(&|angle| (0.15 - angle) / 0.2 * libm::exp(-((angle - 0.15) / 0.2).powi(2)));
        assert!(magnet.is_some_and(|place| (place - 0.15).abs() < 0.1), "{magnet:?}");
        assert_eq!(seen(&|angle| 0.3 * libm::sin(7.0 * angle)), None);
        assert_eq!(seen(&|angle| 0.1 * libm::sin(40.0 * angle)), None);
    }

    #[test]
    fn value_an_angle_goes_through_two_waves_and_an_encoder_has_two_codes_in_each() {
        let tried = |span: f64, quantum: f64| {
            let Tried { first, count, .. } = turns(&[vec![(0.0, 0.0), (span, 0.0)]], quantum);
            (first, count)
        };
        assert_eq!(tried(2.0 * TAU / 99.5, 0.0), (100.0, 901));
        assert_eq!(tried(2.0 * TAU / 99.5, TAU / 501.0), (100.0, 151));
        assert_eq!(tried(2.0 * TAU / 99.5, TAU / 100.0), (100.0, 0));
        assert!(strongest(&[&[]], &turns(&[], 0.0)).is_none());
    }
}
