"""Logs that others measured, of machines of which nobody knows all: `examples/pendulum`, `examples/heater`."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy import optimize, signal

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "target" / "release" / "acroscope"
EXAMPLES = ROOT / "examples"
sys.path.insert(0, str(EXAMPLES))
from real import REAL  # noqa: E402


def program(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout + done.stderr


@pytest.fixture(scope="module")
def diagnosed(tmp_path_factory):
    """`diagnosed(name)`: what `import` said, and the diagnosis of an example's logs."""
    known = {}

    def of(name):
        if name not in known:
            folder = tmp_path_factory.mktemp(name)
            fmu = REAL[name].build(REAL[name], folder)
            logs = sorted((EXAMPLES / name / "logs").glob("*.csv"))
            said = program("import", *logs, "--fmu", fmu, "--out", folder / "data")
            program("--quiet", "diagnose", folder / "data", "--out", folder / "out")
            known[name] = said, json.loads((folder / "out" / "diagnosis.json").read_text())
        return known[name]

    return of


def named(diagnosis, *names):
    """The effect that is one of these, or may be."""
    found = [effect for effect in diagnosis["effects"] if set(effect["class"]) & set(names)]
    assert len(found) == 1, diagnosis["effects"]
    return found[0]


def regressed(path):
    """Coulomb friction and delay of a pendulum by regression of the torque, filtered, on what moves: no state space, no likelihood."""
    log = np.genfromtxt(path, delimiter=",", names=True)
    row = np.median(np.diff(log["time"]))
    times = np.arange(log["time"][0], log["time"][-1], row)
    q, w, torque = (np.interp(times, log["time"], log[name]) for name in ("position", "velocity", "torque"))
    b, a = signal.butter(3, 15.0, fs=1 / row)
    q, w = signal.filtfilt(b, a, q), signal.filtfilt(b, a, w)
    columns = np.c_[np.gradient(w, row), np.sin(q), w, np.tanh(w / 0.05), np.ones_like(q)]
    inner, found = slice(40, -40), []
    for late in range(31):
        fed = signal.filtfilt(b, a, np.roll(torque, late))[inner]
        amounts, left = np.linalg.lstsq(columns[inner], fed, rcond=None)[:2]
        found.append((left[0], late * row, amounts[3]))
    return min(found)[1:]


def test_friction_of_a_pendulum_is_that_of_a_regression(diagnosed):
    said, diagnosis = diagnosed("pendulum")
    assert said.count("sign as logged") == 3, said
    delay, friction = regressed(EXAMPLES / "pendulum" / "logs" / "ddp.csv")
    # two ways that treat the same noise differently: 0.18 and 0.20 N.m
    assert abs(named(diagnosis, "pendulum.fc")["value"] / friction - 1) < 0.25
    # late by 18 ms, says the regression; beside what has no name the scatter of timestamps does as much as a delay
    assert diagnosis["verdict"] == "unknown" and len(diagnosis["effects"]) == 1
    assert delay > 0.01


def test_what_a_pendulum_lacks_follows_it_on_a_log_that_was_left_out(diagnosed):
    gap = diagnosed("pendulum")[1]["gap"]
    assert gap["held_out_runs"] == ["run-02.csv"] and gap["closed"] > 0.5, gap


def least_squares():
    """U, alpha_1, alpha_2 of the heaters as the authors of these logs fit them: a whole run, no lag, no noise but the sensors'."""
    time, *heat, one, two = np.loadtxt(EXAMPLES / "heater" / "logs" / "steps.csv", delimiter=",", skiprows=1)[:, :5].T

    def off(values):
        u, *powers = values
        air, seen = 296.15, 0.9 * 5.67e-8
        at, left = np.array([one[0], two[0]]) + 273.15, []
        for row in range(len(time)):
            left += [at[0] - 273.15 - one[row], at[1] - 273.15 - two[row]]
            step = (time[min(row + 1, len(time) - 1)] - time[row]) / 4
            for _ in range(4):
                over = 2e-4 * (u * (at[1] - at[0]) + seen * (at[1] ** 4 - at[0] ** 4))
                loss = 1e-3 * (u * (air - at) + seen * (air**4 - at**4)) + np.array([over, -over])
                at = at + step / 2.0 * (loss + np.array([powers[0] * heat[0][row], powers[1] * heat[1][row]]))
        return np.array(left)

    return optimize.least_squares(off, [10.0, 0.01, 0.0075], x_scale=[1.0, 1e-3, 1e-3]).x


def test_heaters_lack_what_the_authors_of_their_logs_fit(diagnosed):
    said, diagnosis = diagnosed("heater")
    assert 'column "Temperature 1 (degC)" by the same unit of measurement and number' in said, said
    u, *powers = least_squares()
    # a fit without the lag, which takes a part of what the powers do: they differ by an eighth
    assert abs(named(diagnosis, "heater.U")["value"] / u - 1) < 0.25
    for place, (power, start) in enumerate(zip(powers, (0.01, 0.0075), strict=True), 1):
        found = named(diagnosis, f"heater.alpha_{place}", f"heater.Q{place}:gain")
        value = found["value"] * (start if found["name"].endswith(":gain") else 1.0)
        assert abs(value / power - 1) < 0.25, found
    # their later models give the heater a lag of 15 to 30 s
    assert 10.0 < named(diagnosis, "heater.Q1:lag")["value"] < 30.0


def turned(name):
    """A log of the pendulum with the torque's sign turned."""
    head, *lines = (EXAMPLES / "pendulum" / "logs" / name).read_text().splitlines()
    return "\n".join([head, *(f"{line.rsplit(',', 1)[0]},{-float(line.rsplit(',', 1)[1])}" for line in lines), ""])


def test_a_turned_sign_is_told_though_the_model_drifts_off(tmp_path):
    (tmp_path / "log.csv").write_text(turned("ddp.csv"))
    fmu = REAL["pendulum"].build(REAL["pendulum"], tmp_path)
    program("import", tmp_path / "log.csv", "--fmu", fmu, "--out", tmp_path / "data")
    text = (tmp_path / "data" / "dataset.toml").read_text()
    assert "sign turned" in text.split('variable = "pendulum.torque"')[0], text


def test_a_turned_sign_is_refused_though_a_gain_is_off_as_well(tmp_path):
    fmu = REAL["pendulum"].build(REAL["pendulum"], tmp_path)
    program("import", EXAMPLES / "pendulum" / "logs" / "direct-collocation.csv", "--fmu", fmu, "--out", tmp_path / "data")
    (tmp_path / "data" / "run-01.csv").write_text(turned("direct-collocation.csv"))
    done = subprocess.run([PROGRAM, "diagnose", tmp_path / "data", "--out", tmp_path / "out"], capture_output=True, text=True, check=False)
    assert done.returncode == 2 and "only with the sign of pendulum.torque" in done.stderr, done.stderr
