"""States that an output shows only while a parameter is as it is: a capacitor's voltage, by its terminals."""

import dataclasses
import json

import numpy as np

from . import sets
from .machine import Parameter, State
from .machines import ALL
from .machines.buck import C
from .test_amended import run
from .unit_c import build

BUCK = ALL["buck"]


def outputs(x, u, p):
    return np.array([x[0], (x[1] + p["esr"] * x[0]) / (1.0 + p["esr"] / p["R"])])


def rhs(x, u, p):
    return BUCK.rhs(np.array([x[0], outputs(x, u, p)[1]]), u, p)


def unit(machine, folder):
    shown = "(x[1] + v[esr] * x[0]) / (1 + v[esr] / v[R])"
    derivatives = f"const double shown = {shown};" + C.replace(" x[1]", " shown")
    return build(machine, folder, derivatives, f"v[i] = x[0]; v[v_out] = {shown};", step=2e-6)


def test_a_resistance_beside_which_an_output_is_no_state_any_more(tmp_path):
    esr = Parameter("esr", "Ohm", 0.0, 0.0, 1.0, "absolute", "series resistance of the capacitor", 0.3)
    machine = dataclasses.replace(
        BUCK,
        states=(BUCK.states[0], State("v_out", "V", "v_C0", 12.0, 0.5)),
        parameters=(*BUCK.parameters, esr),
        rhs=rhs,
        outputs=outputs,
        build=unit,
        runs=2,
    )
    for case in ("esr", "none"):
        sets.make(machine, case, 5, tmp_path / case, tmp_path / "answers", {"buck": unit(machine, tmp_path)})
        assert 'shows = "buck.v_out"' in (tmp_path / case / "dataset.toml").read_text()
        run("diagnose", tmp_path / case, "--out", tmp_path / "said")
        said = json.loads((tmp_path / "said" / "diagnosis.json").read_text())
        assert any("only while buck.esr is as it is" in notice["message"] for notice in said["notices"]), said["notices"]
        names = [effect["name"] for effect in said["effects"]]
        assert (said["verdict"], names) == (("named", ["buck.esr"]) if case == "esr" else ("none", []))
        if case == "esr":
            truth = json.loads((tmp_path / "answers" / "esr.json").read_text())["effects"][0]["value"]
            assert abs(said["effects"][0]["value"] / truth - 1) < 0.02, "a few of its deviations"
