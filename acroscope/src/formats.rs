//! Results in the formats of other tools, beside `results.csv`.

use export::{Column, Kind, Pictures};
use runner::{Error, Ran, pictures};

/// Writes those that were asked for.
pub fn write(ran: &Ran<'_>) -> Result<(), Error> {
    if ran.arguments.mcap {
        mcap(ran)?;
    }
    if ran.arguments.parquet {
        parquet(ran)?;
    }
    Ok(())
}

/// For tables: with where it comes from.
fn parquet(ran: &Ran<'_>) -> Result<(), Error> {
    let target = ran.folder.file("results.parquet");
    let provenance = serde_json::to_string(ran.provenance).map_err(|why| Error::file(&target)(why.into()))?;
    let words = [("acroscope:provenance", provenance), ("acroscope:resolved", ran.simulation.resolved())];
    export::write_parquet(&target, &ran.folder.file("results.csv"), &columns(ran), &words).map_err(told)
}

/// For Foxglove, Rerun, PlotJuggler: what there is of the run, pictures included.
fn mcap(ran: &Ran<'_>) -> Result<(), Error> {
    let pictures = match &ran.layout.picture {
        Some(entry) => Some(Pictures {
            unit: entry.unit.clone(),
            index: format!("{}.{}", entry.unit, entry.index),
            files: pictures(&ran.folder.file("frames"))?,
        }),
        None => None,
    };
    let target = ran.folder.file("results.mcap");
    export::write_mcap(&target, &ran.folder.file("results.csv"), &columns(ran), pictures.as_ref())
        .map_err(told)
}

fn told(error: export::Error) -> Error {
    match error {
        export::Error::File { path, why } => Error::File { path, why },
        other => Error::Format(other.to_string()),
    }
}

fn columns(ran: &Ran<'_>) -> Vec<Column> {
    ran.simulation.columns().iter().map(column).collect()
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
