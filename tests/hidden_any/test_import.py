"""`acroscope import` finds columns, units, signs and time as they were written, and the tutorial's commands work."""

import dataclasses
import datetime
import os
import re
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import numpy as np
import pytest

from . import excite
from .machine import Input, Output, Parameter, State
from .machines import ALL
from .simulate import simulate, variants
from .unit_c import build
from .unit_python import environment

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "target" / "release" / "acroscope"


def run(*arguments, status=0):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False, env=environment())
    assert done.returncode == status, done.stderr
    return done.stdout + done.stderr


def log(path, machine, columns, separator=",", time=("time", 1.0), change=None, gap=False):
    """A log whose columns are {variable: (head, scale, offset)} with model = scale * log + offset."""
    rng = np.random.default_rng(11)
    times = machine.row * np.arange(300)
    commands, start = excite.commands(machine, times, rng), excite.start(machine, rng)
    clean = simulate(machine, variants(machine, [change or {}]), times, commands, start)
    values = commands | {one.name: clean[one.name][:, 0] + one.noise * rng.normal(size=len(times)) for one in machine.outputs_of}
    numbers = [times / time[1], *((values[name] - offset) / scale for name, (_, scale, offset) in columns.items())]
    rows = [row for place, row in enumerate(zip(*numbers, strict=True)) if not gap or not 100 < place < 120]
    text = "\n".join(separator.join(f"{value:.7g}" for value in row) for row in rows)
    text = text if separator == "," else text.replace(".", ",")
    path.write_text(separator.join([time[0], *(head for head, *_ in columns.values())]) + "\n" + text + "\n")
    return path


@pytest.fixture
def motor(tmp_path):
    return ALL["motor"].build(ALL["motor"], tmp_path)


def channels(folder):
    head = tomllib.loads((folder / "dataset.toml").read_text())
    return {entry["variable"]: entry for entry in head["channel"]}, head


def test_a_number_below_no_name_is_an_error_with_its_line(tmp_path, motor):
    columns = {"u": ("u (V)", 1.0, 0.0), "i": ("i (A)", 1.0, 0.0), "w": ("w (rad/s)", 1.0, 0.0)}
    path = log(tmp_path / "log.csv", ALL["motor"], columns)
    rows = path.read_text().splitlines()
    for more, status in [(",", 0), (",7.5", 2)]:
        path.write_text("\n".join([*rows[:9], rows[9] + more, *rows[10:]]) + "\n")
        said = run("import", path, "--fmu", motor, "--out", tmp_path / f"out{status}", status=status)
        assert (f"{path}:10: 5 cells below 4 names: 7.5 stands below none" in said) == (status == 2), said


def test_a_column_of_words_is_left_out_and_told(tmp_path, motor):
    path = log(tmp_path / "log.csv", ALL["motor"], {"u": ("u (V)", 1.0, 0.0), "i": ("i (A)", 1.0, 0.0), "w": ("w (rad/s)", 1.0, 0.0)})
    head, *rows = path.read_text().splitlines()
    path.write_text("\n".join([f"{head},mode", *(f"{row},{'charge' if place % 7 else 'rest'}" for place, row in enumerate(rows))]) + "\n")
    said = run("import", path, "--fmu", motor, "--out", tmp_path / "set")
    assert 'column "mode" holds words' in said, said
    assert set(channels(tmp_path / "set")[0]) == {"motor.u", "motor.i", "motor.w"}
    # what is neither a number nor a date is no time: nothing else passes for it
    words = [f"shift {place},{row.split(',', 1)[1]}" for place, row in enumerate(rows)]
    (tmp_path / "words.csv").write_text("\n".join([head, *words]) + "\n")
    assert 'words.csv:2: column "time": "shift 0" is no number; dates and times are read as' in run(
        "import", tmp_path / "words.csv", "--fmu", motor, "--out", tmp_path / "other", status=2)  # fmt: skip
    # a word among numbers stays an error
    path.write_text(path.read_text().replace(rows[5].split(",")[1], "over", 1))
    said = run("import", path, "--fmu", motor, "--out", tmp_path / "other", status=2)
    assert '"over" is no number; where nothing was measured the cell is empty, NaN or N/A' in said, said


def seconds(folder, column):
    head, *rows = [line.split(",") for line in (folder / "run-01.csv").read_text().splitlines()]
    return [float(row[head.index(column)]) for row in rows]


@pytest.mark.parametrize(("head", "format", "start"), [
    ("timestamp", "%Y-%m-%dT%H:%M:%S.%f", "2026-03-28 23:59:59"), ("Date Time", "%d.%m.%Y %H:%M:%S.%f", "2026-03-28 23:59:59"),
    ("when", "%m/%d/%Y %I:%M:%S.%f %p", "2026-03-28 11:59:59"), ("Time", "%H:%M:%S.%f", "2026-03-28 23:59:59"),
    ("time", "%Y-%m-%d %H:%M:%S.%f+01:00", "2026-03-28 23:59:59"), ("Date,Time", "%m/%d/%Y,%H:%M:%S.%f", "2026-03-28 23:59:59"),
])  # fmt: skip
def test_dates_and_times_of_day_are_a_clock(tmp_path, motor, head, format, start):
    """As loggers stamp rows, through midnight and noon: the data set has seconds since the first row, and is diagnosed."""
    columns = {"u": ("u (V)", 1.0, 0.0), "i": ("i (A)", 1.0, 0.0), "w": ("w (rad/s)", 1.0, 0.0), "phi": ("phi (rad)", 1.0, 0.0)}
    path = log(tmp_path / "log.csv", ALL["motor"], columns)
    names, *rows = path.read_text().splitlines()
    times = [float(row.split(",")[0]) for row in rows]
    begin = datetime.datetime.fromisoformat(start)
    stamps = [(begin + datetime.timedelta(seconds=time)).strftime(format) for time in times]
    path.write_text("\n".join([names.replace("time", head, 1), *(f"{stamp},{row.split(',', 1)[1]}" for stamp, row in zip(stamps, rows, strict=True))]) + "\n")
    said = run("import", path, "--fmu", motor, "--out", tmp_path / "set")
    column = head.rsplit(",", maxsplit=1)[-1]
    assert np.allclose(seconds(tmp_path / "set", column), times, atol=1e-6), said
    assert ("midnight passes before line" in said) == (head == "Time"), said
    if head in ("timestamp", "Time"):
        run("diagnose", tmp_path / "set", "--out", tmp_path / "out")


