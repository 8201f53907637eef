"""What loggers do to a log: rows that are lost, sensors that drift."""

import csv
import json
import subprocess
from pathlib import Path

import numpy as np
import pytest

from . import sets
from .machines import ALL
from .unit_python import environment

PROGRAM = Path(__file__).resolve().parents[2] / "target" / "release" / "acroscope"


def diagnosed(folder, *options):
    command = [PROGRAM, "--quiet", "diagnose", folder, "--out", folder / "found", *options]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False, env=environment())
    assert done.returncode == 0, done.stderr
    return json.loads((folder / "found" / "diagnosis.json").read_text())


def made(name, case, seed, tmp_path):
    units = {name: ALL[name].build(ALL[name], tmp_path)}
    sets.make(ALL[name], case, seed, tmp_path / "set", tmp_path / "answers", units)
    return tmp_path / "set"


@pytest.mark.parametrize(("name", "command"), [("motor", "u_cmd"), ("cell", "i_cmd"), ("cabin", "P_a_cmd")])
def test_a_step_in_rows_that_were_lost_is_no_force(tmp_path, name, command):
    """Five rows are gone around the largest step of each run, and the command's first value after it with them. The cell's voltage
    follows its current at once; the cabin is simulated whole."""
    folder = made(name, "none", 51, tmp_path)
    for path in folder.glob("run-*.csv"):
        with path.open(newline="") as file:
            head, *rows = csv.reader(file)
        values = np.array([float(row[head.index(command)]) for row in rows])
        step = 20 + int(np.argmax(np.abs(np.diff(values[20:-20]))))
        kept = rows[: step - 1] + rows[step + 4 :]
        path.write_text("\n".join(",".join(row) for row in [head, *kept]) + "\n")
    found = diagnosed(folder)
    assert found["verdict"] == "none", [found["effects"], found["unknown"]]


def test_a_run_of_two_rows_is_left_out_and_told(tmp_path):
    folder = made("motor", "fc", 3, tmp_path)
    path = folder / "run-02.csv"
    path.write_text("".join(path.read_text().splitlines(keepends=True)[:3]))
    found = diagnosed(folder)
    assert [effect["name"] for effect in found["effects"]] == ["motor.fc"], found["effects"]
    assert any("run-02" in str(notice) and "left out" in str(notice) for notice in found["notices"]), found["notices"]


def test_a_step_in_an_empty_cell_is_no_force(tmp_path):
    """The command's first three values after each run's largest step weren't logged; the outputs were."""
    folder = made("motor", "none", 53, tmp_path)
    for path in folder.glob("run-*.csv"):
        with path.open(newline="") as file:
            head, *rows = csv.reader(file)
        place = head.index("u_cmd")
        values = np.array([float(row[place]) for row in rows])
        step = 21 + int(np.argmax(np.abs(np.diff(values[20:-20]))))
        for row in rows[step : step + 3]:
            row[place] = ""
        path.write_text("\n".join(",".join(row) for row in [head, *rows]) + "\n")
    found = diagnosed(folder)
    assert found["verdict"] == "none", [found["effects"], found["unknown"]]


def test_a_drift_counts_from_the_begin_of_the_run_in_the_gap_as_well(tmp_path):
    found = diagnosed(made("motor", "w:drift", 52, tmp_path))
    assert [effect["name"] for effect in found["effects"]] == ["motor.w:drift"]
    assert found["gap"]["closed"] > 0.9, found["gap"]


