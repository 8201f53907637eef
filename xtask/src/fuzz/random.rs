//! Random numbers that a seed and a number repeat (splitmix64, Steele, Lea and Flood 2014).

/// A stream.
pub struct Random(u64);

impl Random {
    /// The stream of this seed and number.
    pub fn new(seed: u64, number: u64) -> Self {
        let mut start = Self(seed);
        start.0 = start.next() ^ number.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        start
    }

    /// 64 random bits.
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// 0 to `end` - 1.
    pub fn below(&mut self, end: usize) -> usize {
        (self.next() % end.max(1) as u64) as usize
    }

    /// True in so many per cent of cases.
    pub fn per_cent(&mut self, share: usize) -> bool {
        self.below(100) < share
    }

    /// 0 to 1.
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// One of several.
    pub fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())]
    }
}
