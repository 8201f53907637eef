"""What Python takes and gives beside the command line: containers, lists of names, ends of simulations. Run by scripts/test-wheel.sh."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import acroscope as ac


@pytest.fixture(scope="module")
def results():
    return ac.run("full-state", stop="1/10")


@pytest.fixture(scope="module")
def single(tmp_path_factory):
    """A scenario of one unit, without a [report]."""
    folder = tmp_path_factory.mktemp("single")
    (folder / "alone.toml").write_text(
        'format = 1\nexperiment = { stop = 0.1 }\n[[units]]\nname = "plant"\nfmu = "acrobot_plant.fmu"\ninterval = 0.01\n'
    )
    return folder / "alone.toml"


DRIVEN = r"^controller\.z_desired=0\.3: controller\.z_desired is driven: its signal at .*visual-servo\.toml:\d+ would overwrite it$"


def test_a_driven_input_is_refused_wherever_it_is_given():
    given = {"controller.z_desired": 0.3}
    with pytest.raises(ac.InputError, match=DRIVEN):
        ac.run("visual-servo", given)
    with pytest.raises(ac.InputError, match=DRIVEN):
        ac.Simulation("visual-servo", given)
    with pytest.raises(ac.InputError, match=DRIVEN):
        ac.sweep("visual-servo", {"camera.seed": [1]}, scalars={"q": "plant.q1:last"}, values=given)
    with pytest.raises(ac.InputError, match="would overwrite it"):
        ac.Simulation("visual-servo").set("controller.z_desired", 0.3)
    free = ac.Simulation("full-state", {"plant.tau": 1.0}, inputs="plant.tau", stop=0.1)
    assert free.get("plant.tau") == 1.0, "nothing drives it any more"


def test_results_are_a_mapping_of_columns(results):
    assert list(results) == results.columns and "plant.q1" in results and "plant.q9" not in results
    assert 3 not in results
    arrays = dict(results)
    assert list(arrays) == results.columns and arrays["plant.q1"].tolist() == results["plant.q1"].tolist()
    whole = np.asarray(results)
    assert whole.shape == (len(results), len(results.columns)) and whole.dtype == float
    np.testing.assert_array_equal(whole[:, results.columns.index("plant.q2")], results["plant.q2"])
    np.testing.assert_array_equal(whole[:, results.columns.index("plant.contact")], results["plant.contact"])
    assert np.asarray(results, dtype=np.float32).dtype == np.float32


def test_plots_are_those_of_the_page(results, single):
    assert len(results.plot().axes) == 4, "those that the scenario asks for"
    alone = ac.run(single)
    page = (alone.folder / "report.html").read_text("utf-8")
    titles = [axis.get_title() for axis in alone.plot().axes]
    assert "Outputs of plant, rad" in titles
    for title in titles:
        assert title in page


def test_steps_end_and_do_not_go_back():
    sim = ac.Simulation("full-state", stop=0.5)
    times = []
    while (time := sim.step(until=sim.time + 0.2)) is not None:
        times.append(time)
        assert len(times) < 9, "the end is never told"
    assert times == [0.2, 0.4, 0.5] and sim.step() is None
    sim.reset()
    assert sim.step(until=0.2) == 0.2
    assert sim.step(until=0.2) == 0.2 and sim.step(until=0.2 + 1e-9) == 0.2, "it has not come to its end"
    for wrong in (0.1, float("nan"), -float("inf")):
        with pytest.raises(ac.InputError, match=r"^until = .*not before the time now, 0\.2 s$"):
            sim.step(until=wrong)
    for no_time in ("x", [0.3], 10**400):
        with pytest.raises(ac.InputError, match=re.escape(f"until = {no_time!r}: a time in s that is not before the time now, 0.2 s")):
            sim.step(until=no_time)
    assert sim.step(until=float("inf")) == 0.5 and sim.step(until=1) is None


def test_a_simulation_is_closed():
    with ac.Simulation("full-state", stop=0.1) as sim:
        sim.step()
    with pytest.raises(ac.Error, match="the simulation is closed"):
        sim.step()
    sim.close()
    assert repr(sim) == "<Simulation, closed>"


@pytest.mark.skipif(sys.platform != "linux", reason="units in processes of their own: Linux")
def test_the_end_of_a_with_ends_the_processes_of_units():
    with ac.Simulation("full-state", stop=0.1, isolate=True) as sim:
        sim.step()
        assert ac_processes() == 2
    assert ac_processes() == 0


def ac_processes():
    words = ["ps", "--ppid", str(os.getpid()), "-ww", "-o", "args="]
    if not shutil.which("ps"):
        pytest.skip("no ps")
    return sum(str(Path(ac.__file__).resolve()) in line for line in subprocess.run(words, capture_output=True, text=True).stdout.splitlines())


def test_reading_begins_a_run_and_says_so():
    sim = ac.Simulation("full-state", stop=0.1)
    assert "q1_0" in sim.resolved
    sim.set("plant.q1_0", 0.02)
    assert sim.get("plant.q1_0") == 0.02
    with pytest.raises(ac.InputError, match="reading a value or saving begins that; reset first"):
        sim.set("plant.q1_0", 0.03)
    sim.reset()
    sim.set("plant.q1_0", 0.03)
    assert sim.get("plant.q1") == 0.03


def test_values_are_of_the_type_that_is_wanted(results):
    sim = ac.Simulation("visual-servo", stop=0.1)
    assert sim.get("plant.q1", float) == sim.get("plant.q1")
    assert type(sim.get("camera.frame", int)) is int and type(sim.get("camera.frame", float)) is float
    assert sim.get("camera.frames_dir", str) == "" and sim.get("plant.contact", bool) is False
    with pytest.raises(ac.InputError, match=r"plant\.q1 = .*: it is of type float, not str"):
        sim.get("plant.q1", str)
    with pytest.raises(ac.InputError, match="not str"):
        results.last("plant.q1", str)
    assert results.last("plant.q1", float) == results["plant.q1"][-1]


def test_a_single_name_is_no_list_of_letters():
    free = ac.Simulation("full-state", stop=0.1, inputs="plant.tau")
    free.set("plant.tau", 2.0)
    hidden = ac.examples()["hidden-effect"]
    with pytest.raises(ac.InputError, match=r"plant\.b_jiont"):
        ac.diagnose(hidden, without="plant.b_jiont")
    with pytest.raises(ac.InputError, match=r"--fit .*format = 2|format = 2"):
        ac.diagnose(hidden, fit="plant.b_joint")


def test_a_package_that_is_missing_is_told_with_what_installs_it(monkeypatch):
    """Ours is on no index: an extra of it would install nothing, or a stranger's."""
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(ImportError, match="^this needs matplotlib: pip install matplotlib numpy$"):
        ac.run("full-state", stop=0.01).plot()


