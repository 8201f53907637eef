"""Several units in a scenario, and units that nothing can start within a run."""

import dataclasses
import json

import pytest

from . import sets
from .machines import ALL
from .replay import closed
from .test_amended import run


def diagnosed(name, case, folder, **changes):
    machine = dataclasses.replace(ALL[name], **changes)
    units = {name: machine.build(machine, folder)}
    sets.make(machine, case, 5, folder / "set", folder / "answers", units)
    run("diagnose", folder / "set", "--out", folder / "said")
    answer = json.loads((folder / "answers" / "set.json").read_text())
    return answer, json.loads((folder / "said" / "diagnosis.json").read_text())


@pytest.mark.parametrize("case", ["k_o", "T_b:offset"])
def test_an_effect_in_one_of_two_units_that_are_connected_both_ways(case, tmp_path):
    answer, said = diagnosed("heating", case, tmp_path, runs=2, duration=12_000.0)
    assert [effect["name"] for effect in said["effects"]] == [answer["effects"][0]["name"]], said["effects"]
    # what the nominal scenario leaves to a run that nobody saw; units hold each other's values for a step
    assert closed(tmp_path / "set", tmp_path / "said" / "amended.toml", answer) > 0.9


def test_nothing_in_two_units(tmp_path):
    _, said = diagnosed("heating", "none", tmp_path, runs=2, duration=12_000.0)
    assert (said["verdict"], said["effects"]) == ("none", [])


@pytest.mark.parametrize("case", ["none", "k_a", "door"])
def test_a_unit_whose_states_nobody_can_set_is_simulated_whole(case, tmp_path):
    answer, said = diagnosed("cabin", case, tmp_path, runs=2, duration=30_000.0)
    assert any("simulated whole" in notice["message"] for notice in said["notices"]), said["notices"]
    wanted = {"none": ("none", []), "k_a": ("named", ["cabin.k_a"]), "door": ("unknown", None)}[case]
    names = [effect["name"] for effect in said["effects"]]
    assert (said["verdict"], names if wanted[1] is not None else None) == wanted, said["effects"]
