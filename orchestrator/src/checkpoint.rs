//! Checkpoints: the whole state of a run in a file, from which it goes on to the same bytes.
//!
//! A file is written beside the old one and takes its place in one go, so that whenever the process is killed there is a
//! whole one. It holds what the run was built from, the clock, all values, what is on its way, the units' own states and
//! how far the results were written.

use crate::error::Error;
use crate::line::{Line, LineState};
use crate::recorder::Position;
use crate::simulation::{Phase, Simulation};
use crate::system::{Point, Unit};
use crate::text::Text;
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Begins every file; the number is that of the format.
const MAGIC: &[u8] = b"acroscope checkpoint 5\n";

/// Where checkpoints go, and how often they are made.
#[derive(Debug, Clone)]
pub struct Checkpoints {
    /// The file, of which there is only the newest.
    pub file: PathBuf,
    /// Simulated time between two in s.
    pub every: f64,
}

/// The state of a run.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Checkpoint {
    /// The resolved scenario and the units' GUIDs and files: only the same run can go on.
    identity: String,
    ticks: i64,
    time: f64,
    pub(crate) position: Position,
    reals: Vec<f64>,
    integers: Vec<i32>,
    strings: Vec<String>,
    ends: Vec<i64>,
    next: i64,
    units: Vec<UnitState>,
    lines: Vec<LineState>,
    /// What the algorithm knows beside.
    algorithm: Vec<f64>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
struct UnitState {
    begin: f64,
    step: i64,
    reach: i64,
    size: f64,
    warnings: u64,
    not_finite: Vec<(u32, String)>,
    state: Vec<u8>,
}

impl Checkpoint {
    /// Simulated time in s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// How many bytes of results belong to it.
    pub fn position(&self) -> Position {
        self.position
    }

    /// Reads the newest checkpoint; `None` where there is none.
    ///
    /// # Errors
    /// If the file can't be read or is damaged.
    pub fn load(path: &Path) -> Result<Option<Self>, Error> {
        let bytes = match crate::plain::read(path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(source) => return Err(Error::File { path: path.into(), source }),
        };
        let wrong = |reason: &str| Error::Checkpoint { path: path.into(), reason: reason.into() };
        let rest = bytes.strip_prefix(MAGIC).ok_or_else(|| wrong("it is no checkpoint of this version"))?;
        let (sum, body) = rest.split_at_checked(32).ok_or_else(|| wrong("it is cut off"))?;
        if Sha256::digest(body).as_slice() != sum {
            return Err(wrong("it is damaged"));
        }
        postcard::from_bytes(body).map(Some).map_err(|error| wrong(&error.to_string()))
    }

    /// Writes the file in place of the one before.
    ///
    /// # Errors
    /// If it can't be written; the one before then stays.
    pub fn save(&self, path: &Path) -> Result<(), Error> {
        let body = postcard::to_allocvec(self)
            .map_err(|error| Error::Checkpoint { path: path.into(), reason: error.to_string() })?;
        let sum = Sha256::digest(&body);
        let write = |file: &mut File| {
            [MAGIC, sum.as_slice(), &body].into_iter().try_for_each(|part| file.write_all(part))
        };
        crate::plain::write_whole(path, write)
            .map_err(|source| Error::Record { target: Some(path.into()), source })
    }
}

impl Simulation {
    /// What a checkpoint belongs to.
    fn identity(&self) -> Result<String, Error> {
        let units = match self.sums.get() {
            Some(units) => units,
            None => {
                let units = format!("{}\n{}", self.units_by_content()?, self.signals_by_content());
                self.sums.get_or_init(|| units)
            }
        };
        // The description is words: it changes no row, and it would hide what does.
        // Files by their names and their content: a state goes to another folder, too.
        let resolved = self.bundled(&self.bundle());
        let told = |line: &&str| line.starts_with("description = ");
        let words =
            resolved.lines().take_while(|line| *line != "[experiment]").find(told).unwrap_or_default();
        Ok(format!("{}\n{units}", resolved.replacen(words, "", 1)))
    }

    /// A line a unit that signals are fed to: the checksum of all their values, since a file of measured ones may have changed.
    fn signals_by_content(&self) -> String {
        let fed = self.wiring.system.units.iter().filter(|unit| !unit.feeds.is_empty());
        let line = |unit: &Unit| {
            let points = unit.feeds.iter().flat_map(|feed| feed.signal.points());
            let bytes = points.flat_map(|(time, value)| [time.to_le_bytes(), value.to_le_bytes()].concat());
            format!(
                "unit {}: values fed from outside, of checksum {}…",
                unit.name,
                checksum(&bytes.collect::<Vec<_>>())
            )
        };
        fed.map(line).collect::<Vec<_>>().join("\n")
    }

    /// A line a unit: its GUID, and the checksum of its file, since a GUID need not tell two builds apart.
    fn units_by_content(&self) -> Result<String, Error> {
        let line = |((name, description), path): ((&str, &crate::fmu::Description), &PathBuf)| {
            let bytes = std::fs::read(path).map_err(|source| Error::File { path: path.clone(), source })?;
            Ok(format!("unit {name}: GUID {}, file of checksum {}…", description.guid, checksum(&bytes)))
        };
        let lines: Result<Vec<String>, Error> = self.units().zip(&self.wiring.files).map(line).collect();
        Ok(lines?.join("\n"))
    }