def test_a_table_amid_what_a_device_writes(tmp_path, motor):
    """Lines above and below the table, words for what is missing, thousands that are marked: read, and told."""
    columns = {"u": ("u / V", 1.0, 0.0), "i": ("i in uA", 1e-6, 0.0), "w": ("w / (rad/s)", 1.0, 0.0), "phi": ("phi", 1.0, 0.0)}
    path = log(tmp_path / "log.csv", ALL["motor"], columns)
    head, *rows = [line.split(",") for line in path.read_text().splitlines()]
    for place, row in enumerate(rows):
        row[2] = f'"{float(row[2]):,.1f}"'
        row[3] = ["N/A", "---", "null", "Inf"][place // 40 % 4] if place % 40 == 7 else row[3]
    above = ["Device: DAQ-7; serial 12", 'Operator,"Smith, J."', "Rate,100,Hz", ""]
    path.write_text("\n".join([*above, *(",".join(row) for row in [head, *rows]), "Mean,1,2,3,4", "End of file"]) + "\n")
    said = run("import", path, "--fmu", motor, "--out", tmp_path / "set")
    found, _ = channels(tmp_path / "set")
    assert (found["motor.i"]["unit"], found["motor.w"]["unit"], found["motor.u"]["unit"]) == ("uA", "rad/s", "V"), said
    for told in ("lines 1 to 4 stand above the table", 'line 306 on ("Mean,1,2,3,4")', 'cells hold no measurement, the first "N/A" in line 13',
                 "thousands are marked in its numbers"):  # fmt: skip
        assert told in said, said
    assert np.allclose(seconds(tmp_path / "set", "i in uA"), [float(row[2].strip('"').replace(",", "")) for row in rows])


def test_a_column_that_counts_rows_is_no_clock(tmp_path, motor):
    path = log(tmp_path / "log.csv", ALL["motor"], {"u": ("u", 1.0, 0.0), "i": ("i", 1.0, 0.0), "w": ("w", 1.0, 0.0)})
    head, *rows = path.read_text().splitlines()
    rows = [f"{place},{row.split(',', 1)[1]}" for place, row in enumerate(rows)]
    path.write_text("\n".join([head.replace("time", "index", 1), *rows]) + "\n")
    said = run("import", path, "--fmu", motor, "--out", tmp_path / "set", status=2)
    assert 'column "index" counts rows and is no clock' in said and "--rate HZ" in said and not (tmp_path / "set").exists(), said
    run("import", path, "--fmu", motor, "--rate", 100, "--out", tmp_path / "set")


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


def test_what_loggers_write(tmp_path, motor):
    """Names in a comment, blanks between cells, no column of time, and heads that are no variable's name."""
    heads = {"u": ("Supply/V", 1.0, 0.0), "i": ("Shunt/A", 1.0, 0.0), "w": ("Encoder/rpm", 2 * np.pi / 60, 0.0)}
    path = log(tmp_path / "log.csv", ALL["motor"], heads)
    head, *rows = path.read_text().splitlines()
    times = [float(row.split(",")[0]) for row in rows]
    bare = [row.split(",")[1:] for row in rows]
    text = "% bench 7\n# " + "  ".join(head.split(",")[1:]) + "\n" + "\n".join("  ".join(row) for row in bare) + "\n"
    path = tmp_path / "log.txt"
    path.write_text(text)
    refused = run("import", path, "--fmu", motor, "--out", tmp_path / "ds", status=2)
    assert "--rate HZ" in refused and not (tmp_path / "ds").exists()
    rate = round(1 / (times[1] - times[0]))
    told = run("import", path, "--fmu", motor, "--rate", rate, "--start", 2, "--out", tmp_path / "ds")
    assert f"{rate} rows a second, as asked for" in told and "separated by blanks" in told
    found, _ = channels(tmp_path / "ds")
    assert {name: entry["column"] for name, entry in found.items()} == {
        "motor.u": "Supply/V", "motor.i": "Shunt/A", "motor.w": "Encoder/rpm"}  # fmt: skip
    assert "is the only one in a unit that converts to rad/s" in told
    first = (tmp_path / "ds" / "run-01.csv").read_text().splitlines()
    assert first[0].startswith("time,") and [float(row.split(",")[0]) for row in first[1:3]] == [2.0, 2.0 + 1 / rate]
    for rate, wrong in [("0", "--rate 0: expected rows a second, above 0"), ("nan", "--rate NaN"), ("-5", "--rate -5")]:
        assert wrong in run("import", path, "--fmu", motor, "--rate", rate, "--out", tmp_path / "other", status=2)
    assert "without --rate its times are taken" in run(
        "import", tmp_path / "log.csv", "--fmu", motor, "--rate", 10, "--out", tmp_path / "other", status=2)  # fmt: skip
    nameless = tmp_path / "nameless.csv"
    nameless.write_text("\n".join(rows))
    assert "numbers where the names of columns belong" in run("import", nameless, "--fmu", motor, "--out", tmp_path / "other", status=2)
    assert not (tmp_path / "other").exists()
