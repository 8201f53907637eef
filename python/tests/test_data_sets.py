"""Data sets and first scenarios made from Python, as the command line makes them. Run by scripts/test-wheel.sh."""

import math
import subprocess
import sys
import tomllib

import pytest

import acroscope as ac

GAIN = 1.25


@pytest.fixture(scope="module")
def unit():
    """What comes in goes out, until something is set."""
    return ac.units()["signal_effects"]


@pytest.fixture(scope="module")
def logs(tmp_path_factory):
    """Two runs of a machine that the unit is a model of, but for a gain; the second without a column of time."""
    folder = tmp_path_factory.mktemp("logs")
    rows = [(k / 50, math.sin(0.07 * k) + 0.3 * math.sin(0.31 * k)) for k in range(400)]
    paths = folder / "timed.csv", folder / "bare.csv"
    paths[0].write_text("time,u,y\n" + "".join(f"{t},{u},{GAIN * u}\n" for t, u in rows))
    paths[1].write_text("u,y\n" + "".join(f"{u},{GAIN * u}\n" for _, u in rows))
    return paths


def test_logs_become_a_data_set_that_a_diagnosis_takes(unit, logs, tmp_path):
    made = ac.import_logs(logs[0], unit, out=tmp_path / "made")
    assert made.folder == tmp_path / "made" and repr(made) == f"<DataSet: {made.folder}>"
    text = (made.folder / "dataset.toml").read_text("utf-8")
    channels = {channel["variable"] for channel in tomllib.loads(text)["channel"]}
    assert channels == {"signal_effects.u", "signal_effects.y"}
    assert made.guesses and all(guess.strip() == guess != "" for guess in made.guesses)
    assert any("time" in guess and "by its name" in guess for guess in made.guesses), made.guesses
    found = ac.diagnose(made, budget=20)
    assert [effect["value"] for effect in found.effects] == [pytest.approx(GAIN, rel=1e-3)]


def test_a_data_set_is_that_of_the_command_line(unit, logs, tmp_path):
    made = ac.import_logs([logs[1]], unit, rate=50, start=-1.5, isolate=sys.platform == "linux", step_limit=20, out=tmp_path / "python")
    words = ["import", str(logs[1]), "--fmu", str(unit), "--rate", "50", "--start=-1.5", "--out", str(tmp_path / "command")]
    done = subprocess.run([sys.executable, "-P", "-m", "acroscope", *words], capture_output=True, text=True, check=True)
    files = {file.name: file.read_bytes() for file in made.folder.iterdir()}
    assert files == {file.name: file.read_bytes() for file in (tmp_path / "command").iterdir()}
    assert files["run-01.csv"].splitlines()[1].startswith(b"-1.5,")
    assert made.guesses == [line[2:] for line in done.stdout.splitlines() if line.startswith("  ")]
    assert made.notices == [line.removeprefix("note: ") for line in done.stderr.splitlines()]


def test_what_can_not_be_imported_is_told_in_the_words_of_the_command(unit, logs, tmp_path):
    with pytest.raises(ac.InputError, match=r"nowhere\.csv"):
        ac.import_logs("nowhere.csv", unit)
    with pytest.raises(ac.InputError, match=r"^logs = \[\]: the paths of CSV files, one a run$"):
        ac.import_logs([], unit)
    with pytest.raises(ac.InputError, match=r"(?<!-)\brate.* 0.*rows a second, above 0"):
        ac.import_logs(logs[1], unit, rate=0)
    with pytest.raises(ac.InputError, match=r"(?<!-)\brate <HZ>") as told:
        ac.import_logs(logs[1], unit, start=1)
    assert "Usage" not in str(told.value)
    with pytest.raises(ac.InputError, match="no column rises from row to row"):
        ac.import_logs(logs[1], unit)


def test_measured_data_are_replaced_only_when_that_is_asked_for(unit, logs, tmp_path):
    (tmp_path / "dataset.toml").write_text("measured")
    with pytest.raises(ac.InputError, match=r"dataset\.toml.*: force=True replaces it$"):
        ac.import_logs(logs[0], unit, out=tmp_path)
    assert (tmp_path / "dataset.toml").read_text() == "measured"
    ac.import_logs(logs[0], unit, out=tmp_path, force=True)
    assert (tmp_path / "dataset.toml").read_text() != "measured"


def test_a_temporary_data_set_vanishes_with_its_object(unit, logs):
    made = ac.import_logs(logs[0], unit)
    folder = made.folder
    assert (folder / "dataset.toml").is_file()
    del made
    assert not folder.exists()


def test_finished_runs_become_a_data_set(tmp_path):
    run = ac.run("full-state", {"plant.q2_0": 0.05}, stop=0.5)
    made = ac.record(run.folder, scenario="full-state", encoder_rate=20, encoder_noise=0, torque_noise=0.01, seed=3, out=tmp_path / "made")
    assert tomllib.loads((made.folder / "dataset.toml").read_text("utf-8"))["scenario"] == "full-state"
    head, *rows = (made.folder / "run-01" / "plant.csv").read_text("utf-8").splitlines()
    assert head.split(",")[0] == "time" and "tau_applied" in head and len(rows) >= 10
    assert made.guesses == [] and made.notices == []
    with pytest.raises(ac.InputError, match=r"dataset\.toml.*: force=True replaces it$"):
        ac.record([run.folder], scenario="full-state", out=tmp_path / "made")
    with pytest.raises(ac.InputError, match=r"^runs = \(\): the folders of finished runs$"):
        ac.record(())


def test_a_first_scenario_is_text_or_a_file(tmp_path):
    units = ac.units()
    text = ac.new(units["acrobot_plant"], units["acrobot_controller"])
    drafted = tomllib.loads(text)
    assert [unit["name"] for unit in drafted["units"]] == ["acrobot_plant", "acrobot_controller"]
    file = tmp_path / "mine.toml"
    assert ac.new(units["acrobot_plant"], units["acrobot_controller"], out=file) == file.read_text("utf-8")
    assert ac.run(file, stop=0.05).last("time") == 0.05
    with pytest.raises(ac.InputError, match=r"mine\.toml.*: force=True replaces it$"):
        ac.new(units["acrobot_plant"], out=file)
    assert "acrobot_controller" not in ac.new(units["acrobot_plant"], out=file, force=True)
    with pytest.raises(ac.InputError, match=r"nowhere\.fmu"):
        ac.new("nowhere.fmu")
    with pytest.raises(ac.InputError, match="^fmus: the paths of one unit or more$"):
        ac.new()
