//! "Did you mean …": the known names nearest to one that isn't.

/// Text to put after an error: the nearest names, or all of them where they are few.
pub fn nearest<'a>(wrong: &str, known: impl Iterator<Item = &'a str>) -> String {
    let known: Vec<&str> = known.collect();
    let limit = (wrong.chars().count() / 3).max(2);
    // Of names equally near, those that begin alike come first.
    let alike = |name: &str| wrong.chars().zip(name.chars()).take_while(|(a, b)| a == b).count();
    let mut ranked: Vec<(usize, std::cmp::Reverse<usize>, &str)> = known
        .iter()
        .map(|name| {
            let distance = distance(&wrong.to_lowercase(), &name.to_lowercase());
            (distance, std::cmp::Reverse(alike(name)), *name)
        })
        .filter(|(distance, ..)| *distance <= limit)
        .collect();
    ranked.sort();
    if let Some(((.., first), others)) = ranked.split_first() {
        let others: Vec<&str> = others.iter().take(2).map(|(.., name)| *name).collect();
        return match others.is_empty() {
            true => format!("did you mean {first}?"),
            false => format!("did you mean {first} (or {})?", others.join(", ")),
        };
    }
    match known.len() {
        0 => "there are none".into(),
        1..=12 => format!("known: {}", known.join(", ")),
        count => format!("known: {} and {} more", known[..8].join(", "), count - 8),
    }
}

/// Edits (insert, delete, replace, swap neighbours) from one word to the other.
fn distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut before: Vec<usize> = Vec::new();
    let mut above: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let replaced = above[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut best = replaced.min(above[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(before[j - 2] + 1);
            }
            row.push(best);
        }
        before = std::mem::replace(&mut above, row);
    }
    above[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_edits_between_words() {
        for (a, b, edits) in [
            ("", "abc", 3),
            ("abc", "abc", 0),
            ("ab", "ba", 1),
            ("abcdef", "abdcef", 1),
            ("abcdef", "bacdfe", 2),
            ("kitten", "sitting", 3),
            // No edit within a pair that was swapped.
            ("ca", "abc", 3),
        ] {
            assert_eq!((distance(a, b), distance(b, a)), (edits, edits), "{a} {b}");
        }
    }

    #[test]
    fn value_nearest_name_comes_first() {
        let known = ["theta_1", "theta_2", "q1_0", "b_joint"];
        assert_eq!(nearest("theta1", known.into_iter()), "did you mean theta_1 (or theta_2)?");
        assert_eq!(nearest("b_jiont", known.into_iter()), "did you mean b_joint?");
        assert_eq!(nearest("wholly_else", known.into_iter()), "known: theta_1, theta_2, q1_0, b_joint");
    }
}
