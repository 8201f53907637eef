"""`acroscope import` finds columns, units, signs and starts, and the tutorial's commands work."""

import dataclasses
import os
import re
import subprocess
import sys
import zipfile

import numpy as np
import pytest

from .importing import PROGRAM, ROOT, channels, log, run
from .machine import Input, Output, Parameter, State
from .machines import ALL
from .unit_c import build


@pytest.fixture
def motor(tmp_path):
    return ALL["motor"].build(ALL["motor"], tmp_path)


def test_starts_by_trial_and_what_changes_nothing(tmp_path):
    sled = ALL["sled"]
    z, w = sled.states
    states = (dataclasses.replace(z, start="initialPlace"), dataclasses.replace(w, start="rateInit"))
    idle = Parameter("plot", "1", 3.0, 0.0, 1e9, "relative", "how often a plot is drawn", 0.5)
    machine = dataclasses.replace(sled, states=states, parameters=(*sled.parameters, idle))
    unit = machine.build(machine, tmp_path)
    heads = {name: (name, 1.0, 0.0) for name in ("force", "z", "w", "acceleration")}
    run("import", log(tmp_path / "a.csv", machine, heads), "--fmu", unit, "--out", tmp_path / "set")
    _, head = channels(tmp_path / "set")
    assert head["state"] == [{"start": "sled.initialPlace", "shows": "sled.z"}, {"start": "sled.rateInit", "shows": "sled.w"}]
    # struck out, not lost
    assert [one["variable"] for one in head["candidate"]] == ["sled.m", "sled.k", "sled.d", "sled.f_c"]
    assert '# variable = "sled.plot"' in (tmp_path / "set" / "dataset.toml").read_text()


@pytest.mark.parametrize("second, interval", [("y", 0.05), ("y", 0.002), ("second_0", 0.05)])
def test_a_start_that_no_variable_shows_is_a_state_where_the_model_remembers_it(tmp_path, second, interval):
    # two lags in a row; only the second is seen, or twice its value. T_0 is called like a start and is none.
    equations = "dx[0] = (v[u] - x[0]) / v[T_0]; dx[1] = (x[0] - x[1]) / 0.5;"
    gain = 1 if second == "y" else 2
    machine = dataclasses.replace(
        ALL["sled"], name="lags", late="", saves_state=True, states=(State("first", "V", "first_0", 0.0, 0.0), State("second", "V", second, 0.0, 0.0)),
        inputs=(Input("u", "V", 0.0, 1.0, "V"),), outputs_of=(Output("y", "V", 1e-3, "V"),),
        parameters=(Parameter("T_0", "1", 0.3, 0.01, 10.0, "relative", "time constant of the first", 0.5),),
        build=lambda machine, folder: build(machine, folder, equations, f"v[y] = {gain} * x[1];", step=min(0.01, interval)),
    )  # fmt: skip
    times, lags, rows = interval * np.arange(round(10 / interval)), np.zeros(2), []
    for time in times:
        rows.append((time, np.sign(np.sin(time)), gain * lags[1]))
        for _ in range(round(interval / 0.001)):
            lags = lags + 0.001 * np.array([(rows[-1][1] - lags[0]) / 0.3, (lags[0] - lags[1]) / 0.5])
    (tmp_path / "a.csv").write_text("time,u,y\n" + "".join(",".join(map(str, row)) + "\n" for row in rows))
    said = run("import", tmp_path / "a.csv", "--fmu", machine.build(machine, tmp_path), "--out", tmp_path / "set")
    _, head = channels(tmp_path / "set")
    assert {"start": "lags.first_0"} in head["state"], said
    assert ({"start": "lags.y", "shows": "lags.y"} if second == "y" else {"start": "lags.second_0"}) in head["state"], said
    assert [one["variable"] for one in head["candidate"]] == ["lags.T_0"]


