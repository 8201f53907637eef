"""Nominal models of two machines whose logs were measured by others: what a textbook says of them, and nothing else."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))
from hidden_any.machine import Input, Machine, Output, Parameter, State  # noqa: E402
from hidden_any.unit_c import build  # noqa: E402

# m l² dω/dt = τ - m g l sin φ - b ω - fc tanh(ω / 0.05), φ = 0 hanging down
PENDULUM = """
    dx[0] = x[1];
    dx[1] = (v[torque] - 9.81 * v[m] * v[l] * sin(x[0]) - v[b] * x[1] - v[fc] * tanh(x[1] / 0.05)) / (v[m] * v[l] * v[l]);
"""

# energy of two heaters of 4 g and 500 J/(kg K), 10 cm² each, that see each other over 2 cm²
HEATER = """
    const double s = 0.9 * 5.67e-8, one = x[0], two = x[1], air = v[T_air];
    const double over = 2e-4 * (v[U_s] * (two - one) + s * (pow(two, 4) - pow(one, 4)));
    dx[0] = (1e-3 * (v[U] * (air - one) + s * (pow(air, 4) - pow(one, 4))) + over + v[alpha_1] * v[Q1]) / 2.0;
    dx[1] = (1e-3 * (v[U] * (air - two) + s * (pow(air, 4) - pow(two, 4))) - over + v[alpha_2] * v[Q2]) / 2.0;
"""


def machine(name, states, inputs, outputs, parameters, equations, step):
    """A machine that is only built: there is no truth to simulate."""
    shown = " ".join(f"v[{state.name}] = x[{place}];" for place, state in enumerate(states))
    return Machine(
        name=name, states=states, inputs=inputs, outputs_of=outputs, parameters=parameters, rhs=None, outputs=None,
        row=step, substeps=1, duration=0.0, build=lambda machine, folder: build(machine, folder, equations, shown, step=step),
    )  # fmt: skip


REAL = {
    "pendulum": machine(
        "pendulum",
        (State("position", "rad", "position", 0.0, 0.0), State("velocity", "rad/s", "velocity", 0.0, 0.0)),
        (Input("torque", "N.m", 0.0, 1.0, "N.m"),),
        (Output("position", "rad", 0.0, "rad"), Output("velocity", "rad/s", 0.0, "rad/s")),
        (
            Parameter("m", "kg", 0.6755, 0.01, 10.0, "relative", "mass at the rod's end", 0.5),
            Parameter("l", "m", 0.5, 0.05, 5.0, "relative", "length of the rod", 0.5),
            Parameter("b", "N.m.s/rad", 0.0, 0.0, 1.0, "absolute", "viscous friction", 0.5),
            Parameter("fc", "N.m", 0.0, 0.0, 2.0, "absolute", "Coulomb friction", 0.5),
        ),
        PENDULUM,
        5e-4,
    ),
    "heater": machine(
        "heater",
        (State("T1", "K", "T1", 296.15, 0.0), State("T2", "K", "T2", 296.15, 0.0)),
        (Input("Q1", "%", 0.0, 1.0, "%"), Input("Q2", "%", 0.0, 1.0, "%")),
        (Output("T1", "K", 0.0, "degC"), Output("T2", "K", 0.0, "degC")),
        (
            Parameter("U", "W/(m2.K)", 10.0, 1.0, 50.0, "relative", "heat transfer to the air", 0.5),
            Parameter("U_s", "W/(m2.K)", 10.0, 1.0, 50.0, "relative", "heat transfer between the heaters", 0.5),
            Parameter("alpha_1", "W/%", 0.01, 0.001, 0.1, "relative", "power of heater 1", 0.5),
            Parameter("alpha_2", "W/%", 0.0075, 0.001, 0.1, "relative", "power of heater 2", 0.5),
            Parameter("T_air", "K", 296.15, 270.0, 320.0, "absolute", "temperature of the air", 5.0),
        ),
        HEATER,
        0.1,
    ),
}
