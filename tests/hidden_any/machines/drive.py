"""A motor that turns a load through a shaft that twists: encoder at the motor, another at the load."""

import numpy as np

from ..machine import Input, Machine, Output, Parameter, State
from ..unit_c import build


def rhs(x, u, p):
    phi_m, w_m, phi_l, w_l = x
    twist = phi_m - phi_l
    shaft = p["k"] * twist + p["d"] * (w_m - w_l) + p["hardening"] * twist**3
    return np.array([
        w_m,
        (u["torque"] - p["b_m"] * w_m - shaft) / p["J_m"],
        w_l,
        (shaft - p["fc_l"] * np.tanh(w_l / 0.05) - p["b_l"] * w_l + p["push"]) / p["J_l"],
    ])


def outputs(x, u, p):
    return np.array([x[1], x[2]])


C = """
    const double shaft = v[k] * (x[0] - x[2]) + v[d] * (x[1] - x[3]);
    dx[0] = x[1];
    dx[1] = (v[torque] - v[b_m] * x[1] - shaft) / v[J_m];
    dx[2] = x[3];
    dx[3] = (shaft - v[fc_l] * tanh(x[3] / 0.05) - v[b_l] * x[3]) / v[J_l];
"""

MACHINE = Machine(
    name="drive",
    states=(
        State("phi_m", "rad", "phi_m_0", 0.0, 0.3),
        State("w_m", "rad/s", "w_m", 0.0, 0.5),
        State("phi_l", "rad", "phi_l", 0.0, 0.3),
        State("w_l", "rad/s", "w_l_0", 0.0, 0.5),
    ),
    inputs=(Input("torque", "N.m", 0.0, 2.0, "mN.m", (1e-3, 0.0)),),
    outputs_of=(Output("w_m", "rad/s", 0.05, "rpm", (2 * np.pi / 60, 0.0)), Output("phi_l", "rad", 0.002, "deg", (np.pi / 180, 0.0))),
    parameters=(
        Parameter("J_m", "kg.m2", 0.02, 0.001, 1.0, "relative", "inertia of the motor", 0.4),
        Parameter("J_l", "kg.m2", 0.06, 0.001, 2.0, "relative", "inertia of the load", 0.4),
        Parameter("k", "N.m/rad", 30.0, 1.0, 1e4, "relative", "stiffness of the shaft", 0.4),
        Parameter("d", "N.m.s/rad", 0.05, 0.0, 5.0, "relative", "damping of the shaft", 0.8),
        Parameter("b_m", "N.m.s/rad", 0.05, 0.0, 5.0, "relative", "viscous friction of the motor", 0.8),
        Parameter("b_l", "N.m.s/rad", 0.0, 0.0, 5.0, "absolute", "viscous friction of the load", 0.05),
        Parameter("fc_l", "N.m", 0.0, 0.0, 5.0, "absolute", "Coulomb friction of the load", 0.4),
    ),
    rhs=rhs,
    outputs=outputs,
    row=0.01,
    substeps=10,
    duration=6.0,
    build=lambda machine, folder: build(machine, folder, C, "v[w_m] = x[1]; v[phi_l] = x[2];", step=1e-3),
    extra={"push": 0.6, "hardening": 600.0},
    runs=3,
)