@pytest.mark.parametrize("rows", [12, 300])
def test_a_start_whose_variable_is_called_otherwise_is_found_in_any_log(tmp_path, rows):
    machine = dataclasses.replace(
        ALL["sled"], name="lag", late="", saves_state=True, states=(State("x", "V", "x_0", 0.5, 0.0),),
        inputs=(Input("u", "V", 0.0, 1.0, "V"),), outputs_of=(Output("y", "V", 1e-3, "V"),),
        parameters=(Parameter("T", "1", 0.3, 0.01, 10.0, "relative", "time constant", 0.5),),
        build=lambda machine, folder: build(machine, folder, "dx[0] = (v[u] - x[0]) / v[T];", "v[y] = x[0];", step=0.01),
    )  # fmt: skip
    times = 0.05 * np.arange(rows)
    log = "".join(f"{time},{np.sign(np.sin(time))},{0.3 * np.cos(time)}\n" for time in times)
    (tmp_path / "a.csv").write_text("time,u,y\n" + log)
    said = run("import", tmp_path / "a.csv", "--fmu", machine.build(machine, tmp_path), "--out", tmp_path / "set")
    assert channels(tmp_path / "set")[1]["state"] == [{"start": "lag.x_0", "shows": "lag.y"}], said


def unit(folder, name, states, parameters, equations, outputs, starts, rows=300, interval=0.1):
    """A unit with an input u, and a log of it that begins at `starts`. States are (name, start, its value), parameters (name, value, low, high)."""
    spread = [State(state, "1", start, value, 0.0) for state, start, value in states]
    values = [Parameter(of, "1", value, low, high, "relative", of, 0.5) for of, value, low, high in parameters]
    machine = dataclasses.replace(
        ALL["sled"], name=name, late="", saves_state=True, states=tuple(spread), inputs=(Input("u", "1", 0.0, 1.0, "1"),),
        outputs_of=(Output("y", "1", 1e-3, "1"),), parameters=tuple(values),
        build=lambda machine, folder: build(machine, folder, equations, outputs, step=interval / 10),
    )  # fmt: skip
    names = {one: one for one in ["u", "y", *(of for of, *_ in parameters)]}
    python = {part: compile(part.replace("; ", "\n"), name, "exec") for part in (equations, outputs)}
    given = {of: value for of, value, *_ in parameters}

    def slopes(x, u):
        slope = np.zeros(len(x))
        exec(python[equations], names | {"v": given | {"u": u}, "x": x, "dx": slope, "fmax": max})
        return slope

    x, lines, step = np.array(starts, float), ["time,u,y"], interval / 10
    for row in range(rows):
        u = float(np.sign(np.sin(0.7 * row * interval)))
        shown = given | {"u": u}
        exec(python[outputs], names | {"v": shown, "x": x})
        lines.append(f"{row * interval},{u},{shown['y']}")
        for _ in range(10):
            x = x + step * slopes(x + 0.5 * step * slopes(x, u), u)
    (folder / "a.csv").write_text("\n".join(lines) + "\n")
    return machine.build(machine, folder)


# a wall that holds its heat far longer than the log, at rest where the unit starts; a second tank; a rest that dies out, and is 0 where the unit starts
WALL = "dx[0] = v[u] - 0.3 * x[0] + v[G] * (x[1] - x[0]); dx[1] = v[G] * (x[0] - x[1]) / v[C]"
AT_REST = {
    "wall": ([("air", "y", 0.0), ("wall", "T_wall_start", 0.0)], [("G", 0.3, 0.01, 3.0), ("C", 900.0, 1.0, 9e4)], WALL, "v[y] = x[0]", [0.0, 5.0]),
    "rest": ([("air", "y", 0.0), ("left", "x2_0", 0.0)], [("G", 0.3, 0.01, 3.0), ("C", 9.0, 1.0, 9e4)],
             "dx[0] = v[u] - 0.3 * x[0] + v[G] * x[1]; dx[1] = -x[1] / v[C]", "v[y] = x[0]", [0.0, 5.0]),
    "row": ([("one", "y", 1.0), ("two", "two_0", 1.0), ("three", "three_0", 1.0)], [("G", 0.3, 0.01, 3.0), ("T_0", 4.0, 0.1, 40.0)],
            "dx[0] = v[u] - 0.3 * x[0] + v[G] * (x[1] - x[0]); dx[1] = v[G] * (x[0] + x[2] - 2 * x[1]); dx[2] = (x[1] - x[2]) / v[T_0]",
            "v[y] = x[0]", [1.0, 2.0, 0.5]),
}  # fmt: skip


