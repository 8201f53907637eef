"""What a rival may know of a data set: its logs, nominal model and stated noise, and which effects to try at which sizes."""

import csv
import tomllib
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..effects import CAMERA_NOMINAL, LISTED, PLANT_NOMINAL, Effect
from .maker import Maker

PLANT_COLUMNS = ("q1", "q2", "dq1", "dq2", "tau_applied")  # the order of a node of dynamics.simulate
CLOCK = Effect("clock.offset", 0.0, 5e-4, 0.0)  # a nuisance where plant and camera are logged: never named
RENDERED = ("beta", "N", "E_t")  # effects that no projected outline knows
TIMES = ("T_act", "tau_delay", "T_delay")  # slopes are taken near zero: a late torque soon leaves the straight line
INTEGERS = {"N": (1.0, 2.0, 4.0), "beta": (1.0, 3.0, 8.0)}
QUANTILES = (0.3, 0.5, 0.7, 0.85, 0.93, 0.97, 0.99)  # of the torque, where its limit is tried
PARTS = (0.5, 0.65, 0.8, 0.9, 0.97)  # of the largest torque, too
RATES = (0.5, 2.0, 7.0, 20.0, 60.0, 200.0, 600.0, 2000.0)  # 1/s, of a large step of the torque


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
    world: object = field(default_factory=Maker)  # whose machine and camera predict

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
    pace = np.median(np.diff(times))
    gaps = np.maximum(np.round(np.diff(times) / pace), 1.0)  # lost frames leave no row
    for k in (np.arange(len(times)), np.concatenate([[0.0], np.cumsum(gaps)])):
        line = np.polynomial.Polynomial.fit(k, times, 1)(k)
        off = np.abs(times - line).max()
        if off < 1.5 * pace:
            return line if off > 1e-5 else times
    return times


def _run(folder, camera):
    c = _columns(folder / "controller.csv", ("time", "tau", "tau_1"))
    p = _columns(folder / "plant.csv", ("time", *PLANT_COLUMNS))
    names = [[f"area{i}", f"u{i}", f"v{i}"] for i in (1, 2, 3)]
    f = _columns(folder / "camera.csv", ("time", "valid", *sum(names, [])))
    seen = np.stack([np.column_stack([f[n] for n in circle]) for circle in names], axis=1)
    good = np.all(np.isfinite(seen), axis=(1, 2)) & (f["valid"] != 0.0)
    taken = _even(f["time"])
    gaps = np.round(np.diff(taken) * camera["omega_cam"]) - 1.0
    return Run(np.column_stack([_even(c["time"]), c["tau"], np.nan_to_num(c["tau_1"])]), _even(p["time"]),
               np.column_stack([p[k] for k in PLANT_COLUMNS]), taken[good], seen[good], len(f["time"]),
               int(np.maximum(gaps, 0.0).sum()))


def load(folder, without=(), world=None):
    """Reads a data set folder (docs/data-set.md); `without`: names that may not be given; world: who predicts."""
    folder = Path(folder)
    head = tomllib.loads((folder / "dataset.toml").read_text())
    plant, camera = dict(PLANT_NOMINAL), dict(CAMERA_NOMINAL)
    for name, value in head.get("set", {}).items():
        side, key = name.split(".", 1)
        (plant if side == "plant" else camera)[key] = float(value)
    noise = {k.split(".")[1]: float(v) for k, v in head.get("noise", {}).items() if k.startswith("plant.")}
    data = Data([_run(folder / r["dir"], camera) for r in head["run"]], plant, camera, noise, world=world or Maker())
    data.candidates = [e for e in LISTED if e.name not in without and _possible(e, data)]
    return data


def _possible(effect, data):
    """Nobody looks for the camera's effects without a camera, nor for a drum on ground where an arm is pinned."""
    if effect.side == "camera":
        return data.has_frames
    return not (data.pinned and effect.key in ("slope", "theta_2", "theta_7"))


def probe(effect, value, off):
    if effect.key in TIMES:
        return 2e-4
    if effect.key.startswith("theta"):
        return 0.01 * abs(off)
    return -0.03 * value if effect.shape == "limit" else effect.probe


def limits(effect, data):
    """Levels at which a limit of the torque or of its rate is tried."""
    torque = [r.commands[:, 1] for r in data.runs if len(r.commands) > 1]
    if not torque:
        return []
    if effect.key == "tau_max":
        size = np.abs(np.concatenate(torque))
        return sorted({*np.quantile(size, QUANTILES), *(x * size.max() for x in PARTS)} - {0.0})
    step = np.quantile(np.abs(np.concatenate([np.diff(c) for c in torque])), 0.98)
    return [x * step for x in RATES] if step > 0.0 else []


def trials(effect, off, data):
    """Values of an effect without a slope at its neutral value: limits, integers, switches."""
    if effect.shape == "switch":
        return [1.0 - off]
    return list(INTEGERS[effect.key]) if effect.shape == "integer" else limits(effect, data)
