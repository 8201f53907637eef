//! Results as CSV while the run goes on.
//!
//! Numbers are the shortest ones that read back to the same bits; Booleans are 0 and 1. Only whole rows are handed
//! to the system, at the latest when a simulated second is full, so that a killed run leaves a readable file.

#[cfg(unix)]
use super::Waiting;
#[cfg(unix)]
use super::lasting::Lasting;
use super::{Cell, Column, Position, Recorder, Row};
use crate::error::Error;
use std::fs::File;
use std::io::{self, Seek as _, Write};
use std::path::{Path, PathBuf};
#[cfg(unix)]
use std::ptr;

/// Rows are handed over when this many bytes wait, or when a simulated second is full.
const WAITING: usize = 1 << 16;

/// Makes of a file that was opened again what is written to.
#[cfg(unix)]
type Opened<W> = fn(File) -> W;

/// Writes CSV to a file or to anything else that takes bytes.
pub struct CsvRecorder<W: Write> {
    sink: W,
    path: Option<PathBuf>,
    waiting: Vec<u8>,
    /// The file, if it is one.
    #[cfg(unix)]
    file: Option<(Lasting, Opened<W>)>,
    /// Whose rows these are.
    #[cfg(unix)]
    process: u32,
    /// Bytes that were handed over.
    written: u64,
    /// Simulated time at which the next second is full.
    next_second: f64,
    number: zmij::Buffer,
}

impl CsvRecorder<File> {
    /// Writes a file; what it held is lost.
    ///
    /// # Errors
    /// If the file can't be made.
    pub fn create(path: impl AsRef<Path>) -> Result<Self, Error> {
        let path = path.as_ref();
        let sink = File::create(path);
        Self::to(path, sink.map_err(|source| Error::Record { target: Some(path.into()), source })?)
    }

    /// Goes on with a file where a checkpoint was made; what came after that is cut off.
    ///
    /// # Errors
    /// If the file isn't there any more, or is shorter than it was.
    pub fn resume(path: impl AsRef<Path>, position: Position) -> Result<Self, Error> {
        let path = path.as_ref();
        let open = || {
            let gone =
                "it is gone, though the checkpoint goes on with it; without --resume the run begins anew";
            let mut sink = File::options().write(true).open(path).map_err(|error| match error.kind() {
                io::ErrorKind::NotFound => io::Error::other(gone),
                _ => error,
            })?;
            if sink.metadata()?.len() < position.bytes {
                return Err(io::Error::other(
                    "it is shorter than at the checkpoint; without --resume the run begins anew",
                ));
            }
            sink.set_len(position.bytes)?;
            sink.seek(io::SeekFrom::End(0))?;
            Ok(sink)
        };
        let sink = open().map_err(|source| Error::Record { target: Some(path.into()), source })?;
        let Position { bytes, next_second } = position;
        Self::to(path, sink).map(|recorder| Self { written: bytes, next_second, ..recorder })
    }

    fn to(path: &Path, sink: File) -> Result<Self, Error> {
        #[cfg(unix)]
        let file = Lasting::new(path, &sink)
            .map_err(|source| Error::Record { target: Some(path.into()), source })?;
        Ok(Self {
            path: Some(path.into()),
            #[cfg(unix)]
            file: Some((file, std::convert::identity)),
            ..Self::new(sink)
        })
    }
}

impl<W: Write> CsvRecorder<W> {
    /// Writes to `sink`, in large pieces.
    pub fn new(sink: W) -> Self {
        Self {
            sink,
            path: None,
            #[cfg(unix)]
            file: None,
            #[cfg(unix)]
            process: std::process::id(),
            written: 0,
            waiting: Vec::with_capacity(WAITING + 4096),
            next_second: f64::NEG_INFINITY,
            number: zmij::Buffer::new(),
        }
    }

    /// What was written to.
    pub fn into_inner(self) -> W {
        self.sink
    }

    #[cold]
    fn hand_over(&mut self) -> Result<(), Error> {
        #[cfg(unix)]
        if self.file.is_some() && self.process != std::process::id() {
            // A copy of this process, which a unit may have split off and let return: the rows are the other one's to write.
            crate::guard::end_copy_of(self.process);
        }
        let result =
            self.found().and_then(|()| self.sink.write_all(&self.waiting)).and_then(|()| self.sink.flush());
        match result {
            Ok(()) => self.written += self.waiting.len() as u64,
            #[cfg(unix)]
            Err(_) => {
                if let Some((file, _)) = &self.file {
                    // Half a row is none.
                    file.cut_at(self.written);
                }
            }
            #[cfg(not(unix))]
            Err(_) => {}
        }
        self.waiting.clear();
        result.map_err(|source| self.failed(source))
    }

    /// Opens the file again if a unit has closed it, with all that the process had open.
    #[cfg(unix)]
    fn found(&mut self) -> io::Result<()> {
        if let Some((file, sink)) = &mut self.file
            && let Some(again) = file.found(self.written)?
        {
            // The number of the old one is somebody else's by now.
            std::mem::forget(std::mem::replace(&mut self.sink, sink(again)));
        }
        Ok(())
    }

    /// No unit closes it.
    #[cfg(not(unix))]
    fn found(&mut self) -> io::Result<()> {
        Ok(())
    }