@pytest.mark.parametrize("name", AT_REST)
def test_a_start_of_a_state_that_rests_or_hardly_moves_is_no_constant(tmp_path, name):
    states, parameters, equations, outputs, starts = AT_REST[name]
    fmu = unit(tmp_path, name, states, parameters, equations + ";", outputs + ";", starts)
    said = run("import", tmp_path / "a.csv", "--fmu", fmu, "--out", tmp_path / "set")
    _, head = channels(tmp_path / "set")
    wanted = [{"start": f"{name}.y", "shows": f"{name}.y"}, *({"start": f"{name}.{start}"} for _, start, _ in states[1:])]
    assert head["state"] == wanted, said
    # what acts once the state is elsewhere is no idle parameter, and a constant that is called like a start is no state
    assert [one["variable"] for one in head["candidate"]] == [f"{name}.{of}" for of, *_ in parameters], said


def test_a_start_that_no_name_tells_is_found_by_trial(tmp_path):
    states = [("one", "h_begin", 1.0), ("two", "depth", 1.0)]
    parameters = [("G", 0.3, 0.01, 3.0), ("C", 4.0, 0.1, 40.0)]
    fmu = unit(tmp_path, "tanks", states, parameters, WALL + ";", "v[y] = x[0];", [0.5, 2.0])
    said = run("import", tmp_path / "a.csv", "--fmu", fmu, "--out", tmp_path / "set")
    _, head = channels(tmp_path / "set")
    assert head["state"] == [{"start": "tanks.h_begin", "shows": "tanks.y"}, {"start": "tanks.depth"}], said
    assert [one["variable"] for one in head["candidate"]] == ["tanks.G", "tanks.C"]


def test_what_acts_only_beside_another_or_far_off_is_not_idle(tmp_path):
    # a stop that is not there, an inhibition that begins at 1e9; and what nothing reads
    parameters = [("d", 0.5, 0.05, 5.0), ("k_st", 0.0, 0.0, 100.0), ("x_st", 2.0, 0.0, 50.0), ("K_i", 1e9, 1e-3, 1e9), ("plot", 3.0, 0.0, 1e9)]
    equations = "dx[0] = v[u] - v[d] * x[0] / (1 + x[0] * x[0] / v[K_i]) - v[k_st] * fmax(0.0, x[0] - v[x_st]);"
    fmu = unit(tmp_path, "stop", [("x", "y", 0.0)], parameters, equations, "v[y] = x[0];", [0.0])
    said = run("import", tmp_path / "a.csv", "--fmu", fmu, "--out", tmp_path / "set")
    assert [one["variable"] for one in channels(tmp_path / "set")[1]["candidate"]] == [f"stop.{of}" for of in ("d", "k_st", "x_st", "K_i")], said
    assert '# variable = "stop.plot"' in (tmp_path / "set" / "dataset.toml").read_text()


def test_what_is_computed_of_a_state_does_not_show_it(tmp_path):
    # a tachometer behind a gear of 1: with another gear it shows another speed, and the state is as it was
    machine = dataclasses.replace(
        ALL["sled"], name="drum", late="", saves_state=True, states=(State("w", "rad/s", "w_0", 0.0, 0.0),),
        inputs=(Input("u", "V", 0.0, 1.0, "V"),), outputs_of=(Output("seen", "rad/s", 1e-3, "rad/s"),),
        parameters=(Parameter("ratio", "1", 1.0, 0.1, 10.0, "relative", "ratio of the gear", 0.5), Parameter("T", "s", 0.3, 0.01, 10.0, "relative", "time constant", 0.5)),
        build=lambda machine, folder: build(machine, folder, "dx[0] = (v[u] - x[0]) / v[T];", "v[seen] = v[ratio] * x[0];", step=0.01),
    )  # fmt: skip
    times = 0.05 * np.arange(300)
    log = "".join(f"{time},{np.sign(np.sin(time))},{0.3 * np.cos(time)}\n" for time in times)
    (tmp_path / "a.csv").write_text("time,u,seen\n" + log)
    run("import", tmp_path / "a.csv", "--fmu", machine.build(machine, tmp_path), "--out", tmp_path / "set")
    assert all("shows" not in one for one in channels(tmp_path / "set")[1].get("state", [])), channels(tmp_path / "set")[1]


