"""A pendulum that hangs on a cart between springs."""

import numpy as np

from ..machine import Input, Machine, Output, Parameter, State
from ..unit_c import build

G = 9.81


def rhs(x, u, p):
    place, v, angle, w = x
    m, length = p["m_p"], p["l"]
    s, c = np.sin(angle), np.cos(angle)
    force = u["force"] - p["b_c"] * v - p["f_c"] * np.tanh(v / 0.01) - p["k_c"] * place + p["push"] - p["drag"] * v * np.abs(v)
    turn = p["b_p"] * w / (m * length)
    a = (force + m * length * w**2 * s + m * c * (G * s + turn)) / (p["m_c"] + m - m * c**2)
    return np.array([v, a, w, -(G * s + turn + a * c) / length])


def outputs(x, u, p):
    return np.array([x[0], x[2]])


C = """
    const double s = sin(x[2]), c = cos(x[2]), m = v[m_p];
    const double pull = v[force] - v[b_c] * x[1] - v[f_c] * tanh(x[1] / 0.01) - v[k_c] * x[0];
    const double turn = v[b_p] * x[3] / (m * v[l]);
    dx[0] = x[1];
    dx[1] = (pull + m * v[l] * x[3] * x[3] * s + m * c * (9.81 * s + turn)) / (v[m_c] + m * s * s);
    dx[2] = x[3];
    dx[3] = -(9.81 * s + turn + dx[1] * c) / v[l];
"""

MACHINE = Machine(
    name="cart",
    states=(
        State("x_cart", "m", "x_0", 0.0, 0.05),
        State("v", "m/s", "v_0", 0.0, 0.1),
        State("angle", "rad", "angle_0", 0.0, 0.2),
        State("w", "rad/s", "w_0", 0.0, 0.5),
    ),
    inputs=(Input("force", "N", 0.0, 3.0, "mN", (1e-3, 0.0)),),
    # the angle's sensor counts the other way round
    outputs_of=(Output("x_cart", "m", 1e-3, "mm", (1e-3, 0.0)), Output("angle", "rad", 3e-3, "deg", (-np.pi / 180, 0.0))),
    parameters=(
        Parameter("m_c", "kg", 1.0, 0.1, 10.0, "relative", "mass of the cart", 0.4),
        Parameter("m_p", "kg", 0.3, 0.01, 5.0, "relative", "mass of the pendulum", 0.5),
        Parameter("l", "m", 0.4, 0.05, 3.0, "relative", "length of the pendulum", 0.2),
        Parameter("k_c", "N/m", 8.0, 0.0, 100.0, "relative", "spring of the cart", 0.4),
        Parameter("b_c", "N.s/m", 0.0, 0.0, 20.0, "absolute", "viscous friction of the cart", 0.6),
        Parameter("b_p", "N.m.s/rad", 0.0, 0.0, 1.0, "absolute", "viscous friction of the pivot", 0.02),
        Parameter("f_c", "N", 0.0, 0.0, 5.0, "absolute", "Coulomb friction of the cart", 0.4),
    ),
    rhs=rhs,
    outputs=outputs,
    row=0.02,
    substeps=8,
    duration=10.0,
    build=lambda machine, folder: build(machine, folder, C, "v[x_cart] = x[0]; v[angle] = x[2];", step=1e-3),
    extra={"push": 2.0, "drag": 1.5},
)
