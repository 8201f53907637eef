//! The values of a case by its number. Random numbers are ChaCha8's, at a place of the stream that the case and the parameter
//! name: nothing is drawn in turn, so any part of a study can be made alone.

use super::{Design, Method, Sampled, sobol};
use orchestrator::Value;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};

/// Slices of a Latin hypercube, at most: their order is kept in memory.
pub(super) const SLICES: u64 = 1 << 24;

/// Gives the values of cases.
#[derive(Debug)]
pub(crate) struct Sampler {
    design: Design,
    /// Of a Latin hypercube: for each parameter which slice a case lies in.
    slices: Vec<Vec<u32>>,
    /// Of Sobol's sequence: for each parameter its direction numbers and its shift.
    directions: Vec<(sobol::Directions, u32)>,
}

/// What random numbers are for; each has a stream of its own for each parameter.
#[derive(Clone, Copy)]
enum Purpose {
    Points,
    Slices,
    Shift,
}

fn stream(seed: u64, purpose: Purpose, parameter: usize) -> ChaCha8Rng {
    let mut numbers = ChaCha8Rng::seed_from_u64(seed);
    numbers.set_stream(3 * parameter as u64 + purpose as u64);
    numbers
}

/// A number from 0 to below 1 with 53 digits.
fn share(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1u64 << 53) as f64
}

impl Sampler {
    pub(crate) fn new(design: Design) -> Self {
        let (mut slices, mut directions) = (Vec::new(), Vec::new());
        if let Design::Sampled(Sampled { method, count, seed, ranges }) = &design {
            match method {
                Method::Random => {}
                Method::LatinHypercube => {
                    slices = (0..ranges.len()).map(|at| shuffled(*count, seed.unwrap_or(0), at)).collect();
                }
                Method::Sobol => {
                    let shift = |at| seed.map_or(0, |seed| stream(seed, Purpose::Shift, at).next_u32());
                    directions = (0..ranges.len()).map(|at| (sobol::directions(at), shift(at))).collect();
                }
            }
        }
        Self { design, slices, directions }
    }

    pub(crate) fn design(&self) -> &Design {
        &self.design
    }

    /// How many cases there are.
    pub(crate) fn cases(&self) -> u64 {
        self.design.cases().unwrap_or(0)
    }

    /// The value of a parameter in a case.
    pub(crate) fn value(&self, case: u64, parameter: usize) -> Value {
        let sampled = match &self.design {
            Design::Grid(axes) => {
                let faster: u64 = axes[parameter + 1..].iter().map(|axis| axis.len() as u64).product();
                let axis = &axes[parameter];
                return axis[(case / faster % axis.len() as u64) as usize].clone();
            }
            Design::List(rows) => return rows[case as usize][parameter].clone(),
            Design::Sampled(sampled) => sampled,
        };
        let seed = sampled.seed.unwrap_or(0);
        let drawn = || {
            let mut numbers = stream(seed, Purpose::Points, parameter);
            // In words of 32 bits.
            numbers.set_word_pos(2 * u128::from(case));
            share(numbers.next_u64())
        };
        let share = match sampled.method {
            Method::Random => drawn(),
            Method::LatinHypercube => {
                (f64::from(self.slices[parameter][case as usize]) + drawn()) / sampled.count as f64
            }
            Method::Sobol => {
                let (directions, shift) = &self.directions[parameter];
                sobol::share(sobol::point(directions, case as u32) ^ shift)
            }
        };
        let range = &sampled.ranges[parameter];
        match range.whole {
            true => Value::Integer(range.at(share) as i32),
            false => Value::Real(range.at(share)),
        }
    }
}

/// The numbers from 0 on in a random order (Fisher and Yates).
fn shuffled(count: u64, seed: u64, parameter: usize) -> Vec<u32> {
    let mut numbers = stream(seed, Purpose::Slices, parameter);
    let mut order: Vec<u32> = (0..count as u32).collect();
    for last in (1..order.len()).rev() {
        // Of 64 bits the upper ones of the product: even to 1 in 2⁴⁰ for as many slices as there may be.
        let other = (u128::from(numbers.next_u64()) * (last as u128 + 1)) >> 64;
        order.swap(last, other as usize);
    }
    order
}

