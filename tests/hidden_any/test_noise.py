"""What is white and what is not: noise of an input that was measured is nothing that a model lacks; a wave that nobody lists is, however short."""

import json

import numpy as np
import pytest

from . import sets
from .machines import ALL
from .test_doubts import changed, diagnosed


@pytest.fixture
def made(tmp_path):
    """`made(name, case)`: a set of a machine."""

    def of(name, case):
        units = {name: ALL[name].build(ALL[name], tmp_path)}
        sets.make(ALL[name], case, 33, tmp_path / name, tmp_path / "answers", units)
        return tmp_path / name

    return of


def told(folder):
    status, said = diagnosed(folder)
    assert status == 0, said
    return json.loads((folder / "found" / "diagnosis.json").read_text())


def with_noise(named):
    """A change of an input's column: noise of 2 % of its range."""
    rng = np.random.default_rng(3)

    def change(head, values):
        place = next(place for place, name in enumerate(head) if name.startswith(named))
        values[:, place] += 0.02 * np.ptp(values[:, place]) * rng.normal(size=len(values))

    return change


def with_wave(rows, times):
    """A change of the speed's column: a wave of so many rows, so many times what neighbouring rows scatter by."""

    def change(head, values):
        place = head.index("w")
        scatter = np.median(np.abs(np.diff(values[:, place], 3))) / 0.6745 / np.sqrt(20)
        values[:, place] += times * scatter * np.sqrt(2) * np.sin(2 * np.pi * np.arange(len(values)) / rows)

    return change


@pytest.mark.parametrize(("name", "fed"), [("drive", "torque"), ("cart", "force")])
def test_noise_of_a_measured_input_is_nothing_that_the_model_lacks(made, name, fed):
    found = told(changed(made(name, "none"), with_noise(fed)))
    assert (found["verdict"], found["effects"]) == ("none", [])
    assert any("noise of the logged inputs" in line for line in found["story"]), found["story"]


@pytest.mark.long
def test_pushes_that_nobody_lists_are_unknown_beside_noise_of_the_input(made):
    assert told(changed(made("cart", "door"), with_noise("force")))["verdict"] == "unknown"


@pytest.mark.parametrize("rows", [3, 4, 8])
def test_a_wave_of_some_rows_is_no_noise(made, rows):
    assert told(changed(made("motor", "none"), with_wave(rows, 5.0)))["verdict"] == "unknown"
