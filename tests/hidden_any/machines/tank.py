"""A pump fills an upper tank that drains into a lower one. Its unit is made with PythonFMU: no units of measurement, no saved states."""

import numpy as np

from ..machine import Input, Machine, Output, Parameter, State
from ..unit_python import build

G = 9.81


def rhs(x, u, p):
    one, two = (np.sqrt(2 * G * np.maximum(level, 1e-6)) for level in x)
    middle = 1e-4 * p["a_1"] * one
    return np.array([
        (1e-4 * p["q_pump"] * u["u"] - middle - 1e-4 * p["leak"] * one) / p["A_1"],
        (middle - 1e-4 * p["a_2"] * two + 1e-4 * p["hose"] - 1e-4 * p["weir"] * x[1]) / p["A_2"],
    ])


def outputs(x, u, p):
    return np.array([x[0], x[1]])


PYTHON = """
        one, two = ((2 * 9.81 * max(level, 1e-6)) ** 0.5 for level in self.x)
        middle = 1e-4 * self.a_1 * one
        return [
            (1e-4 * self.q_pump * self.u - middle - 1e-4 * self.leak * one) / self.A_1,
            (middle - 1e-4 * self.a_2 * two) / self.A_2,
        ]
"""

MACHINE = Machine(
    name="tank",
    states=(State("h_1", "m", "h_1_0", 0.5, 0.05), State("h_2", "m", "h_2_0", 0.5, 0.05)),
    inputs=(Input("u", "V", 5.0, 2.5, "V"),),
    outputs_of=(Output("h_1", "m", 2e-3, "cm", (1e-2, 0.0)), Output("h_2", "m", 2e-3, "cm", (1e-2, 0.0))),
    parameters=(
        Parameter("A_1", "m2", 0.02, 1e-3, 1.0, "relative", "cross section of the upper tank", 0.3),
        Parameter("A_2", "m2", 0.02, 1e-3, 1.0, "relative", "cross section of the lower tank", 0.3),
        Parameter("a_1", "cm2", 1.0, 0.1, 10.0, "relative", "opening below the upper tank", 0.2),
        Parameter("a_2", "cm2", 1.0, 0.1, 10.0, "relative", "opening below the lower tank", 0.2),
        Parameter("q_pump", "1e-4 m3/s/V", 0.6, 0.01, 10.0, "relative", "flow of the pump for a volt", 0.2),
        Parameter("leak", "cm2", 0.0, 0.0, 5.0, "absolute", "leak of the upper tank", 0.2),
    ),
    rhs=rhs,
    outputs=outputs,
    row=2.0,
    substeps=4,
    duration=600.0,
    build=lambda machine, folder: build(machine, folder, PYTHON, step=1.0),
    extra={"hose": 1.0, "weir": 2.0},
    saves_state=False,
    one_sided=True,
    runs=3,
    units=False,
)