    fn failed(&self, source: io::Error) -> Error {
        Error::Record { target: self.path.clone(), source }
    }
}

impl<W: Write> Recorder for CsvRecorder<W> {
    fn begin(&mut self, columns: &[Column]) -> Result<(), Error> {
        self.next_second = f64::NEG_INFINITY;
        self.waiting.extend_from_slice(b"time");
        for column in columns {
            self.waiting.push(b',');
            text(&mut self.waiting, &column.name);
        }
        self.waiting.push(b'\n');
        self.hand_over()
    }

    #[inline]
    fn row(&mut self, time: f64, row: Row<'_>) -> Result<(), Error> {
        let line = &mut self.waiting;
        line.extend_from_slice(self.number.format(time).as_bytes());
        for cell in row.cells() {
            line.push(b',');
            match cell {
                Cell::Real(value) => line.extend_from_slice(self.number.format(value).as_bytes()),
                Cell::Integer(value) => integer(line, value),
                Cell::Boolean(value) => line.push(b'0' + u8::from(value)),
                Cell::String(value) => text(line, value),
            }
        }
        line.push(b'\n');
        if time >= self.next_second || self.waiting.len() >= WAITING {
            self.next_second = time.floor() + 1.0;
            return self.hand_over();
        }
        Ok(())
    }

    fn position(&mut self) -> Result<Position, Error> {
        self.hand_over()?;
        #[cfg(unix)]
        if let Some((file, _)) = &self.file {
            // The rows must be on the disk before the checkpoint that counts on them.
            file.sync().map_err(|source| self.failed(source))?;
        }
        Ok(Position { bytes: self.written, next_second: self.next_second })
    }

    #[cfg(unix)]
    fn rescue(&self) -> Option<Waiting> {
        self.file.as_ref()?;
        Some(Waiting { write: write_waiting::<W>, recorder: ptr::from_ref(self).cast() })
    }

    fn end(&mut self) -> Result<(), Error> {
        self.hand_over()
    }
}

/// Writes what waits. Rows are whole, since no unit is called while one is put together.
///
/// # Safety
/// The pointer is to a recorder for `W` that is not being used.
#[cfg(unix)]
unsafe fn write_waiting<W: Write>(recorder: *const ()) {
    // SAFETY: as promised.
    let recorder = unsafe { &*recorder.cast::<CsvRecorder<W>>() };
    if let Some((file, _)) = &recorder.file {
        file.append(&recorder.waiting);
    }
}

impl<W: Write> CsvRecorder<W> {
    /// Bytes that were recorded but not handed over yet.
    pub fn waiting(&self) -> usize {
        self.waiting.len()
    }
}

fn integer(line: &mut Vec<u8>, value: i32) {
    let mut digits = [0u8; 10];
    let mut at = digits.len();
    let mut rest = value.unsigned_abs();
    loop {
        at -= 1;
        digits[at] = b'0' + (rest % 10) as u8;
        rest /= 10;
        if rest == 0 {
            break;
        }
    }
    if value < 0 {
        line.push(b'-');
    }
    line.extend_from_slice(&digits[at..]);
}

/// Quotes a text where RFC 4180 asks for it.
fn text(line: &mut Vec<u8>, value: &str) {
    if !value.contains(['"', ',', '\n', '\r']) {
        line.extend_from_slice(value.as_bytes());
        return;
    }
    line.push(b'"');
    for byte in value.bytes() {
        if byte == b'"' {
            line.push(b'"');
        }
        line.push(byte);
    }
    line.push(b'"');
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_texts_and_integers_are_written_as_others_read_them() {
        let mut line = Vec::new();
        for value in [0, 7, -10, i32::MAX, i32::MIN] {
            integer(&mut line, value);
            line.push(b' ');
        }
        text(&mut line, "a");
        text(&mut line, "b \"c\", d");
        assert_eq!(String::from_utf8_lossy(&line), "0 7 -10 2147483647 -2147483648 a\"b \"\"c\"\", d\"");
    }

    #[test]
    fn law_rows_wait_for_a_full_second_or_for_many_bytes() {
        let mut recorder = CsvRecorder::new(Vec::new());
        let column = Column { name: "a.s".into(), kind: crate::value::Kind::String, unit: None };
        recorder.begin(&[column]).expect("written");
        assert_eq!((recorder.waiting(), recorder.sink.as_slice()), (0, &b"time,a.s\n"[..]));
        let mut row = |time: f64, length: usize| {
            let strings = [crate::text::Text::from("x".repeat(length).as_str())];
            let slots = [crate::recorder::Slot::String(0)];
            recorder
                .row(time, Row { slots: &slots, reals: &[], integers: &[], strings: &strings })
                .expect("written");
            (recorder.waiting(), recorder.written)
        };
        assert_eq!(row(0.25, 1), (0, 16), "the first");
        assert_eq!(row(0.5, 2), (7, 16));
        assert_eq!(row(0.75, 1), (14, 16));
        assert_eq!(row(1.0, 1), (0, 36), "the second is full");
        // One byte less than it takes, then just as many.
        assert_eq!(row(1.5, WAITING - 6), (WAITING - 1, 36));
        assert_eq!(row(2.0, 1).0, 0, "a second later");
        assert_eq!(row(2.5, WAITING - 5).0, 0, "so many are handed over at once");
    }
}