def test_how_rows_were_read_is_told_by_runs_in_which_the_input_jumps(tmp_path):
    """The cell's voltage follows its current at once. The first run ends before the current first changes, so that the rows that are
    searched first, without the last run, can't tell whether a row was read before its own current acted."""
    folder = made("cell", "none", 51, tmp_path)
    runs = sorted(folder.glob("run-*.csv"))
    with runs[0].open(newline="") as file:
        head, *rows = csv.reader(file)
    values = [row[head.index("i_cmd")] for row in rows]
    still = next(place for place, value in enumerate(values) if value != values[0])
    assert still > 8, "rows enough to be a run"
    runs[0].write_text("\n".join(",".join(row) for row in [head, *rows[:still]]) + "\n")
    text = (folder / "dataset.toml").read_text()
    top, *tables = text.split("[[run]]")
    (folder / "dataset.toml").write_text("[[run]]".join([top, *tables[:2]]))
    found = diagnosed(folder)
    assert found["verdict"] == "none", [found["effects"], found["unknown"]]


def test_a_command_that_no_unit_stands_is_told_by_its_cell(tmp_path):
    folder = made("motor", "none", 51, tmp_path)
    path = folder / "run-01.csv"
    with path.open(newline="") as file:
        head, *rows = csv.reader(file)
    rows[50][head.index("u_cmd")] = "1e300"
    path.write_text("\n".join(",".join(row) for row in [head, *rows]) + "\n")
    command = [PROGRAM, "--quiet", "diagnose", folder, "--out", folder / "found"]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False, env=environment())
    assert done.returncode == 2 and 'run-01.csv:52: column "u_cmd": 1e300' in done.stderr, done.stderr


def test_a_parameter_of_half_its_value_is_named_though_the_first_step_leaves_its_range(tmp_path):
    """A cell of half the heat capacity: a step along the derivative leads below zero, and with the noises that would fit there any place
    was better than the nominal one, so that the fit ended at the end of the range and the verdict was unknown."""
    found = diagnosed(made("cell", "C_th", 4423, tmp_path))
    assert [effect["name"] for effect in found["effects"]] == ["cell.C_th"], found["verdict"]
    # three of its standard deviations, a half interval being two
    low, high = found["effects"][0]["ci95"]
    assert abs(found["effects"][0]["value"] - 30.0) < 0.75 * (high - low), found["effects"]


@pytest.mark.parametrize("seed", [4412, pytest.param(4416, marks=pytest.mark.long)])
def test_a_damper_is_fitted_by_the_acceleration_that_it_makes(tmp_path, seed):
    """The states of a quarter car are read through its outputs, which hardly tell them apart and follow the damper themselves. What the
    damper does to the state was read from where the path is, not from where the state is: the fit ended within 3 % of the nominal value."""
    folder = made("car", "c_s", seed, tmp_path)
    truth = json.loads(next((tmp_path / "answers").glob("*.json")).read_text())["effects"][0]["value"]
    found = diagnosed(folder, "--fit", "car.c_s")
    low, high = found["effects"][0]["ci95"]
    # three of its standard deviations, a half interval being two
    assert abs(found["effects"][0]["value"] - truth) < 0.75 * (high - low), (truth, found["effects"])
    assert found["verdict"] == "named", found["verdict"]


@pytest.mark.parametrize("name", ["motor", "drive", "valve"])
def test_timestamps_that_scatter_are_no_missing_effect(tmp_path, name):
    """Each row's time is off by a twentieth of a row. A held command that steps at such a row acts so much later or earlier, which the states
    remember from there on: all three were unknown, with events at the steps. States of two of them are read through the rows that follow."""
    folder, random = made(name, "none", 57, tmp_path), np.random.default_rng(7)
    for path in sorted(folder.glob("run-*.csv")):
        with path.open(newline="") as file:
            head, *rows = csv.reader(file)
        times = np.array([float(row[0]) for row in rows])
        times[1:] += 0.05 * np.median(np.diff(times)) * random.standard_normal(len(times) - 1)
        stamped = [[f"{time:.9g}", *row[1:]] for time, row in zip(times, rows, strict=True)]
        path.write_text("\n".join(",".join(row) for row in [head, *stamped]) + "\n")
    found = diagnosed(folder)
    assert found["verdict"] == "none", [found["effects"], found["unknown"]]
