"""Logs that count otherwise than the model does end the diagnosis with one sentence and the line to write; with that line it goes on.

Each kind on two machines: a motor (fast, linear, all states measured) and a cell (slow, not linear, two of three states hidden)."""

import csv
import json
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from . import sets
from .importing import log, run
from .machines import ALL
from .unit_python import environment

PROGRAM = Path(__file__).resolve().parents[2] / "target" / "release" / "acroscope"


@pytest.fixture(scope="module")
def units(tmp_path_factory):
    folder = tmp_path_factory.mktemp("units")
    return {name: ALL[name].build(ALL[name], folder) for name in ("motor", "cell", "cart")}


@pytest.fixture(scope="module")
def honest(tmp_path_factory, units):
    """A set of each machine of which the model lacks nothing. Seeds whose times are in s."""
    folder = tmp_path_factory.mktemp("doubts")
    for name, seed in (("motor", 33), ("cell", 31), ("cart", 32)):
        sets.make(ALL[name], "none", seed, folder / name, folder / "answers", units)
        path = folder / name / "dataset.toml"
        if '"ms"' in path.read_text():
            path.write_text(path.read_text().replace('time = { column = "t", unit = "ms" }', 'time = { column = "t" }'))
            changed(folder / name, lambda head, values: scaled(values, 0, 1e-3))
    return folder


@pytest.fixture
def taken(honest, tmp_path):
    """A copy of a machine's set."""
    return lambda name: Path(shutil.copytree(honest / name, tmp_path / name))


def test_a_start_that_starts_no_state_is_named(taken):
    folder = taken("motor")
    text = re.sub(r"\[\[state\]\][^\[]*", "", (folder / "dataset.toml").read_text())
    (folder / "dataset.toml").write_text(text + '\n[[state]]\nstart = "motor.R"\n')
    status, said = diagnosed(folder)
    assert status == 2 and "motor.R starts no state, as it seems" in said and "fed motor" not in said, said


@pytest.mark.long
def test_a_run_whose_times_are_in_another_unit_is_named(taken):
    folder = taken("motor")
    path = folder / "run-01.csv"
    head, *rows = [line.split(",") for line in path.read_text().splitlines()]
    path.write_text("\n".join(",".join(row) for row in [head, *([f"{1e3 * float(row[0]):.9g}", *row[1:]] for row in rows)]) + "\n")
    command = [PROGRAM, "--quiet", "diagnose", folder, "--budget", "20", "--out", folder / "found"]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False, env=environment())
    assert done.returncode == 2 and "the rows of run-01.csv are" in done.stderr and "are its times in ms?" in done.stderr, done.stderr


def diagnosed(folder):
    command = [PROGRAM, "--quiet", "diagnose", folder, "--out", folder / "found"]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False, env=environment())
    return done.returncode, done.stderr


def changed(folder, change):
    """The logs of a set after `change(head, values)`."""
    for path in folder.glob("run-*.csv"):
        with path.open(newline="") as file:
            head, *rows = csv.reader(file)
        values = np.array(rows, dtype=float)
        change(head, values)
        path.write_text(",".join(head) + "\n" + "".join(",".join(f"{v:.9g}" for v in row) + "\n" for row in values))
    return folder


def scaled(values, place, factor, offset=0.0):
    values[:, place] = factor * values[:, place] + offset


def column(name, factor, offset=0.0):
    """A change of one column."""
    return lambda head, values: scaled(values, head.index(name), factor, offset)


def written(folder, variable, *lines):
    """`dataset.toml` with what the [[channel]] of a variable says of unit, scale and offset replaced."""
    path = folder / "dataset.toml"
    text = path.read_text()
    block = re.search(rf'\[\[channel\]\]\nvariable = "{re.escape(variable)}"\n.*?(?=\n\[\[)', text, re.S).group(0)
    keys = ("column",) if lines[0].startswith("column") else ("unit", "scale", "offset")
    kept = [line for line in block.rstrip().splitlines() if not line.startswith(keys)]
    path.write_text(text.replace(block, "\n".join([*kept, *lines]) + "\n"))


def refused(folder, *words):
    """Exit status 2, and one line that names file, line, what was found, and what to write."""
    status, said = diagnosed(folder)
    assert status == 2, said
    assert re.search(r"dataset\.toml:\d+: ", said) and said.count("\n") == 1, said
    for word in words:
        assert word in said, said
    assert not (folder / "found").exists()
    return said


