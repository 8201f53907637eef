"""Our master runs units that we did not write: two made with PythonFMU, in a loop with its own closed form."""

import csv
import subprocess
import sys
import sysconfig
from pathlib import Path

import numpy as np

TANK = """
from pythonfmu import Fmi2Causality, Fmi2Slave, Real

class Tank(Fmi2Slave):
    author = "test"

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.level, self.inflow = 1.0, 0.0
        self.register_variable(Real("inflow", causality=Fmi2Causality.input))
        self.register_variable(Real("level", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        self.level += step_size * (self.inflow - self.level)
        return True
"""
VALVE = """
from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

class Valve(Fmi2Slave):
    author = "test"

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.gain, self.level, self.flow = 0.5, 0.0, 0.0
        self.register_variable(Real("gain", causality=Fmi2Causality.parameter, variability=Fmi2Variability.tunable))
        self.register_variable(Real("level", causality=Fmi2Causality.input))
        self.register_variable(Real("flow", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        self.flow = self.gain * self.level
        return True
"""
SCENARIO = """
format = 1
[experiment]
stop = 1
algorithm = "gauss-seidel"
[[units]]
name = "tank"
fmu = "Tank.fmu"
interval = "1/100"
[[units]]
name = "valve"
fmu = "Valve.fmu"
interval = "1/50"
[units.set]
gain = 0.25
[[connections]]
from = "tank.level"
to = "valve.level"
[[connections]]
from = "valve.flow"
to = "tank.inflow"
"""


def test_pythonfmu_units(acroscope, tmp_path):
    for name, source in {"tank": TANK, "valve": VALVE}.items():
        (tmp_path / f"{name}.py").write_text(source)
        command = [sys.executable, "-m", "pythonfmu", "build", "-f", f"{name}.py"]
        subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    (tmp_path / "loop.toml").write_text(SCENARIO)
    # A PythonFMU unit expects Python in the process that loads it; ours has none of its own.
    library = Path(sysconfig.get_config_var("LIBDIR")) / sysconfig.get_config_var("LDLIBRARY")
    assert library.suffix == ".so", "this Python was built without its shared library"
    python = {"LD_PRELOAD": str(library), "PYTHONPATH": sysconfig.get_path("purelib")}
    acroscope("run", tmp_path / "loop.toml", "--out", tmp_path / "out", **python)
    with (tmp_path / "out" / "results.csv").open() as file:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]

    level, flow = 1.0, 0.0  # the two difference equations, stepped by hand
    for k, row in enumerate(rows):
        if k > 0:
            level += 0.01 * (flow - level)
            flow = 0.25 * level if k % 2 == 0 else flow
        assert np.isclose(row["tank.level"], level, rtol=1e-12) and np.isclose(row["valve.flow"], flow, rtol=1e-12)
    assert len(rows) == 101
