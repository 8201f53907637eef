#!/usr/bin/env python3
"""Masters in Python that step the ring of three nearly free units of `benches/ring.c`: FMPy, libcosim and
Ecos.

With `--serve RING_FMU UNITS` it reads lines and answers each with one line of JSON: `times_us` (one value) and
`values`.

    fmpy STEPS        µs a step; the loop a user writes with FMPy: set, doStep, get for each unit
    fmpy_csv STEPS    the same with ten values a step to CSV
    libcosim STEPS    µs a step; `simulate_until`, so that no Python runs between steps
    libcosim_csv STEPS  the same with its file observer
    serial STEPS      µs a step of libcosim without its threads (libcosim_serial.py)
    ecos STEPS        µs a step of Ecos (ecos.py)
    ecos_csv STEPS    the same with ten values a step through its CSV writer
    fmpy_short STEPS  µs of a whole run of so many steps, from reset to the last step
    loop STOP         µs of the closed loop of Figure 19 for STOP simulated seconds (scripts/fmpy_closed_loop.py)
"""

import csv
import json
import os
import shutil
import sys
import tempfile
import time
from fractions import Fraction
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from ecos import Ecos  # noqa: E402
from libcosim_serial import Serial  # noqa: E402

SIZE = 1e-3
IN, OUT = [0, 1], [2, 3]


class Fmpy:
    def __init__(self, path):
        from fmpy import extract, read_model_description
        from fmpy.fmi2 import FMU2Slave

        description = read_model_description(path)
        self.folder = extract(path)
        self.units = []
        for name in "abc":
            unit = FMU2Slave(
                guid=description.guid,
                unzipDirectory=self.folder,
                modelIdentifier=description.coSimulation.modelIdentifier,
                instanceName=name,
            )
            unit.instantiate()
            self.units.append(unit)

    def run(self, steps, file=None):
        writer = csv.writer(file) if file else None
        for unit in self.units:
            unit.reset()
            unit.setupExperiment(startTime=0.0)
            unit.enterInitializationMode()
            unit.exitInitializationMode()
        a, b, c = self.units
        from_a = from_b = from_c = [0.0, 0.0]
        for k in range(steps):
            t = k * SIZE
            a.setReal(IN, from_c)
            a.doStep(t, SIZE)
            from_a = a.getReal(OUT)
            b.setReal(IN, from_a)
            b.doStep(t, SIZE)
            from_b = b.getReal(OUT)
            c.setReal(IN, from_b)
            c.doStep(t, SIZE)
            from_c = c.getReal(OUT)
            if writer:
                writer.writerow([t, *from_a, *from_b, *from_c, *from_a, *from_b])
        return from_a + from_b + from_c


class Libcosim:
    def __init__(self, path, log=None):
        from libcosimpy.CosimExecution import CosimExecution
        from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
        from libcosimpy.CosimObserver import CosimObserver
        from libcosimpy.CosimSlave import CosimLocalSlave

        log_output_level(CosimLogLevel.ERROR)
        self.execution = CosimExecution.from_step_size(step_size=1_000_000)
        # The execution doesn't own its slaves in Python.
        self.slaves = [CosimLocalSlave(fmu_path=path, instance_name=name) for name in "abc"]
        index = [self.execution.add_local_slave(slave) for slave in self.slaves]
        for source, target in ((2, 0), (0, 1), (1, 2)):
            for out, into in zip(OUT, IN):
                assert self.execution.connect_real_variables(index[source], out, index[target], into) == 0
        self.observer = CosimObserver.create_to_dir(log) if log else None
        if self.observer:
            self.execution.add_observer(self.observer)
        self.now = 0
        self.run(1)

    def run(self, steps):
        self.now += steps * 1_000_000
        assert self.execution.simulate_until(self.now)


def closed_loop(units, stop):
    import fmpy_closed_loop

    fmpy_closed_loop.Unit.__init__.__defaults__ = (Path(units),)
    began = time.perf_counter()
    with open(os.devnull, "w", newline="") as file:
        writer = csv.writer(file)
        for row in fmpy_closed_loop.rows(Fraction(stop)):
            writer.writerow(row.values())
    return time.perf_counter() - began


def main():
    ring, units = sys.argv[sys.argv.index("--serve") + 1 :][:2]
    folder = tempfile.mkdtemp()
    make = {
        "fmpy": lambda: Fmpy(ring),
        "libcosim": lambda: Libcosim(ring),
        "libcosim_csv": lambda: Libcosim(ring, folder),
        "serial": lambda: Serial(ring),
        "ecos": lambda: Ecos(ring),
        "ecos_csv": lambda: Ecos(ring, str(Path(folder) / "ecos.csv")),
    }
    masters = {}
    try:
        for line in sys.stdin:
            name, size = line.split()
            steps, values = int(size), []
            kind = name.split("_")[0]
            key = name if name in make else kind
            if kind != "loop" and key not in masters:
                masters[key] = make[key]()
            began = time.perf_counter()
            if name == "loop":
                closed_loop(units, steps)
            elif name == "fmpy_csv":
                with open(Path(folder) / "fmpy.csv", "w", newline="") as file:
                    values = masters[key].run(steps, file)
            elif kind == "fmpy":
                values = masters[key].run(steps)
            else:
                masters[key].run(steps)
            took = (time.perf_counter() - began) * 1e6
            if name not in ("loop", "fmpy_short"):
                took /= steps
            print(json.dumps({"times_us": [took], "values": values}), flush=True)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
