"""A quarter car on a rough road: body and wheel on spring, damper and tyre. It can't save its state."""

import numpy as np

from ..machine import Input, Machine, Output, Parameter, State
from ..unit_c import build


def rhs(x, u, p):
    zb, vb, zw, vw = x
    travel, speed = zb - zw, vb - vw
    damper = np.where(speed > 0, p["c_s"] * (1 + p["asymmetry"]), p["c_s"])
    spring = p["k_s"] * travel + p["k_3"] * travel**3 + damper * speed + p["f_s"] * np.tanh(speed / 0.02)
    tyre = p["k_t"] * (zw - u["road"])
    return np.array([vb, (-spring + p["push"]) / p["m_b"], vw, (spring - tyre - p["c_t"] * vw) / p["m_w"]])


def outputs(x, u, p):
    return np.array([rhs(x, u, p)[1], x[0] - x[2]])


C = """
    const double travel = x[0] - x[2], speed = x[1] - x[3];
    const double spring = v[k_s] * travel + v[k_3] * travel * travel * travel + v[c_s] * speed + v[f_s] * tanh(speed / 0.02);
    dx[0] = x[1];
    dx[1] = -spring / v[m_b];
    dx[2] = x[3];
    dx[3] = (spring - v[k_t] * (x[2] - v[road]) - v[c_t] * x[3]) / v[m_w];
"""

MACHINE = Machine(
    name="car",
    states=(
        State("zb", "m", "zb_0", 0.0, 0.01),
        State("vb", "m/s", "vb_0", 0.0, 0.05),
        State("zw", "m", "zw_0", 0.0, 0.005),
        State("vw", "m/s", "vw_0", 0.0, 0.05),
    ),
    inputs=(Input("road", "m", 0.0, 0.01, "mm", (1e-3, 0.0), kind="rough", hold="linear"),),
    outputs_of=(Output("acceleration", "m/s2", 0.03, "m/s2"), Output("travel", "m", 4e-4, "mm", (1e-3, 0.0))),
    parameters=(
        Parameter("m_b", "kg", 300.0, 50.0, 1000.0, "relative", "mass of the body", 0.3),
        Parameter("m_w", "kg", 40.0, 5.0, 200.0, "relative", "mass of the wheel", 0.4),
        Parameter("k_s", "N/m", 18e3, 1e3, 1e5, "relative", "stiffness of the spring", 0.3),
        Parameter("c_s", "N.s/m", 1200.0, 10.0, 1e4, "relative", "damper", 0.4),
        Parameter("k_t", "N/m", 180e3, 1e4, 1e6, "relative", "stiffness of the tyre", 0.3),
        Parameter("c_t", "N.s/m", 0.0, 0.0, 1e4, "absolute", "friction of the wheel's guide", 150.0),
        Parameter("f_s", "N", 0.0, 0.0, 500.0, "absolute", "dry friction in the strut", 60.0),
        Parameter("k_3", "N/m3", 0.0, 0.0, 1e8, "absolute", "progressive spring", 2e7),
    ),
    rhs=rhs,
    outputs=outputs,
    row=0.01,
    substeps=10,
    duration=6.0,
    build=lambda machine, folder: build(
        machine, folder, C, "double dx[4]; derivatives(v, x, dx); v[acceleration] = dx[1]; v[travel] = x[0] - x[2];", step=1e-3
    ),
    extra={"push": 400.0, "asymmetry": 1.0},
    saves_state=False,
    step=1e-3,
)