def goes_on(folder):
    status, said = diagnosed(folder)
    assert status == 0, said
    assert json.loads((folder / "found" / "diagnosis.json").read_text())["verdict"] == "none"


@pytest.mark.parametrize("name", ["motor", "cell"])
@pytest.mark.parametrize(("unit", "factor"), [("ms", 1e3), ("us", 1e6), ("min", 1 / 60)])
def test_times_in_another_unit(taken, name, unit, factor):
    folder = changed(taken(name), lambda head, values: scaled(values, 0, factor))
    refused(folder, f"only with times in {unit}", f'time = {{ unit = "{unit}" }}')
    if unit == "ms":
        path = folder / "dataset.toml"
        text = path.read_text().replace('time = { column = "t" }', "")
        path.write_text(re.sub(r'(file = "run-\d+\.csv")', r'\1\ntime = { column = "' + first(folder) + '", unit = "ms" }', text))
        goes_on(folder)


def first(folder):
    return (folder / "run-01.csv").read_text().split(",", 1)[0]


@pytest.mark.parametrize(("name", "variable", "log", "scale"), [("motor", "motor.u", "u_cmd", 1e-3), ("cell", "cell.i", "i_cmd", 1e-3)])
def test_the_sign_of_an_input(taken, name, variable, log, scale):
    folder = changed(taken(name), column(log, -1.0))
    refused(folder, f'the sign of {variable} (column "{log}") turned', f"scale = -{scale}")
    written(folder, variable, f"scale = -{scale}")
    goes_on(folder)


@pytest.mark.parametrize(("name", "variable", "log", "scale"), [("motor", "motor.w", "w", 2 * np.pi / 60), ("cell", "cell.v_cell", "v_cell", 1e-3)])
def test_the_sign_of_an_output(taken, name, variable, log, scale):
    folder = changed(taken(name), column(log, -1.0))
    refused(folder, f'the sign of {variable} (column "{log}") turned', f"scale = -{scale}")
    written(folder, variable, f"scale = -{scale!r}")
    goes_on(folder)


@pytest.mark.parametrize(("name", "variable", "said", "unit"), [
    ("motor", "motor.phi", "rad", "deg"),
    ("motor", "motor.w", "rad/s", "rpm"),
    ("motor", "motor.u", "V", "mV"),
    ("cell", "cell.v_cell", "V", "mV"),
    ("cell", "cell.i", "A", "mA"),
    ("cell", "cell.T", "K", "degC"),
])  # fmt: skip
def test_another_unit_of_measurement(taken, name, variable, said, unit):
    """As someone writes who takes the log to be in the model's unit: degrees for radians, mV for V, degC for K."""
    folder = taken(name)
    written(folder, variable, f'unit = "{said}"')
    refused(folder, f"{variable} (column ", f") in {unit}", f'unit = "{unit}"')
    written(folder, variable, f'unit = "{unit}"')
    goes_on(folder)


@pytest.mark.parametrize(("variable", "log", "said", "unit", "size"), [
    ("cart.x_cart", "x_cart", "mm", "inch", 1 / 25.4),
    ("cart.force", "force_cmd", "N", "lbf", 1e-3 / 4.4482216152605),
])  # fmt: skip
def test_a_unit_outside_the_si(taken, variable, log, said, unit, size):
    """An inch that is taken for a millimetre, a pound-force for a newton."""
    folder = changed(taken("cart"), column(log, size))
    written(folder, variable, f'unit = "{said}"')
    refused(folder, f"{variable} (column ", f") in {unit}", f'unit = "{unit}"')
    written(folder, variable, f'unit = "{unit}"')
    goes_on(folder)


@pytest.mark.parametrize(("name", "one", "two"), [("motor", "i", "w"), ("cell", "v_cell", "T")])
def test_two_columns_exchanged(taken, name, one, two):
    folder = taken(name)
    written(folder, f"{name}.{one}", f'column = "{two}"')
    written(folder, f"{name}.{two}", f'column = "{one}"')
    refused(folder, f"the columns of {name}.{one} and {name}.{two} exchanged", f'column = "{one}"', f'column = "{two}"')
    written(folder, f"{name}.{one}", f'column = "{one}"')
    written(folder, f"{name}.{two}", f'column = "{two}"')
    goes_on(folder)


