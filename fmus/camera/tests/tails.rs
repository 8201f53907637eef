//! The tails of the noise by themselves: how many pixels lie in them, and how far out.

use camera::photometry::noise::{self, Keys};
use camera::photometry::quantise::{Span, reaches, rounded};
use camera::photometry::tails;

/// Probability that a Gaussian lies beyond t deviations either way.
fn gaussian(t: f64) -> f64 {
    libm::erfc(t * core::f64::consts::FRAC_1_SQRT_2)
}

/// Where the sums begin to be too few, in deviations.
const BEGIN: f64 = 3.2;

/// What the sums lack beyond t: Q − B through the middles of B's steps, and never rising.
fn missing(t: f64) -> f64 {
    let mut sums: Vec<i16> = (0..=u16::MAX).map(|bits| noise::deviate(bits).abs()).collect();
    sums.sort_unstable();
    let beyond = |sum: i16| (sums.len() - sums.partition_point(|other| *other <= sum)) as f64 / 65536.0;
    let mut steps: Vec<(f64, f64)> = Vec::new(); // from the outermost in
    let mut step = |at: f64, sums: f64| {
        let least = steps.last().map_or(0.0, |(_, missing)| *missing);
        if steps.last().is_none_or(|(known, _)| *known != at) {
            steps.push((at, (gaussian(at) - sums).max(least)));
        }
    };
    for sum in sums.iter().rev() {
        let at = f64::from(*sum) / noise::deviation();
        if at < BEGIN {
            step(BEGIN, beyond(*sum));
            break;
        }
        step(at, 0.5 * (beyond(*sum) + beyond(*sum - 1)));
    }
    if t >= steps[0].0 {
        return gaussian(t);
    }
    let after = steps.windows(2).find(|pair| pair[1].0 <= t).expect("t is in the tail");
    let ((t1, s1), (t0, s0)) = (after[0], after[1]);
    s0 + (s1 - s0) * (t - t0) / (t1 - t0)
}

#[test]
fn value_as_many_pixels_lie_in_a_tail_as_the_sums_lack() {
    // σ = 30, on a grey of 0: what goes up shows in steps of 1/30 of a deviation, to 8.5 of them.
    const PIXELS: usize = 1 << 20;
    const FRAMES: i64 = 1500;
    let (base, gain) = (vec![0_i16; PIXELS], noise::gain(30.0));
    let (mut picture, mut mask) = (vec![0_u8; PIXELS], vec![0_u32; PIXELS / 32]);
    let (mut counts, mut up, mut down) = ([0_u32; 256], 0.0, 0.0);
    for k in 0..FRAMES {
        // What is not drawn anew stays at 7, which no tail shows: 3.2 deviations are 96.
        picture.fill(7);
        let span = Span { base: &base, first_word: 0, noise: Some((Keys::new(5, k), gain)), level: 200 };
        tails::draw(span, &mut picture, &mut mask);
        for pixel in picture.iter().filter(|pixel| **pixel != 7) {
            counts[usize::from(*pixel)] += 1;
            *(if *pixel > 0 { &mut up } else { &mut down }) += 1.0;
        }
    }
    let n = PIXELS as f64 * FRAMES as f64;
    let expected = n * missing(BEGIN);
    // Counted things scatter by their root: four of them.
    assert!((up + down - expected).abs() < 4.0 * expected.sqrt(), "{} drawn, not {expected}", up + down);
    assert!(f64::abs(up - down) < 4.0 * expected.sqrt(), "{up} up, {down} down");
    for level in [99_u8, 102, 105, 108, 111, 114, 118, 122, 126, 135, 145, 155] {
        let t = (f64::from(level) - 0.5) / 30.0;
        let seen: f64 = counts[usize::from(level)..].iter().copied().map(f64::from).sum();
        let expected = 0.5 * n * missing(t);
        println!("beyond {t:.3}: {seen}, expected {expected:.0}, {:.4}", seen / expected);
        // Magnitudes are in 32 parts of an octave of probability: half of one is 1.1 %.
        let allowed = 4.0 * expected.sqrt() + 0.011 * expected;
        assert!((seen - expected).abs() < allowed, "beyond {t}: {seen}, expected {expected}");
    }
}

#[test]
fn value_noise_reaches_a_level_if_its_largest_does() {
    // Without noise a grey level begins half a level below.
    for level in [1_u8, 90, 191, 255] {
        let first = 64 * i16::from(level) - 32;
        assert!(reaches(first, None, level) && reaches(first + 100, None, level));
        assert!(!reaches(first - 1, None, level) && !reaches(0, None, level));
    }
    // The random bits end at 6.5 deviations: 2⁻²³ of the pixels that are drawn, in the middle of a 32nd of it.
    for sigma in [15.0, 30.0] {
        let gain = noise::gain(sigma);
        let largest = tails::largest(gain);
        let share = gaussian(f64::from(largest) / 64.0 / sigma) / missing(BEGIN) * 2.0_f64.powi(23);
        // Whole parts and a whole gain: 1e-3 of 6.5 deviations, where Q falls by 6.7 of itself a deviation.
        assert!((share - 1.0 - 1.0 / 64.0).abs() < 0.01, "{sigma}: {largest}, {share}");
        let noise = Some((Keys::new(0, 0), gain));
        let level = rounded(largest);
        let first = 64 * i16::from(level) - 32;
        assert!(reaches(first - largest, noise, level) && !reaches(first - largest - 1, noise, level));
    }
    // In proportion to the gain, to the nearest part.
    let half = f64::from(tails::largest(16_384));
    for gain in [0_i16, 1, 5, 40, 300, 1000, 1024, 4423, 8191, 12_000] {
        let (found, share) = (f64::from(tails::largest(gain)), f64::from(gain) / 16_384.0);
        assert!((found - half * share).abs() <= 0.5 + 0.5 * share, "{gain}: {found}");
    }
}

#[test]
fn value_the_rarest_pixel_that_there_is_lies_as_far_out_as_noise_can() {
    // One in 2²³ of those that are drawn, found by trying: its random bits are all 0.
    const CELL: usize = 1024;
    let (seed, k, cell) = (0, 2388, 17_471);
    let (base, gain) = (vec![64 * 120_i16; CELL], noise::gain(15.0));
    let (mut picture, mut mask) = (vec![120_u8; CELL], vec![0_u32; CELL / 32]);
    let first_word = (cell * CELL / 2) as u32;
    let span = Span { base: &base, first_word, noise: Some((Keys::new(seed, k), gain)), level: 100 };
    tails::draw(span, &mut picture, &mut mask);
    let drawn: Vec<usize> = (0..CELL).filter(|place| picture[*place] != 120).collect();
    assert_eq!(drawn.len(), 1);
    let noise = if picture[drawn[0]] > 120 { tails::largest(gain) } else { -tails::largest(gain) };
    let expected = rounded(64 * 120 + noise);
    assert_eq!(picture[drawn[0]], expected);
    assert_eq!(mask[drawn[0] / 32] >> (drawn[0] % 32) & 1, u32::from(expected >= 100));
}
