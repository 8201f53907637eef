//! Why recorded frames did not become a log. All of it can be mended by the user.

use std::path::PathBuf;

/// What is wrong and what would be right.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// There is no such scenario, or it can't be read.
    #[error(transparent)]
    Scenario(#[from] scenarios::Error),
    /// An override that the scenario does not know.
    #[error(transparent)]
    Orchestrator(#[from] orchestrator::Error),
    /// The scenario's camera can't be used.
    #[error("{scenario}: {what}; {expected}")]
    Camera {
        /// The scenario.
        scenario: String,
        /// What is wrong.
        what: String,
        /// What would be right.
        expected: String,
    },
    /// A folder without frames.
    #[error(
        "{}: no image; expected files that end in {}, one a frame", path.display(),
        crate::sequence::ENDINGS.map(|ending| format!(".{ending}")).join(", ")
    )]
    Empty {
        /// The folder.
        path: PathBuf,
    },
    /// An image that can't be used.
    #[error("{}: {what}", path.display())]
    Image {
        /// The file.
        path: PathBuf,
        /// What is wrong and what would be right.
        what: String,
    },
    /// A table of times that can't be used.
    #[error("{}:{line}: {what}", path.display())]
    Table {
        /// The file.
        path: PathBuf,
        /// Counted from 1.
        line: u64,
        /// What is wrong and what would be right.
        what: String,
    },
    /// Neither one for all nor one a folder.
    #[error(
        "{times} tables of times for {folders} folders of frames; expected one a folder, in the same order"
    )]
    Times {
        /// Folders of frames.
        folders: usize,
        /// Tables.
        times: usize,
    },
    /// Frames that are not in the order of their times.
    #[error("{}: frame {frame} at {time} s is not later than the one before it at {before} s; {expected}", path.display())]
    Order {
        /// Folder or table.
        path: PathBuf,
        /// Name of the file.
        frame: String,
        /// Its time.
        time: f64,
        /// The time before it.
        before: f64,
        /// What would be right.
        expected: &'static str,
    },
    /// A rate that is none.
    #[error("--rate {rate}: expected frames per second, above 0")]
    Rate {
        /// As given.
        rate: f64,
    },
    /// A time that is none.
    #[error("--start {start}: expected the time of the first frame in s, a finite number")]
    Start {
        /// As given.
        start: f64,
    },
    /// The data set that is there already does not fit.
    #[error("{}: {what}", path.display())]
    DataSet {
        /// The file.
        path: PathBuf,
        /// What is wrong and what would be right.
        what: String,
    },
    /// A file or folder can't be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// Which one.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
}

/// For `map_err` on something that was done with a file.
pub(crate) fn file(path: &std::path::Path) -> impl FnOnce(std::io::Error) -> Error {
    let path = path.to_owned();
    move |source| Error::File { path, source }
}
