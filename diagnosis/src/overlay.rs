//! Measured, nominal and amended laid over each other for the report: each channel of one run, and its residual over time,
//! over its own past, over the states and the inputs.

/// A measured channel of a run, with what both models give in its place: as the page lays them over each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Overlaid {
    /// Name of the run.
    pub run: String,
    /// Nothing was fitted to it but where its windows begin.
    pub left_out: bool,
    /// `instance.variable`.
    pub signal: String,
    /// Its unit.
    pub unit: String,
    /// The page lays measured, nominal and amended over each other.
    pub drawn: bool,
    /// Time in s and value, row by row of the log.
    pub measured: Vec<(f64, f64)>,
    /// What the nominal model gives, where it was compared.
    pub nominal: Vec<(f64, f64)>,
    /// What the amended one gives.
    pub amended: Vec<(f64, f64)>,
    /// Measured less amended, over time.
    pub residual: Vec<(f64, f64)>,
    /// The residual beside each state and input.
    pub over: Vec<Dependence>,
}

/// A residual beside what it may depend on.
#[derive(Debug, Clone, PartialEq)]
pub struct Dependence {
    /// The state or input.
    pub name: String,
    /// Its unit; empty: none is known.
    pub unit: String,
    /// Its value, and the amended model's residual there.
    pub pairs: Vec<(f64, f64)>,
    /// The same of the nominal model.
    pub nominal: Vec<(f64, f64)>,
}

/// Neighbours along a state or an input, as one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bin {
    /// Mean of the state or input.
    pub at: f64,
    /// Mean residual.
    pub mean: f64,
    /// Rows in it.
    pub rows: usize,
}

/// A log at a time: between two rows on the straight line, since rows that lie close are compared as their mean.
pub(crate) fn at(rows: &[(f64, f64)], time: f64) -> Option<f64> {
    let next = rows.partition_point(|(of, _)| *of < time);
    let (t1, v1) = *rows.get(next)?;
    if t1 == time || next == 0 {
        return (t1 == time).then_some(v1);
    }
    let (t0, v0) = rows[next - 1];
    Some(v0 + (time - t0) / (t1 - t0) * (v1 - v0))
}

/// The correlation of a series with itself so many rows before, from 1 row on; none of a series too short or still.
pub fn autocorrelation(points: &[(f64, f64)], most: usize) -> Vec<(f64, f64)> {
    let mean = points.iter().map(|(_, value)| value).sum::<f64>() / points.len().max(1) as f64;
    let off: Vec<f64> = points.iter().map(|(_, value)| value - mean).collect();
    let square: f64 = off.iter().map(|value| value * value).sum();
    if square <= 0.0 || points.len() < 8 {
        return Vec::new();
    }
    let at = |lag: usize| off.iter().zip(&off[lag..]).map(|(a, b)| a * b).sum::<f64>() / square;
    (1..=most.min(points.len() / 2)).map(|lag| (lag as f64, at(lag))).collect()
}

/// Means of neighbours in the first number of each pair, of as many in each bin as in any other, or one more: a dependence shows,
/// single points don't hide it. Bins that stand at the same place are one.
pub fn binned(pairs: &[(f64, f64)], bins: usize) -> Vec<Bin> {
    let finite = |(x, y): &&(f64, f64)| x.is_finite() && y.is_finite();
    let mut pairs: Vec<(f64, f64)> = pairs.iter().filter(finite).copied().collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let bins = bins.clamp(1, pairs.len().max(1));
    // the rows that are over are spread evenly: a last bin of few rows would scatter more than the others
    let edge = |bin: usize| bin * pairs.len() / bins;
    let means = (0..bins).filter_map(|bin| mean(&pairs[edge(bin)..edge(bin + 1)]));
    let mut merged: Vec<Bin> = Vec::with_capacity(bins);
    for next in means {
        match merged.last_mut().filter(|last| last.at == next.at) {
            Some(last) => {
                let (own, more) = (last.rows as f64, next.rows as f64);
                last.mean = (own * last.mean + more * next.mean) / (own + more);
                last.rows += next.rows;
            }
            None => merged.push(next),
        }
    }
    merged
}

/// One bin of pairs in order.
fn mean(part: &[(f64, f64)]) -> Option<Bin> {
    let (first, last) = (part.first()?.0, part.last()?.0);
    let many = part.len() as f64;
    let at = if first == last { first } else { part.iter().map(|pair| pair.0).sum::<f64>() / many };
    Some(Bin { at, mean: part.iter().map(|pair| pair.1).sum::<f64>() / many, rows: part.len() })
}

#[cfg(test)]
mod tests {
    use super::{Bin, at, autocorrelation, binned};

    #[test]
    fn value_autocorrelation_of_a_known_series() {
        // +1, -1, +1, ...: one row before everything is opposite, n - 1 products of n squares; two rows before equal.
        let points: Vec<(f64, f64)> =
            (0..10).map(|row| (f64::from(row), if row % 2 == 0 { 1.0 } else { -1.0 })).collect();
        assert_eq!(autocorrelation(&points, 2), [(1.0, -0.9), (2.0, 0.8)]);
        assert!(autocorrelation(&points.iter().map(|(t, _)| (*t, 3.0)).collect::<Vec<_>>(), 2).is_empty());
    }

    #[test]
    fn value_bins_are_means_of_neighbours() {
        let pairs = vec![(3.0, 30.0), (1.0, 10.0), (4.0, 40.0), (2.0, f64::NAN), (2.0, 20.0)];
        let bin = |at: f64, mean: f64, rows: usize| Bin { at, mean, rows };
        assert_eq!(binned(&pairs, 2), [bin(1.5, 15.0, 2), bin(3.5, 35.0, 2)]);
        // a switch has two values: what lies at one of them is one bin, whatever its neighbours are
        let switch: Vec<(f64, f64)> =
            (0..9).map(|row| (if row < 4 { 0.1 } else { 0.3 }, f64::from(row))).collect();
        assert_eq!(binned(&switch, 9), [bin(0.1, 1.5, 4), bin(0.3, 6.0, 5)]);
        assert!(binned(&[], 3).is_empty());
    }

    #[test]
    fn law_no_bin_has_more_than_one_row_more_than_another() {
        for rows in [23, 24, 25, 130, 601, 1201] {
            let pairs: Vec<(f64, f64)> = (0..rows).map(|row| (f64::from(row), 0.0)).collect();
            let each: Vec<usize> = binned(&pairs, 24).iter().map(|bin| bin.rows).collect();
            let (least, most) = (each.iter().min().expect("bins"), each.iter().max().expect("bins"));
            assert!(most - least <= 1, "{rows} rows: {each:?}");
            assert_eq!((each.len(), each.iter().sum::<usize>()), (24.min(rows as usize), rows as usize));
        }
    }

    #[test]
    fn law_a_log_is_known_between_its_rows_only() {
        let rows = [(0.0, 1.0), (1.0, 3.0)];
        assert_eq!([0.0, 0.5, 1.0].map(|time| at(&rows, time)), [Some(1.0), Some(2.0), Some(3.0)]);
        assert_eq!([-0.1, 1.1].map(|time| at(&rows, time)), [None, None]);
    }
}
