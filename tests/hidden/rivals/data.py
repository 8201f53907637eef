"""What a rival may know of a data set: its logs, its nominal model, its noise where stated, and the names to choose from."""

import csv
import tomllib
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..effects import CAMERA_NOMINAL, LISTED, PLANT_NOMINAL

PLANT_COLUMNS = ("q1", "q2", "dq1", "dq2", "tau_applied")  # the order of a node of dynamics.simulate


@dataclass
class Run:
    commands: np.ndarray  # time, tau, tau_1
    plant_time: np.ndarray
    plant: np.ndarray  # PLANT_COLUMNS, NaN where not measured
    frame_time: np.ndarray  # of valid frames
    frames: np.ndarray  # n x 3 x (area, u, v), as camera.take has them
    rows: int = 0  # delivered frames, valid or not
    lost: int = 0  # frames that the spacing of the rows lacks


@dataclass
class Data:
    runs: list
    plant: dict  # nominal
    camera: dict
    noise: dict  # stated standard deviations, by column of the plant
    candidates: list = field(default_factory=list)

    @property
    def has_frames(self):
        return any(len(r.frames) for r in self.runs)

    @property
    def has_plant(self):
        return any(len(r.plant) for r in self.runs)

    @property
    def pinned(self):
        return self.plant["theta_2"] == 0.0 and self.plant["theta_7"] == 0.0

    def off(self, effect):
        return (self.plant if effect.side == "plant" else self.camera)[effect.key]


def _columns(file, names):
    """Columns of a CSV as arrays; NaN for empty cells and missing columns."""
    if not file.exists():
        return {name: np.zeros(0) for name in names}
    with file.open() as f:
        rows = list(csv.DictReader(f))
    return {name: np.array([float(r.get(name) or "nan") for r in rows]) for name in names}


def _even(times):
    """Evenly spaced stamps where the rows are and only the stamps jitter (a lab's logger has a fixed rate)."""
    if len(times) < 10:
        return times
    k = np.arange(len(times))
    line = np.polynomial.Polynomial.fit(k, times, 1)(k)
    off = np.abs(times - line)
    return line if 1e-5 < off.max() < 1.5 * np.median(np.diff(times)) else times


def _run(folder, camera):
    c = _columns(folder / "controller.csv", ("time", "tau", "tau_1"))
    p = _columns(folder / "plant.csv", ("time", *PLANT_COLUMNS))
    names = [[f"area{i}", f"u{i}", f"v{i}"] for i in (1, 2, 3)]
    f = _columns(folder / "camera.csv", ("time", "valid", *sum(names, [])))
    seen = np.stack([np.column_stack([f[n] for n in circle]) for circle in names], axis=1)
    good = np.all(np.isfinite(seen), axis=(1, 2)) & (f["valid"] != 0.0)
    gaps = np.round(np.diff(f["time"]) * camera["omega_cam"]) - 1.0
    return Run(np.column_stack([_even(c["time"]), c["tau"], np.nan_to_num(c["tau_1"])]), _even(p["time"]),
               np.column_stack([p[k] for k in PLANT_COLUMNS]), f["time"][good], seen[good], len(f["time"]),
               int(np.maximum(gaps, 0.0).sum()))


def load(folder, without=()):
    """Reads a data set folder (CONTRACT.md, section 5); `without`: names that may not be given."""
    folder = Path(folder)
    head = tomllib.loads((folder / "dataset.toml").read_text())
    plant, camera = dict(PLANT_NOMINAL), dict(CAMERA_NOMINAL)
    for name, value in head.get("set", {}).items():
        side, key = name.split(".", 1)
        (plant if side == "plant" else camera)[key] = float(value)
    noise = {k.split(".")[1]: float(v) for k, v in head.get("noise", {}).items() if k.startswith("plant.")}
    data = Data([_run(folder / r["dir"], camera) for r in head["run"]], plant, camera, noise)
    data.candidates = [e for e in LISTED if e.name not in without and _possible(e, data)]
    return data


def _possible(effect, data):
    """Nobody looks for the camera's effects without a camera, nor for a drum on ground where an arm is pinned."""
    if effect.side == "camera":
        return data.has_frames
    return not (data.pinned and effect.key in ("slope", "theta_2", "theta_7"))
