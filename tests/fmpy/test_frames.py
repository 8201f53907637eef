"""`acroscope import --frames`: images in every format, written by OpenCV, give the centroids that the camera unit itself gave for them."""

import csv
import json
import struct
import subprocess
import tomllib
import zlib

import cv2
import numpy as np
import pytest
from conftest import ROOT

PROGRAM = ROOT / "target" / "release" / "acroscope"
CENTROIDS = ("u1", "v1", "u2", "v2", "u3", "v3")
SEEN = (*CENTROIDS, "area1", "area2", "area3", "q1_est", "q2_est")
FRAMES = 24


def run(*arguments, status=0):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == status, done.stderr
    return done.stdout + done.stderr


def rows(path):
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def recorded(unit, folder, **values):
    """Frames of a swaying arm as the unit writes them, and what its vision said of each."""
    camera = unit("camera").start(frames_dir=str(folder), **values)
    fields = 60 if values.get("interlaced") else 30
    said, last = [], None
    for point in range(600 // fields * FRAMES + 1):
        time = point / 600
        if point:
            camera.set(q1=0.1 * np.sin(3 * time), q2=0.2 * np.cos(2 * time)).step((point - 1) / 600, 1 / 600)
        if (number := camera.get("frame")) != last:
            said.append([camera.get("frame_index"), *(camera.get(name) for name in SEEN)])
            last = number
    return said


def rewritten(folder, to, change, ending, *options):
    """The same frames as another program writes them."""
    to.mkdir()
    for path in sorted(folder.glob("*.png")):
        assert cv2.imwrite(str(to / (path.stem + ending)), change(cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)), list(options))
    return to


def same(path, said, tolerance=0.0):
    """Each row of the log against what the unit said of the frame."""
    log = rows(path)
    assert len(log) == len(said) and all(row["valid"] == "1" for row in log)
    found = np.array([[float(row[name]) for name in SEEN] for row in log])
    off = np.abs(found - np.array([one[1:] for one in said]))
    assert off[:, : len(CENTROIDS)].max() <= tolerance
    if not tolerance:
        # the log has the shortest text of each double
        assert off.max() == 0


FORMATS = {
    "png-8": (lambda grey: grey, ".png", ()),
    "png-16": (lambda grey: grey.astype(np.uint16) * 257, ".png", ()),
    "tiff-8": (lambda grey: grey, ".tiff", ()),
    "tiff-16": (lambda grey: grey.astype(np.uint16) * 257, ".TIF", ()),
    "png-12": (lambda grey: np.round(grey * (4095 / 255)).astype(np.uint16), ".png", ()),
    "colour": (lambda grey: cv2.cvtColor(grey, cv2.COLOR_GRAY2BGR), ".png", ()),
}


@pytest.mark.parametrize("kind", FORMATS)
def test_lossless_images_give_the_units_own_centroids_to_the_last_bit(unit, tmp_path, kind):
    said = recorded(unit, tmp_path / "own", sigma=3.0, seed=5)
    change, ending, options = FORMATS[kind]
    images = rewritten(tmp_path / "own", tmp_path / "images", change, ending, *options)
    white = ("--white", 4095) if kind == "png-12" else ()
    told = run("import", "--frames", images, "--rate", 30, *white, "--out", tmp_path / "set")
    same(tmp_path / "set" / "run-01" / "camera.csv", said)
    assert ("luminance" in told) == (kind == "colour")
    assert ("16 bit" in told) == kind.endswith(("16", "12"))
    head = tomllib.loads((tmp_path / "set" / "dataset.toml").read_text())
    assert head == {"format": 1, "scenario": "visual-servo", "run": [{"dir": "run-01"}]}
    times = [float(row["time"]) for row in rows(tmp_path / "set" / "run-01" / "camera.csv")]
    assert np.allclose(times, np.arange(len(said)) / 30, atol=1e-12)


@pytest.mark.parametrize("values", [{"estimator": 1}, {"estimator": 2}, {"interlaced": True}], ids=["grey", "likelihood", "interlaced"])
def test_estimators_and_fields_are_those_of_the_scenario(unit, tmp_path, values):
    said = recorded(unit, tmp_path / "own", **values)
    sets = [part for name, value in values.items() for part in ("--set", f"camera.{name}={str(value).lower()}")]
    run("import", "--frames", tmp_path / "own", "--rate", 60 if "interlaced" in values else 30, *sets, "--out", tmp_path / "set")
    same(tmp_path / "set" / "run-01" / "camera.csv", said)
    head = tomllib.loads((tmp_path / "set" / "dataset.toml").read_text())
    assert head["set"] == {f"camera.{name}": value for name, value in values.items()}


