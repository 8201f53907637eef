"""`fmpy validate` has nothing to say about any unit: it checks the description against the standard's schema."""

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from conftest import IDENTIFIERS, NAMES, ROOT, UNITS
from fmpy.validation import validate_fmu


@pytest.mark.parametrize("name", NAMES)
def test_no_message(name):
    assert validate_fmu(str(UNITS / f"{IDENTIFIERS[name]}.fmu")) == []


@pytest.mark.parametrize("name", NAMES)
def test_the_command_line_agrees(name):
    command = [Path(sys.executable).parent / "fmpy", "validate", str(UNITS / f"{IDENTIFIERS[name]}.fmu")]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0 and "No problems found." in done.stdout, done.stdout + done.stderr


@pytest.mark.parametrize("name", NAMES)
def test_committed_description_is_the_one_inside(name):
    with zipfile.ZipFile(UNITS / f"{IDENTIFIERS[name]}.fmu") as fmu:
        inside = fmu.read("modelDescription.xml")
    assert inside == (ROOT / "modelDescriptions" / f"{IDENTIFIERS[name]}.xml").read_bytes()
