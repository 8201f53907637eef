"""A sled between two springs, pushed by a force: a unit that heeds values in initialization mode only, and computes its acceleration in a
step only."""

import numpy as np

from ..machine import Input, Machine, Output, Parameter, State
from ..unit_c import build


def rhs(x, u, p):
    z, v = x
    force = u["force"] + p["push"] - p["k"] * z - p["d"] * v - p["f_c"] * np.tanh(v / 0.01) - p["k_3"] * z**3
    return np.array([v, force / p["m"]])


def outputs(x, u, p):
    return np.array([x[0], x[1], rhs(x, u, p)[1]])


C = """
    dx[0] = x[1];
    dx[1] = (v[force] - v[k] * x[0] - v[d] * x[1] - v[f_c] * tanh(x[1] / 0.01)) / v[m];
"""

MACHINE = Machine(
    name="sled",
    states=(State("z", "m", "z_init", 0.0, 0.02), State("w", "m/s", "w_init", 0.0, 0.05)),
    inputs=(Input("force", "N", 0.0, 40.0, "N", hold="zero"),),
    outputs_of=(Output("z", "m", 2e-4, "m"), Output("w", "m/s", 2e-3, "m/s"), Output("acceleration", "m/s2", 0.02, "m/s2")),
    parameters=(
        Parameter("m", "kg", 20.0, 5.0, 80.0, "relative", "mass", 0.2),
        Parameter("k", "N/m", 400.0, 50.0, 4000.0, "relative", "stiffness of the springs", 0.3),
        Parameter("d", "N.s/m", 15.0, 0.0, 200.0, "relative", "viscous friction", 0.5),
        Parameter("f_c", "N", 0.0, 0.0, 50.0, "absolute", "dry friction", 4.0),
    ),
    rhs=rhs,
    outputs=outputs,
    row=0.01,
    substeps=10,
    duration=6.0,
    build=lambda machine, folder: build(
        machine,
        folder,
        C,
        "double dx[2]; derivatives(v, x, dx); v[z] = x[0]; v[w] = x[1]; v[acceleration] = dx[1];",
        step=1e-3,
        late=machine.late,
    ),
    late="acceleration",
    extra={"push": 8.0, "k_3": 2e5},
)
