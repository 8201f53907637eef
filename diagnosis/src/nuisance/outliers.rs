//! Values of a log that stand alone: a spike, a dropped byte, a sensor that said 0 for a moment.
//!
//! Judged without any model: a stretch of at most three values lies beyond both its neighbours by much more than these
//! differ and than the channel scatters. What an input did at the same time may have caused it, and stays.
//! Rousseeuw, Croux, J. Am. Stat. Assoc. 88 (1993) 1273 (scales that outliers don't move).

use super::policy::NUISANCE;
use crate::statistics::levels::MIDDLE;
use crate::statistics::median::median;

/// Places of the outliers in one run of a channel. `scale` is [`scale`] of the channel; `driven` says whether an input moved
/// between two times, `NUISANCE.rings` rows before included.
pub fn outliers(time: &[f64], values: &[f64], scale: f64, driven: impl Fn(f64, f64) -> bool) -> Vec<usize> {
    let mut found = Vec::new();
    let mut place = 1;
    while place + 1 < values.len() {
        let fits = (1..=NUISANCE.longest).find(|length| {
            let after = place + length;
            after < values.len()
                && stands_alone(&values[place - 1..=after], scale)
                && !driven(time[place.saturating_sub(NUISANCE.rings)], time[after])
        });
        match fits {
            Some(length) => {
                found.extend(place..place + length);
                place += length + 1;
            }
            None => place += 1,
        }
    }
    if found.len() as f64 > NUISANCE.seldom * values.len() as f64 { Vec::new() } else { found }
}

/// Whether all but the ends lie beyond both ends, on the same side.
fn stands_alone(stretch: &[f64], scale: f64) -> bool {
    let (first, last) = (stretch[0], stretch[stretch.len() - 1]);
    let needed = (NUISANCE.beyond * scale).max(NUISANCE.alone * (last - first).abs());
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
    let middle = median(runs.iter().flat_map(|run| run.windows(3).map(away)));
    (middle.unwrap_or(f64::INFINITY) / MIDDLE).max(quantum)
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

    #[test]
    fn value_each_level_of_an_outlier_stands_where_it_does() {
        let time: Vec<f64> = (0..100).map(f64::from).collect();
        // values that lie so far off, so many in a row and so often, on a line that rises by so much over such a stretch
        let places = |by: f64, length: usize, often: usize, rise: f64| {
            let mut values: Vec<f64> = time.iter().map(|t| rise * t / (length + 1) as f64).collect();
            for k in 0..often {
                (0..length).for_each(|row| values[20 + 20 * k + row] = values[19 + 20 * k] + by);
            }
            outliers(&time, &values, 1.0, |_, _| false).len()
        };
        // ten robust deviations
        assert_eq!([9.9, 10.1].map(|by| places(by, 1, 1, 0.0)), [0, 1]);
        // beyond the later neighbour by three times as much as that lies off the first
        assert_eq!([39.0, 41.0].map(|by| places(by, 1, 1, 10.0)), [0, 1]);
        // two at most are an accident, of 100
        assert_eq!([2, 3].map(|often| places(50.0, 1, often, 0.0)), [2, 0]);
        // a stretch of three, of more values than these
        let long: Vec<f64> = (0..1000).map(f64::from).collect();
        let stretch = |length: usize| {
            let values: Vec<f64> = long
                .iter()
                .map(|t| if (500.0..500.0 + length as f64).contains(t) { 50.0 } else { 0.0 })
                .collect();
            outliers(&long, &values, 1.0, |_, _| false).len()
        };
        assert_eq!([3, 4].map(stretch), [3, 0]);
    }
}
