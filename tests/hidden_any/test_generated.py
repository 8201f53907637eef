"""Units that can't be begun anew anywhere: as code generators make them (`shed`), or with a state that nobody lists. A diagnosis follows their
ways and says so."""

import dataclasses
import json
import subprocess
import zipfile
from pathlib import Path

import numpy as np
import pytest

from . import sets
from .machine import Parameter
from .machines import ALL, house
from .machines.motor import C as MOTOR
from .unit_c import build
from .unit_python import environment

PROGRAM = Path(__file__).resolve().parents[2] / "target" / "release" / "acroscope"


def diagnosed(machine, case, seed, folder, more=""):
    units = {machine.name: machine.build(machine, folder)}
    sets.make(machine, case, seed, folder / "set", folder / "answers", units)
    with (folder / "set" / "dataset.toml").open("a") as file:
        file.write(more)
    return told(folder)


def told(folder):
    command = [PROGRAM, "--quiet", "diagnose", folder / "set", "--out", folder / "said"]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False, env=environment())
    assert done.returncode == 0, done.stderr
    return json.loads((folder / "said" / "diagnosis.json").read_text())


def test_the_last_part_of_a_single_run_is_simulated_from_its_begin(tmp_path):
    said = diagnosed(dataclasses.replace(ALL["shed"], runs=1), "k_a", 7, tmp_path)
    assert [effect["name"] for effect in said["effects"]] == ["shed.k_a"], said["effects"]
    # begun anew in its middle, half of the gap stayed open for the right model
    assert said["gap"]["closed"] > 0.95, said["gap"]


@pytest.mark.long
def test_a_name_that_widens_the_gap_beside_something_unlisted_is_withdrawn(tmp_path):
    motor = ALL["motor"]
    runs = sets.Runs(motor, np.random.default_rng(5), 7)
    pushes = [sets.trace(motor, runs.rng, times)[1] for times in runs.times]
    # heavier by two fifths but in the last run, which is left out: there lighter by half as much
    both = runs.outputs([{"J": 1.4 * 0.05}, {"J": 0.8 * 0.05}], disturb=pushes)
    clean = [{name: values[:, int(run is both[-1])] for name, values in run.items()} for run in both]
    sets.write(motor, runs, clean, runs.rng, tmp_path / "set", {"motor": motor.build(motor, tmp_path)})
    said = told(tmp_path)
    assert said["verdict"] == "unknown" and said["effects"] == [], said["effects"]
    assert any(line.startswith("motor.J is withdrawn") for line in said["story"]), said["story"]
    # what is told is the gap of the model that is left
    assert all(gap["after"] == gap["before"] for gap in said["gaps"]), said["gaps"]


def test_a_payload_in_one_run_is_told_with_its_run(tmp_path):
    motor = ALL["motor"]
    runs = sets.Runs(motor, np.random.default_rng(1), 4)
    both = runs.outputs([{"J": 0.05}, {"J": 0.07}])
    clean = [{name: values[:, int(run is both[1])] for name, values in run.items()} for run in both]
    sets.write(motor, runs, clean, runs.rng, tmp_path / "set", {"motor": motor.build(motor, tmp_path)})
    said = told(tmp_path)
    assert said["verdict"] == "unknown" and said["effects"] == [], said["effects"]
    shape = said["unknown"]["shape"]
    assert shape.startswith("runs that differ: motor.J (inertia of motor and load) would be ") and "; or " not in shape, shape
    values = [float(words.split(" in ")[0]) for words in shape.split(" would be ")[1].split(", ")]
    # each run knows its inertia to a part in a thousand
    assert np.allclose(values, [0.05, 0.07, 0.05, 0.05], rtol=3e-3), shape


def test_a_path_that_the_unit_cant_be_run_from_ends_no_diagnosis(tmp_path):
    reactor = dataclasses.replace(ALL["reactor"], duration=800.0)
    runs = sets.Runs(reactor, np.random.default_rng(0), 3)
    # a coolant at -133 degC stops the reaction: no row tells the concentration any more, and with what is read of it the unit's solver fails
    clean = [{name: values[:, 0] for name, values in run.items()} for run in runs.outputs([{"T_c:saturation": 140.0}])]
    sets.write(reactor, runs, clean, runs.rng, tmp_path / "set", {"reactor": reactor.build(reactor, tmp_path)})
    said = told(tmp_path)
    assert said["verdict"] != "none" and said["gap"]["closed"] > 0.9, (said["verdict"], said["gap"])


def test_a_state_that_no_output_tells_of_for_a_while_is_followed_through_whole_runs(tmp_path):
    valve = ALL["valve"]
    runs = sets.Runs(valve, np.random.default_rng(1), 3)
    clean = [{name: values[:, 0] for name, values in run.items()} for run in runs.outputs([{"overlap": 0.1}])]
    sets.write(valve, runs, clean, runs.rng, tmp_path / "set", {"valve": valve.build(valve, tmp_path)})
    said = told(tmp_path)
    # within the overlap a row forgets where the spool went: begun anew from row to row, the truth left something without a name
    assert [effect["name"] for effect in said["effects"]] == ["valve.overlap"] and said["verdict"] == "named", said["effects"]
    assert abs(said["effects"][0]["value"] - 0.1) < 1e-3 and said["gap"]["closed"] > 0.99, said
    assert any("lost where no output tells of it" in str(notice) for notice in said["notices"]), said["notices"]


