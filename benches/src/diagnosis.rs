//! How long a diagnosis takes on the open data sets, and which stage takes it; beside the times of issue 4.

use crate::{Row, Samples, peer::root};
use diagnosis::{Options, diagnose};
use std::path::PathBuf;
use std::time::Instant;

/// Data set, and the seconds that it may take: 10 with plant logs only, 60 with frames.
const SETS: [(&str, f64); 5] = [
    ("sim-none", 60.0),
    ("sim-k1", 60.0),
    ("sim-delay", 60.0),
    ("sim-joint-friction", 60.0),
    ("dfki-arm-a0", 10.0),
];
const ROUNDS: usize = 3;
/// One round is enough where it takes longer than this, in s.
const LONG: f64 = 20.0;

/// Beginnings of the lines that a diagnosis tells, and what is done from there on.
const STAGES: [(&str, &str); 3] =
    [("", "reading and opening"), ("plant:", "plant"), ("camera:", "picture and conclusion")];

/// Seconds that this process has spent on processors.
fn processor_time() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // After the name in brackets: user and system time are the 12th and 13th number, in hundredths of a second.
    let numbers = text.rsplit(')').next().unwrap_or_default().split_whitespace();
    numbers.skip(11).take(2).filter_map(|ticks| ticks.parse::<f64>().ok()).sum::<f64>() / 100.0
}

/// All sets; none where the open data are not at hand.
pub fn rows() -> Vec<Row> {
    let Some(folder) = data() else {
        println!("no shared/data beside the repository: diagnosis not measured");
        return Vec::new();
    };
    SETS.iter().map(|(name, limit)| row(&folder.join(name), name, *limit)).collect()
}

fn data() -> Option<PathBuf> {
    let beside = root().parent().map(|folder| folder.join("shared/data"));
    [Some(root().join("shared/data")), beside].into_iter().flatten().find(|folder| folder.is_dir())
}

fn row(path: &std::path::Path, name: &str, limit: f64) -> Row {
    let [mut all, mut processor]: [Samples; 2] = Default::default();
    let mut stages = [const { Samples(Vec::new()) }; STAGES.len()];
    let mut verdict = String::new();
    for _ in 0..ROUNDS {
        let (began, used) = (Instant::now(), processor_time());
        let (mut stage, mut since) = (0, began);
        let mut spent = [0.0; STAGES.len()];
        let mut tell = |doing: &diagnosis::Doing<'_>| {
            let line = doing.stage;
            // Only a stage's own line leads on; lines about what was found there begin alike.
            let Some(next) = (stage + 1..STAGES.len()).find(|at| line.starts_with(STAGES[*at].0)) else {
                return;
            };
            let now = Instant::now();
            spent[stage] += (now - since).as_secs_f64();
            (stage, since) = (next, now);
        };
        let found = diagnose(path, &crate::closed_loop::units(), &Options::default(), &mut tell)
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        spent[stage] += since.elapsed().as_secs_f64();
        all.0.push(began.elapsed().as_secs_f64());
        processor.0.push(processor_time() - used);
        stages.iter_mut().zip(spent).for_each(|(samples, time)| samples.0.push(time));
        let effects: Vec<String> = found.effects.iter().map(|effect| effect.name.clone()).collect();
        let long = all.0.iter().any(|time| *time > LONG);
        verdict = if effects.is_empty() { "nothing named".into() } else { effects.join(", ") };
        if long {
            break;
        }
    }
    let split: Vec<String> = (STAGES.iter().zip(&stages))
        .filter(|(_, samples)| samples.median() > 0.0)
        .map(|((_, words), samples)| format!("{words} {}", crate::samples::short(samples.median())))
        .collect();
    Row::faster("diagnosis", format!("diagnosis of {name}"), "s", &all).at_most(limit).note(format!(
        "{}; processors {}; found: {verdict}",
        split.join(", "),
        crate::samples::short(processor.median())
    ))
}
