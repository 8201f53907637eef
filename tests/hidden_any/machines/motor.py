"""A DC motor with a gearbox: L di/dt = u - R i - k n w; J dw/dt = n k i - b w - fc tanh(w / 0.05) - c phi + load."""

import numpy as np

from ..machine import Input, Machine, Output, Parameter, State
from ..unit_c import build

RATIO = 20.0


def rhs(x, u, p):
    i, w, phi = x
    friction = p["b"] * w + p["fc"] * np.tanh(w / 0.05) + p["c"] * phi + p["cogging"] * np.sin(12 * phi)
    return np.array([
        (u["u"] - p["R"] * i - p["k"] * RATIO * w) / p["L"],
        (RATIO * p["k"] * i - friction + p["push"]) / p["J"],
        w,
    ])


def outputs(x, u, p):
    return np.array([x[0], x[1], x[2]])


C = """
    const double friction = v[b] * x[1] + v[fc] * tanh(x[1] / 0.05) + v[c] * x[2];
    dx[0] = (v[u] - v[R] * x[0] - v[k] * 20.0 * x[1]) / v[L];
    dx[1] = (20.0 * v[k] * x[0] - friction) / v[J];
    dx[2] = x[1];
"""

MACHINE = Machine(
    name="motor",
    states=(
        State("i", "A", "i", 0.0, 0.3),
        State("w", "rad/s", "w", 0.0, 2.0),
        State("phi", "rad", "phi", 0.0, 1.0),
    ),
    inputs=(Input("u", "V", 0.0, 10.0, "mV", (1e-3, 0.0)),),
    outputs_of=(
        Output("i", "A", 0.02, "mA", (1e-3, 0.0)),
        Output("w", "rad/s", 0.05, "rpm", (2 * np.pi / 60, 0.0)),
        Output("phi", "rad", 0.004, "deg", (np.pi / 180, 0.0)),
    ),
    parameters=(
        Parameter("R", "Ohm", 1.2, 0.1, 10.0, "relative", "resistance of the winding", 0.5),
        Parameter("L", "H", 0.008, 1e-4, 0.1, "relative", "inductance of the winding", 0.8),
        Parameter("k", "N.m/A", 0.04, 0.001, 1.0, "relative", "torque constant", 0.3),
        Parameter("J", "kg.m2", 0.05, 0.001, 1.0, "relative", "inertia of motor and load", 0.5),
        Parameter("b", "N.m.s/rad", 0.0, 0.0, 1.0, "absolute", "viscous friction", 0.15),
        Parameter("fc", "N.m", 0.0, 0.0, 3.0, "absolute", "Coulomb friction", 0.8),
        Parameter("c", "N.m/rad", 0.0, 0.0, 5.0, "absolute", "return spring", 0.5),
    ),
    rhs=rhs,
    outputs=outputs,
    row=0.01,
    substeps=4,
    duration=6.0,
    build=lambda machine, folder: build(machine, folder, C, "v[i] = x[0]; v[w] = x[1]; v[phi] = x[2];", step=5e-4),
    extra={"push": 3.0, "cogging": 1.0},
)