def test_a_sensors_lag_below_a_row_is_not_called_a_delay(tmp_path):
    said = diagnosed(dataclasses.replace(ALL["motor"], runs=4), "w:lag", 3, tmp_path)
    # least squares by scipy over start states and either: chi2 of 7203.2 with the lag, of 7208.3 with a delay, so that both are told
    assert {name for effect in said["effects"] for name in effect["class"]} == {"motor.w:lag", "motor.w:delay"}, said["effects"]
    assert said["effects"][0]["name"] == "motor.w:lag", said["effects"]


@pytest.mark.long
def test_effects_that_stand_for_parts_of_pushes_are_not_collected(tmp_path):
    said = diagnosed(ALL["car"], "door", 613, tmp_path)
    assert said["verdict"] == "unknown" and said["effects"] == [], said["effects"]
    # five were, and dropped again, which took 240 s
    assert not any("explains" in line for line in said["story"]), said["story"]


@pytest.mark.long
def test_long_logs_are_searched_in_stretches_first(tmp_path):
    said = diagnosed(dataclasses.replace(ALL["motor"], duration=60.0), "fc", 3, tmp_path)
    assert [effect["name"] for effect in said["effects"]] == ["motor.fc"], said["effects"]
    assert said["gap"]["closed"] > 0.99, said["gap"]
    # the answer is that of all rows, and says how it came about
    assert any("24004 rows" in line for line in said["story"]), said["story"]
    told = [notice["message"] if isinstance(notice, dict) else notice for notice in said["notices"]]
    # 200 000 rows times parameters, with 28 of these, in stretches of 360 rows: as quick as a short log, and a fit of all rows after it
    assert any("of 24004 rows some 7142 in 19 stretches" in line for line in told), told


def test_what_a_unit_does_its_own_way_is_told(tmp_path):
    said = diagnosed(ALL["shed"], "none", 7, tmp_path)
    told = " ".join(notice["message"] if isinstance(notice, dict) else notice for notice in said["notices"])
    assert said["verdict"] == "none"
    for words in ("fmi2Reset doesn't bring the unit back", "begins at 0 whatever start time", "makes steps of one size"):
        assert words in told, told


# whole runs, and rows that are linked
@pytest.mark.parametrize(
    ("name", "code", "outputs", "step", "case"),
    [("shed", house.C, "v[T_b] = x[1]; v[T_a] = x[0]", 60.0, "k_a"), ("motor", MOTOR, "v[i] = x[0]; v[phi] = x[2]; v[w] = x[1]", 5e-4, "fc")],
)
def test_a_parameter_that_the_unit_cant_be_run_with_is_told(name, code, outputs, step, case, tmp_path):
    fragile = Parameter("fragile", "1", 1.0, 0.1, 10.0, "relative", "a value that the unit bears as it is only", 0.5)
    outputs += " + sqrt(-(v[fragile] - 1.0) * (v[fragile] - 1.0));"
    machine = dataclasses.replace(
        ALL[name],
        parameters=(*ALL[name].parameters, fragile),
        build=lambda machine, folder: build(machine, folder, code, outputs, step=step, old=name == "shed"),
    )
    said = diagnosed(machine, case, 7, tmp_path)
    assert [effect["name"] for effect in said["effects"]] == [f"{name}.{case}"], said["effects"]
    told = " ".join(map(str, said["notices"]))
    assert f"with {name}.fragile = " in told and "the unit can't be run" in told, told


def test_a_value_that_the_unit_has_against_its_description_is_its_own(tmp_path):
    def described_otherwise(machine, folder):
        path = ALL["sled"].build(machine, folder)
        with zipfile.ZipFile(path) as archive:
            files = {name: archive.read(name) for name in archive.namelist()}
        text = files["modelDescription.xml"].decode()
        assert 'start="400.0"' in text
        files["modelDescription.xml"] = text.replace('start="400.0"', 'start="300.0"').encode()
        with zipfile.ZipFile(path, "w") as archive:
            for name, content in files.items():
                archive.writestr(name, content)
        return path

    said = diagnosed(dataclasses.replace(ALL["sled"], build=described_otherwise), "none", 5, tmp_path)
    # as described it would lack a third of its stiffness
    assert (said["verdict"], said["effects"]) == ("none", [])
    assert "sled.k starts at 300 by the description and at 400 in the unit" in " ".join(map(str, said["notices"]))