def test_jpeg_and_colours_are_near(unit, tmp_path):
    said = recorded(unit, tmp_path / "own")
    images = rewritten(tmp_path / "own", tmp_path / "jpeg", lambda grey: grey, ".jpg", cv2.IMWRITE_JPEG_QUALITY, 95)
    run("import", "--frames", images, "--rate", 30, "--out", tmp_path / "set")
    # a circle of 75 px whose rim rings by some grey levels: a pixel or two of it change sides
    same(tmp_path / "set" / "run-01" / "camera.csv", said, tolerance=0.15)
    # yellow circles: Rec. 709 gives them .9278 of the light, still above the threshold where they are full
    yellow = rewritten(tmp_path / "own", tmp_path / "yellow", lambda grey: np.dstack([0 * grey, grey, grey]), ".png")
    run("import", "--frames", yellow, "--rate", 30, "--set", "camera.threshold=177", "--out", tmp_path / "yellow-set")
    same(tmp_path / "yellow-set" / "run-01" / "camera.csv", said, tolerance=0.02)


def test_times_come_from_a_table_in_any_order_and_lost_circles_are_told(unit, tmp_path):
    said = recorded(unit, tmp_path / "own")
    names = sorted(path.name for path in (tmp_path / "own").glob("*.png"))
    cv2.imwrite(str(tmp_path / "own" / names[7]), np.zeros((512, 512), np.uint8))
    times = {name: 100 + 0.034 * place for place, name in enumerate(names)}
    table = tmp_path / "times.csv"
    table.write_text("file,time\n" + "".join(f"{name},{times[name]!r}\n" for name in reversed(names)))
    told = run(
        "import", "--frames", tmp_path / "own", "--times", table, "--stamp", "exposure-start",
        "--set", "camera.T_delay=0.02", "--set", "camera.E_t=0.3", "--out", tmp_path / "set",
    )  # fmt: skip
    log = rows(tmp_path / "set" / "run-01" / "camera.csv")
    assert [row["valid"] for row in log] == ["0" if place == 7 else "1" for place in range(len(names))]
    assert all(log[7][name] == "" for name in SEEN) and log[8]["u3"] == repr(said[8][1 + SEEN.index("u3")])
    # open for 0.3/30 s, read out and worked on for 0.02 s
    assert np.allclose([float(row["time"]) for row in log], np.array(list(times.values())) + 0.01 + 0.02, atol=1e-9)
    assert np.allclose([float(row["t_mid"]) for row in log], np.array(list(times.values())) + 0.005, atol=1e-9)
    assert f"1 of {len(names)} frames do not show all three circles" in told and names[7] in told and "no pixel at or above" in told


def test_a_missing_number_is_a_lost_frame(unit, tmp_path):
    recorded(unit, tmp_path / "own")
    lost = sorted((tmp_path / "own").glob("*.png"))[4]
    lost.unlink()
    told = run("import", "--frames", tmp_path / "own", "--rate", 30, "--start", 2, "--out", tmp_path / "set")
    times = [float(row["time"]) for row in rows(tmp_path / "set" / "run-01" / "camera.csv")]
    assert np.allclose(times, 2 + np.delete(np.arange(len(times) + 1), 4) / 30, atol=1e-12) and "1 numbers between" in told


@pytest.fixture
def image(tmp_path):
    (tmp_path / "images").mkdir()
    cv2.imwrite(str(tmp_path / "images" / "f1.png"), np.zeros((480, 640), np.uint8))
    return tmp_path / "images"


