//! How calls and answers lie in shared memory: numbers of eight bytes, slices with their padding to eight.

/// What a slice of a message may hold: any bytes are a value.
///
/// # Safety
/// Only for types without padding, of which every pattern of bits is a value.
pub(super) unsafe trait Plain: Copy {}
// SAFETY: numbers.
unsafe impl Plain for u8 {}
// SAFETY: as above.
unsafe impl Plain for u32 {}
// SAFETY: as above.
unsafe impl Plain for i32 {}
// SAFETY: as above.
unsafe impl Plain for f64 {}

/// Writes a message. What does not fit is left out, and told at the end.
pub(super) struct Writer<'a> {
    bytes: &'a mut [u8],
    at: usize,
    fits: bool,
}

impl<'a> Writer<'a> {
    /// Goes on at a place.
    pub(super) fn at(bytes: &'a mut [u8], at: usize) -> Self {
        Self { bytes, at, fits: true }
    }

    pub(super) fn number(&mut self, number: u64) {
        self.raw(&number.to_ne_bytes());
    }

    pub(super) fn real(&mut self, number: f64) {
        self.number(number.to_bits());
    }

    pub(super) fn slice<T: Plain>(&mut self, values: &[T]) {
        let length = size_of_val(values);
        // SAFETY: plain values have no padding, so that all of their bytes can be read.
        self.raw(unsafe { std::slice::from_raw_parts(values.as_ptr().cast::<u8>(), length) });
    }

    /// A slice with its length.
    pub(super) fn bytes(&mut self, bytes: &[u8]) {
        self.number(bytes.len() as u64);
        self.raw(bytes);
    }

    fn raw(&mut self, bytes: &[u8]) {
        let end = self.at + bytes.len().next_multiple_of(8);
        match self.bytes.get_mut(self.at..end) {
            Some(place) => {
                place[..bytes.len()].copy_from_slice(bytes);
                self.at = end;
            }
            None => self.fits = false,
        }
    }

    /// Where it ends; `None` where it did not fit.
    pub(super) fn end(self) -> Option<usize> {
        self.fits.then_some(self.at)
    }
}

/// Reads a message; `None` where there is no more. It trusts nobody: a unit may write anywhere in its process.
pub(super) struct Reader<'a> {
    bytes: &'a [u8],
    pub(super) at: usize,
}

impl<'a> Reader<'a> {
    pub(super) fn at(bytes: &'a [u8], at: usize) -> Self {
        Self { bytes, at }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.at >= self.bytes.len()
    }

    pub(super) fn number(&mut self) -> Option<u64> {
        let bytes = self.raw(8)?;
        Some(u64::from_ne_bytes(bytes.try_into().ok()?))
    }

    pub(super) fn real(&mut self) -> Option<f64> {
        self.number().map(f64::from_bits)
    }

    pub(super) fn count(&mut self) -> Option<usize> {
        usize::try_from(self.number()?).ok()
    }

    /// Reads as many values as `into` has.
    pub(super) fn slice<T: Plain>(&mut self, into: &mut [T]) -> Option<()> {
        let length = size_of_val(into);
        let bytes = self.raw(length)?;
        // SAFETY: both have this length, and any bytes are plain values.
        unsafe { std::ptr::copy_nonoverlapping(bytes.as_ptr(), into.as_mut_ptr().cast::<u8>(), length) };
        Some(())
    }

    /// Reads a number of values.
    pub(super) fn values<T: Plain + Default>(&mut self, count: usize) -> Option<Vec<T>> {
        // Not more than there is, however many are said to come.
        if count.checked_mul(size_of::<T>())? > self.bytes.len() {
            return None;
        }
        let mut values = vec![T::default(); count];
        self.slice(&mut values)?;
        Some(values)
    }

    pub(super) fn bytes(&mut self) -> Option<&'a [u8]> {
        let length = self.count()?;
        self.raw(length)
    }

    fn raw(&mut self, length: usize) -> Option<&'a [u8]> {
        let bytes = self.bytes.get(self.at..self.at.checked_add(length)?)?;
        self.at += length.next_multiple_of(8);
        Some(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::{Reader, Writer};

    #[test]
    fn value_what_was_written_is_read_and_no_more() {
        let mut bytes = [0; 64];
        let mut writer = Writer::at(&mut bytes, 8);
        writer.number(7);
        writer.bytes(b"abc");
        writer.slice(&[1.5, -2.5]);
        assert_eq!(writer.end(), Some(48), "padded to eight");
        let mut reader = Reader::at(&bytes[..48], 8);
        assert_eq!((reader.number(), reader.bytes()), (Some(7), Some(&b"abc"[..])));
        assert!(!reader.is_empty());
        assert_eq!(reader.values::<f64>(2), Some(vec![1.5, -2.5]));
        assert!(reader.is_empty(), "at the end");
        assert_eq!(reader.number(), None);
    }

    #[test]
    fn law_a_message_that_does_not_fit_or_lies_is_told() {
        let mut bytes = [0; 16];
        let mut writer = Writer::at(&mut bytes, 0);
        writer.number(u64::MAX);
        writer.number(1);
        assert_eq!(writer.end(), Some(16), "just");
        let mut writer = Writer::at(&mut bytes, 16);
        writer.number(1);
        assert_eq!(writer.end(), None);
        // A length of all that a number holds, and one more value than there is.
        assert!(Reader::at(&bytes, 0).bytes().is_none());
        assert_eq!(Reader::at(&bytes, 0).values::<u8>(17), None);
        assert_eq!(Reader::at(&bytes, 0).values::<f64>(usize::MAX), None);
        assert_eq!(Reader::at(&bytes, 0).values::<u8>(16).map(|all| all.len()), Some(16), "all of it");
    }
}
