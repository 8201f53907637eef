//! Values of a log that stand alone: a spike, a dropped byte, a sensor that said 0 for a moment.
//!
//! Judged without any model: a stretch of at most three values lies beyond both its neighbours by much more than these
//! differ and than the channel scatters. What an input did at the same time may have caused it, and stays.
//! Rousseeuw, Croux, J. Am. Stat. Assoc. 88 (1993) 1273 (scales that outliers don't move).

/// So many robust deviations beyond its neighbours: of 1e6 values of normal noise none is.
const FAR: f64 = 8.0;
/// And so many times as far as the neighbours are from each other: an edge lies one time away.
const ALONE: f64 = 3.0;
/// Longest stretch.
const LONGEST: usize = 3;
/// What an input did may show for so many rows.
const RINGS: usize = 5;
/// More than this share of a channel is no accident but the way it behaves.
const SELDOM: f64 = 0.02;

/// Places of the outliers in one run of a channel. `scale` is [`scale`] of the channel; `driven` says whether an input moved
/// between two times, [`RINGS`] rows before included.
pub fn outliers(time: &[f64], values: &[f64], scale: f64, driven: impl Fn(f64, f64) -> bool) -> Vec<usize> {
    let mut found = Vec::new();
    let mut place = 1;
    while place + 1 < values.len() {
        let fits = (1..=LONGEST).find(|length| {
            let after = place + length;
            after < values.len()
                && alone(&values[place - 1..=after], scale)
                && !driven(time[place.saturating_sub(RINGS)], time[after])
        });
        match fits {
            Some(length) => {
                found.extend(place..place + length);
                place += length + 1;
            }
            None => place += 1,
        }
    }
    if found.len() as f64 > SELDOM * values.len() as f64 { Vec::new() } else { found }
}

/// Whether all but the ends lie beyond both ends, on the same side.
fn alone(stretch: &[f64], scale: f64) -> bool {
    let (first, last) = (stretch[0], stretch[stretch.len() - 1]);
    let needed = (FAR * scale).max(ALONE * (last - first).abs());
    let inner = &stretch[1..stretch.len() - 1];
    let beyond = |side: f64| {
        inner.iter().all(|value| side * (value - first) > needed && side * (value - last) > needed)
    };
    beyond(1.0) || beyond(-1.0)
}

/// How far values of a channel lie from the mean of their neighbours, but for the outer half of them: 1.4826 times the median
/// is the standard deviation of normal values.
pub fn scale(runs: &[&[f64]], quantum: f64) -> f64 {
    let away = |triple: &[f64]| (triple[1] - 0.5 * (triple[0] + triple[2])).abs();
    let mut all: Vec<f64> = runs.iter().flat_map(|run| run.windows(3).map(away)).collect();
    all.sort_by(f64::total_cmp);
    let median = all.get(all.len() / 2).copied().unwrap_or(f64::INFINITY);
    (1.4826 * median).max(quantum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::random::Random;

    fn found(change: impl Fn(&mut Vec<f64>), driven: impl Fn(f64, f64) -> bool) -> Vec<usize> {
        let mut random = Random::new(11);
        let time: Vec<f64> = (0..4000).map(f64::from).collect();
        let mut values: Vec<f64> =
            time.iter().map(|t| libm::sin(0.03 * t) + 0.01 * random.normal()).collect();
        change(&mut values);
        outliers(&time, &values, scale(&[&values], 0.0), driven)
    }

    #[test]
    fn value_spikes_and_short_drops_are_found_and_nothing_else() {
        let never = |_, _| false;
        assert_eq!(found(|_| {}, never), Vec::<usize>::new());
        let spiked = |values: &mut Vec<f64>| {
            values[700] += 0.5;
            values[1500] = -4.0;
            (2000..2003).for_each(|place| values[place] = 9.0);
        };
        assert_eq!(found(spiked, never), [700, 1500, 2000, 2001, 2002]);
        // what an input did at that time stays
        assert_eq!(found(spiked, |from, to| from < 699.0 && to > 697.0), [1500, 2000, 2001, 2002]);
    }

    #[test]
    fn law_edges_and_what_happens_often_are_no_outliers() {
        let edge = |values: &mut Vec<f64>| values[1000..].iter_mut().for_each(|value| *value += 2.0);
        assert_eq!(found(edge, |_, _| false), Vec::<usize>::new());
        let often = |values: &mut Vec<f64>| values.iter_mut().step_by(20).for_each(|value| *value += 2.0);
        assert_eq!(found(often, |_, _| false), Vec::<usize>::new());
    }
}
