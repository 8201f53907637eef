//! What is written is read back, by the reader of the same crate here and by Python's in `tests/fmpy/test_export.py`.

use export::{Column, Kind, write_parquet};
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::Field;
use std::fmt::Write as _;
use std::path::Path;

fn column(name: &str, kind: Kind, unit: Option<&str>) -> Column {
    Column { name: name.to_owned(), kind, unit: unit.map(str::to_owned) }
}

fn write(
    folder: &Path,
    rows: &str,
    columns: &[Column],
) -> Result<SerializedFileReader<std::fs::File>, String> {
    let (results, target) = (folder.join("results.csv"), folder.join("results.parquet"));
    std::fs::write(&results, rows).expect("writable");
    let metadata = [("acroscope:origin", "a test".to_owned())];
    write_parquet(&target, &results, columns, &metadata).map_err(|error| error.to_string())?;
    Ok(SerializedFileReader::new(std::fs::File::open(target).expect("readable")).expect("a Parquet file"))
}

#[test]
fn value_rows_come_back_with_their_types_and_units() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let columns = [
        column("a.x", Kind::Real, Some("rad")),
        column("a.on", Kind::Boolean, None),
        column("b.frame", Kind::Integer, None),
        column("b.said", Kind::Text, None),
    ];
    let rows = "time,a.x,a.on,b.frame,b.said\n0.0,0.1,0,-1,\n0.5,inf,1,3,\"grüß, \"\"dich\"\"\"\n1.0,-0.3,1,4,x\n1.5,0.";
    let file = write(folder.path(), rows, &columns).expect("written");
    let row = |values: (f64, f64, bool, i32, &str)| {
        let (time, x, on, frame, said) = values;
        [
            ("time", Field::Double(time)),
            ("a.x", Field::Double(x)),
            ("a.on", Field::Bool(on)),
            ("b.frame", Field::Int(frame)),
            ("b.said", Field::Str(said.to_owned())),
        ]
        .map(|(name, field)| (name.to_owned(), field))
        .to_vec()
    };
    let found: Vec<Vec<(String, Field)>> =
        file.get_row_iter(None).expect("rows").map(|row| row.expect("a row").into_columns()).collect();
    // The last line was cut off in the middle: three rows are whole.
    let expected = [
        row((0.0, 0.1, false, -1, "")),
        row((0.5, f64::INFINITY, true, 3, "grüß, \"dich\"")),
        row((1.0, -0.3, true, 4, "x")),
    ];
    assert_eq!(found, expected);
    let about = file.metadata().file_metadata();
    let mut words: Vec<(String, String)> = about
        .key_value_metadata()
        .expect("metadata")
        .iter()
        .map(|word| (word.key.clone(), word.value.clone().unwrap_or_default()))
        .collect();
    words.sort();
    let expected = [("acroscope:origin", "a test"), ("unit:a.x", "rad"), ("unit:time", "s")];
    assert_eq!(words, expected.map(|(key, value)| (key.to_owned(), value.to_owned())));
    assert!(about.created_by().is_some_and(|by| by.starts_with("acroscope ")));
}

#[test]
fn value_long_tables_come_in_groups_that_fit_into_memory() {
    // A million values wait at most: 8 columns of 300 000 rows are three groups.
    let folder = tempfile::tempdir().expect("a temporary folder");
    let columns: Vec<Column> = (0..7).map(|k| column(&format!("a.x{k}"), Kind::Integer, None)).collect();
    let mut rows = "time,a.x0,a.x1,a.x2,a.x3,a.x4,a.x5,a.x6\n".to_owned();
    for k in 0..300_000 {
        writeln!(rows, "{k}.0,{k},1,2,3,4,5,{}", -k).expect("room");
    }
    let file = write(folder.path(), &rows, &columns).expect("written");
    let groups: Vec<i64> = file.metadata().row_groups().iter().map(|group| group.num_rows()).collect();
    assert_eq!(groups, [131_072, 131_072, 37_856]); // 2²⁰ / 8 rows
    let mut count = 0;
    for (row, k) in file.get_row_iter(None).expect("rows").zip(0..) {
        let columns = row.expect("a row").into_columns();
        assert_eq!(columns[0].1, Field::Double(f64::from(k)));
        assert_eq!(columns[1].1, Field::Int(k));
        assert_eq!(columns[7].1, Field::Int(-k));
        count += 1;
    }
    assert_eq!(count, 300_000);
}

#[test]
fn value_a_table_without_rows_is_one() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = write(folder.path(), "time,a.x\n", &[column("a.x", Kind::Real, None)]).expect("written");
    assert_eq!(file.metadata().file_metadata().num_rows(), 0);
    assert_eq!(file.metadata().num_row_groups(), 0);
    assert_eq!(file.metadata().file_metadata().schema().get_fields().len(), 2);
}

#[test]
fn every_text_in_place_of_a_number_is_told_and_leaves_no_half_table() {
    for kind in [Kind::Real, Kind::Integer, Kind::Boolean] {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let error = write(folder.path(), "time,a.x\n0.0,1\n1.0,often\n", &[column("a.x", kind, None)]);
        let error = error.err().expect("refused");
        assert!(error.ends_with("results.csv:3: a.x is \"often\", not a number"), "{error}");
        assert!(!folder.path().join("results.parquet").exists());
    }
}
