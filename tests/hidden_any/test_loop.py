"""Machines that fall over without the loop that holds them: a ball under a magnet, and a rotor between two, of which only the position is
measured. Commands are made of measured values, row by row, and held until the next."""

import json
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from .machine import Input, Machine, Output, Parameter, State
from .unit_c import build
from .unit_python import environment

PROGRAM = Path(__file__).resolve().parents[2] / "target" / "release" / "acroscope"
ROW, ROWS, SUBSTEPS = 1e-3, 1500, 5


def machine(name, states, inputs, outputs, parameters):
    return Machine(name=name, states=states, inputs=inputs, outputs_of=outputs, parameters=parameters, rhs=None, outputs=None,
                   row=ROW, substeps=SUBSTEPS, duration=ROW * ROWS, build=None, step=1e-4)  # fmt: skip


@dataclass
class Loop:
    """A machine with its equations twice: in C for the unit, in Python for the truth. `control(y, before, dither)` is the loop's."""

    machine: Machine
    code: str
    shown: str
    rhs: object
    outputs: object
    control: object
    start: object
    measured: dict


ROTOR = Loop(
    machine("rotor", (State("y", "m", "y_0", 0.0, 0.0), State("w", "m/s", "w_0", 0.0, 0.0)), (Input("ic", "A", 0.0, 1.0, "A"),),
            (Output("y", "m", 1e-6, "mm"),),
            (Parameter("m", "kg", 2.0, 0.2, 20.0, "relative", "mass of the rotor", 1.0),
             Parameter("k", "1", 5e-6, 5e-7, 1e-4, "relative", "force constant of the coils", 1.0),
             Parameter("load", "N", 0.0, -40.0, 40.0, "absolute", "static load", 1.0),
             Parameter("d", "N.s/m", 0.0, 0.0, 500.0, "absolute", "damping by eddy currents", 1.0))),
    """const double a = (2.0 + v[ic]) / (1e-3 - x[0]), b = (2.0 - v[ic]) / (1e-3 + x[0]);
    dx[0] = x[1];
    dx[1] = (v[k] * (a * a - b * b) + v[load] - v[d] * x[1]) / v[m];""",
    "v[y] = x[0];",
    lambda x, u, p: np.array([x[1], (p["k"] * (((2 + u) / (1e-3 - x[0])) ** 2 - ((2 - u) / (1e-3 + x[0])) ** 2) + p["load"] - p["d"] * x[1]) / p["m"]]),
    lambda x: {"y": x[0]},
    lambda y, before, dither: -4000.0 * (y["y"] - 5e-5 * dither[0]) - 20.0 * (y["y"] - before["y"]) / ROW + 0.1 * dither[1],
    lambda rng: [3e-5 * rng.normal(), 0.0],
    {"y": 1e-6},
)  # fmt: skip

BALL = Loop(
    machine("ball", (State("z", "m", "z_0", 0.0218, 0.0), State("w", "m/s", "w_0", 0.0, 0.0), State("i", "A", "i_0", 1.0, 0.0)),
            (Input("u", "V", 2.0, 1.0, "V"),), (Output("z", "m", 2e-5, "mm"), Output("i", "A", 5e-3, "A")),
            (Parameter("m", "kg", 0.1, 0.01, 1.0, "relative", "mass of the ball", 1.0),
             Parameter("R", "Ohm", 2.0, 0.2, 20.0, "relative", "resistance of the coil", 1.0),
             Parameter("L", "H", 0.01, 1e-3, 0.2, "relative", "inductance of the coil", 1.0),
             Parameter("b", "N.s/m", 0.0, 0.0, 5.0, "absolute", "viscous friction of the ball", 1.0))),
    """const double r = x[2] / x[0];
    dx[0] = x[1];
    dx[1] = 9.81 + (-4.662e-4 * r * r - v[b] * x[1]) / v[m];
    dx[2] = (v[u] - v[R] * x[2]) / v[L];""",
    "v[z] = x[0]; v[i] = x[2];",
    lambda x, u, p: np.array([x[1], 9.81 + (-4.662e-4 * (x[2] / x[0]) ** 2 - p["b"] * x[1]) / p["m"], (u - p["R"] * x[2]) / p["L"]]),
    lambda x: {"z": x[0], "i": x[2]},
    lambda y, before, dither: 2.0 + 40.0 * (1.0 + 90.0 * (y["z"] - 0.0218 - 1e-3 * dither[0]) + 3.0 * (y["z"] - before["z"]) / ROW - y["i"]) * 0.5 + 0.2 * dither[1],
    lambda rng: [0.0218 + 5e-4 * rng.normal(), 0.0, 1.0],
    {"z": 2e-5, "i": 5e-3},
)  # fmt: skip