@pytest.mark.parametrize(("name", "log"), [("motor", "w"), ("cell", "T")])
def test_a_sensor_that_stood_still(taken, name, log):
    def stands(head, values):
        values[200:260, head.index(log)] = values[200, head.index(log)]

    folder = changed(taken(name), stands)
    refused(folder, f'column "{log}" ({name}.{log})', "60 rows", "stood still", "empty")
    for path in folder.glob("run-*.csv"):
        head, *lines = path.read_text().splitlines()
        rows = [line.split(",") for line in lines]
        for row in rows[200:260]:
            row[head.split(",").index(log)] = ""
        path.write_text("\n".join([head, *map(",".join, rows)]) + "\n")
    goes_on(folder)


@pytest.mark.parametrize(("name", "case"), [("motor", "u:gain"), ("motor", "w:gain"), ("motor", "door"), ("cell", "R0"), ("cell", "i:bias")])
def test_what_the_model_lacks_is_no_doubt(tmp_path, units, name, case):
    sets.make(ALL[name], case, 40, tmp_path / "set", tmp_path / "answers", units)
    assert diagnosed(tmp_path / "set")[0] == 0


def worn(tmp_path, motor, friction):
    """A set of a motor with so much more friction that its model follows no log of it as well as it should."""
    heads = {name: (f"{name} [{unit}]", 1, 0) for name, unit in (("u", "V"), ("i", "A"), ("w", "rad/s"), ("phi", "rad"))}
    file = log(tmp_path / "a.csv", ALL["motor"], heads, change={"b": friction})
    run("import", file, "--fmu", motor, "--out", tmp_path / "set")
    path = tmp_path / "set" / "dataset.toml"
    path.write_text(re.sub(r"^#.*\n", "", path.read_text(), flags=re.M))
    return tmp_path / "set"


@pytest.mark.parametrize(("friction", "variable", "scale", "said"), [
    (0.6, "motor.w", -1.0, 'the sign of motor.w (column "w [rad/s]") turned beside motor.b ='),
    (0.6, "motor.u", -1.0, 'the sign of motor.u (column "u [V]") turned beside motor.b ='),
    (0.15, "motor.i", 1e3, 'motor.i (column "i [A]") in A beside motor.b ='),
    (0.15, "motor.phi", -57.3, 'turned and motor.phi (column "phi [rad]") in rad beside motor.b ='),
])  # fmt: skip
def test_a_sign_or_unit_beside_what_the_model_lacks(tmp_path, units, friction, variable, scale, said):
    """In no reading the model follows these logs before the fit; in the right one nothing is left without a name."""
    folder = worn(tmp_path, units["motor"], friction)
    written(folder, variable, f"scale = {scale}")
    found = answer(folder)
    assert any(said in notice["message"] for notice in found["notices"]), found["notices"]
    assert all(effect["probability"] < 0.5 for effect in found["effects"]), found["effects"]


def test_a_gain_that_is_the_ratio_of_two_units(tmp_path, units):
    folder = worn(tmp_path, units["motor"], 0.6)
    written(folder, "motor.w", "scale = 0.10471975511965977")
    told = answer(folder)["notices"][-1]["message"]
    assert "motor.w:gain is 0.1047" in told and 'unit = "rad/s"' in told, told


def answer(folder):
    status, output = diagnosed(folder)
    assert status == 0, output
    return json.loads((folder / "found" / "diagnosis.json").read_text())


@pytest.mark.parametrize("gain", [-0.5, 2.0, pytest.param(-0.8, marks=pytest.mark.long)])
def test_a_gain_that_is_no_sign_is_no_doubt(taken, gain):
    """An input, or a sensor, of half or twice its size, even turned: no sign or unit explains it, so that the search must."""
    folder = changed(taken("motor"), column("u_cmd", 1 / gain))
    status, said = diagnosed(folder)
    assert status == 0, said
    found = json.loads((folder / "found" / "diagnosis.json").read_text())
    # no gain is negative, and beside a turned sign every name would be wrong
    told = any("with its sign turned motor.u" in notice["message"] for notice in found["notices"])
    assert told == (gain < 0) and (found["effects"] == []) == (gain < 0), found["effects"]
