//! The noise: its law, its independence of region and order, and the same bits on every path.

use crate::common::*;
use camera::photometry::noise::{self, Keys};
use camera::photometry::plane::{Mask, Plane};
use camera::photometry::quantise::{Span, portable};
use camera::photometry::{Area, quantise, simd};

/// Normal distribution function by Simpson's rule on the density (1e-10).
fn normal(x: f64) -> f64 {
    let n = 2000;
    let h = x / f64::from(n);
    let density = |t: f64| (-0.5 * t * t).exp();
    let sum: f64 = (0..n)
        .map(|i| {
            let a = f64::from(i) * h;
            density(a) + 4.0 * density(a + 0.5 * h) + density(a + h)
        })
        .sum();
    0.5 + sum * h / 6.0 / (2.0 * core::f64::consts::PI).sqrt()
}

/// Largest distance between the distribution of sorted values and the normal one.
fn cdf_error(sorted: &[f64], sigma: f64) -> f64 {
    let n = sorted.len() as f64;
    let mut worst: f64 = 0.0;
    let mut i = 0;
    while i < sorted.len() {
        let mut j = i;
        while j < sorted.len() && sorted[j] == sorted[i] {
            j += 1;
        }
        let p = normal(sorted[i] / sigma);
        worst = worst.max((i as f64 / n - p).abs()).max((j as f64 / n - p).abs());
        i = j;
    }
    worst
}

#[test]
fn value_noise_law() {
    // All 65 536 deviates there are, scaled to sigma 15 as the frames are: the law before quantisation.
    let gain = noise::gain(15.0);
    let mut all: Vec<f64> =
        (0..=u16::MAX).map(|bits| f64::from(noise::scaled(noise::deviate(bits), gain)) / 64.0).collect();
    let mean = all.iter().sum::<f64>() / 65536.0;
    let deviation = (all.iter().map(|x| x * x).sum::<f64>() / 65536.0 - mean * mean).sqrt();
    all.sort_by(f64::total_cmp);
    let error = cdf_error(&all, 15.0);
    println!("mean {mean:.2e}, deviation {deviation:.5}, CDF error {error:.2e}");
    // Issue 2 and 5: mean within .02 grey levels, deviation within .2 %, CDF within 5e-4. A deviate is a multiple of
    // 1/64 grey level, whose half is 2e-4 of the CDF at sigma 15; without it the tables are good to CDF_ERROR.
    assert!(mean.abs() < 1e-3 && (deviation / 15.0 - 1.0).abs() < 5e-4);
    assert!(error < 5e-4, "{error}");
    let mut bare: Vec<f64> = (0..=u16::MAX).map(|bits| f64::from(noise::deviate(bits))).collect();
    bare.sort_by(f64::total_cmp);
    assert!(cdf_error(&bare, noise::deviation()) <= noise::CDF_ERROR);
}

#[test]
fn value_tails_are_a_gaussians() {
    // 400 frames' worth of grey 128 at sigma 15: a level shows places to 1/30 of a deviation, and 0 and 255 lie 8.5
    // deviations away.
    let (base, mut picture) = (Plane::filled(512, 512, 128 * 64, 0), Plane::filled(512, 512, 0, 0));
    let mut mask = Mask::empty(512, 512);
    let all = Area { x0: 0, y0: 0, x1: 512, y1: 512 };
    let mut counts = [0_u32; 256];
    for k in 0..400 {
        let noise = Some((Keys::new(17, k), noise::gain(15.0)));
        quantise::quantise(&base, all, 1, noise, 180, &mut picture, &mut mask);
        picture.values.iter().for_each(|grey| counts[usize::from(*grey)] += 1);
        let over = picture.values.iter().filter(|grey| **grey >= 180).count();
        assert_eq!(over, mask.words.iter().map(|word| word.count_ones() as usize).sum::<usize>());
    }
    let n = 400.0 * f64::from(1 << 18);
    // The sums' own steps are seen up to 3.9 deviations; the sums alone have 0.15 of what there should be at 3.8.
    for (levels, within) in [
        (39_u8, 0.07),
        (45, 0.08),
        (48, 0.1),
        (51, 0.1),
        (54, 0.15),
        (57, 0.15),
        (60, 0.02),
        (66, 0.02),
        (72, 0.02),
        (75, 0.02),
    ] {
        let beyond = |grey: usize| grey.abs_diff(128) >= usize::from(levels);
        let seen: f64 = (0..256).filter(|grey| beyond(*grey)).map(|grey| f64::from(counts[grey])).sum();
        let sigmas = (f64::from(levels) - 0.5) / 15.0;
        let expected = n * libm::erfc(sigmas * std::f64::consts::FRAC_1_SQRT_2);
        println!("beyond {sigmas:.2} sigma: {seen}, expected {expected:.0}, {:.3}", seen / expected);
        // Four standard deviations of the count beside.
        let allowed = 4.0 * expected.sqrt() + within * expected;
        assert!((seen - expected).abs() < allowed, "beyond {sigmas} sigma: {seen}, expected {expected}");
    }
    let (up, down): (u32, u32) = (counts[180..].iter().sum(), counts[..=76].iter().sum());
    assert!(f64::from(up.abs_diff(down)) < 4.0 * f64::from(up + down).sqrt(), "{up} up, {down} down");
}

