"""Logs that begin in the middle of the motion, as they do where somebody presses "record": what acts late was fed before the first row."""

import json

import pytest

from . import sets
from .machines import ALL
from .test_doubts import diagnosed


def begun(folder, column):
    """The logs of a set from the first row behind a step of a column on; what is cut off is a fifth or more."""
    for path in folder.glob("run-*.csv"):
        head, *rows = path.read_text().splitlines()
        place = head.split(",").index(column)
        values = [row.split(",")[place] for row in rows]
        first = next(row for row in range(len(rows) // 5, len(rows)) if values[row] != values[row - 1])
        path.write_text("\n".join([head, *rows[first + 1 :]]) + "\n")
    return folder


def without_first_cells(folder, column):
    """The logs of a set with the first 40 cells of a column left empty, as where its logger was started later."""
    for path in folder.glob("run-*.csv"):
        head, *rows = path.read_text().splitlines()
        place = head.split(",").index(column)
        cells = [row.split(",") for row in rows]
        for row in cells[:40]:
            row[place] = ""
        path.write_text("\n".join([head, *map(",".join, cells)]) + "\n")
    return folder


@pytest.fixture
def late(tmp_path, monkeypatch):
    """`late(name, case)`: a set with the largest delay that the machine has, eight rows, and what is hidden."""

    def of(name, case):
        # more than any shows
        monkeypatch.setattr(sets, "SHOWN", (1e5, 1e6))
        units = {name: ALL[name].build(ALL[name], tmp_path)}
        answer = sets.make(ALL[name], case, 1, tmp_path / name, tmp_path / "answers", units)
        return tmp_path / name, answer["effects"][0]

    return of


def named(folder, hidden):
    """The diagnosis, in which an effect is named, and nothing else, with its value to a hundredth, which is a twelfth of a row."""
    status, said = diagnosed(folder)
    assert status == 0, said
    found = json.loads((folder / "found" / "diagnosis.json").read_text())
    assert found["verdict"] == "named", found["story"]
    [effect] = found["effects"]
    assert effect["name"] == hidden["name"]
    assert effect["value"] == pytest.approx(hidden["value"], rel=0.01)
    return found


@pytest.mark.parametrize(("name", "case"), [("sled", "force:delay"), ("reactor", "T_c:delay"), ("drive", "torque:delay")])
def test_a_late_input_is_named_whatever_was_fed_before_the_log(name, case, late):
    folder, hidden = late(name, case)
    named(begun(folder, case.split(":")[0] + "_cmd"), hidden)


@pytest.mark.parametrize(("name", "case"), [("cell", "i:lag"), ("reactor", "q:lag")])
def test_a_slow_input_is_named_wherever_it_was_when_the_log_began(name, case, late):
    folder, hidden = late(name, case)
    named(begun(folder, case.split(":")[0] + "_cmd"), hidden)


def test_a_late_input_is_named_whatever_was_fed_before_its_own_log(late):
    folder, hidden = late("sled", "force:delay")
    found = named(without_first_cells(begun(folder, "force_cmd"), "force_cmd"), hidden)
    told = {notice["file"] for notice in found["notices"] if "sled.force is logged from" in notice["message"] and "40 rows" in notice["message"]}
    assert told == {path.name for path in folder.glob("run-*.csv")}, found["notices"]


def test_a_late_sensor_is_named_that_alone_tells_of_hidden_states(late):
    folder, hidden = late("cell", "v_cell:delay")
    named(folder, hidden)