@pytest.mark.parametrize("case", ["none", "m"])
def test_outputs_that_are_computed_in_a_step_only_are_read_after_one(case, tmp_path):
    # begun anew in each row, the unit shows no acceleration, and forgets what was set before initialization mode
    said = diagnosed(ALL["sled"], case, 5, tmp_path)
    assert "acceleration is computed in a step only" in " ".join(map(str, said["notices"]))
    named = [effect["class"] for effect in said["effects"]]
    assert named == [] if case == "none" else len(named) == 1 and "sled.m" in named[0], said["effects"]


@pytest.mark.parametrize("case", ["none", "b"])
def test_a_state_that_nobody_lists_is_followed_through_whole_runs(case, tmp_path):
    # the motor's current begins anew at 0 with each row, as if each were a blow
    listed = "".join(f'\n[[state]]\nstart = "motor.{name}"\n' for name in ("w", "phi"))
    said = diagnosed(ALL["motor"], case, 5, tmp_path, listed)
    assert [effect["name"] for effect in said["effects"]] == [f"motor.{case}"] * (case != "none"), said["effects"]
    assert said["verdict"] == ("none" if case == "none" else "named")


# the tank in C: quick, and with nothing that a leak would be taken for
TANK = dataclasses.replace(
    ALL["tank"],
    parameters=tuple(dataclasses.replace(one, unit="1", hide=one.hide * (one.name != "leak")) for one in ALL["tank"].parameters),
    build=lambda machine, folder: build(
        machine,
        folder,
        """const double one = sqrt(19.62 * fmax(x[0], 1e-6)), two = sqrt(19.62 * fmax(x[1], 1e-6));
        dx[0] = 1e-4 * (v[q_pump] * v[u] - (v[a_1] + v[leak]) * one) / v[A_1]; dx[1] = 1e-4 * (v[a_1] * one - v[a_2] * two) / v[A_2];""",
        "v[h_1] = x[0]; v[h_2] = x[1];",
        step=0.5,
    ),
)


@pytest.mark.parametrize("case", ["none", "A_1"])
def test_a_state_that_nobody_lists_beside_one_that_no_variable_shows_is_told(case, tmp_path):
    # the lower tank begins anew with each row; the upper one is read through what the levels do
    upper, lower = TANK.states
    tank = dataclasses.replace(TANK, states=(upper, dataclasses.replace(lower, spread=0.0)))
    sets.make(tank, case, 5, tmp_path / "set", tmp_path / "answers", {"tank": tank.build(tank, tmp_path)})
    path = tmp_path / "set" / "dataset.toml"
    lower_listed = '[[state]]\nstart = "tank.h_2_0"\nshows = "tank.h_2"\n'
    assert lower_listed in path.read_text()
    path.write_text(path.read_text().replace(lower_listed, "").replace('shows = "tank.h_1"\n', ""))
    said = told(tmp_path)
    assert "remembers more than the states that can be set" in " ".join(map(str, said["notices"])), said["notices"]
    assert [effect["name"] for effect in said["effects"]] == [f"tank.{case}"] * (case != "none"), said["effects"]
    assert said["verdict"] == ("none" if case == "none" else "named")


def test_two_effects_that_hide_each_other_are_named(tmp_path):
    # a wider tank and a stronger pump: the level rises as before, and falls more slowly
    runs = sets.Runs(TANK, np.random.default_rng(2), 3)
    clean = [{name: values[:, 0] for name, values in run.items()} for run in runs.outputs([{"A_1": 0.023, "q_pump": 0.66}])]
    sets.write(TANK, runs, clean, runs.rng, tmp_path / "set", {"tank": TANK.build(TANK, tmp_path)})
    said = told(tmp_path)
    found = {effect["name"]: effect for effect in said["effects"]}
    # what the data leave open is the same by its equations: of pump and input either may be the stronger
    assert said["verdict"] == "ambiguous" and len(found) == 2 and "tank.A_1" in found, said["effects"]
    assert abs(found["tank.A_1"]["value"] - 0.023) < 2e-4, found
    assert {name for effect in said["effects"] for name in effect["class"]} == {"tank.A_1", "tank.q_pump", "tank.u:gain"}, said["effects"]


def test_a_late_sensor_whose_output_follows_an_input_at_once_is_in_the_class(tmp_path):
    # the voltage jumps with the current: what a row showed until it jumped lies on the line of the interval before
    cell = ALL["cell"]
    runs = sets.Runs(cell, np.random.default_rng(4), 3)
    clean = [{name: values[:, 0] for name, values in run.items()} for run in runs.outputs([{"v_cell:delay": 0.4 * cell.row}])]
    sets.write(cell, runs, clean, runs.rng, tmp_path / "set", {"cell": cell.build(cell, tmp_path)})
    said = told(tmp_path)
    # a later current is a later voltage; the temperature hardly tells the two apart
    assert [set(effect["class"]) for effect in said["effects"]] == [{"cell.i:delay", "cell.v_cell:delay"}], said["effects"]
    low, high = said["effects"][0]["ci95"]
    assert low < 0.4 * cell.row < high, said["effects"]
