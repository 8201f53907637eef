"""A lithium-ion cell: open-circuit voltage, series resistance, one RC pair, and its temperature."""

import numpy as np

from ..machine import Input, Machine, Output, Parameter, State
from ..unit_c import build

AMBIENT = 298.15


def resistance(T, p):
    return p["R0"] * (1 - p["a_T"] * (T - AMBIENT))


def rhs(x, u, p):
    soc, v1, T = x
    i = u["i"]
    heat = i * i * resistance(T, p) + v1 * v1 / p["R1"]
    return np.array([
        -(i + p["leak"] + p["push"]) / (3600 * p["Q"]),
        i / p["C1"] - v1 / (p["R1"] * p["C1"]),
        (heat - p["h"] * (T - AMBIENT)) / p["C_th"],
    ])


def outputs(x, u, p):
    soc, v1, T = x
    ocv = 3.0 + 1.6 * soc - 1.1 * soc**2 + 0.6 * soc**3
    hysteresis = p["hysteresis"] * np.tanh(u["i"] / 0.2)
    return np.array([ocv - v1 - resistance(T, p) * u["i"] - hysteresis, T])


C = """
    const double heat = v[i] * v[i] * v[R0] * (1 - v[a_T] * (x[2] - 298.15)) + x[1] * x[1] / v[R1];
    dx[0] = -(v[i] + v[leak]) / (3600 * v[Q]);
    dx[1] = v[i] / v[C1] - x[1] / (v[R1] * v[C1]);
    dx[2] = (heat - v[h] * (x[2] - 298.15)) / v[C_th];
"""
OUTPUTS = """
    const double s = x[0];
    v[v_cell] = 3.0 + 1.6 * s - 1.1 * s * s + 0.6 * s * s * s - x[1] - v[R0] * (1 - v[a_T] * (x[2] - 298.15)) * v[i];
    v[T] = x[2];
"""

MACHINE = Machine(
    name="cell",
    states=(
        State("soc", "1", "soc_0", 0.7, 0.05),
        State("v1", "V", "v1_0", 0.0, 0.005),
        State("T", "K", "T", AMBIENT, 1.0),
    ),
    inputs=(Input("i", "A", 0.5, 3.0, "mA", (1e-3, 0.0)),),
    outputs_of=(Output("v_cell", "V", 1e-3, "mV", (1e-3, 0.0)), Output("T", "K", 0.05, "degC", (1.0, 273.15))),
    parameters=(
        Parameter("Q", "A.h", 2.5, 0.5, 10.0, "relative", "capacity", -0.3),
        Parameter("R0", "Ohm", 0.03, 0.001, 1.0, "relative", "series resistance", 0.6),
        Parameter("R1", "Ohm", 0.02, 0.001, 1.0, "relative", "resistance of the RC pair", 0.6),
        Parameter("C1", "F", 1500.0, 10.0, 1e5, "relative", "capacitance of the RC pair", 0.6),
        Parameter("C_th", "J/K", 60.0, 1.0, 1e4, "relative", "heat capacity", 0.5),
        Parameter("h", "W/K", 0.15, 0.0, 10.0, "relative", "heat loss to the air", 0.6),
        Parameter("leak", "A", 0.0, 0.0, 2.0, "absolute", "self-discharge", 0.4),
        Parameter("a_T", "1/K", 0.0, 0.0, 0.05, "absolute", "drop of the series resistance with temperature", 0.03),
    ),
    rhs=rhs,
    outputs=outputs,
    row=2.0,
    substeps=2,
    duration=1000.0,
    build=lambda machine, folder: build(machine, folder, C, OUTPUTS, step=1.0),
    extra={"push": 2.0, "hysteresis": 0.03},
    one_sided=True,
)
