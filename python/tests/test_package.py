"""The installed package: what a notebook does with it. Run by scripts/test-wheel.sh, outside the clone."""

import csv
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import polars
import pyarrow
import pytest

import acroscope as ac


@pytest.fixture(scope="module")
def results():
    return ac.run("visual-servo", {"camera.frames_every": 5}, stop="1/2")


def test_results_are_those_of_the_command_line(results):
    with (results.folder / "results.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == results.columns
    assert len(rows) == len(results) == 301
    for name in ("time", "plant.q1", "controller.tau", "camera.frame"):
        # The shortest text that reads back as the same double: nothing is lost.
        assert [float(row[name]) for row in rows] == results[name].tolist()
    assert results[name].dtype == np.int32
    assert results["camera.valid"].dtype == np.bool_
    assert results.last("plant.q1") == results["plant.q1"][-1]


def test_arrow_consumers_take_the_table(results):
    table = pyarrow.table(results)
    assert table.column_names == results.columns
    assert table.schema.field("plant.q1").metadata == {b"unit": b"rad"}
    assert results.unit("plant.q1") == "rad"
    assert table.schema.field("camera.valid").type == pyarrow.bool_()
    np.testing.assert_array_equal(table["plant.z"].to_numpy(), results["plant.z"])
    frame = polars.DataFrame(results)
    np.testing.assert_array_equal(frame["plant.z"].to_numpy(), results["plant.z"])


def test_arrow_consumers_share_the_memory(results):
    first, second = pyarrow.table(results), pyarrow.table(results)
    address = lambda table: table["plant.q1"].chunk(0).buffers()[1].address  # noqa: E731
    assert address(first) == address(second), "no copy was made"


def test_the_table_outlives_its_results():
    table = pyarrow.table(ac.run("full-state", stop=0.1))
    assert len(table) == 61 and table["plant.q2"][0].as_py() == 0.1


def test_verdict_report_and_graphs(results):
    fell = ac.run("visual-servo", {"camera.T_delay": 0.05}, stop=5)
    assert "lost balance" in fell.verdict, "C39: with a delay of 1.5 periods the acrobot falls"
    assert "lost balance" not in results.verdict
    assert "<svg" in (results.folder / "report.html").read_text("utf-8")
    assert results._repr_html_().startswith("<iframe srcdoc=")
    assert len(results.plot().axes) == 4
    assert ac.run(results.folder / "resolved.toml").last("plant.z") == results.last("plant.z")


def test_frames_are_pictures(results):
    frames = results.frames
    assert frames and all(frame.shape == (512, 512) and frame.dtype == np.uint8 for frame in frames.values())
    # Three circles of 75 px each (section 2 of the paper), where the threshold cuts them.
    assert all(3 * 60 < np.count_nonzero(frame > 191) < 3 * 95 for frame in frames.values())


def test_a_temporary_folder_vanishes_and_a_named_one_stays(tmp_path):
    kept = ac.run("full-state", stop=0.1, out=tmp_path / "kept")
    gone = ac.run("full-state", stop=0.1)
    folder = gone.folder
    assert folder.is_dir()
    del kept, gone
    assert (tmp_path / "kept" / "results.csv").is_file() and not folder.exists()


def test_results_can_be_pickled(results):
    again = pickle.loads(pickle.dumps(results))
    assert again.columns == results.columns and repr(again) == repr(results)
    for name in results.columns:
        assert again.unit(name) == results.unit(name)
        assert again[name].dtype == results[name].dtype
        assert again[name].tobytes() == results[name].tobytes()
    assert again.resolved == results.resolved and again.frames.keys() == results.frames.keys()
    # Of a temporary folder, which goes with the first results, the table and the verdict are left.
    gone = ac.run("full-state", stop=0.1)
    pickled = pickle.dumps(gone)
    verdict, last, folder = gone.verdict, gone.last("plant.q1"), gone.folder
    del gone
    again = pickle.loads(pickled)
    assert not folder.exists() and (again.verdict, again.last("plant.q1")) == (verdict, last)


def test_simulation_step_by_step_is_the_run():
    run = ac.run("full-state", stop=0.2)
    simulation = ac.Simulation("full-state", stop=0.2)
    seen = []
    while (now := simulation.step()) is not None:
        seen.append((now, simulation.get("plant.q1")))
    assert seen == list(zip(run["time"].tolist(), run["plant.q1"].tolist()))[1:]
    simulation.reset()
    assert simulation.step(until=0.1) == 0.1


def test_a_saved_state_leads_on_to_the_same_bits():
    simulation = ac.Simulation("visual-servo", {"camera.T_delay": 0.01}, stop=0.4)
    simulation.step(until=0.2)
    state = simulation.save()
    assert state.time == simulation.time == 0.2

    def rest(of):
        seen = []
        while of.step() is not None:
            seen.append((of.time, of.get("plant.q1"), of.get("controller.tau"), of.get("camera.frame")))
        return seen

    first = rest(simulation)
    assert len(first) == 120
    simulation.restore(state)
    assert simulation.time == 0.2 and rest(simulation) == first
    other = ac.Simulation("visual-servo", {"camera.T_delay": 0.01}, stop=0.4)
    other.restore(state)
    assert rest(other) == first
    with pytest.raises(ac.InputError, match="differs"):
        ac.Simulation("visual-servo", stop=0.4).restore(state)


def test_a_controller_in_python_takes_an_input_over():
    free = ac.Simulation("full-state", {"plant.b_joint": 0.5}, stop=0.3, inputs=["plant.tau"])
    free.step()
    free.set("plant.tau", 3.0)
    free.step()
    assert free.get("plant.tau_applied") == 3.0
    with pytest.raises(ac.InputError, match="overwrite"):
        bound = ac.Simulation("full-state")
        bound.step()
        bound.set("plant.tau", 3.0)
    with pytest.raises(ac.InputError, match="did you mean plant.tau"):
        ac.Simulation("full-state", inputs=["plant.tua"])
    with pytest.raises(ac.InputError, match='"plant.q1" is no driven input'):
        ac.Simulation("full-state", inputs=["plant.q1"])


@pytest.mark.skipif(sys.platform != "linux", reason="units in processes of their own: Linux")
def test_isolated_units_give_the_same_bits():
    here, apart = ac.run("visual-servo", stop=0.2), ac.run("visual-servo", stop=0.2, isolate=True)
    assert apart["plant.q1"].tolist() == here["plant.q1"].tolist()
    simulation = ac.Simulation("full-state", stop=0.1, isolate=True)
    pid = os.getpid()
    children = Path(f"/proc/{pid}/task/{threading.get_native_id()}/children").read_text().split()
    names = [Path(f"/proc/{child}/cmdline").read_bytes().split(b"\0")[1:5] for child in children]
    # Python's multiprocessing may have a process of its own there.
    names = [name for name in names if name[-1:] == [str(Path(ac.__file__).resolve()).encode()]]
    assert len(names) == 2, "one process for the plant, one for the controller"
    simulation.step(until=0.1)
    assert simulation.get("plant.q1") == ac.run("full-state", stop=0.1).last("plant.q1")
    # A unit whose process is gone ends the simulation with its name, and not Python.
    simulation.reset()
    simulation.step()
    for child in children:
        os.kill(int(child), signal.SIGKILL)
    with pytest.raises(ac.Error, match="plant|controller"):
        simulation.step(until=0.1)


def test_what_is_wrong_says_so():
    with pytest.raises(ac.InputError, match="did you mean visual-servo"):
        ac.run("visual-sevro")
    with pytest.raises(ac.InputError, match="camera.k9"):
        ac.run("visual-servo", {"camera.k9": 0.1})
    with pytest.raises(KeyError, match="plant.q1"):
        ac.run("full-state", stop=0.1)["plant.q11"]
    with pytest.raises(ac.InputError, match="dataset.toml"):
        ac.diagnose("nowhere")
    with pytest.raises(ac.InputError, match="table-9"):
        ac.reproduce("table-9")
    assert issubclass(ac.InputError, ac.Error)


def test_check_finds_no_error_in_our_units():
    for unit in ac.units().values():
        assert not [finding for finding in ac.check(unit) if finding["severity"] == "error"]
    with pytest.raises(ac.InputError, match="nowhere.fmu"):
        ac.check("nowhere.fmu")


def test_reproduce_gives_claims():
    reproduction = ac.reproduce("table-3")
    assert reproduction.claims and all(claim["holds"] for claim in reproduction.claims)
    assert "statements hold" in repr(reproduction)


def test_the_wheel_brings_units_scenarios_and_examples():
    assert {"acrobot_plant", "acrobot_camera", "acrobot_controller"} <= set(ac.units())
    assert {"visual-servo", "full-state"} <= set(ac.scenarios())
    assert ac.examples(), "a sample data set"
    assert ac.run(ac.scenarios()["full-state"], stop=0.1).last("time") == 0.1


def test_other_threads_go_on_during_a_run():
    ticks = []
    done = threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(None)
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    while not ticks:
        time.sleep(0.001)
    before = len(ticks)
    ac.run("visual-servo", stop=20)
    during = len(ticks) - before
    done.set()
    thread.join()
    # A run of 20 s takes tenths of a second at least: a held lock would leave one tick or two.
    assert during > 5


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_ctrl_c_ends_a_run():
    code = (
        "import acroscope as ac, sys\n"
        "print('begun', flush=True)\n"
        "try:\n    ac.run('visual-servo', stop=1000000)\n"
        "except KeyboardInterrupt:\n    print('interrupted')\n"
    )
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "begun\n"
        time.sleep(1.0)  # into the run; were it not there yet, the import would end with a traceback
        process.send_signal(signal.SIGINT)
        said, _ = process.communicate(timeout=60)
    assert said == "interrupted\n"


def interrupted(what):
    """What comes of Ctrl-C while an isolated unit hangs: the exception, what it came with, and how long it took."""
    code = (
        "import acroscope as ac\n"
        "print('begun', flush=True)\n"
        f"try:\n    {what}\n"
        "except BaseException as error:\n    print(type(error).__name__, repr(error.__context__))\n"
    )
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "begun\n"
        time.sleep(2.0)  # into the run
        # A process that is stopped answers as one that hangs does: not at all.
        threads = Path(f"/proc/{process.pid}/task").iterdir()
        children = {child for thread in threads for child in (thread / "children").read_text().split()}
        assert len(children) == 2, "the plant's and the controller's"
        os.kill(int(min(children)), signal.SIGSTOP)
        time.sleep(0.5)
        began = time.monotonic()
        process.send_signal(signal.SIGINT)
        said, _ = process.communicate(timeout=60)
    return said, time.monotonic() - began


@pytest.mark.skipif(sys.platform != "linux", reason="units in processes of their own: Linux")
@pytest.mark.parametrize(
    "what",
    [
        "ac.run('full-state', stop=1000000, isolate=True)",
        "ac.Simulation('full-state', stop=1000000, isolate=True).step(until=1000000)",
    ],
)
def test_ctrl_c_ends_an_isolated_unit_that_hangs(what):
    said, seconds = interrupted(what)
    assert said == "KeyboardInterrupt None\n"
    # Looked for some fifty times a second; a step limit would take 30 s, and Python's own end takes some.
    assert seconds < 10


def test_limits_of_a_call_are_arguments():
    for call in (ac.run, ac.Simulation):
        with pytest.raises(ac.InputError, match="above 0 and below 1e9") as refused:
            call("full-state", isolate=True, step_limit=-1.0)
        assert "--" not in str(refused.value)
    with pytest.raises(ac.InputError, match="add isolate=True$"):
        ac.run("full-state", step_limit=3)


@pytest.mark.skipif(sys.platform != "linux", reason="units in processes of their own: Linux")
def test_processes_find_a_package_that_only_sys_path_knows():
    other = getattr(sys, "_base_executable", sys.executable)
    bare = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    known = subprocess.run([other, "-P", "-c", "import acroscope"], env=bare, capture_output=True)
    assert known.returncode != 0, "it is found by name: nothing is tested"
    code = (
        f"import sys; sys.path.insert(0, {str(Path(ac.__file__).parents[1])!r})\n"
        "import acroscope as ac\n"
        "print(ac.check(ac.units()['acrobot_plant']))\n"
        "print(len(ac.run('full-state', stop=0.1, isolate=True)))\n"
    )
    done = subprocess.run([other, "-P", "-c", code], env=bare, capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("[]\n61\n", "")


def test_the_command_is_installed(tmp_path):
    words = [sys.executable, "-m", "acroscope", "run", "full-state", "--stop", "0.1", "--out", str(tmp_path / "out")]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert "report.html" in done.stdout
    wrong = subprocess.run([*words, "--set", "plant.theta_99=1"], cwd=tmp_path, capture_output=True, text=True)
    assert wrong.returncode == 2 and "theta_99" in wrong.stderr
