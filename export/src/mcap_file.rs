//! MCAP, for Foxglove, Rerun and PlotJuggler: a topic for each unit, its values as JSON, and its pictures as
//! `foxglove.CompressedImage` (<https://docs.foxglove.dev/docs/sdk/schemas/compressed-image>). Log time is simulated time in ns.

use crate::error::{Error, file};
use crate::rows::Rows;
use crate::{Column, Kind, Pictures};
use base64::Engine as _;
use mcap::records::MessageHeader;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

type Writer = mcap::Writer<BufWriter<File>>;

/// A column of the file, the variable's name, what is known of it.
type Field<'a> = (usize, &'a str, &'a Column);

/// Values of one unit: where they go, and from which columns.
struct Topic {
    channel: u16,
    /// Column of the file, name of the variable, type.
    fields: Vec<(usize, String, Kind)>,
}

/// Pictures that are still to come.
struct Images<'a> {
    channel: u16,
    unit: &'a str,
    index: usize,
    files: BTreeMap<u64, &'a PathBuf>,
}

/// Writes `target` from the run's `results` and pictures.
///
/// # Errors
/// A file can't be read or written; results that are no numbers.
pub fn write_mcap(
    target: &Path,
    results: &Path,
    columns: &[Column],
    pictures: Option<&Pictures>,
) -> Result<(), Error> {
    let written = write(target, results, columns, pictures);
    if written.is_err() {
        // Without its end readers refuse it.
        let _ = std::fs::remove_file(target);
    }
    written
}

fn write(
    target: &Path,
    results: &Path,
    columns: &[Column],
    pictures: Option<&Pictures>,
) -> Result<(), Error> {
    let mut rows = Rows::open(results)?;
    // Whole chunks without compression: no C library, and the same bytes everywhere.
    let options =
        mcap::WriteOptions::new().compression(None).library(concat!("acroscope ", env!("CARGO_PKG_VERSION")));
    let output = BufWriter::new(File::create(target).map_err(file(target))?);
    let mut writer = options.create(output).map_err(refused(target))?;
    let topics = topics(&mut writer, &rows.head, columns).map_err(refused(target))?;
    let mut images = match pictures {
        Some(pictures) => images(&mut writer, &rows.head, pictures).map_err(refused(target))?,
        None => None,
    };
    let mut sequence = 0;
    while rows.advance()? {
        let time = rows.number(0)?;
        let time = nanoseconds(time).ok_or_else(|| Error::Time { path: results.to_owned(), time })?;
        for topic in &topics {
            let message = values(&rows, topic)?.to_string();
            put(&mut writer, topic.channel, sequence, time, message.as_bytes()).map_err(refused(target))?;
        }
        if let Some(images) = &mut images {
            let number = rows.number(images.index)?;
            // Numbers of pictures are counts, from 0; -1 and the like are none.
            if let Some(path) = (number >= 0.0).then(|| images.files.remove(&(number as u64))).flatten() {
                let message = image(images.unit, time, path)?.to_string();
                put(&mut writer, images.channel, sequence, time, message.as_bytes())
                    .map_err(refused(target))?;
            }
        }
        sequence += 1;
    }
    writer.finish().map_err(refused(target))?;
    Ok(())
}

/// What the system said, where it said something.
fn refused(path: &Path) -> impl Fn(mcap::McapError) -> Error {
    move |error| match error {
        mcap::McapError::Io(why) => file(path)(why),
        other => file(path)(other),
    }
}

fn put(writer: &mut Writer, channel_id: u16, sequence: u32, time: u64, data: &[u8]) -> mcap::McapResult<()> {
    writer.write_to_known_channel(
        &MessageHeader { channel_id, sequence, log_time: time, publish_time: time },
        data,
    )
}

/// Simulated time as MCAP counts it; nothing where it can't.
fn nanoseconds(time: f64) -> Option<u64> {
    let time = (time * 1e9).round();
    (0.0..u64::MAX as f64).contains(&time).then_some(time as u64)
}

