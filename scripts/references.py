#!/usr/bin/env python3
"""Writes the reference results that travel in our units, by the Layered Standard References (FMI-LS-REF).

For each unit one smoke test in `fmus/*/fmu/extra/org.fmi-standard.fmi-ls-ref/`: what goes in, what FMPy gets out of the packed
unit, an experiment of the Modelica Association's experiments format that ties both together, parameters as an SSP parameter
set, and the manifest. `cargo xtask pack` puts the folder into the unit. To be run again, after `cargo xtask pack`, when a change
is meant to move a unit's results; `tests/fmpy/test_references.py` fails when they move without.
"""

import math
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
from fmpy import simulate_fmu

ROOT = Path(__file__).resolve().parents[1]
STANDARD = "org.fmi-standard.fmi-ls-ref"
STEP, ROWS = 0.01, 51
HEAD = '<?xml version="1.0" encoding="UTF-8"?><!-- Written by scripts/references.py. Do not edit. -->\n'


def swing(amplitude, rate):
    """An angle and its rate."""
    return (lambda t: amplitude * math.sin(rate * t), lambda t: amplitude * rate * math.cos(rate * t))


LINK_1, LINK_2 = swing(-0.05, 5.0), swing(0.3, 5.0)
STATE = {"q1": LINK_1[0], "q2": LINK_2[0], "dq1": LINK_1[1], "dq2": LINK_2[1]}
# Folder: model identifier, what the experiment is, parameters, stimuli.
UNITS = {
    "plant": (
        "acrobot_plant",
        "Free-standing arm under a torque between its links",
        {"b_joint": 0.02, "T_act": 0.02},
        {"tau": lambda t: 1.0 * math.sin(9.0 * t), "tau_1": lambda t: 0.1 * t, "tau_2": lambda t: -0.5},
    ),
    "camera": ("acrobot_camera", "Two links that swing before a camera with a barrel lens", {"k1": 0.05, "T_delay": 0.02}, STATE),
    "controller": (
        "acrobot_controller",
        "Estimates of 30 Hz about a manoeuvre, and a step of what is wanted",
        {},
        {**STATE, "z_desired": lambda t: 0.0 if t < 0.2 else 0.1, "frame": lambda t: int(30 * t) + 1},
    ),
    "residual": (
        "acrobot_residual",
        "A spring, damping and friction that eases off, at both joints",
        {"spring_roll": 0.4, "damp_roll": 0.1, "stick_joint": 0.3, "stribeck_joint": 0.2, "drag_joint": 0.05},
        {**STATE, "tau_1_in": lambda t: 0.2 * t, "tau_2_in": lambda t: -0.1},
    ),
    "signal_effects": (
        "signal_effects",
        "Delay, rate limit, lag, gain and bias of one signal",
        {"delay": 0.03, "rate_limit": 5.0, "lag": 0.05, "gain": 2.0, "bias": 0.1},
        {"u": lambda t: 0.0 if t < 0.1 else 1.0, "d": lambda t: 0.2 * t},
    ),
}


def folder(unit):
    return ROOT / "fmus" / unit / "fmu" / "extra" / STANDARD


def stimuli(courses):
    """What is set at each communication point and holds for the step that begins there."""
    types = [(name, np.int32 if isinstance(course(0.0), int) else float) for name, course in courses.items()]
    times = [STEP * row for row in range(ROWS)]
    rows = [(time, *(course(time) for course in courses.values())) for time in times]
    return np.array(rows, dtype=[("time", float), *types])


def results(fmu, parameters, given):
    """What FMPy records at each communication point."""
    return simulate_fmu(
        str(fmu), start_time=0.0, stop_time=STEP * (ROWS - 1), step_size=STEP, output_interval=STEP, start_values=parameters, input=given
    )


def csv(table):
    def number(value):
        return repr(int(value) if isinstance(value, (bool, np.bool_)) else value.item())

    rows = [",".join(table.dtype.names)]
    return "\n".join(rows + [",".join(number(value) for value in row) for row in table]) + "\n"


def parameter_set(name, parameters):
    rows = [f'    <ssv:Parameter name={quoteattr(p)}><ssv:Real value="{value!r}"/></ssv:Parameter>\n' for p, value in parameters.items()]
    space = "http://ssp-standard.org/SSP1/SystemStructureParameterValues"
    head = f'<ssv:ParameterSet xmlns:ssv="{space}" version="1.0" name={quoteattr(name)}>\n'
    return HEAD + head + "  <ssv:Parameters>\n" + "".join(rows) + "  </ssv:Parameters>\n</ssv:ParameterSet>\n"


def experiment(description, has_parameters):
    return (
        f'{HEAD}<Experiments name="smoke test" description="Stimuli are set at each communication point and hold over the step.">\n'
        f'  <Experiment name="smoke test" description={quoteattr(description)}>\n'
        f'    <TransientSimulation startTime="0" stopTime="{STEP * (ROWS - 1)}" stepSize="{STEP}"/>\n'
        + ('    <Parameters source="smoke-test.ssv"/>\n' if has_parameters else "")
        + '    <Stimuli source="smoke-test-in.csv"/>\n    <References source="smoke-test-ref.csv"/>\n  </Experiment>\n</Experiments>\n'
    )


def manifest(description, has_parameters):
    related = [("application/x-ma-hs-experiments", "smoke-test.exp", "experiment/smoke-test", description)]
    if has_parameters:
        related.append(("application/x-ssp-parameter-set", "smoke-test.ssv", "parameter", "Parameters of the smoke test"))
    related.append(("text/csv", "smoke-test-in.csv", "other", "Stimuli of the smoke test"))
    related.append(("text/csv", "smoke-test-ref.csv", "result", "Results of the smoke test, by FMPy"))
    rows = [f'  <Related type="{kind}" source="{source}" role="{role}" description={quoteattr(words)}/>\n' for kind, source, role, words in related]
    return (
        f'{HEAD}<fmiReferences xmlns:fmi-ls="http://fmi-standard.org/fmi-ls-manifest"\n    fmi-ls:fmi-ls-name="{STANDARD}"\n'
        '    fmi-ls:fmi-ls-version="1.0.0-alpha.1"\n'
        '    fmi-ls:fmi-ls-description="Layered Standard providing information on related files included in an FMU.">\n'
        + "".join(rows)
        + "</fmiReferences>\n"
    )


def main():
    for unit, (identifier, description, parameters, courses) in UNITS.items():
        given = stimuli(courses)
        files = {
            "fmi-ls-manifest.xml": manifest(description, bool(parameters)),
            "smoke-test.exp": experiment(description, bool(parameters)),
            "smoke-test-in.csv": csv(given),
            "smoke-test-ref.csv": csv(results(ROOT / "target" / "fmus" / f"{identifier}.fmu", parameters, given)),
        }
        if parameters:
            files["smoke-test.ssv"] = parameter_set(f"{identifier}: smoke test", parameters)
        folder(unit).mkdir(parents=True, exist_ok=True)
        for name, text in files.items():
            (folder(unit) / name).write_text(text)


if __name__ == "__main__":
    main()
