"""`acroscope run --mcap` and `--parquet`, read by others' libraries."""

import base64
import csv
import json
import subprocess
from pathlib import Path

import cv2
import numpy as np
import pyarrow.parquet as parquet
from mcap.reader import make_reader

ROOT = Path(__file__).resolve().parents[2]


def test_value_mcap_holds_the_rows_and_the_frames(tmp_path):
    command = [ROOT / "target" / "release" / "acroscope", "--quiet", "run", "visual-servo", "--stop", "0.5", "--mcap",
               "--set", "camera.frames_every=5", "--out", tmp_path]
    subprocess.run(command, check=True)
    rows = list(csv.DictReader((tmp_path / "results.csv").open()))
    plant, images, schemas = [], [], {}
    with (tmp_path / "results.mcap").open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            schemas[channel.topic] = schema
            {"/plant": plant, "/camera/image": images}.get(channel.topic, []).append((message.log_time, json.loads(message.data)))
    assert len(plant) == len(rows) == 301
    for (time, values), row in zip(plant, rows):
        assert time == round(float(row["time"]) * 1e9)
        assert values["q2"] == float(row["plant.q2"])
    assert json.loads(schemas["/plant"].data)["properties"]["q2"]["description"] == "rad"
    assert schemas["/camera/image"].name == "foxglove.CompressedImage"
    files = sorted((tmp_path / "frames").glob("*.png"))
    assert len(images) == len(files) >= 2
    for (_, message), file in zip(images, files):
        sent = cv2.imdecode(np.frombuffer(base64.b64decode(message["data"]), np.uint8), cv2.IMREAD_GRAYSCALE)
        assert np.array_equal(sent, cv2.imread(str(file), cv2.IMREAD_GRAYSCALE))


def test_value_parquet_holds_the_rows_the_units_and_where_they_come_from(tmp_path):
    command = [ROOT / "target" / "release" / "acroscope", "--quiet", "run", "visual-servo", "--stop", "0.5", "--parquet", "--out", tmp_path]
    subprocess.run(command, check=True)
    rows = list(csv.DictReader((tmp_path / "results.csv").open()))
    file = parquet.ParquetFile(tmp_path / "results.parquet")
    table = file.read()
    assert table.num_rows == len(rows) == 301 and table.column_names == list(rows[0])
    for name, values in table.to_pydict().items():
        assert [float(value) for value in values] == [float(row[name]) for row in rows], name
    kinds = {str(table.schema.field(name).type) for name in ("time", "camera.frame", "camera.valid")}
    assert kinds == {"double", "int32", "bool"}
    words = {key.decode(): value.decode() for key, value in file.metadata.metadata.items()}
    assert words["unit:plant.q2"] == "rad" and words["unit:time"] == "s"
    assert json.loads(words["acroscope:provenance"]) == json.loads((tmp_path / "summary.json").read_text())["provenance"]
    assert words["acroscope:resolved"] == (tmp_path / "resolved.toml").read_text()
