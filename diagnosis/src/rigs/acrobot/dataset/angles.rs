//! What angles of a log show by themselves: whether they are degrees, and where they were wrapped.

use super::Table;
use super::row_times::typical_gap;
use crate::nuisance::{least_gap, scatter};
use crate::rigs::acrobot::dataset::policy::LOGS;
use crate::rigs::acrobot::policy::POLICY;
use crate::statistics::levels::{FAR, MORE};
use std::f64::consts::{PI, TAU};

/// The usual distance of rows where it is so long that an arm loses its balance in between: no law of motion can be read off such a log.
pub fn far_apart(plant: &Table, falling: [f64; 2]) -> Option<f64> {
    typical_gap(plant).filter(|gap| gap * falling[0].max(falling[1]) > POLICY.coarse)
}

/// Makes cells of an angle that jump away from what is before and after them, and back, not measured: the first such row, by how much
/// it jumps (rad), and how many there are. No link is thrown so far and back in so short a time: `falling` is the rate (rad/s) that
/// gravity gives it.
pub fn glitches(time: &[f64], values: &mut [f64], falling: f64) -> Option<(usize, (f64, usize))> {
    let failed = failed_readings(time, values, falling);
    failed.iter().for_each(|(row, _)| values[*row] = f64::NAN);
    let mut found = thrown_away(time, values, falling);
    found.iter().for_each(|(row, _)| values[*row] = f64::NAN);
    found.extend(failed);
    let count = found.len();
    found.into_iter().min_by_key(|(row, _)| *row).map(|(row, by)| (row, (by, count)))
}

/// Rows that jump away and back, whatever they hold, and by how much they do, rad.
fn thrown_away(time: &[f64], values: &[f64], falling: f64) -> Vec<(usize, f64)> {
    let rows: Vec<usize> = (0..values.len()).filter(|row| values[*row].is_finite()).collect();
    let (mut found, mut place) = (Vec::new(), 2);
    while place + 2 < rows.len() {
        let jump = (1..=LOGS.few).find_map(|count| thrown(time, values, &rows[place - 2..], count, falling));
        let Some((count, by)) = jump else {
            place += 1;
            continue;
        };
        found.extend(rows[place..place + count].iter().map(|row| (*row, by)));
        place += count + 1;
    }
    found
}

/// Rows that hold exactly 0, a few in turn, where the rows around lead elsewhere: so a log shows readings that failed. A jump says so that is
/// far beyond the noise and the encoder's step, the law by which the rows around go on, and what gravity moves a link by in that time.
fn failed_readings(time: &[f64], values: &[f64], falling: f64) -> Vec<(usize, f64)> {
    let finite: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    let noise = FAR * scatter(&[&finite]).quiet.max(least_gap(&finite));
    let rows: Vec<usize> = (0..values.len()).filter(|row| values[*row].is_finite()).collect();
    let stretches = rows.chunk_by(|one, other| (values[*one] == 0.0) == (values[*other] == 0.0));
    let (mut found, mut place) = (Vec::new(), 0);
    for stretch in stretches {
        let (from, to) = (place, place + stretch.len());
        place = to;
        if values[stretch[0]] != 0.0 || stretch.len() > LOGS.few {
            continue;
        }
        let (before, after) =
            (&rows[from.saturating_sub(LOGS.few)..from], &rows[to..rows.len().min(to + LOGS.few)]);
        let jump = |row: &usize| {
            let (by, doubt, lasts) = off_the_course(time, values, *row, before, after)?;
            let least = noise.max(LOGS.clearly * doubt).max((falling * 0.5 * 0.5 * lasts).powi(2));
            (by.abs() > least).then_some((*row, by))
        };
        let jumps: Vec<(usize, f64)> = stretch.iter().filter_map(jump).collect();
        found.extend(jumps.iter().copied().filter(|_| jumps.len() == stretch.len()));
    }
    found
}

