"""Two rooms with a heater each, a wall between them that stores heat, and the weather."""

import numpy as np

from ..machine import Input, Machine, Output, Parameter, State
from ..unit_c import build


def rhs(x, u, p):
    a, b, w = x
    out = u["T_out"]
    return np.array([
        (p["eta_a"] * u["P_a"] + p["k_w"] * (w - a) + (p["k_a"] + p["window"]) * (out - a)) / p["C_a"],
        (u["P_b"] + p["k_w"] * (w - b) + p["k_b"] * (out - b) + p["k_d"] * (a - b) - p["stove"] * (b - out) * np.abs(b - out)) / p["C_b"],
        (p["k_w"] * (a - w) + p["k_w"] * (b - w) + p["sun"]) / p["C_w"],
    ])


def outputs(x, u, p):
    return np.array([x[0], x[1]])


C = """
    dx[0] = (v[eta_a] * v[P_a] + v[k_w] * (x[2] - x[0]) + v[k_a] * (v[T_out] - x[0])) / v[C_a];
    dx[1] = (v[P_b] + v[k_w] * (x[2] - x[1]) + v[k_b] * (v[T_out] - x[1]) + v[k_d] * (x[0] - x[1])) / v[C_b];
    dx[2] = (v[k_w] * (x[0] - x[2]) + v[k_w] * (x[1] - x[2]) + v[sun]) / v[C_w];
"""

MACHINE = Machine(
    name="house",
    states=(
        State("T_a", "K", "T_a", 294.15, 1.0),
        State("T_b", "K", "T_b", 292.15, 1.0),
        State("T_w", "K", "T_w_0", 292.15, 1.0),
    ),
    inputs=(
        Input("P_a", "W", 0.0, 1500.0, "kW", (1e3, 0.0), kind="on-off"),
        Input("P_b", "W", 0.0, 1000.0, "kW", (1e3, 0.0), kind="on-off"),
        Input("T_out", "K", 278.15, 4.0, "degC", (1.0, 273.15), kind="slow"),
    ),
    outputs_of=(Output("T_a", "K", 0.05, "degC", (1.0, 273.15)), Output("T_b", "K", 0.05, "degC", (1.0, 273.15))),
    parameters=(
        Parameter("C_a", "J/K", 2e5, 1e4, 1e7, "relative", "heat capacity of room A", 0.5),
        Parameter("C_b", "J/K", 1.5e5, 1e4, 1e7, "relative", "heat capacity of room B", 0.5),
        Parameter("C_w", "J/K", 2e6, 1e5, 1e8, "relative", "heat capacity of the wall between", 0.5),
        Parameter("k_w", "W/K", 60.0, 1.0, 1e3, "relative", "heat passed between a room and the wall", 0.5),
        Parameter("k_a", "W/K", 25.0, 0.0, 1e3, "relative", "heat loss of room A", 0.6),
        Parameter("k_b", "W/K", 20.0, 0.0, 1e3, "relative", "heat loss of room B", 0.6),
        Parameter("k_d", "W/K", 0.0, 0.0, 500.0, "absolute", "air that passes between the rooms", 40.0),
        Parameter("sun", "W", 0.0, 0.0, 2000.0, "absolute", "sun on the wall between", 300.0),
        Parameter("eta_a", "1", 1.0, 0.0, 1.5, "relative", "share of the power that arrives in room A", -0.3),
    ),
    rhs=rhs,
    outputs=outputs,
    row=120.0,
    substeps=3,
    duration=60_000.0,
    build=lambda machine, folder: build(machine, folder, C, "v[T_a] = x[0]; v[T_b] = x[1];", step=60.0),
    extra={"window": 60.0, "stove": 1.0},
    one_sided=True,
    runs=3,
)
