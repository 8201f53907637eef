//! The files of a folder in the order in which a person would number them.

use crate::error::{Error, file};
use std::path::{Path, PathBuf};

/// Endings of the files that are frames.
pub const ENDINGS: [&str; 5] = ["png", "tif", "tiff", "jpg", "jpeg"];

/// A frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// The file.
    pub path: PathBuf,
    /// Its name without the folder.
    pub name: String,
    /// The last number in its name, or its place: it says which field an interlaced frame is.
    pub number: i64,
    /// Its place among the frames, from 1.
    pub place: usize,
    /// The number stands in the name.
    pub numbered: bool,
}

/// The frames of a folder.
pub fn list(folder: &Path, notices: &mut Vec<String>) -> Result<Vec<Frame>, Error> {
    let mut names = Vec::new();
    let mut others = 0;
    for entry in std::fs::read_dir(folder).map_err(file(folder))? {
        let path = entry.map_err(file(folder))?.path();
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if ENDINGS.contains(&ending.as_str()) && !name.starts_with('.') && path.is_file() {
            names.push((name, path));
        } else {
            others += 1;
        }
    }
    if names.is_empty() {
        return Err(Error::Empty { path: folder.to_owned() });
    }
    if others > 0 {
        notices.push(format!("{}: {others} entries that are no images are left out", folder.display()));
    }
    let (with, without): (Vec<_>, Vec<_>) =
        names.iter().cloned().partition(|(name, _)| last_number(name).is_some());
    // A still of the scene among numbered frames is none of them; where few have numbers, these count nothing.
    if with.len() > without.len()
        && let Some((first, _)) = without.iter().min()
    {
        notices.push(format!(
            "{}: {} images without a number that counts frames are left out, {first} among them",
            folder.display(),
            without.len()
        ));
        names = with;
    }
    names.sort_by_cached_key(|(name, _)| order(name));
    let numbered = names.iter().all(|(name, _)| last_number(name).is_some());
    let frame = |(place, (name, path)): (usize, (String, PathBuf))| {
        let number = last_number(&name).filter(|_| numbered).unwrap_or(place as i64);
        Frame { path, number, name, place: place + 1, numbered }
    };
    Ok(names.into_iter().enumerate().map(frame).collect())
}

/// Text and numbers of a name in turn: frame_10 comes after frame_9.
fn order(name: &str) -> Vec<(String, u128, String)> {
    let mut parts = Vec::new();
    let mut rest = name;
    while !rest.is_empty() {
        let digits = rest.find(|c: char| c.is_ascii_digit()).unwrap_or(rest.len());
        let (text, tail) = rest.split_at(digits);
        let end = tail.find(|c: char| !c.is_ascii_digit()).unwrap_or(tail.len());
        let (number, tail) = tail.split_at(end);
        parts.push((text.to_owned(), number.parse().unwrap_or(0), number.to_owned()));
        rest = tail;
    }
    parts
}

/// The last number in a name before its ending.
fn last_number(name: &str) -> Option<i64> {
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    let end = stem.rfind(|c: char| c.is_ascii_digit())? + 1;
    let start = stem[..end]
        .rfind(|c: char| !c.is_ascii_digit())
        .map_or(0, |before| before + stem[before..].chars().next().map_or(1, char::len_utf8));
    stem[start..end].parse().ok()
}

#[cfg(test)]
mod tests {
    use super::{last_number, list, order};

    #[test]
    fn law_frames_follow_their_numbers_not_their_letters() {
        let mut names = ["f10.png", "f9.png", "f1.png", "f2b3.png", "f2b12.png"];
        names.sort_by_cached_key(|name| order(name));
        assert_eq!(names, ["f1.png", "f2b3.png", "f2b12.png", "f9.png", "f10.png"]);
    }

    #[test]
    fn law_the_number_of_a_frame_is_the_last_before_the_ending() {
        assert_eq!(last_number("run2_frame_000042.png"), Some(42));
        assert_eq!(last_number("bild-äß7x.jp2"), Some(7));
        assert_eq!(last_number("still.mp4"), None);
        assert_eq!(last_number("99999999999999999999.png"), None, "more digits than can be counted");
    }

    #[test]
    fn bad_data_an_image_without_a_number_counts_no_frame() {
        let folder = tempfile::tempdir().expect("a folder");
        let made = |name: &str| std::fs::write(folder.path().join(name), "").expect("writable");
        ["f0.png", "f1.png", "f2.png", "f4.png"].into_iter().for_each(made);
        let numbers = |notices: &mut Vec<String>| -> Vec<i64> {
            list(folder.path(), notices).expect("frames").iter().map(|frame| frame.number).collect()
        };
        let mut notices = Vec::new();
        assert_eq!((numbers(&mut notices), notices.len()), (vec![0, 1, 2, 4], 0));
        ["zz.png", "background.png"].into_iter().for_each(made);
        assert_eq!(numbers(&mut notices), [0, 1, 2, 4]);
        assert!(
            notices[0].contains("2 images without a number") && notices[0].contains("background.png"),
            "{notices:?}"
        );
        // Where most have none, frames go by their places.
        ["a.png", "b.png", "c.png"].into_iter().for_each(made);
        assert_eq!(numbers(&mut notices), (0..9).collect::<Vec<i64>>());
    }
}