/// By how much a row is off where the rows around it lead, how well these tell (by a line and by a curve), rad, and how long it would have
/// had to go there, s. At an end of the log one side tells.
fn off_the_course(
    time: &[f64],
    values: &[f64],
    row: usize,
    before: &[usize],
    after: &[usize],
) -> Option<(f64, f64, f64)> {
    let (line, curve): (Vec<usize>, Vec<usize>) = match (before, after) {
        ([.., ahead, last], [next, beyond, ..]) => (vec![*last, *next], vec![*ahead, *last, *next, *beyond]),
        ([.., one, two, three], []) => (vec![*two, *three], vec![*one, *two, *three]),
        ([], [one, two, three, ..]) => (vec![*one, *two], vec![*one, *two, *three]),
        _ => return None,
    };
    let (straight, bent) = (led_to(time, values, row, &line), led_to(time, values, row, &curve));
    Some((values[row] - bent, bent - straight, time[line[1]] - time[line[0]]))
}

/// Where the polynomial through some rows is at the time of another (Lagrange).
fn led_to(time: &[f64], values: &[f64], row: usize, through: &[usize]) -> f64 {
    let share = |own: usize| -> f64 {
        let others = through.iter().filter(|other| **other != own);
        others.map(|other| (time[row] - time[*other]) / (time[own] - time[*other])).product()
    };
    through.iter().map(|own| share(*own) * values[*own]).sum()
}

/// Whether `count` rows after the first two of `rows` are elsewhere, and by how much the first of them is, rad.
fn thrown(time: &[f64], values: &[f64], rows: &[usize], count: usize, falling: f64) -> Option<(usize, f64)> {
    let [ahead, before] = [rows[0], rows[1]];
    let (after, beyond) = (*rows.get(count + 2)?, *rows.get(count + 3)?);
    let lasts = time[after] - time[before];
    // there and back at ten times the acceleration that gravity gives: a quarter of the time to speed up, a quarter to stop
    let most = (FAR * (falling * 0.5 * 0.5 * lasts).powi(2)).clamp(LOGS.glitch, MORE * TAU);
    let away = |row: &usize| values[*row] - 0.5 * (values[before] + values[after]);
    // an angle that was wrapped jumps by a whole turn
    let thrown = |by: f64| if by.abs() < MORE * TAU { by - TAU * (by / TAU).round() } else { by };
    let inside = &rows[2..count + 2];
    let least = inside.iter().map(|row| thrown(away(row)).abs()).fold(f64::INFINITY, f64::min);
    let jumps = least > most;
    // links that bounce off each other turn back from one row to the next, and move as fast before and after
    let steady = |one: usize, other: usize| LOGS.clearly * (values[one] - values[other]).abs() < least;
    (jumps && steady(ahead, before) && steady(before, after) && steady(after, beyond))
        .then(|| (count, away(&inside[0])))
}

/// Makes an angle continuous where it jumps by whole turns; the first such row and how many there are. Only where all of it
/// lies within a turn: an angle that counts turns was never wrapped.
pub fn unwrapped(values: &mut [f64]) -> Option<(usize, usize)> {
    let (low, high) = (values.iter().copied().filter(|value| value.is_finite()))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    if high - low > TAU * 1.01 || high - low < PI {
        return None;
    }
    let (mut first, mut count, mut turns, mut last) = (0, 0, 0.0, f64::NAN);
    for (row, value) in values.iter_mut().enumerate().filter(|(_, value)| value.is_finite()) {
        let jump = ((*value - last) / TAU).round();
        last = *value;
        if jump.is_finite() && jump != 0.0 {
            turns -= jump;
            count += 1;
            first = if count == 1 { row } else { first };
        }
        *value += TAU * turns;
    }
    (count > 0).then_some((first, count))
}

/// Angles in degrees show by their range together with their speed, or by the image. Range alone doesn't do: a free arm
/// turns over many times.
pub fn in_degrees(plant: &Table, camera: Option<&Table>, falling: [f64; 2]) -> Option<(usize, String)> {
    for (name, falling) in ["q1", "q2"].into_iter().zip(falling) {
        if let Some((row, message)) = degrees(plant, name, falling) {
            return Some((plant.line[row], message));
        }
    }
    let camera = camera?;
    let pairs = [("q1", "u1", "v1", "u2", "v2"), ("q2", "u2", "v2", "u3", "v3")];
    for (name, ua, va, ub, vb) in pairs {
        let seen: Vec<f64> = (0..camera.len())
            .filter_map(|row| {
                let cell = |column| Some(camera.column(column)?[row]);
                let angle = libm::atan2(cell(ub)? - cell(ua)?, cell(vb)? - cell(va)?);
                angle.is_finite().then_some(angle)
            })
            .collect();
        if let Some(times) = as_far(plant.column(name)?, &seen) {
            let message =
                format!("{name} moves {times:.0} times as far as the image shows (are these degrees?)");
            return Some((plant.line[0], message));
        }
    }
    None
}

