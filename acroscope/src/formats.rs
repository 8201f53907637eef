//! Results in the formats of other tools, beside `results.csv`.

use crate::error::Error;
use crate::folder::Folder;
use crate::run_report::{Layout, pictures};
use export::{Column, Kind, Pictures};
use orchestrator::Simulation;
use report::Provenance;

/// For Foxglove, Rerun, PlotJuggler.
pub const MCAP: &str = "results.mcap";

/// For tables.
pub const PARQUET: &str = "results.parquet";

/// Writes the table, with where it comes from.
pub fn parquet(folder: &Folder, simulation: &Simulation, provenance: &Provenance) -> Result<(), Error> {
    let columns: Vec<Column> = simulation.columns().iter().map(column).collect();
    let target = folder.file(PARQUET);
    let provenance = serde_json::to_string(provenance).map_err(|why| Error::file(&target)(why.into()))?;
    let words = [("acroscope:provenance", provenance), ("acroscope:resolved", simulation.resolved())];
    Ok(export::write_parquet(&target, &folder.file("results.csv"), &columns, &words)?)
}

/// Writes what there is of the run, pictures included.
pub fn mcap(folder: &Folder, simulation: &Simulation, layout: &Layout) -> Result<(), Error> {
    let columns: Vec<Column> = simulation.columns().iter().map(column).collect();
    let pictures = match &layout.picture {
        Some(entry) => Some(Pictures {
            unit: entry.unit.clone(),
            index: format!("{}.{}", entry.unit, entry.index),
            files: pictures(&folder.file("frames"))?,
        }),
        None => None,
    };
    Ok(export::write_mcap(&folder.file(MCAP), &folder.file("results.csv"), &columns, pictures.as_ref())?)
}

fn column(column: &orchestrator::Column) -> Column {
    let kind = match column.kind {
        orchestrator::Kind::Real => Kind::Real,
        orchestrator::Kind::Integer => Kind::Integer,
        orchestrator::Kind::Boolean => Kind::Boolean,
        orchestrator::Kind::String => Kind::Text,
    };
    Column { name: column.name.clone(), unit: column.unit.clone(), kind }
}