def test_a_unit_that_ends_its_process_with_other_values_is_imported(tmp_path):
    machine = dataclasses.replace(
        ALL["sled"], name="brittle", late="", saves_state=True, states=(State("x", "V", "x_0", 0.5, 0.0),),
        inputs=(Input("u", "V", 0.0, 1.0, "V"),), outputs_of=(Output("y", "V", 1e-3, "V"),),
        parameters=(Parameter("T", "1", 0.3, 0.01, 10.0, "relative", "time constant", 0.5),),
        build=lambda machine, folder: build(machine, folder, "dx[0] = (v[u] - x[0]) / v[T];", "if (v[T] != 0.3) abort(); v[y] = x[0];", step=0.01),
    )  # fmt: skip
    times = 0.05 * np.arange(100)
    log = "".join(f"{time},{np.sign(np.sin(time))},{0.3 * np.cos(time)}\n" for time in times)
    (tmp_path / "a.csv").write_text("time,u,y\n" + log)
    run("import", tmp_path / "a.csv", "--fmu", machine.build(machine, tmp_path), "--out", tmp_path / "set")
    assert channels(tmp_path / "set")[1]["state"] == [{"start": "brittle.x_0", "shows": "brittle.y"}]


def test_degrees_under_a_header_that_says_kelvin_are_not_taken_for_an_offset(tmp_path):
    # where nothing starts the model, an offset is tried: of all that comes near, the unit of measurement is the exact one
    house = ALL["house"]
    heads = {one.name: (f"{one.name} [{one.unit}]", 1.0, 0.0) for one in house.inputs}
    heads |= {one.name: (f"{one.name} [K]", 1.0, 273.15) for one in house.outputs_of}
    path = log(tmp_path / "a.csv", dataclasses.replace(house, fixed=True), heads)
    said = run("import", path, "--fmu", house.build(dataclasses.replace(house, fixed=True), tmp_path), "--out", tmp_path / "set")
    table, _ = channels(tmp_path / "set")
    for one in house.outputs_of:
        assert table[f"house.{one.name}"].get("offset", 273.15) == 273.15, said
        assert "whatever its header says" in said, said


def test_an_import_that_fails_leaves_nothing(motor, tmp_path):
    heads = {"u": ("u", 1, 0), "i": ("i", 1, 0), "w": ("w", 1, 0), "phi": ("phi", 1, 0)}
    file = log(tmp_path / "a.csv", ALL["motor"], heads)
    # time that stands still is seen when all columns are read
    lines = file.read_text().splitlines()
    file.write_text("\n".join([lines[0], *(",".join(["1.0", *line.split(",")[1:]]) for line in lines[1:])]) + "\n")
    run("import", file, "--fmu", motor, "--out", tmp_path / "set", status=2)
    assert not (tmp_path / "set").exists()
    # what only the whole data set shows: a unit that nobody knows, a clock that begins again; both are told of the user's own log
    file = log(tmp_path / "a.csv", ALL["motor"], heads | {"w": ("w [furlong]", 1, 0)})
    said = run("import", file, "--fmu", motor, "--out", tmp_path / "set", status=2)
    assert f'{file}:1: column "w [furlong]": unit = "furlong"' in said and not (tmp_path / "set").exists(), said
    head, *rows = log(file, ALL["motor"], heads).read_text().splitlines()
    again = [f"{float(row.split(',')[0]) - float(rows[150].split(',')[0])},{row.split(',', 1)[1]}" for row in rows[150:]]
    file.write_text("\n".join(["# rig 7", head, *rows[:150], *again]) + "\n")
    said = run("import", file, "--fmu", motor, "--out", tmp_path / "set", status=2)
    assert f'{file}:153: column "time": the clock begins again here' in said and "split the log" in said, said
    assert not (tmp_path / "set").exists()
    # the same command with the log mended
    run("import", log(tmp_path / "a.csv", ALL["motor"], heads), "--fmu", motor, "--out", tmp_path / "set")
    assert sorted(path.name for path in (tmp_path / "set").iterdir()) == ["dataset.toml", "motor.fmu", "run-01.csv"]


@pytest.mark.parametrize(("file", "name"), [("My Model v1.2 (1).fmu", "My_Model_v1_2_(1)"), ("a=b.fmu", "a_b"), ("A.B.motor.fmu", "A_B_motor")])
def test_a_unit_whose_file_is_called_as_no_instance_can_be(motor, tmp_path, file, name):
    heads = {"u": ("u", 1, 0), "i": ("i", 1, 0), "w": ("w", 1, 0), "phi": ("phi", 1, 0)}
    unit = motor.rename(tmp_path / file)
    run("import", log(tmp_path / "a.csv", ALL["motor"], heads), "--fmu", unit, "--out", tmp_path / "set")
    found, head = channels(tmp_path / "set")
    assert head["fmu"] == file and set(found) == {f"{name}.{one}" for one in heads}
    if file == "a=b.fmu":
        run("diagnose", tmp_path / "set", "--out", tmp_path / "out")


