"""What tests of `acroscope import` share: the program, a log with heads of one's own, what it wrote."""

import subprocess
import tomllib
from pathlib import Path

import numpy as np

from . import excite
from .simulate import simulate, variants
from .unit_python import environment

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "target" / "release" / "acroscope"


def run(*arguments, status=0):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False, env=environment())
    assert done.returncode == status, done.stderr
    return done.stdout + done.stderr


def log(path, machine, columns, separator=",", time=("time", 1.0), change=None, gap=False):
    """A log whose columns are {variable: (head, scale, offset)} with model = scale * log + offset."""
    rng = np.random.default_rng(11)
    times = machine.row * np.arange(300)
    commands, start = excite.commands(machine, times, rng), excite.start(machine, rng)
    clean = simulate(machine, variants(machine, [change or {}]), times, commands, start)
    values = commands | {one.name: clean[one.name][:, 0] + one.noise * rng.normal(size=len(times)) for one in machine.outputs_of}
    numbers = [times / time[1], *((values[name] - offset) / scale for name, (_, scale, offset) in columns.items())]
    rows = [row for place, row in enumerate(zip(*numbers, strict=True)) if not gap or not 100 < place < 120]
    text = "\n".join(separator.join(f"{value:.7g}" for value in row) for row in rows)
    text = text if separator == "," else text.replace(".", ",")
    path.write_text(separator.join([time[0], *(head for head, *_ in columns.values())]) + "\n" + text + "\n")
    return path


def channels(folder):
    head = tomllib.loads((folder / "dataset.toml").read_text())
    return {entry["variable"]: entry for entry in head["channel"]}, head
