//! The results of a run, which takes its folder over when all units have begun: one that is refused leaves what an earlier
//! run wrote there.

use crate::complain;
use crate::error::Error;
use crate::folder::Folder;
use crate::run_report::{Dated, clear_pictures, dated_pictures};
use orchestrator::{Checkpoint, Column, CsvRecorder, Position, Recorder, Row, Waiting};
use std::fs::{File, TryLockError};

/// Records to `results.csv`.
pub struct Results<'a> {
    folder: &'a Folder,
    /// Of an earlier run, without those that are gone on with.
    files: Vec<&'static str>,
    /// Likewise. Units write pictures from their initialisation on, before the folder is taken over.
    pictures: Dated,
    resolved: &'a str,
    /// How far the rows of a checkpoint reach.
    from: Option<Position>,
    csv: Option<CsvRecorder<File>>,
    /// Held as long as the folder is this run's.
    lock: Option<File>,
    failed: Option<Error>,
    /// What is told when rows of a checkpoint are gone on with.
    told: Option<String>,
}

/// The file of rows.
const ROWS: &str = "results.csv";

impl<'a> Results<'a> {
    /// New ones, in place of these files and of the pictures that are there now.
    ///
    /// # Errors
    /// The folder of pictures can't be read.
    pub fn new(folder: &'a Folder, files: &[&'static str], resolved: &'a str) -> Result<Self, Error> {
        let pictures = dated_pictures(&folder.file("frames"))?;
        Ok(Self {
            folder,
            files: files.to_vec(),
            pictures,
            resolved,
            from: None,
            csv: None,
            lock: None,
            failed: None,
            told: None,
        })
    }

    /// Those that a checkpoint left; these files give way but for the rows.
    ///
    /// # Errors
    /// As [`Results::new`].
    pub fn resumed(
        folder: &'a Folder,
        files: &[&'static str],
        resolved: &'a str,
        from: &Checkpoint,
    ) -> Result<Self, Error> {
        let others: Vec<&str> = files.iter().copied().filter(|file| *file != ROWS).collect();
        Ok(Self { from: Some(from.position()), ..Self::new(folder, &others, resolved)? })
    }

    /// Has this told when the run goes on; before that the checkpoint may turn out to be another run's.
    pub fn told(self, told: Option<String>) -> Self {
        Self { told, ..self }
    }

    /// Whether the folder is theirs.
    pub fn begun(&self) -> bool {
        self.csv.is_some()
    }

    /// Why the folder could not be taken over, if that was tried.
    pub fn failed(&mut self) -> Option<Error> {
        self.failed.take()
    }

    /// The folder, for one run at a time. Where a system locks no folders, nothing is looked at.
    fn lock(&self) -> Result<Option<File>, Error> {
        let path = self.folder.path().to_owned();
        let Ok(folder) = File::open(&path) else { return Ok(None) };
        match folder.try_lock() {
            Err(TryLockError::WouldBlock) => {
                let why = "another run is writing its results there; --out names another folder".to_owned();
                Err(Error::File { path, why })
            }
            _ => Ok(Some(folder)),
        }
    }

    /// Nothing is changed before it is known that the rows can be written.
    fn take_over(&mut self) -> Result<CsvRecorder<File>, Error> {
        self.lock = self.lock()?;
        let rows = self.folder.file(ROWS);
        let resumed = self.from.map(|position| CsvRecorder::resume(&rows, position)).transpose()?;
        self.folder.clear(&self.files)?;
        if resumed.is_none() {
            clear_pictures(&self.pictures)?;
        }
        self.folder.write("resolved.toml", self.resolved)?;
        Ok(resumed.map_or_else(|| CsvRecorder::create(rows), Ok)?)
    }

    /// The folder's rows from now on, or why not, for whom the recorder works.
    fn taken_over(&mut self) -> Result<&mut CsvRecorder<File>, orchestrator::Error> {
        match self.take_over() {
            Ok(csv) => Ok(self.csv.insert(csv)),
            Err(Error::Orchestrator(error)) => Err(error),
            Err(error) => {
                let source = std::io::Error::other(error.to_string());
                self.failed = Some(error);
                Err(orchestrator::Error::Record { target: None, source })
            }
        }
    }
}

impl Recorder for Results<'_> {
    fn begin(&mut self, columns: &[Column]) -> Result<(), orchestrator::Error> {
        self.taken_over()?.begin(columns)
    }

    fn go_on(&mut self) -> Result<(), orchestrator::Error> {
        self.taken_over()?;
        if let Some(told) = &self.told {
            complain!("{told}");
        }
        Ok(())
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
