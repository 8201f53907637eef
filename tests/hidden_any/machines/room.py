"""A heated box with a wall that stores heat and a door. Its unit is made with PythonFMU: no units of measurement, no saved states."""

import numpy as np

from ..machine import Input, Machine, Output, Parameter, State
from ..unit_python import build


def rhs(x, u, p):
    air, wall = x
    out = u["T_out"]
    inside = p["k_wall"] * (wall - air) + (p["k_leak"] + p["door"]) * (out - air)
    radiation = p["radiation"] * 5.67e-8 * (wall**4 - out**4)
    return np.array([
        (p["efficiency"] * u["P"] + inside) / p["C_air"],
        (p["k_wall"] * (air - wall) + p["k_out"] * (out - wall) + p["sun"] - radiation) / p["C_wall"],
    ])


def outputs(x, u, p):
    return np.array([x[0]])


PYTHON = """
        air, wall = self.x
        inside = self.k_wall * (wall - air) + self.k_leak * (self.T_out - air)
        return [
            (self.efficiency * self.P + inside) / self.C_air,
            (self.k_wall * (air - wall) + self.k_out * (self.T_out - wall) + self.sun) / self.C_wall,
        ]
"""

MACHINE = Machine(
    name="room",
    states=(State("T", "K", "T_0", 293.15, 1.5), State("T_wall", "K", "T_wall_0", 290.15, 1.5)),
    inputs=(
        Input("P", "W", 0.0, 120.0, "W", kind="on-off"),
        Input("T_out", "K", 281.15, 3.0, "degC", (1.0, 273.15), kind="slow", hold="linear"),
    ),
    outputs_of=(Output("T", "K", 0.05, "degC", (1.0, 273.15)),),
    parameters=(
        Parameter("C_air", "J/K", 2500.0, 100.0, 1e5, "relative", "heat capacity of the air and what it holds", 0.6),
        Parameter("C_wall", "J/K", 3e4, 1e3, 1e6, "relative", "heat capacity of the wall", 0.6),
        Parameter("k_wall", "W/K", 8.0, 0.1, 100.0, "relative", "heat passed between air and wall", 0.5),
        Parameter("k_out", "W/K", 3.0, 0.1, 100.0, "relative", "heat passed between wall and outside", 0.6),
        Parameter("k_leak", "W/K", 0.0, 0.0, 50.0, "absolute", "air that leaks out", 3.0),
        Parameter("efficiency", "1", 1.0, 0.0, 1.5, "absolute", "share of the heater's power that arrives", -0.3),
        Parameter("sun", "W", 0.0, 0.0, 500.0, "absolute", "sun on the wall", 60.0),
    ),
    rhs=rhs,
    outputs=outputs,
    row=20.0,
    substeps=2,
    duration=8000.0,
    build=lambda machine, folder: build(machine, folder, PYTHON, step=10.0),
    extra={"door": 8.0, "radiation": 2.0},
    saves_state=False,
    one_sided=True,
    runs=4,
    units=False,
)