#[test]
fn value_frames_are_independent_and_uniform() {
    // 512 x 512 words of two frames: bits are fair, frames and neighbours uncorrelated, to four standard deviations.
    let n = 1 << 17;
    let words = |k: i64| (0..n).map(move |w| noise::random_word(w, Keys::new(5, k))).collect::<Vec<u32>>();
    let (a, b) = (words(7), words(8));
    let fair = 4.0 * (f64::from(n)).sqrt() / 2.0;
    for bit in 0..32 {
        let ones = |it: &mut dyn Iterator<Item = u32>| it.filter(|word| word >> bit & 1 == 1).count() as f64;
        for (name, count) in [
            ("set", ones(&mut a.iter().copied())),
            ("frames", ones(&mut a.iter().zip(&b).map(|(x, y)| x ^ y))),
            ("neighbours", ones(&mut a.windows(2).map(|pair| pair[0] ^ pair[1]))),
            ("rows", ones(&mut a.iter().zip(&a[256..]).map(|(x, y)| x ^ y))),
            ("halves", ones(&mut a.iter().map(|x| x ^ x.rotate_left(16)))),
        ] {
            let of = if name == "rows" { n - 256 } else { n };
            assert!((count - f64::from(of) / 2.0).abs() < fair, "{name}, bit {bit}: {count} of {of}");
        }
    }
    // No frame is another one shifted: no word of one stands among the same place's neighbours in the other.
    let same = a.iter().filter(|word| b.contains(word)).take(40).count();
    // 2^17 · 2^17 / 2^32 = 4 chance meetings are expected.
    assert!(same < 20, "{same}");
}

#[test]
fn every_path_gives_the_same_bits() {
    let names: Vec<&str> = simd::available().into_iter().map(|(name, _)| name).collect();
    #[cfg(target_arch = "x86_64")]
    {
        let wide = std::arch::is_x86_feature_detected!("avx512bw")
            && std::arch::is_x86_feature_detected!("avx512vl");
        assert_eq!(names.contains(&"AVX-512"), wide);
        assert_eq!(names.contains(&"AVX2"), std::arch::is_x86_feature_detected!("avx2"));
    }
    assert_eq!(names.last(), Some(&"portable"), "the one for every machine comes last");
    let mut random = Random(11);
    for trial in 0..200 {
        let blocks = 1 + trial % 7;
        let base: Vec<i16> = (0..32 * blocks).map(|_| random.between(-33000.0, 33000.0) as i16).collect();
        let keys = Keys::new(trial as i32, 3);
        let gain = [1, 300, 4423, 32767][trial % 4];
        let noise = if trial % 5 == 0 { None } else { Some((keys, gain)) };
        let level = 1 + (random.uniform() * 255.0) as u8;
        let span = Span { base: &base, first_word: u32::MAX - 20 + trial as u32, noise, level };
        let made = |path: simd::Path| {
            let (mut picture, mut mask) = (vec![0; 32 * blocks], vec![0; blocks]);
            path(span, &mut picture, &mut mask);
            (picture, mask)
        };
        for (name, path) in simd::available() {
            assert_eq!(made(portable), made(path), "{name}, trial {trial}");
        }
    }
}

#[test]
fn value_noise_in_whole_frames() {
    // The mean over a frame's 2^18 pixels of a grey background, sigma 15: within four standard errors, 4 · 15 / 512.
    use camera::photometry::{FrameMaker, Shot};
    let base = variables(|v| {
        (v.scene.background, v.scene.foreground) = (128.0, 255.0);
        v.effects.noise.deviation = 15.0;
        v.sensor.threshold = 240.0;
    });
    let mut maker = FrameMaker::new(&base.scene, &base.sensor, &base.effects).expect("legal parameters");
    let far = [[(100.0, 100.0); 3]];
    let mut before: Vec<u8> = Vec::new();
    for k in 0..4 {
        maker.render(Shot { k, seed: 0, centres_world: &far, whole: true });
        let pixels: Vec<f64> = maker.picture().values.iter().map(|pixel| f64::from(*pixel)).collect();
        let mean = pixels.iter().sum::<f64>() / pixels.len() as f64;
        let deviation = (pixels.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / pixels.len() as f64).sqrt();
        assert!((mean - 128.0).abs() < 0.117, "{mean}");
        // Rounding to whole levels adds 1/12 to the variance; four standard errors are 0.083.
        assert!((deviation - (225.0f64 + 1.0 / 12.0).sqrt()).abs() < 0.083, "{deviation}");
        assert_ne!(before, maker.picture().values);
        before.clone_from(&maker.picture().values);
    }
}
