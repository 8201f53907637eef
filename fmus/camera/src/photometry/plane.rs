//! Frames in memory: rows padded to whole blocks of pixels, so that every kernel works on whole blocks.

/// Pixels that the kernels handle at once; rows are padded to a multiple.
pub const BLOCK: usize = 32;

/// Values of a frame's pixels, row by row from the upper left.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Plane<T> {
    /// Rows, each of `stride` values.
    pub values: Vec<T>,
    /// Values from one row to the next.
    pub stride: usize,
    /// Columns that are seen.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

impl<T: Copy> Plane<T> {
    /// A frame in which every pixel has the value `fill`, and every pixel of the padding `padding`.
    pub fn filled(width: usize, height: usize, fill: T, padding: T) -> Self {
        let stride = width.div_ceil(BLOCK) * BLOCK;
        let mut values = vec![fill; stride * height];
        for row in values.chunks_exact_mut(stride) {
            row[width..].fill(padding);
        }
        Self { values, stride, width, height }
    }

    /// A row without its padding.
    pub fn row(&self, y: usize) -> &[T] {
        &self.values[y * self.stride..y * self.stride + self.width]
    }

    /// A row without its padding, to be changed.
    pub fn row_mut(&mut self, y: usize) -> &mut [T] {
        &mut self.values[y * self.stride..y * self.stride + self.width]
    }
}

/// One bit a pixel: at or above the threshold. Bit i of a word is the pixel i to the right of the word's first.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mask {
    /// Rows, each of `stride` words of [`BLOCK`] pixels.
    pub words: Vec<u32>,
    /// Words from one row to the next.
    pub stride: usize,
}

impl Mask {
    /// Nothing set, for a frame of this size.
    pub fn empty(width: usize, height: usize) -> Self {
        let stride = width.div_ceil(BLOCK);
        Self { words: vec![0; stride * height], stride }
    }

    /// The words of a row.
    pub fn row(&self, y: usize) -> &[u32] {
        &self.words[y * self.stride..(y + 1) * self.stride]
    }
}