def test_signs_units_and_time(motor, tmp_path):
    heads = {"u": ("Motor u [mV]", 1e-3, 0), "i": ("i_mA", 1e-3, 0), "w": ("w", 2 * np.pi / 60, 0), "phi": ("phi (deg)", -np.pi / 180, 0)}
    file = log(tmp_path / "a.csv", ALL["motor"], heads, ";", ("t [ms]", 1e-3), {"b": 0.02}, gap=True)
    said = run("import", file, "--fmu", motor, "--out", tmp_path / "set")
    found, head = channels(tmp_path / "set")
    assert set(found) == {"motor.u", "motor.i", "motor.w", "motor.phi"}
    assert (found["motor.u"]["unit"], found["motor.i"]["unit"]) == ("mV", "mA")
    # no header says rpm: the model's slope does
    assert found["motor.w"]["unit"] == "rpm" and found["motor.w"]["column"] == "w"
    assert np.isclose(found["motor.phi"]["scale"], -np.pi / 180, rtol=1e-9) and found["motor.phi"]["offset"] == 0
    assert head["run"][0]["time"] == {"column": "t [ms]", "unit": "ms"}
    text = (tmp_path / "set" / "dataset.toml").read_text()
    assert "# guess: sign turned, by trial" in text and "# guess: in rpm, by trial" in text and "semicolons" in text
    assert "1 gap(s) in time" in said
    assert {entry["variable"] for entry in head["candidate"]} >= {"motor.b", "motor.R", "motor.fc"}


def test_units_as_people_write_them(motor, tmp_path):
    sled = ALL["sled"]
    heads = {"force": ("force [N]", 1, 0), "z": ("z [m]", 1, 0), "w": ("w [m/sec]", 1, 0), "acceleration": ("acc [g]", 9.80665, 0)}
    said = run("import", log(tmp_path / "a.csv", sled, heads), "--fmu", sled.build(sled, tmp_path), "--out", tmp_path / "set")
    found, _ = channels(tmp_path / "set")
    assert found["sled.acceleration"]["unit"] == "g" and "sled.acceleration: sign and size fit" in said, said
    heads = {"u": ("u [V]", 1, 0), "i": ("i [A]", 1, 0), "w": ("w [°/s]", np.pi / 180, 0), "phi": ("phi [deg]", 1, 0)}
    said = run("import", log(tmp_path / "b.csv", ALL["motor"], heads), "--fmu", motor, "--out", tmp_path / "angles")
    found, _ = channels(tmp_path / "angles")
    assert found["motor.w"]["unit"] == "°/s"
    # radians under a header that says degrees: told, and kept as written
    assert found["motor.phi"]["unit"] == "deg" and 'its header says deg, and its numbers are what the model says in rad' in said, said
    refused = run("diagnose", tmp_path / "angles", "--out", tmp_path / "out", status=2)
    assert "phi" in refused and 'unit = "rad"' in refused and "°" not in refused, refused


@pytest.mark.parametrize("change", [{}, {"J": 0.06, "R": 1.5}], ids=["follows", "lacks"])
@pytest.mark.parametrize("hold", ["linear", "zero"])
def test_how_an_input_runs_between_rows_is_told_by_what_fits(motor, tmp_path, hold, change):
    """A sine that a sensor measured runs on between rows; one that a computer set is held. The model tells, also where it lacks something."""
    smooth = dataclasses.replace(ALL["motor"].inputs[0], kind="slow", hold=hold)
    heads = {"u": ("u [V]", 1, 0), "i": ("i [A]", 1, 0), "w": ("w [rad/s]", 1, 0), "phi": ("phi [rad]", 1, 0)}
    file = log(tmp_path / "a.csv", dataclasses.replace(ALL["motor"], inputs=(smooth,)), heads, change=change)
    said = run("import", file, "--fmu", motor, "--out", tmp_path / "set")
    found, _ = channels(tmp_path / "set")
    assert found["motor.u"].get("hold", "zero") == hold and "it runs smoothly" in said, said
    # held is along lines half a row late, and what a model lacks may be a delay
    assert "less likely" in said or not change or hold == "zero", said


