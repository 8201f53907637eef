"""An amended scenario runs in the product and in FMPy: it follows the run that it came from, and one that no diagnosis saw."""

import csv
import dataclasses
import json
import subprocess
import tomllib
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from . import sets
from .machines import ALL
from .replay import closed
from .replay import run as replayed
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
        place = behind[0] if one.name == "phi" and behind else names.index(machine.full(one.name))
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


def test_amended_with_a_force_that_nobody_lists(tmp_path):
    """A window that was opened five times: the power that would have done the same is part of what the scenario feeds."""
    machine = dataclasses.replace(ALL["house"], runs=2, duration=30_000.0)
    units = {"house": machine.build(machine, tmp_path)}
    sets.make(machine, "door", 3, tmp_path / "set", tmp_path / "answers", units)
    run("diagnose", tmp_path / "set", "--out", tmp_path / "said")
    said = json.loads((tmp_path / "said" / "diagnosis.json").read_text())
    assert said["verdict"] == "unknown"
    assert any("adds the unlisted input to house.P_a" in line for line in said["story"]), said["story"]
    run("run", tmp_path / "said" / "amended.toml", "--out", tmp_path / "run")
    # the course follows a part of the noise, too; its edges are smoothed over a row or two
    assert max(misses(machine, tmp_path / "set", tmp_path / "run" / "results.csv")) < 1.5
    # FMPy is fed the same table: written half a step late, for masters that read a source at a step's end
    scenario = tomllib.loads((tmp_path / "said" / "amended.toml").read_text())
    head, rows = table(tmp_path / "said" / "inputs.csv")
    late = 0.5 * float(Fraction(str(scenario["units"][0]["interval"])))
    fed = {source["to"]: (rows[:, 0] - late, rows[:, head.index(source["column"])], "zero") for source in scenario["sources"]}
    columns, log = table(tmp_path / "set" / "run-01.csv")
    times = (log[:, 0] - log[0, 0]) * (1e-3 if columns[0] == "t" else 1.0)
    names = [machine.full(one.name) for one in machine.outputs_of]
    found = replayed(scenario, [tmp_path / "said", tmp_path / "set", ROOT / "target" / "fmus"], fed, {}, names, times)
    for one, name in zip(machine.outputs_of, names, strict=True):
        measured = one.log[0] * log[:, columns.index(one.name)] + one.log[1]
        assert np.sqrt(np.mean(np.square((measured - found[name]) / one.noise))) < 1.5, one.name


def test_no_inputs_of_an_earlier_diagnosis_stay(tmp_path):
    machine = dataclasses.replace(ALL["motor"], runs=1, duration=2.0)
    units = {"motor": machine.build(machine, tmp_path)}
    sets.make(machine, "none", 3, tmp_path / "set", tmp_path / "answers", units)
    for name in ("inputs.csv", "inputs_lines.csv", "next_experiment.toml"):
        (tmp_path / "said").mkdir(exist_ok=True)
        (tmp_path / "said" / name).write_text("old")
    run("diagnose", tmp_path / "set", "--out", tmp_path / "said")
    assert (tmp_path / "said" / "inputs.csv").read_text() != "old"
    assert not (tmp_path / "said" / "inputs_lines.csv").exists()
    assert not (tmp_path / "said" / "next_experiment.toml").exists()