/// The row of an angle that goes further, and faster, than any arm turns, and what it is then.
pub fn degrees(log: &Table, name: &str, falling: f64) -> Option<(usize, String)> {
    let values = log.column(name)?;
    let row = values.iter().position(|value| value.abs() > LOGS.largest_angle)?;
    let speed = speed(&log.time, values);
    let brief = |x: f64| if x.abs() < 1e6 { format!("{x:.1}") } else { format!("{x:.1e}") };
    let message = format!(
        "{name} = {} rad is {} turns, and it moves by up to {} rad/s, where gravity gives about {falling:.0}; angles are in \
         radians (are these degrees?)",
        brief(values[row]),
        brief(values[row].abs() / TAU),
        brief(speed)
    );
    (speed > degree_ratio() * falling).then_some((row, message))
}

/// How many times as far as another an angle moves, if that is more than any error of either.
pub fn as_far(angle: &[f64], other: &[f64]) -> Option<f64> {
    let times = spread(angle) / spread(other);
    (spread(other) > POLICY.least_motion && times > degree_ratio()).then_some(times)
}

/// Span that holds nine tenths of the values, in their unit.
fn spread(values: &[f64]) -> f64 {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    if sorted.is_empty() {
        return 0.0;
    }
    let at = |share: f64| sorted[((sorted.len() - 1) as f64 * share) as usize];
    at(0.95) - at(0.05)
}

/// The speed that is exceeded in a twentieth of the rows, rad/s.
pub fn speed(time: &[f64], values: &[f64]) -> f64 {
    let mut rates: Vec<f64> = (1..values.len())
        .map(|row| ((values[row] - values[row - 1]) / (time[row] - time[row - 1])).abs())
        .filter(|rate| rate.is_finite())
        .collect();
    rates.sort_by(f64::total_cmp);
    rates.get(rates.len().saturating_sub(1) * 19 / 20).copied().unwrap_or(0.0)
}

