"""`acroscope check` beside FMPy's validation, on units with planted faults and on units without; `acroscope new` runs."""

import json
import os
import re
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path

import pytest
from conftest import IDENTIFIERS, ROOT, UNITS
from fmpy.validation import validate_fmu
from test_foreign_units import TANK

# What is replaced in the plant's description: both FMPy and we must complain.
PLANTED = [
    (r'unit="rad/s"', 'unit="furlong"'),
    (r'<Outputs>\s*<Unknown [^>]*>', "<Outputs>"),
    (r'<InitialUnknowns>\s*<Unknown [^>]*>', "<InitialUnknowns>"),
    (r'ScalarVariable name="q2"', 'ScalarVariable name="q1"'),
    (r'causality="parameter" variability="fixed"', 'causality="parameter" variability="continuous"'),
    (r'causality="input"', 'causality="in"'),
    (r'(causality="input"[^>]*>\s*<Real[^>]*?) start="[^"]*"', r"\1"),
    (r'<BaseUnit rad="1"/>', '<BaseUnit rad="one"/>'),
    (r"<DefaultExperiment ", "<DefaultExperimet "),
    (r'fmiVersion="2.0"', ""),
    (r'valueReference="0"', ""),
    (r'displayUnit="deg"', 'displayUnit="grad"'),
]


@pytest.fixture
def findings():
    def findings(path, **environment):
        command = [ROOT / "target" / "release" / "acroscope", "check", path, "--json"]
        done = subprocess.run(command, capture_output=True, text=True, env=os.environ | environment)
        found = json.loads(done.stdout)
        assert done.returncode == int(any(one["severity"] == "error" for one in found)), done.stderr
        assert all(set(one) == {"rule", "severity", "variable", "text"} for one in found)
        return found

    return findings


def changed(path, pattern, replacement, to):
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(to, "w") as new:
        for name in old.namelist():
            content = old.read(name)
            if name == "modelDescription.xml":
                text, count = re.subn(pattern, replacement, content.decode(), count=1)
                assert count == 1, pattern
                content = text.encode()
            new.writestr(name, content)
    return to


@pytest.mark.parametrize("pattern,replacement", PLANTED)
def test_what_fmpy_finds_is_found(findings, tmp_path, pattern, replacement):
    path = changed(UNITS / f"{IDENTIFIERS['plant']}.fmu", pattern, replacement, tmp_path / "acrobot_plant.fmu")
    assert validate_fmu(str(path)) != []
    assert any(one["severity"] == "error" for one in findings(path))


def test_a_unit_of_pythonfmu_has_no_error(findings, tmp_path):
    (tmp_path / "tank.py").write_text(TANK)
    command = [sys.executable, "-m", "pythonfmu", "build", "-f", "tank.py"]
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    library = Path(sysconfig.get_config_var("LIBDIR")) / sysconfig.get_config_var("LDLIBRARY")
    found = findings(tmp_path / "Tank.fmu", LD_PRELOAD=str(library), PYTHONPATH=sysconfig.get_path("purelib"))
    assert [one for one in found if one["severity"] == "error"] == []
    # It was run: this one shows nowhere else.
    assert "guid-checked" in {one["rule"] for one in found}


def test_a_drafted_scenario_runs(acroscope, tmp_path):
    units = [UNITS / f"{IDENTIFIERS[name]}.fmu" for name in ("plant", "camera", "controller")]
    acroscope("new", *units, "-o", tmp_path / "loop.toml")
    acroscope("run", tmp_path / "loop.toml", "--stop", "0.1", "--out", tmp_path / "out")
    assert len((tmp_path / "out" / "results.csv").read_text().splitlines()) == 62
    again = acroscope("new", *units, "-o", tmp_path / "loop.toml", status=2)
    assert "--force" in again.stderr
    acroscope("new", *units, "-o", tmp_path / "loop.toml", "--force")
