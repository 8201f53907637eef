//! What is counted over the cases of a part, so that it is known without reading them.

/// Cases of a part, or of several.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Counts {
    /// Cases that failed.
    pub(crate) failed: u64,
    /// Cases that did not, with a value that is not finite in a signal that a scalar reads.
    pub(crate) not_finite: u64,
    /// The first of these.
    pub(crate) example: Option<u64>,
}

impl Counts {
    /// Of all parts, in any order.
    pub(crate) fn sum(parts: impl Iterator<Item = Self>) -> Self {
        parts.fold(Self::default(), |one, other| Self {
            failed: one.failed + other.failed,
            not_finite: one.not_finite + other.not_finite,
            example: one.example.into_iter().chain(other.example).min(),
        })
    }

    /// A case that did not fail has such a value.
    pub(crate) fn add_not_finite(&mut self, case: u64) {
        self.not_finite += 1;
        self.example.get_or_insert(case);
    }

    /// As it stands in a file: how many, the first one.
    pub(crate) fn not_finite_text(&self) -> Option<String> {
        self.example.map(|example| format!("{} {example}", self.not_finite))
    }

    /// Reads it back; files without it have no such case.
    pub(crate) fn read(failed: &str, not_finite: Option<&str>) -> Option<Self> {
        let failed = failed.parse().ok()?;
        let Some((count, example)) = not_finite.and_then(|text| text.split_once(' ')) else {
            return Some(Self { failed, ..Self::default() });
        };
        Some(Self { failed, not_finite: count.parse().ok()?, example: Some(example.parse().ok()?) })
    }

    /// What a person is told of cases that look healthy and are not.
    pub(crate) fn words(&self) -> Option<String> {
        let example = self.example?;
        let cases = match self.not_finite {
            1 => format!("case {example} has"),
            more => format!("{more} cases (the first is {example}) have"),
        };
        Some(format!(
            "{cases} values that are not finite (NaN or inf) in a signal that a scalar reads; a scalar passes NaN over"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::Counts;

    #[test]
    fn law_counts_come_back_and_add_up() {
        let mut one = Counts { failed: 2, ..Counts::default() };
        assert_eq!((one.words(), one.not_finite_text()), (None, None));
        assert_eq!(Counts::read("2", None), Some(one));
        one.add_not_finite(17);
        assert!(one.words().is_some_and(|words| words.starts_with("case 17 has values")));
        one.add_not_finite(19);
        assert_eq!(Counts::read("2", one.not_finite_text().as_deref()), Some(one));
        let other = Counts { failed: 1, not_finite: 1, example: Some(3) };
        let all = Counts::sum([one, Counts::default(), other].into_iter());
        assert_eq!(all, Counts { failed: 3, not_finite: 3, example: Some(3) });
        assert!(all.words().is_some_and(|words| words.starts_with("3 cases (the first is 3) have")));
    }
}