/// Degrees are 57 times radians; halfway on a logarithmic scale.
fn degree_ratio() -> f64 {
    1.0_f64.to_degrees().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::random::Random;

    /// 100 values that spread evenly over so much between their 5th and 95th hundredth.
    fn spread_over(size: f64) -> Vec<f64> {
        (0..100).map(|row| f64::from(row) * size / 89.0).collect()
    }

    #[test]
    fn value_degrees_are_more_than_seven_and_a_half_times_radians() {
        let told =
            |times: f64, motion: f64| as_far(&spread_over(times * motion), &spread_over(motion)).is_some();
        assert_eq!([7.5, 7.6].map(|times| told(times, 1.0)), [false, true]);
        // of a motion of a fiftieth of a radian nothing is said
        assert_eq!([0.019, 0.021].map(|motion| told(57.3, motion)), [false, true]);
    }

    #[test]
    fn value_an_angle_of_six_turns_that_moves_faster_than_gravity_moves_it_is_in_degrees() {
        let told = |largest: f64, speed: f64| {
            let q1: Vec<f64> = (0..100).map(|row| largest * (f64::from(row) / 99.0)).collect();
            let time = q1.iter().map(|angle| angle / speed).collect();
            degrees(&Table::new(time, vec![("q1".into(), q1)]), "q1", 7.0).is_some()
        };
        // 6 turns are 37.7 rad
        assert_eq!([37.6, 37.8].map(|largest| told(largest, 100.0)), [false, true]);
        // 7.57 times 7 rad/s
        assert_eq!([52.0, 54.0].map(|speed| told(100.0, speed)), [false, true]);
    }

    /// The cells of a log of 100 Hz that are taken out of a swing of 2 rad, once a second, after some were overwritten.
    fn taken_out(changed: &[(usize, f64)]) -> Vec<usize> {
        let time: Vec<f64> = (0..200).map(|row| f64::from(row) * 0.01).collect();
        let mut values: Vec<f64> = time.iter().map(|time| 3.1 + 2.0 * libm::sin(TAU * time)).collect();
        changed.iter().for_each(|(row, value)| values[*row] = *value);
        glitches(&time, &mut values, 7.0);
        (0..values.len()).filter(|row| values[*row].is_nan()).collect()
    }

    #[test]
    fn value_an_angle_jumps_by_three_tenths_of_a_radian_and_back() {
        assert_eq!(taken_out(&[]), [0; 0]);
        assert_eq!([3.1 + 2.0 + 0.25, 3.1 + 2.0 + 0.35].map(|value| taken_out(&[(25, value)]).len()), [0, 1]);
        // three rows of 0 where the log missed an angle, and four, which somebody meant
        let zeros = |count: usize| (100..100 + count).map(|row| (row, 0.0)).collect::<Vec<_>>();
        assert_eq!(taken_out(&zeros(3)), [100, 101, 102]);
        assert_eq!(taken_out(&zeros(4)), [0; 0]);
        // a step stays where it is, and a whole turn is a matter of wrapping
        assert_eq!(taken_out(&(100..200).map(|row| (row, 9.0)).collect::<Vec<_>>()), [0; 0]);
        assert_eq!(taken_out(&[(100, 3.1 - TAU)]), [0; 0]);
    }

    /// The cells of a log of 30 Hz that are taken for readings that failed, of a swing of half a radian with some noise.
    fn failed(changed: &[usize], level: f64, rows: usize) -> Vec<usize> {
        let mut random = Random::new(8);
        let time: Vec<f64> = (0..rows).map(|row| row as f64 / 30.0).collect();
        let mut values: Vec<f64> =
            time.iter().map(|time| level + 0.3 * libm::sin(3.0 * time) + 2e-4 * random.normal()).collect();
        changed.iter().for_each(|row| values[*row] = 0.0);
        glitches(&time, &mut values, 5.0);
        (0..values.len()).filter(|row| values[*row].is_nan()).collect()
    }

    #[test]
    fn every_0_that_the_rows_around_do_not_lead_to_is_a_reading_that_failed() {
        assert_eq!(failed(&[], 0.4, 200), [0; 0]);
        // one that is on its way, near its rest, the last of the log and the first, and three in turn
        assert_eq!(failed(&[20, 47, 100, 101, 102, 199], 0.4, 200), [20, 47, 100, 101, 102, 199]);
        assert_eq!(failed(&[0], 0.4, 200), [0]);
        assert_eq!(failed(&[100, 101, 102, 103], 0.4, 200), [0; 0]);
        // where it passes, 0 is what was measured: near 5 π / 3 s, row 157
        assert_eq!(failed(&[157], 0.0, 200), [0; 0]);
    }

    #[test]
    fn value_a_reading_fails_by_ten_times_the_noise_and_what_gravity_moves_a_link_by() {
        // (5 rad/s · 2/30 s / 4)² = 0.0069 rad
        assert_eq!([6.5e-3, 7.5e-3].map(|level| failed_at(level, 2e-5)), [false, true]);
        // noise of 2e-3 rad scatters by about as much
        assert_eq!([0.015, 0.026].map(|level| failed_at(level, 2e-3)), [false, true]);
    }

    #[test]
    fn value_a_reading_fails_by_ten_steps_of_the_encoder() {
        let step = 5e-4;
        let failed = |steps: f64| {
            let time: Vec<f64> = (0..600).map(|row| f64::from(row) * 0.005).collect();
            let mut values = vec![steps * step; 600];
            (values[10], values[300]) = ((steps + 1.0) * step, 0.0);
            glitches(&time, &mut values, 5.0);
            values[300].is_nan()
        };
        assert_eq!([1.0, 9.0, 11.0].map(failed), [false, false, true]);
    }

    /// Whether a 0 among rows at some level is no measurement.
    fn failed_at(level: f64, noise: f64) -> bool {
        let mut random = Random::new(3);
        let time: Vec<f64> = (0..600).map(|row| f64::from(row) / 30.0).collect();
        let mut values: Vec<f64> = time.iter().map(|_| level + noise * random.normal()).collect();
        // the rows around lie on the level, so that they tell it well
        (298..303).for_each(|row| values[row] = level);
        values[300] = 0.0;
        glitches(&time, &mut values, 5.0);
        values[300].is_nan()
    }

    #[test]
    fn rows_far_apart_may_be_anywhere() {
        // a second apart an arm may have turned twice in between
        let (time, mut values) = (vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0], vec![0.0, 0.0, 4.0, 0.0, 0.0, 0.0]);
        assert_eq!(glitches(&time, &mut values, 7.0), None);
    }
}
