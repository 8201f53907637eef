//! A text as it goes to and from units: C's, with its zero at the end, and shared, so that a step that passes texts on
//! neither allocates nor converts as long as they don't change.

use std::ffi::{CStr, c_char, c_int};
use std::sync::Arc;

/// A text with one zero: its last byte.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Text(Arc<str>);

impl Text {
    /// Without the zero.
    #[inline]
    pub(crate) fn as_str(&self) -> &str {
        &self.0[..self.0.len() - 1]
    }

    /// For a unit to read.
    #[inline]
    pub(crate) fn as_ptr(&self) -> *const c_char {
        self.0.as_ptr().cast()
    }

    /// They are one and the same; two of the same letters need not be.
    #[inline]
    pub(crate) fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }

    /// Takes over what a unit answered; null is an empty text, bytes that are no UTF-8 are replaced.
    ///
    /// # Safety
    /// The pointer is null or to bytes that end in zero and stay as they are over the call.
    #[inline(always)]
    pub(crate) unsafe fn read(&mut self, pointer: *const c_char) {
        // SAFETY: not null, and both end in zero.
        if pointer.is_null() || unsafe { strcmp(pointer, self.as_ptr()) } != 0 {
            // SAFETY: as the caller promised.
            unsafe { self.renew(pointer) };
        }
    }

    /// # Safety
    /// As of [`Text::read`].
    #[cold]
    unsafe fn renew(&mut self, pointer: *const c_char) {
        if pointer.is_null() {
            *self = Self::default();
            return;
        }
        // SAFETY: not null, and as the caller of `read` promised.
        let answer = unsafe { CStr::from_ptr(pointer) };
        *self = match str::from_utf8(answer.to_bytes_with_nul()) {
            Ok(text) => Self(text.into()),
            Err(_) => Self::from(&*answer.to_string_lossy()),
        };
    }
}

unsafe extern "C" {
    /// The C library's: one pass, where `CStr` takes one for the length and one to compare.
    fn strcmp(one: *const c_char, other: *const c_char) -> c_int;
}

impl Default for Text {
    fn default() -> Self {
        Self("\0".into())
    }
}

/// Zeros inside a text are left out.
impl From<&str> for Text {
    fn from(text: &str) -> Self {
        let mut ended: String = text.split('\0').collect();
        ended.push('\0');
        Self(ended.into())
    }
}

#[cfg(test)]
mod tests {
    use super::Text;
    use std::ptr;

    #[test]
    fn value_texts_end_in_the_only_zero() {
        for (given, kept) in [("", ""), ("a", "a"), ("ä%s", "ä%s"), ("a\0b\0", "ab"), ("\0", "")] {
            let text = Text::from(given);
            assert_eq!(
                (text.as_str(), text.0.as_bytes().iter().filter(|&&byte| byte == 0).count()),
                (kept, 1)
            );
            assert!(text.clone().is(&text) && !Text::from(given).is(&text));
        }
    }

    #[test]
    fn value_what_a_unit_answers_is_taken_over() {
        let mut text = Text::default();
        // SAFETY: the bytes hold a zero.
        let again = |text: &mut Text, bytes: &[u8]| unsafe { text.read(bytes.as_ptr().cast()) };
        again(&mut text, b"abc\0");
        let before = text.clone();
        again(&mut text, b"abc\0");
        assert!(text.is(&before), "nothing new for what didn't change");
        for (bytes, read) in [(&b"abcd\0"[..], "abcd"), (b"ab\0c\0", "ab"), (b"a\xffb\0", "a\u{fffd}b")] {
            again(&mut text, bytes);
            assert_eq!(text.as_str(), read);
        }
        // SAFETY: null is allowed.
        unsafe { text.read(ptr::null()) };
        assert_eq!(text.as_str(), "");
    }
}
