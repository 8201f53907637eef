"""A boiler that feeds radiators in a room: two units that are connected both ways. Nobody measures the radiators."""

import numpy as np

from ..machine import Input, Machine, Output, Parameter, State
from ..unit_c import build

AMBIENT = 293.15


def rhs(x, u, p):
    boiler, radiator, room = x
    flow = p["k_f"] * (boiler - radiator)
    heat = p["k_h"] * (radiator - room) + p["convection"] * (radiator - room) * np.abs(radiator - room)
    return np.array([
        (p["eta"] * u["P"] - flow - p["k_b"] * (boiler - AMBIENT)) / p["C_b"],
        (flow - heat) / p["C_r"],
        (heat - p["k_o"] * (room - u["T_out"]) + p["guests"]) / p["C_i"],
    ])


def outputs(x, u, p):
    return np.array([x[0], x[2]])


BOILER = Machine(
    name="boiler",
    states=(State("T_b", "K", "T_b", 323.15, 3.0),),
    inputs=(Input("P", "W", 0.0, 6000.0, "kW", (1e3, 0.0), kind="on-off"), Input("T_back", "K", 313.15, 0.0, "K")),
    outputs_of=(Output("T_b", "K", 0.1, "degC", (1.0, 273.15)),),
    parameters=(
        Parameter("C_b", "J/K", 1.2e5, 1e3, 1e8, "relative", "heat capacity of the boiler", 0.4),
        Parameter("k_b", "W/K", 8.0, 0.0, 1e4, "relative", "heat loss of the boiler", 0.8),
        Parameter("eta", "1", 0.9, 0.0, 1.5, "relative", "efficiency of the burner", -0.2),
        Parameter("k_f", "W/K", 250.0, 1.0, 1e5, "relative", "flow of water", 0.0),
    ),
    rhs=None, outputs=None, row=60.0, substeps=1, duration=0.0, build=None,
)  # fmt: skip
ROOM = Machine(
    name="radiators",
    states=(State("T_r", "K", "T_r", 313.15, 3.0), State("T_i", "K", "T_i", 292.15, 1.0)),
    inputs=(Input("T_supply", "K", 323.15, 0.0, "K"), Input("T_out", "K", 275.15, 4.0, "degC", (1.0, 273.15), kind="slow")),
    outputs_of=(Output("T_r", "K", 0.1, "degC", (1.0, 273.15)), Output("T_i", "K", 0.05, "degC", (1.0, 273.15))),
    parameters=(
        Parameter("C_r", "J/K", 1e5, 1e3, 1e8, "relative", "heat capacity of the radiators", 0.5),
        Parameter("k_h", "W/K", 120.0, 1.0, 1e5, "relative", "heat passed from radiators to room", 0.3),
        Parameter("C_i", "J/K", 8e5, 1e4, 1e9, "relative", "heat capacity of the room", 0.4),
        Parameter("k_o", "W/K", 90.0, 1.0, 1e4, "relative", "heat loss of the room", 0.4),
        Parameter("k_f", "W/K", 250.0, 1.0, 1e5, "relative", "flow of water", 0.0),
    ),
    rhs=None, outputs=None, row=60.0, substeps=1, duration=0.0, build=None,
)  # fmt: skip

BOILER_C = "dx[0] = (v[eta] * v[P] - v[k_f] * (x[0] - v[T_back]) - v[k_b] * (x[0] - 293.15)) / v[C_b];"
ROOM_C = """
    const double heat = v[k_h] * (x[0] - x[1]);
    dx[0] = (v[k_f] * (v[T_supply] - x[0]) - heat) / v[C_r];
    dx[1] = (heat - v[k_o] * (x[1] - v[T_out])) / v[C_i];
"""
# both hold what the other gave last: 2 s against time constants of minutes
SCENARIO = """format = 1
[experiment]
stop = 3600
[[units]]
name = "boiler"
fmu = "boiler.fmu"
interval = 2
[[units]]
name = "radiators"
fmu = "radiators.fmu"
interval = 2
[[connections]]
from = "boiler.T_b"
to = "radiators.T_supply"
[[connections]]
from = "radiators.T_r"
to = "boiler.T_back"
"""


def both(machine, folder):
    (folder / "heating.toml").write_text(SCENARIO)
    return [
        folder / "heating.toml",
        build(BOILER, folder, BOILER_C, "v[T_b] = x[0];", step=2.0),
        build(ROOM, folder, ROOM_C, "v[T_r] = x[0]; v[T_i] = x[1];", step=2.0),
    ]


def own(parts, names):
    return tuple(one for one in parts if one.name in names)


MACHINE = Machine(
    name="heating",
    states=(*BOILER.states, *ROOM.states),
    inputs=(*own(BOILER.inputs, "P"), *own(ROOM.inputs, ("T_out",))),
    outputs_of=(*BOILER.outputs_of, *own(ROOM.outputs_of, ("T_i",))),
    # the flow of water stands in both units: nobody's candidate
    parameters=(*BOILER.parameters, *ROOM.parameters[:-1]),
    rhs=rhs,
    outputs=outputs,
    row=60.0,
    substeps=10,
    duration=24_000.0,
    build=both,
    extra={"guests": 800.0, "convection": 2.0},
    one_sided=True,
    runs=3,
    scenario="heating.toml",
    places={name: "boiler" for name in ("P", "T_b", "C_b", "k_b", "eta", "k_f")}
    | {name: "radiators" for name in ("T_r", "T_i", "T_out", "C_r", "k_h", "C_i", "k_o")},
)