def test_words_of_the_command_line_stay_there():
    for call in (lambda: ac.run("--help"), lambda: ac.sweep("-q"), lambda: ac.diagnose("--help"), lambda: ac.Simulation("-q")):
        with pytest.raises(ac.InputError) as told:
            call()
        assert "usage" not in str(told.value).lower() and "for more information" not in str(told.value).lower()
    with pytest.raises(ac.InputError, match=r"'-1' for 'budget .*seconds above 0 and below 1e9$"):
        ac.diagnose(ac.examples()["hidden-effect"], budget=-1)
    with pytest.raises(ac.InputError, match=r"^grid: nothing of a run would be kept: until plant\.contact, or scalars NAME="):
        ac.sweep("visual-servo", {"camera.seed": [1]})
    for call in (ac.run, ac.sweep):
        with pytest.raises(TypeError, match=r"values: a mapping such as .*, not \[1, 2\]"):
            call("full-state", values=[1, 2])
    with pytest.raises(ac.InputError, match=r"^camera\.k9=0\.1: "):
        ac.run("visual-servo", {"camera.k9": 0.1})
    with pytest.raises(ac.InputError, match="jobs = -1: a number of threads"):
        ac.sweep("delay-and-rate", jobs=-1)


def test_a_diagnosis_takes_what_the_command_takes_and_its_model_can_be_moved(tmp_path):
    diagnosis = ac.diagnose(ac.examples()["hidden-effect"], budget=20, without=["camera.k2"])
    assert [effect["name"] for effect in diagnosis.effects] == ["plant.b_joint"]
    moved = diagnosis.write_amended(tmp_path / "moved")
    assert moved == tmp_path / "moved" / "amended.toml" and moved.read_text("utf-8") == diagnosis.amended
    assert "lost its balance" in ac.run(moved).summary["title"]


def test_the_amended_model_of_any_unit_goes_with_its_files(tmp_path, single):
    """As `diagnose` leaves it for a unit that is fed by a log."""
    folder = tmp_path / "found"
    folder.mkdir()
    (folder / "inputs.csv").write_text("time,u\n0,1\n1,2\n")
    (folder / "diagnosis.json").write_text('{"verdict": "none", "effects": [], "gap": {}}')
    (folder / "amended.toml").write_text(
        single.read_text("utf-8")
        + '[[sources]]\nto = "plant.tau"\nkind = "csv"\nfile = "inputs.csv"\ncolumn = "u"\n'
    )
    found = ac.Diagnosis(folder)
    assert ac.run(found.write_amended(tmp_path / "elsewhere")).last("plant.tau") > 1.0
    assert found.write_amended(folder) == folder / "amended.toml", "into its own folder: nothing is to be done"


def test_a_grid_is_swept_from_python(tmp_path):
    out = tmp_path / "out"
    done = ac.sweep(
        "full-state", {"plant.b_joint": [0.1, 0.2], "plant.q2_0": "0.1:0.12:0.01"},
        scalars={"last": "plant.q1:last"}, values={"plant.tau_max": 40.0}, stop="1/10", out=out, jobs=1,
    )  # fmt: skip
    table = done.table()
    assert table["plant.b_joint"].to_pylist() == [0.1] * 3 + [0.2] * 3
    assert table["plant.q2_0"].to_pylist() == [0.1, 0.11, 0.12] * 2
    alone = ac.run("full-state", {"plant.b_joint": 0.2, "plant.q2_0": 0.11, "plant.tau_max": 40.0}, stop="1/10")
    assert table["last"].to_pylist()[4] == alone.last("plant.q1")
    until = ac.sweep("full-state", {"plant.b_joint": [0.1]}, until="plant.q2 < 1", stop=0.1).table()
    assert len(until) == 1
    with pytest.raises(ac.InputError, match="signals"):
        done.table("signals")


def test_a_page_in_a_frame_has_no_links_that_lead_nowhere():
    shown = ac.reproduce("table-3")._repr_html_()
    frame = re.search(r'srcdoc="([^"]*)"', shown)
    assert frame and "href=&quot;studies/" not in frame[1]
    assert "index.html</p><iframe" in shown
