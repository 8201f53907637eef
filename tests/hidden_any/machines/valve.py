"""A spring-centred cylinder behind a proportional valve. Its spool follows the command with a lag, is not measured, and within its overlap
it moves nothing: no output tells of it there.

Merritt, Hydraulic Control Systems (1967), chapters 5 and 6: flow proportional to the opening, an overlapped (closed-centre) spool.
"""

import numpy as np

from ..machine import Input, Machine, Output, Parameter, State
from ..unit_c import build


def rhs(x, u, p):
    position, spool = x
    opening = np.sign(spool) * np.maximum(np.abs(spool) - p["overlap"], 0.0)
    return np.array([p["k_q"] * opening - position / p["T_x"] + p["push"], (u["u"] - spool) / p["tau"]])


def outputs(x, u, p):
    return np.array([x[0]])


C = """
    const double opening = copysign(fmax(fabs(x[1]) - v[overlap], 0.0), x[1]);
    dx[0] = v[k_q] * opening - x[0] / v[T_x];
    dx[1] = (v[u] - x[1]) / v[tau];
"""

MACHINE = Machine(
    name="valve",
    states=(State("position", "m", "position_0", 0.0, 0.02), State("spool", "1", "spool_0", 0.0, 0.1)),
    inputs=(Input("u", "1", 0.0, 0.5, "%", (0.01, 0.0)),),
    outputs_of=(Output("position", "m", 1e-4, "mm", (1e-3, 0.0)),),
    parameters=(
        Parameter("k_q", "m/s", 0.4, 0.01, 10.0, "relative", "speed of the open valve", 0.2),
        Parameter("T_x", "s", 1.5, 0.1, 20.0, "relative", "time in which the spring centres the cylinder", 0.3),
        Parameter("tau", "s", 0.1, 0.01, 1.0, "relative", "lag of the spool", 0.3),
        Parameter("overlap", "1", 0.0, 0.0, 0.5, "absolute", "overlap of the spool", 0.15),
    ),
    rhs=rhs,
    outputs=outputs,
    row=0.02,
    substeps=20,
    duration=12.0,
    build=lambda machine, folder: build(machine, folder, C, "v[position] = x[0];", step=1e-3),
    extra={"push": 0.1},
)