def test_a_turned_input_is_the_input(motor, tmp_path):
    heads = {"u": ("u", -1, 0), "i": ("i", 1, 0), "w": ("w", 1, 0), "phi": ("phi", 1, 0)}
    run("import", log(tmp_path / "a.csv", ALL["motor"], heads), "--fmu", motor, "--out", tmp_path / "set")
    found, _ = channels(tmp_path / "set")
    assert found["motor.u"]["scale"] == -1 and all("scale" not in found[f"motor.{name}"] for name in ("i", "w", "phi"))


def test_parameters_without_descriptions_may_be_off(motor, tmp_path):
    bare = tmp_path / "bare" / "motor.fmu"
    bare.parent.mkdir()
    with zipfile.ZipFile(motor) as old, zipfile.ZipFile(bare, "w") as new:
        for name in old.namelist():
            text = old.read(name)
            new.writestr(name, re.sub(rb'(<ScalarVariable[^>]*?) description="[^"]*"', rb"\1", text) if name == "modelDescription.xml" else text)
    heads = {"u": ("u", 1, 0), "i": ("i", 1, 0), "w": ("w", 1, 0), "phi": ("phi", 1, 0)}
    run("import", log(tmp_path / "a.csv", ALL["motor"], heads, change={"b": 0.02}), "--fmu", bare, "--out", tmp_path / "set")
    text = (tmp_path / "set" / "dataset.toml").read_text()
    assert '[[candidate]]\nvariable = "motor.b"' in text, "nothing to say of it"
    found = run("diagnose", tmp_path / "set", "--out", tmp_path / "out")
    assert "motor.b = " in found, found
    # and without any [[candidate]]
    (tmp_path / "set" / "dataset.toml").write_text(re.sub(r"\[\[candidate\]\][^\[]*", "", text))
    found = run("diagnose", tmp_path / "set", "--out", tmp_path / "again")
    assert "every parameter may be off" in found and "motor.b = " in found, found


def test_kelvins_of_a_unit_without_units(tmp_path):
    room = ALL["room"]
    fmu = room.build(room, tmp_path)
    heads = {"P": ("P [W]", 1, 0), "T_out": ("T_out [degC]", 1, 273.15), "T": ("T [°C]", 1, 273.15)}
    run("import", log(tmp_path / "a.csv", room, heads), "--fmu", fmu, "--out", tmp_path / "set")
    found, head = channels(tmp_path / "set")
    assert (found["room.T"]["scale"], found["room.T"]["offset"]) == (1, 273.15)
    assert (found["room.T_out"]["scale"], found["room.T_out"]["offset"]) == (1, 273.15)
    assert head["state"][0] == {"start": "room.T_0", "shows": "room.T"}


def test_what_fits_nothing_is_told(motor, tmp_path):
    heads = {"u": ("voltage at plug", 1, 0), "i": ("n1", 1, 0), "w": ("n2", 1, 0)}
    file = log(tmp_path / "a.csv", ALL["motor"], heads)
    said = run("import", file, "--fmu", motor, "--out", tmp_path / "set", status=2)
    assert 'no column ("voltage at plug", "n1", "n2") is an output of motor (i, w, phi)' in said


def test_the_tutorials_commands(tmp_path):
    text = (ROOT / "docs" / "your-fmu.md").read_text()
    blocks = re.findall(r"```console\n(.*?)```", text, re.S)
    commands = [line[2:] for block in blocks for line in block.splitlines() if line.startswith("$ ")]
    # the environment that the tests have stands for the page's own
    made, installed, *commands = commands
    assert made == "python3 -m venv .venv" and installed.startswith(".venv/bin/python -m pip install ") and len(commands) == 4
    # what is built already stands for cargo, and results go elsewhere
    for command in commands:
        words = command.replace("cargo acroscope", str(PROGRAM)).replace(".venv/bin/python", sys.executable).replace("out/", f"{tmp_path}/")
        done = subprocess.run(words.split(), cwd=ROOT, capture_output=True, text=True, check=False, env=os.environ)
        assert done.returncode == 0, f"{command}\n{done.stderr}"
    assert "\nscale = -0.0174" in (tmp_path / "motor" / "dataset.toml").read_text()