def steps(rng, rows, low, high):
    """Values between -1 and 1, each held over `low` to `high` rows."""
    found = []
    while len(found) < rows:
        found += [rng.uniform(-1, 1)] * rng.integers(low, high)
    return found


def logged(loop, seed, change, bias):
    """One run: the columns of its log."""
    rng = np.random.default_rng(seed)
    p = loop.machine.nominal() | change
    x, before, rows = np.array(loop.start(rng)), None, []
    dither = list(zip(steps(rng, ROWS, 60, 300), steps(rng, ROWS, 5, 25), strict=False))
    (fed,) = loop.machine.inputs
    for row in range(ROWS):
        y = {name: value + loop.measured[name] * rng.normal() for name, value in loop.outputs(x).items()}
        u = float(np.clip(loop.control(y, before or y, dither[row]), fed.rest - 1.9, fed.rest + 9.0 if fed.rest else 1.9))
        rows.append({"time": row * ROW, **y, fed.name: u})
        before, h, acting = y, ROW / SUBSTEPS, u + bias
        for _ in range(SUBSTEPS):
            k1 = loop.rhs(x, acting, p)
            k2 = loop.rhs(x + h / 2 * k1, acting, p)
            k3 = loop.rhs(x + h / 2 * k2, acting, p)
            x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + loop.rhs(x + h * k3, acting, p))
    assert np.all(np.isfinite(x)), "the loop doesn't hold it"
    return rows


def made(loop, folder, change=None, bias=0.0):
    """A data set of two runs."""
    folder.mkdir(parents=True, exist_ok=True)
    name, one = loop.machine.name, loop.machine
    unit = build(one, folder, loop.code, loop.shown, one.step)
    lines = ["format = 2", f'fmu = "{Path(unit).name}"']
    for channel in (*one.inputs, *one.outputs_of):
        lines += ["[[channel]]", f'variable = "{name}.{channel.name}"', f'column = "{channel.name}"']
        lines += [] if channel in one.inputs else [f"noise = {channel.noise}"]
    shown = {output.name for output in one.outputs_of}
    for state in one.states:
        lines += ["[[state]]", f'start = "{name}.{state.start}"', *([f'shows = "{name}.{state.name}"'] if state.name in shown else [])]
    for parameter in one.parameters:
        lines += ["[[candidate]]", f'variable = "{name}.{parameter.name}"', f'scale = "{parameter.scale}"']
    for run in (1, 2):
        rows = logged(loop, run, change or {}, bias)
        text = "\n".join(",".join(f"{value:.9g}" for value in row.values()) for row in rows)
        (folder / f"run-{run}.csv").write_text(",".join(rows[0]) + "\n" + text + "\n")
        lines += ["[[run]]", f'file = "run-{run}.csv"']
    (folder / "dataset.toml").write_text("\n".join(lines) + "\n")
    command = [PROGRAM, "--quiet", "diagnose", folder, "--out", folder / "found"]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False, env=environment())
    assert done.returncode == 0, done.stderr
    assert "remembers more" not in done.stderr
    return json.loads((folder / "found" / "diagnosis.json").read_text())


@pytest.mark.parametrize("loop", [ROTOR, BALL], ids=["rotor", "ball"])
def test_nothing_is_missing(tmp_path, loop):
    found = made(loop, tmp_path / "set")
    assert (found["verdict"], found["effects"]) == ("none", [])


@pytest.mark.parametrize(
    ("loop", "hidden", "name", "value", "share"),
    [(ROTOR, {"bias": 0.1}, "rotor.ic:bias", 0.1, 0.02), (BALL, {"change": {"m": 0.12}}, "ball.m", 0.12, 0.01),
     (BALL, {"change": {"R": 2.4}}, "ball.R", 2.4, 0.01)],
    ids=["bias", "mass", "resistance"],
)  # fmt: skip
def test_what_is_missing_is_named(tmp_path, loop, hidden, name, value, share):
    found = made(loop, tmp_path / "set", **hidden)
    (effect,) = found["effects"]
    assert name in effect["class"], effect
    # 3000 rows tell each to less than a hundredth; the rotor's load does nearly what a bias does
    assert effect["name"] != name or abs(effect["value"] / value - 1) < share, effect
