"""A unit that takes its process down, or never comes back, ends import and diagnosis with a word of what it did, and leaves nothing behind."""

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


LOOPS, CRASHES, EXITS = "for (;;) { volatile int k = 0; (void)k; }", "*(volatile int *)0 = 1;", "exit(0);"


def bad_set(folder, fault, outputs=""):
    """A set of the motor whose unit has a fault in its steps, once it is fast."""
    machine = motor.MACHINE
    sets.make(machine, "none", 33, folder / "set", folder / "answers", {"motor": machine.build(machine, folder)})
    (folder / "bad").mkdir()
    equations = f"{motor.C}\nif (x[1] > 3.0) {{ {fault} }}"
    unit = build(machine, folder / "bad", equations, f"{outputs} v[i] = x[0]; v[w] = x[1]; v[phi] = x[2];", step=5e-4)
    shutil.copy(unit, folder / "set" / "motor.fmu")
    return unit


def done_by(*words):
    command = list(map(str, [PROGRAM, *words]))
    return subprocess.run(command, capture_output=True, text=True, check=False, env=environment(), timeout=120)


@pytest.mark.parametrize(
    ("fault", "told"),
    [(LOOPS, "did not come back within 1 s (step_limit)"), (CRASHES, "SIGSEGV"), (EXITS, "ended by exit with status 0")],
)
@pytest.mark.parametrize("where", ["in a step", "where it is begun"])
def test_a_unit_that_ends_an_import_is_told_with_what_it_did(tmp_path, fault, told, where):
    unit = bad_set(tmp_path, *((fault,) if where == "in a step" else ("", fault)))
    logs = sorted((tmp_path / "set").glob("run-*.csv"))
    done = done_by("import", *logs, "--fmu", unit, "--step-limit", "1", "--out", tmp_path / "imported")
    # where it is begun its outputs are computed when they are asked for
    function = "fmi2DoStep" if where == "in a step" else "fmi2GetReal"
    assert done.returncode == 1 and done.stdout == "", done
    assert all(word in done.stderr for word in (told, "unit motor", function, "acroscope check")), done.stderr
    assert not (tmp_path / "imported").exists()


@pytest.mark.parametrize(("fault", "told"), [(LOOPS, "does not come back from"), (CRASHES, "SIGSEGV"), (EXITS, "by calling exit in")])
def test_a_unit_that_ends_a_diagnosis_in_its_own_process_is_told(tmp_path, fault, told):
    bad_set(tmp_path, fault)
    # threads call it side by side: the second that crashes or exits must not cut short what the first one says
    for _ in range(1 if fault == LOOPS else 5):
        done = done_by("diagnose", tmp_path / "set", "--step-limit", "1", "--out", tmp_path / "found")
        assert done.returncode == 1 and done.stdout == "", done
        assert all(word in done.stderr for word in (told, "unit motor", "fmi2DoStep", "--isolate")), done.stderr
        assert not (tmp_path / "found").exists()


@pytest.mark.parametrize("isolate", [[], ["--isolate"]])
def test_what_a_unit_prints_is_no_answer(tmp_path, isolate):
    unit = bad_set(tmp_path, "", "extern int puts(const char *); puts(\"a word of the unit\");")
    logs = sorted((tmp_path / "set").glob("run-*.csv"))[:1]
    done = done_by("import", *logs, "--fmu", unit, "--out", tmp_path / "imported", *isolate)
    assert done.returncode == 0 and "a word of the unit" in done.stderr, done.stderr[-300:]
    assert "then: acroscope diagnose" in done.stdout and "a word of the unit" not in done.stdout, done.stdout