    /// Whether all units can save their states.
    ///
    /// # Errors
    /// Names the first that can't.
    pub(crate) fn can_checkpoint(&self) -> Result<(), Error> {
        let cannot = |(_, description): &(&str, &crate::fmu::Description)| {
            let flags = &description.co_simulation;
            !(flags.can_get_and_set_state && flags.can_serialize_state)
        };
        match self.units().find(cannot) {
            None => Ok(()),
            Some((name, _)) => Err(Error::Value {
                name: "checkpoint".into(),
                value: format!("unit {name}"),
                expected:
                    "a unit that says canGetAndSetFMUstate and canSerializeFMUstate; this one can't be saved"
                        .into(),
            }),
        }
    }

    /// The state now, to come back to with [`Simulation::go_back`].
    ///
    /// # Errors
    /// If a unit can't save its state.
    pub fn save(&mut self) -> Result<Checkpoint, Error> {
        self.initialize()?;
        self.can_checkpoint()?;
        self.checkpoint(Position::default())
    }

    /// Back to a saved state of this simulation, or of another one of the same scenario; from there it goes on to the same
    /// bits. Inputs and tunable parameters that were set while stepping are as they were then.
    ///
    /// # Errors
    /// If the state belongs to another scenario, or a unit refuses it.
    pub fn go_back(&mut self, to: &Checkpoint) -> Result<(), Error> {
        if self.phase != Phase::Running {
            self.reset();
            self.initialize()?;
        }
        self.restore(to)
    }

    /// The state now, between two points.
    pub(crate) fn checkpoint(&mut self, position: Position) -> Result<Checkpoint, Error> {
        let mut units = Vec::new();
        for unit in &mut self.wiring.system.units {
            let saved = unit.instance.save_state()?;
            let state = unit.instance.serialize_state(&saved);
            unit.instance.free_state(saved)?;
            units.push(UnitState {
                begin: unit.begin,
                step: unit.step,
                reach: unit.reach,
                size: unit.size,
                warnings: unit.instance.warnings(),
                not_finite: unit.not_finite.clone(),
                state: state?,
            });
        }
        let system = &self.wiring.system;
        Ok(Checkpoint {
            identity: self.identity()?,
            ticks: self.now.ticks,
            time: self.now.time,
            position,
            reals: system.values.reals.clone(),
            integers: system.values.integers.clone(),
            strings: system.values.strings.iter().map(|text| text.as_str().to_owned()).collect(),
            ends: system.ends.clone(),
            next: system.next,
            units,
            lines: system.lines.iter().map(Line::save).collect(),
            algorithm: self.algorithm.save(),
        })
    }

    /// Puts an initialised simulation where a checkpoint was made. What was told of the start it has told by itself.
    pub(crate) fn restore(&mut self, checkpoint: &Checkpoint) -> Result<(), Error> {
        if let Some(what) = difference(&checkpoint.identity, &self.identity()?) {
            return Err(Error::Value {
                name: "time of the checkpoint".into(),
                value: format!("{} s", checkpoint.time),
                expected: format!("it is of another run; this one differs: {what}"),
            });
        }
        let system = &mut self.wiring.system;
        for (unit, saved) in system.units.iter_mut().zip(&checkpoint.units) {
            let state = unit.instance.deserialize_state(&saved.state)?;
            let restored = unit.instance.restore_state(&state);
            unit.instance.free_state(state)?;
            restored?;
            unit.instance.set_warnings(saved.warnings);
            (unit.begin, unit.step, unit.size) = (saved.begin, saved.step, saved.size);
            unit.reach = saved.reach;
            unit.not_finite.clone_from(&saved.not_finite);
        }
        system.values.reals.clone_from(&checkpoint.reals);
        system.values.integers.clone_from(&checkpoint.integers);
        system.values.strings = checkpoint.strings.iter().map(|text| Text::from(text.as_str())).collect();
        system.ends.clone_from(&checkpoint.ends);
        system.next = checkpoint.next;
        for (line, saved) in system.lines.iter_mut().zip(&checkpoint.lines) {
            line.restore(saved);
        }
        self.algorithm.restore(&checkpoint.algorithm);
        self.now = Point { ticks: checkpoint.ticks, time: checkpoint.time };
        Ok(())
    }
}

/// The first digits of one: enough to tell two files apart.
fn checksum(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().take(6).map(|byte| format!("{byte:02x}")).collect()
}

/// Lines that are told of two runs that differ.
const TOLD: usize = 3;

/// The lines in which two runs differ, of this one and of the one that was saved.
fn difference(saved: &str, now: &str) -> Option<String> {
    if saved == now {
        return None;
    }
    let pairs = || saved.lines().zip(now.lines()).filter(|(saved, now)| saved != now);
    // Behind a line that one of them lacks all others differ, too.
    let told = if saved.lines().count() == now.lines().count() { TOLD } else { 1 };
    let mut differ: Vec<String> =
        pairs().take(told).map(|(saved, now)| format!("`{now}` instead of `{saved}`")).collect();
    match pairs().count() {
        0 => differ.push("it has more or fewer lines".into()),
        all if all > told => differ.push("and more".into()),
        _ => {}
    }
    Some(differ.join(", "))
}
