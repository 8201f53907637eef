"""A stirred tank reactor: a first-order exothermic reaction, cooled by a jacket. The concentration is not measured.

Seborg, Edgar, Mellichamp, Process Dynamics and Control, Example 2.5, with a reaction that gives off half as much heat, so that it stands
still by itself.
"""

import numpy as np

from ..machine import Input, Machine, Output, Parameter, State
from ..unit_c import build


def rhs(x, u, p):
    T, c = x
    rate = p["k_0"] * np.exp(-8750.0 / T) * c
    exchange = p["UA"] * (u["T_c"] - T) + p["stirring"] - p["loss"] * np.sign(T - 330.0) * (T - 330.0) ** 2
    flow = u["q"] / p["V"]
    return np.array([flow * (p["T_f"] - T) + (p["H"] * rate + exchange / p["V"]) / 239.0, flow * (p["c_f"] - c) - rate])


def outputs(x, u, p):
    return np.array([x[0]])


C = """
    const double rate = v[k_0] * exp(-8750.0 / x[0]) * x[1], flow = v[q] / v[V];
    dx[0] = flow * (v[T_f] - x[0]) + (v[H] * rate + (v[UA] * (v[T_c] - x[0]) + v[stirring]) / v[V]) / 239.0;
    dx[1] = flow * (v[c_f] - x[1]) - rate;
"""

MACHINE = Machine(
    name="reactor",
    states=(State("T", "K", "T_0", 335.0, 2.0), State("c", "mol/l", "c_0", 0.75, 0.05)),
    inputs=(Input("T_c", "K", 302.0, 8.0, "degC", (1.0, 273.15)), Input("q", "l/s", 1.6, 0.4, "l/min", (1 / 60, 0.0))),
    outputs_of=(Output("T", "K", 0.05, "degC", (1.0, 273.15)),),
    parameters=(
        Parameter("V", "l", 100.0, 10.0, 1000.0, "relative", "volume"),
        Parameter("T_f", "K", 350.0, 280.0, 400.0, "absolute", "temperature of the feed", 6.0),
        Parameter("c_f", "mol/l", 1.0, 0.1, 5.0, "relative", "concentration of the feed", 0.2),
        Parameter("k_0", "1/s", 1.2e9, 1e8, 1e10, "relative", "frequency factor of the reaction", 0.5),
        Parameter("H", "J/mol", 2.5e4, 0.0, 1e5, "relative", "heat of the reaction", 0.3),
        Parameter("UA", "W/K", 830.0, 10.0, 1e4, "relative", "heat transfer to the jacket", 0.3),
        Parameter("stirring", "W", 0.0, 0.0, 2e4, "absolute", "heat of the stirrer", 8000.0),
    ),
    rhs=rhs,
    outputs=outputs,
    row=5.0,
    substeps=10,
    duration=2000.0,
    build=lambda machine, folder: build(machine, folder, C, "v[T] = x[0];", step=0.5),
    extra={"loss": 15.0},
)
