//! The table of us / peer / ratio, on the terminal and as a page.

use crate::Samples;
use crate::samples::short;
use std::fmt::Write;

/// One comparison.
#[derive(Debug, Clone)]
pub struct Row {
    /// Part of the table.
    pub section: &'static str,
    what: String,
    unit: &'static str,
    ours: String,
    peer: String,
    theirs: String,
    ratio: Option<(f64, f64)>,
    quiet: f64,
    target: String,
    holds: Option<bool>,
    n: usize,
    note: String,
}

impl Row {
    /// A measurement that may be compared by [`Row::than`].
    pub fn faster(section: &'static str, what: String, unit: &'static str, ours: &Samples) -> Self {
        Self {
            section,
            what,
            unit,
            ours: ours.text(),
            peer: String::new(),
            theirs: String::new(),
            ratio: None,
            quiet: ours.quiet(),
            target: String::new(),
            holds: None,
            n: ours.n(),
            note: String::new(),
        }
    }

    /// The peer's samples of the same; the ratio is theirs by ours, of 10th percentiles and of medians.
    pub fn than(mut self, peer: &str, theirs: &Samples) -> Self {
        self.ratio = Some((theirs.quiet() / self.quiet, theirs.quiet()));
        peer.clone_into(&mut self.peer);
        self.theirs = theirs.text();
        self
    }

    /// The ratio must be at least this.
    pub fn at_least(mut self, ratio: f64) -> Self {
        self.target = format!("≥ {ratio} x faster");
        self.holds = self.ratio.map(|(found, _)| found >= ratio);
        self
    }

    /// We may cost at most this many times what the peer costs.
    pub fn at_most_times(mut self, factor: f64) -> Self {
        self.target = format!("≤ {factor} x its cost");
        self.holds = self.ratio.map(|(found, _)| 1.0 / found <= factor);
        self
    }

    /// Our 10th percentile must not be above this.
    pub fn at_most(mut self, limit: f64) -> Self {
        self.target = format!("≤ {limit} {}", self.unit);
        self.holds = Some(self.quiet <= limit);
        self
    }

    /// A remark.
    pub fn note(mut self, note: String) -> Self {
        self.note = note;
        self
    }

    fn cells(&self) -> [String; 8] {
        let ratio = self.ratio.map_or_else(String::new, |(ratio, _)| {
            if ratio >= 1.0 {
                format!("{} x faster", short(ratio))
            } else {
                format!("{} x its cost", short(1.0 / ratio))
            }
        });
        let target = match self.holds {
            Some(true) => format!("{} ✓", self.target),
            Some(false) => format!("{} **missed**", self.target),
            None => String::new(),
        };
        let what =
            if self.unit.is_empty() { self.what.clone() } else { format!("{}, {}", self.what, self.unit) };
        [
            what,
            self.ours.clone(),
            self.peer.clone(),
            self.theirs.clone(),
            ratio,
            target,
            self.n.to_string(),
            self.note.clone(),
        ]
    }
}

const HEAD: [&str; 8] = ["what", "Acroscope", "peer", "peer's", "ratio", "to reach", "n", "remark"];

/// Rows as a Markdown table.
pub fn table(rows: &[Row]) -> String {
    let mut text = String::new();
    let mut line = |cells: &[String]| {
        // Writing to a String can't fail.
        let _ = writeln!(text, "| {} |", cells.join(" | "));
    };
    line(&HEAD.map(String::from));
    line(&HEAD.map(|_| "---".to_owned()));
    for row in rows {
        line(&row.cells());
    }
    text
}

/// The machine in a line: processor, cores, and how busy it is.
pub fn machine() -> String {
    let read = |path: &str| std::fs::read_to_string(path).unwrap_or_default();
    let cpu = read("/proc/cpuinfo");
    let field = |name: &str| {
        let line = cpu.lines().find(|line| line.starts_with(name)).unwrap_or_default();
        line.split_once(':').map_or("?", |(_, value)| value.trim()).to_owned()
    };
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let load = read("/proc/loadavg");
    format!(
        "{} (family {}, model {}), {cores} cores, {}; load at the end {}",
        field("model name"),
        field("cpu family"),
        field("model\t"),
        std::env::consts::OS,
        load.split(' ').take(3).collect::<Vec<_>>().join(" ")
    )
}

/// The whole page.
pub fn page(rows: &[Row]) -> String {
    let mut text = String::from(METHOD);
    let _ = writeln!(text, "\nMachine of the numbers below: {}.\n", machine());
    let mut sections: Vec<&str> = Vec::new();
    for row in rows {
        if !sections.contains(&row.section) {
            sections.push(row.section);
        }
    }
    for section in sections {
        let part: Vec<Row> = rows.iter().filter(|row| row.section == section).cloned().collect();
        let _ = writeln!(text, "## {}\n\n{}", title(section), table(&part));
    }
    text
}

fn title(section: &str) -> &str {
    match section {
        "frame" => "Camera frame",
        "master" => "Master",
        "isolated" => "Units in processes of their own",
        "loop" => "Closed loop",
        "sweep" => "Many short runs",
        "estimator" => "Estimators beside the bound",
        "diagnosis" => "Diagnosis of the open data sets",
        other => other,
    }
}

const METHOD: &str = "# Speed

Written by `scripts/bench.sh`; don't edit. Each side is measured in turns with its peers within one process or with a
peer process that stays alive, so that a busy machine slows both alike. Shown are the 10th percentile and, in brackets,
median and 90th percentile. Ratios are those of 10th percentiles: what it costs when nothing else is on the machine.
Absolute times hold for the machine named and for its load of the day; only ratios are concluded from. `n` is the
number of frames or of rounds. What guards against regressions is `scripts/instructions.sh`, which counts instructions.

Peers: OpenCV and numpy in `scripts/peers/opencv_frame.py`, one thread, in three degrees of tuning; FMPy, libcosim and
Ecos in `scripts/peers/masters.py`, libcosim also without its threads (`scripts/peers/libcosim_serial.py`); for the master
also a plain C loop over the same functions, the limit: of a nearly free unit (`benches/ring.c`), of one that costs what a
small real one does (`benches/oscillator.c`), of one that hands on what it gets (`benches/feedthrough.c`), and of our own
three (`benches/closed.c`). All but the first must end at our bits. The third is made after the Feedthrough of the FMI
project's reference units and takes two thirds of its time, so that a master's share shows sooner; the reference unit itself
is measured where `ACROSCOPE_FEEDTHROUGH` names its file, which no package registry has (github.com/modelica/Reference-FMUs;
below: its source compiled with -O2). Where a unit copies texts, its cost depends by a third on where its instances lie in
memory, so both sides are measured in several places.
";
