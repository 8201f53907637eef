//! Sobol's sequence in Gray-code order, as Bratley and Fox (1988), ACM TOMS algorithm 659, with the direction numbers of
//! Joe and Kuo (2008). The crates that have it are either scrambled (so that nothing else agrees with them) or not kept; it
//! is a page. `tests/fmpy/test_sweep.py` holds it against `scipy.stats.qmc.Sobol`.

use super::directions::STARTS;

/// Parameters, at most.
pub(super) const DIMENSIONS: usize = STARTS.len();
/// Points, at most: more have no digits.
pub(super) const POINTS: u64 = 1 << 32;

const DIGITS: usize = 32;

/// The direction numbers of a dimension, the first digit of each uppermost.
pub(super) type Directions = [u32; DIGITS];

/// Those of a dimension, from 0.
pub(super) fn directions(dimension: usize) -> Directions {
    let (polynomial, starts) = STARTS[dimension];
    let degree = starts.len();
    let mut v = [0; DIGITS];
    for digit in 0..DIGITS {
        v[digit] = match starts.get(digit) {
            Some(start) => start << (DIGITS - 1 - digit),
            // The first dimension: the digits of the number in reverse (van der Corput).
            None if degree == 0 => 1 << (DIGITS - 1 - digit),
            None => {
                // v_k = a₁ v_{k-1} ⊕ ... ⊕ a_{s-1} v_{k-s+1} ⊕ v_{k-s} ⊕ v_{k-s}/2^s
                let mut sum = v[digit - degree] ^ (v[digit - degree] >> degree);
                for back in 1..degree {
                    if polynomial >> (degree - back) & 1 == 1 {
                        sum ^= v[digit - back];
                    }
                }
                sum
            }
        };
    }
    v
}

/// The n-th point, as 32 digits after the point.
pub(super) fn point(directions: &Directions, n: u32) -> u32 {
    let gray = n ^ (n >> 1);
    (0..DIGITS).filter(|digit| gray >> digit & 1 == 1).fold(0, |sum, digit| sum ^ directions[digit])
}

/// As a number from 0 to below 1.
pub(super) fn share(point: u32) -> f64 {
    f64::from(point) / (1u64 << DIGITS) as f64
}

#[cfg(test)]
mod tests {
    use super::{DIMENSIONS, directions, point, share};

    #[test]
    fn value_the_first_points_are_those_of_scipy() {
        // scipy 1.17: qmc.Sobol(4, scramble=False).random(8)
        let expected = [
            [0.0, 0.0, 0.0, 0.0],
            [0.5, 0.5, 0.5, 0.5],
            [0.75, 0.25, 0.25, 0.25],
            [0.25, 0.75, 0.75, 0.75],
            [0.375, 0.375, 0.625, 0.875],
            [0.875, 0.875, 0.125, 0.375],
            [0.625, 0.125, 0.875, 0.625],
            [0.125, 0.625, 0.375, 0.125],
        ];
        for (n, row) in expected.iter().enumerate() {
            for (dimension, value) in row.iter().enumerate() {
                assert_eq!(share(point(&directions(dimension), n as u32)), *value, "{n} {dimension}");
            }
        }
    }

    #[test]
    fn law_every_dyadic_slice_holds_one_of_as_many_points() {
        for dimension in 0..DIMENSIONS {
            let numbers = directions(dimension);
            let mut seen = [false; 1024];
            (0..1024).for_each(|n| seen[(point(&numbers, n) >> 22) as usize] = true);
            assert!(seen.iter().all(|seen| *seen), "dimension {dimension}");
        }
    }
}