def test_what_is_wrong_is_named_with_what_would_be_right(image, tmp_path):
    out = ("--out", tmp_path / "set")
    said = run("import", "--frames", image, "--rate", 30, *out, status=2)
    assert "f1.png: 640 x 480 pixels" in said and "takes 512 x 512; add --set camera.width=640 --set camera.height=480" in said
    run("import", "--frames", image, "--rate", 30, "--set", "camera.width=640", "--set", "camera.height=480", *out)
    assert "--rate HZ, or --times FILE.csv" in run("import", "--frames", image, *out, status=2)
    assert "above 0" in run("import", "--frames", image, "--rate", 0, *out, status=2)
    assert "camera.treshold" in (said := run("import", "--frames", image, "--rate", 30, "--set", "camera.treshold=3", *out, status=2)) and "threshold" in said
    assert "at most 255" in run("import", "--frames", image, "--rate", 30, "--set", "camera.threshold=300", *out, status=2)
    table = tmp_path / "t.csv"
    table.write_text("time\n0\n0.1\n")
    assert "t.csv:3: 2 times for 1 frames" in run("import", "--frames", image, "--times", table, *out, status=2)
    table.write_text("t\n0\n")
    assert "t.csv:1: no column `time`" in run("import", "--frames", image, "--times", table, *out, status=2)
    table.write_text("time\nsoon\n")
    assert 't.csv:2: time = "soon"' in run("import", "--frames", image, "--times", table, *out, status=2)
    assert "--start NaN: expected" in run("import", "--frames", image, "--rate", 30, "--start", "nan", *out, status=2)
    assert "3 tables of times for 2 folders" in run("import", *("--frames", image) * 2, *("--times", table) * 3, *out, status=2)
    (image / "f1.png").write_bytes(b"no image")
    assert "f1.png: " in (said := run("import", "--frames", image, "--rate", 30, *out, status=2)) and "PNG, TIFF or JPEG" in said
    (tmp_path / "empty").mkdir()
    assert "no image; expected files that end in .png" in run("import", "--frames", tmp_path / "empty", "--rate", 30, *out, status=2)
    said = run("import", "--frames", image, "--fmu", "x.fmu", "--rate", 30, *out, status=2)
    assert "cannot be used with" in said


def test_an_image_of_gigabytes_is_refused_before_it_is_decoded(tmp_path):
    def part(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    (tmp_path / "images").mkdir()
    head = struct.pack(">IIBBBBB", 60000, 60000, 8, 0, 0, 0, 0)
    # Decoding would end in another error: there are no pixels.
    picture = b"\x89PNG\r\n\x1a\n" + part(b"IHDR", head) + part(b"IDAT", zlib.compress(b"")) + part(b"IEND", b"")
    (tmp_path / "images" / "f1.png").write_bytes(picture)
    said = run("import", "--frames", tmp_path / "images", "--rate", 30, "--out", tmp_path / "set", status=2)
    assert "f1.png: 60000 x 60000 pixels, but the camera of visual-servo takes 512 x 512" in said


def test_what_was_measured_is_kept_and_odd_names_make_no_lines(image, tmp_path):
    odd = image.rename(tmp_path / "images\n[evil]")
    words = ("import", "--frames", odd, "--rate", 30, "--set", "camera.width=640", "--set", "camera.height=480", "--out", tmp_path / "set")
    run(*words)
    manifest = tomllib.loads((tmp_path / "set" / "dataset.toml").read_text())
    assert manifest["run"] == [{"dir": "run-01"}] and "evil" not in manifest
    log = tmp_path / "set" / "run-01" / "camera.csv"
    log.write_text("measured")
    assert "camera.csv was there before" in run(*words)
    run(*words)
    assert (log.parent / "camera.csv.before").read_text() == "measured" and log.read_text().startswith("time,frame")
    assert sorted(path.name for path in log.parent.iterdir()) == ["camera.csv", "camera.csv.before"]


def test_a_lens_in_recorded_images_is_named(tmp_path):
    """Frames beside encoders and torques: what the images show is diagnosed as what the unit itself had logged."""
    hidden, folders = ("--set", "camera.k1=0.1"), []
    for name, start in (("one", 0.1), ("two", -0.08)):
        frames = ("--set", "camera.frames_every=1", "--set", f"camera.frames_dir={tmp_path / name}-frames")
        run("run", "visual-servo", *hidden, *frames, "--set", f"plant.q2_0={start}", "--stop", 8, "--out", tmp_path / name)
        folders += ["--frames", tmp_path / f"{name}-frames"]
    run("record", tmp_path / "one", tmp_path / "two", "--out", tmp_path / "set")
    before = rows(tmp_path / "set" / "run-01" / "camera.csv")
    run("import", *folders, "--rate", 30, "--out", tmp_path / "set")
    after = rows(tmp_path / "set" / "run-01" / "camera.csv")
    assert [float(row["u3"]) for row in before] == [float(row["u3"]) for row in after]
    run("diagnose", tmp_path / "set", "--out", tmp_path / "found")
    found = json.loads((tmp_path / "found" / "diagnosis.json").read_text())
    assert found["verdict"] == "named" and [effect["name"] for effect in found["effects"]] == ["camera.k1"]
    low, high = found["effects"][0]["ci95"]
    # 95 % intervals of one fixed case: as wide again on either side
    assert low - (high - low) / 2 <= 0.1 <= high + (high - low) / 2