/// A channel for each unit, in the order in which the units come.
fn topics(writer: &mut Writer, head: &[String], columns: &[Column]) -> mcap::McapResult<Vec<Topic>> {
    let mut units: Vec<(&str, Vec<Field<'_>>)> = Vec::new();
    for column in columns {
        let Some(at) = head.iter().position(|name| *name == column.name) else { continue };
        let (unit, variable) = column.name.split_once('.').unwrap_or(("", &column.name));
        match units.iter_mut().find(|(name, _)| *name == unit) {
            Some((_, fields)) => fields.push((at, variable, column)),
            None => units.push((unit, vec![(at, variable, column)])),
        }
    }
    let mut made = Vec::new();
    for (unit, fields) in units {
        let schema = schema(unit, &fields).to_string();
        let schema = writer.add_schema(&format!("acroscope.{unit}"), "jsonschema", schema.as_bytes())?;
        let channel = writer.add_channel(schema, &format!("/{unit}"), "json", &BTreeMap::new())?;
        let fields =
            fields.into_iter().map(|(at, name, column)| (at, name.to_owned(), column.kind)).collect();
        made.push(Topic { channel, fields });
    }
    Ok(made)
}

/// JSON schema of one unit's values; units of measurement stand in the descriptions.
fn schema(unit: &str, fields: &[Field<'_>]) -> Value {
    let properties: Map<String, Value> = fields
        .iter()
        .map(|(_, name, column)| {
            let kind = match column.kind {
                Kind::Real => "number",
                Kind::Integer => "integer",
                Kind::Boolean => "boolean",
                Kind::Text => "string",
            };
            let mut property = json!({ "type": kind });
            if let Some(unit) = &column.unit {
                property["description"] = json!(unit);
            }
            ((*name).to_owned(), property)
        })
        .collect();
    json!({ "title": format!("acroscope.{unit}"), "type": "object", "properties": properties })
}

/// One message of a unit. JSON has no NaN: what is no finite number is null.
fn values(rows: &Rows, topic: &Topic) -> Result<Value, Error> {
    let mut message = Map::new();
    for (at, name, kind) in &topic.fields {
        let value = match kind {
            Kind::Real => json!(rows.number(*at)?),
            Kind::Integer => json!(rows.number(*at)? as i64),
            Kind::Boolean => json!(rows.number(*at)? != 0.0),
            Kind::Text => json!(rows.text(*at)),
        };
        message.insert(name.clone(), value);
    }
    Ok(Value::Object(message))
}

fn images<'a>(
    writer: &mut Writer,
    head: &[String],
    pictures: &'a Pictures,
) -> mcap::McapResult<Option<Images<'a>>> {
    let Some(index) = head.iter().position(|name| *name == pictures.index) else { return Ok(None) };
    let schema = json!({
        "title": "foxglove.CompressedImage",
        "description": "A compressed image",
        "type": "object",
        "properties": {
            "timestamp": {
                "type": "object", "title": "time",
                "properties": { "sec": { "type": "integer", "minimum": 0 }, "nsec": { "type": "integer", "minimum": 0, "maximum": 999_999_999 } },
            },
            "frame_id": { "type": "string" },
            "data": { "type": "string", "contentEncoding": "base64" },
            "format": { "type": "string" },
        },
    });
    let schema =
        writer.add_schema("foxglove.CompressedImage", "jsonschema", schema.to_string().as_bytes())?;
    let channel =
        writer.add_channel(schema, &format!("/{}/image", pictures.unit), "json", &BTreeMap::new())?;
    let files = pictures.files.iter().map(|(path, number)| (*number, path)).collect();
    Ok(Some(Images { channel, unit: &pictures.unit, index, files }))
}

fn image(unit: &str, time: u64, path: &Path) -> Result<Value, Error> {
    let bytes = std::fs::read(path).map_err(file(path))?;
    Ok(json!({
        "timestamp": { "sec": time / 1_000_000_000, "nsec": time % 1_000_000_000 },
        "frame_id": unit,
        "data": base64::engine::general_purpose::STANDARD.encode(bytes),
        "format": "png",
    }))
}
