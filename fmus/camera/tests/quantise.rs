//! What is made of a frame where only an area of it is asked for, and how well the words of the noise are mixed.

use crate::common::*;
use camera::photometry::Area;
use camera::photometry::noise::{Keys, gain, mixed};
use camera::photometry::plane::{BLOCK, Mask, Plane};
use camera::photometry::quantise::quantise;

#[test]
fn every_area_is_made_as_it_is_in_the_whole_frame_and_nothing_beside_it() {
    let (width, height) = (100, 30);
    let mut random = Random(77);
    let mut base = Plane::filled(width, height, 0_i16, i16::MIN);
    for y in 0..height {
        base.row_mut(y).iter_mut().for_each(|parts| *parts = random.between(0.0, 16320.0) as i16);
    }
    let all = Area { x0: 0, y0: 0, x1: width, y1: height };
    for trial in 0..400 {
        let noise = (trial % 3 > 0).then(|| (Keys::new(trial, 5), gain(20.0)));
        let level = 1 + (random.uniform() * 255.0) as u8;
        let mut side = |most: usize| {
            let from = random.between(0.0, most as f64) as usize;
            (from, from + 1 + random.between(0.0, (most - from) as f64) as usize)
        };
        let ((x0, x1), (y0, y1)) =
            if trial % 4 == 0 { ((0, width), side(height)) } else { (side(width), side(height)) };
        let area = Area { x0, y0, x1: x1.min(width), y1: y1.min(height) };
        let step = 1 + trial as usize % 2;
        let made = |area: Area, step: usize| {
            // 77 and a bit pattern that no pixel's neighbours have stand for what was there before.
            let (mut picture, mut mask) = (Plane::filled(width, height, 77, 77), Mask::empty(width, height));
            mask.words.fill(0x5a5a_a5a5);
            quantise(&base, area, step, noise, level, &mut picture, &mut mask);
            (picture, mask)
        };
        let ((picture, mask), (whole, whole_mask)) = (made(area, step), made(all, 1));
        for y in 0..height {
            for block in 0..mask.stride {
                let asked = (area.x0 / BLOCK..area.x1.div_ceil(BLOCK)).contains(&block)
                    && (area.y0..area.y1).contains(&y)
                    && (y - area.y0).is_multiple_of(step);
                let pixels = y * picture.stride + block * BLOCK..y * picture.stride + (block + 1) * BLOCK;
                let word = mask.words[y * mask.stride + block];
                if asked {
                    assert_eq!(
                        picture.values[pixels.clone()],
                        whole.values[pixels.clone()],
                        "{area:?} {step} {y}"
                    );
                    assert_eq!(word, whole_mask.words[y * mask.stride + block]);
                    let bits = picture.values[pixels]
                        .iter()
                        .enumerate()
                        .fold(0, |bits, (i, p)| bits | u32::from(*p >= level) << i);
                    assert_eq!(word, bits);
                } else {
                    assert!(picture.values[pixels].iter().all(|pixel| *pixel == 77), "{area:?} {step} {y}");
                    assert_eq!(word, 0x5a5a_a5a5);
                }
            }
        }
    }
}

#[test]
fn law_every_bit_of_seed_frame_and_stream_turns_each_bit_of_the_word_half_of_the_time() {
    const TRIALS: u32 = 1000;
    // 64 · 128 counts, of deviation 16: beyond six deviations one in 60 000 such tests.
    let allowed = 6.0 * 0.5 * f64::from(TRIALS).sqrt();
    let mut random = Random(8);
    let inputs: Vec<(i32, i64, u64)> = (0..TRIALS)
        .map(|_| {
            let mut word = || (random.uniform() * 4_294_967_296.0) as u32;
            // Seeds and frames as they are: small numbers and others.
            let (seed, k) = (word() >> (word() % 32), i64::from(word()) >> (word() % 32));
            (seed as i32, k, u64::from(word()))
        })
        .collect();
    for bit in 0..32 + 63 + 32 {
        let mut turned = [0_u32; 64];
        for (seed, k, stream) in &inputs {
            let other = match bit {
                0..32 => mixed(seed ^ (1_u32 << bit) as i32, *k, *stream),
                32..95 => mixed(*seed, k ^ (1 << (bit - 32)), *stream),
                _ => mixed(*seed, *k, stream ^ (1 << (bit - 95))),
            };
            let difference = mixed(*seed, *k, *stream) ^ other;
            turned.iter_mut().enumerate().for_each(|(i, count)| *count += (difference >> i & 1) as u32);
        }
        for (i, count) in turned.into_iter().enumerate() {
            let off = (f64::from(count) - 0.5 * f64::from(TRIALS)).abs();
            assert!(off < allowed, "input bit {bit}, bit {i}: {count} of {TRIALS}");
        }
    }
    // Both keys of a frame come of it.
    let ones =
        |key: fn(Keys) -> u32| (0..TRIALS).map(|k| key(Keys::new(1, i64::from(k))).count_ones()).sum::<u32>();
    for count in [ones(|keys| keys.0), ones(|keys| keys.1)] {
        // 32 000 fair bits: four deviations.
        assert!((f64::from(count) - 16_000.0).abs() < 4.0 * 0.5 * 32_000.0_f64.sqrt(), "{count}");
    }
}

#[test]
fn value_the_words_of_frames_one_after_the_other_are_splitmix64s() {
    // Steele, Lea and Flood (2014), with the constants of Vigna's splitmix64.c: states are this far apart.
    const GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;
    let inverse = |odd: u64| {
        (0..6).fold(odd, |found, _| found.wrapping_mul(2_u64.wrapping_sub(odd.wrapping_mul(found))))
    };
    let state = |word: u64| {
        let z = word ^ (word >> 31) ^ (word >> 62);
        let z = z.wrapping_mul(inverse(0x94d0_49bb_1331_11eb));
        let z = z ^ (z >> 27) ^ (z >> 54);
        let z = z.wrapping_mul(inverse(0xbf58_476d_1ce4_e5b9));
        z ^ (z >> 30) ^ (z >> 60)
    };
    // Its first two words from the state 1234567, as Rosetta Code lists them.
    assert_eq!(state(6_457_827_717_110_365_317), GAMMA.wrapping_add(1_234_567));
    assert_eq!(state(3_203_168_211_198_807_973), GAMMA.wrapping_mul(2).wrapping_add(1_234_567));
    for (seed, stream) in [(0, 0), (1, 0), (-5, 7), (i32::MAX, 0x6c6f_7373)] {
        let first = state(mixed(seed, 0, stream));
        for k in [1_i64, 2, 3, 1000, -1, i64::from(u32::MAX) * 1000] {
            let expected = first.wrapping_add(GAMMA.wrapping_mul(k as u64));
            assert_eq!(state(mixed(seed, k, stream)), expected, "{seed} {stream} {k}");
        }
    }
}
