"""Logs as loggers write them, through `acroscope import`: tables amid other lines, dates, words, marks between thousands, no clock."""

import datetime

import numpy as np
import pytest

from .importing import channels, log, run
from .machines import ALL


@pytest.fixture
def motor(tmp_path):
    return ALL["motor"].build(ALL["motor"], tmp_path)


def test_a_number_below_no_name_is_an_error_with_its_line(tmp_path, motor):
    columns = {"u": ("u (V)", 1.0, 0.0), "i": ("i (A)", 1.0, 0.0), "w": ("w (rad/s)", 1.0, 0.0)}
    path = log(tmp_path / "log.csv", ALL["motor"], columns)
    rows = path.read_text().splitlines()
    for more, status in [(",", 0), (",7.5", 2)]:
        path.write_text("\n".join([*rows[:9], rows[9] + more, *rows[10:]]) + "\n")
        said = run("import", path, "--fmu", motor, "--out", tmp_path / f"out{status}", status=status)
        assert (f"{path}:10: 5 cells below 4 names: 7.5 stands below none" in said) == (status == 2), said


BARE = {"u": ("u [mV]", 1e-3, 0.0), "i": ("i [mA]", 1e-3, 0.0), "w": ("w [rpm]", 2 * np.pi / 60, 0.0), "phi": ("phi [deg]", np.pi / 180, 0.0)}


def test_what_no_log_can_hold_is_an_error_with_its_line(tmp_path, motor):
    """Two columns of one name, an input in a unit of something else, a number that no sensor gives, a log that is given twice; nothing is written."""
    path = log(tmp_path / "log.csv", ALL["motor"], BARE)
    lines = path.read_text().splitlines()
    head, row = lines[0], lines[51].split(",")
    huge = [*lines[:51], ",".join([*row[:2], "1e308", *row[3:]]), *lines[52:]]
    twice = [f"{head},i [mA]", *(f"{line},1" for line in lines[1:])]
    for text, told in [
        (twice, f'{path}:1: columns 3 and 6 are both called "i [mA]"'),
        ([head.replace("u [mV]", "u [kg]"), *lines[1:]], f'{path}:1: column "u [kg]" is called like the input u, which is in V, and kg measures something'),
        (huge, f'{path}:52: column "i [mA]": 1e308 is no measurement'),
    ]:
        path.write_text("\n".join(text) + "\n")
        assert told in run("import", path, "--fmu", motor, "--out", tmp_path / "set", status=2)
    path.write_text("\n".join(lines) + "\n")
    assert f"{path}:1: the same rows as in {path}" in run("import", path, path, "--fmu", motor, "--out", tmp_path / "set", status=2)
    assert not (tmp_path / "set").exists()
    # and of a data set that was made of a good one
    run("import", path, "--fmu", motor, "--out", tmp_path / "set")
    (tmp_path / "set" / "run-01.csv").write_text("\n".join(huge) + "\n")
    said = run("diagnose", tmp_path / "set", "--out", tmp_path / "out", status=2)
    assert 'run-01.csv:52: column "i [mA]": 1e308 is no measurement' in said, said


def test_rows_that_are_cut_are_left_out_and_told(tmp_path, motor):
    path = log(tmp_path / "log.csv", ALL["motor"], BARE)
    head, *rows = path.read_text().splitlines()
    cut = [*rows[:29], f"{rows[29].split(',')[0]},1", *rows[29:-1], rows[-1][:9]]
    path.write_text("\n".join([head, *cut]))
    said = run("import", path, "--fmu", motor, "--out", tmp_path / "set")
    assert "2 cells below 5 names in line 31 (2 such rows, this is the first): the row is cut and left out" in said, said
    assert len((tmp_path / "set" / "run-01.csv").read_text().splitlines()) == len(rows)


def test_a_log_in_which_no_parameter_acts_has_none_as_candidates(tmp_path, motor):
    path = log(tmp_path / "log.csv", ALL["motor"], BARE)
    head, *rows = path.read_text().splitlines()
    path.write_text("\n".join([head, *(f"{row.split(',')[0]},0,0,0,0" for row in rows)]) + "\n")
    said = run("import", path, "--fmu", motor, "--out", tmp_path / "set")
    assert "no parameter may be off: candidate = []" in said and "every parameter may be off" not in said, said
    assert channels(tmp_path / "set")[1]["candidate"] == []


@pytest.mark.long
def test_times_in_ms_under_a_head_that_says_s_end_with_a_question(tmp_path, motor):
    path = log(tmp_path / "log.csv", ALL["motor"], BARE, time=("t [s]", 1e-3))
    said = run("import", path, "--fmu", motor, "--out", tmp_path / "set")
    assert 'the rows of column "t [s]" are 1.000e1 s apart' in said and "are these times in ms?" in said, said
    assert "Nothing else was tried against the model" in said, said


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
