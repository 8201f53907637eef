"""An amended scenario runs in the product and in FMPy: it follows the run that it came from, and one that no diagnosis saw."""

import csv
import dataclasses
import json
import subprocess
from pathlib import Path

import numpy as np
import pytest

from . import sets
from .machines import ALL
from .replay import closed
from .unit_python import environment

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "target" / "release" / "acroscope"


def run(*arguments):
    done = subprocess.run([PROGRAM, "--quiet", *map(str, arguments)], capture_output=True, text=True, check=False, env=environment())
    assert done.returncode == 0, done.stderr


def table(path):
    with path.open() as file:
        rows = list(csv.reader(file))
    return rows[0], np.array([[float(cell or "nan") for cell in row] for row in rows[1:]])


def misses(machine, folder, results):
    """Root mean square of log minus simulation for each output, in sensor deviations: of the first run."""
    head, log = table(folder / "run-01.csv")
    times = (log[:, 0] - log[0, 0]) * (1e-3 if head[0] == "t" else 1.0)
    names, found = table(results)
    for one in machine.outputs_of:
        behind = [place for place, name in enumerate(names) if name.startswith("output_effects_") and name.endswith(".y")]
        place = behind[0] if one.name == "phi" and behind else names.index(f"{machine.name}.{one.name}")
        measured = one.log[0] * log[:, head.index(one.name)] + one.log[1]
        yield float(np.sqrt(np.mean(np.square((measured - np.interp(times, found[:, 0], found[:, place])) / one.noise))))


@pytest.mark.parametrize("case", ["u:delay", "phi:gain"])
def test_amended(case, tmp_path):
    machine = dataclasses.replace(ALL["motor"], runs=2, duration=3.0)
    units = {"motor": machine.build(machine, tmp_path)}
    sets.make(machine, case, 3, tmp_path / "set", tmp_path / "answers", units)
    answer = json.loads((tmp_path / "answers" / "set.json").read_text())
    run("diagnose", tmp_path / "set", "--out", tmp_path / "said")
    said = json.loads((tmp_path / "said" / "diagnosis.json").read_text())
    assert [effect["name"] for effect in said["effects"]] == [f"motor.{case}"], said["effects"]
    # what is left to close by the truth is nothing; a delay is met to a fortieth of a row, half of it a step of the finer interval
    assert closed(tmp_path / "set", tmp_path / "said" / "amended.toml", answer) > 0.95
    run("run", tmp_path / "said" / "amended.toml", "--out", tmp_path / "run")
    # 301 values of noise scatter by 4 %; jumps of a delayed input are off by a fortieth of a row
    assert max(misses(machine, tmp_path / "set", tmp_path / "run" / "results.csv")) < 1.25
