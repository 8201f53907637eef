"""Pictures and the table of docs/camera.md, made by the camera unit itself through FMPy.

For each effect: the circle at the tip as the camera sees it without and with the effect, eight times as large, and how far the three
centroids move. `scripts/book.py` asks for it.
"""

import struct
import tempfile
import zlib
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

ROOT = Path(__file__).resolve().parent.parent
CAMERA = ROOT / "target" / "fmus" / "acrobot_camera.fmu"
POSE = {"q1": -0.35, "q2": 0.9, "dq1": 0.6, "dq2": -2.0}  # leaning, and swinging, so that a long exposure shows
INTERVAL = 1.0 / 30.0  # s, the unit's own rate
HALF, SCALE = 12, 8  # px on each side of the tip; how often each is drawn

# name, values, the sentence beside the picture
EFFECTS = [
    ("k1", {"k1": 0.05}, "radial distortion, third order: eq. (3)"),
    ("k2", {"k2": 0.2}, "radial distortion, fifth order"),
    ("p1", {"p1": 0.02}, "decentering along u: eqs. (5), (6)"),
    ("p2", {"p2": 0.02}, "decentering along v: eqs. (5), (6)"),
    ("s1", {"s1": 0.02}, "thin prism along u: eqs. (7), (8)"),
    ("s2", {"s2": 0.02}, "thin prism along v: eqs. (7), (8)"),
    ("beta", {"beta": 3.0}, "vignetting: light falls off towards the edge, eq. (11), and the circle shrinks at the threshold"),
    ("N", {"N": 3}, "defocus: three passes of the mask"),
    ("E_t", {"E_t": 0.5}, "a shutter that is open for half of the interval smears a circle that moves"),
    ("sigma", {"sigma": 25.0}, "noise of 25 grey levels"),
    ("roll", {"roll": 0.02}, "the camera turned about its axis"),
    ("pan", {"pan": 0.005}, "the camera's axis turned towards +u"),
    ("tilt", {"tilt": 0.005}, "the camera's axis turned towards +v"),
    ("u0", {"u0": 0.01}, "principal point off along u"),
    ("v0", {"v0": 0.01}, "principal point off along v"),
    ("scale", {"scale": 1.01}, "a focal length that is off by 1 %"),
]


def frame(values, folder):
    """(picture, centroids) of frame 1 of a camera that sees the arm pass POSE at mid-exposure of its ideal shutter."""
    description = read_model_description(str(CAMERA))
    variables = {v.name: v for v in description.modelVariables}
    unit = FMU2Slave(guid=description.guid, unzipDirectory=extract(str(CAMERA)), instanceName="book",
                     modelIdentifier=description.coSimulation.modelIdentifier)
    unit.instantiate()

    def put(name, value):
        kind = variables[name].type
        cast = {"Real": float, "Integer": int, "Boolean": bool, "String": str}[kind]
        getattr(unit, "set" + kind)([variables[name].valueReference], [cast(value)])

    unit.setupExperiment(startTime=0.0)
    for name, value in {**values, "frames_dir": str(folder)}.items():
        put(name, value)
    unit.enterInitializationMode()
    arm(put, -INTERVAL)
    unit.exitInitializationMode()
    arm(put, 0.0)  # the pose at the end of the step: Gauss-Seidel
    unit.doStep(0.0, INTERVAL)
    seen = [unit.getReal([variables[n].valueReference])[0] for n in ("u1", "v1", "u2", "v2", "u3", "v3")]
    valid = unit.getBoolean([variables["valid"].valueReference])[0]
    unit.terminate()
    unit.freeInstance()
    files = sorted(Path(folder).glob("*.png"))
    return read_grey(files[-1]), (np.array(seen).reshape(3, 2) if valid else None)


def arm(put, after):
    """The pose so long after POSE, at its rates."""
    for angle, rate in (("q1", "dq1"), ("q2", "dq2")):
        put(angle, POSE[angle] + after * POSE[rate])
        put(rate, POSE[rate])


def read_grey(file):
    """A PNG of 8 bit grey without interlacing, which is what the unit writes."""
    import cv2

    return cv2.imread(str(file), cv2.IMREAD_GRAYSCALE)


def write_grey(file, picture):
    """A PNG with the same bytes on every machine."""
    height, width = picture.shape
    rows = b"".join(b"\0" + row.tobytes() for row in picture)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    file.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def cut(picture, centre):
    """The neighbourhood of a place (pixels from the middle, v up), enlarged."""
    column, row = int(round(picture.shape[1] / 2 + centre[0])), int(round(picture.shape[0] / 2 - centre[1]))
    part = picture[row - HALF : row + HALF, column - HALF : column + HALF]
    return np.kron(part, np.ones((SCALE, SCALE), dtype=np.uint8))


def make(docs):
    """The table, as text; its pictures go to `docs`/figures/camera."""
    folder = docs / "figures" / "camera"
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        def taken(name, values):
            here = Path(scratch) / name
            here.mkdir()
            return frame(values, here)

        plain, at = taken("nominal", {})
        lines = ["| | without, with | joint moves (px) | tip moves (px) | |", "|---|---|---|---|---|"]
        for name, values, words in EFFECTS:
            picture, seen = taken(name, values)
            gap = np.full((2 * HALF * SCALE, SCALE), 128, dtype=np.uint8)
            write_grey(folder / f"{name}.png", np.hstack([cut(plain, at[2]), gap, cut(picture, at[2])]))
            told = ", ".join(f"`{k}` = {v:g}" for k, v in values.items())
            moved = ["lost", "lost"] if seen is None else ["{:+.2f}, {:+.2f}".format(*(seen[k] - at[k] + 0.0)) for k in (1, 2)]
            lines.append(f"| {told} | ![{name}](figures/camera/{name}.png) | {moved[0]} | {moved[1]} | {words} |")
    return "\n" + "\n".join(lines) + "\n"
