//! The results of a run, which takes its folder over when all units have begun: one that is refused leaves what an earlier
//! run wrote there.

use crate::error::Error;
use crate::folder::Folder;
use crate::run_report::clear_pictures;
use orchestrator::{Checkpoint, Column, CsvRecorder, Position, Recorder, Row, Waiting};
use std::fs::File;

/// Records to `results.csv`.
pub struct Results<'a> {
    folder: &'a Folder,
    /// Of an earlier run.
    files: Vec<&'static str>,
    resolved: &'a str,
    csv: Option<CsvRecorder<File>>,
    failed: Option<Error>,
}

impl<'a> Results<'a> {
    /// New ones, in place of these files.
    pub fn new(folder: &'a Folder, files: &[&'static str], resolved: &'a str) -> Self {
        Self { folder, files: files.to_vec(), resolved, csv: None, failed: None }
    }

    /// Those that a checkpoint left in the first of these files; the others give way.
    pub fn resumed(
        folder: &'a Folder,
        files: &[&'static str],
        resolved: &'a str,
        from: &Checkpoint,
    ) -> Result<Self, Error> {
        folder.clear(&files[1..])?;
        folder.write("resolved.toml", resolved)?;
        let csv = CsvRecorder::resume(folder.file(files[0]), from.position())?;
        Ok(Self { csv: Some(csv), ..Self::new(folder, files, resolved) })
    }

    /// Whether the folder is theirs.
    pub fn begun(&self) -> bool {
        self.csv.is_some()
    }

    /// Why the folder could not be taken over, if that was tried.
    pub fn failed(&mut self) -> Option<Error> {
        self.failed.take()
    }

    fn take_over(&self) -> Result<CsvRecorder<File>, Error> {
        self.folder.clear(&self.files)?;
        clear_pictures(&self.folder.file("frames"))?;
        self.folder.write("resolved.toml", self.resolved)?;
        Ok(CsvRecorder::create(self.folder.file("results.csv"))?)
    }
}

impl Recorder for Results<'_> {
    fn begin(&mut self, columns: &[Column]) -> Result<(), orchestrator::Error> {
        match self.take_over() {
            Ok(csv) => self.csv.insert(csv).begin(columns),
            Err(Error::Orchestrator(error)) => Err(error),
            Err(error) => {
                let source = std::io::Error::other(error.to_string());
                self.failed = Some(error);
                Err(orchestrator::Error::Record { target: None, source })
            }
        }
    }

    fn row(&mut self, time: f64, row: Row<'_>) -> Result<(), orchestrator::Error> {
        self.csv.as_mut().map_or(Ok(()), |csv| csv.row(time, row))
    }

    fn position(&mut self) -> Result<Position, orchestrator::Error> {
        self.csv.as_mut().map_or(Ok(Position::default()), Recorder::position)
    }

    fn rescue(&self) -> Option<Waiting> {
        self.csv.as_ref().and_then(Recorder::rescue)
    }

    fn end(&mut self) -> Result<(), orchestrator::Error> {
        self.csv.as_mut().map_or(Ok(()), Recorder::end)
    }
}
