//! The AVX2 and AVX-512 paths of [`super::quantise`] and the AVX2 one of [`super::edges`], chosen at run time. All
//! `unsafe` of the camera is in this file.

#![allow(unsafe_code)] // intrinsics of the processor

use super::edges;
use super::quantise::{Span, portable};

/// A way to quantise a span.
pub type Path = fn(Span<'_>, &mut [u8], &mut [u32]);

/// The paths that this machine has, the fastest first.
pub fn available() -> Vec<(&'static str, Path)> {
    let mut paths: Vec<(&'static str, Path)> = Vec::new();
    #[cfg(target_arch = "x86_64")]
    {
        if x86::has_avx512() {
            paths.push(("AVX-512", x86::avx512));
        }
        if std::arch::is_x86_feature_detected!("avx2") {
            paths.push(("AVX2", x86::avx2));
        }
    }
    paths.push(("portable", portable));
    paths
}

/// The fastest path that this machine has.
pub fn best() -> Path {
    #[cfg(target_arch = "x86_64")]
    {
        if x86::has_avx512() {
            return x86::avx512;
        }
        if std::arch::is_x86_feature_detected!("avx2") {
            return x86::avx2;
        }
    }
    portable
}

/// Adds a closed polygon of short edges to the cells. Cells beyond the last are left out, or take the last's place.
pub fn add_short(cells: &mut [i32], stride: usize, xs: &[f32], ys: &[f32], origin: (f32, f32)) {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the machine has AVX2, which is all that the function needs.
        return unsafe { x86::add_short(cells, stride, xs, ys, origin) };
    }
    edges::each::<4>(xs, ys, origin, stride as i32, |edges| edges::add(cells, edges));
}

/// Adds a·cos + b·sin to each place.
pub fn add_wave(places: &mut [f32], cosines: &[f32], sines: &[f32], parts: (f32, f32)) {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the machine has AVX2, which is all that the function needs.
        return unsafe { x86::add_wave(places, cosines, sines, parts) };
    }
    edges::add_wave(places, cosines, sines, parts);
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::super::edges::{self, CELLS, Edges};
    use super::super::noise::{Keys, ROUNDS, TABLE_A, TABLE_B, WEIGHTS};
    use super::super::plane::BLOCK;
    use super::Span;
    use core::arch::x86_64::*;

    /// Same bits as [`super::portable`]. Only handed out by [`super::best`] where the machine has AVX2.
    pub fn avx2(span: Span<'_>, picture: &mut [u8], mask: &mut [u32]) {
        let blocks = span.base.len() / BLOCK;
        assert!(picture.len() >= blocks * BLOCK && mask.len() >= blocks, "a span's slices have one length");
        // SAFETY: `best` has seen that the machine has AVX2; the lengths that the pointers rely on are asserted.
        unsafe {
            match span.noise {
                Some((keys, gain)) => noisy(span, keys, gain, picture, mask, blocks),
                None => clean(span, picture, mask, blocks),
            }
        }
    }

    /// The same source as everywhere, with eight lanes. Without fused multiply-add, which would change bits.
    #[target_feature(enable = "avx2")]
    pub fn add_short(cells: &mut [i32], stride: usize, xs: &[f32], ys: &[f32], origin: (f32, f32)) {
        assert!(cells.len() >= CELLS, "an area has cells for a vector");
        edges::each::<8>(xs, ys, origin, stride as i32, |edges| add8(cells, edges));
    }

    /// The same source as everywhere, with eight lanes.
    #[target_feature(enable = "avx2")]
    pub fn add_wave(places: &mut [f32], cosines: &[f32], sines: &[f32], parts: (f32, f32)) {
        edges::add_wave(places, cosines, sines, parts);
    }

    /// As [`edges::add`], four cells at once.
    #[inline]
    #[target_feature(enable = "avx2")]
    fn add8(cells: &mut [i32], edges: &Edges<8>) {
        // Promised: every cell is within the area. Should it not be, the last ones take its place.
        let last = _mm256_set1_epi32((cells.len() - CELLS) as i32);
        for (first, parts) in [(&edges.upper_first, &edges.upper), (&edges.lower_first, &edges.lower)] {
            // SAFETY: these are arrays of eight numbers of 32 bits, and the loads and stores are unaligned ones.
            let (first, a, b, c) = unsafe {
                let load = |of: *const i32| _mm256_loadu_si256(of.cast());
                (
                    load(first.as_ptr().cast()),
                    load(parts[0].as_ptr()),
                    load(parts[1].as_ptr()),
                    load(parts[2].as_ptr()),
                )
            };
            let mut places = [0u32; 8];
            // SAFETY: as above.
            unsafe { _mm256_storeu_si256(places.as_mut_ptr().cast(), _mm256_min_epu32(first, last)) };
            let zero = _mm256_setzero_si256();
            let (ab, c0) = (_mm256_unpacklo_epi32(a, b), _mm256_unpacklo_epi32(c, zero));
            let (cd, c1) = (_mm256_unpackhi_epi32(a, b), _mm256_unpackhi_epi32(c, zero));
            let lanes = [
                _mm256_unpacklo_epi64(ab, c0),
                _mm256_unpackhi_epi64(ab, c0),
                _mm256_unpacklo_epi64(cd, c1),
                _mm256_unpackhi_epi64(cd, c1),
            ];
            for (lane, four) in lanes.into_iter().enumerate() {
                let halves = [_mm256_castsi256_si128(four), _mm256_extracti128_si256::<1>(four)];
                for (half, added) in halves.into_iter().enumerate() {
                    let place = places[lane + 4 * half] as usize;
                    // SAFETY: place + CELLS is at most the number of cells.
                    unsafe {
                        let cell = cells.as_mut_ptr().add(place).cast::<__m128i>();
                        _mm_storeu_si128(cell, _mm_add_epi32(_mm_loadu_si128(cell), added));
                    }
                }
            }
        }
    }

    /// Whether the machine has what [`avx512`] uses.
    pub fn has_avx512() -> bool {
        std::arch::is_x86_feature_detected!("avx512bw") && std::arch::is_x86_feature_detected!("avx512vl")
    }

    /// Same bits as [`super::portable`]. Only handed out by [`super::best`] where [`has_avx512`].
    pub fn avx512(span: Span<'_>, picture: &mut [u8], mask: &mut [u32]) {
        let Some((keys, gain)) = span.noise else { return avx2(span, picture, mask) };
        let blocks = span.base.len() / BLOCK;
        assert!(picture.len() >= blocks * BLOCK && mask.len() >= blocks, "a span's slices have one length");
        // SAFETY: the machine has AVX-512 BW and VL; the lengths that the pointers rely on are asserted.
        unsafe { noisy512(span, keys, gain, picture, mask, blocks) }
    }

    /// As `noisy`, a block at a time.
    ///
    /// # Safety
    /// `span.base` and `picture` hold `blocks` blocks, `mask` that many words.
    #[target_feature(enable = "avx512f,avx512bw,avx512vl,avx2")]
    unsafe fn noisy512(
        span: Span<'_>,
        keys: Keys,
        gain: i16,
        picture: &mut [u8],
        mask: &mut [u32],
        blocks: usize,
    ) {
        let narrow = tables(gain);
        let wide = |half: __m256i| _mm512_broadcast_i64x4(half);
        let (a, b, low) = (wide(narrow.a), wide(narrow.b), wide(narrow.low));
        let (weights, rounds) = (
            (wide(narrow.weights.0), wide(narrow.weights.1)),
            (wide(narrow.rounds.0), wide(narrow.rounds.1)),
        );
        let (gain, half) = (wide(narrow.gain), _mm512_set1_epi16(32));
        let second = _mm512_set1_epi32(keys.1 as i32);
        let level = _mm256_set1_epi8(span.level as i8);
        let lanes = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
        let mut word =
            _mm512_add_epi32(_mm512_set1_epi32(span.first_word.wrapping_add(keys.0) as i32), lanes);
        for (block, bits) in mask.iter_mut().enumerate().take(blocks) {
            let mut h = _mm512_xor_si512(word, _mm512_srli_epi32::<16>(word));
            h = _mm512_mullo_epi32(h, rounds.0);
            h = _mm512_xor_si512(h, second);
            h = _mm512_xor_si512(h, _mm512_srli_epi32::<15>(h));
            h = _mm512_mullo_epi32(h, rounds.1);
            h = _mm512_xor_si512(h, _mm512_srli_epi32::<16>(h));
            let even = _mm512_and_si512(h, low);
            let odd = _mm512_and_si512(_mm512_srli_epi16::<4>(h), low);
            let deviate = _mm512_add_epi16(
                _mm512_maddubs_epi16(weights.0, _mm512_shuffle_epi8(a, even)),
                _mm512_maddubs_epi16(weights.1, _mm512_shuffle_epi8(b, odd)),
            );
            let noise = _mm512_mulhrs_epi16(deviate, gain);
            word = _mm512_add_epi32(word, _mm512_set1_epi32(16));
            // SAFETY: block < blocks, as the caller promised; the loads and stores are unaligned ones.
            unsafe {
                let base = _mm512_loadu_si512(span.base.as_ptr().add(block * BLOCK).cast());
                let sum = _mm512_adds_epi16(_mm512_adds_epi16(base, noise), half);
                let grey = _mm512_max_epi16(_mm512_srai_epi16::<6>(sum), _mm512_setzero_si512());
                let pixels = _mm512_cvtusepi16_epi8(grey);
                _mm256_storeu_si256(picture.as_mut_ptr().add(block * BLOCK).cast(), pixels);
                *bits = _mm256_cmpge_epu8_mask(pixels, level);
            }
        }
    }

    /// 16 deviates from the words `word..word + 8`, scaled.
    #[inline]
    #[target_feature(enable = "avx2")]
    fn noise16(word: __m256i, second: __m256i, tables: &Tables) -> __m256i {
        let mut h = _mm256_xor_si256(word, _mm256_srli_epi32::<16>(word));
        h = _mm256_mullo_epi32(h, tables.rounds.0);
        h = _mm256_xor_si256(h, second);
        h = _mm256_xor_si256(h, _mm256_srli_epi32::<15>(h));
        h = _mm256_mullo_epi32(h, tables.rounds.1);
        h = _mm256_xor_si256(h, _mm256_srli_epi32::<16>(h));
        // Bytes of `even` hold the nibbles 0 and 2 of each pixel's 16 bits, those of `odd` the nibbles 1 and 3.
        let even = _mm256_and_si256(h, tables.low);
        let odd = _mm256_and_si256(_mm256_srli_epi16::<4>(h), tables.low);
        let a = _mm256_maddubs_epi16(tables.weights.0, _mm256_shuffle_epi8(tables.a, even));
        let b = _mm256_maddubs_epi16(tables.weights.1, _mm256_shuffle_epi8(tables.b, odd));
        _mm256_mulhrs_epi16(_mm256_add_epi16(a, b), tables.gain)
    }

    struct Tables {
        a: __m256i,
        b: __m256i,
        low: __m256i,
        weights: (__m256i, __m256i),
        rounds: (__m256i, __m256i),
        gain: __m256i,
    }

    #[target_feature(enable = "avx2")]
    fn tables(gain: i16) -> Tables {
        let wide = |table: [i8; 16]| {
            let [low, high]: [i64; 2] =
                [0, 8].map(|at| i64::from_le_bytes(core::array::from_fn(|i| table[at + i] as u8)));
            _mm256_set_epi64x(high, low, high, low)
        };
        let pair = |first: i8, second: i8| _mm256_set1_epi16(i16::from_le_bytes([first as u8, second as u8]));
        Tables {
            a: wide(TABLE_A),
            b: wide(TABLE_B),
            low: _mm256_set1_epi8(15),
            weights: (pair(WEIGHTS[0], WEIGHTS[2]), pair(WEIGHTS[1], WEIGHTS[3])),
            rounds: (_mm256_set1_epi32(ROUNDS.0 as i32), _mm256_set1_epi32(ROUNDS.1 as i32)),
            gain: _mm256_set1_epi16(gain),
        }
    }

    /// # Safety
    /// `span.base` and `picture` hold `blocks` blocks, `mask` that many words.
    #[target_feature(enable = "avx2")]
    unsafe fn noisy(
        span: Span<'_>,
        keys: Keys,
        gain: i16,
        picture: &mut [u8],
        mask: &mut [u32],
        blocks: usize,
    ) {
        let tables = tables(gain);
        let second = _mm256_set1_epi32(keys.1 as i32);
        let half = _mm256_set1_epi16(32);
        let level = _mm256_set1_epi8(span.level as i8);
        let lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
        let first = span.first_word.wrapping_add(keys.0);
        let mut word = _mm256_add_epi32(_mm256_set1_epi32(first as i32), lanes);
        let eight = _mm256_set1_epi32(8);
        for (block, bits) in mask.iter_mut().enumerate().take(blocks) {
            let next = _mm256_add_epi32(word, eight);
            let (noise_a, noise_b) = (noise16(word, second, &tables), noise16(next, second, &tables));
            word = _mm256_add_epi32(next, eight);
            // SAFETY: block < blocks, see above; the loads and stores are unaligned ones.
            unsafe {
                let base = span.base.as_ptr().add(block * BLOCK).cast::<__m256i>();
                let sum_a = _mm256_adds_epi16(_mm256_loadu_si256(base), noise_a);
                let sum_b = _mm256_adds_epi16(_mm256_loadu_si256(base.add(1)), noise_b);
                let out = picture.as_mut_ptr().add(block * BLOCK).cast::<__m256i>();
                *bits = rounded(sum_a, sum_b, half, level, out);
            }
        }
    }

    /// # Safety
    /// As for `noisy`.
    #[target_feature(enable = "avx2")]
    unsafe fn clean(span: Span<'_>, picture: &mut [u8], mask: &mut [u32], blocks: usize) {
        let half = _mm256_set1_epi16(32);
        let level = _mm256_set1_epi8(span.level as i8);
        for (block, bits) in mask.iter_mut().enumerate().take(blocks) {
            // SAFETY: block < blocks, see above; the loads and stores are unaligned ones.
            unsafe {
                let base = span.base.as_ptr().add(block * BLOCK).cast::<__m256i>();
                let (a, b) = (_mm256_loadu_si256(base), _mm256_loadu_si256(base.add(1)));
                let out = picture.as_mut_ptr().add(block * BLOCK).cast::<__m256i>();
                *bits = rounded(a, b, half, level, out);
            }
        }
    }

    /// Rounds, packs and stores 32 pixels; answers their mask.
    ///
    /// # Safety
    /// 32 bytes can be written at `out`.
    #[inline]
    #[target_feature(enable = "avx2")]
    unsafe fn rounded(a: __m256i, b: __m256i, half: __m256i, level: __m256i, out: *mut __m256i) -> u32 {
        let a = _mm256_srai_epi16::<6>(_mm256_adds_epi16(a, half));
        let b = _mm256_srai_epi16::<6>(_mm256_adds_epi16(b, half));
        // Packing works on halves of the register; put them into the order of the pixels again.
        let pixels = _mm256_permute4x64_epi64::<0b11_01_10_00>(_mm256_packus_epi16(a, b));
        // SAFETY: as the caller promised.
        unsafe { _mm256_storeu_si256(out, pixels) };
        _mm256_movemask_epi8(_mm256_cmpeq_epi8(_mm256_max_epu8(pixels, level), pixels)) as u32
    }
}
