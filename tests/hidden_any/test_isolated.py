"""A unit that takes its process down, or never comes back, ends a diagnosis in which it runs in a process of its own."""

import shutil
import subprocess
from pathlib import Path

import pytest

from . import sets
from .machines import motor
from .unit_c import build
from .unit_python import environment

PROGRAM = Path(__file__).resolve().parents[2] / "target" / "release" / "acroscope"


@pytest.mark.parametrize(
    ("fault", "told"),
    [("for (;;) { volatile int k = 0; (void)k; }", "did not come back within 1 s (step_limit)"), ("*(volatile int *)0 = 1;", "SIGSEGV")],
)
def test_a_unit_that_crashes_or_hangs_ends_the_diagnosis_with_what_it_did(tmp_path, fault, told):
    machine = motor.MACHINE
    units = {"motor": machine.build(machine, tmp_path)}
    sets.make(machine, "none", 33, tmp_path / "set", tmp_path / "answers", units)
    (tmp_path / "bad").mkdir()
    equations = f"{motor.C}\nif (x[1] > 3.0) {fault}"
    unit = build(machine, tmp_path / "bad", equations, "v[i] = x[0]; v[w] = x[1]; v[phi] = x[2];", step=5e-4)
    shutil.copy(unit, tmp_path / "set" / "motor.fmu")
    command = [PROGRAM, "--quiet", "diagnose", tmp_path / "set", "--isolate", "--step-limit", "1", "--out", tmp_path / "found"]
    # two calls or three hang, of a second each; without an end to it there would be hundreds
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False, env=environment(), timeout=120)
    assert done.returncode == 1 and told in done.stderr and "fmi2DoStep" in done.stderr, done.stderr
    assert not (tmp_path / "found").exists()


def test_a_unit_that_crashes_where_it_is_begun_takes_no_diagnosis_with_it(tmp_path):
    machine = motor.MACHINE
    sets.make(machine, "none", 33, tmp_path / "set", tmp_path / "answers", {"motor": machine.build(machine, tmp_path)})
    (tmp_path / "bad").mkdir()
    unit = build(machine, tmp_path / "bad", motor.C, "*(volatile int *)0 = 1; v[i] = x[0]; v[w] = x[1]; v[phi] = x[2];", step=5e-4)
    shutil.copy(unit, tmp_path / "set" / "motor.fmu")
    command = [PROGRAM, "--quiet", "diagnose", tmp_path / "set", "--isolate", "--step-limit", "1", "--out", tmp_path / "found"]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False, env=environment(), timeout=120)
    # it was killed itself before, where start values were looked at
    assert done.returncode == 1 and "SIGSEGV" in done.stderr, (done.returncode, done.stderr)
    assert not (tmp_path / "found").exists()