#[cfg(test)]
mod tests {
    use super::Sampler;
    use crate::design::{Design, Method, Range, Sampled};
    use orchestrator::Value;

    fn sampler(method: Method, count: u64, seed: Option<u64>, whole: bool) -> Sampler {
        let range = Range { from: -1.0, to: 3.0, log: false, whole };
        let log = Range { from: 1e-3, to: 10.0, log: true, whole: false };
        Sampler::new(Design::Sampled(Sampled { method, count, seed, ranges: vec![range, log] }))
    }

    fn real(sampler: &Sampler, case: u64, parameter: usize) -> f64 {
        sampler.value(case, parameter).as_f64().expect("a number")
    }

    #[test]
    fn law_every_slice_of_a_latin_hypercube_holds_one_point() {
        let sampler = sampler(Method::LatinHypercube, 100, Some(7), false);
        let mut seen = [[false; 100]; 2];
        for case in 0..100 {
            seen[0][((real(&sampler, case, 0) + 1.0) / 4.0 * 100.0) as usize] = true;
            seen[1][((real(&sampler, case, 1).log10() + 3.0) / 4.0 * 100.0) as usize] = true;
        }
        assert_eq!(seen, [[true; 100]; 2]);
    }

    #[test]
    fn law_cases_are_known_by_their_number_alone() {
        for method in [Method::Random, Method::LatinHypercube, Method::Sobol] {
            let (one, other) = (sampler(method, 64, Some(1), false), sampler(method, 64, Some(1), false));
            let forth: Vec<f64> = (0..64).map(|case| real(&one, case, 0)).collect();
            let back: Vec<f64> = (0..64).rev().map(|case| real(&other, case, 0)).collect();
            assert!(forth.iter().eq(back.iter().rev()), "{method:?}");
            assert!(forth.iter().all(|value| (-1.0..=3.0).contains(value)));
            let seeded = sampler(method, 64, Some(2), false);
            assert_ne!(forth[0], real(&seeded, 0, 0), "another seed, other cases: {method:?}");
        }
    }

    #[test]
    fn law_random_points_fill_their_range_evenly() {
        // The mean of n even numbers over 4 strays by 4/√(12 n) = 0.0115 at n = 10 000; four of these.
        let sampler = sampler(Method::Random, 10_000, Some(3), false);
        let mean = (0..10_000).map(|case| real(&sampler, case, 0)).sum::<f64>() / 10_000.0;
        assert!((mean - 1.0).abs() < 0.046, "{mean}");
    }

    #[test]
    fn law_whole_numbers_have_both_ends() {
        let sampler = sampler(Method::Random, 1000, Some(3), true);
        let mut counts = [0; 5];
        for case in 0..1000 {
            match sampler.value(case, 0) {
                Value::Integer(value) => counts[(value + 1) as usize] += 1,
                other => panic!("{other}"),
            }
        }
        // 200 each, sd 12.6.
        assert!(counts.iter().all(|count| (150..250).contains(count)), "{counts:?}");
    }

    #[test]
    fn law_the_last_parameter_of_a_grid_varies_fastest() {
        let axis = |values: &[i32]| values.iter().map(|value| Value::Integer(*value)).collect();
        let sampler = Sampler::new(Design::Grid(vec![axis(&[1, 2]), axis(&[3, 4, 5])]));
        let all: Vec<(f64, f64)> =
            (0..6).map(|case| (real(&sampler, case, 0), real(&sampler, case, 1))).collect();
        assert_eq!(all, [(1.0, 3.0), (1.0, 4.0), (1.0, 5.0), (2.0, 3.0), (2.0, 4.0), (2.0, 5.0)]);
    }
}
