"""The packed units, and a thin way to step one, for all tests driven by foreign programs."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

ROOT = Path(__file__).resolve().parents[2]
UNITS = ROOT / "target" / "fmus"
IDENTIFIERS = {name: f"acrobot_{name}" for name in ("plant", "camera", "controller", "residual")}
IDENTIFIERS["signal"] = "signal_effects"
NAMES = tuple(IDENTIFIERS)
sys.path.insert(0, str(ROOT / "scripts"))


class Unit:
    """One instance of one of our units, addressed by variable names."""

    def __init__(self, name, directory, instance="unit"):
        self.path = UNITS / f"{IDENTIFIERS[name]}.fmu"
        self.description = read_model_description(str(self.path))
        self.variables = {variable.name: variable for variable in self.description.modelVariables}
        self.slave = FMU2Slave(
            guid=self.description.guid,
            unzipDirectory=extract(str(self.path), unzipdir=str(directory)),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=instance,
        )
        self.slave.instantiate()

    def start(self, **values):
        """Sets up an experiment from time 0 and leaves initialisation with these values."""
        self.slave.setupExperiment(startTime=0.0)
        self.slave.enterInitializationMode()
        self.set(**values)
        self.slave.exitInitializationMode()
        return self

    def set(self, **values):
        for name, value in values.items():
            variable = self.variables[name]
            getattr(self.slave, "set" + variable.type)([variable.valueReference], [value])
        return self

    def get(self, *names):
        values = []
        for name in names:
            variable = self.variables[name]
            values += getattr(self.slave, "get" + variable.type)([variable.valueReference])
        return values[0] if len(values) == 1 else values

    def outputs(self):
        return {name: self.get(name) for name, v in self.variables.items() if v.causality == "output"}

    def step(self, time, size, no_way_back=False):
        """One step; FMPy's own default promises that no earlier state will be set again."""
        self.slave.doStep(time, size, noSetFMUStatePriorToCurrentPoint=no_way_back)
        return self


@pytest.fixture
def unit(tmp_path):
    """Makes instances; frees them afterwards."""
    made = []

    def make(name):
        made.append(Unit(name, tmp_path / f"{name}-{len(made)}"))
        return made[-1]

    yield make
    for one in made:
        one.slave.freeInstance()


@pytest.fixture(scope="session")
def acroscope():
    """Runs the command line and returns the finished process."""
    program = ROOT / "target" / "release" / "acroscope"

    def run(*arguments, status=0, **environment):
        environment = os.environ | environment
        done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, cwd=ROOT, env=environment)
        assert done.returncode == status, f"exit {done.returncode}\n{done.stdout}\n{done.stderr}"
        return done

    return run
