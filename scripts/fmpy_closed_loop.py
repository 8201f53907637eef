"""The paper's Figure 19 through FMPy: a Gauss-Seidel master in a page of Python.

Steps plant -> camera -> controller 600 times a second, as scenarios/visual-servo.toml does, and writes a CSV file with
one row per communication point. Same algorithm and intervals: the same bits as `acroscope run visual-servo`.

    python scripts/fmpy_closed_loop.py --stop 30 --out out/fmpy.csv
"""

import argparse
import csv
from bisect import bisect_right
from fractions import Fraction
from pathlib import Path

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

UNITS = Path(__file__).resolve().parent.parent / "target" / "fmus"
INTERVAL = Fraction(1, 600)
REFERENCE = [(0, 0), (2, 0), (12, 0.5), (15, 0.5), (25, 0), (30, 0)]
START = {"plant": {"q1_0": -0.05, "q2_0": 0.1}}
LINKS = {
    "plant": {"tau": "controller.tau"},
    "camera": {name: f"plant.{name}" for name in ("q1", "q2", "dq1", "dq2")},
    "controller": {name: f"camera.{name}_est" for name in ("q1", "q2", "dq1", "dq2")} | {"frame": "camera.frame"},
}


def z_desired(time):
    """Ramps between the points of REFERENCE, smooth to the fourth derivative."""
    if time >= REFERENCE[-1][0]:
        return REFERENCE[-1][1]
    index = bisect_right([point[0] for point in REFERENCE], time) - 1
    (t0, z0), (t1, z1) = REFERENCE[index : index + 2]
    s = (time - t0) / (t1 - t0)
    ramp = s * s * s * s * s * (126.0 + s * (-420.0 + s * (540.0 + s * (-315.0 + s * 70.0))))
    return z0 + (z1 - z0) * ramp


class Unit:
    """One instance of an FMU, addressed by variable names."""

    def __init__(self, name, folder=UNITS):
        path = folder / f"acrobot_{name}.fmu"
        description = read_model_description(str(path))
        self.variables = {variable.name: variable for variable in description.modelVariables}
        self.slave = FMU2Slave(
            guid=description.guid,
            unzipDirectory=extract(str(path)),
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        self.slave.instantiate()

    def set(self, name, value):
        variable = self.variables[name]
        getattr(self.slave, "set" + variable.type)([variable.valueReference], [value])

    def get(self, name):
        variable = self.variables[name]
        return getattr(self.slave, "get" + variable.type)([variable.valueReference])[0]


def rows(stop, parameters=None):
    """Runs the loop; yields the time and the values of all inputs and outputs at each communication point."""
    units = {name: Unit(name) for name in LINKS}
    for name, unit in units.items():
        unit.slave.setupExperiment(startTime=0.0, stopTime=float(stop))
        unit.slave.enterInitializationMode()
        for parameter, value in ((parameters or START).get(name, {})).items():
            unit.set(parameter, value)

    def feed(name, time):
        for variable, source in LINKS[name].items():
            other, output = source.split(".")
            units[name].set(variable, units[other].get(output))
        if name == "controller":
            units[name].set("z_desired", z_desired(time))

    def sample(time):
        row = {"time": time}
        for name, unit in units.items():
            row |= {f"{name}.{v.name}": unit.get(v.name) for v in unit.variables.values() if v.causality == "output"}
        return row

    for name in ("camera", "controller", "plant"):  # along the dependencies at the start
        feed(name, 0.0)
    for unit in units.values():
        unit.slave.exitInitializationMode()
    yield sample(0.0)
    for step in range(int(Fraction(stop) / INTERVAL)):
        time, after = float(step * INTERVAL), float((step + 1) * INTERVAL)
        for name, unit in units.items():
            feed(name, after)
            unit.slave.doStep(currentCommunicationPoint=time, communicationStepSize=float(INTERVAL))
        yield sample(after)
    for unit in units.values():
        unit.slave.terminate()
        unit.slave.freeInstance()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--stop", type=Fraction, default=Fraction(30), help="simulated seconds (default 30)")
    parser.add_argument("--out", type=Path, default=Path("out/fmpy.csv"), help="CSV file to write")
    arguments = parser.parse_args()
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    with arguments.out.open("w", newline="") as file:
        writer = None
        for row in rows(arguments.stop):
            if writer is None:
                writer = csv.DictWriter(file, fieldnames=list(row))
                writer.writeheader()
            writer.writerow(row)
    print(f"{arguments.out}: the last row is at {row['time']} s, z = {row['plant.z']:.6f}")


if __name__ == "__main__":
    main()
