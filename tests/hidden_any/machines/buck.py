"""A step-down converter, averaged over its switching, with a rough load: milliseconds and microhenries."""

import numpy as np

from ..machine import Input, Machine, Output, Parameter, State
from ..unit_c import build


def rhs(x, u, p):
    i, v = x
    inductance = p["L"] * (1.0 - p["core"] * np.tanh(i / 5.0) ** 2)
    driven = u["d"] * (u["v_in"] - p["r_on"] * i) - (1.0 - u["d"]) * p["v_d"] - p["r_L"] * i
    return np.array([(driven - v) / inductance, (i - v / p["R"] - p["draw"] * np.sign(v) * v**2) / p["C"]])


def outputs(x, u, p):
    return np.array([x[0], x[1]])


C = """
    const double driven = v[d] * (v[v_in] - v[r_on] * x[0]) - (1 - v[d]) * v[v_d] - v[r_L] * x[0];
    dx[0] = (driven - x[1]) / v[L];
    dx[1] = (x[0] - x[1] / v[R]) / v[C];
"""

MACHINE = Machine(
    name="buck",
    states=(State("i", "A", "i", 2.4, 0.3), State("v_out", "V", "v_out", 12.0, 0.5)),
    inputs=(Input("d", "1", 0.5, 0.2, "%", (0.01, 0.0)), Input("v_in", "V", 24.0, 2.0, "V", kind="slow")),
    outputs_of=(Output("i", "A", 0.02, "mA", (1e-3, 0.0)), Output("v_out", "V", 0.02, "V")),
    parameters=(
        Parameter("L", "H", 1e-4, 1e-6, 1e-2, "relative", "inductance", 0.4),
        Parameter("C", "F", 2e-4, 1e-6, 1e-2, "relative", "capacitance", 0.4),
        Parameter("R", "Ohm", 5.0, 0.1, 100.0, "relative", "load", 0.3),
        Parameter("r_L", "Ohm", 0.0, 0.0, 2.0, "absolute", "resistance of the coil", 0.2),
        Parameter("r_on", "Ohm", 0.0, 0.0, 2.0, "absolute", "resistance of the switch", 0.2),
        Parameter("v_d", "V", 0.0, 0.0, 3.0, "absolute", "forward voltage of the diode", 0.7),
    ),
    rhs=rhs,
    outputs=outputs,
    row=2e-5,
    substeps=10,
    duration=0.012,
    build=lambda machine, folder: build(machine, folder, C, "v[i] = x[0]; v[v_out] = x[1];", step=2e-6),
    extra={"core": 0.5, "draw": 0.02},
)
