"""The types that editors and checkers see, against the compiled module and in programs. Run by scripts/test-wheel.sh."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("mypy")

README = Path(__file__).parent.parent / "README.md"


def checked(program, tmp_path):
    """What mypy says of a program, strictly."""
    file = tmp_path / "program.py"
    file.write_text(program)
    words = [sys.executable, "-m", "mypy", "--strict", "--no-error-summary", "--cache-dir", str(tmp_path / "cache"), str(file)]
    return subprocess.run(words, cwd=tmp_path, capture_output=True, text=True).stdout


def test_stubs_are_those_of_the_compiled_module():
    words = [sys.executable, "-m", "mypy.stubtest", "--concise", "acroscope._acroscope"]
    done = subprocess.run(words, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_types_of_the_readme_are_right(tmp_path):
    blocks = re.findall(r"```python\n(.*?)```", README.read_text("utf-8"), flags=re.S)
    assert len(blocks) == 2
    assert checked("\n".join(blocks), tmp_path) == ""


def test_types_are_what_they_say(tmp_path):
    program = """
import acroscope as ac
r = ac.run("full-state", {"plant.b_joint": 0.5}, stop="1/3")
reveal_type(r.verdict)
reveal_type(r.frames)
reveal_type(r.plot())
reveal_type(ac.Simulation("full-state").step())
reveal_type(ac.check("a.fmu"))
reveal_type(ac.diagnose("set").verdict)
reveal_type(ac.import_logs("log.csv", "heater.fmu").guesses)
reveal_type(ac.new("plant.fmu"))
"""
    revealed = re.findall(r'Revealed type is "(.*)"', checked(program, tmp_path))
    wanted = ["str", r"dict\[int, .*ndarray", "Figure", r"float \| None", r"list\[.*dict\[.*str, Any\]\]", "str", r"list\[.*str\]", "str"]
    assert len(revealed) == len(wanted)
    for found, want in zip(revealed, wanted):
        assert re.search(want, found), f"{found}: {want}"


@pytest.mark.parametrize("wrong", ["ac.run(3)", "ac.run('full-state', stopp=1)", "ac.Simulation('full-state').sett('a', 1)"])
def test_types_refuse_what_is_wrong(wrong, tmp_path):
    assert "error:" in checked(f"import acroscope as ac\n{wrong}\n", tmp_path)


def test_what_is_read_can_be_reckoned_with(tmp_path):
    """A controller in Python, and names where lists of names are wanted."""
    program = """
import numpy as np
import acroscope as ac
with ac.Simulation("full-state", inputs="plant.tau") as sim:
    sim.set("plant.tau", -2.0 * sim.get("plant.q1") - 0.5 * sim.get("plant.dq1"))
    sim.set("plant.tau", np.float32(0.1))
    text: str = sim.get("camera.frames_dir", str)
    count: int = sim.get("camera.frame", int)
    known: bool = sim.get("plant.contact", bool)
r = ac.run("full-state")
twice: float = 2 * r.last("plant.q1")
names: list[str] = list(r)
ac.diagnose("set", without="plant.b_joint", fit=["a.b"], budget=5.0)
ac.diagnose(ac.import_logs(["a.csv", "b.csv"], "heater.fmu", rate=50, out="heater"))
ac.diagnose(ac.record(r.folder, torque_noise=0.01))
ac.sweep("full-state", {"plant.b_joint": [0.1, 0.2], "plant.q2_0": "0:1:0.5"}, until="plant.contact", values={"plant.k_tau": 1.1})
"""
    assert checked(program, tmp_path) == ""
