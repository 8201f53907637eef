//! The parts of a data set: which there are, which are still to be made. A part is a stretch of cases in order; its file gets
//! its name when it is whole, so that making it twice, or at two places at once, does no harm.

use crate::data::{self, Counts, Marks};
use crate::error::Error;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Without a number of parts that somebody gave: so many cases a part, and so many parts at most. What an interruption can
/// lose is a part.
const CASES: u64 = 128;
const PARTS: u64 = 32;

/// The parts of a study in a folder.
pub(crate) struct Parts {
    folder: PathBuf,
    pub(crate) of: u64,
    cases: u64,
    /// A part has a file of signals beside that of its cases.
    signals: bool,
    /// Those that are whole: number, and what is counted over their cases.
    pub(crate) finished: Vec<(u64, Counts)>,
    /// Those that are to be made now.
    pub(crate) due: Vec<u64>,
    /// Files of another study that gave way.
    pub(crate) removed: usize,
    /// Parts whose cases are there without their signals.
    pub(crate) without_signals: Vec<u64>,
}

impl Parts {
    /// Looks into a folder. One part of so many, or all of them: then a data set of another study there gives way, while
    /// one of this study is completed, in as many parts as it has.
    pub(crate) fn look(
        folder: &Path,
        fingerprint: &str,
        cases: u64,
        partition: Option<(u64, u64)>,
        signals: bool,
    ) -> Result<Self, Error> {
        let found = found(&folder.join("cases"))?;
        let foreign = |path: &Path, what: String| Error::Foreign { path: path.into(), what };
        if let Some((path, _)) = found.iter().find(|(_, marks)| marks.is_none()) {
            return Err(foreign(path, "no study of ours".into()));
        }
        let found: Vec<(PathBuf, Marks)> =
            found.into_iter().filter_map(|(path, marks)| Some((path, marks?))).collect();
        let (ours, other): (Vec<_>, Vec<_>) =
            found.into_iter().partition(|(_, marks)| marks.fingerprint == fingerprint);
        let of = match partition {
            Some((part, of)) => {
                if part < 1 || part > of {
                    return Err(Error::Partition { part, of });
                }
                if let Some((path, _)) = other.first() {
                    return Err(foreign(path, "another study, scenario, unit or version".into()));
                }
                if let Some((path, marks)) = ours.iter().find(|(_, marks)| marks.of != of) {
                    return Err(foreign(path, format!("this study in {} parts, not {of}", marks.of)));
                }
                of
            }
            None => ours.first().map_or_else(|| cases.div_ceil(CASES).clamp(1, PARTS), |(_, marks)| marks.of),
        };
        let (ours, odd): (Vec<_>, Vec<_>) = ours.into_iter().partition(|(_, marks)| marks.of == of);
        let mut parts = Self {
            folder: folder.into(),
            of,
            cases,
            signals,
            finished: Vec::new(),
            due: Vec::new(),
            removed: 0,
            without_signals: Vec::new(),
        };
        for (path, _) in other.iter().chain(&odd) {
            parts.remove(path)?;
        }
        parts.take_over(ours.into_iter().map(|(_, marks)| marks).collect());
        let wanted = partition.map_or(1..=of, |(part, _)| part..=part);
        parts.due = wanted.filter(|part| !parts.is_finished(*part)).collect();
        Ok(parts)
    }

    /// What is told of cases without their signals: those that are made again now.
    pub(crate) fn words_of_lost(&self) -> Option<String> {
        let lost: Vec<u64> =
            self.without_signals.iter().copied().filter(|part| self.due.contains(part)).collect();
        let first = self.file("signals", *lost.first()?);
        let others = match lost.len() {
            1 => String::new(),
            more => format!(", nor those of {} other parts", more - 1),
        };
        Some(format!("{} is not there, or not of these cases{others}: made again", first.display()))
    }

    fn remove(&mut self, path: &Path) -> Result<(), Error> {
        let name = path.file_name().unwrap_or_default();
        for path in [path.to_owned(), self.folder.join("signals").join(name)] {
            match std::fs::remove_file(&path) {
                Err(why) if why.kind() != std::io::ErrorKind::NotFound => {
                    return Err(Error::file(&path)(why));
                }
                _ => {}
            }
        }
        self.removed += 1;
        Ok(())
    }

