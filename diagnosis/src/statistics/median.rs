//! The median.

/// The middle of these by size, of an even count the upper one of both; `None` where there are none.
pub fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut sorted: Vec<f64> = values.into_iter().collect();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied()
}

/// The usual distance of neighbouring rows, in the unit of their times: the median; `None` below two rows.
pub fn usual_step(time: &[f64]) -> Option<f64> {
    median(time.windows(2).map(|pair| pair[1] - pair[0]))
}

#[cfg(test)]
mod tests {
    use super::{median, usual_step};

    #[test]
    fn value_the_middle_of_few_numbers() {
        assert_eq!((median([]), median([3.0]), median([2.0, 1.0])), (None, Some(3.0), Some(2.0)));
        assert_eq!(median([5.0, -1.0, 2.0]), Some(2.0));
        // one gap among rows is not what is usual
        assert_eq!((usual_step(&[1.0]), usual_step(&[0.0, 1.0, 2.0, 9.0])), (None, Some(1.0)));
    }
}
