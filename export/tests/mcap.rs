//! What is written is read back, by the reader of the same crate here and by Python's in `tests/fmpy/test_export.py`.

use export::{Column, Kind, Pictures, write_mcap};
use serde_json::Value;
use std::path::Path;

fn column(name: &str, kind: Kind, unit: Option<&str>) -> Column {
    Column { name: name.to_owned(), kind, unit: unit.map(str::to_owned) }
}

fn written(folder: &Path) -> Vec<u8> {
    let results = folder.join("results.csv");
    std::fs::write(&results, "time,a.x,a.on,b.frame\n0.0,0.1,0,-1\n0.5,inf,1,3\n1.0,0.3,1,3\n1.5,0.")
        .expect("writable");
    let picture = folder.join("frame_000003.png");
    std::fs::write(&picture, b"not looked into").expect("writable");
    let columns = [
        column("a.x", Kind::Real, Some("rad")),
        column("a.on", Kind::Boolean, None),
        column("b.frame", Kind::Integer, None),
    ];
    let pictures = Pictures { unit: "b".into(), index: "b.frame".into(), files: vec![(picture, 3)] };
    let target = folder.join("results.mcap");
    write_mcap(&target, &results, &columns, Some(&pictures)).expect("written");
    std::fs::read(target).expect("readable")
}

#[test]
fn law_each_row_is_a_message_of_each_unit_at_its_time() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let bytes = written(folder.path());
    let messages: Vec<(String, u64, Value)> = mcap::MessageStream::new(&bytes)
        .expect("an MCAP file")
        .map(|message| message.expect("a message"))
        .map(|m| (m.channel.topic.clone(), m.log_time, serde_json::from_slice(&m.data).expect("JSON")))
        .collect();
    let of = |topic: &str| {
        messages.iter().filter(|(t, ..)| t == topic).map(|(_, at, v)| (*at, v.clone())).collect::<Vec<_>>()
    };
    // The last line was cut off in the middle: three rows are whole. JSON has no infinity.
    assert_eq!(
        of("/a"),
        [
            (0, serde_json::json!({ "x": 0.1, "on": false })),
            (500_000_000, serde_json::json!({ "x": null, "on": true })),
            (1_000_000_000, serde_json::json!({ "x": 0.3, "on": true })),
        ]
    );
    // Messages are counted by rows.
    let sequences: Vec<u32> = mcap::MessageStream::new(&bytes)
        .expect("an MCAP file")
        .map(|message| message.expect("a message"))
        .filter(|message| message.channel.topic == "/a")
        .map(|message| message.sequence)
        .collect();
    assert_eq!(sequences, [0, 1, 2]);
    // A picture comes once, at the first row with its number.
    let images = of("/b/image");
    assert_eq!(images.len(), 1);
    assert_eq!(images[0].0, 500_000_000);
    assert_eq!(images[0].1["data"], "bm90IGxvb2tlZCBpbnRv");
}

#[test]
fn value_the_first_picture_has_the_number_0() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let results = folder.path().join("results.csv");
    std::fs::write(&results, "time,b.frame\n0.0,-1\n0.25,0\n0.5,0\n0.75,1\n").expect("writable");
    let files = (0..2).map(|number| {
        let path = folder.path().join(format!("{number}.png"));
        std::fs::write(&path, [number as u8; 3]).expect("writable");
        (path, number)
    });
    let pictures = Pictures { unit: "b".into(), index: "b.frame".into(), files: files.collect() };
    let target = folder.path().join("results.mcap");
    write_mcap(&target, &results, &[column("b.frame", Kind::Integer, None)], Some(&pictures))
        .expect("written");
    let bytes = std::fs::read(target).expect("readable");
    let images: Vec<(u64, Value)> = mcap::MessageStream::new(&bytes)
        .expect("an MCAP file")
        .map(|message| message.expect("a message"))
        .filter(|message| message.channel.topic == "/b/image")
        .map(|message| (message.log_time, serde_json::from_slice(&message.data).expect("JSON")))
        .collect();
    let found: Vec<_> = images
        .iter()
        .map(|(at, image)| (*at, image["data"].as_str(), image["timestamp"]["nsec"].as_u64()))
        .collect();
    assert_eq!(
        found,
        [(250_000_000, Some("AAAA"), Some(250_000_000)), (750_000_000, Some("AQEB"), Some(750_000_000))]
    );
}

#[test]
fn law_the_same_results_give_the_same_bytes() {
    let (one, two) = (tempfile::tempdir().expect("a folder"), tempfile::tempdir().expect("a folder"));
    assert_eq!(written(one.path()), written(two.path()));
}

#[test]
fn every_text_in_place_of_a_number_is_told_with_its_line() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let results = folder.path().join("results.csv");
    std::fs::write(&results, "time,a.x\n0.0,0.1\n1.0,often\n").expect("writable");
    let columns = [column("a.x", Kind::Real, None)];
    let error = write_mcap(&folder.path().join("x.mcap"), &results, &columns, None).expect_err("refused");
    assert!(error.to_string().ends_with("results.csv:3: a.x is \"often\", not a number"), "{error}");
}

/// A device on which nothing has room stands for the disk.
#[cfg(target_os = "linux")]
#[test]
fn bad_rows_and_times_are_told() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let results = folder.path().join("results.csv");
    let told = |text: &str| {
        std::fs::write(&results, text).expect("writable");
        let columns = [column("a.x", Kind::Real, None)];
        write_mcap(&folder.path().join("results.mcap"), &results, &columns, None)
            .map_err(|why| why.to_string())
    };
    // the last line may have been cut off; one before it is damage
    assert_eq!(told("time,a.x\n0,1\n1"), Ok(()));
    let damage = told("time,a.x\n0,1\n1\n2,3\n").expect_err("a row of one cell");
    assert!(damage.contains("line: 3"), "{damage}");
    let before = told("time,a.x\n-1,1\n").expect_err("before 0");
    assert!(before.contains("results.csv: a row at -1 s: MCAP counts nanoseconds from 0"), "{before}");
}

#[test]
fn law_a_full_disk_is_told_and_no_half_file_is_left() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (results, target) = (folder.path().join("results.csv"), folder.path().join("results.mcap"));
    std::fs::write(&results, "time,a.x\n0.0,0.1\n").expect("writable");
    std::os::unix::fs::symlink("/dev/full", &target).expect("writable");
    let error = write_mcap(&target, &results, &[column("a.x", Kind::Real, None)], None).expect_err("no room");
    let text = error.to_string();
    assert_eq!(text, format!("{}: No space left on device (os error 28)", target.display()));
    assert!(target.symlink_metadata().is_err(), "the name is free");
}