    /// Those that are whole need not be made again.
    fn take_over(&mut self, ours: Vec<Marks>) {
        let (whole, halves): (Vec<_>, Vec<_>) =
            ours.into_iter().partition(|marks| !self.signals || self.has_signals(marks));
        self.finished = whole.iter().map(|marks| (marks.part, marks.counts)).collect();
        self.finished.sort_unstable_by_key(|(part, _)| *part);
        self.without_signals = halves.iter().map(|marks| marks.part).collect();
    }

    /// Whether the signals of a part lie beside its cases: somebody may have taken them away, or put others there.
    fn has_signals(&self, cases: &Marks) -> bool {
        let path = self.file("signals", cases.part);
        path.is_file() && data::marks(&path).is_ok_and(|marks| marks.as_ref() == Some(cases))
    }

    fn is_finished(&self, part: u64) -> bool {
        self.finished.iter().any(|(known, _)| *known == part)
    }

    /// A part is whole now.
    pub(crate) fn finish(&mut self, part: u64, counts: Counts) {
        self.finished.push((part, counts));
    }

    /// Whether all parts are there: those of others, too, which may have come meanwhile.
    pub(crate) fn all_there(&self) -> bool {
        let there = |kind: &str, part: u64| self.file(kind, part).is_file();
        let whole = |part: u64| there("cases", part) && (!self.signals || there("signals", part));
        (1..=self.of).all(|part| self.is_finished(part) || whole(part))
    }

    /// The cases of a part.
    pub(crate) fn range(&self, part: u64) -> Range<u64> {
        let bound = |part: u64| (u128::from(self.cases) * u128::from(part) / u128::from(self.of)) as u64;
        bound(part - 1)..bound(part)
    }

    /// The file of a part. Names have as many digits as the last one, so that their order is that of the cases.
    pub(crate) fn file(&self, kind: &str, part: u64) -> PathBuf {
        let width = self.of.to_string().len();
        self.folder.join(kind).join(format!("part-{part:0width$}.parquet"))
    }

    /// Takes away what an end in the middle of a part left: files that nobody has locked. Others may be writing theirs.
    pub(crate) fn sweep_up(&self) {
        for kind in ["cases", "signals"] {
            let entries = std::fs::read_dir(self.folder.join(kind)).into_iter().flatten().flatten();
            for path in entries.map(|entry| entry.path()) {
                let name = path.file_name().unwrap_or_default().to_string_lossy();
                let is_left = || std::fs::File::open(&path).is_ok_and(|file| file.try_lock().is_ok());
                if name.starts_with(".part-") && name.ends_with(".tmp") && is_left() {
                    // What can't be taken away is in nobody's way.
                    let _ = std::fs::remove_file(&path);
                }
            }
        }
    }
}

/// The files of a folder that are parts by their names, and what they say of themselves.
fn found(folder: &Path) -> Result<Vec<(PathBuf, Option<Marks>)>, Error> {
    let entries = match std::fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(why) if why.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(why) => return Err(Error::file(folder)(why)),
    };
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.retain(|path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with("part-") && name.ends_with(".parquet")
    });
    paths.sort();
    paths.into_iter().map(|path| data::marks(&path).map(|marks| (path, marks))).collect()
}

#[cfg(test)]
mod tests {
    use super::Parts;

    #[test]
    fn law_files_that_somebody_writes_are_left_alone() {
        let folder = tempfile::tempdir().expect("a folder");
        let cases = folder.path().join("cases");
        std::fs::create_dir(&cases).expect("writable");
        let parts = Parts::look(folder.path(), "study", 10, None, false).expect("an empty folder");
        let held = crate::data::temporary(&parts.file("cases", 1)).expect("writable");
        std::fs::write(cases.join(".part-1-left.tmp"), "half").expect("writable");
        parts.sweep_up();
        assert!(held.path().is_file(), "somebody writes it");
        assert!(!cases.join(".part-1-left.tmp").exists(), "nobody does");
    }
}
