//! `acroscope import`: a data set of a unit and measured logs, or of images of a real camera.

use crate::cli::{Import, StampOf};
use crate::data_set::data_set;
use crate::error::Error;
use frames::{Recording, Stamp, Times};
use std::path::Path;

/// Writes the data set and says what was guessed.
pub fn import(arguments: &Import, quiet: bool) -> Result<(), Error> {
    let Some(fmu) = &arguments.fmu else {
        return images(arguments, quiet);
    };
    for path in arguments.logs.iter().chain([fmu]) {
        let unreadable = |source| orchestrator::Error::File { path: path.clone(), source };
        orchestrator::plain::open(path).map_err(unreadable)?;
    }
    let earlier = data_set(&arguments.out, arguments.force)?;
    let is = |one: &Path, other: &Path| one.canonicalize().ok() == other.canonicalize().ok();
    if let Some(log) = arguments.logs.iter().find(|log| earlier.iter().any(|path| is(path, log))) {
        return Err(Error::words(format!(
            "{}: this log would be written over; choose another --out",
            log.display()
        )));
    }
    let units = scenarios::unit_path();
    let clock = arguments.rate.map(|rate| diagnosis::Clock { rate, start: arguments.start });
    arguments.called.look_out();
    let asked = diagnosis::Import {
        logs: &arguments.logs,
        fmu,
        units: &units,
        clock,
        limits: &arguments.called.limited(),
        isolated: arguments.called.isolate,
    };
    let imported = diagnosis::import(&asked, &arguments.out)?;
    if quiet {
        return Ok(());
    }
    notes(&imported.notices);
    tell!("guesses, also in {}:", arguments.out.join("dataset.toml").display());
    for guess in &imported.guesses {
        tell!("  {guess}");
    }
    tell!("then: acroscope diagnose {}", arguments.out.display());
    Ok(())
}

fn notes(notices: &[String]) {
    for notice in notices {
        complain!("note: {notice}");
    }
}

/// `--frames`
fn images(arguments: &Import, quiet: bool) -> Result<(), Error> {
    let times = match arguments.rate {
        Some(rate) => vec![Times::Rate { rate, start: arguments.start }],
        None => arguments.times.iter().cloned().map(Times::Table).collect(),
    };
    if times.is_empty() {
        let words = "--frames needs to know when they were taken: expected --rate HZ, or --times FILE.csv with a column time in s";
        return Err(Error::words(words));
    }
    let recording = Recording {
        folders: arguments.frames.clone(),
        times,
        stamp: match arguments.stamp {
            StampOf::Delivered => Stamp::Delivered,
            StampOf::ExposureStart => Stamp::ExposureStart,
            StampOf::MidExposure => Stamp::MidExposure,
            StampOf::ExposureEnd => Stamp::ExposureEnd,
        },
        scenario: arguments.scenario.clone(),
        set: arguments.set.clone(),
        white: arguments.white,
    };
    let imported = frames::import(&recording, &arguments.out)?;
    if quiet {
        return Ok(());
    }
    notes(&imported.notices);
    for (folder, (frames, found)) in arguments.frames.iter().zip(&imported.counts) {
        tell!("{}: {frames} frames, {found} of them with all three circles", folder.display());
    }
    for path in &imported.written {
        tell!("{}", path.display());
    }
    tell!("then: acroscope diagnose {}", arguments.out.display());
    Ok(())
}
